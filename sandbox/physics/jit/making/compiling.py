"""Compiling: from the C++ of kernels to the library of a platform, by zig, which can for all of them on any of them.

Units are compiled at the same time, each by a process of its own, and linked into one library.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from sandbox.physics.jit.making.platforms import Platform

_CALLING = Path(__file__).with_name("calling.c")
# Determinism: no sum whose terms change places, no product that melts into one. Kernels ask for no error of a root.
_OPTIONS = (
    "-O3", "-g0", "-fno-builtin", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off", "-fno-stack-protector",
    "-fvisibility=hidden", "-Wall", "-Werror", "-Wno-unused",
)  # fmt: skip
_WEB = ("-fno-entry", "--export-memory", "--export=__heap_base", "--initial-memory=2097152", "--stack", "1048576")


class NotCompiled(Exception):
    """zig is not installed, or does not take what it was given."""


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
    """What zig is to do for an object file of a unit."""
    language = ("-std=c11",) if unit.endswith(".c") else ("-std=c++20", "-fno-exceptions", "-fno-rtti")
    position = () if platform.is_web else ("-fPIC",)
    sanitizer = ("-fsanitize-c=full",) if sanitized else ()
    flags = ("-cflags", *_OPTIONS, *("-DKERNELS_CHECKED",) * checked, *language, "--")
    return ["build-obj", *_target(platform), *position, *sanitizer, f"-femit-bin={unit}.o", *flags, unit]


def _linking(units: Sequence[str], symbols: Sequence[str], platform: Platform, sanitized: bool) -> list[str]:
    """What zig is to do for a library of object files, with what compilers take for granted, such as memset."""
    runtime = ("-fcompiler-rt", "-fubsan-rt") if sanitized else ("-fcompiler-rt",)
    linked = (*_target(platform), *runtime, f"-femit-bin={platform.file}", *(f"{unit}.o" for unit in units))
    if platform.is_web:
        return ["build-exe", *linked, *_WEB, *(f"--export={symbol}" for symbol in symbols)]
    return ["build-lib", "-dynamic", *linked, *platform.options]


def compiled(
    texts: Mapping[str, str],
    symbols: Sequence[str],
    platform: Platform,
    kept: Path,
    checked: bool = False,
    sanitized: bool = False,
) -> bytes:
    """The library of a platform: entries of kernels, with what calls them from Python; always the same bytes.

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
            (folder / _CALLING.name).write_bytes(_CALLING.read_bytes())
            units.append(_CALLING.name)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(lambda unit: _zig(folder, kept, _compiling(unit, platform, checked, sanitized)), units))
        _zig(folder, kept, _linking(units, symbols, platform, sanitized))
        return (folder / platform.file).read_bytes()
