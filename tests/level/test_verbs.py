"""Whatever is done to the soft bodies of shipped levels, a while later they lie in the picture, not in each other."""

import pytest

from sandbox.level.reading.files import load_level
from sandbox.physics.jit import COMPILED
from tests.support import verbs

pytestmark = [
    pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes"),
    pytest.mark.whole_world,
]
LEVELS = ("jelly_pile", "desk_toy", "trampoline", "rope_bridge_jelly", "beating_heart", "jelly_cube", "tumble_drum")


@pytest.mark.parametrize("verb", [verb for verb in verbs.VERBS if "melt" not in verb])
@pytest.mark.parametrize("name", LEVELS)
def test_what_is_done_leaves_a_picture_in_which_nothing_lies_in_another(name, verb):
    assert verbs.faults(verbs.played(load_level(name), verb)) == []
