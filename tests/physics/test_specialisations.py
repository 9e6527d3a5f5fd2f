"""How often kernels are compiled: for which types of arguments, and that calling every kernel covers them all."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from sandbox.physics.jit.library import read_manifest
from tests.support.wants import needs

pytestmark = needs("numba", importlib.util.find_spec("numba"))
ROOT = Path(__file__).resolve().parents[2]

STEPS = """
from sandbox.physics.step import step
from tests.determinism.kernel_script import busy_world, touching_world

def count():
    return {kernel.name: len(kernel.ready().overloads) for kernel in jit.entries() if kernel.ready().overloads}

def play():
    for solver in ("single_pass", "iterative", "direct"):
        for make in busy_world, touching_world:
            world = make(solver, "auto")
            for _ in range(3):
                step(world)
"""
CALLS = f"""
from sandbox.physics import jit
from sandbox.physics.every_kernel import call_every_kernel
{STEPS}
call_every_kernel()
before = count()
play()
assert count() == before, set(count().items()) ^ set(before.items())
print(*(f"{{name}} {{number}}" for name, number in before.items()), sep="\\n")
"""
NOTES = """
from sandbox.app.kernels.compiling import needed_kernels
print(*(f"{kernel.name} {len(kernel.signatures)}" for kernel in needed_kernels()), sep="\\n")
"""


def printed(script):
    environment = {**os.environ, "SANDBOX_KERNELS": "numba"}
    command = [sys.executable, "-c", script]
    ended = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.splitlines()


@pytest.mark.whole_world
def test_calling_every_kernel_leaves_nothing_to_compile_and_each_entry_is_compiled_for_one_signature():
    numbers = dict(line.split() for line in printed(CALLS))
    assert len(numbers) > 10
    assert {name: int(number) for name, number in numbers.items() if number != "1"} == {}


def test_interpreted_kernels_note_one_signature_each_and_the_libraries_hold_them_all():
    numbers = dict(line.split() for line in printed(NOTES) if line.startswith("sandbox."))
    assert set(numbers.values()) == {"1"}
    assert set(numbers) == set(read_manifest()["entries"])
