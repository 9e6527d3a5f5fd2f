"""Gathering: what numba makes of every entry and the parts below it, as one module of LLVM, not yet optimised."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import llvmlite.binding as llvm
import numba

from sandbox.physics.jit import compiled
from sandbox.physics.jit.linking import libraries_below

types: Any = numba.types

_GIVES = {types.none: "nothing", types.int64: "integer", types.float64: "float", types.boolean: "flag"}
_SCALARS = {types.int64: "integer", types.float64: "float", types.boolean: "flag"}


@dataclass(frozen=True)
class EntryCode:
    """One entry in gathered code.

    name: its kernel's. function: what it is called in the module; symbol: what it is to be called in a library.
    arguments: a form for each, as `library.py` reads them. gives: the form of its result.
    """

    name: str
    function: str
    arguments: tuple[Any, ...]
    gives: str

    @property
    def symbol(self) -> str:
        """A name that C can say."""
        return self.name.partition(".")[2].replace(".", "_")


def _form(kind: Any) -> Any:
    """The form of an argument by its numba type."""
    if kind in _SCALARS:
        return _SCALARS[kind]
    if isinstance(kind, types.Array):
        fields = getattr(kind.dtype, "fields", None)
        if fields:
            return ["bundle", next(iter(fields)), kind.dtype.size // 8]
        return ["array", numba.np.numpy_support.as_dtype(kind.dtype).str, kind.ndim]
    if isinstance(kind, types.BaseTuple):
        return ["tuple", *map(_form, kind.types)]
    raise TypeError(f"entries of libraries take no {kind}")


def gather(entries: Sequence[tuple[Any, tuple[Any, ...]]]) -> tuple[bytes, list[EntryCode]]:
    """The bitcode of one module that holds all of these kernels, each for the numba types of its arguments.

    Raises:
        TypeError: for an argument or a result that has no form in a library.
    """
    libraries: dict[Any, None] = {}
    codes = []
    for kernel, signature in entries:
        result = compiled.lowered(kernel, signature)
        libraries |= dict.fromkeys([result.library, *libraries_below(result.library)])
        gives = result.signature.return_type
        if gives not in _GIVES:
            raise TypeError(f"{kernel.name} gives {gives}, which has no form in a library")
        forms = tuple(map(_form, signature))
        codes.append(EntryCode(kernel.name, result.fndesc.llvm_func_name, forms, _GIVES[gives]))
    whole = llvm.parse_assembly("")
    for library in libraries:
        module = llvm.parse_bitcode(library._get_module_for_linking().as_bitcode())
        for function in module.functions:
            # Else a part would be left out that nothing linked so far calls.
            if not function.is_declaration:
                function.linkage = "weak_odr"
        whole.link_in(module)
    return bytes(whole.as_bitcode()), codes
