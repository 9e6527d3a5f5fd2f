"""Edits that put in, take out, copy, rename and rebuild: what the level says then, and what the world is."""

import math

import numpy as np
import pytest

from sandbox.editor.document import Document, EditError, empty_level
from sandbox.editor.edits.copying import array_circle, array_line, copy_text, duplicate, paste
from sandbox.editor.edits.deleting import break_apart, delete
from sandbox.editor.edits.fields import rename, set_field, set_level_field, set_setting
from sandbox.editor.edits.grouping import group, reorder, ungroup, with_groups
from sandbox.editor.edits.materials import (
    add_material,
    assign,
    delete_material,
    rename_material,
    set_checks,
    set_material,
)
from sandbox.editor.edits.moving import rotate
from sandbox.editor.edits.names import free_id
from sandbox.editor.edits.placing import add_body, add_particle, add_spring, set_pinned, unweld, weld, without_springs
from sandbox.editor.items import Item, items_of
from sandbox.editor.scene import make_scene
from sandbox.level.assembly.build_world import build_world
from sandbox.level.checks import CheckDef
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import NissenMaterial, ParticleDef
from sandbox.level.kinds.rope import RopeDef
from sandbox.level.reading.parse import parse_level
from tests.support.zoo import zoo

STEEL = NissenMaterial(stiffness=0.2, damping=0.3)


def body(kind):
    return Item("body", kind)


def chosen(*ids):
    level = zoo()
    return Document(level, frozenset(item for item in items_of(level) if item.key in ids))


def rope(segments=6, **more):
    return RopeDef(type="rope", id="rope", start=(0.0, 0.0), end=(6.0, 0.0), segments=segments, **more)


def names_of(level):
    scene = make_scene(level)
    return {scene.names(slot) for slot in range(len(scene.mass))}


def test_ids_are_made_free_by_a_number():
    level = zoo()
    assert [free_id(level, name) for name in ("new", "rope", "hook", "hook 2")] == ["new", "rope 2", "hook 3", "hook 3"]
    document = add_body(Document(level), rope())
    assert document.level.bodies[-1].id == "rope 2"
    assert document.selection == {body("rope 2")}


def test_a_body_that_could_not_be_saved_is_refused_before_it_is_made():
    with pytest.raises(EditError, match='"rope": segments: brings the level above 100,000 particles'):
        add_body(Document(empty_level()), rope(10**9))
    with pytest.raises(EditError, match='there is no material "gold"'):
        add_body(Document(empty_level()), rope(material="gold"))


def test_a_spring_joins_two_particles_by_name():
    document = add_spring(chosen(), "hook", "rope.3", "steel", 1.25)
    world = build_world(document.level)
    slot = world.spring_slot(":4")
    assert world.rest_length[slot] == 1.25
    assert {world.particle_a[slot], world.particle_b[slot]} == {
        world.particle_slot("hook"),
        world.particle_slot("rope.3"),
    }
    assert document.selection == {Item("spring", 4)}
    with pytest.raises(EditError, match="there is no body or particle"):
        add_spring(chosen(), "hook", "nobody")
    with pytest.raises(EditError, match="joins"):
        add_spring(chosen(), "rope.end", "rope.6")


def test_a_weld_makes_one_of_two_particles_and_can_be_undone():
    document = weld(Document(zoo()), "hook", "ball.0")
    world = build_world(document.level)
    assert world.particle_slot("hook") == world.particle_slot("ball.0")
    with pytest.raises(EditError, match="one particle already"):
        weld(document, "ball.0", "hook")
    apart = build_world(unweld(document, "ball.0").level)
    assert apart.particle_slot("hook") != apart.particle_slot("ball.0")
    with pytest.raises(EditError, match="welded to nothing"):
        unweld(Document(zoo()), "hook")
    with pytest.raises(EditError, match="both ends"):
        weld(Document(zoo()), "rope.0", "rope.1")


