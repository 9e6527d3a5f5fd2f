"""Energy of a world [J] and what ticks take out of it: for the panel and the checks; no tick depends on it."""

import numpy as np

from sandbox.physics.analysis.last_tick import of_last_tick
from sandbox.physics.analysis.water_energy import water_energy
from sandbox.physics.arrays import Floats
from sandbox.physics.constraints import AREA, FLOOR, FLOOR_RATE, FLOOR_STRENGTH, TRIANGLE, constraint_values
from sandbox.physics.geometry.segment import lengths
from sandbox.physics.marks import GRAB_MATERIAL, LAW_HOOKE
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.substeps import constraint_coefficients, substep_coefficients, substep_time
from sandbox.physics.water.pools import FLOW_X, FLOW_Y
from sandbox.physics.world import World

# The energy of what blew up is inf or NaN, and no fault.
_unbounded = np.errstate(over="ignore", invalid="ignore")


def reduced_masses(world: World | Snapshot) -> Floats:
    """Reduced mass [kg] of every spring (m,); 0 where both ends are pinned."""
    total = world.inverse_mass[world.particle_a] + world.inverse_mass[world.particle_b]
    return np.divide(1.0, total, out=np.zeros_like(total), where=total > 0.0)


@_unbounded
def spring_lengths(world: World | Snapshot) -> Floats:
    """Present length [m] of every spring (m,)."""
    return lengths(world.position[world.particle_b] - world.position[world.particle_a])


def _spring_constants(state: World | Snapshot) -> Floats:
    """k [N/m] of every spring (m,), as the solver gives it to them."""
    solver, h = SOLVERS[state.settings.solver], substep_time(state.settings)
    nissen = solver.spring_constant(*_halved_coefficients(state), reduced_masses(state), h)
    return np.where(state.law == LAW_HOOKE, state.hooke_stiffness, nissen)


def _halved_coefficients(state: World | Snapshot) -> tuple[Floats, Floats]:
    return substep_coefficients(state, highest=SOLVERS[state.settings.solver].highest)


@_unbounded
def spring_forces(state: World | Snapshot) -> Floats:
    """Force [N] of every spring (m,) as the next step begins, above 0: it pulls; 0 where inactive, and of the grabs'.

    F = k x + c u, with the speed u at which the ends part once gravity has acted. Where the solver bounds the energy
    it is k x alone: its k has the damping in it.
    """
    state = of_last_tick(state)
    constant, h = _spring_constants(state), substep_time(state.settings)
    separation = state.position[state.particle_b] - state.position[state.particle_a]
    length = spring_lengths(state)
    force = constant * (length - state.rest_length)
    if not SOLVERS[state.settings.solver].bounded:
        falling = np.where(state.inverse_mass > 0.0, state.gravity_scale * h, 0.0)[:, None] * state.settings.gravity
        velocity = state.velocity + falling
        parting = np.sum((velocity[state.particle_b] - velocity[state.particle_a]) * separation, axis=1)
        speed = np.divide(parting, length, out=np.zeros_like(length), where=length > 0.0)
        nissen = _halved_coefficients(state)[1] * reduced_masses(state) / h
        force = force + np.where(state.law == LAW_HOOKE, state.hooke_damping, nissen) * speed
    return np.where(state.spring_active & (state.material != GRAB_MATERIAL), force, 0.0)


@_unbounded
def kinetic_energy(world: World) -> float:
    """Sum of m v^2 / 2 over the free particles [J], and of I omega^2 / 2 of those that turn, I = m r^2 / 2."""
    free = world.particle_active & (world.inverse_mass > 0.0)
    energy = 0.5 * np.sum(world.mass[free, None] * world.velocity[free] ** 2)
    if world.spin.any():
        energy += 0.25 * np.sum(world.mass[free] * (world.radius[free] * world.spin[free]) ** 2)
    return float(energy)


