"""Kernels that are linked once: a part stays as it was lowered until an entry gathers all that it calls.

numba links the finished module of each callee into each caller, optimises the whole again and makes machine code of it
again, at every level of a tree of calls. Here a part is neither optimised as a module nor made machine code, and an
entry links every part below it once.

Nor does an index count from the end in any of them: numba would ask that of each signed one wherever it is used, a
quarter of the time of inner loops, which LLVM then does not vectorise.
"""

from __future__ import annotations

import functools
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
from numba.core import compiler, lowering, typed_passes, typing
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_machinery import register_pass
from numba.core.environment import lookup_environment

from sandbox.physics.jit.lending import mark_arguments

types: Any = numba.types

_ENVIRONMENT = "_ZN08NumbaEnv"


class _WithoutEnvironments:
    """Code generation for a part, which has no address yet at which its environment could be set."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def set_env(self, name: str, environment: Any) -> None:
        pass

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)


class _PartLibrary(JITCodeLibrary):
    @property
    def codegen(self) -> Any:
        return _WithoutEnvironments(self._codegen)

    def add_ir_module(self, ir_module: Any) -> None:
        mark_arguments(ir_module)
        super().add_ir_module(ir_module)

    def finalize(self) -> None:
        self._raise_if_finalized()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0


class _EntryLibrary(JITCodeLibrary):
    def finalize(self) -> None:
        self._raise_if_finalized()
        self._codegen._check_llvm_bugs()
        for library in libraries_below(self):
            if hasattr(self, "_reload_init"):  # from numba 0.62 on
                self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        # Nobody else calls them: arguments that are not used go, and what is called once is inlined.
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == llvm.Linkage.linkonce_odr:
                function.linkage = "internal"
        self._optimize_final_module()
        self._final_module.verify()
        self._finalize_final_module()
        for variable in self._final_module.global_variables:
            environment = lookup_environment(variable.name) if variable.name.startswith(_ENVIRONMENT) else None
            if environment is not None:
                self._codegen.set_env(variable.name, environment)

    def serialize_using_object_code(self) -> Any:
        """What is kept of it: machine code, and the names that it defines. Nobody links an entry, as others are."""
        try:
            return self.name, "object", (self._get_compiled_object(), _outline(self._final_module))
        except AttributeError:
            return super().serialize_using_object_code()


def libraries_below(library: Any) -> list[Any]:
    """The code of all that a part or an entry calls, in the order in which it is linked."""
    found, waiting = {}, list(library._linking_libraries)
    while waiting:
        one = waiting.pop(0)
        if one not in found:
            found[one] = True
            if isinstance(one, _PartLibrary):
                waiting.extend(one._linking_libraries)
    return list(found)


def _outline(module: Any) -> bytes:
    """A module that defines the same names for others, and does nothing: ten times sooner loaded than the whole."""
    own = ("internal", "private")
    lines = [f'target triple = "{module.triple}"', f'target datalayout = "{module.data_layout}"']
    for form, values in (
        ("define void @{} () {{ unreachable }}", module.functions),
        ("@{} = global i8 0", module.global_variables),
    ):
        names = [value.name for value in values if not value.is_declaration and value.linkage.name not in own]
        lines += [form.format(f'"{name}"') for name in names]
    return bytes(llvm.parse_assembly("\n".join(lines)).as_bitcode())


def _from_front(kind: Any) -> Any:
    """The type of an index as one that does not count from the end."""
    if isinstance(kind, types.BaseTuple):
        return types.Tuple([_from_front(part) for part in kind])
    if isinstance(kind, types.IntegerLiteral):
        return kind if kind.literal_value < 0 else types.uintp
    return types.uintp if isinstance(kind, types.Integer) else kind


def _taking_from_front(signature: Any) -> Any:
    base, index, *others = signature.args
    if not isinstance(base, types.Array):
        return signature
    return typing.signature(signature.return_type, base, _from_front(index), *others)


class _Lower(lowering.Lower):
    """Code for indices that do not count from the end, but for a constant below 0."""

    def lower_getitem(self, resty: Any, expr: Any, value: Any, index: Any, signature: Any) -> Any:
        return super().lower_getitem(resty, expr, value, index, _taking_from_front(signature))

    def lower_setitem(self, target_var: Any, index_var: Any, value_var: Any, signature: Any) -> Any:
        return super().lower_setitem(target_var, index_var, value_var, _taking_from_front(signature))


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(typed_passes.NativeLowering):
    _name = "lowering_without_wraparound"

    @property
    def lowering_class(self) -> Any:
        return _Lower


class _PartCompiler(compiler.Compiler):
    library: type[JITCodeLibrary] = _PartLibrary

    def define_pipelines(self) -> Any:
        self.state.library = self.library(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        self.state.library.enable_object_caching()
        managers = super().define_pipelines()
        for manager in managers:
            manager.passes = [
                (_Lowering if each is typed_passes.NativeLowering else each, about) for each, about in manager.passes
            ]
        return managers


class _EntryCompiler(_PartCompiler):
    library = _EntryLibrary


def _tried_out() -> float:
    """What a small entry gives that calls parts, which call parts."""
    part = numba.njit(pipeline_class=_PartCompiler, no_cpython_wrapper=True, no_cfunc_wrapper=True, error_model="numpy")

    @part
    def least(values: Any) -> Any:
        if values.shape[0] == 0:
            raise ValueError("no values")
        return values[0]

    @part
    def spread(values: Any) -> Any:
        return values[values.shape[0] - 1] - least(values)

    @numba.njit(pipeline_class=_EntryCompiler, error_model="numpy")
    def entry(values: Any) -> Any:
        return spread(values) + 0.5 * least(values)

    return float(entry(np.array([1.0, 3.0, 7.0])))


@functools.cache
def links_once() -> bool:
    """Whether this numba can: the linker uses inner parts that another version may not have."""
    try:
        return _tried_out() == 6.5
    except Exception:
        return False


class PartCompiler(_PartCompiler):
    """For what kernels alone call."""

    def define_pipelines(self) -> Any:
        """numba's passes, with a library of its own where that works."""
        return super().define_pipelines() if links_once() else compiler.Compiler.define_pipelines(self)


class EntryCompiler(_EntryCompiler):
    """For what Python calls."""

    def define_pipelines(self) -> Any:
        """numba's passes, with a library of its own where that works."""
        return super().define_pipelines() if links_once() else compiler.Compiler.define_pipelines(self)
