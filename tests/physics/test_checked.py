"""Kernels that look at every index: a wrong one ends the process, and says where."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

from tests.support.wants import needs

KERNELS = """
from sandbox.physics.arrays import Floats
from sandbox.physics.jit import kernel


@kernel
def read(values: Floats, k: int) -> float:
    return values[k]
"""
SCRIPT = """
import sys
from pathlib import Path
import numpy as np
import reading
from sandbox.physics.jit.library import Library
from sandbox.physics.jit.making.compiling import compiled
from sandbox.physics.jit.making.gathering import entry_of
from sandbox.physics.jit.making.platforms import this_machine
from sandbox.physics.jit.translate.program import Translation, symbol_of

kernel, here = reading.read._kernel, Path(reading.__file__).parent
translation, platform = Translation([kernel]), this_machine()
texts = {"reading.cpp": translation.text()}
(here / platform.file).write_bytes(compiled(texts, [symbol_of(kernel)], platform, here / "kept", ["KERNELS_CHECKED"]))
read = Library(here / platform.file, {kernel.name: entry_of(translation, kernel)}).function(kernel.name)
print(read(np.array([1.0, 2.0]), 1), flush=True)
read(np.array([1.0, 2.0]), int(sys.argv[1]))
"""
ROOT = Path(__file__).resolve().parents[2]


@needs("zig", importlib.util.find_spec("ziglang"))
def test_an_index_that_is_out_of_range_ends_a_checked_run_with_its_place(tmp_path):
    (tmp_path / "reading.py").write_text(KERNELS)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    for index in ("2", "-1"):
        command = [sys.executable, "-c", SCRIPT, index]
        ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert (ended.stdout, ended.returncode == 0) == ("2.0\n", False), ended.stderr
        assert re.search(rf"reading\.cpp:\d+: index {index} of 2", ended.stderr)
