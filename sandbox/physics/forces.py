"""What acts on particles before the springs do: gravity, the air, motors. To the springs it is work from outside."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit import bundle, contents, inner_kernel, kernel
from sandbox.physics.settings import WorldSettings
from sandbox.physics.world import Floats, Slots, World

# Below this moment of inertia [kg m^2] a group of particles has no direction to be turned in.
LEAST_INERTIA = 1e-150


class Before(NamedTuple):
    """What a step begins with, before forces and drives: velocity [m/s] (n, 2) and rest_length [m] (m,).

    A solver that tests energies measures by it what forces and drives have done.
    """

    velocity: Floats
    rest_length: Floats


class Masses(NamedTuple):
    """What motors read of particles (n,), see StateArrays; they change the velocity."""

    position: Floats
    velocity: Floats
    mass: Floats
    inverse_mass: Floats


class Joints(NamedTuple):
    """What motors read of springs (m,), see StateArrays."""

    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    active: NDArray[np.bool_]
    material: NDArray[np.int32]


class Wheels(NamedTuple):
    """The wheels of all motors, see Motors, and how the driven parts are driven, -1..1."""

    hub: Slots
    speed: Floats
    torque: Floats
    part: Slots
    rim_start: Slots
    rim: Slots
    actuator_value: Floats


class ForcedParticles(NamedTuple):
    """The arrays of a world that gravity and the air read and change, see StateArrays.

    before [m/s] (n, 2): the velocities at the start of the step. numbers (5,): gravity [m/s^2], wind [m/s], drag [1/s].
    """

    velocity: Floats
    inverse_mass: Floats
    gravity_scale: Floats
    particle_active: NDArray[np.bool_]
    before: Floats
    numbers: Floats


@dataclass(eq=False)
class Forces:
    """The scratch of a world's forces, and it as one argument; settings: those whose numbers are in it."""

    particles: ForcedParticles
    items: Any
    settings: WorldSettings | None = None


@inner_kernel
def add_gravity_and_air(particles: ForcedParticles, h: float) -> None:
    """Bring velocities of free particles from the start of a step of h [s] to where motors begin; keep those before.

    v += g h, times their gravity scale; then, with the air, v' = v + h drag (wind - v'), implicit:
    v += (1 - 1 / (1 + drag h)) (wind - v), which never overshoots.
    """
    velocity = particles.velocity
    gravity_x = particles.numbers[0]
    gravity_y = particles.numbers[1]
    wind_x = particles.numbers[2]
    wind_y = particles.numbers[3]
    drag = particles.numbers[4]
    share = drag * h / (1.0 + drag * h)
    for p in range(particles.inverse_mass.shape[0]):
        particles.before[p, 0] = velocity[p, 0]
        particles.before[p, 1] = velocity[p, 1]
        if particles.particle_active[p] and particles.inverse_mass[p] > 0.0:
            velocity[p, 0] += gravity_x * particles.gravity_scale[p] * h
            velocity[p, 1] += gravity_y * particles.gravity_scale[p] * h
            if drag > 0.0:
                velocity[p, 0] += share * (wind_x - velocity[p, 0])
                velocity[p, 1] += share * (wind_y - velocity[p, 1])


@kernel
def _add_gravity_and_air(items: Any, h: float) -> None:
    (particles,) = contents(items)
    add_gravity_and_air(particles, h)


def forces_of(world: World) -> Forces:
    """The scratch of a world's forces, with the numbers of its present settings."""
    forces, settings = world.derived(_make_forces), world.settings
    if forces.settings is not settings:
        forces.particles.numbers[:] = (*settings.gravity, *settings.wind, settings.drag)
        forces.settings = settings
    return forces


def _make_forces(world: World) -> Forces:
    arrays = world.velocity, world.inverse_mass, world.gravity_scale, world.particle_active
    particles = ForcedParticles(*arrays, np.zeros_like(world.velocity), np.zeros(5))
    return Forces(particles, bundle((particles,)))


@inner_kernel
def _spin(group: Slots, first: int, last: int, masses: Masses) -> tuple[float, float, float, float]:
    # Centre of mass, angular velocity about it and moment of inertia of a group; infinite (-1) where one is pinned.
    # omega = sum m r x v / I,  I = sum m r^2
    position, velocity, mass = masses.position, masses.velocity, masses.mass
    total = 0.0
    x = 0.0
    y = 0.0
    u = 0.0
    v = 0.0
    for i in range(first, last):
        p = group[i]
        if masses.inverse_mass[p] == 0.0:
            return 0.0, 0.0, 0.0, -1.0
        total += mass[p]
        x += mass[p] * position[p, 0]
        y += mass[p] * position[p, 1]
        u += mass[p] * velocity[p, 0]
        v += mass[p] * velocity[p, 1]
    if not total > 0.0:
        return 0.0, 0.0, 0.0, 0.0
    x /= total
    y /= total
    u /= total
    v /= total
    inertia = 0.0
    momentum = 0.0
    for i in range(first, last):
        p = group[i]
        dx = position[p, 0] - x
        dy = position[p, 1] - y
        inertia += mass[p] * (dx * dx + dy * dy)
        momentum += mass[p] * (dx * (velocity[p, 1] - v) - dy * (velocity[p, 0] - u))
    if not inertia > LEAST_INERTIA:
        return 0.0, 0.0, 0.0, 0.0
    return x, y, momentum / inertia, inertia


