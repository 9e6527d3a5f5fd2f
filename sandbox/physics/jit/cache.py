"""Compiled kernels on disk: one file for each kernel and types of arguments, whose name says all that it follows from.

A file is valid wherever it lies, whenever it was written: a filled folder may be copied to another machine of its kind.
It is written in one go, and read only where its content is what was written; what is cut or damaged counts as not there
and is written anew.
"""

import contextlib
import functools
import glob
import hashlib
import os
import pickle
import shutil
import sys
import time
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from types import FunctionType
from typing import Any

import numba
import numpy as np
from numba.core import caching, compiler, serialize

from sandbox.physics.jit.needs import class_text, digest_of_needs

types: Any = numba.types

_SUFFIX = ".kernel"
_CHECK_SIZE = 16
# Versions of one kernel that are kept: branches of a checkout, or installations that share a user's folder, take turns.
_KEPT_VERSIONS = 4
_DAY = 86400.0
# Files that nobody has loaded for so long belong to no kernel any more.
_FORGOTTEN = 60 * _DAY


def cache_folders() -> list[Path]:
    """The folders in which compiled kernels are looked for; they are written to the first that is writable.

    That of NUMBA_CACHE_DIR, else one next to the source and the user's own.
    """
    if numba.config.CACHE_DIR:
        return [Path(numba.config.CACHE_DIR) / "kernels"]
    physics = Path(__file__).parents[1]
    return [physics / "__pycache__" / "kernels", _user_folder()]


def _user_folder() -> Path:
    usual = {"win32": ("LOCALAPPDATA", "AppData/Local"), "darwin": ("", "Library/Caches")}
    variable, below_home = usual.get(sys.platform, ("XDG_CACHE_HOME", ".cache"))
    return Path(os.environ.get(variable) or Path.home() / below_home) / "spring-sandbox" / "kernels"


def _type_text(kind: Any) -> str:
    # A named tuple's own name leaves out its fields.
    if isinstance(kind, types.BaseNamedTuple):
        return f"{class_text(kind.instance_class)}{list(map(_type_text, kind.types))}"
    if isinstance(kind, types.BaseTuple):
        return repr(list(map(_type_text, kind)))
    return str(kind)


def _short(*texts: object) -> str:
    return hashlib.blake2b("\n".join(map(str, texts)).encode(), digest_size=6).hexdigest()


def _sealed(content: bytes) -> bytes:
    return hashlib.blake2b(content, digest_size=_CHECK_SIZE).digest() + content


def _unsealed(sealed: bytes) -> bytes | None:
    content = sealed[_CHECK_SIZE:]
    return content if _sealed(content) == sealed else None


class KernelCache(caching.NullCache):
    """Loads and saves the compiled code of a function. before: called with its dispatcher when that has to compile."""

    def __init__(self, dispatcher: Any, function: FunctionType, before: Callable[[Any], object]) -> None:
        self._dispatcher, self._function, self._before = dispatcher, function, before

    def _file_names(self, signature: Any, processor: tuple[Any, ...]) -> tuple[str, str]:
        """How the files of all versions of this kernel begin here, and the rest of this one's name."""
        arguments = _short(*map(_type_text, getattr(signature, "args", signature)))
        return f"{self._begin(processor)}{arguments}-", f"{digest_of_needs(self._function)}{_SUFFIX}"

    def _begin(self, processor: tuple[Any, ...]) -> str:
        function = self._function
        name = f"{function.__module__.rpartition('.')[2]}.{function.__qualname__}".replace("<", "").replace(">", "")
        versions = sys.implementation.cache_tag, numba.__version__, np.__version__
        return f"{name}-{_short(function.__module__, *versions, *processor)}-"

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The code compiled for these types of arguments, by any process; None: there is none that can be used."""
        with contextlib.suppress(Exception):  # inner parts of numba are others than those below
            found = self._find(sig, target_context)
            if found is not None:
                return found
        self._before(self._dispatcher)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Write compiled code to the first folder that takes it; if none does, say so once."""
        try:
            if any(not lifted.can_cache for lifted in data.lifted) or data.library.has_dynamic_globals:
                return
            # Types of variables, with paths of sources: text that nobody reads.
            content = serialize.dumps(data._replace(type_annotation="")._reduce())
            begin, end = self._file_names(sig, data.codegen.magic_tuple())
        except Exception as fault:
            _say_once(f"compiled kernels of this numba cannot be kept: {fault!r}")
        else:
            _keep(begin, begin + end, content)

    def _find(self, sig: Any, target_context: Any) -> Any:
        name = "".join(self._file_names(sig, target_context.codegen().magic_tuple()))
        found = (_load(folder / name, target_context) for folder in cache_folders())
        return next((result for result in found if result is not None), None)


def keep(dispatcher: Any, function: FunctionType, before: Callable[[Any], object]) -> bool:
    """Let a dispatcher of numba load and save compiled code; False: it cannot.

    before: called with the dispatcher when it has to compile.
    """
    can = hasattr(dispatcher, "_cache")
    if can:
        dispatcher._cache = KernelCache(dispatcher, function, before)
    return can


_said: list[str] = []


def _say_once(text: str) -> None:
    if not _said:
        _said.append(text)
        warnings.warn(text, RuntimeWarning, stacklevel=2)


def _keep(begin: str, name: str, content: bytes) -> None:
    refusal: OSError | None = None
    for folder in cache_folders():
        try:
            _write(folder / name, _sealed(content))
        except OSError as error:
            refusal = refusal or error
        else:
            _tidy(folder, begin)
            return
    _say_once(f"compiled kernels cannot be kept, and will be compiled again at the next start: {refusal}")


def _read(path: Path) -> bytes | None:
    try:
        return _unsealed(path.read_bytes())
    except OSError:
        return None


def _load(path: Path, target_context: Any) -> Any:
    content = _read(path)
    if content is None:
        return None
    try:
        result = compiler.CompileResult._rebuild(target_context, *pickle.loads(content))
    except Exception:  # whatever it is that was kept there, a start does not depend on it
        return None
    with contextlib.suppress(OSError):
        if path.stat().st_mtime < time.time() - _DAY:
            os.utime(path)
    return result


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(f".{os.getpid()}{_SUFFIX}")
    try:
        unfinished.write_bytes(content)
        os.replace(unfinished, path)
    except OSError:
        with contextlib.suppress(OSError):
            unfinished.unlink()
        raise


def _by_use(files: Iterable[Path]) -> list[tuple[float, Path]]:
    found = []
    for file in files:
        with contextlib.suppress(OSError):
            found.append((file.stat().st_mtime, file))
    return sorted(found, reverse=True)


def _tidy(folder: Path, begin: str) -> None:
    """Remove the oldest versions of a kernel. A process that still wants one has it loaded, or compiles it again."""
    _sweep(folder)
    for _, file in _by_use(folder.glob(f"{glob.escape(begin)}*{_SUFFIX}"))[_KEPT_VERSIONS:]:
        with contextlib.suppress(OSError):
            file.unlink()


@functools.cache
def _sweep(folder: Path) -> None:
    """Once in a process: remove what nobody loads any more, and the folders in which numba itself kept kernels."""
    for used, file in _by_use(folder.glob(f"*{_SUFFIX}")):
        if used < time.time() - _FORGOTTEN:
            with contextlib.suppress(OSError):
                file.unlink()
    if folder.parent.name == "__pycache__":
        for old in folder.parent.glob("kernels-*"):
            shutil.rmtree(old, ignore_errors=True)
