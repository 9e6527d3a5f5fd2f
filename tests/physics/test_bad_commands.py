"""What is not there or makes no sense raises, in words that name it, and changes no byte of a world."""

import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from sandbox.physics.commands.command import BAD, PROGRAM, REASONS, command
from sandbox.physics.commands.command_table import KINDS
from sandbox.physics.constraints import AREA, BEND
from sandbox.physics.driving import Actuators
from sandbox.physics.kits.removing import remove_particles
from sandbox.physics.softness.firmness import set_firmness
from sandbox.physics.state import Family
from sandbox.physics.step import step
from tests.support import bad_commands
from tests.support.bad_commands import CALLS, INF, NAN, call, made, outcome, wrong_calls

ROOT = Path(__file__).resolve().parents[2]
ARGUMENTS = {
    "grab": ("grab", "particle", "target", "strength", "radius"),
    "move_grab": ("grab", "target"),
    "release": ("grab",),
    "pin": ("particle",),
    "unpin": ("particle",),
    "cut_springs": ("springs",),
    "break_springs": ("springs",),
    "part_bodies": ("springs",),
    "set_coefficients": ("stiffness", "damping", "material", "duration"),
    "set_gravity": ("gravity", "duration"),
    "set_air": ("wind", "drag", "duration"),
    "set_drive": ("part", "value"),
    "set_firmness": ("body", "sag", "duration"),
    "soften": ("body", "value", "gravity", "duration"),
    "hold_key": ("key",),
    "push": ("position", "impulse", "outward", "radius"),
    "shake": ("acceleration",),
    "set_inflation": ("body", "value", "duration"),
    "scale_mass": ("particle", "factor"),
    "move_body": ("particle", "by"),
    "free": ("particle",),
    "set_solver": ("solver", "iterations", "substeps", "warm_start", "duration"),
}
# Other methods that change a world, or ask it: the call, and what its fault begins with.
OTHERS = {
    "change, no such array": (lambda world: world.change("places", 0.0), "name 'places': there is no such array"),
    "change, beyond": (lambda world: world.change("mass", 1.0, 14), "slots 14: a world with rows 0 to 13"),
    "change, below 0": (lambda world: world.change("mass", 1.0, [0, -1]), "slots -1: "),
    "change, short flags": (lambda world: world.change("mass", 1.0, np.ones(3, np.bool_)), "slots "),
    "change, of another shape": (lambda world: world.change("mass", [1.0, 2.0], [0, 1, 2]), "values of mass of"),
    "append, no such array": (lambda world: world.append(Family.SPRING, 1, mass=1.0), "springs have no mass"),
    "append, NaN": (lambda world: world.append(Family.PARTICLE, 1, mass=1.0, velocity=[[0, NAN]]), "velocity nan: "),
    "append, shape": (lambda world: world.append(Family.PARTICLE, 2, mass=[1.0] * 3), "mass of shape (3,)"),
    "append, no mass": (lambda world: world.append(Family.PARTICLE, 1), "mass 0.0: "),
    "append, no ends": (lambda world: world.append(Family.SPRING, 1), "particle_a, particle_b 0: "),
    "append, hands": (lambda world: world.append(Family.HAND, 1), "family <Family.HAND"),
    "disturb": (lambda world: world.disturb(np.array([0]), -1), "particles -1: "),
    "name a particle": (lambda world: world.name_particle(14, "second"), "slot 14: "),
    "add particles, position": (lambda world: world.add_particles(["e"], [[0, NAN]]), "position nan: "),
    "add particles, rows": (lambda world: world.add_particles(["e"], [[0, 1], [2, 3]]), "position of shape (2, 2)"),
    "add particles, text": (lambda world: world.add_particles(["e"], [["0", "1"]]), "position [['0', '1']]: "),
    "add particles, radius": (lambda world: world.add_particles(["e"], [[0, 1]], radius=-1.0), "radius -1.0: "),
    "add particles, radii": (lambda world: world.add_particles(["e"], [[0, 1]], radius=[1, 2]), "radius of shape (2,)"),
    "add particles, mass": (lambda world: world.add_particles(["e"], [[0, 1]], mass=INF), "mass inf: "),
    "add particles, pinned": (lambda world: world.add_particles(["e"], [[0, 1]], pinned="no"), "pinned 'no': "),
    "add particles, another": (lambda world: world.add_particles(["e"], [[0, 1]], law=1), "particles have no law"),
    "add particles, owner": (lambda world: world.add_particles(["e"], [[0, 1]], owner=0.5), "owner 0.5: "),
    "add springs, beyond": (lambda world: world.add_springs(["v"], [0], [14]), "particle_b 14: "),
    "add springs, no slot": (lambda world: world.add_springs(["v"], [0.5], [1]), "particle_a 0.5: "),
    "add springs, too few": (lambda world: world.add_springs(["v", "w"], [0], [1]), "2 names"),
    "add springs, rest": (lambda world: world.add_springs(["v"], [0], [1], rest_length=INF), "rest_length inf: "),
    "add springs, stiffness": (lambda world: world.add_springs(["v"], [0], [1], stiffness=NAN), "stiffness nan: "),
    "add springs, stiff": (lambda world: world.add_springs(["v"], [0], [1], stiffness=5.0), "stiffness 5.0: a number"),
    "add particles, far": (lambda world: world.add_particles(["e"], [[0, -1e19]]), "position -1e+19: a number from -1"),
    "add particles, lively": (lambda world: world.add_particles(["e"], [[0, 1]], restitution=1.5), "restitution 1.5: "),
    "add springs, dampings": (lambda world: world.add_springs(["v"], [0], [1], damping=[0, 1]), "damping of shape"),
    "add springs, material": (lambda world: world.add_springs(["v"], [0], [1], material=1), "material 1: "),
    "add an area, beyond": (lambda world: world.add_constraints(AREA, [[0, 1, 14]]), "corners 14: "),
    "add an area, no rows": (lambda world: world.add_constraints(AREA, [0, 1, 2]), "corners "),
    "add an area, inflation": (lambda world: world.add_constraints(AREA, [[0, 1, 2]], inflation=NAN), "inflation nan"),
    "add an area, form": (lambda world: world.add_constraints(AREA, [[0, 1, 2]], form=[[0, 1, 2]]), "form of shape"),
    "add a bend, stiffness": (lambda world: world.add_constraints(BEND, [[0, 1, 2]], stiffness=INF), "constraint_"),
    "add a bend, material": (lambda world: world.add_constraints(BEND, [[0, 1, 2]], material=7), "constraint_"),
    "name areas": (lambda world: world.name_areas("balloon", range(1, 2)), "constraints 1: "),
    "inflate": (lambda world: bad_commands.inflate(world, 9, 1.0), "body 9: there is none"),
    "fit, too many": (lambda world: world.fit(Actuators(("a",)), [0.0, 0.0]), "values of 2 parts"),
    "fit, too fast": (lambda world: world.fit(Actuators(("a",)), [2.0]), "values 2.0: "),
    "is held": (lambda world: world.is_held(10), "grab 10: a world with hands 0 to 9"),
    "forget names": (lambda world: world.forget_names_beyond(-1, 0), "particle_count -1: "),
    "move a body, removed": (lambda world: bad_commands.move_body(world, 3, (1.0, 0.0)), "particle 3: it is not"),
    "move a body, NaN": (lambda world: bad_commands.move_body(world, 0, (NAN, 0.0)), "by nan: "),
    "move a body, short": (lambda world: bad_commands.move_body(world, 0, (1.0,)), "by (1.0,): "),
    "remove": (lambda world: remove_particles(world, np.array([0, 14])), "particles 14: "),
    "firmness": (lambda world: set_firmness(world, 9, 0.5, 0.5), "body 9: there is none"),
}  # fmt: skip


