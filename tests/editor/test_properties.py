"""What can be changed of a selection, a level and its checks: fields, values, typed text."""

import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.editor.document import Document, EditError
from sandbox.editor.items import Item, definitions, items_of
from sandbox.editor.panel.check_form import add_check, check_properties, delete_check
from sandbox.editor.panel.field_info import fields_of
from sandbox.editor.panel.level_properties import level_properties
from sandbox.editor.panel.material_properties import look_properties
from sandbox.editor.panel.properties import properties
from sandbox.editor.panel.property import MIXED, Property
from sandbox.editor.panel.typed import line_text, list_text, number_text, read_line, read_pairs, read_words
from sandbox.level.checks import METRICS, promise_text
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import ContactsDef, Level, NissenMaterial, ParticleDef, Settings, SpringDef
from sandbox.level.format.look import BodyLook
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import KINDS, expansion
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.reading.files import parse_level
from tests.support.zoo import zoo

LEVEL = {
    "format": "spring-sandbox/level",
    "version": 3,
    "name": "Everything",
    "materials": {"steel": {"stiffness": 1.0}, "hook": {"law": "hooke", "k": 3.0, "c": 1.0}},
    "bodies": [
        {"type": "rope", "id": "rope", "start": [0, 0], "end": [4, 0], "segments": 4, "pin": ["start"],
         "rest_length": 1.5, "material": "steel"},
        {"type": "rope", "id": "line", "start": [0, 1], "end": [4, 0], "segments": 6, "material": "steel"},
        {"type": "bridge", "id": "deck", "start": [0, 5], "end": [4, 5], "segments": 4, "pin": ["start", "end"]},
        {"type": "girder", "id": "beam", "start": [0, 8], "end": [4, 8], "segments": 4},
        {"type": "web", "id": "web", "position": [9, 0], "radius": 2.0, "spokes": 6, "rings": 2, "pin": ["rim"]},
        {"type": "wheel", "id": "wheel", "position": [9, 6], "radius": 2.0, "thickness": 0.5, "segments": 6},
        {"type": "jelly", "id": "box", "shape": {"box": [2.0, 1.0]}, "spacing": 0.5, "position": [20, 0]},
        {"type": "jelly", "id": "disc", "shape": {"circle": 1.0}, "spacing": 0.5, "position": [20, 4]},
        {"type": "jelly", "id": "kite", "shape": {"polygon": [[-1, 0], [0, -1], [1, 0], [0, 2]]}, "spacing": 0.5,
         "position": [20, 8]},
        {"type": "wheel", "id": "driven", "position": [9, 12], "radius": 1.0, "thickness": 0.5, "segments": 6,
         "drive": {"amplitude": 0.1, "period": 30}, "motor": {"speed": 2, "torque": 10}, "gravity_scale": 0.5},
        {"type": "ring", "id": "ring", "position": [40, 0], "radius": 1.0, "segments": 8, "bending": {}},
        {"type": "mesh", "id": "mesh", "particles": [[30, 0], [31, 0]], "masses": [1.0, 2.0], "springs": [[0, 1]],
         "velocities": [[0, 0], [0, 1]], "pinned": [0], "extras": {"by": "hand"}},
    ],
    "walls": {"box": [-50, -50, 50, 50]},
    "terrain": [{"id": "ground", "polygon": [[0, -9], [9, -9], [9, -8], [0, -8]], "friction": 0.5},
                {"id": "edge", "polyline": [[0, -20], [9, -21], [12, -20]], "restitution": 0.5}],
    "particles": [{"id": "ball", "position": [4, 3], "mass": 5.0}, {"id": "nail", "position": [6, 3], "pinned": True}],
    "springs": [{"a": "ball", "b": "rope.end", "material": "hook"}, {"a": "nail", "b": "ball"},
                {"a": "nail", "b": "disc.0", "hydraulic": {"shortest": 1, "longest": 2, "rate": 1, "key": "u"}}],
    "welds": [["line.end", "deck.1"]],
    "checks": [{"name": "up", "metric": "y", "particle": "ball", "at_least": 0.0}],
}  # fmt: skip


