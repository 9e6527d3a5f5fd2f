"""Image: the arrays of a block as bytes for a memory of their own, and a table of where the words of each are."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit.bundles import HEAD_WORDS, WORD

# Where arrays begin [bytes].
ALIGNED = 16
# Smaller arrays [bytes] are not looked at for being copies.
LEAST_COPY = 64


class ArrayPlace(NamedTuple):
    """Where an array of a block is: the first of its words, its dtype as numpy writes it, and its dimensions."""

    word: int
    dtype: str
    dimensions: int


class Image(NamedTuple):
    """A block as bytes: its words, then its arrays; addresses count from the first byte. table: by path of the array.

    copies: of arrays that are as another one is, where to and from, and how many bytes; content has zeros there.
    """

    content: bytes
    table: dict[str, ArrayPlace]
    copies: list[tuple[int, int, int]]


def image_of(block: tuple[Any, ...]) -> Image:
    """The image of a named tuple of contiguous arrays and of such tuples; arrays that share memory share it there."""
    arrays = dict(arrays_of(block))
    table, words = {}, 0
    for path, array in arrays.items():
        table[path] = ArrayPlace(words, array.dtype.str.lstrip("<|"), array.ndim)
        words += HEAD_WORDS + 2 * array.ndim
    where, content = _laid_out(list(arrays.values()), _aligned(WORD * words))
    values = [value for array in arrays.values() for value in _words(array, where)]
    content[: WORD * words] = np.array(values, "<i8").tobytes()
    copies = _leave_out_copies(list(arrays.values()), where, content)
    return Image(bytes(content), table, copies)


def _leave_out_copies(
    arrays: list[NDArray[Any]], where: dict[int, int], content: bytearray
) -> list[tuple[int, int, int]]:
    first: dict[bytes, int] = {}
    copies = []
    for array in arrays:
        held, place = array.tobytes(), where.get(array.ctypes.data, 0)
        if len(held) < LEAST_COPY or not any(held) or first.setdefault(held, place) == place:
            continue
        copies.append((place, first[held], len(held)))
        content[place : place + len(held)] = bytes(len(held))
    return copies


def arrays_of(item: Any, path: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """The arrays of a named tuple of such and of named tuples, by their paths."""
    if isinstance(item, np.ndarray):
        yield path, item
        return
    for name, part in zip(item._fields, item, strict=True):
        yield from arrays_of(part, f"{path}.{name}" if path else name)


def _laid_out(arrays: list[NDArray[Any]], end: int) -> tuple[dict[int, int], bytearray]:
    """Where in an image each address here is, and the image with all arrays; end [bytes]: where there is room."""
    where: dict[int, int] = {}
    content = bytearray(end)
    reached = start = 0
    for array in sorted((array for array in arrays if array.nbytes), key=lambda array: array.ctypes.data):
        first = array.ctypes.data
        if first >= reached:
            start, end = first, _aligned(len(content))
        reached = max(reached, first + array.nbytes)
        where[first] = end + first - start
        content.extend(bytes(max(0, end + reached - start - len(content))))
        content[where[first] : where[first] + array.nbytes] = array.tobytes()
    return where, content


def _aligned(size: int) -> int:
    return -(-size // ALIGNED) * ALIGNED


def _words(array: NDArray[Any], where: dict[int, int]) -> tuple[int, ...]:
    return 0, 0, array.size, array.itemsize, where.get(array.ctypes.data, 0), *array.shape, *array.strides
