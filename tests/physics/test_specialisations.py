"""How often kernels are compiled: for which types of arguments, and that warming up covers them all."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="nothing is compiled here")
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
WARM_UP = f"""
from sandbox.physics import jit
from sandbox.physics.warm_up import warm_up
{STEPS}
warm_up()
before = count()
play()
assert count() == before, set(count().items()) ^ set(before.items())
print(*(f"{{name}} {{number}}" for name, number in before.items()), sep="\\n")
"""
LOAD = f"""
from sandbox.physics import jit
jit.start_interpreted()
import sandbox.physics.step
{STEPS}
from sandbox.physics.warm_up import warm_up
with jit.recorded("all"):
    warm_up()
noted = {{kernel.name: len(kernel.signatures) for kernel in jit.entries() if kernel.signatures}}
assert jit.switch_to_compiled()
for kernel in jit.entries():
    for signature in kernel.signatures.values():
        jit.compile_entry(kernel, signature)
before = count()
play()
assert count() == before, set(count().items()) ^ set(before.items())
assert noted == before
"""


def printed(script):
    environment = {**os.environ, "SANDBOX_KERNELS": "numba"}
    command = [sys.executable, "-c", script]
    ended = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.splitlines()


def test_warming_up_leaves_nothing_to_compile_and_each_entry_is_compiled_for_one_signature():
    numbers = dict(line.split() for line in printed(WARM_UP))
    assert len(numbers) > 20
    assert {name: int(number) for name, number in numbers.items() if number != "1"} == {}


def test_calls_that_interpreted_kernels_note_are_all_that_is_to_be_compiled():
    printed(LOAD)
