"""What begins in a pose: it looks as its kind does, and stands where its fields say."""

import numpy as np
import pytest

from sandbox.app.draw.looks import body_looks
from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.bake import keep_pose
from sandbox.editor.scene import make_scene
from sandbox.level.assembly.build_world import build_world
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.kinds.girder import GirderDef
from sandbox.level.kinds.jelly import BoxShape, JellyDef
from sandbox.level.kinds.ring import RingDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.kinds.web import WebDef
from sandbox.level.kinds.wheel import WheelDef

PLACED = (
    WheelDef(type="wheel", id="wheel", position=(5.0, 1.0), radius=0.5, thickness=0.15, segments=12),
    RingDef(type="ring", id="ring", position=(8.0, 1.0), radius=0.5, segments=12),
    WebDef(type="web", id="web", position=(11.0, 1.0), radius=0.5, rings=2, spokes=6),
    JellyDef(type="jelly", id="jelly", position=(14.0, 1.0), shape=BoxShape(box=(1.0, 1.0)), spacing=0.5),
    RopeDef(type="rope", id="rope", start=(0.0, 0.0), end=(2.0, 0.0), segments=4),
    BridgeDef(type="bridge", id="bridge", start=(0.0, 3.0), end=(2.0, 3.0), segments=4, height=0.5),
    GirderDef(type="girder", id="girder", start=(0.0, 5.0), end=(2.0, 5.0), segments=4, height=0.5),
)


@pytest.mark.parametrize("body", PLACED, ids=lambda body: body.type)
def test_a_body_that_begins_in_a_pose_looks_as_its_kind_does_and_stands_where_its_fields_say(body):
    document = Document(replaced(empty_level(), bodies=(body,)))
    world = build_world(document.level)
    shift = np.array([0.25, -1.353699])
    world.position[:] = world.position * [1.0, 0.999] + shift + [0.0, 0.00001]
    kept = keep_pose(document, world).level
    assert kept.bodies[0].pose is not None
    assert body_looks(kept) == body_looks(document.level)
    assert np.allclose(build_world(kept).rest_length, build_world(document.level).rest_length, rtol=1e-12)
    if hasattr(body, "position"):
        left, bottom, right, top = make_scene(kept).bounds()
        before = make_scene(document.level).bounds()
        middle = (left + right - before[0] - before[2]) / 2, (bottom + top - before[1] - before[3]) / 2
        moved = np.subtract(kept.bodies[0].position, body.position)
        assert moved == pytest.approx(middle, abs=1e-4)
        assert all(round(value, 4) == value for value in kept.bodies[0].position)
