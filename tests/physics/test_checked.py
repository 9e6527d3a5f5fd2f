"""Checked kernels: an index out of range, or what C++ leaves undefined, ends the process, which says where."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.wants import needs

KERNELS = """
from sandbox.physics.arrays import Floats
from sandbox.physics.jit import kernel


@kernel
def read(values: Floats, k: int) -> float:
    return values[k]


@kernel
def doubled(count: int) -> int:
    total = 0
    for each in (count, count):
        total += each
    return total
"""
SCRIPT = """
import sys
from pathlib import Path
import numpy as np
import tried
from sandbox.physics.jit.library import Library
from sandbox.physics.jit.making.compiling import compiled
from sandbox.physics.jit.making.compiling import entry_of
from sandbox.physics.jit.making.platforms import this_machine
from sandbox.physics.jit.translate.program import Translation, symbol_of

kernels, here = (tried.read._kernel, tried.doubled._kernel), Path(tried.__file__).parent
translation, platform = Translation(kernels), this_machine()
entries = {kernel.name: entry_of(translation, kernel) for kernel in kernels}
symbols = [symbol_of(kernel) for kernel in kernels]
texts = {"tried.cpp": translation.text()}
(here / platform.file).write_bytes(compiled(texts, symbols, platform, here / "kept", True, True))
library = Library(here / platform.file, entries)
read, doubled, values = library.function("tried.read"), library.function("tried.doubled"), np.array([1.0, 2.0])
print(read(values, 1), doubled(3), flush=True)
eval(sys.argv[1])
"""
ROOT = Path(__file__).resolve().parents[2]
WRONG = {
    "read(values, 2)": r"tried\.cpp:\d+: index 2 of 2",
    "read(values, -1)": r"tried\.cpp:\d+: index -1 of 2",
    "doubled(2**62)": r"signed integer overflow: 4611686018427387904 \+ 4611686018427387904",
}


@pytest.mark.whole_world
@needs("zig", importlib.util.find_spec("ziglang"))
def test_what_cpp_leaves_undefined_ends_a_checked_run_and_is_named(tmp_path):
    (tmp_path / "tried.py").write_text(KERNELS)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    for call, named in WRONG.items():
        command = [sys.executable, "-c", SCRIPT, call]
        ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert (ended.stdout, ended.returncode == 0) == ("2.0 6\n", False), ended.stderr
        assert re.search(named, ended.stderr), ended.stderr
