"""All kernels that entries call, as one text of C++."""

import ast
import inspect
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from sandbox.physics.jit import KERNELS, Kernel
from sandbox.physics.jit.translate.cpp_types import (
    FLAG,
    FLOAT,
    INTEGER,
    NOTHING,
    Array,
    BundleType,
    Constant,
    NoType,
    Several,
    Struct,
    Type,
    Types,
    Untranslatable,
    definition,
    fits,
)
from sandbox.physics.jit.translate.expressions import spelled, written
from sandbox.physics.jit.translate.statements import Body

_RUNTIME = Path(__file__).with_name("runtime.h")


@dataclass(frozen=True)
class Signature:
    """The parameters of a kernel, by name, and its result."""

    takes: tuple[tuple[str, Type], ...]
    gives: Type


@dataclass(frozen=True)
class _Function:
    """A kernel in C++, and the kernels that it calls."""

    text: str
    calls: tuple[Kernel, ...]


class Translation:
    """The kernels that some entries call, translated. Raises Untranslatable."""

    def __init__(self, entries: Iterable[Kernel]) -> None:
        self._types = Types()
        self._spaces = _spaces({kernel.function.__module__ for kernel in KERNELS})
        self._signatures: dict[Kernel, list[Signature]] = {}
        self._constants: dict[tuple[str, str], Constant] = {}
        self._functions: dict[Kernel, _Function] = {}
        self._calls: dict[Kernel, None] = {}
        self.entries = list(entries)
        self._order: list[Kernel] = []
        for entry in self.entries:
            self._visit(entry, ())

    # What expressions ask

    def struct(self, kind: type) -> Struct:
        """The struct of a class of named tuples."""
        return self._types.struct(kind)

    def constant(self, constant: Constant) -> None:
        """Take note that a constant is used."""
        self._constants[constant.module, constant.name] = constant

    def name_of(self, module: str, within: str, name: str) -> str:
        """A module's name as C++ spells it within another module."""
        return spelled(name) if module == within else f"{self._spaces.get(module, _space(module))}::{spelled(name)}"

    def called(self, kernel: Kernel, arguments: Sequence[Type]) -> Type | str:
        """The result type of a kernel for such arguments, or why it does not take them."""
        self._calls[kernel] = None
        why = ""
        for signature in self.signatures(kernel):
            if len(signature.takes) != len(arguments):
                return f"it takes {len(signature.takes)} arguments"
            pairs = zip(signature.takes, arguments, strict=True)
            wrong = next(((name, kind, given) for (name, kind), given in pairs if not fits(given, kind)), None)
            if wrong is None:
                return signature.gives
            why = f"{wrong[0]} is {wrong[1].cpp}, given {wrong[2].cpp}"
        return why

    def signatures(self, kernel: Kernel) -> list[Signature]:
        """Signatures of a kernel: several, where an argument is one of several kinds. Raises Untranslatable."""
        if kernel not in self._signatures:
            function = kernel.function
            line = function.__code__.co_firstlineno
            hints = get_type_hints(function, include_extras=True)
            names = list(inspect.signature(function).parameters)
            missing = [name for name in (*names, "return") if name not in hints]
            if missing:
                raise Untranslatable(function.__module__, line, f"{function.__name__}: {missing[0]} has no annotation")
            try:
                choices = [[(name, kind) for kind in self._kinds(hints[name])] for name in names]
                gives = self._types.of(hints["return"])
            except NoType as fault:
                raise Untranslatable(
                    function.__module__, line, f"{function.__name__}: {fault} is no type of kernels"
                ) from None
            self._signatures[kernel] = [Signature(takes, gives) for takes in itertools.product(*choices)]
        return self._signatures[kernel]

    def _kinds(self, hint: Any) -> list[Type]:
        """The types that a parameter may have; of a union those that kernels know."""
        choices = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
        known = []
        for choice in choices:
            try:
                known.append(self._types.of(choice))
            except NoType:
                if len(choices) == 1:
                    raise
        return known

    # Functions

    def _visit(self, kernel: Kernel, above: tuple[Kernel, ...]) -> None:
        if kernel in above:
            raise Untranslatable(
                kernel.function.__module__, kernel.function.__code__.co_firstlineno, "a kernel calls itself"
            )
        if kernel in self._functions:
            return
        made = self._functions[kernel] = self._translated(kernel)
        for called in made.calls:
            self._visit(called, (*above, kernel))
        self._order.append(kernel)

    def _translated(self, kernel: Kernel) -> _Function:
        node = definition(kernel)
        self._calls = {}
        texts = [self._text(kernel, node, signature) for signature in self.signatures(kernel)]
        return _Function("\n".join(texts), tuple(self._calls))

    def _text(self, kernel: Kernel, node: ast.FunctionDef, signature: Signature) -> str:
        module = kernel.function.__module__
        body = Body(self, module, node, dict(signature.takes), signature.gives)
        lines = body.lines()
        stored = {each.id for each in ast.walk(node) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)}
        taken = ", ".join(_parameter(name, kind, name in stored) for name, kind in signature.takes)
        said = [f"// {line}" if line else "//" for line in (ast.get_docstring(node) or "").splitlines()]
        where = f"// {module.replace('.', '/')}.py:{node.lineno}"
        inlined = "inline __attribute__((always_inline)) " if kernel.role == "inlined_kernel" else ""
        head = f"static {inlined}{signature.gives.cpp} {spelled(node.name)}({taken}) {{"
        return "\n".join([*said, where, head, *lines, "}"])

    # The whole text

    def text(self) -> str:
        """The whole program in C++: kernels, and their entries."""
        return "\n\n".join([self.kernels_text(), *map(self._entry_text, self.entries)]) + "\n"

    def kernels_text(self) -> str:
        """Text of the kernels alone, callees before callers."""
        parts = [_RUNTIME.read_text(encoding="utf-8"), *map(_struct_text, self._types.structs.values())]
        for module in sorted({constant.module for constant in self._constants.values()}):
            own = [constant for constant in self._constants.values() if constant.module == module]
            lines = [_constant_text(constant) for constant in sorted(own, key=lambda each: each.name)]
            parts.append(self._in_space(module, "\n".join(lines)))
        for module, kernels in itertools.groupby(self._order, lambda kernel: kernel.function.__module__):
            parts.append(self._in_space(module, "\n\n".join(self._functions[kernel].text for kernel in kernels)))
        return "\n\n".join(parts)

    def _in_space(self, module: str, text: str) -> str:
        return f"namespace {self._spaces.get(module, _space(module))} {{\n\n{text}\n\n}}"

    def _entry_text(self, entry: Kernel) -> str:
        function = entry.function
        (signature,) = self.signatures(entry)
        given, word = [], 0
        for _, kind in signature.takes:
            given.append(f"argument<{kind.cpp}>(block + {word})")
            word += words_of(kind)
        call = f"{self._spaces[function.__module__]}::{spelled(function.__name__)}({', '.join(given)})"
        result = f"{call};\n    block[0] = 0;" if signature.gives == NOTHING else f"give(block, {call});"
        return f"KERNELS_ENTRY({symbol_of(entry)}) {{\n    {result}\n    return 0;\n}}"


