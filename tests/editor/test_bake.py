"""What is kept of a played world: the level then builds the world as it was when it was kept."""

import numpy as np
import pytest

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.bake import keep_coefficients, keep_cuts, keep_pins, keep_pose
from sandbox.editor.edits.fields import set_setting
from sandbox.editor.edits.placing import add_particle
from sandbox.editor.items import Item
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import NissenMaterial, ParticleDef
from sandbox.level.kinds.body_def import FirmnessDef
from sandbox.level.reading.parse import parse_level
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.firmness import FirmnessRange, set_firmness
from sandbox.physics.step import step
from tests.support.wobbles import firm_level
from tests.support.zoo import zoo


def calm():
    """The zoo with the solver that bears everything in it."""
    return set_setting(Document(zoo()), "solver", "direct")


def played(document, ticks=20):
    world = build_world(document.level)
    for _ in range(ticks):
        step(world)
    return world


def test_a_kept_pose_is_where_the_world_was_and_every_rest_length_stays():
    document = calm()
    world = played(document)
    again = build_world(keep_pose(document, world).level)
    assert np.array_equal(again.position, world.position)
    # What muscles have added for the moment is not kept.
    assert np.allclose(again.rest_length, build_world(document.level).rest_length, rtol=1e-12)
    assert again.particle_names == world.particle_names
    assert again.spring_names == world.spring_names


def test_what_did_not_move_gets_no_pose():
    document = calm()
    assert keep_pose(document, build_world(document.level)) is document
    kept = keep_pose(document, played(document)).level
    assert kept.particles[1] is document.level.particles[1]


def test_springs_as_placed_get_the_rest_length_that_they_had():
    document = calm()
    world = played(document)
    kept = keep_pose(document, world).level
    assert document.level.springs[2].rest_length is None
    assert kept.springs[2].rest_length == world.rest_length[world.spring_slot(":2")]


def test_a_world_that_has_flown_apart_is_not_kept():
    document = Document(zoo())
    for place in (np.nan, 1e9):
        world = build_world(document.level)
        world.position[3] = place
        with pytest.raises(EditError, match="flown out"):
            keep_pose(document, world)


def test_a_world_of_another_level_is_not_kept():
    document = Document(zoo())
    other = add_particle(document, ParticleDef(id="new"))
    for keep in (keep_pose, keep_cuts, keep_pins, keep_coefficients):
        with pytest.raises(EditError, match="not the level as it is now"):
            keep(other, build_world(document.level))


def test_coefficients_are_kept_by_material():
    document = calm()
    world = build_world(document.level)
    world.set_coefficients(0.75, None, world.material_names.index("steel"))
    world.set_coefficients(None, 0.25, world.material_names.index("default"))
    level = keep_coefficients(document, world).level
    assert level.materials["steel"] == NissenMaterial(stiffness=0.75, damping=0.3)
    assert level.materials["default"] == NissenMaterial(stiffness=0.5, damping=0.25)
    assert level.materials["wire"] == document.level.materials["wire"]
    assert keep_coefficients(document, build_world(document.level)) is document


def test_firmness_is_kept_by_body_and_ends_where_cs_or_cd_ended_it():
    jelly = {"shape": {"box": [1, 1]}, "spacing": 0.25}
    document = Document(parse_level(firm_level({"sag": 0.1}, floor=True, **jelly), "firm"))
    world = build_world(document.level)
    assert keep_coefficients(document, world) is document
    reach = FirmnessRange.of(world.forms[0].shape, (0.0, -9.81), 60)
    set_firmness(world, 0, *reach.coefficients(Firmness(hz=4.0, ratio=0.4)))
    level = keep_coefficients(document, world).level
    assert level.bodies[0].firmness == FirmnessDef(hz=4.0, ratio=0.4)
    assert build_world(level).stiffness == pytest.approx(world.stiffness, rel=1e-5)
    world.set_coefficients(0.75, 0.8, 0)
    level = keep_coefficients(document, world).level
    assert level.bodies[0].firmness is None
    assert level.materials["default"] == NissenMaterial(stiffness=0.75, damping=0.8)


def test_cuts_are_kept_and_loose_springs_that_were_cut_are_gone():
    document = Document(zoo(), frozenset([Item("spring", 3)]))
    world = build_world(document.level)
    world.cut([world.spring_slot("rope:0"), world.spring_slot("web:4"), world.spring_slot(":1")])
    kept = keep_cuts(document, world)
    assert (kept.level.bodies[0].cut, kept.level.bodies[3].cut) == ((0, 4), (3, 4))
    assert len(kept.level.springs) == 3
    assert kept.selection == {Item("spring", 2)}
    for keep in (keep_coefficients, keep_pose, keep_pins):
        assert keep(kept, world).level.springs == kept.level.springs
    with pytest.raises(EditError, match="not the level as it is now"):
        keep_cuts(kept, world)


def test_pins_are_kept_also_of_welded_particles():
    document = Document(zoo())
    world = build_world(document.level)
    for name in ("rope.start", "beam.start", "hook"):
        world.unpin(world.particle_slot(name))
    for name in ("weight", "web.centre", "cube.1"):
        world.pin(world.particle_slot(name))
    kept = build_world(keep_pins(document, world).level)
    assert np.array_equal(kept.inverse_mass == 0.0, world.inverse_mass == 0.0)
    assert keep_pins(document, build_world(document.level)) is document
