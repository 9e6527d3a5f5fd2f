"""The numbers for other engines, tried in those that can be had: what swings there swings as here."""

import json
import math
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from sandbox.export.engines import MOST_STEPS, choose_body, engine_numbers
from sandbox.export.take_home import as_text, take_home
from sandbox.physics.analysis.energy import reduced_masses
from tests.support.springs_elsewhere import Swing, lattice, level_of_springs, swing, swing_here, weight
from tests.support.wants import skip_without

TICKS = 3000
# Cs and Cd: slow and soft, as much of both, quick and firm.
PAIRS = [(0.001, 0.01), (0.004, 0.004), (0.02, 0.05), (0.1, 0.12)]
SOLVER_NAMES = ["single_pass", "iterative", "direct"]
GRAVITY = (0.0, -9.81)


def constants(world, numbers):
    """k and c of every spring of the body, in its order, with ends and rest length."""
    body, line = choose_body(world), numbers.masses[0]
    for spring in body.springs.tolist():
        share = float(reduced_masses(world)[spring]) / line.reduced_mass
        ends = int(world.particle_a[spring]), int(world.particle_b[spring])
        yield *ends, float(world.rest_length[spring]), line.k * share, line.c * share


def in_pymunk(world, name="pymunk", ticks=TICKS):
    """How particle 1 swings in pymunk, with the numbers for an engine."""
    pymunk = pytest.importorskip("pymunk", reason="needs pymunk")
    numbers = engine_numbers(choose_body(world))[name]
    space = pymunk.Space()
    space.gravity, space.damping = GRAVITY, 1.0
    bodies = []
    for place, mass, inverse in zip(world.position, world.mass, world.inverse_mass, strict=True):
        body = pymunk.Body(float(mass), math.inf) if inverse else pymunk.Body(body_type=pymunk.Body.STATIC)
        body.position = tuple(map(float, place))
        space.add(body)
        bodies.append(body)
    for a, b, length, k, c in constants(world, numbers):
        space.add(pymunk.DampedSpring(bodies[a], bodies[b], (0, 0), (0, 0), length, k, c))
    heights = []
    for _ in range(ticks):
        for _ in range(numbers.steps):
            space.step(numbers.step)
        heights.append(bodies[1].position.y)
    return swing(heights, numbers.step * numbers.steps)


def in_box2d(world, ticks=TICKS):
    """The same in Box2D 3, by frequency and damping ratio."""
    b2 = pytest.importorskip("pyb2d3", reason="needs pyb2d3")
    numbers = engine_numbers(choose_body(world))["box2d"]
    space, bodies = b2.World(gravity=GRAVITY), []
    for place, mass, inverse in zip(world.position, world.mass, world.inverse_mass, strict=True):
        where = tuple(map(float, place))
        if inverse:
            body = space.create_dynamic_body(position=where, enable_sleep=False, fixed_rotation=True)
            body.create_shape(b2.shape_def(density=float(mass) / 0.0004), b2.box(0.01, 0.01))
        else:
            body = space.create_static_body(position=where)
        bodies.append(body)
    for a, b, length, _, _ in constants(world, numbers):
        space.create_distance_joint(
            bodies[a], bodies[b], length=length, enable_spring=True, hertz=numbers.frequency,
            damping_ratio=numbers.damping_ratio,
        )  # fmt: skip
    heights = []
    for _ in range(ticks):
        space.step(numbers.step * numbers.steps, numbers.steps)
        heights.append(float(bodies[1].position[1]))
    return swing(heights, numbers.step * numbers.steps)


RAPIER = """
import { createRequire } from 'node:module';
const R = createRequire(process.env.FOLDER + '/')('@dimforge/rapier2d-compat'), job = JSON.parse(process.env.JOB);
await R.init();
const world = new R.World({ x: 0, y: -9.81 });
world.timestep = job.tick;
world.numSolverIterations = job.steps;
const bodies = job.particles.map(([x, y, mass]) => world.createRigidBody(
  mass ? R.RigidBodyDesc.dynamic().setTranslation(x, y).setAdditionalMass(mass).lockRotations().setCanSleep(false)
    : R.RigidBodyDesc.fixed().setTranslation(x, y)));
const zero = { x: 0, y: 0 };
for (const [a, b, length, k, c] of job.springs)
  world.createImpulseJoint(R.JointData.spring(length, k, c, zero, zero), bodies[a], bodies[b], true);
const heights = [];
for (let tick = 0; tick < job.ticks; tick++) { world.step(); heights.push(bodies[1].translation().y); }
console.log(JSON.stringify(heights));
"""


