"""Statements of kernels as C++."""

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from sandbox.physics.jit import interpreted
from sandbox.physics.jit.translate.cpp_types import (
    FLOAT,
    INTEGER,
    NOTHING,
    Constant,
    Several,
    Struct,
    Type,
    comments,
    fits,
    joined,
    meaning,
)
from sandbox.physics.jit.translate.expressions import PRIMARY, SUM, Code, Expressions, Program, Unknown, spelled

_INDENT = "    "


class Body(Expressions):
    """The body of one kernel as lines of C++."""

    def __init__(
        self, program: Program, module: str, function: ast.FunctionDef, given: dict[str, Type], result: Type
    ) -> None:
        super().__init__(program, module, _own_names(function), dict(given))
        self.function, self.result = function, result
        self.places: Declarations = _find_places(function)
        self._comments = comments(module)
        self._line = function.lineno
        self._count = 0
        self._find_types()

    # Types

    def _find_types(self) -> None:
        while self._types_found():
            pass
        missing = self.own.keys() - self.types.keys() - {"_"}
        if missing:
            raise self.refuse(self.function, f"the type of {', '.join(sorted(missing))} does not follow from anything")

    def _types_found(self) -> bool:
        """Find the types of more names; whether there were any."""
        before = dict(self.types)
        for node in _in_order(self.function.body):
            if isinstance(node, ast.For) and isinstance(node.target, ast.Name):
                self._take(node, node.target.id, INTEGER)
            for name, value in self._given(node):
                try:
                    self._take(node, name, self._type_of(value))
                except Unknown:
                    continue
        return self.types != before

    def _given(self, node: ast.stmt) -> Iterator[tuple[str, ast.expr | Type]]:
        """Names and values of a statement's assignments."""
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            assert node.value is not None
            yield node.target.id, node.value
        elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
            yield (
                node.target.id,
                ast.copy_location(ast.BinOp(ast.Name(node.target.id, ast.Load()), node.op, node.value), node),
            )
        elif isinstance(node, ast.Assign):
            for target in node.targets:
                if isinstance(target, ast.Name):
                    yield target.id, node.value
                elif isinstance(target, ast.Tuple):
                    yield from self._unpacked(node, target)

    def _unpacked(self, node: ast.Assign, target: ast.Tuple) -> Iterator[tuple[str, ast.expr | Type]]:
        if isinstance(node.value, ast.Tuple):
            parts: list[ast.expr | Type] = list(node.value.elts)
        else:
            try:
                parts = [kind for _, kind in self._fields(node, self.code(node.value).type)]
            except Unknown:
                return
        if len(parts) != len(target.elts):
            raise self.refuse(node, f"{len(target.elts)} names for {len(parts)} values")
        yield from ((one.id, part) for one, part in zip(target.elts, parts, strict=True) if isinstance(one, ast.Name))

    def _fields(self, node: ast.AST, kind: Type) -> list[tuple[str, Type]]:
        if isinstance(kind, Several):
            return [(f"item{k}", item) for k, item in enumerate(kind.items)]
        if isinstance(kind, Struct):
            return [(spelled(name), each) for name, each in kind.fields]
        raise self.refuse(node, "this is nothing that has parts")

    def _type_of(self, value: ast.expr | Type) -> Type:
        return self.code(value).type if isinstance(value, ast.expr) else value

    def _take(self, node: ast.stmt, name: str, kind: Type) -> None:
        wider = joined(self.types.get(name, kind), kind)
        if wider is None or kind == NOTHING:
            raise self.refuse(node, f"{name} is {self.types.get(name, kind).cpp}, given {kind.cpp}")
        self.types[name] = wider

    # Lines

    def lines(self) -> list[str]:
        """The statements, each with its comments."""
        return self._block(self.function.body, 1)

    def _block(self, body: list[ast.stmt], depth: int) -> list[str]:
        found: list[str] = []
        for statement in body:
            if isinstance(statement, ast.Pass) or _is_text(statement):
                continue
            found += self._said_before(statement, depth)
            found += [
                f"{_INDENT * depth}{self.types[name].cpp} {spelled(name)}{{}};"
                for name in self.places.before.get(id(statement), [])
            ]
            found += self._statement(statement, depth)
        return found

    def _said_before(self, statement: ast.stmt, depth: int) -> list[str]:
        first, self._line = self._line, max(self._line, statement.lineno)
        said = [
            f"{_INDENT * depth}// {text}"
            for line in range(first, statement.lineno)
            for alone, text in [self._comments.get(line, (False, ""))]
            if alone
        ]
        return said

    def _statement(self, statement: ast.stmt, depth: int) -> list[str]:
        indent = _INDENT * depth
        if isinstance(statement, ast.If):
            return self._if(statement, depth)
        if isinstance(statement, ast.For):
            return self._for(statement, depth)
        if isinstance(statement, ast.While):
            if statement.orelse:
                raise self.refuse(statement, "a loop has no else")
            head = f"{indent}while ({self.flag(statement.test).text}) {{"
            return [head, *self._block(statement.body, depth + 1), f"{indent}}}"]
        return [indent + line for line in self._simple(statement)]

    def _simple(self, statement: ast.stmt) -> list[str]:
        if isinstance(statement, ast.Break):
            return ["break;"]
        if isinstance(statement, ast.Continue):
            return ["continue;"]
        if isinstance(statement, ast.Return):
            return self._return(statement)
        if isinstance(statement, ast.Expr):
            return [f"{self._put(statement.value) or self.code(statement.value).text};"]
        if isinstance(statement, ast.AugAssign):
            return self._augmented(statement)
        if isinstance(statement, ast.AnnAssign):
            return self._annotated(statement)
        if isinstance(statement, ast.Assign):
            return self._assigned(statement)
        raise self.refuse(statement, f"kernels have no {type(statement).__name__.lower()}")

    def _return(self, statement: ast.Return) -> list[str]:
        if statement.value is None:
            return ["return;"]
        found = self.code(statement.value)
        if (
            isinstance(found.type, Several)
            and isinstance(self.result, Several)
            and isinstance(statement.value, ast.Tuple)
        ):
            items = zip(statement.value.elts, self.result.items, strict=True)
            texts = [self._as(statement, self.code(node), wanted) for node, wanted in items]
            return [f"return {{{', '.join(texts)}}};"]
        return [f"return {self._as(statement, found, self.result)};"]

    def _as(self, node: ast.AST, found: Code, wanted: Type) -> str:
        if not fits(found.type, wanted):
            raise self.refuse(node, f"{found.type.cpp} is given where {wanted.cpp} is wanted")
        return f"double({found.text})" if wanted == FLOAT != found.type else found.text

    def _put(self, node: ast.expr) -> str | None:
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
            return None
        if meaning(self.module, node.func.id) is not interpreted.set_field:
            return None
        place, name, value = node.args
        whole, given = self.code(place), self.code(value)
        if not (isinstance(name, ast.Constant) and isinstance(name.value, str)):
            raise self.refuse(node, "the name of a field is written there")
        kind = whole.type.field(name.value) if isinstance(whole.type, Struct) else None
        if kind != given.type:
            raise self.refuse(node, f"{ast.unparse(place)}.{name.value} is not {given.type.cpp}")
        return f"set_field({whole.within(PRIMARY)}.{spelled(name.value)}, {given.text})"

    def _augmented(self, statement: ast.AugAssign) -> list[str]:
        place = statement.target
        target = self.subscript(place, reads=False) if isinstance(place, ast.Subscript) else self.scalar(place)
        value = self.scalar(statement.value)
        combined = self.combined(statement, type(statement.op), target, value)
        if joined(combined.type, target.type) != target.type:
            raise self.refuse(statement, f"{ast.unparse(statement.target)} is an integer")
        sign = {
            ast.Add: "+",
            ast.Sub: "-",
            ast.Mult: "*",
            ast.Div: "/",
            ast.BitOr: "|",
            ast.BitAnd: "&",
            ast.BitXor: "^",
        }
        changes = any(isinstance(node, ast.Call) for node in ast.walk(statement.value))
        if type(statement.op) not in sign or (changes and isinstance(statement.target, ast.Subscript)):
            # Python reads what is changed before it comes to what changes it.
            before = self._temporary()
            again = self.combined(statement, type(statement.op), Code(before, target.type), value)
            return [f"const {target.type.cpp} {before} = {target.text};", f"{target.text} = {again.text};"]
        return [f"{target.text} {sign[type(statement.op)]}= {value.text};"]

    def _annotated(self, statement: ast.AnnAssign) -> list[str]:
        assert statement.value is not None
        return [self._set(statement, statement.target, self.code(statement.value))]

    def _assigned(self, statement: ast.Assign) -> list[str]:
        value, targets = statement.value, statement.targets
        if len(targets) > 1:
            return self._to_each(statement)
        if not isinstance(targets[0], ast.Tuple):
            return [self._set(statement, targets[0], self.code(value))]
        if isinstance(value, ast.Tuple):
            return self._in_turn(statement, targets[0], value)
        whole, found = self._temporary(), self.code(value)
        parts = zip(targets[0].elts, self._fields(statement, found.type), strict=True)
        return [f"const {found.type.cpp} {whole} = {found.text};"] + [
            self._set(statement, target, Code(f"{whole}.{name}", kind))
            for target, (name, kind) in parts
            if not _is_unused(target)
        ]

    def _to_each(self, statement: ast.Assign) -> list[str]:
        found = self.code(statement.value)
        if isinstance(statement.value, (ast.Constant, ast.UnaryOp)):
            return [self._set(statement, target, found) for target in statement.targets]
        one = self._temporary()
        return [f"const {found.type.cpp} {one} = {found.text};"] + [
            self._set(statement, target, Code(one, found.type)) for target in statement.targets
        ]

    def _in_turn(self, statement: ast.Assign, targets: ast.Tuple, values: ast.Tuple) -> list[str]:
        # All values first, unless none of them reads what is set before it.
        set_before: list[str] = []
        apart = True
        for target, value in zip(targets.elts, values.elts, strict=True):
            apart = (
                apart
                and isinstance(target, ast.Name)
                and not any(isinstance(node, ast.Name) and node.id in set_before for node in ast.walk(value))
            )
            set_before.append(target.id if isinstance(target, ast.Name) else "")
        if apart:
            pairs = zip(targets.elts, values.elts, strict=True)
            return [self._set(statement, target, self.code(value)) for target, value in pairs if not _is_unused(target)]
        found = [(self._temporary(), self.code(value)) for value in values.elts]
        return [f"const {code.type.cpp} {name} = {code.text};" for name, code in found] + [
            self._set(statement, target, Code(name, code.type))
            for target, (name, code) in zip(targets.elts, found, strict=True)
        ]

    def _set(self, statement: ast.stmt, target: ast.expr, value: Code) -> str:
        if isinstance(target, ast.Subscript):
            place = self.subscript(target, reads=False)
            if not fits(value.type, place.type):
                raise self.refuse(statement, f"{ast.unparse(target)} is {place.type.cpp}, given {value.type.cpp}")
            return f"{place.text} = {value.text};"
        if not isinstance(target, ast.Name):
            raise self.refuse(statement, "a field of a named tuple is set by set_field")
        name, kind = spelled(target.id), self.types[target.id]
        if target.id not in self.places.first.get(id(statement), ()):
            return f"{name} = {value.text};"
        once = target.id in self.places.once
        if isinstance(kind, Struct) and once and value.stays:
            return f"const {kind.cpp} &{name} = {value.text};"
        return f"{'const ' if once else ''}{kind.cpp} {name} = {value.text};"

    def _temporary(self) -> str:
        self._count += 1
        return f"held{self._count}"

    # Compound statements

    def _if(self, statement: ast.If, depth: int, word: str = "if") -> list[str]:
        indent = _INDENT * depth
        found = [f"{indent}{word} ({self.flag(statement.test).text}) {{", *self._block(statement.body, depth + 1)]
        other = statement.orelse
        if not other:
            return [*found, f"{indent}}}"]
        if len(other) == 1 and isinstance(other[0], ast.If) and id(other[0]) not in self.places.before:
            return found + self._if(other[0], depth, "} else if")
        return [*found, f"{indent}}} else {{", *self._block(other, depth + 1), f"{indent}}}"]

    def _for(self, statement: ast.For, depth: int) -> list[str]:
        indent, target = _INDENT * depth, statement.target
        if not isinstance(target, ast.Name) or statement.orelse:
            raise self.refuse(statement, "a loop has one name, and no else")
        body = self._block(statement.body, depth + 1)
        name = spelled(target.id)
        if self._is_parallel(statement.iter):
            return self._parallel(statement, name, body, indent)
        if isinstance(statement.iter, ast.Tuple):
            items = ", ".join(f"int64_t({self.scalar(item).text})" for item in statement.iter.elts)
            head = f"for (const int64_t {name}_of[] = {{{items}}}; const int64_t {name} : {name}_of) {{"
            return [f"{indent}{head}", *body, f"{indent}}}"]
        if not isinstance(statement.iter, ast.Call) or ast.unparse(statement.iter.func) != "range":
            raise self.refuse(statement, "a loop runs over a range, or over a tuple that is written there")
        first, last, step = self._range(statement.iter)
        if id(statement) in self.places.hidden:
            counter = self._temporary()
            body.insert(0, f"{indent}{_INDENT}{name} = {counter};")
        else:
            counter = name
        start = f"int64_t {counter} = {first.text}"
        if self._stays(statement, last):
            end = last.within(SUM)
        else:
            end = f"{counter}_end" if counter.startswith("held") else f"{name.rstrip('_')}_end"
            start += f", {end} = {last.text}"
        forth = {1: f"{counter}++", -1: f"{counter}--"}.get(step, f"{counter} {'+' if step > 0 else '-'}= {abs(step)}")
        head = f"{indent}for ({start}; {counter} {'<' if step > 0 else '>'} {end}; {forth}) {{"
        return [head, *body, f"{indent}}}"]

    def _is_parallel(self, node: ast.expr) -> bool:
        function = node.func if isinstance(node, ast.Call) else None
        return isinstance(function, ast.Name) and meaning(self.module, function.id) is interpreted.parallel

    def _parallel(self, statement: ast.For, name: str, body: list[str], indent: str) -> list[str]:
        assert isinstance(statement.iter, ast.Call)
        only = statement.body[0] if len(statement.body) == 1 else None
        if not (isinstance(only, ast.Expr) and isinstance(only.value, ast.Call)) or len(statement.iter.args) != 2:
            raise self.refuse(statement, "a parallel loop has a number of items, work, and one call as its body")
        items, work = (self.scalar(argument) for argument in statement.iter.args)
        if items.type != INTEGER or work.type != INTEGER:
            raise self.refuse(statement, "items and work of a parallel loop are integers")
        head = f"{indent}parallel({items.text}, {work.text}, [&](const int64_t {name}) {{"
        return [head, *body, f"{indent}}});"]

    def _range(self, call: ast.Call) -> tuple[Code, Code, int]:
        codes = [self.scalar(argument) for argument in call.args]
        if any(code.type != INTEGER for code in codes):
            raise self.refuse(call, "a range is one of integers")
        if len(codes) == 1:
            return Code("0", INTEGER), codes[0], 1
        return codes[0], codes[1], self._step(call.args[2]) if len(codes) == 3 else 1

    def _step(self, node: ast.expr) -> int:
        known = meaning(self.module, node.id) if isinstance(node, ast.Name) and node.id not in self.own else None
        try:
            return int(known.value if isinstance(known, Constant) else ast.literal_eval(node))
        except ValueError:
            raise self.refuse(node, "the step of a range is a constant") from None

    def _stays(self, statement: ast.For, last: Code) -> bool:
        """Whether the end of a range is the same after each turn, as C++ looks again."""
        assert isinstance(statement.iter, ast.Call)
        node = statement.iter.args[min(1, len(statement.iter.args) - 1)]
        changed = {each.id for inner in statement.body for each in ast.walk(inner)
                   if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)}  # fmt: skip
        if isinstance(node, ast.Constant):
            return True
        if isinstance(node, ast.Name):
            return node.id not in changed
        is_shape = (
            isinstance(node, ast.Subscript) and isinstance(node.value, ast.Attribute) and node.value.attr == "shape"
        )
        puts = any(isinstance(each, ast.Name) and each.id == "set_field" for each in ast.walk(statement))
        return (
            is_shape
            and not puts
            and not any(isinstance(each, ast.Name) and each.id in changed for each in ast.walk(node))
        )


