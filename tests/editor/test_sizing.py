"""Parts made larger: the same thing in other measures, driven along, or one line where no file could say it."""

import numpy as np
import pytest

from sandbox.editor.document import EditError
from sandbox.editor.edits.joining import sized
from sandbox.level.document.model import SpringDef
from sandbox.level.format.quantities import replaced
from sandbox.session.commands import SetDrive
from sandbox.session.session import Session
from tests.editor.test_joining import BAR, SHIPPED, join, part
from tests.support.parts import BODIES, SKIN, room

# All but the swing, which has a velocity from the start.
SHOWN = ("balloon", "brick_tower", "car", "catapult", "jelly_friend", "tower", "trampoline", "walker")
HOOKED = part(
    materials={"skin": {"law": "hooke", "k": 300, "c": 3}}, bodies=[BAR, *(BODIES[kind] | {"id": kind, "position":
    [x, 3]} for x, kind in ((-3, "wheel"), (0, "ring"), (3, "jelly")))],
    particles=[{"id": "knot", "position": [0.5, 1], "mass": 3}, {"id": "ball", "position": [3, 0], "radius": 0.3}],
    springs=[
        {"a": "bar.0", "b": "knot", "material": "skin", "rest_length": 0.8},
        {"a": "bar.1", "b": "knot", "hydraulic": {"shortest": 0.5, "longest": 1.5, "rate": 0.5}},
    ],
)  # fmt: skip


def run(level, larger, ticks):
    """Where a part comes to [m] in a room, and in gravity, that is so many times as large; and its mass [kg]."""
    wide = {"box": [-15 * larger, 0, 15 * larger, 20 * larger]}
    session = Session(room(walls=wide, settings={"gravity": [0.0, -9.81 * larger]}))
    join(session, level, (0.0, 0.5 * larger))
    for _ in range(ticks):
        session.advance()
    world = session.world
    assert not session.messages
    return world.position[world.particle_active], world.mass[world.particle_active].sum()


@pytest.mark.parametrize("larger", [0.5, 3.0])
def test_in_gravity_as_much_larger_a_part_does_the_same_in_larger_measures(larger):
    for name, level in [*((name, SHIPPED[name]) for name in SHOWN), ("hooked", HOOKED)]:
        (kept, mass), (made, heavier) = run(level, 1.0, 40), run(sized(level, larger), larger, 40)
        # Bricks that touch part by more than rounding, and what is slow is so at one speed in all sizes.
        assert made / larger == pytest.approx(kept, abs=1e-2), name
        assert heavier == pytest.approx(larger**2 * mass), name
        assert np.ptp(made, axis=0).max() > 0.0


def speed_of_car(larger):
    """How fast [m/s] the car goes after some seconds of full drive, as many more as it is larger."""
    session = Session(room(walls={"box": [-190, 0, 190, 20]}))
    join(session, sized(SHIPPED["car"], larger), (-90.0, 0.2 * larger))
    for drive in range(len(session.world.actuators.names)):
        session.submit(SetDrive(drive, 1.0))
    for _ in range(round(180 * larger)):
        session.advance()
    world = session.world
    return abs(np.average(world.velocity[world.particle_active, 0], weights=world.mass[world.particle_active]))


def test_a_car_of_another_size_drives_as_fast_for_its_length():
    kept = speed_of_car(1.0)
    assert kept > 1.0
    for larger in (0.5, 3.0):
        assert speed_of_car(larger) == pytest.approx(larger * kept, rel=0.08)


def test_masses_forces_and_rates_follow_its_lengths():
    lift = {"a": "knot", "b": "ball", "hydraulic": {"shortest": 0.5, "longest": 1.5, "rate": 0.5, "force": 200}}
    made = sized(replaced(HOOKED, springs=(*HOOKED.springs[:1], SpringDef.model_validate(lift))), 2.0)
    hydraulic = made.springs[1].hydraulic
    assert (hydraulic.shortest, hydraulic.longest, hydraulic.rate, hydraulic.force) == (1.0, 3.0, 1.0, 800.0)
    assert made.springs[0].rest_length == 1.6 and (made.materials["skin"].k, made.materials["skin"].c) == (1200.0, 12.0)
    assert made.bodies[0].masses == (4.0, 4.0) and made.bodies[0].particle_radius == 0.1
    assert made.particles[0].mass == 12.0 and made.particles[1].radius == 0.6
    torque = [sized(SHIPPED["car"], larger).bodies[1].motor.torque for larger in (1.0, 2.0)]
    assert torque[1] == 8.0 * torque[0]


def test_a_part_of_its_own_size_is_itself_and_one_beyond_a_limit_is_refused_in_a_line():
    assert sized(HOOKED, 1.0) is HOOKED
    heavy = part(materials=SKIN, bodies=[BAR | {"masses": [1e6, 1e6]}])
    with pytest.raises(EditError, match="masses") as refused:
        sized(heavy, 1e4)
    assert "\n" not in str(refused.value)
