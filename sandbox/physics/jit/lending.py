"""Named tuples of arrays as one pointer: numba's view of bundles, and what kernels lend to those they call.

numba hands a named tuple on as the words of all its arrays, some hundred arguments at every call. A lent one is the
address of these words: whoever made it keeps it, nobody writes to it, and an attribute is read where it is used.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils
from numba.core.datamodel import default_manager
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    infer_getattr,
    intrinsic,
    lower_cast,
    lower_getattr_generic,
    models,
    register_model,
)
from numba.np.arrayobj import populate_array

from sandbox.physics.jit.bundles import HAS_KNOWN_ARRAYS, HEAD_WORDS, SIGNATURES, WORD, Signature

types: Any = numba.types

_CHAR = ir.IntType(8)
# As numba lays an array out; shape and strides have a word for each dimension.
_ARRAY_WORDS = ("meminfo", "parent", "nitems", "itemsize", "data", "shape", "strides")
if default_manager.lookup(types.Array(types.float64, 1, "C"))._fields != _ARRAY_WORDS:
    raise ImportError("this numba lays arrays out in another way")
if not HAS_KNOWN_ARRAYS:
    raise ImportError("this numpy lays arrays out in another way")


class Lent(types.Type):
    """A pointer to the fields of a named tuple, or of a plain one, whose fields have no names."""

    def __init__(self, name: str, fields: Sequence[str], kinds: Sequence[Any]) -> None:
        self.fields, self.kinds = tuple(fields), tuple(kinds)
        self.offsets = [0]
        for kind in kinds:
            self.offsets.append(self.offsets[-1] + _size(kind))
        text = repr((self.fields, list(map(str, kinds))))
        super().__init__(f"Lent{name}{hashlib.blake2b(text.encode(), digest_size=6).hexdigest()}")

    def kind_of(self, field: str) -> Any:
        """The type of a field; None where there is none of this name."""
        return self.kinds[self.fields.index(field)] if field in self.fields else None


def _size(kind: Any) -> int:
    if isinstance(kind, types.Array):
        return WORD * (HEAD_WORDS + 2 * kind.ndim)
    if isinstance(kind, Lent):
        return kind.offsets[-1]
    if isinstance(kind, (types.Integer, types.Float)) and kind.bitwidth == 8 * WORD:
        return WORD
    raise TypeError(f"a named tuple for kernels holds arrays, named tuples, int64 and float64, not {kind}")


def lent(kind: Any) -> Any:
    """The type that a part of a kernel gets for an argument of some type."""
    if isinstance(kind, types.BaseNamedTuple):
        return Lent(kind.instance_class.__name__, kind.fields, [lent(part) for part in kind.types])
    signature = _signature_of(kind)
    return kind if signature is None else _kind_of(signature)


@register_model(Lent)
class _LentModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Lent) -> None:
        # The width tells the size, for the attributes of arguments; odd, so that no other type has it.
        super().__init__(manager, kind, ir.IntType(kind.offsets[-1] + 1).as_pointer())


def mark_arguments(module: Any) -> None:
    """Say in the IR of a module that lent tuples are whole, and that nobody else writes to them or keeps them."""
    for function in module.functions:
        for argument in function.args if function.blocks else ():
            pointed = getattr(argument.type, "pointee", None)
            if isinstance(pointed, ir.IntType) and pointed.width > 1 and pointed.width % WORD == 1:
                argument.attributes.dereferenceable = pointed.width - 1
                known = argument.attributes._known
                for attribute in ("noalias", "captures(none)" if "captures(none)" in known else "nocapture"):
                    argument.attributes.add(attribute)


def _place(builder: Any, pointer: Any, offset: int, kind: Any) -> Any:
    start = builder.bitcast(pointer, _CHAR.as_pointer())
    return builder.bitcast(builder.gep(start, [ir.Constant(ir.IntType(64), offset)], inbounds=True), kind)


def _field(context: Any, builder: Any, kind: Lent, pointer: Any, index: int) -> Any:
    # A nested tuple stays where it is too.
    part, value_type = kind.kinds[index], context.get_value_type(kind.kinds[index])
    if isinstance(part, Lent):
        return _place(builder, pointer, kind.offsets[index], value_type)
    return builder.load(_place(builder, pointer, kind.offsets[index], value_type.as_pointer()))


@infer_getattr
class _LentAttributes(AttributeTemplate):
    key = Lent

    def generic_resolve(self, kind: Lent, attribute: str) -> Any:
        return kind.kind_of(attribute)


@lower_getattr_generic(Lent)
def _lower_attribute(context: Any, builder: Any, kind: Lent, value: Any, attribute: str) -> Any:
    return _field(context, builder, kind, value, kind.fields.index(attribute))


@lower_cast(types.NamedTuple, Lent)
@lower_cast(types.NamedUniTuple, Lent)
def _lend(context: Any, builder: Any, given: Any, wanted: Lent, value: Any) -> Any:
    if not _holds_lent(given):
        # All fields are whole words, so the tuple lies in memory as the words of its fields.
        return builder.bitcast(cgutils.alloca_once_value(builder, value), context.get_value_type(wanted))
    words = cgutils.alloca_once(builder, ir.ArrayType(ir.IntType(64), wanted.offsets[-1] // WORD))
    pointer = builder.bitcast(words, context.get_value_type(wanted))
    _store(context, builder, pointer, 0, given, value)
    return pointer


def _holds_lent(kind: Any) -> bool:
    return isinstance(kind, Lent) or (isinstance(kind, types.BaseTuple) and any(map(_holds_lent, kind.types)))


def lend_to(part: Any) -> None:
    """Let callers lend a part of kernels the named tuples and bundles that they pass to it."""
    resolve = getattr(part, "get_call_template", None)
    if resolve is None:
        return

    def get_call_template(arguments: Any, named: Any) -> Any:
        return resolve([lent(kind) for kind in arguments], {name: lent(kind) for name, kind in named.items()})

    part.get_call_template = get_call_template


@functools.cache
def _kind_of(signature: Signature) -> Any:
    """The numba type of what has this signature."""
    first, *others = signature
    if isinstance(first, str):
        return types.Array(numba.np.numpy_support.from_dtype(np.dtype(first)), others[0], "C")
    fields = getattr(first, "_fields", None)
    return Lent(first.__name__ if fields else "", fields or ("",) * len(others), tuple(map(_kind_of, others)))


def _signature_of(kind: Any) -> Signature | None:
    """What lies in a bundle, by the numba type of its array; None for the type of anything else."""
    fields = getattr(getattr(kind, "dtype", None), "fields", None) if isinstance(kind, types.Array) else None
    return SIGNATURES.get(next(iter(fields))) if fields else None


@lower_cast(types.Array, Lent)
def _lend_bundle(context: Any, builder: Any, given: Any, wanted: Lent, value: Any) -> Any:
    return builder.bitcast(context.make_array(given)(context, builder, value).data, context.get_value_type(wanted))


@intrinsic
def contents(typing_context: Any, bundle: Any) -> Any:
    """The items of a bundle, lent."""
    kind = lent(bundle)
    if not isinstance(kind, Lent):
        return None
    result = kind if all(kind.fields) else types.Tuple(kind.kinds)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer = context.cast(builder, arguments[0], signature.args[0], kind)
        if isinstance(result, Lent):
            return pointer
        items = [_field(context, builder, kind, pointer, k) for k in range(len(kind.kinds))]
        return context.make_tuple(builder, result, items)

    return result(bundle), generate


def _store(context: Any, builder: Any, pointer: Any, offset: int, kind: Any, value: Any) -> None:
    # What was lent is a pointer, also in a tuple, and its words are copied.
    if isinstance(kind, Lent):
        size = ir.Constant(ir.IntType(64), kind.offsets[-1])
        cgutils.raw_memcpy(builder, _place(builder, pointer, offset, _CHAR.as_pointer()), value, size, 1)
    elif isinstance(kind, types.BaseTuple):
        for index, part in enumerate(kind.types):
            _store(context, builder, pointer, offset, part, builder.extract_value(value, index))
            offset += _size(lent(part))
    else:
        builder.store(value, _place(builder, pointer, offset, context.get_value_type(kind).as_pointer()))


@intrinsic(prefer_literal=True)
def put(typing_context: Any, place: Any, field: Any, value: Any) -> Any:
    """Write an array, or a tuple of arrays, where a lent named tuple has the field of that name."""
    if not isinstance(place, Lent) or not isinstance(field, types.StringLiteral):
        return None
    if lent(value) != place.kind_of(field.literal_value):
        raise TypeError(f"{field.literal_value} of {place} is {place.kind_of(field.literal_value)}, not {value}")
    offset = place.offsets[place.fields.index(field.literal_value)]

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        _store(context, builder, arguments[0], offset, value, arguments[2])
        return context.get_dummy_value()

    return types.void(place, field, value), generate


def _array_in(dtype: Any, dimensions: int = 1) -> Any:
    """The intrinsic that makes an array of so many dimensions in the memory of another, an int64 array."""
    kind = types.Array(dtype, dimensions, "C")
    item = ir.Constant(ir.IntType(64), 1 if dtype is types.boolean else dtype.bitwidth // WORD)
    whole = types.int64

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        memory, first, *shape = arguments
        start = builder.gep(context.make_array(signature.args[0])(context, builder, memory).data, [first])
        made = context.make_array(kind)(context, builder)
        strides = [item]
        for width in shape[:0:-1]:
            strides.insert(0, builder.mul(width, strides[0]))
        data = builder.bitcast(start, made.data.type)
        populate_array(made, data=data, shape=shape, strides=strides, itemsize=item, meminfo=None)
        return made._getvalue()

    def of_one(typing_context: Any, memory: Any, first: Any, rows: Any) -> Any:
        return kind(memory, whole, whole), generate

    def of_two(typing_context: Any, memory: Any, first: Any, rows: Any, width: Any) -> Any:
        return kind(memory, whole, whole, whole), generate

    def of_three(typing_context: Any, memory: Any, first: Any, tables: Any, rows: Any, width: Any) -> Any:
        return kind(memory, whole, whole, whole, whole), generate

    return intrinsic((of_one, of_two, of_three)[dimensions - 1])


slots_in, slot_rows_in = _array_in(types.int64), _array_in(types.int64, 2)
floats_in, float_rows_in, float_tables_in = (_array_in(types.float64, dimensions) for dimensions in (1, 2, 3))
flags_in, int32s_in = _array_in(types.boolean), _array_in(types.int32)
