"""Own data of a level maker: added, changed and removed, on one thing, on several and on the level."""

import json

import pytest

from sandbox.editor.document import Document, EditError, empty_level
from sandbox.editor.items import items_of
from sandbox.editor.panel.extra_values import read_entry
from sandbox.editor.panel.level_properties import level_properties
from sandbox.editor.panel.properties import properties
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import ParticleDef, SpringDef, TerrainDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.reading.parse import parse_level


@pytest.fixture
def document():
    """One thing of each kind, all selected."""
    level = replaced(
        empty_level(),
        bodies=(RopeDef(type="rope", id="rope", start=(0.0, 0.0), end=(1.0, 0.0), segments=2),),
        particles=(ParticleDef(id="a"), ParticleDef(id="b", position=(1.0, 1.0))),
        springs=(SpringDef(a="a", b="b"),),
        terrain=(TerrainDef(id="floor", polyline=((-5.0, -1.0), (5.0, -1.0))),),
    )
    return Document(level, frozenset(items_of(level)))


def rows(document, of=properties):
    return {each.field: each for section in of(document) for each in section.properties}


@pytest.mark.parametrize(
    ("typed", "name", "value"),
    [
        ("speed = 3", "speed", 3),
        ("speed=0.5", "speed", 0.5),
        ("title = Cave of = wonders", "title", "Cave of = wonders"),
        ("secret = yes", "secret", True),
        ("secret = No", "secret", False),
        ("path = 1, 2.5, 3", "path", [1, 2.5, 3]),
        ("names = ann, bob", "names", ["ann", "bob"]),
        ("points = [[0, 1], [2, 3]]", "points", [[0, 1], [2, 3]]),
        ('text = "3"', "text", "3"),
        ("nothing =", "nothing", ""),
    ],
)
def test_a_typed_entry_is_a_name_and_a_value_of_its_type(typed, name, value):
    read = read_entry(typed)
    assert read == (name, value) and type(read[1]) is type(value)


@pytest.mark.parametrize("typed", ["", "speed", "= 3", "x" * 300 + " = 1"])
def test_what_is_no_entry_is_told_in_one_line(typed):
    with pytest.raises(EditError) as error:
        read_entry(typed)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("of", [properties, level_properties])
def test_own_data_is_added_changed_and_removed_and_read_again_from_the_file(document, of):
    start = level_text(document.level)
    for typed in ("speed = 3", "title = Cave", "secret = yes", "path = 1, 2"):
        document = rows(document, of)["extras"].set(document, typed)
    shown = rows(document, of)
    kinds = {name: shown[f"extras.{name}"].about.kind for name in ("speed", "title", "secret", "path")}
    assert kinds == {"speed": "number", "title": "text", "secret": "yes_no", "path": "list"}
    for name, text in (("speed", "4.5"), ("title", "Hall"), ("path", "5, 6, 7")):
        each = rows(document, of)[f"extras.{name}"]
        document = each.set(document, each.typed(text))
    document = rows(document, of)["extras.secret"].set(document, False)
    wanted = {"speed": 4.5, "title": "Hall", "secret": False, "path": [5, 6, 7]}
    again = parse_level(level_text(document.level).encode(), "x.json")
    held = [again] if of is level_properties else [*again.bodies, *again.particles, *again.springs, *again.terrain]
    assert [each.extras for each in held] == [wanted] * len(held)
    for name in wanted:
        document = rows(document, of)[f"extras.{name}"].remove(document)
    assert level_text(document.level) == start


def test_of_several_things_what_all_have_is_shown_and_what_differs_is_mixed(document):
    one = Document(document.level, frozenset(item for item in document.selection if item.key == "a"))
    one = rows(one)["extras"].set(one, "alone = 1")
    both = Document(one.level, document.selection)
    assert "extras.alone" not in rows(both)
    both = rows(both)["extras"].set(both, "alone = 2")
    assert rows(both)["extras.alone"].value == 2
    one = Document(both.level, one.selection)
    one = rows(one)["extras.alone"].set(one, 9)
    both = Document(one.level, document.selection)
    assert rows(both)["extras.alone"].texts == ("mixed",)
    assert all("alone" in part.extras for part in (*both.level.bodies, *both.level.particles))


def test_an_object_is_shown_as_it_is_and_can_be_removed_alone(document):
    document = Document(replaced(document.level, extras={"tool": {"deep": [1, {}]}}))
    row = rows(document, level_properties)["extras.tool"]
    assert json.loads(row.texts[0]) == {"deep": [1, {}]} and not row.editable
    assert row.remove(document).level.extras == {}


def test_a_text_beyond_the_limit_is_refused(document):
    with pytest.raises(EditError):
        rows(document, level_properties)["extras"].set(document, "a = " + "x" * 100_000)
