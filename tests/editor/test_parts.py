"""The catalogue of parts: what putting one into a level does, files of one's own, and that the shipped ones work."""

import json
import os

import numpy as np
import pytest

from sandbox.editor.document import Document, EditError, empty_level
from sandbox.editor.edits.copying import copy_text, part_of, paste, place_part
from sandbox.editor.edits.fields import set_setting
from sandbox.editor.history import History
from sandbox.editor.items import Item, items_of
from sandbox.editor.scene import make_scene
from sandbox.editor.storage.level_file import StorageError, catalogue, delete_part, keep_part, rename_part
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import NissenMaterial, ParticleDef, TerrainDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bridge import BridgeDef
from sandbox.level.reading.parse import parse_level
from sandbox.physics.equation import frequency_from_coefficients
from sandbox.physics.step import step

SHIPPED = {part.path.stem: part for part in catalogue(None) if not part.is_own}
FLOOR = TerrainDef(id="floor", polyline=((-90.0, 0.0), (90.0, 0.0)))


@pytest.fixture
def floor():
    return Document(replaced(empty_level(), terrain=(FLOOR,)))


def with_part(document, name, at=(0.0, 0.0), mirrored=False):
    return place_part(document, SHIPPED[name].level, at, mirrored)


def run(world, seconds, **values):
    """Let so many seconds pass with driven parts at these values, by their names with "_" for blanks and "s" for :."""
    for name, value in values.items():
        world.drive(world.actuators.names.index(name.replace("_", " ").replace("spring ", ":")), value)
    for _ in range(round(seconds * world.settings.tick_rate)):
        step(world)
    assert not world.contained


def place(world, name):
    return world.position[world.particle_slot(name)].copy()


def readings(level, names):
    """Hz and damping ratio of materials, at the level's rate."""
    step_time = 1.0 / level.settings.tick_rate
    springs = [level.materials[name] for name in names]
    return np.array([frequency_from_coefficients(each.stiffness, each.damping, step_time) for each in springs])


# Putting a part into a level.


def test_a_part_goes_on_per_second_as_it_did_in_a_level_of_another_rate_and_back(floor):
    fast = set_setting(floor, "tick_rate", 120)
    part = SHIPPED["car"].level
    names = [name for name, each in part.materials.items() if each.damping < 1.0]
    there = with_part(fast, "car")
    assert names and np.allclose(readings(there.level, names), readings(part, names), rtol=1e-4)
    kept = part_of(there, "Fast car")
    assert kept.settings.tick_rate == 120
    back = place_part(floor, kept, (0.0, 0.0)).level
    assert np.allclose(readings(back, names), readings(part, names), rtol=1e-3)


def test_text_copied_from_a_level_of_another_rate_is_pasted_in_pace(floor):
    part = SHIPPED["balloon"].level
    text = copy_text(Document(part, frozenset(items_of(part))))
    pasted = paste(set_setting(floor, "tick_rate", 240), text).level
    names = [name for name, each in part.materials.items() if each.damping < 1.0 and name in pasted.materials]
    assert names and np.allclose(readings(pasted, names), readings(part, names), rtol=1e-3)


def test_a_part_is_put_where_the_pointer_is_as_one_group_and_is_selected(floor):
    document = with_part(floor, "car", (3.0, 1.0))
    bodies = document.level.bodies
    assert [body.id for body in bodies] == ["car", "rear wheel", "front wheel"]
    assert {part.group for part in (*bodies, *document.level.springs)} == {"Car"}
    assert document.selection == frozenset(items_of(document.level)) - {Item("terrain", "floor")}
    left, bottom, right, _ = make_scene(document.level).bounds(document.selection)
    assert (left + right) / 2 == pytest.approx(3.0, abs=0.2) and bottom == pytest.approx(1.0, abs=0.07)


def test_a_second_one_has_names_of_its_own_and_shares_the_materials(floor):
    once = with_part(floor, "car")
    twice = with_part(once, "car", (8.0, 0.0))
    assert len({body.id for body in twice.level.bodies}) == 6
    assert {spring.a.partition(".")[0] for spring in twice.level.springs} == {"car", "car 2"}
    assert twice.level.materials == once.level.materials
    assert {body.group for body in twice.level.bodies} == {"Car", "Car 2"}
    assert parse_level(level_text(twice.level).encode(), "again") == twice.level


def test_a_material_of_the_same_name_and_other_values_is_renamed(floor):
    soft = {**floor.level.materials, "shock": NissenMaterial(stiffness=0.01, damping=0.02)}
    document = with_part(Document(replaced(floor.level, materials=soft)), "car")
    assert document.level.materials["shock"] == soft["shock"]
    used = {spring.material for spring in document.level.springs}
    assert "shock" not in used and "shock 2" in used
    assert document.level.materials["shock 2"] == SHIPPED["car"].level.materials["shock"]


