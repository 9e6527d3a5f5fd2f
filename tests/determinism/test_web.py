"""Kernels give the same bits in WebAssembly."""

import shutil

import pytest

from sandbox.physics import jit
from tests.determinism.kernel_script import busy_world, touching_world
from tests.determinism.web import Image, differences, watched

pytestmark = [
    pytest.mark.skipif(shutil.which("node") is None, reason="there is no node to run it"),
    pytest.mark.skipif(jit.way() != "library", reason="calls are noted with the types of the library"),
]
TICKS = 12


@pytest.mark.parametrize("make", [busy_world, touching_world])
@pytest.mark.parametrize("solver", ["single_pass", "iterative", "direct"])
def test_a_run_changes_the_same_bits_of_memory_in_webassembly(make, solver):
    image, world = Image(), make(solver, 2)

    def play():
        from sandbox.physics.step import step

        for tick in range(TICKS):
            if tick == 3:
                world.hold(0, 7, (1.0, 1.5), 60.0, 0.9)
            step(world)
            yield

    watched(image, play())
    said = differences(image)
    assert image.calls > TICKS and said.endswith(" 0 differ"), said


def test_one_ulp_in_memory_is_told():
    image, world = Image(), busy_world("direct", 1)

    def play():
        from sandbox.physics.step import step

        for _ in range(2):
            step(world)
            yield

    watched(image, play())
    content = bytearray(image.content())
    content[-1] ^= 1
    image.content = lambda: bytes(content)
    assert differences(image).endswith(" 1 differ")