def in_rapier(world, ticks=TICKS, name="rapier"):
    """The same in Rapier; `RAPIER_FOLDER` is where `npm install @dimforge/rapier2d-compat` was said."""
    folder = Path(os.environ.get("RAPIER_FOLDER", Path.cwd()))
    if shutil.which("node") is None or not (folder / "node_modules/@dimforge/rapier2d-compat").is_dir():
        skip_without("node with @dimforge/rapier2d-compat in RAPIER_FOLDER")
    numbers = engine_numbers(choose_body(world))[name]
    places = [
        (*map(float, place), float(mass) if inverse else 0.0)
        for place, mass, inverse in zip(world.position, world.mass, world.inverse_mass, strict=True)
    ]
    tick = numbers.step * numbers.steps
    job = {
        "tick": tick, "steps": numbers.steps, "ticks": ticks, "particles": places,
        "springs": list(constants(world, numbers)),
    }  # fmt: skip
    environment = {**os.environ, "FOLDER": str(folder), "JOB": json.dumps(job)}
    command = ["node", "--input-type=module", "-e", RAPIER]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return swing(json.loads(run.stdout), tick)


def is_near(found: Swing, wanted: Swing, start: float, period=0.02, kept=0.04):
    """Whether it sags and swings as wanted: the sag within 2 %."""
    assert found.rest - start == pytest.approx(wanted.rest - start, rel=0.02)
    assert found.period == pytest.approx(wanted.period, rel=period)
    assert found.kept == pytest.approx(wanted.kept, rel=kept)
    return True


@pytest.mark.parametrize("solver", SOLVER_NAMES)
@pytest.mark.parametrize("pair", PAIRS)
def test_a_weight_on_a_spring_swings_in_pymunk_step_by_step_as_here(pair, solver):
    here = swing_here(weight(*pair, solver), TICKS)
    assert is_near(in_pymunk(weight(*pair, solver)), here, -1.0, period=1e-4, kept=2e-3)


@pytest.mark.parametrize("pair", PAIRS)
def test_a_weight_on_a_spring_swings_in_box2d_as_here_but_for_what_the_text_says_of_quick_ones(pair):
    here = swing_here(weight(*pair), TICKS)
    # A period of 20 ticks comes out 2.4 % shorter.
    assert is_near(in_box2d(weight(*pair)), here, -1.0, period=0.02 if here.period > 20.5 / 60.0 else 0.04)
    assert "quicker" in as_text(take_home(weight(*pair)), "box2d")


@pytest.mark.parametrize("pair", PAIRS)
def test_a_weight_on_a_spring_swings_in_rapier_as_here_but_for_what_the_text_says_of_quick_ones(pair):
    here = swing_here(weight(*pair), TICKS)
    assert is_near(in_rapier(weight(*pair)), here, -1.0, period=0.02 if here.period > 20.5 / 60.0 else 0.04)
    assert "quicker" in as_text(take_home(weight(*pair)), "rapier")


@pytest.mark.parametrize("pair", PAIRS[:1] + PAIRS[2:])
def test_unitys_equation_which_is_that_of_rapier_in_one_step_swings_step_by_step_as_here(pair):
    here = swing_here(weight(*pair), TICKS)
    assert is_near(in_rapier(weight(*pair), name="unity"), here, -1.0, period=1e-3, kept=5e-3)


SOFT = [(0.02, 0.03), (0.1, 0.15), (0.4, 0.5)]


