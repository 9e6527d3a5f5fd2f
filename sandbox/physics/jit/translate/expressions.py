"""Expressions of kernels as C++, with their types."""

import ast
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from sandbox.physics.arrays import layout_of
from sandbox.physics.jit import Kernel, interpreted, kernel_of
from sandbox.physics.jit.translate.cpp_types import (
    FLAG,
    FLOAT,
    INTEGER,
    ITEMS,
    Array,
    BundleType,
    Constant,
    Scalar,
    Several,
    Struct,
    Type,
    Untranslatable,
    fits,
    joined,
    meaning,
)

# How closely parts of an expression hang together in C++, the looser the lower.
PRIMARY, UNARY, PRODUCT, SUM, SHIFT, ORDER, EQUALITY, BITS_AND, BITS_XOR, BITS_OR, AND, OR, CHOICE = range(12, -1, -1)

_ARITHMETIC: dict[type, tuple[str, int]] = {
    ast.Add: ("+", SUM), ast.Sub: ("-", SUM), ast.Mult: ("*", PRODUCT), ast.Div: ("/", PRODUCT),
    ast.LShift: ("<<", SHIFT), ast.RShift: (">>", SHIFT), ast.BitAnd: ("&", BITS_AND), ast.BitXor: ("^", BITS_XOR),
    ast.BitOr: ("|", BITS_OR),
}  # fmt: skip
_OF_INTEGERS = (ast.LShift, ast.RShift, ast.BitAnd, ast.BitXor, ast.BitOr)
_ROUNDED = {ast.FloorDiv: "py::floordiv", ast.Mod: "py::mod"}
_ORDERS: dict[type, tuple[str, int]] = {
    ast.Lt: ("<", ORDER), ast.LtE: ("<=", ORDER), ast.Gt: (">", ORDER), ast.GtE: (">=", ORDER),
    ast.Eq: ("==", EQUALITY), ast.NotEq: ("!=", EQUALITY),
}  # fmt: skip
_OF_MATH: dict[Any, tuple[str, Scalar]] = {
    math.sqrt: ("py::sqrt", FLOAT), math.floor: ("py::floor", INTEGER), math.ceil: ("py::ceil", INTEGER),
}  # fmt: skip
# What lies in the memory of an arena: the type of its items, and how many dimensions it has.
_LYING = {
    interpreted.slots_in: ("int64", 1), interpreted.slot_rows_in: ("int64", 2), interpreted.floats_in: ("float64", 1),
    interpreted.float_rows_in: ("float64", 2), interpreted.float_tables_in: ("float64", 3),
    interpreted.flags_in: ("bool", 1), interpreted.int32s_in: ("int32", 1),
}  # fmt: skip
# Names that are words of C++.
_WORDS = frozenset((
    "and", "auto", "bool", "case", "catch", "char", "class", "const", "default", "delete", "do", "double", "enum",
    "explicit", "export", "extern", "float", "friend", "goto", "inline", "int", "long", "namespace", "new", "not",
    "operator", "or", "private", "protected", "public", "register", "short", "signed", "sizeof", "static", "struct",
    "switch", "template", "this", "throw", "try", "typedef", "typename", "union", "unsigned", "using", "virtual",
    "void", "volatile",
))  # fmt: skip


def spelled(name: str) -> str:
    """A name of Python as one of C++."""
    return f"{name}_" if name in _WORDS else name


@dataclass(frozen=True)
class Code:
    """An expression in C++; hangs: how closely its parts hang together; stays: it is there before and afterwards."""

    text: str
    type: Type
    hangs: int = PRIMARY
    stays: bool = False

    def within(self, hangs: int) -> str:
        """The code inside a larger expression: in parentheses where its operator binds less closely than `hangs`."""
        return self.text if self.hangs >= hangs else f"({self.text})"


class Unknown(Exception):
    """The type of a local name is not known yet."""


class Program(Protocol):
    """What the translation of an expression needs to know of other kernels."""

    def called(self, kernel: Kernel, arguments: Sequence[Type]) -> Type | str:
        """The result type of a kernel for such arguments, or why it does not take them."""
        ...

    def name_of(self, module: str, within: str, name: str) -> str:
        """A module's name as C++ spells it within another module."""
        ...

    def struct(self, kind: type) -> Struct:
        """The struct of a class of named tuples."""
        ...

    def constant(self, constant: Constant) -> None:
        """Take note that a constant is used."""
        ...


