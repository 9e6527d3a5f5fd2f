"""What stands in the sources of kernels: their syntax trees and comments, and what a name is there."""

import ast
import functools
import importlib
import inspect
import io
import tokenize
from dataclasses import dataclass
from typing import Any

from sandbox.physics.jit import Kernel, kernel_of

_UNSPOKEN = ("sandbox.",)


class Untranslatable(Exception):
    """A kernel says what the language of kernels does not have; where, and why."""

    def __init__(self, module: str, line: int, reason: str) -> None:
        super().__init__(f"{module.replace('.', '/')}.py:{line}: {reason}")


@dataclass(frozen=True)
class Constant:
    """A number that a module gives a name, in the module where it does so."""

    module: str
    name: str
    value: bool | int | float


@functools.cache
def _text(module: str) -> str:
    return inspect.getsource(importlib.import_module(module))


@functools.cache
def _tree(module: str) -> ast.Module:
    return ast.parse(_text(module))


@functools.cache
def comments(module: str) -> dict[int, tuple[bool, str]]:
    """The comments of a module by their lines: whether one has a line of its own, and what it says."""
    text = _text(module)
    lines = text.splitlines()
    found = {}
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and not token.string.startswith("# fmt:"):
            row, column = token.start
            found[row] = (not lines[row - 1][:column].strip(), token.string.lstrip("# "))
    return found


def definition(kernel: Kernel) -> ast.FunctionDef:
    """The definition of a kernel."""
    function = kernel.function
    for node in _tree(function.__module__).body:
        if isinstance(node, ast.FunctionDef) and node.name == function.__name__:
            return node
    raise Untranslatable(
        function.__module__, function.__code__.co_firstlineno, "it stands not at the top of its module"
    )


@functools.cache
def _imports(module: str) -> dict[str, tuple[str, str]]:
    return {
        alias.asname or alias.name: (node.module or "", alias.name)
        for node in _tree(module).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def home(module: str, name: str) -> tuple[str, str]:
    """The module in which a name is given, and its name there."""
    while name in _imports(module) and _imports(module)[name][0].startswith(_UNSPOKEN):
        origin, name = _imports(module)[name]
        if not hasattr(importlib.import_module(origin), name):
            break
        module = origin
    return module, name


def meaning(module: str, name: str) -> Any:
    """What a name is at the top of a module: a Constant, a Kernel, a class, another module, or None: there is none."""
    value = vars(importlib.import_module(module)).get(name)
    kernel = kernel_of(value)
    if kernel is not None:
        return kernel
    if isinstance(value, (bool, int, float)):
        return Constant(*home(module, name), _plain(value))
    return value


def _plain(value: Any) -> bool | int | float:
    return value if isinstance(value, (bool, float)) else int(value)