@pytest.mark.parametrize("has_hands", [True, False])
@pytest.mark.parametrize("kind", CALLS)
def test_a_wrong_argument_of_any_command_raises_and_changes_no_byte(kind, has_hands):
    world, seen = made(has_hands), Counter()
    for label, act in wrong_calls(kind):
        text = outcome(world, act)
        name = ARGUMENTS[kind][int(label.split()[1].rstrip(":"))]
        assert text.partition(": ")[2].startswith(f"{name} "), f"{label}: {text}"
        assert text.startswith(("IndexError", "ValueError")) and "changed" not in text, f"{label}: {text}"
        seen[name] += 1
    assert all(seen[name] >= 8 for name in ARGUMENTS[kind])
    # It is as good as new.
    method, right, _ = CALLS[kind]
    if has_hands or kind not in ("move_grab", "release"):
        call(world, method, right)
    step(world)
    assert np.isfinite(world.position).all()


def test_the_words_name_the_argument_the_value_and_the_range():
    world = made(has_hands=False)
    for act, text in (
        (lambda: world.pin(99), "particle 99: a world with particles 0 to 3"),
        (lambda: world.pin(3), "particle 3: it is not in use, or a hand's"),
        (lambda: world.hold(10, 0, (0.0, 0.0)), "grab 10: a world with hands 0 to 9"),
        (lambda: world.release(0), "grab 0: a world without hands"),
        (lambda: world.cut([0, 50]), "springs 50: a world with springs 0 to 2"),
        (lambda: world.drive(1, 0.0), "part 1: a world with driven parts 0 to 0"),
        (lambda: world.drive(0, 2.0), "value 2.0: a number from -1 to 1 is needed"),
        (lambda: world.hold(0, 0, (0.0, NAN)), "target nan: a number from -1e+18 to 1e+18 is needed"),
    ):
        with pytest.raises((IndexError, ValueError)) as raised:
            act()
        assert str(raised.value) == text


def test_interpreted_kernels_say_the_same_of_each():
    environment = {**os.environ, "SANDBOX_KERNELS": "interpreted"}
    ended = subprocess.run(
        [sys.executable, "-m", bad_commands.__name__], env=environment, cwd=ROOT, capture_output=True, check=True
    )
    told = json.loads(ended.stdout)
    assert told == {"way": "interpreted", "outcomes": bad_commands.outcomes()}


def test_a_number_that_is_not_finite_is_refused_by_the_kernel_itself():
    world, arena = made(), np.zeros(1, np.int64)
    slots, before = np.array([4]), bad_commands.memory_of(world)
    result = command(world.lent, arena, PROGRAM, KINDS["shake"].code, slots, np.array([NAN, 0.0, 60.0]))
    assert result == -(BAD + REASONS * len(slots)) and bad_commands.memory_of(world) == before


@pytest.mark.parametrize("name", OTHERS)
def test_other_methods_raise_and_change_no_byte_too(name):
    act, begins = OTHERS[name]
    text = outcome(made(), act)
    assert text.startswith(("IndexError: ", "ValueError: ")) and "changed" not in text
    assert text.partition(": ")[2].startswith(begins)