def test_pins_use_the_names_of_ends_where_they_say_the_same():
    document = set_pinned(chosen(), ["rope.5", "rope.start", "hook 2"], True)
    assert (document.level.bodies[0].pin, document.level.bodies[0].pinned) == (("start",), (3, 5))
    assert document.level.particles[2].pinned
    document = set_pinned(document, ["rope.0", "rope.3"], False)
    assert (document.level.bodies[0].pin, document.level.bodies[0].pinned) == ((), (5,))
    # Of the two particles that an end of a bridge holds, the other stays.
    deck = set_pinned(chosen(), ["deck.5"], False).level.bodies[1]
    assert (deck.pin, deck.pinned) == (("end",), (0, 7))


def test_letting_go_of_a_welded_particle_lets_go_of_all_it_is_welded_to():
    level = set_pinned(chosen(), ["beam.start"], False).level
    assert not make_scene(level).pinned[make_scene(level).slot("deck.4")]


def test_cutting_leaves_the_other_springs_their_names():
    document = without_springs(Document(zoo(), frozenset([Item("spring", 3)])), {"rope": {0}}, {1})
    world = build_world(document.level)
    assert "rope:0" not in world.spring_names
    assert "rope:5" in world.spring_names
    assert len(document.level.springs) == 3
    assert document.selection == {Item("spring", 2)}


def test_deleting_takes_along_what_hangs_on_it():
    level = delete(chosen("rope", "hook")).level
    assert "rope" not in names_of(level)
    assert [spring.a for spring in level.springs] == ["weight", "net.1"]
    assert [pair for pair in level.welds] == [("beam.start", "deck.4"), ("web.centre", "hook 2")]
    assert [check.name for check in level.checks] == ["tight"]


def test_a_body_broken_apart_is_the_same_world_by_other_names():
    before = chosen("net", "cube")
    after = break_apart(before)
    old, new = build_world(before.level), build_world(after.level)
    for name in ("net.0", "net.2", "cube.3", "rope.end"):
        other = name if name.startswith("rope") else name.replace(".", " ")
        a, b = old.particle_slot(name), new.particle_slot(other)
        assert np.array_equal(old.position[a], new.position[b])
        assert np.array_equal(old.velocity[a], new.velocity[b])
        assert (old.mass[a], old.inverse_mass[a]) == (new.mass[b], new.inverse_mass[b])
    assert np.allclose(np.sort(old.rest_length), np.sort(new.rest_length), rtol=1e-12)
    assert after.level.springs[2].a == "net 1"
    cube = with_groups(after.level, frozenset([Item("particle", "cube 1")]))
    net = with_groups(after.level, frozenset([Item("particle", "net 1")]))
    assert (cube | net, cube & net) == (after.selection, frozenset())
    with pytest.raises(EditError, match="select a body"):
        break_apart(chosen("hook"))


def test_bodies_broken_apart_that_are_named_as_their_particles_keep_their_springs():
    level = zoo()
    cube = next(body for body in level.bodies if body.id == "cube")
    other = cube.model_copy(update={"id": "cube 1", "position": (9.0, 9.0)})
    level = level.model_copy(update={"bodies": (*level.bodies, other)})
    before = Document(level, frozenset({body("cube"), body("cube 1")}))
    after = break_apart(before)
    assert len(build_world(after.level).rest_length) == len(build_world(level).rest_length)
    assert after.selection <= set(items_of(after.level))


def test_what_is_broken_apart_falls_and_swings_as_before():
    after = break_apart(chosen("ball", "wheel")).level
    assert {spring.drive for spring in after.springs if spring.group == "ball"} == {zoo().bodies[7].drive}
    assert {particle.gravity_scale for particle in after.particles if particle.group == "wheel"} == {0.5}


def test_what_is_too_large_for_a_file_is_not_broken_apart(monkeypatch):
    monkeypatch.setattr("sandbox.editor.document.FILE_LIMIT", 10_000)
    monkeypatch.setattr("sandbox.editor.document.MEASURED_SIZE", 50)
    with pytest.raises(EditError, match="would be larger than"):
        break_apart(chosen("cube", "ball"))


