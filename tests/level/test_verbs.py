"""Whatever is done to soft bodies of shipped levels, a while later they are in the picture and not in each other."""

import itertools

import pytest

from sandbox.level.reading.files import load_level
from sandbox.physics.jit import COMPILED
from tests.support import verbs

pytestmark = [
    pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes"),
    pytest.mark.whole_world,
]
# Melted, what is stiff explodes.
SAFE = [verb for verb in verbs.VERBS if "melt" not in verb]
# A bed or a drum whose own springs sag by metres throws what lies in it when they are rigid again.
THROWS = {"soften and stiffen springs"}
STEADY = ("jelly_pile", "desk_toy", "rope_bridge_jelly", "beating_heart", "jelly_cube", "jelly_wheel", "curtain")
CASES = [
    *itertools.product(STEADY, SAFE),
    *((name, verb) for name in ("trampoline", "tumble_drum") for verb in SAFE if verb not in THROWS),
    *((name, verb) for name in ("jelly_pile", "desk_toy", "beating_heart") for verb in ("melt and make whole",)),
]


@pytest.mark.parametrize(("name", "verb"), CASES)
def test_what_is_done_leaves_a_picture_in_which_nothing_lies_in_another(name, verb):
    found = verbs.faults(verbs.played(load_level(name), verb))
    if "melt" in verb:
        # What was stirred into another while it was melted does not always come out again.
        found = [fault for fault in found if "picture" in fault]
    assert found == []
