"""Kernels give the same bits in WebAssembly and on another processor."""

import pytest

from sandbox.physics import jit
from sandbox.physics.step import step
from tests.determinism.elsewhere import ARM64, WEB, Image, Missing, watched
from tests.determinism.kernel_script import busy_world, touching_world
from tests.support.wants import skip_without

pytestmark = pytest.mark.skipif(jit.way() != "library", reason="calls are noted with the types of the library")
TICKS = 12


def image_of(machine):
    try:
        machine.command()
    except Missing as fault:
        skip_without(str(fault))
    return Image(machine)


@pytest.mark.parametrize("machine", [WEB, ARM64], ids=lambda machine: machine.name)
@pytest.mark.parametrize("make", [busy_world, touching_world])
@pytest.mark.parametrize("solver", ["single_pass", "iterative", "direct"])
def test_a_run_changes_the_same_bits_of_memory_on_another_machine(make, solver, machine):
    image, world = image_of(machine), make(solver, 2)
    with watched([image]) as watch:
        for tick in range(TICKS):
            if tick == 3:
                world.hold(0, 7, (1.0, 1.5), 60.0, 0.9)
            step(world)
            watch()
    said = image.differences()
    assert image.calls > TICKS and said.endswith(" 0 differ"), said


@pytest.mark.parametrize("machine", [WEB, ARM64], ids=lambda machine: machine.name)
def test_one_ulp_in_memory_is_told(machine):
    image, world = image_of(machine), busy_world("direct", 1)
    with watched([image]) as watch:
        for _ in range(2):
            step(world)
            watch()
    content = bytearray(image.content())
    content[-1] ^= 1
    image.content = lambda: bytes(content)
    assert image.differences().endswith(" 1 differ")
