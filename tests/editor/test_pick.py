"""What is under the pointer, in a box, in a lasso."""

import pytest

from sandbox.editor.items import Item
from sandbox.editor.pick import combined, item_at, items_in_box, items_in_lasso, items_of_material, particle_at
from sandbox.editor.scene import make_scene
from sandbox.level.document.model import Level, ParticleDef, SpringDef
from sandbox.level.kinds.jelly import BoxShape, JellyDef
from sandbox.level.kinds.rope import RopeDef
from tests.support.zoo import zoo

BALL, SMALL, LINK, CUBE, ROPE = (
    Item("particle", "ball"),
    Item("particle", "small"),
    Item("spring", 0),
    Item("body", "cube"),
    Item("body", "rope"),
)


@pytest.fixture(scope="module")
def scene():
    """A cube of jelly about the origin, a rope right of it, a ball with a small particle on it, and a spring."""
    level = Level(
        format="spring-sandbox/level",
        version=4,
        name="Picking",
        bodies=(
            JellyDef(type="jelly", id="cube", shape=BoxShape(box=(2.0, 2.0)), spacing=1.0),
            RopeDef(type="rope", id="rope", start=(4.0, 0.0), end=(8.0, 0.0), segments=4),
        ),
        particles=(
            ParticleDef(id="ball", position=(0.0, 5.0), radius=0.5),
            ParticleDef(id="small", position=(0.2, 5.0)),
        ),
        springs=(SpringDef(a="ball", b="rope.start"),),
    )
    return make_scene(level)


def test_a_particle_is_hit_on_its_disc_and_a_little_beside_it(scene):
    assert item_at(scene, (-0.45, 5.0), 0.0) == BALL
    assert item_at(scene, (-0.55, 5.0), 0.1) == BALL
    assert item_at(scene, (-0.65, 5.0), 0.1) is None


def test_of_discs_that_overlap_the_one_with_the_nearest_centre_is_hit(scene):
    assert item_at(scene, (0.2, 5.0), 0.0) == SMALL
    assert item_at(scene, (0.05, 5.0), 0.0) == BALL


def test_beside_all_discs_the_one_with_the_nearest_border_is_hit():
    particles = ParticleDef(id="large", radius=0.5), ParticleDef(id="small", position=(1.0, 0.0))
    scene = make_scene(Level(format="spring-sandbox/level", version=4, name="Beside", particles=particles))
    assert particle_at(scene, (0.6, 0.0), 0.4) == 0
    assert particle_at(scene, (0.9, 0.0), 0.4) == 1


def test_a_body_is_open_where_no_spring_closes_it():
    corners = [(0.0, 3.0), (0.0, 0.0), (3.0, 0.0), (3.0, 3.0)]
    for turns in range(4):
        cup = RopeDef(type="rope", id="cup", start=(0.0, 0.0), end=(3.0, 0.0), segments=3, pose=tuple(corners))
        scene = make_scene(Level(format="spring-sandbox/level", version=4, name="Cup", bodies=(cup,)))
        assert item_at(scene, (1.5, 1.4), 0.1) is None, turns
        corners = [(3.0 - y, x) for x, y in corners]


def test_of_particles_in_one_place_the_one_drawn_last_is_hit():
    particles = tuple(ParticleDef(id=name) for name in ("under", "over"))
    level = Level(format="spring-sandbox/level", version=4, name="Stack", particles=particles)
    assert particle_at(make_scene(level), (0.0, 0.0), 0.0) == 1


def test_particles_come_before_springs_and_springs_before_the_insides_of_bodies(scene):
    assert item_at(scene, (4.05, 0.05), 0.3) == ROPE
    assert item_at(scene, (2.0, 2.6), 0.2) == LINK
    assert item_at(scene, (0.3, 0.45), 0.01) == CUBE
    assert item_at(scene, (2.0, -3.0), 0.2) is None


def test_the_inside_of_a_body_ends_at_its_border(scene):
    assert item_at(scene, (0.9, 0.45), 0.0) == CUBE
    assert item_at(scene, (1.1, 0.45), 0.0) is None


def test_a_box_takes_what_lies_in_it_whole_from_whatever_corner_it_is_drawn(scene):
    assert items_in_box(scene, (-1.0, -1.0, 1.0, 1.0)) == {CUBE}
    assert items_in_box(scene, (1.0, 1.0, -1.0, -1.0)) == {CUBE}
    assert items_in_box(scene, (-0.9, -1.0, 1.0, 1.0)) == frozenset()
    assert items_in_box(scene, (-1.0, -1.0, 9.0, 6.0)) == {CUBE, ROPE, BALL, SMALL, LINK}


def test_a_lasso_takes_what_lies_in_it_whole_and_leaves_what_lies_in_its_bay(scene):
    around_both = [(-2.0, -2.0), (9.0, -2.0), (9.0, 2.0), (-2.0, 2.0)]
    assert items_in_lasso(scene, around_both) == {CUBE, ROPE}
    bay = [(-2.0, -2.0), (9.0, -2.0), (9.0, 2.0), (5.0, 2.0), (5.0, -1.5), (4.5, -1.5), (4.5, 2.0), (-2.0, 2.0)]
    assert items_in_lasso(scene, bay) == {CUBE, ROPE}
    assert items_in_lasso(scene, [*bay[:3], (6.5, 2.0), (6.5, -1.5), (5.5, -1.5), (5.5, 2.0), bay[-1]]) == {CUBE}
    assert items_in_lasso(scene, around_both[:2]) == frozenset()


def test_everything_of_a_material_is_found_bodies_and_springs():
    assert items_of_material(zoo(), "steel") == {Item("body", "rope"), Item("spring", 0)}
    assert items_of_material(zoo(), "unused") == frozenset()


def test_picking_replaces_adds_takes_away_and_toggles():
    old, new = frozenset({BALL, CUBE}), frozenset({CUBE, ROPE})
    assert combined(old, new, "replace") == new
    assert combined(old, new, "add") == {BALL, CUBE, ROPE}
    assert combined(old, new, "subtract") == {BALL}
    assert combined(old, new, "toggle") == {BALL, ROPE}