@_unbounded
def spring_energy(world: World) -> float:
    """Sum of k x^2 / 2 [J] over active springs but the grabs', and of constraints, with the k that the solver gives
    them.

    With substeps "auto" that is the k of a tick in one part, however many parts the last tick had.
    """
    world = of_last_tick(world)
    error = spring_lengths(world) - world.rest_length
    constant = _spring_constants(world)
    springs = np.sum((constant * error * error)[world.spring_active & (world.material != GRAB_MATERIAL)])
    return float(0.5 * springs) + (float(np.sum(constraint_energies(world))) if world.constraint_count else 0.0)


@_unbounded
def constraint_energies(world: World) -> Floats:
    """Energy [J] of every constraint (t,), k C^2 / 2 with the k that the world's solver gives it; 0 where inactive.

    With that of the floor under a triangle, where the solver has them.
    """
    world = of_last_tick(world)
    value, mass, _ = measure_constraints(world)
    solver, h = SOLVERS[world.settings.solver], substep_time(world.settings)
    constant = solver.spring_constant(*constraint_coefficients(world, highest=solver.highest), mass, h)
    energies = np.asarray(0.5 * constant * value * value)
    if solver.has_floors:
        wanted, form = world.constraint_rest.T
        has_floor = (world.constraint_kind == AREA) & (world.constraint_corners == TRIANGLE) & (wanted * form > 0.0)
        below = np.minimum(0.0, np.sign(wanted) * (value + (1.0 - FLOOR) * wanted))
        energies += np.where(has_floor, 0.5 * FLOOR_STRENGTH * FLOOR_RATE**2 * mass * below * below, 0.0)
    return energies


def measure_constraints(world: World) -> tuple[Floats, Floats, Floats]:
    """C (t,) and effective mass (t,) of every constraint, 0 where inactive; and the gradient at each corner (q, 2)."""
    value, mass = np.zeros((2, world.constraint_count))
    place, slope = np.zeros((2, len(world.corner_particle), 2))
    if world.constraint_count:
        constraint_values(world.position, world.inverse_mass, world.constraints, place, value, mass, slope)
    return value, mass, slope


@_unbounded
def gravity_energy(world: World) -> float:
    """Sum of -m g . x over the free particles [J], g times each one's gravity scale; zero at the origin's height.

    With that of the water that they displace.
    """
    world = of_last_tick(world)
    free = world.particle_active & (world.inverse_mass > 0.0)
    of_particles = -np.sum(
        (world.mass * world.gravity_scale)[free, None] * world.position[free] * np.asarray(world.settings.gravity)
    )
    return float(of_particles) + water_energy(world)


def total_energy(world: World) -> float:
    """Kinetic energy and that of springs and gravity [J]."""
    return kinetic_energy(world) + spring_energy(world) + gravity_energy(world)


class Dissipation:
    """Energy [J] lost in ticks: `before` each, then `after` it; energy that a tick gained counts against it.

    What commands change between ticks is not counted, nor is a tick in which something works on the world: a grab that
    holds a particle, a muscle, a hydraulic or motor that is driven, the wind, water that flows.
    """

    def __init__(self) -> None:
        self.energy = 0.0
        self._before: float | None = None
        self._after: float | None = None

    def before(self, world: World, changed: bool = True) -> None:
        """Look at a world that is about to make a tick; changed: whether it may differ from the last look `after`."""
        if _is_worked_on(world):
            self._before = None
        else:
            self._before = total_energy(world) if changed or self._after is None else self._after

    def after(self, world: World) -> None:
        """Look at it again after the tick."""
        self._after = None
        if self._before is not None:
            self._after = total_energy(world)
            self.energy += self._before - self._after


def _is_worked_on(world: World) -> bool:
    settings = world.settings
    blows = settings.drag > 0.0 and any(settings.wind)
    flows = bool(world.water[:, FLOW_X : FLOW_Y + 1].any())
    is_driven = bool(len(world.actuators.muscles.spring)) or bool(np.any(world.actuator_value))
    return world.any_held() or is_driven or blows or flows
