"""Firmness in the editor: read and set in words and numbers, kept by scaling, and what drawing tools give at first."""

import json

import pytest

from sandbox.editor.document import Document, EditError, empty_level
from sandbox.editor.edits.fields import set_field, set_setting
from sandbox.editor.edits.moving import scale
from sandbox.editor.items import Item, items_of
from sandbox.editor.panel.properties import properties
from sandbox.editor.panel.property import MIXED
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import ContactsDef, TerrainDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.body_def import FirmnessDef
from sandbox.level.reading.parse import parse_level
from sandbox.physics.jit import COMPILED
from sandbox.physics.step import step
from tests.editor.test_drawing_tools import drawn, last_body
from tests.support.wobbles import firm_level, height

SLOW = pytest.mark.skipif(not COMPILED, reason="takes too long with interpreted kernels")
BOX = {"shape": {"box": [1, 1]}, "spacing": 0.25}


def document(firmness=None, **more):
    """A jelly box on its floor, selected, with other bodies."""
    data = json.loads(firm_level(firmness, floor=True, **BOX))
    data["bodies"] += [{"id": name, **fields} for name, fields in more.items()]
    level = parse_level(json.dumps(data).encode(), "test")
    return Document(level, frozenset(item for item in items_of(level) if item.key in ("body", *more)))


def fields(document):
    return {each.field: each for section in properties(document) for each in section.properties}


def changed(document, field, value):
    return fields(document)[field].set(document, value)


def firmness(document):
    return document.level.bodies[0].firmness


def test_the_rows_show_words_and_numbers():
    shown = fields(document({"sag": 0.1}))
    assert shown["firmness"].value == "soft"
    assert [shown[f"firmness.{name}"].value for name in ("sag", "hz", "ratio")] == [10.0, 2.28, 0.15]
    assert fields(document({"hz": 3.0, "ratio": 0.4}))["firmness"].value == "by numbers"
    of_material = fields(document())
    assert of_material["firmness"].value == "as material"
    # What Cs 0.5 and Cd 0.9 of the default material amount to.
    assert 0.0 < of_material["firmness.sag"].value < 2.0
    rigid = fields(document({"sag": 0}))
    assert rigid["firmness"].value == "rigid" and rigid["firmness.hz"].value is None


def test_words_and_numbers_are_written_as_files_have_them():
    start = document()
    assert firmness(changed(start, "firmness", "firm")) == FirmnessDef(sag=0.02)
    assert firmness(changed(start, "firmness.sag", 25.0)) == FirmnessDef(sag=0.25)
    by_frequency = changed(start, "firmness.hz", 3.0)
    assert firmness(by_frequency) == FirmnessDef(hz=3.0)
    assert firmness(changed(by_frequency, "firmness.ratio", 0.5)) == FirmnessDef(hz=3.0, ratio=0.5)
    assert firmness(changed(changed(start, "firmness", "soft"), "firmness.ratio", 0.5)) == FirmnessDef(
        hz=2.28, ratio=0.5
    )
    assert firmness(changed(changed(start, "firmness", "soft"), "firmness", "by numbers")) == FirmnessDef(
        hz=2.28, ratio=0.15
    )
    assert firmness(changed(by_frequency, "firmness", "as material")) is None
    with pytest.raises(EditError, match="choose a firmness first"):
        changed(start, "firmness.ratio", 0.5)


def test_what_is_out_of_reach_becomes_the_nearest_and_a_line_says_so():
    start = document({"hz": 3.0, "ratio": 0.3})
    row = fields(start)["firmness.hz"]
    moved = row.set(start, 10.0)
    assert firmness(moved) == FirmnessDef(hz=10.0, ratio=0.479)
    remark = '"body": 10 Hz at ratio 0.3 is not possible here. It has the nearest value now: 10 Hz at ratio 0.479'
    assert row.remark(start, 10.0) == remark
    assert row.remark(start, 4.0) == ""