@pytest.fixture(scope="module")
def level():
    return parse_level(json.dumps(LEVEL).encode(), "test")


def chosen(level, *keys):
    return Document(level, frozenset(item for item in items_of(level) if item.key in keys))


def fields(document):
    return {each.field: each for section in properties(document) for each in section.properties}


def body(document, name):
    return next(part for part in (*document.level.bodies, *document.level.particles) if part.id == name)


def changed(document, field, text, axis=0):
    each = fields(document)[field]
    return each.set(document, each.typed(text, axis))


def test_nothing_selected_has_no_properties(level):
    assert properties(Document(level)) == ()


def test_every_field_of_every_kind_of_item_can_be_reached(level):
    for item, part in zip(items_of(level), definitions(level), strict=True):
        shown = {name.partition(".")[0] for name in fields(Document(level, frozenset([item])))}
        hidden = set() if not isinstance(part, BodyDef) or expansion(part).may_be_stiff else {"firmness"}
        assert type(part).model_fields.keys() - shown - {"type", "polyline", "polygon"} <= hidden, item
    assert {type(part) for part in level.bodies} == set(KINDS.values())


def test_every_field_of_the_level_and_its_settings_can_be_reached(level):
    sections = {each.title: each.properties for each in level_properties(Document(level))}
    settings = sections.pop("Time and solver")
    parts = {
        "schema_link",
        "format",
        "version",
        "settings",
        "materials",
        "bodies",
        "particles",
        "springs",
        "welds",
        "checks",
        "counters",
        "rules",
    }
    shown = {each.field.partition(".")[0] for found in sections.values() for each in found}
    assert shown == set(Level.model_fields) - parts - {"terrain", "zones"}
    assert {each.field for each in settings} == set(Settings.model_fields)


def test_units_limits_and_tooltips_come_from_the_schema():
    about = fields_of(KINDS["rope"])["particle_mass"]
    assert (about.unit, about.low, about.high, about.above) == ("kg", 1e-9, 1e9, False)
    assert about.tooltip == "Mass of each particle. 1e-09 to 1e+09 kg."
    assert fields_of(KINDS["wheel"])["radius"].above
    assert fields_of(SpringDef)["rest_length"].optional and not fields_of(ParticleDef)["mass"].optional


def test_an_empty_field_says_what_null_means_as_its_model_declares_it():
    words = {"rest_length": "as placed", "end_mass": "as the others", "friction": "the level's", "group": "none"}
    rope = fields_of(KINDS["rope"])
    assert {name: rope[name].empty for name in words} == words
    assert rope["end_mass"].tooltip == "Mass of the last particle. Empty: as the others. 1e-09 to 1e+09 kg."
    assert {name for name, about in rope.items() if about.empty} == {name for name in rope if rope[name].optional}


def test_angles_are_read_typed_and_stepped_in_degrees(level):
    wheel = chosen(level, "wheel")
    # As the wheel tool leaves it, from a drag straight down.
    turned = fields(wheel)["angle"].set(wheel, -1.570796327)
    angle = fields(turned)["angle"]
    assert (angle.about.unit, angle.texts) == ("°", ("-90",))
    assert angle.typed("180") == math.pi and math.degrees(angle.stepped(1)) == pytest.approx(-89.0)
    assert body(changed(turned, "angle", "45"), "wheel").angle == math.radians(45.0)
    assert fields(chosen(level, "wheel", "driven"))["angle"].texts == ("0",)


def test_what_differs_is_mixed_and_what_is_the_same_is_shown(level):
    both = fields(chosen(level, "rope", "line"))
    assert both["segments"].value is MIXED and both["segments"].texts == ("mixed",)
    assert both["start"].value == (0.0, MIXED)
    assert both["end"].texts == ("4", "0")
    assert both["pin"].value == {"start": MIXED, "end": False}
    assert both["material"].value == "steel"
    assert "id" not in both


