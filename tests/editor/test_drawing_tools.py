"""Drawing: what each gesture adds, what it shows before, and what it joins."""

import math

import numpy as np
import pytest

from sandbox.editor.document import Document, EditError, empty_level
from sandbox.editor.edits.fields import set_field
from sandbox.editor.edits.moving import scale
from sandbox.editor.items import Item
from sandbox.editor.kinds.rope import RopeOptions
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.drawing_options import described, stepped
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import Snap, snap
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.kinds.bodies import expansion
from sandbox.level.reading.parse import parse_level

REACH = 0.1
TWO_POINTS = ["spring", "rope", "bridge", "girder", "web", "box", "circle", "wheel", "ring"]


@pytest.fixture
def empty():
    return Document(empty_level())


@pytest.fixture
def with_deck(empty):
    """A bridge from the origin to (4, 0), as the tool draws it."""
    return drawn("bridge", empty, (0.0, 0.0), (4.0, 0.0))


def at(document, point):
    """The pointer at a point, drawn by particles alone."""
    return snap(make_scene(document.level), point, REACH)


def drag(drawing, document, start, end):
    """Press, move, release: the document, or None where it is not done."""
    drawing.down(at(document, start))
    drawing.move(at(document, end))
    drawing.up(at(document, end))
    return drawing.done(document)


def click(drawing, document, point):
    drawing.move(at(document, point))
    drawing.down(at(document, point))
    drawing.up(at(document, point))
    return drawing.done(document)


def drawn(tool, document, start, end, **options):
    drawing = TOOLS[tool].drawing(reach=REACH)
    for name, value in options.items():
        drawing.set_option(name, value)
    return drag(drawing, document, start, end)


def last_body(document):
    return document.level.bodies[-1]


@pytest.mark.parametrize("tool", TWO_POINTS)
def test_a_drag_and_two_clicks_draw_the_same_and_what_is_drawn_can_be_saved_and_is_selected(tool, empty):
    dragged = drawn(tool, empty, (1.0, 2.0), (4.0, 3.0))
    drawing = TOOLS[tool].drawing(reach=REACH)
    assert click(drawing, empty, (1.0, 2.0)) is None
    clicked = click(drawing, empty, (4.0, 3.0))
    assert clicked == dragged
    assert parse_level(level_text(dragged.level).encode(), "drawn") == dragged.level
    assert build_world(dragged.level).particle_count > 0
    expected = {Item("body", last_body(dragged).id)} if dragged.level.bodies else {Item("spring", 0)}
    assert expected <= dragged.selection


@pytest.mark.parametrize("tool", TWO_POINTS)
def test_the_ghost_follows_the_pointer_from_the_first_point_on_and_is_what_will_be_drawn(tool, empty):
    drawing = TOOLS[tool].drawing(reach=REACH)
    drawing.move(at(empty, (1.0, 2.0)))
    assert drawing.ghost(empty) is None
    drawing.down(at(empty, (1.0, 2.0)))
    drawing.move(at(empty, (4.0, 3.0)))
    ghost = drawing.ghost(empty)
    assert drawing.measure != ""
    assert drawing.done(empty) is None
    drawing.up(at(empty, (4.0, 3.0)))
    done = drawing.done(empty)
    assert (ghost.level, ghost.selection) == (done.level, done.selection)
    assert drawing.done(empty) is None


@pytest.mark.parametrize("tool", TWO_POINTS)
def test_escape_gives_up_and_enter_ends_at_the_pointer(tool, empty):
    drawing = TOOLS[tool].drawing(reach=REACH)
    drawing.finish()
    assert drawing.done(empty) is None
    click(drawing, empty, (1.0, 2.0))
    drawing.cancel()
    drawing.move(at(empty, (4.0, 3.0)))
    assert drawing.ghost(empty) is None
    assert not drawing.under_way
    click(drawing, empty, (1.0, 2.0))
    drawing.move(at(empty, (4.0, 3.0)))
    drawing.finish()
    assert drawing.done(empty) == drawn(tool, empty, (1.0, 2.0), (4.0, 3.0))


@pytest.mark.parametrize("tool", TWO_POINTS)
def test_an_end_on_the_start_is_refused_with_a_hint_and_the_gesture_goes_on(tool, empty):
    drawing = TOOLS[tool].drawing(reach=REACH)
    click(drawing, empty, (1.0, 2.0))
    assert click(drawing, empty, (1.0, 2.0)) is None
    assert "in one place" in drawing.hint
    assert click(drawing, empty, (4.0, 3.0)) is not None


