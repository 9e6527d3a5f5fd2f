"""Picture: the name of a PNG that lies beside a level's file, with what is in it once that was read."""

import os
import stat
import struct
import zlib
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, WrapValidator
from pydantic_core.core_schema import ValidatorFunctionWrapHandler

from sandbox.level.format.limits import TEXT_LIMIT
from sandbox.level.format.writing import refusal_of

# Bytes of a file, and pixels of a side.
PICTURE_LIMIT, SIDE_LIMIT = 1024 * 1024, 2048
SIGNATURE = b"\x89PNG\r\n\x1a\n"
NAME_PATTERN = r"^[^/\\:.\x00-\x1f\x7f-\x9f][^/\\:\x00-\x1f\x7f-\x9f]*\.[pP][nN][gG]$"
NAMED = 'name a PNG that lies beside the level\'s file, such as "cat.png", without folders'


class Picture(str):
    """The name of a picture; data: the bytes of its file, None = not read; path: from where, "" = no file.

    Copies of a level share it, so that the picture goes where the body goes.
    """

    data: bytes | None
    path: str

    def __new__(cls, name: str, data: bytes | None = None, path: str = "") -> "Picture":
        """A picture of a name."""
        made = super().__new__(cls, name)
        made.data, made.path = data, path
        return made

    def __eq__(self, other: object) -> bool:
        """Whether the names are the same, and what is in both, where both were read."""
        theirs = other.data if isinstance(other, Picture) else None
        return (
            isinstance(other, str) and str(self) == str(other) and (None in (self.data, theirs) or self.data == theirs)
        )

    def __ne__(self, other: object) -> bool:
        """Whether names or pictures differ."""
        return not self == other

    __hash__ = str.__hash__


class NoPicture(ValueError):
    """A file that is no picture to wear; its text is one line, to be read after the file's name."""


def _kept(value: Any, check: ValidatorFunctionWrapHandler) -> Any:
    # The library would make a plain text of it.
    name = check(value)
    return value if isinstance(value, Picture) else Picture(name)


PictureName = Annotated[
    str,
    Field(max_length=TEXT_LIMIT, pattern=NAME_PATTERN),
    WrapValidator(_kept),
]


def read_picture(path: Path) -> Picture:
    """Read a picture from a file. Raises NoPicture."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise NoPicture("is no file")
        with open(path, "rb") as file:
            data = file.read(PICTURE_LIMIT + 1)
    except FileNotFoundError:
        raise NoPicture("there is no such file") from None
    except (OSError, ValueError) as error:
        raise error if isinstance(error, NoPicture) else NoPicture(f"cannot be read: {refusal_of(error)}") from None
    check_picture(data)
    return Picture(path.name, data, os.path.realpath(path))


def check_picture(data: bytes) -> None:
    """Check the bytes of a PNG without unpacking its pixels. Raises NoPicture."""
    if len(data) > PICTURE_LIMIT:
        raise NoPicture(f"is larger than {PICTURE_LIMIT // 1024 // 1024} MiB; make it smaller")
    if not data.startswith(SIGNATURE):
        raise NoPicture("is no PNG")
    kinds, at = list[bytes](), len(SIGNATURE)
    while at < len(data) and kinds[-1:] != [b"IEND"]:
        size, kind = struct.unpack(">I4s", data[at : at + 8].ljust(8, b"\0"))
        end = at + 12 + size
        if end > len(data) or zlib.crc32(data[at + 4 : end - 4]) != int.from_bytes(data[end - 4 : end]):
            break
        kinds.append(kind)
        at = end
    if kinds[:1] != [b"IHDR"] or kinds[-1:] != [b"IEND"] or b"IDAT" not in kinds:
        raise NoPicture("is a damaged PNG")
    width, height = size_of(data)
    if not (0 < width <= SIDE_LIMIT and 0 < height <= SIDE_LIMIT):
        raise NoPicture(f"has {width:,} x {height:,} pixels; a side may have 1 to {SIDE_LIMIT:,}")


def size_of(data: bytes) -> tuple[int, int]:
    """Width and height [pixels] of a PNG that was checked."""
    width, height = struct.unpack(">II", data[16:24])
    return width, height