def test_several_kinds_have_the_fields_that_they_share(level):
    shared = set(fields(chosen(level, "rope", "deck")))
    assert {"start", "end", "segments", "particle_mass", "pin", "material", "group"} <= shared
    assert "height" not in shared and {"rest_length", "end_mass"} <= shared
    # Ends that are held are not the rim that is.
    assert "pin" not in fields(chosen(level, "rope", "web"))
    everything = set(fields(Document(level, frozenset(items_of(level)))))
    firmness = {"firmness", "firmness.sag", "firmness.hz", "firmness.ratio"}
    assert everything >= {"group", "extras", "drive", "motor", "hydraulic", "bending", "material", "mass", *firmness}
    # Of a form that all of them have nothing is left.
    assert not everything & {"start", "end", "segments", "position", "height", "radius", "id", "pin", "shape"}


def test_one_axis_of_many_is_set_and_the_other_stays(level):
    document = changed(chosen(level, "rope", "line", "deck"), "start", "-2,5", axis=1)
    assert [body(document, name).start for name in ("rope", "line", "deck")] == [(0.0, -2.5)] * 3
    document = changed(chosen(level, "ball", "nail"), "position", "7")
    assert [part.position for part in document.level.particles] == [(7.0, 3.0), (7.0, 3.0)]
    assert document.level.bodies is level.bodies


def test_a_held_end_is_set_of_many_and_their_other_ends_stay(level):
    document = chosen(level, "rope", "line", "deck")
    document = fields(document)["pin"].set(document, {"end": True})
    assert [body(document, name).pin for name in ("rope", "line", "deck")] == [
        ("start", "end"),
        ("end",),
        ("start", "end"),
    ]


def test_segments_of_several_bodies_change_at_once_and_a_rope_keeps_its_length(level):
    document = changed(chosen(level, "rope", "deck"), "segments", "8")
    assert body(document, "rope").segments == body(document, "deck").segments == 8
    assert body(document, "rope").rest_length == 0.75
    assert document.level.springs == level.springs


def test_an_empty_text_is_null_where_the_format_has_it(level):
    document = changed(chosen(level, "rope"), "rest_length", " ")
    assert body(document, "rope").rest_length is None
    with pytest.raises(EditError, match="Particle mass: nothing is not a number"):
        changed(chosen(level, "rope"), "particle_mass", "")
    assert body(changed(chosen(level, "mesh"), "masses", ""), "mesh").masses is None


def test_lists_are_typed_with_and_without_brackets(level):
    for text in ("0, 2", "[0, 2]", " 0,2 "):
        assert body(changed(chosen(level, "rope"), "pinned", text), "rope").pinned == (0, 2)
    for text in ("[30, 0], [32, 1]", "[[30, 0], [32, 1]]"):
        assert body(changed(chosen(level, "mesh"), "particles", text), "mesh").particles == ((30, 0), (32, 1))
    assert body(changed(chosen(level, "rope"), "cut", "1"), "rope").cut == (1,)


@pytest.mark.parametrize(
    ("name", "field", "text", "fault"),
    [
        ("rope", "particle_mass", "heavy", 'Particle mass: "heavy" is not a number'),
        ("rope", "particle_mass", "0", '"rope": particle_mass: 0.0 is below the limit 1e-09'),
        ("rope", "particle_mass", "nan", 'Particle mass: "nan" is not a finite number'),
        ("rope", "segments", "2.5", 'Segments: "2.5" is not a whole number'),
        ("rope", "start", "left", 'Start x: "left" is not a number'),
        ("rope", "pinned", "9", '"rope": pinned.0: 9 is beyond the last particle, 4'),
        ("rope", "pinned", "start", 'Pinned particles: "start" is not a list such as 0, 4, 5'),
        ("rope", "pinned", "[" * 3000, None),
        ("mesh", "particles", "[0, 0], 7", None),
        ("rope", "id", "deck", '"deck" is taken; each body, particle, piece of terrain and zone needs its own name'),
        ("rope", "id", "a.b", None),
        ("wheel", "thickness", "2", '"wheel": thickness: 2.0 is not below the radius, 2.0'),
        ("box", "firmness.sag", "-1", '"box": firmness.sag: -0.01 is below the limit 0'),
        ("box", "firmness.hz", "-1", '"box": firmness.hz: -1.0 is below the limit 0.01'),
        ("box", "firmness.hz", "-6785", '"box": firmness.hz: -6785.0 is below the limit 0.01'),
        ("box", "firmness.hz", "1e300", '"box": firmness.hz: 1e+300 is above the limit 1000'),
    ],
)
def test_a_wrong_text_gives_one_line_and_changes_nothing(level, name, field, text, fault):
    document = chosen(level, name)
    with pytest.raises(EditError) as refusal:
        changed(document, field, text)
    assert "\n" not in str(refusal.value)
    assert fault is None or str(refusal.value) == fault
    assert document.level is level


