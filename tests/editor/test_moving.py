"""Moving, turning, scaling, mirroring and lining up: where the particles of the world are then."""

import math

import numpy as np
import pytest

from sandbox.editor.document import Document, EditError, empty_level, select
from sandbox.editor.edits.fields import set_field
from sandbox.editor.edits.moving import align, can_scale_unevenly, distribute, mirror, move, rotate, scale
from sandbox.editor.edits.placing import add_body, add_particle
from sandbox.editor.items import Item, items_of
from sandbox.editor.scene import make_scene
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import ParticleDef
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.kinds.girder import GirderDef
from sandbox.level.kinds.jelly import CircleShape, JellyDef, PolygonShape
from sandbox.level.kinds.rope import RopeDef
from tests.support.zoo import zoo

BODIES = [body.id for body in zoo().bodies]


def chosen(*ids):
    """The zoo with those of its bodies and loose particles selected."""
    level = zoo()
    return Document(level, frozenset(item for item in items_of(level) if item.key in ids))


def alone(name):
    """One body of the zoo in a level of its own, selected."""
    body = next(b for b in zoo().bodies if b.id == name).model_copy(update={"material": "steel"})
    return add_body(Document(empty_level()), body)


def cloud(level):
    """Places and masses of the particles, and middles of the springs with their rest lengths, in an order of places."""
    world = build_world(level)
    count = len(level_names(level))
    particles = np.column_stack([world.position, world.mass, world.inverse_mass == 0.0])[:count]
    springs = np.flatnonzero(world.material >= 0)
    middles = (world.position[world.particle_a[springs]] + world.position[world.particle_b[springs]]) / 2.0
    return ordered(particles), ordered(np.column_stack([middles, world.rest_length[springs]]))


def level_names(level):
    scene = make_scene(level)
    return [scene.names(slot) for slot in range(len(scene.mass))]


def ordered(rows):
    rows = np.round(rows, 9) + 0.0
    return rows[np.lexsort(rows.T)]


def mapped(rows, function):
    rows = rows.copy()
    rows[:, :2] = [function(x, y) for x, y in rows[:, :2]]
    return ordered(rows)


@pytest.mark.parametrize("name", BODIES)
def test_a_move_moves_every_particle_and_changes_no_spring(name):
    before = alone(name)
    after = move(before, 2.5, -1.25)
    for old, new in zip(cloud(before.level), cloud(after.level), strict=True):
        assert np.allclose(new, mapped(old, lambda x, y: (x + 2.5, y - 1.25)), atol=1e-8)
    assert after.selection == before.selection


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("angle", [0.7, math.pi / 2, -3.0])
def test_a_turn_turns_every_particle_with_its_pins_and_cuts_and_keeps_all_rest_lengths(name, angle):
    before = alone(name)
    after = rotate(before, angle, (1.0, 2.0))

    def turned(x, y):
        c, s = math.cos(angle), math.sin(angle)
        return 1.0 + (x - 1.0) * c - (y - 2.0) * s, 2.0 + (x - 1.0) * s + (y - 2.0) * c

    for old, new in zip(cloud(before.level), cloud(after.level), strict=True):
        assert np.allclose(new, mapped(old, turned), atol=1e-7)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_mirror_image_has_every_particle_pin_and_cut_on_the_other_side(name, axis):
    before = alone(name)
    after = mirror(before, axis, (1.0, 2.0))

    def over(x, y):
        return (2.0 - x, y) if axis == "x" else (x, 4.0 - y)

    for old, new in zip(cloud(before.level), cloud(after.level), strict=True):
        assert np.allclose(new, mapped(old, over), atol=1e-7)
    again = mirror(after, axis, (1.0, 2.0))
    for old, new in zip(cloud(before.level), cloud(again.level), strict=True):
        assert np.allclose(new, old, atol=1e-7)


@pytest.mark.parametrize("name", BODIES)
def test_an_even_scale_makes_everything_larger_rest_lengths_too(name):
    before = alone(name)
    after = scale(before, 1.5, 1.5, (1.0, 2.0))
    (old, springs), (new, longer) = cloud(before.level), cloud(after.level)
    larger = mapped(old, lambda x, y: (1.0 + 1.5 * (x - 1.0), 2.0 + 1.5 * (y - 2.0)))
    assert np.allclose(new, larger, atol=1e-7)
    assert np.allclose(np.sort(longer[:, 2]), 1.5 * np.sort(springs[:, 2]), atol=1e-7)


def test_a_motor_turns_the_other_way_in_a_mirror_and_as_before_when_turned():
    document = Document(zoo(), frozenset([Item("body", "wheel")]))
    speeds = [
        after.level.bodies[4].motor.speed
        for after in (
            mirror(document, "x", (0.0, 0.0)),
            mirror(document, "y", (1.0, 0.0)),
            rotate(document, 2.0, (0, 0)),
        )
    ]
    assert speeds == [-3.0, -3.0, 3.0]