class Expressions:
    """Expressions of one kernel.

    own: the names that it has of its own, and of them those that are assigned once. types: as far as they are known.
    """

    def __init__(self, program: Program, module: str, own: dict[str, bool], types: dict[str, Type]) -> None:
        self.program, self.module, self.own, self.types = program, module, own, types

    def refuse(self, node: ast.AST, reason: str) -> Untranslatable:
        """The error for code that a kernel must not contain, with file and line."""
        return Untranslatable(self.module, getattr(node, "lineno", 0), reason)

    def code(self, node: ast.expr) -> Code:
        """An expression. Raises Untranslatable, and Unknown."""
        translate = _TRANSLATED.get(type(node))
        if translate is None:
            raise self.refuse(node, f"kernels have no {ast.unparse(node)!r:.60}")
        return translate(self, node)

    def scalar(self, node: ast.expr) -> Code:
        """An expression that gives a number or a flag."""
        found = self.code(node)
        if not isinstance(found.type, Scalar):
            raise self.refuse(node, f"{ast.unparse(node)} is no number")
        return found

    def flag(self, node: ast.expr) -> Code:
        """An expression that gives a flag."""
        found = self.code(node)
        if found.type != FLAG:
            raise self.refuse(node, f"{ast.unparse(node)} is no flag: say what it is compared with")
        return found

    def constant(self, node: ast.Constant) -> Code:
        value = node.value
        if isinstance(value, bool):
            return Code("true" if value else "false", FLAG)
        if isinstance(value, int):
            return Code(str(value), INTEGER)
        if isinstance(value, float):
            return Code(written(value), FLOAT)
        raise self.refuse(node, f"kernels have no {value!r}")

    def name(self, node: ast.Name) -> Code:
        if node.id in self.own:
            if node.id not in self.types:
                raise Unknown(node.id)
            return Code(spelled(node.id), self.types[node.id], stays=self.own[node.id])
        found = meaning(self.module, node.id)
        if not isinstance(found, Constant):
            raise self.refuse(node, f"{node.id} is neither a name of this kernel nor a constant")
        self.program.constant(found)
        kind = FLAG if isinstance(found.value, bool) else INTEGER if isinstance(found.value, int) else FLOAT
        return Code(self.program.name_of(found.module, self.module, found.name), kind)

    def attribute(self, node: ast.Attribute) -> Code:
        if isinstance(node.value, ast.Name) and node.value.id not in self.own:
            return self._of_module(node, getattr(meaning(self.module, node.value.id), node.attr, None))
        whole = self.code(node.value)
        kind = whole.type.field(node.attr) if isinstance(whole.type, Struct) else None
        if kind is None:
            raise self.refuse(node, f"{ast.unparse(node.value)} has no {node.attr}")
        return Code(f"{whole.within(PRIMARY)}.{spelled(node.attr)}", kind, stays=whole.stays)

    def _of_module(self, node: ast.Attribute, value: Any) -> Code:
        if not isinstance(value, (bool, int, float)):
            raise self.refuse(node, f"{ast.unparse(node)} is no number")
        return self.constant(ast.copy_location(ast.Constant(value), node))

    def subscript(self, node: ast.Subscript, reads: bool = True) -> Code:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            of = self.code(node.value.value)
            if isinstance(of.type, Array):
                return self._length(node, of)
        whole = self.code(node.value)
        if isinstance(whole.type, Struct):
            return self._numbered(node, whole)
        if not isinstance(whole.type, Array):
            raise self.refuse(node, f"{ast.unparse(node.value)} is no array")
        if isinstance(node.slice, ast.Slice):
            return self._cut(node, whole, node.slice)
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if len(indices) != whole.type.dimensions:
            said = f"{ast.unparse(node.value)} has {whole.type.dimensions}"
            raise self.refuse(node, f"{said} of the {len(indices)} dimensions that this has")
        codes = [self.scalar(index) for index in indices]
        if any(code.type == FLOAT for code in codes):
            raise self.refuse(node, f"{ast.unparse(node)}: an index is an integer")
        text = f"{whole.within(PRIMARY)}({', '.join(code.text for code in codes)})"
        # Narrow numbers would be added as narrow ones.
        item = whole.type.item
        return Code(f"{item.cpp}({text})" if reads and item.cpp != ITEMS[whole.type.dtype] else text, item)

    def _length(self, node: ast.Subscript, whole: Code) -> Code:
        if not (isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, int)):
            raise self.refuse(node, f"{ast.unparse(node)}: a dimension is a number that is written there")
        return Code(f"{whole.within(PRIMARY)}.shape[{node.slice.value}]", INTEGER)

    def _numbered(self, node: ast.Subscript, whole: Code) -> Code:
        fields = whole.type.fields if isinstance(whole.type, Struct) else ()
        if not isinstance(node.slice, ast.Constant) or not isinstance(node.slice.value, int):
            raise self.refuse(node, f"{ast.unparse(node)}: fields are called by their names")
        name, kind = fields[node.slice.value]
        return Code(f"{whole.within(PRIMARY)}.{spelled(name)}", kind, stays=whole.stays)

    def _cut(self, node: ast.Subscript, whole: Code, part: ast.Slice) -> Code:
        if part.step is not None:
            raise self.refuse(node, "a slice has no step")
        first = "0" if part.lower is None else self.scalar(part.lower).text
        last = f"{whole.within(PRIMARY)}.shape[0]" if part.upper is None else self.scalar(part.upper).text
        return Code(f"cut({whole.text}, {first}, {last})", whole.type)

    def binary(self, node: ast.BinOp) -> Code:
        a, b = self.scalar(node.left), self.scalar(node.right)
        return self.combined(node, type(node.op), a, b)

    def combined(self, node: ast.AST, operator: type, a: Code, b: Code) -> Code:
        """Two numbers, combined by an operator."""
        kind = joined(a.type, b.type)
        assert kind is not None
        kind = INTEGER if kind == FLAG else kind
        if operator in _ROUNDED:
            if kind != INTEGER:
                raise self.refuse(node, "// and % are of integers")
            return Code(f"{_ROUNDED[operator]}({a.text}, {b.text})", INTEGER)
        if operator not in _ARITHMETIC or (operator in _OF_INTEGERS and kind != INTEGER):
            raise self.refuse(node, f"kernels have no such operator of these: {ast.unparse(node)}")
        sign, hangs = _ARITHMETIC[operator]
        if operator in _OF_INTEGERS:
            # Compilers warn of operators within those of bits, but for the same one.
            left, right = a.within(hangs if a.hangs == hangs else UNARY), b.within(UNARY)
        else:
            left, right = a.within(hangs), b.within(hangs + 1)
        if operator is ast.Div and kind == INTEGER:
            left, kind = f"double({a.text})", FLOAT
        elif operator is ast.LShift or (_is_literal(a.text) and _is_literal(b.text)):
            # A literal of C++ has 32 bits.
            left = f"int64_t({a.text})"
        return Code(f"{left} {sign} {right}", FLOAT if operator is ast.Div else kind, hangs)

    def unary(self, node: ast.UnaryOp) -> Code:
        if isinstance(node.op, ast.Not):
            return Code(f"!{self.flag(node.operand).within(UNARY)}", FLAG, UNARY)
        a = self.scalar(node.operand)
        sign = {ast.USub: "-", ast.UAdd: "+", ast.Invert: "~"}[type(node.op)]
        inner = a.within(UNARY)
        return Code(
            f"{sign}({inner})" if inner[0] == sign else sign + inner, INTEGER if a.type == FLAG else a.type, UNARY
        )

    def logical(self, node: ast.BoolOp) -> Code:
        sign, hangs = ("&&", AND) if isinstance(node.op, ast.And) else ("||", OR)
        # Compilers warn of both in one without parentheses.
        parts = [self.flag(value) for value in node.values]
        return Code(
            f" {sign} ".join(part.within(hangs if part.hangs != AND else PRIMARY) for part in parts), FLAG, hangs
        )

    def comparison(self, node: ast.Compare) -> Code:
        parts, left = [], node.left
        for operator, right in zip(node.ops, node.comparators, strict=True):
            parts.append(self._compared(node, operator, left, right))
            left = right
        if len(parts) == 1:
            return parts[0]
        if any(isinstance(inner, ast.Call) for middle in node.comparators[:-1] for inner in ast.walk(middle)):
            raise self.refuse(node, "what is compared twice is no call: give it a name")
        return Code(" && ".join(part.within(AND) for part in parts), FLAG, AND)

    def _compared(self, node: ast.Compare, operator: ast.cmpop, left: ast.expr, right: ast.expr) -> Code:
        if isinstance(operator, (ast.In, ast.NotIn)):
            if not isinstance(right, ast.Tuple) or any(isinstance(inner, ast.Call) for inner in ast.walk(left)):
                raise self.refuse(node, "a name is looked for in a tuple that is written there")
            found = " || ".join(self._compared(node, ast.Eq(), left, item).within(OR) for item in right.elts)
            return Code(f"!({found})", FLAG, UNARY) if isinstance(operator, ast.NotIn) else Code(found, FLAG, OR)
        if type(operator) not in _ORDERS:
            raise self.refuse(node, f"kernels have no {ast.unparse(node)!r:.60}")
        sign, hangs = _ORDERS[type(operator)]
        # One more than needed: a comparison of comparisons is hard to read.
        return Code(f"{self.scalar(left).within(SHIFT)} {sign} {self.scalar(right).within(SHIFT)}", FLAG, hangs)

    def choice(self, node: ast.IfExp) -> Code:
        test, a, b = self.flag(node.test), self.code(node.body), self.code(node.orelse)
        kind = joined(a.type, b.type)
        if kind is None:
            raise self.refuse(node, f"{ast.unparse(node)!r:.60} is one of two kinds")
        return Code(f"{test.within(OR)} ? {a.within(CHOICE)} : {b.within(CHOICE)}", kind, CHOICE)

    def several(self, node: ast.Tuple) -> Code:
        codes = [self.code(item) for item in node.elts]
        kind = Several(tuple(code.type for code in codes))
        return Code(f"{kind.cpp}{{{', '.join(code.text for code in codes)}}}", kind)

    def call(self, node: ast.Call) -> Code:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        value = meaning(self.module, name)
        if isinstance(value, interpreted.ArenaLayout):
            return self._laid_out(node, value)
        if node.keywords or any(isinstance(argument, ast.Starred) for argument in node.args):
            raise self.refuse(node, "arguments are given by their places")
        if isinstance(node.func, ast.Attribute):
            module = meaning(self.module, node.func.value.id) if isinstance(node.func.value, ast.Name) else None
            return self._called(node, getattr(module, node.func.attr, None))
        if not isinstance(node.func, ast.Name):
            raise self.refuse(node, f"{ast.unparse(node.func)} is no kernel")
        if name in _BUILTIN and value is None:
            return _BUILTIN[name](self, node)
        return self._called(node, value)

    def _called(self, node: ast.Call, value: Any) -> Code:
        if isinstance(value, Kernel):
            return self._kernel(node, value, [self.code(argument) for argument in node.args])
        if isinstance(value, type) and hasattr(value, "_fields"):
            return self._made(node, self.program.struct(value), [self.code(argument) for argument in node.args])
        known = _known(value)
        if known in _OF_MATH:
            name, kind = _OF_MATH[known]
            return Code(f"{name}({self._only(node, FLOAT).text})", kind)
        if known in _LYING:
            dtype, dimensions = _LYING[known]
            made = Array(dtype, dimensions)
            return Code(f"lying<{made.cpp}>({', '.join(self.code(each).text for each in node.args)})", made)
        if value is interpreted.unpack:
            bundle = self.code(node.args[0])
            if not isinstance(bundle.type, BundleType):
                raise self.refuse(node, f"{ast.unparse(node.args[0])} is no bundle")
            return Code(f"unpack({bundle.text})", bundle.type.items, stays=True)
        raise self.refuse(node, f"{ast.unparse(node.func)} is no kernel")

    def _kernel(self, node: ast.Call, kernel: Kernel, codes: list[Code]) -> Code:
        result = self.program.called(kernel, [code.type for code in codes])
        if isinstance(result, str):
            raise self.refuse(node, f"{ast.unparse(node.func)}: {result}")
        function = kernel.function
        name = self.program.name_of(function.__module__, self.module, function.__name__)
        return Code(f"{name}({', '.join(code.text for code in codes)})", result)

    def _made(self, node: ast.Call, struct: Struct, codes: list[Code]) -> Code:
        if len(codes) != len(struct.fields):
            raise self.refuse(node, f"{struct.kind.__name__} has {len(struct.fields)} fields")
        for code, (name, kind) in zip(codes, struct.fields, strict=True):
            if not fits(code.type, kind):
                raise self.refuse(node, f"{struct.kind.__name__}.{name} is {kind.cpp}, given {code.type.cpp}")
        texts = [
            f"double({code.text})" if kind == FLOAT != code.type else code.text
            for code, (_, kind) in zip(codes, struct.fields, strict=True)
        ]
        return Code(f"{struct.cpp}{{{', '.join(texts)}}}", struct)

    def _laid_out(self, node: ast.Call, layout: interpreted.ArenaLayout) -> Code:
        kind, arena = node.args
        given = {str(each.arg): each.value for each in node.keywords}
        value = meaning(self.module, kind.id) if isinstance(kind, ast.Name) else None
        if not hasattr(value, "_fields"):
            raise self.refuse(node, f"{ast.unparse(kind)} is no named tuple")
        return self._struct_laid_out(node, layout, value, self.code(arena), given)

    def _struct_laid_out(
        self, node: ast.Call, layout: interpreted.ArenaLayout, kind: Any, arena: Code, given: dict[str, ast.expr]
    ) -> Code:
        codes = []
        for name, field in layout_of(kind).items():
            if name in given:
                codes.append(self.code(given[name]))
            elif isinstance(field, type):
                codes.append(self._struct_laid_out(node, layout, field, arena, given))
            elif field is not None:
                kernel = kernel_of(layout.kernels[field[0]])
                assert kernel is not None
                codes.append(self._kernel(node, kernel, [arena, *self._lengths(node, field[1], given)]))
            else:
                raise self.refuse(node, f"{kind.__name__}.{name} is not given, and has no lengths")
        return self._made(node, self.program.struct(kind), codes)

    def _lengths(self, node: ast.Call, text: str, given: dict[str, ast.expr]) -> list[Code]:
        lengths = ast.parse(f"({text},)", mode="eval")
        missing = {each.id for each in ast.walk(lengths) if isinstance(each, ast.Name)} - given.keys()
        if missing:
            raise self.refuse(node, f"the length {min(missing)} is not given")
        return [self.scalar(each) for each in _Replaced(given).visit(lengths).body.elts]

    def _only(self, node: ast.Call, wanted: Scalar) -> Code:
        if len(node.args) != 1:
            raise self.refuse(node, f"{ast.unparse(node.func)} takes one argument")
        found = self.scalar(node.args[0])
        if not fits(found.type, wanted):
            raise self.refuse(node, f"{ast.unparse(node)}: {wanted.cpp} is needed")
        return found

    def _extreme(self, node: ast.Call, name: str) -> Code:
        codes = [self.scalar(argument) for argument in node.args]
        found = codes[0]
        for code in codes[1:]:
            kind = joined(found.type, code.type)
            assert kind is not None
            cast = (
                f"<{kind.cpp}>" if found.type != code.type or _is_literal(found.text) or _is_literal(code.text) else ""
            )
            found = Code(f"{name}{cast}({found.text}, {code.text})", kind)
        return found

    def _size(self, node: ast.Call) -> Code:
        found = self.scalar(node.args[0])
        return Code(f"py::abs({found.text})", found.type)

    def _as_integer(self, node: ast.Call) -> Code:
        return Code(f"int64_t({self._only(node, FLOAT).text})", INTEGER)

    def _as_float(self, node: ast.Call) -> Code:
        return Code(f"double({self._only(node, FLOAT).text})", FLOAT)