def test_the_outline_of_a_jelly_changes_its_kind_and_its_size(level):
    document = chosen(level, "box")
    assert fields(document)["shape"].value == "box"
    circle = fields(document)["shape"].set(document, "circle")
    assert body(circle, "box").shape.circle == 0.5
    assert "shape.circle" in fields(circle) and "shape.box" not in fields(circle)
    assert body(changed(circle, "shape.circle", "0.75"), "box").shape.circle == 0.75
    polygon = fields(document)["shape"].set(document, "polygon")
    assert len(body(polygon, "box").shape.polygon) == 4
    back = fields(polygon)["shape"].set(polygon, "box")
    assert body(back, "box").shape == body(document, "box").shape
    assert body(changed(document, "shape.box", "3", axis=1), "box").shape.box == (2.0, 3.0)


def test_another_mesh_weighs_as_much_and_pins_go_to_the_nearest(level):
    grid = chosen(level, "disc")
    grid = fields(grid)["pinned"].set(grid, [0])
    fitted = fields(grid)["mesh"].set(grid, "fitted")
    before, after = (expansion(body(document, "disc")) for document in (grid, fitted))
    assert after.form_count[0] != before.form_count[0]
    assert after.mass.sum() == pytest.approx(before.mass.sum())
    assert math.dist(before.form[0], after.form[body(fitted, "disc").pinned[0]]) < 0.3
    with_hole = changed(fitted, "holes", "[[-0.2, -0.2], [0.2, -0.2], [0, 0.2]]")
    assert body(with_hole, "disc").holes == (((-0.2, -0.2), (0.2, -0.2), (0, 0.2)),)
    shown = fields(with_hole)["holes"]
    assert shown.typed(shown.texts[0]) == [[[-0.2, -0.2], [0.2, -0.2], [0, 0.2]]]
    assert shown.typed(f"[{shown.texts[0]}]") == shown.typed(shown.texts[0])
    assert body(changed(with_hole, "holes", ""), "disc").holes == ()
    back = fields(with_hole)["mesh"].set(with_hole, "grid")
    assert body(back, "disc").holes == ()
    assert expansion(body(back, "disc")).mass.sum() == pytest.approx(before.mass.sum())
    with pytest.raises(EditError, match="does not lie inside the outline"):
        changed(with_hole, "holes", "[[5, 5], [6, 5], [5, 6]]")


def test_outlines_of_several_kinds_are_mixed_and_can_be_made_alike(level):
    document = chosen(level, "box", "disc", "kite")
    assert fields(document)["shape"].value is MIXED
    alike = fields(document)["shape"].set(document, "circle")
    assert [body(alike, name).shape.circle for name in ("box", "disc", "kite")] == [0.5, 1.0, 1.0]


def test_what_is_only_shown_says_so(level):
    joined = fields(chosen(level, "deck"))["welds"]
    assert joined.value == "line.end = deck.1" and not joined.editable
    assert fields(chosen(level, "rope"))["size"].value == "5 particles, 4 springs"
    assert fields(chosen(level, "mesh"))["size"].value == "2 particles, 1 spring"
    with pytest.raises(EditError):
        joined.set(chosen(level, "deck"), "nothing")
    assert fields(Document(level, frozenset([Item("spring", 1)])))["number"].value == ":1"


