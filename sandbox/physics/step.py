"""step(world): one tick on one screen. The order of its parts is part of the replay contract."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sandbox.physics.breaking import yield_and_break
from sandbox.physics.driving import drive_springs, drives_springs
from sandbox.physics.flight import begin_flight
from sandbox.physics.forces import StepStart, apply_forces, forces_of
from sandbox.physics.integrate import integrate
from sandbox.physics.joints.joint_set import JointSet, joints_of, keep_joints, load_joints
from sandbox.physics.sanitise import LOST, UNSOUND, contain_inputs, contain_outcome
from sandbox.physics.settings import AUTO
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.substeps import (
    Pair,
    Substep,
    cadence_of,
    constraint_coefficients,
    ease_of,
    substep_coefficients,
    substep_count,
    substep_time,
)
from sandbox.physics.untangling.triangle_clamp import clamp_world, has_triangles
from sandbox.physics.world import World

if TYPE_CHECKING:
    from sandbox.physics.pipeline import Collisions

# Changes only when the arithmetic of a tick changes; replays of another version are refused.
PHYSICS_VERSION = 9


@dataclass(frozen=True, eq=False)
class TickPlan:
    """The part of a tick's plan that follows from topology. folds: there are triangles, which may not turn over;
    drives: springs are driven.

    free: its collisions, where no spring, constraint or joint holds anything. springs, constraints: room for their Cs
    and Cd in a substep.
    """

    collisions: "Collisions | None"
    joints: JointSet | None
    folds: bool
    drives: bool
    free: "Collisions | None"
    springs: Pair
    constraints: Pair


def _plan(world: World) -> TickPlan:
    collisions, joints, drives = None, joints_of(world), drives_springs(world)
    if world.has_contacts:
        # Half of the physics, which a world in which nothing touches does without.
        from sandbox.physics.pipeline import collisions_of

        collisions = collisions_of(world)
    free = collisions if collisions is not None and collisions.is_free and joints is None and not drives else None
    springs, constraints = np.zeros((2, world.spring_count)), np.zeros((2, world.constraint_count))
    return TickPlan(
        collisions, joints, has_triangles(world), drives, free, (springs[0], springs[1]),
        (constraints[0], constraints[1]),
    )  # fmt: skip


def precompute(world: World) -> None:
    """Prepare the plan and the layouts of the next tick ahead of it. This changes nothing of a world's state."""
    world.derived(_plan)
    SOLVERS[world.settings.solver].precompute(world)


def step(world: World) -> None:
    """Advance the world by one tick of 1 / tick_rate seconds."""
    plan = world.derived(_plan)
    flies = world.may_fly and bool(world.unmoved.any())
    if plan.free is None or flies or not _step_free(world, plan.free):
        _step_held(world, flies)
    world.may_fly = False
    yield_and_break(world)


def _step_free(world: World, collisions: "Collisions") -> bool:
    # All of a tick in one entry; False: something is to be taken back before.
    settings, cadence = world.settings, collisions.cadence
    if collisions.forces.settings is not settings:
        forces_of(world)
    if cadence is None or cadence.settings is not settings:
        cadence = collisions.cadence = cadence_of(settings)
    collisions.begin(world)
    count = collisions.step_free(cadence.substeps, SOLVERS[settings.solver].tracks_slow_velocity, world.tick, cadence.h)
    if count == UNSOUND:
        return False
    collisions.end(world)
    world.end_tick()
    if count == LOST:
        contain_outcome(world)
    return True


def _step_held(world: World, flies: bool) -> None:
    settings = world.settings
    solver = SOLVERS[settings.solver]
    contain_inputs(world)
    plan = world.derived(_plan)
    collisions, joints = plan.collisions, plan.joints
    rest_length = drive_springs(world) if plan.drives else world.rest_length
    count = substep_count(world)
    h, ease = substep_time(settings, count), ease_of(settings, count)
    # Solvers only read them, so a tick of one substep needs no copies.
    springs, constraints = (world.stiffness, world.damping), world.constraint_coefficients
    if count > 1 or settings.drag > 0.0:
        keeps_constant = solver.bounded and settings.substeps == AUTO
        springs = substep_coefficients(world, count, plan.springs, keeps_constant, solver.highest)
        constraints = constraint_coefficients(world, count, plan.constraints, keeps_constant, solver.highest)
    # What a solver keeps is an impulse of one substep: exact, as their number is a power of two.
    scale = settings.fewest_substeps / count
    world.scale_impulses(scale)
    if collisions is not None:
        collisions.begin(world)
        collisions.forget_impacts()
    forces = forces_of(world)
    start = forces.particles.start
    for _ in range(count):
        if collisions is None or joints is not None:
            apply_forces(forces, h)
        if joints is not None:
            load_joints(joints, world, springs, h)
        contacts = None if collisions is None else collisions.collide(joints is not None, world.tick, h)
        solver.solve(world, Substep(h, count, ease, springs, constraints, StepStart(start, rest_length)), contacts)
        if flies:
            flies = False
            begin_flight(world, np.zeros(0, np.int64) if collisions is None else collisions.touched(), h)
        if joints is not None:
            keep_joints(joints, world, h)
        if collisions is not None:
            collisions.finish(h, not plan.folds)
        if plan.folds:
            clamp_world(world, solver.tracks_slow_velocity, h)
        has_moved = collisions is not None and not plan.folds
        if solver.settle is not None:
            solver.settle(world, not has_moved, h)
        elif not has_moved:
            integrate(world.position, world.velocity, world.particle_active, world.angle, world.spin, h)
        rest_length = world.rest_length
    if collisions is not None:
        collisions.end(world)
    world.scale_impulses(1.0 / scale)
    world.end_tick()
    contain_outcome(world)
