"""Gathering: every kernel that Python calls, as units of C++, and how each is called."""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.physics.jit import Kernel, entries
from sandbox.physics.jit.bundles import Signature, name_of
from sandbox.physics.jit.sources import has_kernels, source_files, text_of
from sandbox.physics.jit.translate.cpp_types import (
    FLAG,
    FLOAT,
    INTEGER,
    NOTHING,
    Array,
    BundleType,
    Scalar,
    Several,
    Struct,
    Type,
)
from sandbox.physics.jit.translate.program import Translation, symbol_of, words_of

# Entries are divided so that few kernels are called from two units: each is compiled by itself, all at once.
_UNITS = {"tick.cpp": "sandbox.physics.pipeline.tick", "physics.cpp": "sandbox.physics", "painting.cpp": "sandbox"}
_FORMS = {INTEGER: "integer", FLOAT: "float", FLAG: "flag", NOTHING: "nothing"}


@dataclass(frozen=True)
class Gathered:
    """Kernels in C++, by the names of files, and entries by their names, as a manifest has them."""

    texts: dict[str, str]
    entries: dict[str, dict[str, Any]]

    @property
    def symbols(self) -> list[str]:
        """What entries are called in a library."""
        return [entry["symbol"] for entry in self.entries.values()]


def all_entries() -> list[Kernel]:
    """Every kernel of the package that Python calls, by name, from all modules that have any."""
    for name, file in source_files():
        if name.endswith(".py") and has_kernels(text_of(file)):
            importlib.import_module(f"sandbox.{name.removesuffix('.py').replace('/', '.')}")
    return sorted((one for one in entries() if one.name.startswith("sandbox.")), key=lambda kernel: kernel.name)


def gathered(kernels: Sequence[Kernel]) -> Gathered:
    """Kernels in C++. Raises Untranslatable where one says what the language of kernels does not have."""
    units: dict[str, list[Kernel]] = {}
    for kernel in kernels:
        unit = next(name for name, begin in _UNITS.items() if kernel.name.startswith(begin))
        units.setdefault(unit, []).append(kernel)
    texts: dict[str, str] = {}
    found: dict[str, dict[str, Any]] = {}
    for unit, ones in units.items():
        translation = Translation(ones)
        texts[unit] = translation.text()
        found |= {kernel.name: entry_of(translation, kernel) for kernel in ones}
    return Gathered(texts, found)


def entry_of(translation: Translation, kernel: Kernel) -> dict[str, Any]:
    """What a manifest says of an entry."""
    (signature,) = translation.signatures(kernel)
    takes = [_form(kind) for _, kind in signature.takes]
    assert isinstance(signature.gives, Scalar)
    return {"symbol": symbol_of(kernel), "takes": takes, "gives": _FORMS[signature.gives]}


def _form(kind: Type) -> Any:
    """The form of an argument, as library.py reads it."""
    if isinstance(kind, Scalar):
        return _FORMS[kind]
    if isinstance(kind, Array):
        return ["array", np.dtype(kind.dtype).str, kind.dimensions]
    if isinstance(kind, BundleType):
        return ["bundle", name_of(_signature(kind.items)), words_of(kind.items)]
    return ["tuple", *map(_form, _items(kind))]


def _signature(kind: Type) -> Signature:
    """What lies in a bundle, as bundles.py says it."""
    if isinstance(kind, Array):
        return np.dtype(kind.dtype).str, kind.dimensions
    return (kind.kind if isinstance(kind, Struct) else tuple, *map(_signature, _items(kind)))


def _items(kind: Type) -> Sequence[Type]:
    assert isinstance(kind, (Several, Struct))
    return kind.items if isinstance(kind, Several) else [each for _, each in kind.fields]