@inner_kernel
def _turn(group: Slots, first: int, last: int, masses: Masses, x: float, y: float, change: float) -> None:
    # Change a group's angular velocity about its centre of mass: no impulse along any direction, for sum m r = 0.
    for i in range(first, last):
        p = group[i]
        dx = masses.position[p, 0] - x
        dy = masses.position[p, 1] - y
        masses.velocity[p, 0] -= change * dy
        masses.velocity[p, 1] += change * dx


@inner_kernel
def _find_mount(hub: int, stamp: int, joints: Joints, mark: Slots, mount: Slots) -> int:
    # The hub and what springs join to it besides its wheel, which is marked with the stamp; how many they are.
    mount[0] = hub
    mark[hub] = stamp
    count = 1
    for s in range(joints.active.shape[0]):
        if not joints.active[s] or joints.material[s] < 0:
            continue
        other = -1
        if joints.particle_a[s] == hub:
            other = joints.particle_b[s]
        elif joints.particle_b[s] == hub:
            other = joints.particle_a[s]
        if other >= 0 and mark[other] != stamp:
            mark[other] = stamp
            mount[count] = other
            count += 1
    return count


@kernel
def _run_motors(masses: Masses, joints: Joints, wheels: Wheels, mark: Slots, mount: Slots, h: float) -> None:
    # The angular impulse P [N m s] that brings the wheel to its speed against its mount, at most torque h:
    # P = (speed - (omega_wheel - omega_mount)) / (1 / I_wheel + 1 / I_mount), +P on the wheel and -P on the mount.
    rim, rim_start = wheels.rim, wheels.rim_start
    for k in range(wheels.hub.shape[0]):
        value = wheels.actuator_value[wheels.part[k]]
        if value == 0.0:
            continue
        first, last = rim_start[k], rim_start[k + 1]
        for i in range(first, last):
            mark[rim[i]] = k + 1
        count = _find_mount(wheels.hub[k], k + 1, joints, mark, mount)
        wheel_x, wheel_y, wheel_turn, wheel_inertia = _spin(rim, first, last, masses)
        mount_x, mount_y, mount_turn, mount_inertia = _spin(mount, 0, count, masses)
        # Without anything to push against, as with a wheel all alone, a motor does nothing.
        if wheel_inertia == 0.0 or mount_inertia == 0.0:
            continue
        of_wheel = 1.0 / wheel_inertia if wheel_inertia > 0.0 else 0.0
        of_mount = 1.0 / mount_inertia if mount_inertia > 0.0 else 0.0
        if of_wheel + of_mount == 0.0:
            continue
        impulse = (value * wheels.speed[k] - (wheel_turn - mount_turn)) / (of_wheel + of_mount)
        impulse = min(max(impulse, -wheels.torque[k] * h), wheels.torque[k] * h)
        if of_wheel > 0.0:
            _turn(rim, first, last, masses, wheel_x, wheel_y, impulse * of_wheel)
        if of_mount > 0.0:
            _turn(mount, 0, count, masses, mount_x, mount_y, -impulse * of_mount)


def apply_forces(world: World, h: float) -> Forces:
    """Bring the velocities of free particles from the start of a step of h [s] to where its springs begin.

    A motor's reaction goes to its hub and what springs join to it, so that momentum and angular momentum are kept;
    where one of these is pinned, it goes to the ground. The forces that are returned keep the velocities before.
    """
    motors = world.actuators.motors
    forces = forces_of(world)
    _add_gravity_and_air(forces.items, h)
    if len(motors.hub):
        mark, mount = np.zeros((2, world.particle_count), dtype=np.int64)
        _run_motors(
            Masses(world.position, world.velocity, world.mass, world.inverse_mass),
            Joints(world.particle_a, world.particle_b, world.spring_active, world.material),
            Wheels(
                motors.hub, motors.speed, motors.torque, motors.part, motors.rim_start, motors.rim, world.actuator_value
            ),
            mark, mount, h,
        )  # fmt: skip
    return forces