def test_keys_of_drives_are_kept_and_a_mirrored_car_looks_and_drives_the_other_way(floor):
    wheels = with_part(floor, "car").level.bodies[1:]
    mirrored = with_part(floor, "car", mirrored=True).level
    assert [(w.motor.key, w.motor.reverse_key) for w in wheels] == [("d", "a")] * 2
    assert [w.motor.key for w in mirrored.bodies[1:]] == ["d"] * 2
    world = build_world(mirrored)
    before = place(world, "car.0")
    run(world, 1.5, rear_wheel=1.0, front_wheel=1.0)
    assert place(world, "car.0")[0] < before[0] - 1.0


def test_where_nothing_touches_anything_a_part_made_to_touch_lets_things_touch(floor):
    bare = Document(empty_level())
    assert not bare.level.has_contacts and with_part(bare, "car").level.has_contacts
    # A level that says how things touch keeps what it says.
    assert with_part(floor, "car").level.contacts is None


def test_undo_takes_the_whole_part_back(floor):
    history = History(floor)
    history.apply("Add Crane", with_part(floor, "crane"))
    history.undo()
    assert history.document.level is floor.level


def test_a_part_with_nothing_in_it_is_refused(floor):
    with pytest.raises(EditError, match="nothing in this part"):
        place_part(floor, empty_level(), (0.0, 0.0))


# A person's own.


@pytest.fixture
def ball():
    level = replaced(
        empty_level(), particles=(ParticleDef(id="ball", position=(4.0, 7.5), radius=0.5),), terrain=(FLOOR,)
    )
    return Document(level, frozenset([Item("particle", "ball")]))


def own(folder):
    return [part for part in catalogue(folder) if part.is_own]


def test_what_is_kept_stands_on_its_origin_and_comes_back_as_it_was(ball, tmp_path):
    keep_part(part_of(ball, "My ball"), tmp_path)
    (part,) = own(tmp_path)
    assert (part.name, part.path.name, part.fault) == ("My ball", "my-ball.json", "")
    assert part.level.particles[0].position == (0.0, 0.5) and not part.level.terrain
    assert part.level.has_contacts
    again = place_part(ball, part.level, (4.0, 7.0))
    assert [p.id for p in again.level.particles] == ["ball", "ball 2"]
    assert again.level.particles[1].position == (4.0, 7.5)


def test_nothing_selected_and_no_name_are_refused(ball):
    with pytest.raises(EditError, match="select something"):
        part_of(Document(ball.level), "x")
    for name in ("", "  ", "x" * 300):
        with pytest.raises(EditError, match="1 to 256"):
            part_of(ball, name)


def test_a_taken_name_is_refused_and_other_names_that_make_one_file_name_do_not_meet(ball, tmp_path):
    keep_part(part_of(ball, "Ball!"), tmp_path)
    with pytest.raises(StorageError, match="already"):
        keep_part(part_of(ball, "ball!"), tmp_path)
    keep_part(part_of(ball, "Ball?"), tmp_path)
    assert sorted(part.path.name for part in own(tmp_path)) == ["ball-2.json", "ball.json"]


def test_own_parts_are_renamed_and_deleted_with_their_files(ball, tmp_path):
    keep_part(part_of(ball, "Ball"), tmp_path)
    path = rename_part(own(tmp_path)[0], "Grüße an ../alle")
    assert path.parent == tmp_path and [part.name for part in own(tmp_path)] == ["Grüße an ../alle"]
    delete_part(own(tmp_path)[0])
    assert os.listdir(tmp_path) == []
    assert all(not part.is_own for part in catalogue(tmp_path))


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"{", "not JSON"),
        (b"\xff\xfe", "UTF-8"),
        (b"[]", "level"),
        (b'{"format": "spring-sandbox/level", "version": 3, "name": "Empty"}', "nothing in it"),
        (json.dumps({"format": "spring-sandbox/level", "version": 3, "name": "x", "wheels": 4}).encode(), "wheels"),
    ],
)
def test_a_broken_file_is_listed_with_one_line_that_says_why(content, fault, tmp_path):
    (tmp_path / "odd.json").write_bytes(content)
    (part,) = own(tmp_path)
    assert part.level is None and part.name == "odd"
    assert fault in part.fault and "\n" not in part.fault
    delete_part(part)
    assert not own(tmp_path)


def test_a_folder_that_cannot_be_written_is_said_in_one_line(ball, tmp_path):
    (tmp_path / "parts").write_text("a file")
    with pytest.raises(StorageError, match="cannot be used"):
        keep_part(part_of(ball, "Ball"), tmp_path / "parts")