def test_a_hand_that_shakes_on_the_edge_of_a_grid_has_clicked_and_not_dragged(empty):
    drawing = TOOLS["rope"].drawing(reach=REACH)
    scene = make_scene(empty.level)
    drawing.down(snap(scene, (0.249, 0.0), 0.0, 0.5))
    drawing.up(snap(scene, (0.251, 0.0), 0.0, 0.5))
    assert drawing.done(empty) is None
    assert drawing.under_way


def test_a_rope_has_links_of_a_quarter_metre_between_four_and_sixty(empty):
    lengths = [last_body(drawn("rope", empty, (0.0, 0.0), (x, 0.0))).segments for x in (0.2, 3.0, 100.0)]
    assert lengths == [4, 12, 60]


def test_slack_makes_a_rope_longer_than_its_way(empty):
    rope = last_body(drawn("rope", empty, (0.0, 0.0), (3.0, 0.0), slack=0.1))
    assert rope.rest_length * rope.segments == pytest.approx(3.3)
    assert last_body(drawn("rope", empty, (0.0, 0.0), (3.0, 0.0))).rest_length is None


def test_options_stay_for_the_next_drawing_and_adjust_counts_from_what_fits(empty):
    drawing = TOOLS["rope"].drawing(reach=REACH)
    drawing.down(at(empty, (0.0, 0.0)))
    drawing.move(at(empty, (3.0, 0.0)))
    drawing.adjust(+3)
    assert "15 segments" in drawing.measure
    drawing.up(at(empty, (3.0, 0.0)))
    assert last_body(drawing.done(empty)).segments == 15
    assert last_body(drag(drawing, empty, (0.0, 0.0), (9.0, 0.0))).segments == 15
    drawing.adjust(-100)
    assert drawing.options.segments == 1


def test_an_option_out_of_range_is_refused_in_one_line_and_changes_nothing(empty):
    drawing = TOOLS["rope"].drawing()
    before = drawing.options
    for name, value in (("segments", 0), ("segments", 2.5), ("mass", -1.0), ("slack", None)):
        with pytest.raises(EditError) as refused:
            drawing.set_option(name, value)
        assert "\n" not in str(refused.value)
    assert drawing.options == before


@pytest.mark.parametrize("tool", ["rope", "box", "wheel", "bridge", "girder", "ring", "web"])
def test_the_mass_of_a_tool_is_that_of_the_whole_body_at_any_size(tool, empty):
    for end in ((3.0, 1.0), (6.0, 4.0)):
        body = last_body(drawn(tool, empty, (0.0, 0.0), end, mass=12.0))
        assert expansion(body).mass.sum() == pytest.approx(12.0, rel=1e-11)


def test_what_is_too_large_is_refused_in_one_line_and_the_ghost_says_why(empty):
    drawing = TOOLS["rope"].drawing(reach=REACH)
    drawing.down(Snap((0.0, 0.0)))
    drawing.move(Snap((2e6, 0.0)))
    assert drawing.ghost(empty) is None
    assert "above the limit" in drawing.hint
    drawing.up(Snap((2e6, 0.0)))
    with pytest.raises(EditError, match="above the limit"):
        drawing.done(empty)
    assert not drawing.under_way


def test_ends_on_particles_are_joined_to_them_and_not_pinned(with_deck):
    drawing = TOOLS["rope"].drawing(reach=REACH)
    drawing.set_option("pin_end", True)
    drawing.down(at(with_deck, (2.0, 0.05)))
    drawing.move(at(with_deck, (2.0, -3.0)))
    assert drawing.hint.endswith("joins bridge.4")
    drawing.up(at(with_deck, (2.0, -3.0)))
    document = drawing.done(with_deck)
    assert document.level.welds == (("bridge.4", "rope.start"),)
    assert last_body(document).pin == ("end",)
    world = build_world(document.level)
    assert world.particle_slot("rope.start") == world.particle_slot("bridge.4")


def test_a_joined_ghost_is_shown_without_the_rest_of_the_level(with_deck):
    drawing = TOOLS["rope"].drawing(reach=REACH)
    drawing.down(at(with_deck, (2.0, 0.05)))
    drawing.move(at(with_deck, (2.0, -3.0)))
    ghost = drawing.ghost(with_deck)
    assert [body.type for body in ghost.level.bodies] == ["rope"]
    scene = make_scene(ghost.level)
    shown = scene.position[scene.particles_of(ghost.selection)]
    assert shown[[0, -1]].tolist() == [[2.0, 0.0], [2.0, -3.0]]