def test_several_bodies_are_set_at_once_and_those_that_give_way_have_no_such_rows():
    rope = {"type": "rope", "start": [3, 3], "end": [5, 3], "segments": 4}
    wheel = {"type": "wheel", "position": [9, 3], "radius": 0.5, "thickness": 0.1, "segments": 12}
    both = document({"sag": 0.1}, wheel=wheel, rope=rope)
    assert fields(both)["firmness"].value is MIXED
    level = changed(both, "firmness", "hard").level
    assert [body.firmness for body in level.bodies] == [FirmnessDef(sag=0.003)] * 2 + [None]
    alone = Document(both.level, frozenset([Item("body", "rope")]))
    assert "firmness" not in fields(alone)
    with pytest.raises(EditError, match="stiff without pins, and this rope is not"):
        set_field(alone, alone.selection, "firmness", {"sag": 0.1})


def test_scaling_keeps_it_and_a_setting_that_puts_it_out_of_reach_is_refused():
    start = document({"hz": 10.0, "ratio": 0.5})
    larger = scale(start, 3.0, 3.0, (0.0, 0.0))
    assert firmness(larger) == firmness(start)
    with pytest.raises(EditError, match="out of reach at 20 ticks a second"):
        set_setting(start, "tick_rate", 20)
    assert set_setting(start, "tick_rate", 120).level.settings.tick_rate == 120


@pytest.mark.parametrize(
    ("tool", "end", "sag"),
    [("box", (1, 1), 0.05), ("circle", (1, 1), 0.05), ("wheel", (1, 0), 0.0015), ("ring", (1, 0), 0.05)],
)
def test_tools_draw_bodies_with_a_firmness_of_their_own_unless_told_otherwise(tool, end, sag):
    empty = Document(empty_level())
    assert last_body(drawn(tool, empty, (0, 0), end)).firmness == FirmnessDef(sag=sag)
    assert last_body(drawn(tool, empty, (0, 0), end, sag=20.0)).firmness == FirmnessDef(sag=0.2)
    assert last_body(drawn(tool, empty, (0, 0), end, sag=None)).firmness is None


def on_ground(tool, start, end, load):
    """The world of what a tool draws by default, on a floor at 0, with so many times its own mass on it or its hub."""
    level = drawn(tool, Document(empty_level()), start, end).level
    ground = TerrainDef(id="ground", polyline=((-50.0, 0.0), (50.0, 0.0)))
    world = build_world(replaced(level, contacts=ContactsDef(), terrain=(ground,)))
    y = world.position[world.particle_active, 1]
    loaded = [0] if tool == "wheel" else (y > y.max() - 0.25 * (y.max() - y.min())).nonzero()[0]
    world.change("mass", world.mass[loaded] + load * world.mass[world.particle_active].sum() / len(loaded), loaded)
    world.change("inverse_mass", 1.0 / world.mass[loaded], loaded)
    return world


@SLOW
@pytest.mark.parametrize(
    ("tool", "size", "load", "least"),
    [
        ("box", 0.5, 0, 0.93), ("box", 2.0, 0, 0.93), ("box", 1.0, 1, 0.85), ("circle", 0.5, 0, 0.85),
        ("circle", 2.0, 0, 0.85), ("circle", 1.0, 1, 0.7), ("wheel", 0.6, 0, 0.97), ("wheel", 1.0, 10, 0.9),
        ("ring", 1.0, 0, 0.95),
    ],
)  # fmt: skip
def test_what_a_tool_draws_stands_under_its_own_weight_and_a_multiple(tool, size, load, least):
    start, end = (
        ((0.0, 0.06), (size, size + 0.06)) if tool == "box" else ((0.0, size / 2 + 0.06), (size / 2, size / 2 + 0.06))
    )
    world = on_ground(tool, start, end, load)
    before = height(world)
    for _ in range(240):
        step(world)
    assert height(world) >= least * before


@SLOW
def test_a_rope_keeps_its_length_under_its_own_weight():
    level = drawn("rope", Document(empty_level()), (0.0, 0.0), (3.0, 0.0)).level
    world = build_world(level)
    for _ in range(240):
        step(world)
    place = world.position[world.particle_active]
    links = ((place[1:] - place[:-1]) ** 2).sum(axis=1) ** 0.5
    assert links.max() < 1.001 * links.min()