@pytest.mark.parametrize("pair", SOFT)
def test_a_soft_body_sags_and_bobs_in_pymunk_as_here(pair):
    here = swing_here(lattice(*pair), TICKS // 2)
    assert is_near(in_pymunk(lattice(*pair), ticks=TICKS // 2), here, 0.0, period=0.01, kept=0.1)


@pytest.mark.parametrize("engine", [in_box2d, in_rapier])
@pytest.mark.parametrize("pair", SOFT)
def test_a_soft_body_sags_and_bobs_in_box2d_and_rapier_as_here(pair, engine):
    here = swing_here(lattice(*pair), TICKS // 2)
    # The quickest, of 17 ticks, comes out 3.6 % shorter.
    period = 0.02 if here.period > 20.5 / 60.0 else 0.04
    assert is_near(engine(lattice(*pair), ticks=TICKS // 2), here, 0.0, period=period, kept=0.15)


def test_a_stiff_body_sags_in_box2d_as_here_and_in_rapier_half_as_much_again_as_the_text_says():
    here = swing_here(lattice(0.9, 0.95), TICKS // 2).rest
    assert in_box2d(lattice(0.9, 0.95), ticks=TICKS // 2).rest == pytest.approx(here, rel=0.02)
    assert 1.3 * here > in_rapier(lattice(0.9, 0.95), ticks=TICKS // 2).rest > 1.6 * here
    assert "half as much again" in as_text(take_home(lattice(0.9, 0.95)), "rapier")


def test_godots_spring_damps_in_every_second_of_16_iterations_and_with_an_eighth_of_c_as_pymunks_does():
    world = weight(0.02, 0.05)
    godot, pymunk = (engine_numbers(choose_body(world))[name] for name in ("godot", "pymunk"))
    (_, _, length, k, c) = next(iter(constants(world, godot)))
    y, v, heights = -1.0, 0.0, []
    for _ in range(TICKS):
        # godot_joints_2d.cpp, of one body on a fixed one: setup, pre_solve, and solve 16 times.
        v += (GRAVITY[1] - k / 2.0 * (y + length)) * godot.step
        fall, target = 1.0 - math.exp(-c * godot.step / 2.0), 0.0
        for _ in range(16):
            rate = v - target
            target = rate - rate * fall
            v -= rate * fall
        y += v * godot.step
        heights.append(y)
    assert is_near(swing(heights, godot.step), swing_here(weight(0.02, 0.05), TICKS), -1.0, period=1e-4, kept=2e-3)
    assert godot.masses[0].c == pytest.approx(pymunk.masses[0].c / 8.0)
    assert godot.damping_ratio == pytest.approx(pymunk.damping_ratio)


def test_an_engine_that_adds_springs_one_by_one_is_given_the_steps_that_keep_them_stable_and_rods_where_none_do():
    numbers = engine_numbers(choose_body(lattice(0.9, 0.95)))["pymunk"]
    (line,) = [line for line in numbers.masses if line.reduced_mass == 0.25]
    assert numbers.steps > 1 and line.k * numbers.step**2 / line.reduced_mass * 8.0 < 4.0
    heights = in_pymunk(lattice(0.9, 0.95), ticks=600)
    assert abs(heights.rest) < 0.01
    stiff = engine_numbers(choose_body(lattice(1.0, 1.0)))
    assert all(each.rigid and each.steps <= MOST_STEPS for each in stiff.values())
    assert "use rigid joints" in as_text(take_home(lattice(1.0, 1.0)), "pymunk")


def test_a_spring_with_cs_above_cd_has_the_least_damping_that_an_engine_can_give():
    found = engine_numbers(choose_body(weight(0.02, 0.01)))
    assert found["unity"].negative and found["unity"].damping_ratio == 0.0
    assert not found["pymunk"].negative and found["pymunk"].damping_ratio > 0.0
    assert "the least" in as_text(take_home(weight(0.02, 0.01)), "unity")


def test_hookes_springs_keep_their_own_k_and_c_in_pymunk():
    particles = [{"id": "pin", "pinned": True}, {"id": "weight", "position": [0, -1], "mass": 2.0}]
    springs = [{"a": "pin", "b": "weight", "material": "hooke"}]
    materials = {"m": {}, "hooke": {"law": "hooke", "k": 300.0, "c": 4.0}}
    world = level_of_springs(0.1, 0.1, particles=particles, springs=springs, materials=materials)
    (line,) = engine_numbers(choose_body(world))["pymunk"].masses
    assert (line.k, line.c) == pytest.approx((300.0, 4.0))
    assert np.isclose(line.reduced_mass, 2.0)
