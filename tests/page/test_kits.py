"""Kits in pages: they join, and what hangs together goes, to the desktop's bits and with its words."""

import pytest

from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from sandbox.session.commands import CommandError, apply
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session
from tests.page.in_node import NODE, tried_in_node
from tests.session.test_kits import DEFINITIONS, WRONG, kit_of, wrong
from tests.support.parts import furnished, placed_cart

pytestmark = pytest.mark.skipif(NODE is None, reason="node is not installed")


def told_of(records, before=()):
    """What comes of each record on the desktop, after others and a tick, from the same state."""
    found = []
    for record in records:
        world = Session(furnished()).world
        for each in before:
            apply(world, from_record(each, world))
        step(world)
        try:
            apply(world, from_record(record, world))
            words = "taken"
        except CommandError as error:
            words = str(error)
        found.append((words, state_hash(world)))
    return found


def same(folder, records, before=()):
    world = Session(furnished()).world
    tried = tried_in_node(folder, world, list(before), list(records))
    found = told_of(records, before)
    assert [each["hash"] for each in tried] == [digest for _, digest in found]
    assert not any(each["isChanged"] for each in tried)
    assert [each["words"] for each in tried] == [words.removeprefix("add_body: kit: ") for words, _ in found]


def test_every_kind_of_body_joins_in_a_page_to_the_bits_of_the_desktop(tmp_path):
    world = Session(furnished()).world
    kits = [kit_of(world, definition) for definition in DEFINITIONS.values()]
    same(tmp_path, [{"type": "add_body", "kit": kit} for kit in kits])


def test_particles_springs_and_a_body_tied_to_others_join_in_a_page(tmp_path):
    tied = {
        "bodies": 1,
        "particles": {"x": [0.0, 1.0], "y": [5.0, 5.0], "body": [0, 0], "group": 2, "collides": "4611686018427387903"},
        "springs": {"a": [0, 1], "b": [1, "cube.0"]},
        "materials": {"name": ["default"]},
    }
    same(
        tmp_path,
        [
            {"type": "add_particle", "position": [0.5, 6.0], "velocity": [1.0, -2.0], "restitution": 0.5},
            {
                "type": "add_particle",
                "position": [0.5, 6.0],
                "mass": 2.0,
                "pinned": True,
                "radius": 0.2,
                "friction": 0.7,
            },
            {"type": "add_spring", "particle_a": "cube.0", "particle_b": "ball", "stiffness": 0.1},
            {"type": "add_spring", "particle_a": "cube.0", "particle_b": "rope.2", "rest_length": 0.4},
            {"type": "add_body", "kit": tied},
        ],
    )


def test_what_hangs_together_and_a_body_by_its_name_go_in_a_page(tmp_path):
    cart = {"type": "add_body", "kit": kit_of(Session(furnished()).world, placed_cart(0.0, 3.0))}
    same(
        tmp_path,
        [
            {"type": "remove", "particle": "rope.2"},
            {"type": "remove", "particle": "ball"},
            {"type": "remove", "particle": "+2.hub"},
            {"type": "remove", "body": "+2"},
            {"type": "remove", "body": "cube"},
            {"type": "add_body", "kit": kit_of(Session(furnished()).world, DEFINITIONS["weak"])},
        ],
        before=[cart],
    )


def test_a_kit_that_the_desktop_refuses_is_refused_in_a_page_with_its_words(tmp_path):
    world = Session(furnished()).world
    kit = kit_of(world, DEFINITIONS["moving"])
    same(tmp_path, [{"type": "add_body", "kit": wrong(kit, place, value)} for place, value, _ in WRONG])