def test_a_loose_spring_is_given_a_name_and_loses_it_again(level):
    spring = Document(level, frozenset([Item("spring", 1)]))
    named = fields(spring)["name"].set(spring, "left knee")
    assert named.level.springs[1].name == "left knee"
    assert fields(named)["name"].set(named, None).level.springs[1].name is None
    both = Document(level, frozenset([Item("spring", 0), Item("spring", 1)]))
    assert "name" not in fields(both), "two of one name could not be told apart"


def test_a_drive_is_added_with_values_that_fit_changed_and_taken_away(level):
    document = chosen(level, "wheel")
    assert "motor.speed" not in fields(document)
    driven = fields(document)["motor"].set(document, True)
    motor = body(driven, "wheel").motor
    # Twice what lifts 13 particles over the corners of 6 segments, at a radius of 2 m.
    assert (motor.speed, motor.torque, motor.key) == (3.0, 255.0, None)
    driven = changed(driven, "motor.speed", "-5")
    driven = changed(driven, "motor.key", "d")
    driven = changed(driven, "motor.reverse_key", "a")
    assert body(driven, "wheel").motor.__dict__ == {
        "key": "d", "reverse_key": "a", "speed": -5.0, "torque": 255.0,
    }  # fmt: skip
    with pytest.raises(EditError, match=r'"wheel": motor\.reverse_key: "d" is the key as well; name another'):
        changed(driven, "motor.reverse_key", "d")
    assert body(changed(driven, "motor.key", ""), "wheel").motor.key is None
    assert fields(driven)["motor"].set(driven, False).level.bodies == level.bodies


def test_drives_of_a_selection_are_for_those_that_can_have_one(level):
    document = chosen(level, "rope", "wheel", "ball", 0, 1)
    assert fields(document)["drive"].value is False and "drive.period" not in fields(document)
    driven = fields(document)["drive"].set(document, True)
    assert body(driven, "rope").drive.period == driven.level.springs[1].drive.period == 60
    assert body(driven, "line").drive is None
    driven = changed(driven, "drive.phase", "0.5")
    assert [spring.drive.phase for spring in driven.level.springs[:2]] == [0.5, 0.5]
    apart = changed(Document(driven.level, frozenset([Item("spring", 1)])), "drive.phase", "0.25")
    apart = Document(apart.level, document.selection)
    assert fields(apart)["drive.phase"].value is MIXED
    with pytest.raises(EditError, match="keep one of them"):
        fields(apart)["hydraulic"].set(apart, True)
    some = Document(fields(chosen(level, "rope"))["drive"].set(chosen(level, "rope"), True).level, document.selection)
    assert fields(some)["drive"].value is MIXED
    assert fields(fields(some)["drive"].set(some, True))["drive"].value is True


def test_a_hydraulic_begins_as_long_as_its_spring(level):
    document = Document(level, frozenset([Item("spring", 0)]))
    driven = fields(document)["hydraulic"].set(document, True)
    assert driven.level.springs[0].hydraulic.__dict__ == {
        "key": None, "reverse_key": None, "shortest": 3.0, "longest": 4.5, "rate": 1.5, "force": None, "returns": False,
    }  # fmt: skip
    assert driven.level.springs[0].rest_length == 3.0
    throws = changed(driven, "hydraulic.shortest", "0.6")
    assert throws.level.springs[0].given_length == 3.0, "it waits as it is drawn, whatever its shortest length"
    with pytest.raises(EditError, match="is above longest"):
        changed(driven, "hydraulic.shortest", "5")
    bare = Document(changed(throws, "rest_length", "").level, document.selection)
    assert fields(bare)["rest_length"].about.empty == "shortest: 0.6"
    assert fields(document)["rest_length"].about.empty == "as placed"
    given = Document(changed(document, "rest_length", "1.25").level, document.selection)
    assert fields(given)["hydraulic"].set(given, True).level.springs[0].hydraulic.shortest == 1.25


def test_a_number_is_counted_up_and_down_within_its_limits(level):
    wheel = fields(chosen(level, "wheel"))
    assert [wheel["segments"].stepped(by) for by in (1, -2, -9)] == [7, 4, 3]
    assert [wheel["radius"].stepped(by) for by in (1, -1)] == [2.1, 1.9]
    assert wheel["gravity_scale"].stepped(-10) == 0.0
    assert wheel["hub_mass"].stepped(1) is None and wheel["id"].stepped(1) is None
    assert Property("x", fields_of(KINDS["wheel"])["radius"], 0.001).stepped(-1) == 0.001