def test_a_fragment_holds_what_is_selected_with_the_joints_inside():
    found = parse_level(copy_text(chosen("rope", "weight", "hook", "hook 2")).encode(), "copy")
    assert [part.id for part in (*found.bodies, *found.particles)] == ["rope", "weight", "hook", "hook 2"]
    assert [(spring.a, spring.b) for spring in found.springs] == [("hook", "hook 2")]
    assert found.welds == (("rope.end", "weight"),)
    assert list(found.materials) == ["steel"]


def test_a_pasted_fragment_gets_ids_and_groups_of_its_own_and_its_references_follow():
    source = chosen("rope", "weight", "deck")
    text = copy_text(source)
    document = paste(source, text, (100.0, 0.0))
    level = document.level
    assert [part.id for part in level.bodies[-2:]] == ["rope 2", "deck 2"]
    assert level.particles[-1].id == "weight 2"
    assert (level.springs[-1].a, level.springs[-1].b) == ("weight 2", "deck 2.end")
    assert level.welds[-1] == ("rope 2.end", "weight 2")
    assert level.bodies[-1].group == level.particles[-1].group == "crossing 2"
    box = make_scene(level).bounds(document.selection)
    assert math.isclose((box[0] + box[2]) / 2, 100.0)
    assert len(document.selection) == 4


def test_materials_are_shared_where_they_are_equal_and_renamed_where_not():
    text = copy_text(chosen("rope"))
    same = paste(Document(zoo()), text)
    assert list(same.level.materials) == list(zoo().materials)
    other = set_material(Document(zoo()), "steel", NissenMaterial(stiffness=0.9))
    once = paste(other, text)
    twice = paste(once, text)
    assert [part.material for part in twice.level.bodies[-2:]] == ["steel 2", "steel 2"]
    assert twice.level.materials["steel 2"] == STEEL
    plain = copy_text(chosen("deck"))
    stiff = add_material(Document(empty_level()), "default", NissenMaterial(stiffness=1.0))
    assert paste(stiff, plain).level.bodies[0].material == "default 2"
    assert paste(Document(empty_level()), plain).level.bodies[0].material == "default"


def test_a_whole_level_can_be_pasted_into_an_empty_one():
    level = paste(Document(empty_level()), level_text(zoo())).level
    assert (level.particles, level.welds) == (zoo().particles, zoo().welds)
    assert [body.material for body in level.bodies[:2]] == ["steel 2", "default"]
    with pytest.raises(EditError, match="not JSON"):
        paste(Document(level), "hello")


