"""Compiling: every kernel that Python calls becomes C++, and that the library of a platform, by zig on any of them.

Units are compiled at the same time, each by a process of its own, and linked into one library.
"""

import importlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.physics.jit import Kernel, entries
from sandbox.physics.jit.bundles import Signature, name_of
from sandbox.physics.jit.making.platforms import Platform
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
from sandbox.processors import cores

CALLING = Path(__file__).with_name("calling.c")
# Determinism: no sum whose terms change places, no product that melts into one. Kernels ask for no error of a root.
_OPTIONS = (
    "-O3", "-g0", "-fno-builtin", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off", "-fno-stack-protector",
    "-fvisibility=hidden", "-Wall", "-Werror", "-Wno-unused",
)  # fmt: skip
_WEB = ("-fno-entry", "--export-memory", "--export=__heap_base", "--initial-memory=2097152", "--stack", "1048576")
# Entries are divided so that few kernels are called from two units: each is compiled by itself, all at once.
_UNITS = {"tick.cpp": "sandbox.physics.pipeline.tick", "physics.cpp": "sandbox.physics", "painting.cpp": "sandbox"}
_FORMS = {INTEGER: "integer", FLOAT: "float", FLAG: "flag", NOTHING: "nothing"}


class NotCompiled(Exception):
    """zig is not installed, or refuses its input."""


@dataclass(frozen=True)
class Gathered:
    """Kernels in C++, by the names of files, and entries by their names, as a manifest has them."""

    texts: dict[str, str]
    entries: dict[str, dict[str, Any]]

    @property
    def symbols(self) -> list[str]:
        """Symbols of the entries in a library."""
        return [entry["symbol"] for entry in self.entries.values()]


def all_entries() -> list[Kernel]:
    """Every kernel of the package that Python calls, by name, from all modules that have any."""
    for name, file in source_files():
        if name.endswith(".py") and has_kernels(text_of(file)):
            importlib.import_module(f"sandbox.{name.removesuffix('.py').replace('/', '.')}")
    return sorted((one for one in entries() if one.name.startswith("sandbox.")), key=lambda kernel: kernel.name)


def gathered(kernels: Sequence[Kernel]) -> Gathered:
    """Kernels in C++. Raises Untranslatable for code outside the language of kernels."""
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
    """An entry as a manifest lists it."""
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
    """The layout of a bundle, in the words of bundles.py."""
    if isinstance(kind, Array):
        return np.dtype(kind.dtype).str, kind.dimensions
    return (kind.kind if isinstance(kind, Struct) else tuple, *map(_signature, _items(kind)))


def _items(kind: Type) -> Sequence[Type]:
    assert isinstance(kind, (Several, Struct))
    return kind.items if isinstance(kind, Several) else [each for _, each in kind.fields]


def compiled(
    texts: Mapping[str, str], symbols: Sequence[str], platform: Platform, kept: Path, checked: bool = False,
    sanitized: bool = False,
) -> bytes:  # fmt: skip
    """The library of a platform: entries of kernels, with their callers from Python; always the same bytes.

    texts: C++ by the names of its files. symbols: of the entries. kept: a folder for what zig makes once. checked:
    it is to end the process, and say where, at an index out of range; sanitized: at what C++ leaves undefined.

    Raises:
        NotCompiled: with what zig says.
    """
    kept.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="utf-8")
        units = list(texts)
        if not platform.is_web:
            (folder / CALLING.name).write_bytes(CALLING.read_bytes())
            units.append(CALLING.name)
        with ThreadPoolExecutor(cores()) as pool:
            list(pool.map(lambda unit: _zig(folder, kept, _compiling(unit, platform, checked, sanitized)), units))
        _zig(folder, kept, _linking(units, symbols, platform, sanitized))
        return (folder / platform.file).read_bytes()


def _zig(folder: Path, kept: Path, arguments: Sequence[str]) -> None:
    # What is kept is what every library takes from zig, not what is made here.
    variables = {"ZIG_GLOBAL_CACHE_DIR": str(kept), "ZIG_LOCAL_CACHE_DIR": str(folder / "cache")}
    command = [sys.executable, "-m", "ziglang", *arguments]
    ended = subprocess.run(
        command, cwd=folder, env={**os.environ, **variables}, capture_output=True, text=True, check=False
    )
    if ended.returncode:
        raise NotCompiled(ended.stderr.strip())


def _target(platform: Platform) -> list[str]:
    return ["-target", platform.target, "-mcpu", platform.processor, "-O", "ReleaseFast", "-fstrip"]


def _compiling(unit: str, platform: Platform, checked: bool, sanitized: bool) -> list[str]:
    """The command for zig that compiles a unit to an object file."""
    language = ("-std=c11",) if unit.endswith(".c") else ("-std=c++20", "-fno-exceptions", "-fno-rtti")
    position = () if platform.is_web else ("-fPIC",)
    sanitizer = ("-fsanitize-c=full",) if sanitized else ()
    flags = ("-cflags", *_OPTIONS, *("-DKERNELS_CHECKED",) * checked, *language, "--")
    return ["build-obj", *_target(platform), *position, *sanitizer, f"-femit-bin={unit}.o", *flags, unit]


def _linking(units: Sequence[str], symbols: Sequence[str], platform: Platform, sanitized: bool) -> list[str]:
    """The command for zig that links object files to a library, with what compilers need, such as memset."""
    runtime = ("-fcompiler-rt", "-fubsan-rt") if sanitized else ("-fcompiler-rt",)
    linked = (*_target(platform), *runtime, f"-femit-bin={platform.file}", *(f"{unit}.o" for unit in units))
    if platform.is_web:
        return ["build-exe", *linked, *_WEB, *(f"--export={symbol}" for symbol in symbols)]
    return ["build-lib", "-dynamic", *linked, *platform.options]
