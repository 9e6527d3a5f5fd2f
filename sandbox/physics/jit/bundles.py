"""Bundles: many arrays as one array of the words that say where they lie, which compiled kernels take as one argument.

An array is these words: two of 0, number of items, bytes of an item, address, and a word of shape and
one of strides for each dimension. A named tuple is the words of its fields, one after another.
"""

import ctypes
import functools
import hashlib
import struct
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

WORD = 8
# Words of an array beside those of its shape and strides.
HEAD_WORDS = 5
# Where an array keeps the address of its data: first thing after the head of every object. What numpy says of it comes
# as a dictionary, at four times the cost.
_ADDRESS = object.__basicsize__
_address_at = ctypes.c_size_t.from_address
_probe = np.zeros(1)
HAS_KNOWN_ARRAYS = _address_at(id(_probe) + _ADDRESS).value == _probe.ctypes.data

# What lies in a bundle: of an array its dtype and dimensions, of a tuple its class and what lies in it.
Signature = tuple[Any, ...]


class _Packed(NamedTuple):
    """The entry of an array or a tuple in a bundle: its words and signature, and the parts of a tuple."""

    item: Any
    words: bytes
    signature: Signature
    parts: tuple["_Packed", ...]


class _Words(bytearray):
    """The words of a bundle, with the arrays that they are addresses of, which live as long.

    whole: the arrays that it was made of; memories: in which kernels put others.
    """

    whole: _Packed
    memories: list[Any]


def owner_of(bundle: Any) -> Any:
    """The object that keeps alive the items of a bundle: `whole.item`."""
    base: Any = bundle.base
    return base.obj if isinstance(base, memoryview) else base


def _part(item: Any, like: _Packed | None) -> _Packed:
    """The part of an item; like: another item, whose arrays may be the same."""
    if like is not None and like.item is item:
        return like
    if isinstance(item, np.ndarray):
        if not item.flags.c_contiguous:
            raise TypeError("arrays in a bundle are contiguous")
        address = _address_at(id(item) + _ADDRESS).value
        words = _format(item.ndim).pack(0, 0, item.size, item.itemsize, address, *item.shape, *item.strides)
        return _Packed(item, words, (item.dtype.str, item.ndim), ())
    if not isinstance(item, tuple):
        raise TypeError(f"a bundle holds arrays and tuples of them, not {type(item).__name__}")
    known = like.parts if like is not None and len(like.parts) == len(item) else (None,) * len(item)
    parts = tuple(map(_part, item, known))
    signature = type(item), *(part.signature for part in parts)
    return _Packed(item, b"".join([part.words for part in parts]), signature, parts)


@functools.cache
def _format(dimensions: int) -> struct.Struct:
    return struct.Struct(f"={HEAD_WORDS + 2 * dimensions}q")


def signature_text(signature: Signature) -> str:
    """The layout of a bundle in words that stay the same from process to process."""
    first, *others = signature
    if isinstance(first, str):
        return f"{first}{others[0]}"
    return f"{first.__name__}{getattr(first, '_fields', '')}({', '.join(map(signature_text, others))})"


@functools.cache
def dtype_of(name: str, words: int) -> np.dtype[Any]:
    """The dtype of a bundle of so many words: one and the same object for every bundle of a name."""
    return np.dtype([(name, np.int64, (words,))])


def name_of(signature: Signature) -> str:
    """The name in bundles of arrays with this layout."""
    digest = hashlib.blake2b(signature_text(signature).encode(), digest_size=6).hexdigest()
    return f"{'' if signature[0] is tuple else signature[0].__name__}{digest}"


@functools.cache
def _dtype(signature: Signature, words: int) -> np.dtype[Any]:
    return dtype_of(name_of(signature), words)


def bundle(items: tuple[Any, ...], like: Any = None) -> Any:
    """One array with the addresses of all the arrays in `items`, which a kernel takes at the cost of one.

    like: a bundle whose items some of these are; their addresses are taken from there.

    Raises:
        TypeError: for what is neither array nor tuple, and for arrays that are not contiguous.
    """
    whole = _part(items, None if like is None else owner_of(like).whole)
    owner = _Words(whole.words)
    owner.whole, owner.memories = whole, []
    return np.frombuffer(owner, dtype=_dtype(whole.signature, len(owner) // WORD))


def hold(bundle: Any, memory: Any) -> None:
    """Keep an array of words alive as long as a bundle: what kernels set in the bundle lies in it."""
    memories = owner_of(bundle).memories
    if not any(memory is one for one in memories):
        memories.append(memory)


def items_of(bundle: Any, path: tuple[str, ...] = ()) -> Any:
    """The items of a bundle as they are now: what kernels put there is an item of it, or lies in what it holds.

    path: names of fields that lead to the tuple that is wanted.
    """
    owner = owner_of(bundle)
    start, part = 0, owner.whole
    for name in path:
        place = part.item._fields.index(name)
        start += sum(len(other.words) for other in part.parts[:place]) // WORD
        part = part.parts[place]
    given = {packed.words: packed.item for packed in _arrays_in(owner.whole)}
    return _item_at(start, np.frombuffer(owner, np.int64), part, given, owner.memories)


def _arrays_in(packed: _Packed) -> Iterator[_Packed]:
    if not packed.parts:
        yield packed
    for part in packed.parts:
        yield from _arrays_in(part)


def _item_at(start: int, words: Any, was: _Packed, given: dict[bytes, Any], memories: Sequence[Any]) -> Any:
    present = words[start : start + len(was.words) // WORD]
    if present.tobytes() == was.words:
        return was.item
    if not was.parts:
        found = given.get(present.tobytes())
        return _array_at(present.tolist(), was.signature, memories) if found is None else found
    items = []
    for part in was.parts:
        items.append(_item_at(start, words, part, given, memories))
        start += len(part.words) // WORD
    return was.item._make(items) if hasattr(was.item, "_make") else tuple(items)


def _array_at(words: list[int], signature: Signature, memories: Sequence[Any]) -> Any:
    dtype, dimensions = signature
    size, address, shape = words[2] * words[3], words[4], words[HEAD_WORDS : HEAD_WORDS + dimensions]
    if size == 0:
        return np.zeros(shape, dtype)
    for memory in memories:
        begin = address - memory.ctypes.data
        if 0 <= begin <= memory.nbytes - size:
            return memory.view(np.uint8)[begin : begin + size].view(dtype).reshape(shape)
    raise ValueError(f"an array of {size} bytes lies in none of the memories")