def _in_order(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    for statement in body:
        yield statement
        for block in _blocks_of(statement):
            yield from _in_order(block)


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _is_unused(target: ast.expr) -> bool:
    return isinstance(target, ast.Name) and target.id == "_"


Statements = list[ast.stmt]


@dataclass
class Declarations:
    """Places where names are declared: at the statements, by id, that first assign them, or before a statement.

    once: names that are assigned only there. hidden: loops whose own name is assigned or read elsewhere as well, so
    that C++ counts by another.
    """

    first: dict[int, set[str]] = field(default_factory=dict)
    before: dict[int, list[str]] = field(default_factory=dict)
    once: set[str] = field(default_factory=set)
    hidden: set[int] = field(default_factory=set)


def _own_names(function: ast.FunctionDef) -> dict[str, bool]:
    """All names that a kernel assigns, its parameters included: whether each is so once."""
    found = [argument.arg for argument in function.args.args]
    found += [node.id for node in ast.walk(function) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)]
    return {name: count == 1 for name, count in Counter(found).items()}


def _targets_of(statement: ast.stmt) -> list[ast.expr]:
    """The targets of an assignment, one after another."""
    if isinstance(statement, ast.Assign):
        return [one for target in statement.targets
                for one in (target.elts if isinstance(target, ast.Tuple) else [target])]  # fmt: skip
    return [statement.target] if isinstance(statement, (ast.AnnAssign, ast.AugAssign)) else []