def test_settings_are_set_with_the_formats_types(level):
    document = Document(level)

    def setting(field):
        found = [each for section in level_properties(document) for each in section.properties]
        return next(each for each in found if each.field == field)

    document = setting("substeps").set(document, "auto")
    assert document.level.settings.substeps == "auto"
    document = setting("substeps").set(document, "4")
    assert document.level.settings.substeps == 4
    document = setting("gravity").set(document, setting("gravity").typed("-1.62", 1))
    assert document.level.settings.gravity == (0.0, -1.62)
    document = setting("solver").set(document, "iterative")
    assert document.level.settings.solver == "iterative"
    with pytest.raises(EditError, match="tick_rate: 0 is below the limit 1"):
        setting("tick_rate").set(document, setting("tick_rate").typed("0"))


def test_a_check_takes_a_box_a_body_or_a_span_of_time_by_what_it_measures(level):
    document = add_check(chosen(level, "rope"))

    def of_check():
        return {each.field: each for each in check_properties(document, 1)[0].properties}

    document = of_check()["metric"].set(document, "inside")
    assert {"particle", "body", "box"} <= of_check().keys() and "other" not in of_check()
    assert "after" in of_check() and "span" not in of_check()
    document = of_check()["box"].set(document, of_check()["box"].typed("5, 0, 0, 5"))
    document = of_check()["when"].set(document, "always")
    assert "after" not in of_check()
    for axis, text in enumerate(("1", "3")):
        document = of_check()["span"].set(document, of_check()["span"].typed(text, axis))
    check = document.level.checks[1]
    assert (check.box, check.always, check.eventually) == ((0.0, 0.0, 5.0, 5.0), (1.0, 3.0), None)
    document = of_check()["span"].set(document, of_check()["span"].typed("4", 0))
    assert document.level.checks[1].always == (4.0, 6.0)
    document = of_check()["when"].set(document, "eventually")
    assert (document.level.checks[1].always, document.level.checks[1].eventually) == (None, (4.0, 6.0))
    document = of_check()["metric"].set(document, "max_strain")
    assert (document.level.checks[1].box, document.level.checks[1].eventually) == (None, None)
    with pytest.raises(EditError, match="four numbers"):
        document = of_check()["metric"].set(document, "inside")
        of_check()["box"].set(document, (1.0, 2.0, 3.0))


@pytest.mark.parametrize("metric", METRICS)
def test_a_metric_brings_bounds_of_its_own(level, metric):
    document = add_check(chosen(level, "rope"))

    def of_check():
        return {each.field: each for each in check_properties(document, 1)[0].properties}

    document = of_check()["metric"].set(document, "max_speed")
    document = of_check()["metric"].set(document, metric)
    check = document.level.checks[1]
    assert (check.at_least, check.at_most) == METRICS[metric].usual
    # No bound is a dead end: the other one goes where the two contradict each other.
    document = of_check()["at_most"].set(document, -3.0)
    said = of_check()["at_least"].remark(document, 10.0)
    document = of_check()["at_least"].set(document, 10.0)
    check = document.level.checks[1]
    assert said == "at most -3 is gone" and (check.at_least, check.at_most) == (10.0, None)


def test_choosing_from_a_menu_what_is_chosen_already_changes_nothing(level):
    tried = set()
    for item in items_of(level):
        document = Document(level, frozenset([item]))
        for each in (each for section in properties(document) for each in section.properties):
            if each.about.kind == "choice" and each.editable:
                assert each.set(document, each.value) is document
                tried.add(each.field)
    assert {"firmness", "shape", "mesh"} <= tried


def test_a_new_check_is_of_what_is_selected_or_else_that_nothing_breaks(level):
    assert promise_text(add_check(chosen(level, "rope")).level.checks[1]) == "x of rope is at least 1 m"
    assert promise_text(add_check(chosen(level, "nail")).level.checks[1]) == "x of nail is at least 5 m"
    assert promise_text(add_check(Document(level)).level.checks[1]) == "no spring breaks"


