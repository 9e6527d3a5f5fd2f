"""Another tick rate at the same pace: springs, bends and muscles go on per second as they did."""

import pytest

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.materials import set_rate_in_pace
from sandbox.physics.equation import frequency_from_coefficients
from sandbox.session.session import Session
from tests.app.conftest import small_level


def document(**materials):
    bodies = [
        {"type": "rope", "id": name, "start": [0, k], "end": [1, k], "segments": 1, "material": name, "pin": ["start"]}
        for k, name in enumerate(materials)
    ]
    return Document(small_level(materials=materials, bodies=bodies))


def test_at_twice_the_rate_springs_swing_as_fast_and_calm_as_fast_per_second():
    before = document(soft={"stiffness": 0.01, "damping": 0.02}, classic={"law": "hooke", "k": 20.0})
    after = set_rate_in_pace(before, 120)
    assert after.level.settings.tick_rate == 120
    old, new = before.level.materials["soft"], after.level.materials["soft"]
    readings = [
        frequency_from_coefficients(each.stiffness, each.damping, h) for each, h in ((old, 1 / 60), (new, 1 / 120))
    ]
    assert readings[1] == pytest.approx(readings[0], rel=1e-4)
    assert after.level.materials["classic"] == before.level.materials["classic"]
    assert set_rate_in_pace(after, 60).level.materials["soft"].stiffness == pytest.approx(0.01, rel=1e-4)


def test_a_stretched_spring_is_at_the_same_place_after_the_same_time():
    ends, start = [], document(soft={"stiffness": 0.01, "damping": 0.02})
    for level in (start.level, set_rate_in_pace(start, 240).level):
        session = Session(level)
        session.world.position[1] += (0.5, 0.0)
        for _ in range(level.settings.tick_rate // 2):
            session.advance()
        ends.append(session.world.position[1, 0])
    assert ends[0] == pytest.approx(ends[1], abs=5e-3) and abs(ends[0] - 1.0) > 0.1


def test_the_usual_material_gets_a_definition_and_muscles_keep_their_seconds():
    made = small_level(
        materials={},
        bodies=[{"type": "rope", "id": "r", "start": [0, 0], "end": [1, 0], "segments": 1,
                 "drive": {"amplitude": 0.1, "period": 30}, "bending": {"stiffness": 0.1}}],
    )  # fmt: skip
    level = set_rate_in_pace(Document(made), 120).level
    assert level.materials["default"].damping < 0.9
    assert level.bodies[0].drive.period == 60 and level.bodies[0].bending.stiffness < 0.1


def test_what_swings_too_fast_for_the_rate_is_refused_by_name():
    with pytest.raises(EditError, match=r'the material "stiff": .*too fast'):
        set_rate_in_pace(document(stiff={"stiffness": 0.9, "damping": 0.0}), 20)
    with pytest.raises(EditError, match="tick_rate"):
        set_rate_in_pace(document(soft={}), 0)
