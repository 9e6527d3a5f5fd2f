"""Where a pointer is taken to be."""

import math

import pytest

from sandbox.editor.items import Item
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.snap import snap
from sandbox.level.document.model import Level, ParticleDef
from sandbox.level.kinds.rope import RopeDef


@pytest.fixture(scope="module")
def scene():
    """A rope of short links from the origin to the right, and a ball."""
    return make_scene(
        Level(
            format="spring-sandbox/level",
            version=4,
            name="Snapping",
            bodies=(RopeDef(type="rope", id="rope", start=(0.0, 0.0), end=(1.0, 0.0), segments=10),),
            particles=(ParticleDef(id="ball", position=(0.5, 3.0)),),
        )
    )


def test_an_end_draws_the_pointer_before_a_nearer_particle(scene):
    at = snap(scene, (0.88, 0.02), 0.15, 0.5)
    assert (at.kind, at.name, at.point, at.hint) == ("end", "rope.end", (1.0, 0.0), "on rope.end")
    at = snap(scene, (0.62, 0.02), 0.15, 0.5)
    assert (at.kind, at.name, at.point) == ("particle", "rope.6", pytest.approx((0.6, 0.0)))
    assert snap(scene, (0.45, 3.05), 0.15).name == "ball"


def test_what_is_moved_does_not_draw_itself(scene):
    rope = frozenset([Item("body", "rope")])
    assert snap(scene, (0.98, 0.02), 0.15, skip=rope).kind == "free"
    assert snap(scene, (0.98, 0.02), 0.15, 0.5, skip=rope).point == (1.0, 0.0)


def test_without_reach_and_grid_the_pointer_is_where_it_is(scene):
    at = snap(scene, (1.0000004, 0.1), 0.0, None, (0.0, 0.0))
    assert (at.kind, at.name, at.point, at.hint) == ("free", None, (1.0, 0.1), "")
    assert at.raw == (1.0000004, 0.1)


def test_a_grid_gives_short_numbers(scene):
    at = snap(scene, (0.29, 5.02), 0.01, 0.1)
    assert (at.kind, at.point, at.hint) == ("grid", (0.3, 5.0), "grid 0.1 m")
    assert str(snap(scene, (-0.01, 5.0), 0.01, 0.1).point) == "(0.0, 5.0)"


def test_round_directions_draw_the_pointer_and_say_which(scene):
    at = snap(scene, (12.0, 12.1), 0.2, None, (10.0, 10.0))
    assert (at.kind, at.hint) == ("angle", "45°")
    assert at.point == pytest.approx((12.05, 12.05))
    turned = math.radians(105.0)
    at = snap(scene, (10 + 3 * math.cos(turned), 10 + 3 * math.sin(turned) + 0.02), 0.2, None, (10.0, 10.0))
    assert at.hint == "105°"
    assert snap(scene, (8.0, 9.99), 0.2, None, (10.0, 10.0)).hint == "180°"
    assert snap(scene, (11.0, 9.43), 0.2, None, (10.0, 10.0)).hint == "-30°", "as what is drawn says it"
    assert snap(scene, (12.0, 11.5), 0.2, None, (10.0, 10.0)).kind == "free"


def test_a_direction_meets_the_grid_where_it_crosses_its_lines(scene):
    at = snap(scene, (11.97, 11.14), 0.2, 0.5, (10.0, 10.0))
    assert (at.kind, at.hint) == ("angle", "30°")
    assert at.point == pytest.approx((12.0, 10.0 + 2.0 * math.tan(math.radians(30.0))), abs=1e-6)


def test_a_point_of_the_grid_that_is_nearer_than_the_direction_wins(scene):
    at = snap(scene, (14.0, 11.01), 0.3, 1.0, (10.0, 10.0))
    assert (at.kind, at.point) == ("grid", (14.0, 11.0))


def test_near_the_anchor_no_direction_draws_the_pointer(scene):
    assert snap(scene, (10.1, 10.0), 0.2, None, (10.0, 10.0)).kind == "free"
