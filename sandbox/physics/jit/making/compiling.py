"""Compiling: from the C++ of kernels to the library of a platform, by zig, which can for all of them on any of them."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from sandbox.physics.jit.making.platforms import Platform

_CALLING = Path(__file__).with_name("calling.c")
# Determinism: no sum whose terms change places, no product that melts into one. Kernels ask for no error of a root.
_OPTIONS = (
    "-O3", "-g0", "-fno-builtin", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off", "-fno-stack-protector",
    "-fvisibility=hidden", "-Wall", "-Werror", "-Wno-unused",
)  # fmt: skip
_CPP = ("-std=c++20", "-fno-exceptions", "-fno-rtti")
# With what compilers take for granted inside it, such as memset: a library needs none of the system's.
_LIBRARY = ("-fcompiler-rt", "-O", "ReleaseFast", "-fstrip")
_WEB = ("-fno-entry", "--export-memory", "--export=__heap_base", "--initial-memory=2097152", "--stack", "1048576")


class NotCompiled(Exception):
    """zig is not installed, or does not take what it was given."""


def _zig(folder: Path, kept: Path, arguments: Sequence[str]) -> None:
    variables = {"ZIG_GLOBAL_CACHE_DIR": str(kept), "ZIG_LOCAL_CACHE_DIR": str(kept)}
    command = [sys.executable, "-m", "ziglang", *arguments]
    ended = subprocess.run(
        command, cwd=folder, env={**os.environ, **variables}, capture_output=True, text=True, check=False
    )
    if ended.returncode:
        raise NotCompiled(ended.stderr.strip())


def compiled(
    texts: Mapping[str, str], symbols: Sequence[str], platform: Platform, kept: Path, defines: Sequence[str] = ()
) -> bytes:
    """The library of a platform: entries of kernels, with what calls them from Python; always the same bytes.

    texts: C++ by the names of its files. symbols: of the entries. kept: a folder for what zig makes once. defines:
    names that C++ is to know, such as KERNELS_CHECKED.

    Raises:
        NotCompiled: with what zig says.
    """
    kept.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="utf-8")
        (folder / "calling.c").write_bytes(_CALLING.read_bytes())
        options = (*_OPTIONS, *(f"-D{define}" for define in defines))
        sources = ["-cflags", *options, *_CPP, "--", *texts]
        target = ["-target", platform.target, "-mcpu", platform.processor, *_LIBRARY, f"-femit-bin={platform.file}"]
        if platform.suffix == "wasm":
            exports = [f"--export={symbol}" for symbol in symbols]
            _zig(folder, kept, ["build-exe", *target, *_WEB, *exports, *sources])
        else:
            sources += ["-cflags", *options, "-std=c11", "--", "calling.c"]
            _zig(folder, kept, ["build-lib", "-dynamic", *target, *platform.options, *sources])
        return (folder / platform.file).read_bytes()
