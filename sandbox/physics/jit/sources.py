"""What machine code follows from in the sources: whether kernels are those that a library was made of.

Of a file of kernels that is the kernels themselves, with the named tuples, constants and imports that they name.
Neither comments, docstrings nor other functions are among it; annotations are: types follow from them. A digest is the
same on every Python.
"""

import ast
import hashlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).parents[2]
_FOLDERS = ("physics", "app/draw/raster")
# What makes machine code of kernels: every statement of these counts.
_MAKERS = (
    "bundles.py", "making/calling.c", "making/compiling.py", "making/platforms.py",
    *(f"translate/{name}" for name in ("cpp_types.py", "expressions.py", "program.py", "runtime.h", "statements.py")),
)  # fmt: skip
_ROLES = {"kernel", "inner_kernel", "inlined_kernel", "scalar_kernel"}
_DIGEST_SIZE = 8
# Fields of a syntax tree that say nothing of what is computed.
_SILENT = {"type_comment", "type_params", "ctx", "kind"}


class NoLibrary(Exception):
    """No library is usable here; says in one line why."""


def source_files() -> Iterator[tuple[str, Path]]:
    """Every file that kernels or their makers may lie in, with its path from the package on."""
    jit = PACKAGE / "physics" / "jit"
    found = [file for folder in _FOLDERS for file in (PACKAGE / folder).rglob("*.py") if jit not in file.parents]
    for file in sorted([*found, *(jit / name for name in _MAKERS)]):
        yield file.relative_to(PACKAGE).as_posix(), file


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=_DIGEST_SIZE).hexdigest()


def text_of(file: Path) -> bytes:
    """A file's text with the ends of lines that the project uses."""
    return file.read_bytes().replace(b"\r\n", b"\n")


def text_digest(text: bytes) -> str:
    """A digest of all of a text: sooner made than the digest of its kernels, and other after any edit."""
    return _digest(text)


def _plain(node: Any) -> Any:
    """A syntax tree in a form that is the same on every version of Python."""
    if isinstance(node, list):
        return [_plain(item) for item in node if not (isinstance(item, ast.Expr) and _is_text(item.value))]
    if isinstance(node, ast.Constant):
        return type(node.value).__name__, repr(node.value)
    if isinstance(node, ast.AST):
        fields = [(name, _plain(value)) for name, value in ast.iter_fields(node) if name not in _SILENT]
        return type(node).__name__, [field for field in fields if field[1] not in (None, [])]
    return node


def _is_text(value: ast.expr) -> bool:
    return isinstance(value, ast.Constant) and isinstance(value.value, str)


def has_kernels(text: bytes) -> bool:
    """Whether a file has kernels."""
    return any(f"\n@{role}\n".encode() in text for role in _ROLES)


def _last_name(node: ast.expr) -> str:
    if isinstance(node, ast.Call):
        return _last_name(node.func)
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _is_of_kernels(statement: ast.stmt) -> bool:
    """Whether a statement is a kernel, or a function that makes one, or a named tuple."""
    if isinstance(statement, ast.ClassDef):
        return "NamedTuple" in map(_last_name, statement.bases)
    if not isinstance(statement, ast.FunctionDef):
        return False
    functions = [node for node in ast.walk(statement) if isinstance(node, ast.FunctionDef)]
    return any(_last_name(mark) in _ROLES for function in functions for mark in function.decorator_list)


def _names(nodes: Iterable[ast.AST]) -> set[str]:
    """Names that these nodes read."""
    found, waiting = set(), list(nodes)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Name):
            found.add(node.id)
        for name, value in ast.iter_fields(node):
            if name not in _SILENT:
                waiting += [one for one in (value if isinstance(value, list) else [value]) if isinstance(one, ast.AST)]
    return found


def _bound(statement: ast.stmt) -> set[str]:
    """The names that a constant's statement binds."""
    if not isinstance(statement, ast.Assign | ast.AnnAssign):
        return set()
    targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
    return {node.id for target in targets for node in ast.walk(target) if isinstance(node, ast.Name)}


def _imports(tree: ast.Module, names: set[str]) -> list[tuple[str, str, str]]:
    """Module, name there and name here of each import under one of these names."""
    found = []
    for statement in tree.body:
        if isinstance(statement, ast.Import | ast.ImportFrom):
            module = str(getattr(statement, "module", ""))
            for alias in statement.names:
                here = alias.asname or alias.name
                if here.partition(".")[0] in names:
                    found.append((module, alias.name, here))
    return sorted(found)


def kernel_part(text: bytes, others: Iterable[str] = ()) -> tuple[list[Any], list[tuple[str, str, str]]]:
    """The part of a file that machine code follows from, and its imports; others: names that other files take."""
    tree = ast.parse(text)
    kept = [statement for statement in tree.body if _is_of_kernels(statement)]
    names, count = _names(kept) | set(others), -1
    while count != len(names):
        count = len(names)
        constants = [statement for statement in tree.body if _bound(statement) & names]
        names |= _names(constants)
    imports = _imports(tree, names) if kept or constants else []
    return _plain([one for one in tree.body if one in kept or one in constants]), imports


def kernel_digest(name: str, text: bytes, others: Iterable[str] = ()) -> str:
    """Digest of a file's part that machine code follows from; of a maker that of all its text."""
    if name.endswith((".c", ".h")):
        return _digest(text)
    if name.startswith("physics/jit/"):
        return _digest(repr(_plain(ast.parse(text).body)).encode())
    part, imports = kernel_part(text, others)
    return _digest(repr((part, imports)).encode()) if part else ""


def names_taken() -> dict[str, list[str]]:
    """Of each file the names that kernels and constants of other files import from it.

    Raises:
        ValueError: where a kernel takes a whole module, of which nobody can say what it reads.
    """
    files = {f"sandbox.{name.removesuffix('.py').replace('/', '.')}": name for name, _ in source_files()}
    texts = {name: text_of(file) for name, file in source_files() if name.endswith(".py")}
    taken: dict[str, set[str]] = {name: set() for name in texts}
    open_ones = [name for name in texts if not name.startswith("physics/jit/")]
    while open_ones:
        name = open_ones.pop()
        for module, imported, _ in kernel_part(texts[name], taken[name])[1]:
            if f"{module}.{imported}" in files:
                raise ValueError(f"{name}: kernels import names, not the module {imported}")
            other = files.get(module)
            if other is not None and imported not in taken[other]:
                taken[other].add(imported)
                open_ones.append(other)
    return {name: sorted(names) for name, names in taken.items()}


def sources_now() -> dict[str, dict[str, Any]]:
    """Of each file the digest of its text, that of its kernels, and the names that other files take from it."""
    taken = names_taken()
    found = {}
    for name, file in source_files():
        text, names = text_of(file), taken.get(name, [])
        found[name] = {"text": text_digest(text), "kernels": kernel_digest(name, text, names), "taken": names}
    return found


def edited(known: dict[str, dict[str, Any]]) -> list[str]:
    """The files whose kernels are others than in `known`, which `sources_now` gave; one that is missing is none."""
    found = []
    for name, file in source_files():
        entry = known.get(name, {"text": "", "kernels": "", "taken": []})
        try:
            text = text_of(file)
        except OSError:
            continue
        if text_digest(text) == entry["text"]:
            continue
        try:
            now = kernel_digest(name, text, entry["taken"])
        except SyntaxError:
            now = "no Python"
        if now != entry["kernels"]:
            found.append(name)
    return found


def file_digest(content: bytes) -> str:
    """The digest of a library's file, as the manifest has it."""
    return hashlib.blake2b(content, digest_size=2 * _DIGEST_SIZE).hexdigest()
