"""Terrain and walls: edits of their corners, picking and snapping, and what becomes of collision groups."""

import math

import numpy as np
import pytest

from sandbox.editor.document import Document, EditError, empty_level
from sandbox.editor.edits.copying import copy_text, duplicate, paste
from sandbox.editor.edits.deleting import delete
from sandbox.editor.edits.fields import rename, set_field
from sandbox.editor.edits.grouping import group, reorder
from sandbox.editor.edits.moving import align, mirror, move, rotate, scale
from sandbox.editor.edits.terrain import (
    add_terrain,
    corners_of,
    delete_corner,
    insert_corner,
    move_corner,
    set_walls,
    with_corners,
)
from sandbox.editor.items import Item
from sandbox.editor.panel.properties import properties
from sandbox.editor.pick import corner_at, item_at, items_in_box, items_in_lasso
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import Snap, snap
from sandbox.level.document.model import TerrainDef, WallsDef
from tests.support.zoo import zoo

GROUND, RAMP = Item("terrain", "ground"), Item("terrain", "ramp")
SQUARE = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))


def chosen(*items):
    return Document(zoo(), frozenset(items))


def square(name="ground"):
    piece = with_corners(TerrainDef(id=name), SQUARE, "solid")
    return add_terrain(Document(empty_level()), piece)


def corners(document, index=0):
    return corners_of(document.level.terrain[index])


def clicked(tool, *points, finish=False, document=None):
    """What a tool draws by a click at each of points [m]."""
    drawing = TOOLS[tool].drawing(reach=0.05)
    for point in points:
        drawing.down(Snap(point))
        drawing.up(Snap(point))
    if finish:
        drawing.finish()
    return drawing.done(document or Document(empty_level()))


def test_corners_are_moved_put_in_and_taken_out():
    document = square()
    assert corners(move_corner(document, "ground", 2, (3.0, 3.0)))[2] == (3.0, 3.0)
    assert corners(insert_corner(document, "ground", 4, (-1.0, 1.0))) == (*SQUARE, (-1.0, 1.0))
    assert corners(insert_corner(document, "ground", 1, (1.0, -1.0)))[:3] == ((0.0, 0.0), (1.0, -1.0), (2.0, 0.0))
    assert corners(delete_corner(document, "ground", 0)) == SQUARE[1:]
    assert move_corner(document, "ground", 1, SQUARE[1]) is document


def test_an_outline_that_crosses_itself_or_has_too_few_corners_is_refused():
    document = square()
    with pytest.raises(EditError, match="touch or cross"):
        move_corner(document, "ground", 0, (3.0, 1.0))
    triangle = delete_corner(document, "ground", 0)
    with pytest.raises(EditError, match="3 corners or more"):
        delete_corner(triangle, "ground", 0)
    with pytest.raises(EditError, match='no terrain or zone "hill"'):
        delete_corner(document, "hill", 0)
    with pytest.raises(EditError, match="left and bottom"):
        set_walls(document, WallsDef(box=(1.0, 0.0, 0.0, 1.0)))


def test_ground_is_drawn_by_clicks_and_closed_on_its_first_corner_by_a_double_click_or_by_enter():
    triangle = ((0.0, 0.0), (2.0, 0.0), (1.0, 1.0))
    for document in (
        clicked("ground", *triangle, (0.01, 0.0)),
        clicked("ground", *triangle, triangle[-1]),
        clicked("ground", *triangle, finish=True),
    ):
        assert document.level.terrain[0].polygon == triangle
        assert document.selection == {GROUND}
    assert clicked("ground", *triangle) is None
    drawing = TOOLS["ground"].drawing(reach=0.05)
    for point in ((0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)):
        drawing.down(Snap(point))
        drawing.up(Snap(point))
    drawing.finish()
    assert drawing.done(Document(empty_level())) is None and "crosses itself" in drawing.hint
    drawing.back()
    drawing.finish()
    assert len(drawing.done(Document(empty_level())).level.terrain[0].polygon) == 3


def test_a_line_ends_where_it_is_ended_and_may_be_a_loop_and_cross_itself():
    way = ((0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0))
    assert clicked("line", *way, finish=True).level.terrain[0].polyline == way
    assert clicked("line", *way, way[-1]).level.terrain[0].polyline == way
    assert clicked("line", *way, way[0]).level.terrain[0].polyline == (*way, way[0])
    assert clicked("line", way[0], finish=True) is None