def test_a_weight_clicked_onto_the_end_of_a_rope_becomes_part_of_it(empty):
    document = drawn("rope", empty, (0.0, 5.0), (0.0, 2.0))
    drawing = TOOLS["particle"].drawing(reach=REACH)
    drawing.set_option("mass", 1000.0)
    document = click(drawing, document, (0.05, 2.0))
    assert document.level.welds == (("rope.end", "particle"),)
    world = build_world(document.level)
    assert world.mass[world.particle_slot("particle")] == 1001.0


def test_a_particle_shows_under_the_pointer_before_the_click(empty):
    drawing = TOOLS["particle"].drawing(reach=REACH)
    assert drawing.ghost(empty) is None
    drawing.move(at(empty, (2.0, 3.0)))
    ghost = drawing.ghost(empty)
    assert ghost.level.particles[0].position == (2.0, 3.0)
    assert click(drawing, empty, (2.0, 3.0)) == ghost


def test_a_spring_joins_particles_and_makes_one_where_it_ends_at_none(with_deck):
    document = drawn("spring", with_deck, (0.0, 0.0), (0.0, 3.0))
    assert [(spring.a, spring.b) for spring in document.level.springs] == [("bridge.start", "particle")]
    assert document.level.particles[0].position == (0.0, 3.0)
    assert document.selection == {Item("spring", 0), Item("particle", "particle")}


def test_a_bridge_has_square_cells_and_a_girder_equilateral_ones(empty):
    bridge = last_body(drawn("bridge", empty, (0.0, 0.0), (4.0, 0.0)))
    assert (bridge.segments, bridge.height, bridge.pin) == (8, 0.5, ("start", "end"))
    girder = last_body(drawn("girder", empty, (0.0, 0.0), (4.0, 0.0)))
    assert girder.height == pytest.approx(0.5 * math.sqrt(3.0) / 2.0, abs=1e-6)


@pytest.mark.parametrize("tool", ["web", "wheel"])
def test_the_first_spoke_points_at_the_pointer_so_that_rim_and_centre_can_join(tool, empty):
    document = drawn("rope", empty, (0.0, 5.0), (2.0, 5.0))
    document = drawn("rope", document, (5.0, 8.0), (3.0, 6.0))
    document = drawn(tool, document, (2.0, 5.0), (3.0, 6.0))
    centre = {"web": "web.centre", "wheel": "wheel.hub"}[tool]
    (first, second) = document.level.welds
    assert first == ("rope.end", centre)
    assert second[0] == "rope 2.end"
    scene = make_scene(document.level)
    assert scene.position[scene.slot(second[1])] == pytest.approx((3.0, 6.0), abs=1e-5)


@pytest.mark.parametrize("degrees", [-15, 45, 90, 165])
def test_a_direction_that_snapped_to_whole_degrees_has_no_dust(empty, degrees):
    rim = tuple(
        round(1.035276 * part, 6) for part in (math.cos(math.radians(degrees)), math.sin(math.radians(degrees)))
    )
    body = last_body(drawn("wheel", empty, (0.0, 0.0), rim))
    assert math.degrees(body.angle) == pytest.approx(degrees, abs=1e-7)
    free = last_body(drawn("wheel", empty, (0.0, 0.0), (1.0, 0.001)))
    assert free.angle == pytest.approx(0.001, abs=1e-6)


def test_the_corner_of_a_box_joins_and_the_rim_of_a_circle_does_not(with_deck):
    document = drawn("box", with_deck, (4.0, 0.0), (6.0, 1.0))
    assert document.level.welds == (("bridge.end", "jelly.0"),)
    drawing = TOOLS["circle"].drawing(reach=REACH)
    drawing.down(at(with_deck, (6.0, 0.0)))
    drawing.move(at(with_deck, (4.0, 0.0)))
    assert "joins" not in drawing.hint
    assert drawn("circle", with_deck, (6.0, 0.0), (4.0, 0.0)).level.welds == ()


def test_a_jelly_is_eight_cells_across_and_a_long_one_no_finer_than_it_can_be(empty):
    box = last_body(drawn("box", empty, (0.0, 0.0), (4.0, 2.0)))
    assert (box.shape.box, box.position, box.spacing) == ((4.0, 2.0), (2.0, 1.0), 0.25)
    long = drawn("box", empty, (0.0, 0.0), (50.0, 0.5))
    assert len(make_scene(long.level).position) < 2_500
    assert last_body(drawn("box", empty, (0.0, 0.0), (4.0, 2.0), cells=4)).spacing == 0.5


