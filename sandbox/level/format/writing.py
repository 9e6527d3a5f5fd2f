"""Writes files so that the old content is never lost: in one step, or in place after a copy."""

import contextlib
import errno
import json
import os
import secrets
import shutil
import stat
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

_TEMPORARY = ".spring-sandbox-{}{}"
# Age [s] beyond which a temporary file belongs to no write that still runs; younger ones are left alone.
_ABANDONED = 3_600.0
# What a folder or file system answers that cannot replace a file in one step, though the file may still be writable.
# A full disk is not among them: a file that is written in place there would lose what it held.
_CANNOT_REPLACE = {
    errno.EACCES,
    errno.EPERM,
    errno.EROFS,
    errno.EBUSY,
    errno.EXDEV,
    errno.EINVAL,
    errno.ENOSYS,
    errno.ENOTSUP,
    errno.EOPNOTSUPP,
}


def write_file(path: Path, data: bytes) -> None:
    """Write a file whole or not at all: temporary file, flush, replace, folder sync. Raises OSError.

    The file keeps its permissions. After an error, such as a full disk, it is unchanged and no other file remains.
    """
    _refuse_what_is_no_file(path)
    try:
        _write_whole(path, data)
    except OSError as error:
        # What is beside it for a moment has no name for anybody.
        error.filename = os.fspath(path)
        raise


def unfinished(path: Path, ending: str) -> Path:
    """A free name beside a file for what is to take its place when it is whole; those of killed programs are swept."""
    _sweep(path.parent)
    return path.with_name(_TEMPORARY.format(secrets.token_hex(8), ending))


def alike(names: Iterable[str]) -> list[str]:
    """Of names those that another one is like, where systems do not tell capitals apart; each once."""
    counts = Counter(name.casefold() for name in names)
    return [name for name, count in counts.items() if count > 1]


def _write_whole(path: Path, data: bytes) -> None:
    temporary = unfinished(path, ".tmp")
    try:
        with open(temporary, "xb") as file:
            file.write(data)
            file.flush()
            _flush(file.fileno())
        _copy_permissions(path, temporary)
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise
    _sync_folder(path.parent)


def write_over(path: Path, data: bytes, backups: Path | None = None) -> str | None:
    """Write a file in one step, or, if the folder does not allow that, in place after a copy. A warning then, or None.

    The copy is `<name>.bak` beside the file, or in the folder `backups` if the program cannot write beside it.
    Raises OSError. The file is then unchanged, or the message names the copy.
    """
    try:
        write_file(path, data)
        return None
    except OSError as error:
        if error.errno not in _CANNOT_REPLACE:
            raise
        refused = error
    if not path.exists():
        _write_new(path, data)
        return f"{path} cannot be replaced in one step here: each save will write over it, and keep a copy first"
    if not path.is_file() or not os.access(path, os.W_OK):
        raise refused
    copy = _keep_copy(path, backups)
    if copy is None:
        raise refused
    try:
        _write_in_place(path, data)
    except OSError as error:
        with contextlib.suppress(OSError):
            _write_in_place(path, copy.read_bytes())
            raise error
        raise OSError(error.errno, f"{os.strerror(error.errno or 0)}; the level as it was is in {copy}") from None
    return (
        f"{path} cannot be replaced in one step here, so it was written in place and read back; "
        f"the level as it was is in {copy}"
    )


def refusal_of(error: OSError | ValueError) -> str:
    """Why the system refused a file, as the end of a line."""
    if isinstance(error, ValueError):  # which each Python words in its own way
        return "the name holds a null character"
    text = error.strerror or str(error)
    return text[:1].lower() + text[1:]


def _refuse_what_is_no_file(path: Path) -> None:
    """Raise OSError for a folder, a device, or a file that its owner has protected."""
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        return
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, "it is a folder")
    if not stat.S_ISREG(mode):
        raise OSError(errno.ENXIO, "it is no regular file")
    if not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, "it is protected against writing")


def _sweep(folder: Path) -> None:
    """Remove the temporary files of programs that were killed while they wrote."""
    with contextlib.suppress(OSError):
        for left in folder.glob(_TEMPORARY.format("*", "")):
            if time.time() - left.stat().st_mtime > _ABANDONED:
                left.unlink()


def _flush(descriptor: int) -> None:
    """Flush a file to the disk. Raises OSError, except on file systems that cannot flush."""
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP):
            raise


def _copy_permissions(path: Path, temporary: Path) -> None:
    try:
        old = path.stat()
    except FileNotFoundError:
        return
    # Giving a file away is the right of few; its permissions count more, and are set last because chown clears some.
    if hasattr(os, "chown"):
        with contextlib.suppress(OSError):
            os.chown(temporary, old.st_uid, old.st_gid)
    os.chmod(temporary, stat.S_IMODE(old.st_mode))


def _sync_folder(folder: Path) -> None:
    # Only where a folder can be opened does its entry need, and allow, to be flushed too.
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _keep_copy(path: Path, backups: Path | None) -> Path | None:
    """Copy a file beside it or into `backups`; returns the path of the copy, or None if that fails."""
    places = [path.with_name(path.name + ".bak")]
    if backups is not None:
        places.append(backups / (path.name + ".bak"))
    for copy in places:
        # A file that was torn while it was written in place is not worth its copy, which is whole.
        if copy.is_file() and not _is_whole(path):
            return copy
        try:
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)
            with open(copy, "rb+") as file:
                _flush(file.fileno())
        except OSError:
            continue
        return copy
    return None


def _is_whole(path: Path) -> bool:
    try:
        json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return False
    return True


def _write_new(path: Path, data: bytes) -> None:
    """Write a file that does not exist yet, whole or not at all. Raises OSError."""
    with open(path, "xb"):
        pass
    try:
        _write_in_place(path, data)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(path)
        raise


def _write_in_place(path: Path, data: bytes) -> None:
    """Write over a file's own bytes and read them back. Raises OSError."""
    # Not cut short first: while it is written, as much as possible of the old content still stands.
    with open(path, "rb+") as file:
        file.write(data)
        file.truncate()
        file.flush()
        _flush(file.fileno())
    if path.read_bytes() != data:
        raise OSError(errno.EIO, "it reads back otherwise than it was written")
