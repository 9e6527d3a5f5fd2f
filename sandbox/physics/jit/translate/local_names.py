"""Local names of a kernel: where C++ is to declare each, and what type it has."""

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

Statements = list[ast.stmt]


@dataclass
class Declarations:
    """Where names are declared: at the statements, by id, that first assign them, or before a statement.

    once: names that are assigned only there. hidden: loops whose own name is assigned or read elsewhere as well, so
    that C++ counts by another.
    """

    first: dict[int, set[str]] = field(default_factory=dict)
    before: dict[int, list[str]] = field(default_factory=dict)
    once: set[str] = field(default_factory=set)
    hidden: set[int] = field(default_factory=set)


def own_names(function: ast.FunctionDef) -> dict[str, bool]:
    """All names that a kernel assigns, its parameters included: whether each is so once."""
    found = [argument.arg for argument in function.args.args]
    found += [node.id for node in ast.walk(function) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)]
    return {name: count == 1 for name, count in Counter(found).items()}


def targets_of(statement: ast.stmt) -> list[ast.expr]:
    """What a statement assigns, one after another."""
    if isinstance(statement, ast.Assign):
        return [one for target in statement.targets
                for one in (target.elts if isinstance(target, ast.Tuple) else [target])]  # fmt: skip
    return [statement.target] if isinstance(statement, (ast.AnnAssign, ast.AugAssign)) else []


def find_places(function: ast.FunctionDef) -> Declarations:
    """Where the names of a kernel are declared."""
    found, names = Declarations(), _NamesWithin(function)
    parameters = {argument.arg for argument in function.args.args}
    loops: dict[str, list[ast.For]] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.For) and isinstance(node.target, ast.Name):
            loops.setdefault(node.target.id, []).append(node)
    for name in sorted(own_names(function).keys() - parameters - {"_"}):
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


def blocks_of(statement: ast.stmt) -> Iterator[Statements]:
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
        blocks = [block for block in blocks_of(first) if any(names.holds(each, name) for each in block)]
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
    return any(_is(target, name) for target in targets_of(statement)) and not names.holds(statement.value, name)