def test_circles_and_polygons_are_fitted_finer_where_they_are_thin_and_left_to_a_grid_where_that_takes_too_many(empty):
    circle = last_body(drawn("circle", empty, (0.0, 0.0), (1.0, 0.0)))
    assert (circle.mesh, circle.spacing) == ("fitted", 0.25)
    assert last_body(drawn("circle", empty, (0.0, 0.0), (1.0, 0.0), cells=4)).spacing == 0.5
    found = []
    for corners in ([(0, 0), (4, 0), (0, 3)], [(0, 0), (4, 3), (4, 4)], [(0, 0), (9, 8.99), (9, 9)]):
        drawing = TOOLS["polygon"].drawing(reach=0.001)
        for corner in corners:
            click(drawing, empty, (float(corner[0]), float(corner[1])))
        drawing.finish()
        found.append(last_body(drawing.done(empty)))
    assert [body.mesh for body in found] == ["fitted", "fitted", "grid"]
    assert found[0].spacing == 0.375 and found[1].spacing <= 0.5
    assert len(make_scene(empty_level().model_copy(update={"bodies": (found[1],)})).position) < 1_500


@pytest.mark.parametrize(
    ("width", "height", "cells"),
    [
        (2.0, 2.0, None),
        (3.0, 0.5, None),
        (3.0, 0.5, 4),
        (10.0, 0.2, None),
        (0.2, 10.0, None),
        (1.3, 0.7, 3),
        (2, 0.9, 7),
    ],
)
def test_a_box_of_jelly_has_the_size_drawn_and_the_size_typed_and_no_more_particles_than_it_needs(
    empty, width, height, cells
):
    document = drawn("box", empty, (1.0, 1.0), (1.0 + width, 1.0 + height), cells=cells)
    left, bottom, right, top = make_scene(document.level).bounds()
    assert (right - left, top - bottom) == (pytest.approx(width, abs=1e-9), pytest.approx(height, abs=1e-9))
    assert cells is not None or len(make_scene(document.level).mass) < 400
    typed = set_field(document, [Item("body", document.level.bodies[0].id)], "shape", {"box": [width + 0.37, height]})
    left, bottom, right, top = make_scene(typed.level).bounds()
    assert (right - left, top - bottom) == (pytest.approx(width + 0.37, abs=1e-9), pytest.approx(height, abs=1e-9))
    wider = scale(document, 1.17, 1.0, (0.0, 0.0))
    left, bottom, right, top = make_scene(wider.level).bounds()
    assert (right - left, top - bottom) == (pytest.approx(1.17 * width, abs=1e-9), pytest.approx(height, abs=1e-9))


def test_a_box_without_height_is_refused(empty):
    drawing = TOOLS["box"].drawing(reach=REACH)
    drawing.down(at(empty, (0.0, 0.0)))
    drawing.move(at(empty, (4.0, 0.0)))
    assert drawing.ghost(empty) is None
    assert "width and a height" in drawing.hint


CORNERS = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (2.0, 1.0), (0.0, 3.0)]


def corners_of(body):
    return [(x + body.position[0], y + body.position[1]) for x, y in body.shape.polygon]


@pytest.mark.parametrize("closing", ["click", "enter"])
def test_a_polygon_is_clicked_corner_by_corner_and_closed(closing, empty):
    drawing = TOOLS["polygon"].drawing(reach=REACH)
    for corner in CORNERS:
        assert click(drawing, empty, corner) is None
    assert drawing.ghost(empty) is not None
    if closing == "click":
        document = click(drawing, empty, (0.05, 0.0))
    else:
        drawing.finish()
        document = drawing.done(empty)
    assert corners_of(last_body(document)) == CORNERS
    assert not drawing.under_way


def test_a_polygon_that_crosses_itself_is_not_closed_and_its_last_corner_can_be_taken_back(empty):
    drawing = TOOLS["polygon"].drawing(reach=REACH)
    for corner in [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0), (4.0, 3.0)]:
        click(drawing, empty, corner)
    assert drawing.ghost(empty) is None
    drawing.finish()
    assert drawing.done(empty) is None
    assert "crosses itself" in drawing.hint
    drawing.back()
    drawing.finish()
    assert len(last_body(drawing.done(empty)).shape.polygon) == 3