def test_a_check_of_a_particle_is_one_of_a_body_once_that_is_named(level):
    document = add_check(chosen(level, "rope"))

    def of_check():
        return {each.field: each for each in check_properties(document, 1)[0].properties}

    document = of_check()["metric"].set(document, "x")
    assert document.level.checks[1].body == "rope"
    document = of_check()["particle"].set(document, "rope.1")
    assert (document.level.checks[1].particle, document.level.checks[1].body) == ("rope.1", None)


def test_a_check_gets_a_particle_with_a_metric_that_needs_one_and_loses_it_again(level):
    document = add_check(chosen(level, "rope"))

    def of_check():
        return {each.field: each for each in check_properties(document, 1)[0].properties}

    document = of_check()["metric"].set(document, "max_speed")
    assert "particle" not in of_check()
    document = of_check()["metric"].set(document, "speed")
    assert document.level.checks[1].body == "rope"
    assert {"particle", "body"} <= of_check().keys()
    document = of_check()["metric"].set(document, "distance")
    assert document.level.checks[1].particle == "rope.4"
    document = of_check()["metric"].set(document, "max_strain")
    assert document.level.checks[1].particle is None
    with pytest.raises(EditError, match="needs a bound"):
        of_check()["at_most"].set(document, None)
    assert delete_check(document, 1).level.checks == level.checks
    assert check_properties(document, 7) == ()


EVERYTHING = parse_level(json.dumps(LEVEL).encode(), "test")
TYPED = st.one_of(
    st.text(max_size=12),
    st.floats().map(repr),
    st.integers(-(10**30), 10**30).map(str),
    st.lists(st.integers(-2, 12)).map(str),
    st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)).map(list), max_size=4).map(str),
    st.sampled_from(["1e999", "-0", "0x10", "1_0", "true", "null", '"', "[[[[", "]", "{}", "\\"]),
    st.sampled_from(["9" * 5000, "[" * 3000]),
)  # fmt: skip


@settings(max_examples=150, deadline=None)
@given(st.integers(0, len(items_of(EVERYTHING)) - 1), st.data(), TYPED, st.integers(0, 1))
def test_whatever_is_typed_gives_a_level_that_can_be_saved_or_one_line(index, data, text, axis):
    document = Document(EVERYTHING, frozenset([items_of(EVERYTHING)[index]]))
    everywhere = [*properties(document), *level_properties(document), *check_properties(document, 0)]
    typed = [each for section in everywhere for each in section.properties if each.editable]
    typed = [each for each in typed if each.about.kind not in ("flags", "yes_no", "choice")]
    each = data.draw(st.sampled_from(typed), "field")
    try:
        after = each.set(document, each.typed(text, axis))
    except EditError as fault:
        assert str(fault) and len(str(fault).splitlines()) == 1
        return
    saved = level_text(after.level)
    assert parse_level(saved.encode(), "saved") == after.level


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_shown_without_becoming_another(value):
    assert math.isclose(float(number_text(value)), value, rel_tol=1e-14)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.1 + 0.2, "0.3"),
        (-1.4000000000000001, "-1.4"),
        (3.0999999999999996, "3.1"),
        (1 / 3, repr(1 / 3)),
        (1e-9, "1e-09"),
    ],
)
def test_the_dust_of_arithmetic_is_not_shown(value, text):
    assert number_text(value) == text


@given(st.text(alphabet="ab\\nt\n\t ", max_size=12))
def test_a_text_of_several_lines_is_one_line_to_change(text):
    assert "\n" not in line_text(text)
    assert read_line(line_text(text)) == text


@given(st.lists(st.text(max_size=6).filter(lambda word: word.strip()), max_size=4))
def test_words_survive_being_typed(words):
    assert read_words("Tags", list_text(words)) == words


@given(st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)), max_size=3))
def test_points_survive_being_typed(points):
    assert read_pairs("Corners", list_text(points)) == [list(point) for point in points]


