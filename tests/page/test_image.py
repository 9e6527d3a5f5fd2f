"""The image of a block has every array of it, where its words say."""

import struct
from typing import NamedTuple

import numpy as np

from sandbox.page.start import ArrayPlace, image_of


class _Inner(NamedTuple):
    numbers: np.ndarray
    flags: np.ndarray


class _Block(NamedTuple):
    inner: _Inner
    part: np.ndarray
    nothing: np.ndarray


def _array(content: bytes, place: ArrayPlace) -> np.ndarray:
    head = struct.unpack_from(f"<{5 + place.dimensions}q", content, 8 * place.word)
    return np.frombuffer(content, place.dtype.replace("b1", "?"), head[2], head[4]).reshape(head[5:])


def test_every_array_is_where_its_words_say() -> None:
    numbers = np.arange(6.0).reshape(3, 2)
    block = _Block(_Inner(numbers, np.array([True, False])), np.arange(4, dtype=np.int32), np.zeros(0))
    image = image_of(block)
    assert list(image.table) == ["inner.numbers", "inner.flags", "part", "nothing"]
    for path, array in zip(image.table, (numbers, block.inner.flags, block.part, block.nothing), strict=True):
        assert np.array_equal(_array(image.content, image.table[path]), array)


def test_arrays_that_share_memory_share_it_in_the_image() -> None:
    whole = np.arange(5.0)
    image = image_of(_Block(_Inner(whole, np.zeros(1, np.bool_)), whole[2:], np.zeros(0)))
    addresses = [
        struct.unpack_from("<q", image.content, 8 * (image.table[path].word + 4))[0]
        for path in ("inner.numbers", "part")
    ]  # fmt: skip
    assert addresses[1] - addresses[0] == 16