def test_a_line_by_hand_goes_to_the_very_end_of_the_stroke():
    drawing = TOOLS["line"].drawing(reach=0.05)
    stroke = [(0.1 * k, math.sin(0.3 * k)) for k in range(30)] + [(2.0, 0.1)]
    drawing.down(Snap(stroke[0]))
    for point in stroke[1:]:
        drawing.move(Snap(point))
    drawing.up(Snap(stroke[-1]))
    line = drawing.done(Document(empty_level())).level.terrain[0].polyline
    assert line[0] == (0.0, 0.0) and line[-1] == (2.0, 0.1) and 4 < len(line) < 20


def test_walls_are_drawn_from_corner_to_corner_with_the_surface_that_the_tool_has():
    drawing = TOOLS["walls"].drawing(reach=0.05)
    drawing.set_option("friction", 0.25)
    drawing.down(Snap((3.0, 4.0)))
    drawing.move(Snap((-1.0, 1.0)))
    assert drawing.ghost(Document(empty_level())).level.walls.box == (-1.0, 1.0, 3.0, 4.0)
    drawing.up(Snap((-1.0, 1.0)))
    walls = drawing.done(Document(empty_level())).level.walls
    assert (walls.box, walls.friction, walls.restitution) == ((-1.0, 1.0, 3.0, 4.0), 0.25, None)


def test_water_is_drawn_from_corner_to_corner_as_dense_as_the_tool_says():
    drawing = TOOLS["water"].drawing(reach=0.05)
    drawing.set_option("density", 25.0)
    for x in (-1.0, 3.0):
        drawing.down(Snap((x, 2.0 - x)))
        drawing.up(Snap((x, 2.0 - x)))
    (zone,) = drawing.done(Document(empty_level())).level.zones
    assert (zone.id, zone.box, zone.water.density) == ("water", (-1.0, -1.0, 3.0, 3.0), 25.0)


def test_terrain_is_moved_turned_scaled_mirrored_and_lined_up_like_everything():
    document = square()
    assert corners(move(document, 1.0, -1.0))[0] == (1.0, -1.0)
    assert np.allclose(corners(rotate(document, math.pi / 2.0, (0.0, 0.0)))[1], (0.0, 2.0))
    assert corners(scale(document, 2.0, 3.0, (0.0, 0.0)))[2] == (4.0, 6.0)
    assert corners(mirror(document, "x", (0.0, 0.0)))[1] == (-2.0, 0.0)
    with pytest.raises(EditError, match="beyond the limit"):
        move(document, 1e6, 0.0)
    both = Document(add_terrain(document, with_corners(TerrainDef(id="low"), [(5, -3.0), (6, -3)], "line")).level)
    both = Document(both.level, frozenset([GROUND, Item("terrain", "low")]))
    assert min(y for _, y in corners(align(both, "bottom"))) == -3.0


def test_terrain_is_copied_grouped_renamed_reordered_and_deleted():
    document = chosen(GROUND, RAMP)
    copied = duplicate(document, 0.0, -20.0)
    assert [piece.id for piece in copied.level.terrain] == ["ground", "ramp", "ground 2", "ramp 2"]
    assert copied.selection == {Item("terrain", "ground 2"), Item("terrain", "ramp 2")}
    assert paste(Document(empty_level()), copy_text(chosen(RAMP))).level.terrain[0].polyline is not None
    assert {piece.group for piece in group(document).level.terrain} == {"group"}
    assert rename(chosen(RAMP), RAMP, "slope").level.terrain[1].id == "slope"
    with pytest.raises(EditError, match="is taken"):
        rename(chosen(RAMP), RAMP, "wheel")
    assert [piece.id for piece in reorder(chosen(GROUND), "front").level.terrain] == ["ramp", "ground"]
    assert [piece.id for piece in delete(chosen(GROUND)).level.terrain] == ["ramp"]


