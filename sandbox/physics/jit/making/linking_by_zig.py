"""Linking: from an object file to the library of a platform, by zig, which can for all of them on any of them."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from sandbox.physics.jit.making.platforms import Platform

_CALLING = Path(__file__).with_name("calling.c")
_C_OPTIONS = ("-O2", "-g0", "-std=c11", "-fno-builtin", "-fno-stack-protector", "-fvisibility=hidden")
# With what compilers take for granted inside it, such as memset: a library needs none of the system's.
_OPTIONS = ("-dynamic", "-fcompiler-rt", "-O", "ReleaseFast", "-fstrip")
_WEB_OPTIONS = (
    "--no-entry", "--export-memory", "--export=__heap_base", "--initial-memory=2097152", "-z", "stack-size=1048576",
    "--stack-first", "--strip-all",
)  # fmt: skip


def _zig(folder: Path, *arguments: str) -> None:
    """Run zig in a folder; what it keeps stays there.

    Raises:
        RuntimeError: with what zig said, where it fails.
    """
    kept = {"ZIG_GLOBAL_CACHE_DIR": str(folder / "kept"), "ZIG_LOCAL_CACHE_DIR": str(folder / "kept")}
    command = [sys.executable, "-m", "ziglang", *arguments]
    ended = subprocess.run(command, cwd=folder, env={**os.environ, **kept}, capture_output=True, text=True, check=False)
    if ended.returncode:
        raise RuntimeError(f"zig {arguments[0]} failed: {ended.stderr.strip()}")


def linked(code: bytes, symbols: Sequence[str], platform: Platform) -> bytes:
    """The library of a platform: an object file of entries, with what calls them from Python."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "entries.o").write_bytes(code)
        (folder / "calling.c").write_bytes(_CALLING.read_bytes())
        if platform.suffix == "wasm":
            exports = [f"--export={symbol}" for symbol in symbols]
            _zig(folder, "wasm-ld", *_WEB_OPTIONS, *exports, "entries.o", "-o", platform.file)
        else:
            sources = ("-cflags", *_C_OPTIONS, "--", "calling.c", "entries.o")
            made = f"-femit-bin={platform.file}"
            _zig(folder, "build-lib", "-target", platform.target, *_OPTIONS, *platform.options, *sources, made)
        return (folder / platform.file).read_bytes()