def _find_places(function: ast.FunctionDef) -> Declarations:
    """Where the names of a kernel are declared."""
    found, names = Declarations(), _NamesWithin(function)
    parameters = {argument.arg for argument in function.args.args}
    loops: dict[str, list[ast.For]] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.For) and isinstance(node.target, ast.Name):
            loops.setdefault(node.target.id, []).append(node)
    for name in sorted(_own_names(function).keys() - parameters - {"_"}):
        own = loops.get(name, [])
        inside = {id(node) for loop in own for node in ast.walk(loop)}
        outside = any(id(node) not in inside for node in names.nodes[name])
        stores = sum(isinstance(node.ctx, ast.Store) for node in names.nodes[name])
        if own and not outside and stores == len(own):
            continue
        found.hidden.update(map(id, own))
        _place(name, function.body, found, names)
        if stores == 1:
            found.once.add(name)
    return found


class _NamesWithin:
    """The names in each part of a kernel, and the nodes of each name."""

    def __init__(self, function: ast.FunctionDef) -> None:
        self.nodes: dict[str, list[ast.Name]] = {}
        self._within: dict[int, set[str]] = {}
        self._collect(function)

    def _collect(self, node: ast.AST) -> set[str]:
        found = {node.id} if isinstance(node, ast.Name) else set()
        if isinstance(node, ast.Name):
            self.nodes.setdefault(node.id, []).append(node)
        for child in ast.iter_child_nodes(node):
            found |= self._collect(child)
        self._within[id(node)] = found
        return found

    def holds(self, node: ast.AST, name: str) -> bool:
        """Whether a name stands in a part."""
        return name in self._within[id(node)]