def test_terrain_is_picked_by_its_edges_and_inside_but_after_what_lies_on_it():
    scene = make_scene(zoo())
    assert item_at(scene, (0.0, -8.0), 0.1) == GROUND
    assert item_at(scene, (23.5, -4.05), 0.1) == RAMP
    assert item_at(scene, (23.5, -3.0), 0.1) is None
    document = add_terrain(Document(zoo()), with_corners(TerrainDef(id="under"), [(-1, 4), (4, 4), (2, 6)], "solid"))
    scene = make_scene(document.level)
    assert item_at(scene, (1.0, 5.0), 0.05) == Item("body", "rope")
    assert item_at(scene, (1.5, 4.5), 0.05) == Item("terrain", "under")
    assert items_in_box(scene, (21.0, -6.0, 31.0, -2.0)) == {RAMP}
    assert items_in_lasso(scene, [(21.0, -6.0), (31.0, -6.0), (31.0, -2.0), (21.0, -2.0)]) == {RAMP}
    assert items_in_box(scene, (23.0, -6.0, 31.0, -2.0)) == frozenset()
    assert corner_at(scene, RAMP, (25.1, -5.0), 0.2) == 1 and corner_at(scene, RAMP, (26.0, -5.0), 0.2) is None


def test_the_pointer_snaps_to_corners_and_then_to_edges():
    scene = make_scene(square().level)
    assert snap(scene, (2.05, -0.04), 0.1).kind == "corner"
    on_edge = snap(scene, (1.3, 0.03), 0.1, grid=0.25)
    assert (on_edge.kind, on_edge.point, on_edge.name) == ("edge", (1.25, 0.0), None)
    assert snap(scene, (1.3, 0.03), 0.1).point == snap(scene, (1.3, 0.03), 0.1, grid=1.0).point == (1.3, 0.0)
    assert snap(scene, (1.3, 0.08), 0.1).kind == "free"
    assert snap(scene, (2.05, -0.04), 0.1, skip=frozenset([GROUND])).kind == "free"
    assert snap(scene, (2.05, -0.04), 0.0).kind == "free"


def test_the_scene_measures_terrain_too():
    scene = make_scene(zoo())
    assert scene.bounds(frozenset([RAMP])) == (22.0, -5.0, 30.0, -3.0)
    assert scene.bounds()[2] == 30.0
    assert make_scene(square().level).bounds() == (0.0, 0.0, 2.0, 2.0)
    assert len(scene.edge) == 5 + 2


def test_the_kind_and_the_corners_of_terrain_are_properties():
    document = chosen(GROUND)
    fields = {each.field: each for section in properties(document) for each in section.properties}
    line = fields["form"].set(document, "line")
    assert line.level.terrain[0].polyline == document.level.terrain[0].polygon
    typed = fields["corners"].typed("[0, 0], [1, 0], [0, 1]")
    assert corners(fields["corners"].set(document, typed)) == ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    with pytest.raises(EditError, match="at least 3"):
        fields["corners"].set(document, fields["corners"].typed("[0, 0], [1, 0]"))
    with pytest.raises(EditError):
        fields["corners"].set(document, fields["corners"].typed("7"))


def test_what_collides_with_a_group_goes_on_without_it_where_the_last_of_it_goes():
    document = Document(zoo(), frozenset([Item("body", "ball")]))
    weight = Item("particle", "weight")
    listing = set_field(document, [weight], "collides", ["balls", "default"])
    assert delete(listing).level.particles[0].collides == ("default",)
    alone = Document(listing.level, frozenset([weight]))
    assert paste(Document(empty_level()), copy_text(alone)).level.particles[0].collides == ("default",)
    with pytest.raises(EditError, match='no group "balls"'):
        set_field(listing, [Item("body", "ball")], "collision_group", None)


def test_what_something_touches_is_typed_in_words():
    document = Document(zoo(), frozenset([Item("particle", "weight")]))
    field = {each.field: each for section in properties(document) for each in section.properties}["collides"]
    assert field.texts == ("balls",)
    for text, value in (
        ("everything", True),
        ("nothing", False),
        ("", False),
        ("default, balls", ("default", "balls")),
    ):
        assert field.set(document, field.typed(text)).level.particles[0].collides == value


def test_walls_that_could_not_be_read_again_are_refused_in_one_line():
    document = Document(empty_level())
    with pytest.raises(EditError, match=r"^the walls: box\.0: -1e\+300 is below") as refused:
        set_walls(document, WallsDef.model_construct(box=(-1e300, 0.0, 1e300, 1.0)))
    assert "\n" not in str(refused.value)
    assert set_walls(document, WallsDef.model_construct(box=(-1.0, 0.0, 1.0, 1.0))).level.walls is not None
