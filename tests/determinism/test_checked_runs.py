"""Kernels that look at each index, in every golden and alone: none is out of range, and the bits are the same."""

import importlib.util
import sys

import pytest

from tests.determinism.matrix import outcome
from tests.determinism.twins import compare
from tests.support.wants import needs

# They make whole numbers of what may be beyond 2^63 here; places, spins and spacings of a world never are.
CASTS = {
    "sandbox.physics.integrate.integrate_positions", "sandbox.physics.meshing.fitting._most_on_border",
    "sandbox.physics.collision.broad_phase.cell_number", "sandbox.physics.collision.outline.new_outline",
    "sandbox.physics.commands.command.denied",
}  # fmt: skip


@needs("zig", importlib.util.find_spec("ziglang"))
@pytest.mark.whole_world
def test_no_index_is_out_of_range_in_any_golden():
    equal, text = outcome(sys.executable, "checked", [])
    assert equal and text.startswith("checked, ") and text.endswith(" 0 goldens differ"), text


@needs("zig", importlib.util.find_spec("ziglang"))
@pytest.mark.whole_world
def test_each_kernel_alone_gives_the_bits_of_its_source():
    differ, never, calls = compare(3, 1, [])
    assert set(differ) <= CASTS and calls > 2000
    # What these take does not come about by chance.
    assert len(never) < 175
