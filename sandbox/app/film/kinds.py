"""Kinds of files that are shared: what they can hold and what they need; nothing here takes long to import."""

import importlib.util
from dataclasses import dataclass

Size = tuple[int, int]


class Missing(Exception):
    """A package that has to be installed first; said in a line."""


@dataclass(frozen=True)
class Kind:
    """fps: pictures a second unless told otherwise, and the most that viewers show at their speed.

    module, package: what it needs beside what is always installed, and how that is called when it is installed.
    even: whether its sides have to be. A page has every tick, and no size.
    """

    usual_fps: float
    most_fps: float
    module: str = ""
    package: str = ""
    even: bool = False


KINDS = {
    "gif": Kind(20.0, 50.0, "PIL", "Pillow"),
    "mp4": Kind(30.0, 60.0, "imageio_ffmpeg", "imageio-ffmpeg", even=True),
    "png": Kind(1.0, 1.0),
    "html": Kind(1.0, 1.0),
}


def require(kind: str) -> None:
    """Raises Missing where a kind of file cannot be written here."""
    needed = KINDS[kind]
    if needed.module:
        require_module(kind.upper(), needed.module, needed.package)


def require_module(what: str, module: str, packages: str, extra: str = "export") -> None:
    """Raises Missing where something needs a module that is not installed; packages: what it comes with."""
    if importlib.util.find_spec(module) is None:
        raise Missing(f'{what} needs {packages}: pip install "spring-sandbox[{extra}]"')


def possible_size(size: Size, kind: str) -> Size:
    """The size that a kind of file can have, next below one that is asked for."""
    return (max(2, size[0] // 2 * 2), max(2, size[1] // 2 * 2)) if KINDS[kind].even else size