def test_a_muscles_period_is_shown_in_seconds_beside_ticks_and_its_phase_is_of_a_period():
    document = Document(parse_level(json.dumps(LEVEL).encode(), "test"), frozenset([Item("body", "driven")]))
    shown = {made.field: made for section in properties(document) for made in section.properties}
    names = list(shown)
    assert names.index("drive.period.seconds") == names.index("drive.period") + 1
    seconds = shown["drive.period.seconds"]
    assert seconds.texts == ("0.5",) and seconds.about.unit == "s" and not seconds.editable
    assert shown["drive.phase"].about.title == "Phase, of a period"


def test_what_only_some_of_a_mixed_selection_have_is_there_for_those():
    level = zoo()
    rope = next(body for body in level.bodies if body.type == "rope")
    particle = level.particles[0]
    both = Document(level, frozenset([Item("body", rope.id), Item("particle", particle.id)]))
    found = {each.field: each for section in properties(both) for each in section.properties}
    assert found["material"].value == rope.material and found["mass"].value == particle.mass
    heavier = found["mass"].set(both, 7.0).level
    assert heavier.particles[0].mass == 7.0 and heavier.bodies == level.bodies
    other = next(name for name in level.materials if name != rope.material)
    changed = found["material"].set(both, other).level
    assert next(body for body in changed.bodies if body.id == rope.id).material == other
    assert changed.particles == level.particles


def test_what_hands_may_do_is_ticked_with_numbers_and_what_is_wrong_is_said(level):
    document = Document(level)

    def hands(field):
        (found,) = (each for each in level_properties(document) if each.title == "Hands")
        return {each.field: each for each in found.properties}.get(field)

    for field, value in (
        ("hands.may", "nothing"),
        ("hands.may.add", True),
        ("hands.may.grab", True),
        ("hands.at_most.add", 3),
    ):
        document = hands(field).set(document, value)
    assert document.level.hands.may == ("grab", "add") and document.level.hands.budgets == {"add": 3}
    assert hands("hands.at_most.cut") is None and hands("hands.at_most.add").texts == ("3",)
    with pytest.raises(EditError, match="no body or particle"):
        hands("hands.bodies").set(document, "x")
    name = level.bodies[0].id
    only = hands("hands.bodies").set(document, name)
    assert only.level.hands.bodies == (name,)
    # What may not be done has no number, and without limits there is nothing in the file.
    document = hands("hands.may.add").set(only, False)
    assert document.level.hands.budgets == {}
    for field, value in (("hands.bodies", None), ("hands.may", "all")):
        document = hands(field).set(document, value)
    assert document.level.hands is None


def test_contacts_that_ground_or_walls_switch_on_show_the_numbers_in_force(level):
    def section(document):
        (found,) = (each for each in level_properties(document) if each.title == "Contacts")
        return {each.field: each for each in found.properties}

    ground = Document(replaced(level, contacts=None))
    shown = section(ground)
    assert shown["contacts"].value == "on: there is ground" and not shown["contacts"].editable
    assert (shown["contacts.friction"].value, shown["contacts.restitution"].value) == (0.5, 0.0)
    assert shown["contacts.restitution"].about.title == "Bounce"
    icy = shown["contacts.friction"].set(ground, 0.1)
    assert icy.level.contacts == ContactsDef(friction=0.1) and section(icy)["contacts"].value is True
    bare = Document(replaced(level, contacts=None, terrain=(), walls=None, zones=()))
    assert section(bare)["contacts"].value is False and "contacts.friction" not in section(bare)


def test_tips_of_menus_speak_of_menus_and_those_of_fields_of_fields():
    assert fields_of(BodyLook)["skin"].tooltip == "What it is filled with. If nothing is chosen: automatic."
    assert fields_of(SpringDef)["rest_length"].tooltip.count("Empty: as placed.") == 1


def test_a_look_of_a_material_has_no_window_for_particles_that_it_has_not():
    material = NissenMaterial(look=BodyLook(face=False))
    assert "look.face" in {each.field for each in look_properties("jelly", material)}
    assert "look.window" not in {each.field for each in look_properties("jelly", material)}