def test_arrays_stand_in_a_row_and_in_a_circle():
    document = add_particle(Document(empty_level()), ParticleDef(id="p", position=(1.0, 0.0)))
    line = array_line(document, 3, 2.0, 0.5)
    assert [particle.position for particle in line.level.particles] == [(1.0, 0.0), (3.0, 0.5), (5.0, 1.0)]
    assert len(line.selection) == 3
    circle = array_circle(document, 4, (0.0, 0.0), math.pi / 2).level
    assert [particle.position for particle in circle.particles] == [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    with pytest.raises(EditError, match="above 100,000 particles; make fewer"):
        array_line(document, 10**9, 1.0, 0.0)
    assert duplicate(document, 0.0, 1.0).level.particles[1].id == "p 2"


def test_a_rope_of_other_segments_keeps_its_pins_cuts_and_references_at_the_nearest_particles():
    document = add_body(Document(empty_level()), rope(6, rest_length=1.2, pin=("end",), pinned=(3,), cut=(1,)))
    document = add_particle(document, ParticleDef(id="p", position=(2.0, -1.0)))
    document = add_spring(document, "p", "rope.2")
    document = add_spring(document, "p", "rope.end")
    finer = set_field(document, [body("rope")], "segments", 12).level
    made = finer.bodies[0]
    assert (made.rest_length, made.pin, made.pinned) == (0.6, ("end",), (6,))
    assert made.cut[0] in (2, 3)
    assert [spring.b for spring in finer.springs] == ["rope.4", "rope.end"]
    with pytest.raises(EditError, match=r"rope.*segments: 0 is below the limit 1"):
        set_field(document, [body("rope")], "segments", 0)


def test_a_sagging_rope_still_sags_with_other_segments():
    sag = tuple((float(k), -0.25 * k * (6 - k)) for k in range(7))
    document = add_body(Document(empty_level()), rope(6, pose=sag))
    pose = set_field(document, [body("rope")], "segments", 12).level.bodies[0].pose
    assert len(pose) == 13
    assert np.allclose(pose[::2], sag)
    assert np.allclose([y for _, y in pose], [-0.25 * x * (6 - x) for x in np.arange(13) / 2], atol=0.15)


def test_corners_stay_corners_when_a_jelly_gets_another_size_and_spacing():
    document = chosen()
    larger = set_field(document, [body("cube")], "shape", {"box": [2.0, 1.5]}).level
    finer = set_field(document, [body("cube")], "spacing", 0.125).level
    for level in (larger, finer):
        scene = make_scene(level)
        assert scene.pinned[scene.slot("cube.0")]
        assert level.bodies[5].pinned == (0,)


def test_a_field_is_set_for_many_at_once_and_the_same_value_is_no_change():
    document = chosen("hook", "hook 2", "weight")
    level = set_field(document, document.selection, "mass", 3).level
    assert [particle.mass for particle in level.particles] == [3.0, 3.0, 3.0]
    assert set_field(Document(level), document.selection, "mass", 3.0).level is level
    with pytest.raises(EditError, match='"hook": mass: -1 is below the limit 1e-09'):
        set_field(document, [Item("particle", "hook")], "mass", -1)
    with pytest.raises(EditError, match='"hook": mass: "heavy" is text'):
        set_field(document, [Item("particle", "hook")], "mass", "heavy")
    with pytest.raises(EditError, match="has no segments"):
        set_field(document, document.selection, "segments", 3)


def test_renaming_follows_into_springs_welds_and_checks():
    document = rename(chosen("rope"), body("rope"), "cable")
    assert document.selection == {body("cable")}
    assert document.level.welds[0] == ("cable.end", "weight")
    assert document.level.checks[0].particle == "cable.end"
    renamed = rename(document, Item("particle", "hook"), "nail").level
    assert [spring.a for spring in renamed.springs] == ["nail", "weight", "net.1", "nail"]
    for name, words in (("deck", "is taken"), ("a.b", "an id may not"), ("", "is empty")):
        with pytest.raises(EditError, match=words):
            rename(document, body("cable"), name)


def test_settings_and_the_fields_of_the_level_are_read_as_a_file_is():
    document = Document(zoo())
    assert set_setting(document, "gravity", [0, -1.62]).level.settings.gravity == (0.0, -1.62)
    assert set_level_field(document, "view", [0, 0, 4, 3]).level.view == (0.0, 0.0, 4.0, 3.0)
    with pytest.raises(EditError, match=r"substeps: 3: substeps are a power of two"):
        set_setting(document, "substeps", 3)
    with pytest.raises(EditError, match="view: left and bottom come first"):
        set_level_field(document, "view", [4, 0, 0, 3])


def test_materials_are_added_renamed_and_deleted_only_where_nobody_uses_them():
    document = Document(zoo())
    assert "gold" in add_material(document, "gold", STEEL).level.materials
    renamed = rename_material(document, "steel", "iron").level
    assert list(renamed.materials) == ["iron", "wire", "unused"]
    assert (renamed.bodies[0].material, renamed.springs[0].material) == ("iron", "iron")
    assert "unused" not in delete_material(document, "unused").level.materials
    with pytest.raises(EditError, match='"steel" is used by "rope", the spring :0; give them another first'):
        delete_material(document, "steel")
    with pytest.raises(EditError, match="already"):
        rename_material(document, "steel", "wire")
    with pytest.raises(EditError, match=r"1\.5 is above the limit 1"):
        set_material(document, "steel", NissenMaterial.model_construct(stiffness=1.5, damping=0.0))


def test_assigning_gives_bodies_and_springs_a_material():
    document = Document(zoo(), frozenset([body("deck"), Item("spring", 1), Item("particle", "hook")]))
    level = assign(document, "wire").level
    assert (level.bodies[1].material, level.springs[1].material) == ("wire", "wire")
    with pytest.raises(EditError, match="select a body or a spring"):
        assign(chosen("hook"), "wire")


def test_checks_are_held_against_the_level():
    check = CheckDef(name="low", metric="y", particle="hook", at_most=1.0)
    assert set_checks(Document(zoo()), [check]).level.checks == (check,)
    with pytest.raises(EditError, match='"low": particle: there is no body or particle "nobody"'):
        set_checks(Document(zoo()), [check.model_copy(update={"particle": "nobody"})])


def test_groups_are_selected_whole():
    document = chosen("rope", "hook")
    grouped = group(document)
    assert with_groups(grouped.level, frozenset([body("rope")])) == document.selection
    assert ungroup(grouped).level.bodies[0].group is None
    assert ungroup(chosen("rope")).level == zoo()
    assert len(with_groups(zoo(), frozenset([body("deck")]))) == 4


def test_the_order_of_drawing_is_that_of_the_file():
    def order(to, *ids):
        return [part.id for part in reorder(chosen(*ids), to).level.bodies][:4]

    assert order("back", "beam") == ["beam", "rope", "deck", "web"]
    assert order("forward", "rope") == ["deck", "rope", "beam", "web"]
    assert order("backward", "deck", "beam") == ["deck", "beam", "rope", "web"]
    assert reorder(chosen("rope"), "front").level.bodies[-1].id == "rope"
    springs = reorder(Document(zoo(), frozenset([Item("spring", 0)])), "front")
    assert springs.selection == {Item("spring", 3)}
    assert springs.level.springs[3] == zoo().springs[0]


def test_a_bridge_that_is_turned_keeps_its_shape_by_its_pose():
    document = rotate(chosen("deck"), math.pi / 2, (0.0, 0.0))
    assert document.level.bodies[1].pose is not None
    finer = set_field(document, [body("deck")], "segments", 8).level
    turned, plain = make_scene(finer), make_scene(set_field(chosen(), [body("deck")], "segments", 8).level)
    mine = plain.particles_of(frozenset([body("deck")]))
    x, y = plain.position[mine].T
    assert np.allclose(turned.position[mine], np.stack([-y, x], axis=1), atol=1e-9)


def test_a_pose_that_a_field_takes_out_of_the_world_is_refused():
    document = add_body(Document(empty_level()), rope(1, pose=((0.0, 0.0), (20.0, 0.0))))
    with pytest.raises(EditError, match='"rope" would lie beyond the limit 1000000'):
        set_field(document, [body("rope")], "end", [999_990.0, 0.0])


def test_a_rest_length_beyond_the_limit_is_not_left_to_a_loose_spring():
    long = RopeDef(type="rope", id="r", start=(-1e6, 0.0), end=(1e6, 0.0), segments=1, pose=((0.0, 0.0), (1.0, 0.0)))
    with pytest.raises(EditError, match="too long"):
        break_apart(add_body(Document(empty_level()), long))


@pytest.mark.parametrize("name", ["", "a.b", "x" * 500])
def test_a_name_that_cannot_be_is_refused_with_the_old_name_and_the_reason(name):
    document = Document(zoo())
    body = document.level.bodies[0].id
    with pytest.raises(EditError, match=f'^"{body}" cannot be called .*: the name '):
        rename(document, Item("body", body), name)
