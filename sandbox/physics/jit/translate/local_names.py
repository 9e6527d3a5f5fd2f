"""Local names of a kernel: where C++ is to declare each, and what type it has."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field

Statements = list[ast.stmt]


@dataclass
class Places:
    """Where names are declared: at the statements, by id, that first assign them, or before a statement.

    once: names that are assigned only there. hidden: loops whose own name is assigned or read elsewhere as well, so
    that C++ counts by another.
    """

    first: dict[int, set[str]] = field(default_factory=dict)
    before: dict[int, list[str]] = field(default_factory=dict)
    once: set[str] = field(default_factory=set)
    hidden: set[int] = field(default_factory=set)


def own_names(function: ast.FunctionDef) -> set[str]:
    """All names that a kernel assigns, its parameters included."""
    stored = {node.id for node in ast.walk(function) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    return stored | {argument.arg for argument in function.args.args}


def targets_of(statement: ast.stmt) -> list[ast.expr]:
    """What a statement assigns, one after another."""
    if isinstance(statement, ast.Assign):
        return [one for target in statement.targets
                for one in (target.elts if isinstance(target, ast.Tuple) else [target])]  # fmt: skip
    return [statement.target] if isinstance(statement, (ast.AnnAssign, ast.AugAssign)) else []


def find_places(function: ast.FunctionDef) -> Places:
    """Where the names of a kernel are declared."""
    found = Places()
    parameters = {argument.arg for argument in function.args.args}
    for name in sorted(own_names(function) - parameters - {"_"}):
        loops = [node for node in ast.walk(function) if isinstance(node, ast.For) and _is(node.target, name)]
        stores = sum(_is_store(node, name) for node in ast.walk(function))
        inside = {id(node) for loop in loops for node in ast.walk(loop)}
        outside = any(isinstance(node, ast.Name) and node.id == name and id(node) not in inside
                      for node in ast.walk(function))  # fmt: skip
        if loops and not outside and stores == len(loops):
            continue
        found.hidden.update(map(id, loops))
        _place(name, function.body, found)
        if stores == 1:
            found.once.add(name)
    return found


def _is(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def _is_store(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name and isinstance(node.ctx, ast.Store)


def has_name(node: ast.AST, name: str) -> bool:
    """Whether a name stands in a part of a kernel."""
    return any(_is(each, name) for each in ast.walk(node))


def blocks_of(statement: ast.stmt) -> Iterator[Statements]:
    """The blocks of a statement."""
    if isinstance(statement, (ast.If, ast.For, ast.While)):
        yield statement.body
        if statement.orelse:
            yield statement.orelse


def _place(name: str, body: Statements, found: Places) -> None:
    # In the innermost block that holds it everywhere; not in that of a loop that may carry a value on to the next turn.
    holding = [statement for statement in body if has_name(statement, name)]
    first = holding[0]
    if len(holding) == 1:
        blocks = [block for block in blocks_of(first) if any(has_name(each, name) for each in block)]
        heads = [first.test] if isinstance(first, (ast.If, ast.While)) else []
        heads += [first.target, first.iter] if isinstance(first, ast.For) else []
        if len(blocks) == 1 and not any(has_name(head, name) for head in heads):
            start = next(each for each in blocks[0] if has_name(each, name))
            if isinstance(first, ast.If) or _begins(start, name):
                _place(name, blocks[0], found)
                return
    if _begins(first, name):
        found.first.setdefault(id(first), set()).add(name)
    else:
        found.before.setdefault(id(first), []).append(name)


def _begins(statement: ast.stmt, name: str) -> bool:
    """Whether a statement assigns a name and reads it not."""
    if not isinstance(statement, (ast.Assign, ast.AnnAssign)) or statement.value is None:
        return False
    return any(_is(target, name) for target in targets_of(statement)) and not has_name(statement.value, name)