def test_references_follow_into_a_mirror_image():
    before = chosen("beam", "cube", "deck")
    scene = make_scene(before.level)
    after = mirror(before, "y", (0.0, 0.0))
    flipped = make_scene(after.level)
    ends = zip(before.level.springs[:3], after.level.springs[:3], strict=True)
    for old, new in ends:
        place, image = scene.position[scene.slot(old.b)], flipped.position[flipped.slot(new.b)]
        assert np.allclose(image, place * [1.0, -1.0]), new
    # A girder's second row lies on its right, so that its image begins where it ended.
    assert after.level.springs[2].b == "beam.start"
    assert after.level.bodies[2].pin == ("end",)


def test_a_mirrored_pose_is_the_image_of_the_pose_to_the_last_particle():
    bent = tuple((0.1 * k, 0.01 * k * k) for k in range(make_scene(alone("cube").level).mass.size))
    before = set_field(alone("cube"), [Item("body", "cube")], "pose", bent)
    after = mirror(before, "x", (0.0, 0.0))
    image = {(round(-x, 9), round(y, 9)) for x, y in bent}
    assert {(round(x, 9), round(y, 9)) for x, y in after.level.bodies[0].pose} == image
    assert math.isclose(make_scene(after.level).rest_length.sum(), make_scene(before.level).rest_length.sum())


def test_start_velocities_turn_with_their_body_and_stay_in_a_scale():
    document = chosen("rope")
    assert rotate(document, math.pi / 2, (0.0, 0.0)).level.bodies[0].velocity == (0.0, 1.0)
    assert mirror(document, "x", (0.0, 0.0)).level.bodies[0].velocity == (-1.0, 0.0)
    assert scale(document, 2.0, 2.0, (0.0, 0.0)).level.bodies[0].velocity == (1.0, 0.0)


def test_a_given_rest_length_between_scaled_things_scales_with_them():
    document = scale(chosen("hook", "hook 2"), 2.0, 2.0, (0.0, 0.0))
    assert document.level.springs[3].rest_length == 4.0
    assert document.level.springs[0].rest_length == 1.5


def test_a_box_of_jelly_can_be_stretched_along_its_sides_alone():
    level = add_body(
        Document(empty_level()),
        JellyDef.model_validate({"type": "jelly", "id": "j", "shape": {"box": (1.0, 2.0)}, "spacing": 0.25}),
    )
    assert can_scale_unevenly(level)
    upright = rotate(level, math.pi / 2, (0.0, 0.0))
    assert can_scale_unevenly(upright)
    assert scale(upright, 2.0, 1.0, (0.0, 0.0)).level.bodies[0].shape.box == (1.0, 4.0)
    assert not can_scale_unevenly(rotate(level, 0.3, (0.0, 0.0)))


@pytest.mark.parametrize(
    "body",
    [
        JellyDef(type="jelly", id="b", shape=CircleShape(circle=1.0), spacing=0.25),
        GirderDef(type="girder", id="b", start=(0.0, 0.0), end=(2.0, 1.0), segments=4),
    ],
)
def test_what_cannot_be_stretched_says_so(body):
    document = add_body(Document(empty_level()), body)
    assert not can_scale_unevenly(document)
    with pytest.raises(EditError, match=r'"b": a .* can only be scaled evenly'):
        scale(document, 2.0, 1.0, (0.0, 0.0))


def test_a_level_bridge_or_girder_or_rope_can_be_stretched():
    document = Document(empty_level())
    document = add_body(document, BridgeDef(type="bridge", id="b", start=(0.0, 0.0), end=(2.0, 0.0), segments=4))
    document = add_body(document, GirderDef(type="girder", id="g", start=(0.0, 5.0), end=(2.0, 5.0), segments=4))
    document = add_body(
        document, RopeDef(type="rope", id="r", start=(0.0, 0.0), end=(3.0, 4.0), segments=4, rest_length=2.0)
    )
    document = Document(document.level, frozenset(items_of(document.level)))
    before, after = make_scene(document.level), make_scene(scale(document, 2.0, 3.0, (0.0, 0.0)).level)
    assert np.allclose(after.position, before.position * [2.0, 3.0])
    assert math.isclose(after.rest_length[-1], 2.0 * math.hypot(6.0, 12.0) / 5.0)


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda d: move(d, 1e6, 0.0), '"rope" would lie beyond the limit 1000000'),
        (lambda d: move(d, math.nan, 0.0), "finite"),
        (lambda d: rotate(d, math.inf, (0.0, 0.0)), "finite"),
        (lambda d: scale(d, -1.0, 1.0, (0.0, 0.0)), "above 0; use Mirror to turn something over"),
        (lambda d: scale(d, 1e9, 1e9, (0.0, 0.0)), "above the limit"),
        (lambda d: mirror(d, "x", (1e6, 0.0)), "above the limit"),
    ],
)
def test_an_edit_that_leaves_the_world_is_refused_in_one_line(edit, words):
    with pytest.raises(EditError, match=words) as refused:
        edit(chosen("rope"))
    assert "\n" not in str(refused.value)


