"""recorded_array: what a recording holds of an array of which it keeps only a hash, where one number differs."""

import hashlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.snapshot import canonical_bytes

# Bytes that are hashed before it is given up: a second or two.
_MOST_WORK = 1_500_000_000
# Neighbours of a number that are tried, in units of its last place.
_NEIGHBOURS = 8


def recorded_array(found: NDArray[Any], fits: Callable[[str], bool]) -> NDArray[Any] | None:
    """The array that differs from the one found in a single number, by a few last places or in one bit; else None.

    fits: whether an array whose hash has these digits (see `hash_by_array`) is the recorded one.
    """
    data, size = canonical_bytes(found), found.dtype.itemsize
    numbers = np.frombuffer(data, dtype=f"<u{size}")
    work = 0
    for change in _changes(8 * size):
        changed = change(numbers)
        before = hashlib.blake2b(digest_size=8)
        for place, number in enumerate(changed):
            end = (place + 1) * size
            attempt = before.copy()
            attempt.update(number.tobytes() + data[end:])
            if fits(attempt.hexdigest()):
                wanted = numbers.copy()
                wanted[place] = number
                return wanted.view(found.dtype.newbyteorder("<")).astype(found.dtype).reshape(found.shape)
            before.update(data[end - size : end])
            work += len(data) - end + size
            if work > _MOST_WORK:
                return None
    return None


def _changes(bits: int) -> Iterator[Callable[[NDArray[Any]], NDArray[Any]]]:
    """What may have become of numbers of this many bits, read as unsigned, the likeliest first."""

    def moved(step: int) -> Callable[[NDArray[Any]], NDArray[Any]]:
        return lambda numbers: numbers + numbers.dtype.type(step % 2**bits)

    def flipped(bit: int) -> Callable[[NDArray[Any]], NDArray[Any]]:
        return lambda numbers: numbers ^ numbers.dtype.type(1 << bit)

    yield moved(1)
    yield moved(-1)
    yield from (flipped(bit) for bit in range(bits))
    yield from (moved(sign * step) for step in range(2, _NEIGHBOURS + 1) for sign in (1, -1))