@pytest.mark.parametrize("tool", [*TWO_POINTS, "polygon", "line"])
def test_a_point_that_is_taken_back_while_the_button_is_down_ends_as_nothing(tool, empty):
    drawing = TOOLS[tool].drawing(reach=REACH)
    for taken_back in (0, 1):
        for corner in [(0.0, 0.0)] * taken_back:
            click(drawing, empty, corner)
        drawing.down(at(empty, (1.0, 2.0)))
        drawing.back()
        before = list(drawing.points)
        drawing.move(at(empty, (4.0, 3.0)))
        drawing.up(at(empty, (4.0, 3.0)))
        assert drawing.done(empty) is None and drawing.points == before
        drawing.cancel()


def test_an_outline_in_one_stroke_is_simplified_and_closed_where_the_stroke_ends(empty):
    drawing = TOOLS["polygon"].drawing(reach=REACH)
    turns = np.linspace(0.0, 2.0 * math.pi, 400)[:-1]
    stroke = [(3.0 * math.cos(turn), 2.0 * math.sin(turn)) for turn in turns]
    drawing.down(Snap((3.0, 0.0)))
    for point in stroke:
        drawing.move(Snap(point))
    drawing.up(Snap(stroke[-1]))
    corners = corners_of(last_body(drawing.done(empty)))
    assert 8 < len(corners) < 60
    assert max(abs((x / 3.0) ** 2 + (y / 2.0) ** 2 - 1.0) for x, y in corners) < 0.01


def test_a_stroke_that_crosses_itself_is_refused_with_a_hint(empty):
    drawing = TOOLS["polygon"].drawing(reach=REACH)
    drawing.down(Snap((0.0, 0.0)))
    for point in [(4.0, 0.0), (0.0, 3.0), (4.0, 3.0)]:
        drawing.move(Snap(point))
    drawing.up(Snap((4.0, 3.0)))
    assert drawing.done(empty) is None
    assert "crosses itself" in drawing.hint
    assert not drawing.under_way


def test_a_click_pins_a_particle_of_any_body_and_another_lets_it_go(with_deck):
    drawing = TOOLS["pin"].drawing(reach=REACH)
    drawing.move(at(with_deck, (2.0, 0.0)))
    ghost = drawing.ghost(with_deck)
    assert ghost.level.particles[0].pinned
    assert drawing.hint == "Click to pin bridge.4"
    pinned = click(drawing, with_deck, (2.0, 0.0))
    scene = make_scene(pinned.level)
    assert scene.pinned[scene.slot("bridge.4")]
    drawing.ghost(pinned)
    assert drawing.hint == "Click to unpin bridge.4"
    assert not make_scene(click(drawing, pinned, (2.0, 0.0)).level).pinned[scene.slot("bridge.4")]


def test_a_pin_in_empty_space_is_refused(with_deck):
    with pytest.raises(EditError, match="no particle here"):
        click(TOOLS["pin"].drawing(reach=REACH), with_deck, (2.0, 5.0))


def test_a_material_that_a_level_does_not_have_is_the_default_one(empty):
    bare = Document(empty.level.model_copy(update={"materials": {}}))
    assert last_body(drawn("rope", bare, (0.0, 0.0), (3.0, 0.0))).material == "default"
    assert last_body(drawn("rope", empty, (0.0, 0.0), (3.0, 0.0))).material == "steel"


def test_steps_of_options_go_through_round_values_and_end_at_the_limits():
    mass, slack = described(RopeOptions())["mass"], described(RopeOptions())["slack"]
    links = described(RopeOptions())["segments"]
    up = [0.7]
    while up[-1] < 100.0:
        up.append(stepped(mass, up[-1], 1))
    assert up == [0.7, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]
    assert stepped(mass, 1.0, -1) == 0.5 and stepped(mass, None, 1) == 1.0
    assert stepped(mass, mass.high, 1) == mass.high and stepped(mass, mass.low, -1) == mass.low
    assert stepped(slack, 0.0, -1) == -0.05 and stepped(slack, slack.low, -1) == slack.low
    assert stepped(links, 1, -1) == 1 and stepped(links, 1, 1) == 2


@pytest.mark.parametrize("radius", [0.3, 0.9, 1.0, 1.1, 1.3, 7.0])
def test_a_wheel_gets_an_even_number_of_spokes_so_that_the_box_around_it_has_its_middle(empty, radius):
    scene = make_scene(drawn("wheel", empty, (0.0, 0.0), (radius, 0.0)).level)
    left, bottom, right, top = scene.bounds()
    spokes = scene.level.bodies[0].segments
    assert spokes % 2 == 0 and 8 <= spokes <= 32
    assert (left + right, bottom + top) == pytest.approx((0.0, 0.0), abs=1e-9)