def _is(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def _blocks_of(statement: ast.stmt) -> Iterator[Statements]:
    """The blocks of a statement."""
    if isinstance(statement, (ast.If, ast.For, ast.While)):
        yield statement.body
        if statement.orelse:
            yield statement.orelse


def _place(name: str, body: Statements, found: Declarations, names: _NamesWithin) -> None:
    # In the innermost block that holds it everywhere; not in that of a loop that may carry a value on to the next turn.
    holding = [statement for statement in body if names.holds(statement, name)]
    first = holding[0]
    if len(holding) == 1:
        blocks = [block for block in _blocks_of(first) if any(names.holds(each, name) for each in block)]
        heads = [first.test] if isinstance(first, (ast.If, ast.While)) else []
        heads += [first.target, first.iter] if isinstance(first, ast.For) else []
        if len(blocks) == 1 and not any(names.holds(head, name) for head in heads):
            start = next(each for each in blocks[0] if names.holds(each, name))
            if isinstance(first, ast.If) or _begins(start, name, names):
                _place(name, blocks[0], found, names)
                return
    if _begins(first, name, names):
        found.first.setdefault(id(first), set()).add(name)
    else:
        found.before.setdefault(id(first), []).append(name)


def _begins(statement: ast.stmt, name: str, names: _NamesWithin) -> bool:
    """Whether a statement assigns a name and reads it not."""
    if not isinstance(statement, (ast.Assign, ast.AnnAssign)) or statement.value is None:
        return False
    return any(_is(target, name) for target in _targets_of(statement)) and not names.holds(statement.value, name)