class _Replaced(ast.NodeTransformer):
    """Replaces names in lengths by expressions."""

    def __init__(self, given: dict[str, ast.expr]) -> None:
        self._given = given

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return self._given[node.id]


_TRANSLATED: dict[type, Callable[[Expressions, Any], Code]] = {
    ast.Constant: Expressions.constant, ast.Name: Expressions.name, ast.Attribute: Expressions.attribute,
    ast.Subscript: Expressions.subscript, ast.BinOp: Expressions.binary, ast.UnaryOp: Expressions.unary,
    ast.BoolOp: Expressions.logical, ast.Compare: Expressions.comparison, ast.IfExp: Expressions.choice,
    ast.Tuple: Expressions.several, ast.Call: Expressions.call,
}  # fmt: skip
_BUILTIN: dict[str, Callable[[Expressions, ast.Call], Code]] = {
    "min": lambda own, node: own._extreme(node, "py::min"),
    "max": lambda own, node: own._extreme(node, "py::max"),
    "abs": Expressions._size,
    "int": Expressions._as_integer,
    "float": Expressions._as_float,
}


def written(value: float) -> str:
    """A float as C++ reads it: the same bits."""
    if math.isinf(value):
        return "INFINITY" if value > 0.0 else "-INFINITY"
    return "NAN" if math.isnan(value) else repr(value)


def _is_literal(text: str) -> bool:
    return text.lstrip("-").isdigit()


def _known(value: Any) -> Any:
    """A value that a table may be asked for."""
    return value if callable(value) else None
