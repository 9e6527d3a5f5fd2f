"""What the camera goes along with stays right whatever is edited."""

import pytest

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.deleting import break_apart, delete
from sandbox.editor.edits.fields import rename
from sandbox.editor.items import Item
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import ParticleDef, TerrainDef
from sandbox.level.format.look import LevelLook
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.reading.parse import parse_level


def followed(name):
    level = replaced(
        empty_level(),
        bodies=(RopeDef(type="rope", id="rope", start=(0.0, 0.0), end=(1.0, 0.0), segments=2),),
        particles=(ParticleDef(id="ball"),),
        terrain=(TerrainDef(id="floor", polyline=((-5.0, -1.0), (5.0, -1.0))),),
        look=LevelLook(follow=name, ground={"floor": "wood"}),
    )
    return Document(level)


def read_again(document):
    return parse_level(level_text(document.level).encode(), "x.json").look


@pytest.mark.parametrize(("kind", "name"), [("body", "rope"), ("particle", "ball")])
def test_what_is_followed_is_followed_under_another_name_and_no_more_once_it_is_gone(kind, name):
    document = followed(name)
    assert read_again(rename(document, Item(kind, name), "hero")).follow == "hero"
    chosen = replaced_selection(document, Item(kind, name))
    assert read_again(delete(chosen)).follow is None


def test_of_a_body_that_is_broken_apart_its_first_particle_is_followed():
    apart = break_apart(replaced_selection(followed("rope"), Item("body", "rope")))
    assert read_again(apart).follow == "rope 0"


def test_terrain_keeps_its_ground_under_another_name():
    assert read_again(rename(followed(None), Item("terrain", "floor"), "stage")).ground == {"stage": "wood"}


def replaced_selection(document, item):
    return Document(document.level, frozenset([item]))
