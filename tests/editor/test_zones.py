"""Zones in the editor: drawn, picked, moved, scaled, listed, named and changed."""

import math

import pytest

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.grouping import group
from sandbox.editor.edits.moving import can_scale_unevenly, mirror, move, rotate, scale
from sandbox.editor.edits.terrain import add_zone
from sandbox.editor.items import Item
from sandbox.editor.lint.lint import findings
from sandbox.editor.objects import object_lines
from sandbox.editor.panel.properties import properties
from sandbox.editor.pick import item_at, items_in_box
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.drawing_zone import ZoneDrawing, ZoneOptions
from sandbox.editor.tools.snap import Snap, snap
from sandbox.level.document.model import ParticleDef, WaterDef, ZoneDef
from tests.editor.test_rule_names import document

BOX = ZoneDef(id="basket", box=(1.0, 0.0, 2.0, 1.0))


def one(zone):
    return add_zone(document([], zones=[]), zone)


def zone_of(document):
    (zone,) = document.level.zones
    return zone


def at(x, y):
    return Snap((x, y))


def test_a_drag_draws_a_box_and_with_circle_a_circle_about_its_start():
    for circle, expected in ((False, {"box": (1.0, 1.0, 3.0, 2.0)}), (True, {"circle": (3.0, 2.0, math.hypot(2, 1))})):
        drawing = ZoneDrawing(ZoneOptions(circle), reach=0.1)
        drawing.down(at(3.0, 2.0))
        drawing.move(at(2.0, 1.5))
        drawing.move(at(1.0, 1.0))
        before = document([], zones=[])
        assert len(drawing.ghost(before).level.zones) == 1
        drawing.up(at(1.0, 1.0))
        zone = zone_of(drawing.done(before))
        for field, value in expected.items():
            assert getattr(zone, field) == pytest.approx(value)


def test_clicks_draw_a_polygon_that_a_click_on_its_first_corner_closes():
    drawing = ZoneDrawing(reach=0.1)
    for corner in ((0.0, 0.0), (2.0, 0.0), (1.0, 2.0), (0.0, 0.0)):
        drawing.down(at(*corner))
        drawing.up(at(*corner))
    assert zone_of(drawing.done(document([], zones=[]))).polygon == ((0.0, 0.0), (2.0, 0.0), (1.0, 2.0))


def test_a_drag_along_a_line_makes_no_box_and_says_why():
    drawing = ZoneDrawing(reach=0.1)
    drawing.down(at(0.0, 0.0))
    drawing.move(at(2.0, 0.0))
    drawing.up(at(2.0, 0.0))
    assert drawing.done(document([])) is None and "width and a height" in drawing.hint


def test_zones_move_and_scale_as_what_they_are():
    assert zone_of(move(one(BOX), 0.1, 0.2)).box == (1.1, 0.2, 2.1, 1.2)
    assert zone_of(scale(one(BOX), 2.0, 3.0, (1.0, 0.0))).box == (1.0, 0.0, 3.0, 3.0)
    round_zone = one(ZoneDef(id="hole", circle=(1.0, 2.0, 0.5)))
    assert zone_of(scale(round_zone, 2.0, 2.0, (0.0, 0.0))).circle == (2.0, 4.0, 1.0)
    assert not can_scale_unevenly(round_zone) and can_scale_unevenly(one(BOX))
    with pytest.raises(EditError, match="evenly"):
        scale(round_zone, 2.0, 1.0, (0.0, 0.0))


def test_a_box_stays_a_box_while_it_is_upright_and_is_a_polygon_askew():
    assert zone_of(rotate(one(BOX), math.pi / 2.0, (0.0, 0.0))).box == (-1.0, 1.0, 0.0, 2.0)
    assert zone_of(mirror(one(BOX), "x", (0.0, 0.0))).box == (-2.0, 0.0, -1.0, 1.0)
    assert len(zone_of(rotate(one(BOX), 0.3, (0.0, 0.0))).polygon) == 4
    with pytest.raises(EditError, match="upright"):
        rotate(one(ZoneDef(id="pool", box=BOX.box, water=WaterDef())), 0.3, (0.0, 0.0))


def test_a_zone_is_picked_inside_where_nothing_else_is_and_draws_no_pointer_to_it():
    level = document([], zones=[{"id": "basket", "box": [-3.5, 1.0, 2.0, 3.0]}]).level
    scene = make_scene(level)
    assert item_at(scene, (1.0, 1.5), 0.05) == Item("zone", "basket")
    assert item_at(scene, (-2.0, 2.0), 0.05) == Item("particle", "ball")
    assert Item("zone", "basket") in items_in_box(scene, (-4.0, 0.5, 3.0, 3.5))
    assert snap(scene, (2.0, 2.97), 0.1).kind == "free"


def test_a_zone_below_holds_nothing_that_falls():
    level = document(
        [], walls=None, terrain=[], springs=[], bodies=[], particles=[{"id": "ball", "position": [0.0, 5.0]}],
        zones=[{"id": "deep", "box": [-9.0, -9.0, 9.0, -8.0]}], contacts={},
    ).level  # fmt: skip
    assert any("ball" in found.text and "fall" in found.text for found in findings(level, make_scene(level)) if found)


def test_zones_are_listed_by_kind_and_are_in_no_group():
    before = document([], zones=[{"id": "a", "box": [0, 0, 1, 1]}, {"id": "b", "box": [0, 0, 1, 1], "water": {}}])
    assert [(line.name, line.kind) for line in object_lines(before.level)][-2:] == [("a", "zone"), ("b", "water")]
    chosen = Document(before.level, frozenset([Item("zone", "a"), Item("particle", "ball")]))
    with pytest.raises(EditError, match="no group"):
        group(chosen)
    grouped = group(Document(before.level, chosen.selection | {Item("particle", "peg")}))
    assert [part.group for part in grouped.level.particles] == ["group", "group"]


def test_the_panel_changes_name_place_water_and_look_of_a_zone():
    before = one(BOX)
    shown = {each.field: each for section in properties(before) for each in section.properties}
    assert {"id", "box", "water", "look"} <= set(shown) and "circle" not in shown
    assert zone_of(shown["box"].set(before, [0, 0, 4, 4])).box == (0.0, 0.0, 4.0, 4.0)
    assert zone_of(shown["water"].set(before, True)).water == WaterDef()
    assert zone_of(shown["id"].set(before, "net")).id == "net"


def test_drawings_show_their_ghost_in_a_level_with_rules():
    before = document([{"when": {"touches": ["ball", "floor"]}}])
    drawing = ZoneDrawing(reach=0.1)
    drawing.down(at(0.0, 0.0))
    drawing.move(at(1.0, 1.0))
    assert drawing.ghost(before) is not None


def test_a_new_zone_has_a_free_name():
    before = document([], particles=[ParticleDef(id="zone", position=(0.0, 0.0)).model_dump()], springs=[])
    assert add_zone(before, ZoneDef(id="zone", box=BOX.box)).level.zones[-1].id == "zone 2"
