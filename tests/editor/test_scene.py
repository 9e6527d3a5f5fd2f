"""Scenes: the arrays of a level, as the world has them; parts of an old scene are reused without a difference."""

import numpy as np
import pytest

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.moving import move
from sandbox.editor.items import Item, items_of
from sandbox.editor.scene import make_scene
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.plan.plan import kept_plan
from sandbox.level.reading.files import parse_level, read_level, shipped_levels
from tests.support.zoo import zoo


@pytest.mark.parametrize("path", shipped_levels(), ids=lambda path: path.stem)
def test_a_scene_has_the_particles_and_springs_of_the_world(path):
    level = read_level(path)
    scene, world = make_scene(level), build_world(level)
    slots = [world.particle_slot(scene.names(slot)) for slot in range(len(scene.mass))]
    springs = [world.spring_slot(scene.spring_name(spring)) for spring in range(len(scene.rest_length))]
    assert np.array_equal(scene.position, world.position[slots])
    assert np.array_equal(scene.pinned, world.inverse_mass[slots] == 0.0)
    assert np.array_equal(np.array(slots)[scene.particle_a], world.particle_a[springs])
    assert np.allclose(scene.rest_length, world.natural_length[springs], rtol=1e-12)
    assert [scene.materials[k] for k in scene.material] == [world.material_names[k] for k in world.material[springs]]


def test_names_lead_to_slots_and_back():
    scene = make_scene(zoo())
    assert [scene.slot(scene.names(slot)) for slot in range(len(scene.mass))] == list(range(len(scene.mass)))
    assert scene.names(scene.slot("rope.end")) == "rope.6"
    with pytest.raises(LookupError, match="nobody"):
        scene.slot("nobody")


def test_welded_particles_stay_two_in_one_place_and_are_held_together():
    scene = make_scene(zoo())
    a, b = scene.slot("web.centre"), scene.slot("hook 2")
    assert a != b
    assert np.array_equal(scene.position[a], scene.position[b])
    assert scene.welds.tolist()[2] == [a, b]
    assert scene.first_of_weld[b] == a
    beam, deck = scene.slot("beam.start"), scene.slot("deck.4")
    assert scene.pinned[beam]
    assert scene.pinned[deck]


def test_an_empty_level_has_a_scene_without_bounds():
    scene = make_scene(empty_level())
    assert (len(scene.items), len(scene.position), len(scene.rest_length)) == (0, 0, 0)
    assert scene.bounds() is None


def test_bounds_are_those_of_the_selected_particles_and_the_ends_of_selected_springs():
    scene = make_scene(zoo())
    assert scene.bounds(frozenset([Item("body", "rope")])) == (0.0, 5.0, 3.0, 5.0)
    assert scene.bounds(frozenset([Item("spring", 3)])) == (0.0, 5.0, 10.0, 7.0)
    assert scene.bounds(frozenset()) is None


def test_the_scene_of_a_move_has_the_selected_particles_elsewhere_and_the_others_where_they_were():
    scene = make_scene(zoo())
    chosen = frozenset([Item("body", "cube")])
    moved = make_scene(move(Document(scene.level, chosen), 2.0, -1.0).level, scene)
    mine = scene.particles_of(chosen)
    assert np.allclose(moved.position[mine], scene.position[mine] + [2.0, -1.0])
    assert np.array_equal(moved.position[~mine], scene.position[~mine])


def test_bodies_that_did_not_change_are_not_expanded_again(monkeypatch):
    level = zoo()
    scene = make_scene(level)
    expanded = []
    monkeypatch.setattr("sandbox.editor.scene.expansion", lambda body: expanded.append(body.id) or pytest.fail())
    moved = move(Document(level, frozenset([Item("body", "cube"), Item("particle", "hook")])), 1.0, 0.0).level
    assert make_scene(moved, scene).items is scene.items
    assert expanded == []


def test_all_items_are_selected_by_mask():
    scene = make_scene(zoo())
    assert scene.particles_of(frozenset(items_of(scene.level))).all()
    assert scene.springs_of(frozenset([Item("spring", 0), Item("body", "rope")])).sum() == 6


def test_the_scene_of_a_level_that_was_read_takes_the_expansions_of_its_check(monkeypatch):
    level = parse_level(level_text(zoo()).encode(), "zoo.json")
    monkeypatch.setattr("sandbox.level.plan.plan.expansion", lambda body: pytest.fail(body.id))
    monkeypatch.setattr("sandbox.editor.scene.expansion", lambda body: pytest.fail(body.id))
    assert make_scene(level).parts.names.plan is kept_plan(level)


def test_lengths_of_springs_depend_on_the_form_alone_not_on_which_body_of_it_was_expanded_first():
    level = zoo()
    moved = Document(level, frozenset(items_of(level)))
    for _ in range(3):
        before = make_scene(moved.level)
        moved = move(moved, 0.1, -0.7)
        assert (make_scene(moved.level, before).rest_length == make_scene(moved.level).rest_length).all()