def row(*places):
    document = Document(empty_level())
    for index, place in enumerate(places):
        document = add_particle(document, ParticleDef(id=f"p{index}", position=place))
    return Document(document.level, frozenset(items_of(document.level)))


def places(document):
    return [particle.position for particle in document.level.particles]


def test_aligning_brings_an_edge_or_the_middles_onto_one_line():
    document = row((0.0, 0.0), (2.0, 1.0), (1.0, 4.0))
    assert places(align(document, "left")) == [(0.0, 0.0), (0.0, 1.0), (0.0, 4.0)]
    assert places(align(document, "top")) == [(0.0, 4.0), (2.0, 4.0), (1.0, 4.0)]
    assert places(align(document, "centre_x")) == [(1.0, 0.0), (1.0, 1.0), (1.0, 4.0)]


def test_what_is_aligned_already_stays_the_same_level():
    document = align(row((0.0, 0.0), (2.0, 1.0)), "bottom")
    assert align(document, "bottom").level is document.level
    with pytest.raises(EditError, match="select two things or more to line them up"):
        align(select(document, frozenset(list(document.selection)[:1])), "left")


def test_a_group_is_aligned_as_one():
    document = chosen("deck", "weight", "cube")
    scene = make_scene(document.level)
    after = align(document, "left")
    moved = make_scene(after.level)
    shift = moved.position - scene.position
    both = scene.particles_of(frozenset([Item("body", "deck"), Item("particle", "weight")]))
    assert np.allclose(shift[both & (scene.first_of_weld == np.arange(len(both)))], shift[scene.slot("deck.0")])
    assert math.isclose(moved.bounds(frozenset([Item("body", "cube")]))[0], scene.bounds(document.selection)[0])


def test_distributing_makes_gaps_even_and_leaves_the_outermost():
    assert places(distribute(row((0.0, 0.0), (9.0, 1.0), (1.0, 4.0), (2.0, 0.0)), "x")) == [
        (0.0, 0.0),
        (9.0, 1.0),
        (3.0, 4.0),
        (6.0, 0.0),
    ]
    with pytest.raises(EditError, match="three things"):
        distribute(row((0.0, 0.0), (1.0, 0.0)), "x")


@pytest.mark.parametrize("change", ["mirror", "turn", "stretch"])
def test_the_outline_holes_and_pins_of_a_fitted_jelly_go_where_a_motion_takes_them(change):
    hole = ((-0.4, -0.3), (0.3, -0.3), (0.3, 0.2))
    body = JellyDef(
        type="jelly", id="j", mesh="fitted", shape=PolygonShape(polygon=((-2, -1), (1, -1), (2, 1), (-1, 1.5))),
        holes=(hole,), spacing=0.25, position=(3.0, 1.0), pinned=(0, 7),
    )  # fmt: skip
    before = add_body(Document(empty_level()), body)
    after, where = {
        "mirror": lambda: (mirror(before, "x", (0.0, 0.0)), np.array([[-1.0, 0.0], [0.0, 1.0]])),
        "turn": lambda: (rotate(before, math.pi / 2.0, (0.0, 0.0)), np.array([[0.0, 1.0], [-1.0, 0.0]])),
        "stretch": lambda: (scale(before, 1.5, 1.0, (0.0, 0.0)), np.diag([1.5, 1.0])),
    }[change]()
    old, new = (expansion(document.level.bodies[0]) for document in (before, after))
    assert len(new.body.pinned) == 2
    for corner in (*body.shape.polygon, *hole):
        image = (np.array(corner) + body.position) @ where
        assert np.hypot(*(new.form - image).T).min() < 1e-9
    # Where they were, but for a part of the spacing, which another mesh may need.
    pinned = old.form[list(body.pinned)] @ where
    for place in pinned:
        assert np.hypot(*(new.form[list(new.body.pinned)] - place).T).min() < 0.2
    assert new.mass.sum() == pytest.approx(old.mass.sum(), rel=0.3)


def test_moves_turns_scales_and_mirrors_leave_no_dust_of_arithmetic_in_the_file():
    document = Document(zoo())
    document = Document(document.level, frozenset(items_of(document.level)))
    for edit in (
        lambda each: move(each, 0.1, 0.2),
        lambda each: move(each, 0.7, -0.1),
        lambda each: mirror(each, "x", (0.3, 0.1)),
        lambda each: rotate(each, 0.5, (0.1, 0.2)),
        lambda each: scale(each, 1.1, 1.1, (0.1, 0.3)),
    ):
        document = edit(document)
    body = document.level.bodies[0]
    numbers = [*body.__dict__.get("position", ()), *body.__dict__.get("start", ())]
    numbers += [value for particle in document.level.particles for value in (*particle.position, particle.radius)]
    assert numbers and all(round(value, 12) == value for value in numbers)


def test_a_move_there_and_back_is_the_level_as_it_was():
    level = zoo()
    document = Document(level, frozenset(items_of(level)))
    assert level_text(move(move(document, 0.1, 0.7), -0.1, -0.7).level) == level_text(level)
