"""Kernels that are compiled on this machine, once, where they are others than those of the libraries that are shipped.

Each version has a folder of its own among the user's caches, whose name says what it follows from. It is made aside and
moved there in one go: it is whole, or not there.
"""

import contextlib
import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import platformdirs
from filelock import FileLock

from sandbox.physics.jit import say
from sandbox.physics.jit.sources import NoLibrary, file_digest, source_files, text_of

# Versions that are kept: branches of a checkout take turns.
_KEPT = 8
_DIGEST_SIZE = 8
# Where a library is made: one is left behind by a process that was killed.
_ASIDE = ".making-"


def _folder() -> Path:
    return Path(platformdirs.user_cache_dir("spring-sandbox", appauthor=False)) / "kernels"


def _version(checked: bool) -> str:
    digest = hashlib.blake2b(digest_size=_DIGEST_SIZE)
    for name, file in source_files():
        digest.update(f"{name}\n".encode() + text_of(file))
    return f"{digest.hexdigest()}-checked" if checked else digest.hexdigest()


def compiled_here(why: str, checked: bool) -> tuple[Path, dict[str, Any]]:
    """The library of kernels as they are now, and its manifest, compiled if it is not there yet.

    why: in a line that is said while that is done.

    Raises:
        NoLibrary: where they cannot be.
    """
    folder = _folder() / _version(checked)
    found = _kept(folder)
    if found is None:
        if importlib.util.find_spec("ziglang") is None:
            raise NoLibrary(f"{why}, and zig is not installed (the extra `build`)")
        say(f"{why}: they are compiled once, which takes about 15 s")
        try:
            found = _made(folder, checked)
        except OSError as error:
            raise NoLibrary(f"{why}, and no library can be kept in {folder.parent}: {error.strerror}") from error
    with contextlib.suppress(OSError):
        os.utime(folder)
    return found


def _kept(folder: Path) -> tuple[Path, dict[str, Any]] | None:
    """The library in a folder and its manifest, if both are there and whole."""
    try:
        manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
        library = folder / manifest["library"]
        return (library, manifest) if file_digest(library.read_bytes()) == manifest["digest"] else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _made(folder: Path, checked: bool) -> tuple[Path, dict[str, Any]]:
    """The compiled library in a folder, once it is made. Raises NoLibrary, OSError."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    # Processes that start together compile once: the others wait for the first.
    with FileLock(folder.parent / ".lock"):
        found = _kept(folder)
        if found is None:
            for left in (folder, *folder.parent.glob(f"{_ASIDE}*")):
                shutil.rmtree(left, ignore_errors=True)
            _compile(folder, checked)
            others = [one for one in folder.parent.iterdir() if (one / "manifest.json").exists()]
            for old in sorted(others, key=lambda one: one.stat().st_mtime, reverse=True)[_KEPT:]:
                shutil.rmtree(old, ignore_errors=True)
            found = _kept(folder)
    if found is None:
        raise NoLibrary(f"the library that was compiled cannot be read in {folder}")
    return found


def _compile(folder: Path, checked: bool) -> None:
    aside = Path(tempfile.mkdtemp(prefix=_ASIDE, dir=folder.parent))
    try:
        command = [sys.executable, "-P", "-m", f"{__package__}.making", str(aside)] + ["checked"] * checked
        home = str(Path(__file__).resolve().parents[3])
        path = os.pathsep.join(filter(None, (home, os.environ.get("PYTHONPATH"))))
        variables = {
            **os.environ,
            "PYTHONPATH": path,
            "SANDBOX_KERNELS": "interpreted",
            "PYGAME_HIDE_SUPPORT_PROMPT": "1",
        }
        ended = subprocess.run(command, env=variables, capture_output=True, text=True, check=False)
        if ended.returncode:
            raise NoLibrary(_last_line(ended.stdout) or _last_line(ended.stderr))
        aside.rename(folder)
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def _last_line(text: str) -> str:
    return text.strip().rpartition("\n")[2]