def test_a_file_that_has_changed_is_read_again(ball, tmp_path):
    path = keep_part(part_of(ball, "Ball"), tmp_path)
    assert own(tmp_path)[0].name == "Ball"
    path.write_text(path.read_text().replace('"Ball"', '"Another ball"'))
    assert own(tmp_path)[0].name == "Another ball"


# That the shipped ones are good.


def test_every_shipped_part_is_sound_and_stands_on_its_origin():
    assert {"car", "crane", "walker", "windmill", "tower"} <= set(SHIPPED)
    for name, part in SHIPPED.items():
        assert part.fault == "" and part.level.description, name
        scene = make_scene(part.level)
        left, _, right, _ = scene.bounds()
        assert left <= 0.0 <= right, name
        lowest = float((scene.position[:, 1] - scene.radius).min())
        pinned = bool(scene.pinned.any())
        assert pinned or lowest == pytest.approx(0.0, abs=0.08), f"{name} floats or is sunk by {lowest}"


def test_parts_without_a_drive_stay_in_one_piece_side_by_side(floor):
    document = floor
    for index, name in enumerate(("brick_tower", "jelly_friend", "seesaw", "tower", "trampoline", "wrecking_ball")):
        document = with_part(document, name, (9.0 * index - 48.0, 0.0))
    world = build_world(document.level)
    springs = world.spring_active.copy()
    run(world, 0.75)
    assert float(np.abs(world.velocity).max()) < 6.0
    assert (world.spring_active == springs).all()


def test_the_car_drives_and_crosses_a_bridge():
    cliffs = (
        TerrainDef(id="left", polygon=((-20.0, -4.0), (-4.0, -4.0), (-4.0, 0.0), (-20.0, 0.0))),
        TerrainDef(id="right", polygon=((4.0, -4.0), (30.0, -4.0), (30.0, 0.0), (4.0, 0.0))),
    )
    deck = BridgeDef(
        type="bridge", id="deck", start=(-4.0, 0.0), end=(4.0, 0.0), segments=8, height=0.8, pin=("start", "end"),
        particle_mass=4.0, material="steel",
    )  # fmt: skip
    level = replaced(empty_level(), terrain=cliffs, bodies=(deck,))
    world = build_world(with_part(Document(level), "car", (-8.0, 0.0)).level)
    run(world, 4.0, rear_wheel=1.0, front_wheel=1.0)
    x, y = place(world, "car.7")
    assert x > 6.0 and y > 1.5, "it lies on the far side, the right way up"


def test_the_walker_walks(floor):
    world = build_world(with_part(floor, "walker").level)
    before = place(world, "body.6")
    run(world, 4.0)
    x, y = place(world, "body.6") - before
    assert x > 3.0 and abs(y) < 1.0


def test_the_crane_lifts_its_crate_and_lets_it_down(floor):
    world = build_world(with_part(floor, "crane").level)
    run(world, 0.5)
    before = place(world, "crate.4")[1]
    run(world, 2.0, spring_0=-1.0)
    lifted = place(world, "crate.4")[1]
    run(world, 2.5, spring_0=1.0)
    assert lifted > before + 1.5 and place(world, "crate.4")[1] < before + 0.5
    assert float(place(world, "mast.11")[1]) == pytest.approx(6.0, abs=0.05)


def test_the_windmill_turns_by_itself(floor):
    world = build_world(with_part(floor, "windmill").level)
    tip, hub = "sail 1.3", "shaft.hub"
    turned = 0.0
    before = place(world, tip) - place(world, hub)
    for _ in range(90):
        step(world)
        now = place(world, tip) - place(world, hub)
        turned += float(np.arctan2(before[0] * now[1] - before[1] * now[0], before @ now))
        before = now
    assert turned > 1.5


def test_the_ferris_wheel_turns_both_ways_and_keeps_its_seats(floor):
    world = build_world(with_part(floor, "ferris_wheel").level)
    before, springs = place(world, "wheel.9"), world.spring_active.copy()
    run(world, 1.5, wheel=1.0)
    assert place(world, "wheel.9")[1] > before[1] + 0.5 and (world.spring_active == springs).all()


def test_the_catapult_throws_its_ball_far(floor):
    world = build_world(with_part(floor, "catapult").level)
    run(world, 0.5)
    run(world, 2.5, spring_0=1.0)
    assert place(world, "ball")[0] > 10.0


def test_the_balloon_rises_and_the_swing_swings(floor):
    world = build_world(with_part(with_part(floor, "balloon", (-8.0, 0.0)), "swing").level)
    before, child = place(world, "basket.0"), place(world, "child.0")
    run(world, 0.4)
    assert place(world, "child.0")[0] > child[0] + 0.3
    run(world, 1.6)
    assert place(world, "basket.0")[1] > before[1] + 0.2