def symbol_of(entry: Kernel) -> str:
    """The symbol of an entry in a library."""
    return entry.name.partition(".")[2].replace(".", "_")


def words_of(kind: Type) -> int:
    """How many words an argument is, as bundles.py lays it out."""
    if isinstance(kind, Array):
        return 5 + 2 * kind.dimensions
    if isinstance(kind, BundleType):
        return 7
    if isinstance(kind, Struct):
        return sum(words_of(each) for _, each in kind.fields)
    if isinstance(kind, Several):
        return sum(map(words_of, kind.items))
    return 1


def _space(module: str) -> str:
    return spelled(module.rpartition(".")[2])


def _spaces(modules: set[str]) -> dict[str, str]:
    """A namespace for each module: its last name, with that of its folder where another has the same."""
    last = [_space(module) for module in modules]
    return {
        module: _space(module) if last.count(_space(module)) == 1 else "_".join(module.split(".")[-2:])
        for module in modules
    }


def _parameter(name: str, kind: Type, stored: bool) -> str:
    by_value = stored or kind in (FLAG, INTEGER, FLOAT)
    return f"{kind.cpp} {spelled(name)}" if by_value else f"const {kind.cpp} &{spelled(name)}"


def _struct_text(struct: Struct) -> str:
    said = [f"// {line}" if line else "//" for line in (inspect.getdoc(struct.kind) or "").splitlines()]
    fields = [f"    {kind.cpp} {spelled(name)};" for name, kind in struct.fields]
    return "\n".join([*said, f"struct {struct.cpp} {{", *fields, "};"])


def _constant_text(constant: Constant) -> str:
    value = constant.value
    if isinstance(value, bool):
        return f"constexpr bool {spelled(constant.name)} = {'true' if value else 'false'};"
    if isinstance(value, int):
        return f"constexpr int64_t {spelled(constant.name)} = {value};"
    return f"constexpr double {spelled(constant.name)} = {written(value)};"
