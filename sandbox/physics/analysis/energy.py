"""Energy of a world [J], what ticks take out of it, and how steps passed their energy test; no tick depends on it.

Where Cs, Cd or settings ramp (ramps.py), energies and forces are of what was in force in the last tick.
"""

import copy
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np

from sandbox.physics.arena import FIRST_ARENA, Arena, begin, lay_out
from sandbox.physics.arrays import Floats, Slots, with_empty
from sandbox.physics.constraints import AREA, FLOOR, FLOOR_RATE, FLOOR_STRENGTH, TRIANGLE, constraint_values
from sandbox.physics.geometry.segment import lengths
from sandbox.physics.jit import Bundle, bundle, items_of, kernel, set_field, unpack
from sandbox.physics.marks import GRAB_MATERIAL, LAW_HOOKE
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.ramps import COEFFICIENTS, CONSTRAINTS, SPRINGS, in_force
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.solvers.direct.system import BY_MASS
from sandbox.physics.state import State, state_of
from sandbox.physics.substeps import constraint_coefficients, substep_coefficients, substep_time
from sandbox.physics.water.displacers import FLOW_X, FLOW_Y, Water, new_water
from sandbox.physics.water.lift import ABOVE_ALL, add_energies
from sandbox.physics.world import World

AnyState = TypeVar("AnyState", World, Snapshot, World | Snapshot)
_TICKS = ("ramp_ticks", "constraint_ramp_ticks", "constraint_area_ticks", "setting_ticks")
# The energy of what blew up is inf or NaN, and no fault.
_unbounded = np.errstate(over="ignore", invalid="ignore")


def total_energy(world: World) -> float:
    """Kinetic energy and that of springs and gravity [J]."""
    return kinetic_energy(world) + spring_energy(world) + gravity_energy(world)


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
    them, less what cannot come back.

    With substeps "auto" that is the k of a tick in one part, however many parts the last tick had.
    """
    world = of_last_tick(world)
    error = spring_lengths(world) - world.rest_length
    constant = _spring_constants(world)
    springs = np.sum((constant * error * error)[world.spring_active & (world.material != GRAB_MATERIAL)])
    constraints = float(np.sum(constraint_energies(world))) if world.constraint_count else 0.0
    return float(0.5 * springs) + constraints - float(np.sum(world.unreturnable))


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
        rest, form = world.constraint_rest.T
        has_floor = (world.constraint_kind == AREA) & (world.constraint_corners == TRIANGLE) & (rest * form > 0.0)
        below = np.minimum(0.0, np.sign(rest) * (value + (1.0 - FLOOR) * rest))
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
def spring_lengths(world: World | Snapshot) -> Floats:
    """Present length [m] of every spring (m,)."""
    return lengths(world.position[world.particle_b] - world.position[world.particle_a])


def reduced_masses(world: World | Snapshot) -> Floats:
    """Reduced mass [kg] of every spring (m,); 0 where both ends are pinned."""
    total = world.inverse_mass[world.particle_a] + world.inverse_mass[world.particle_b]
    return np.divide(1.0, total, out=np.zeros_like(total), where=total > 0.0)


def _spring_constants(state: World | Snapshot) -> Floats:
    """k [N/m] of every spring (m,), as the solver gives it to them."""
    solver, h = SOLVERS[state.settings.solver], substep_time(state.settings)
    nissen = solver.spring_constant(*_halved_coefficients(state), reduced_masses(state), h)
    return np.where(state.law == LAW_HOOKE, state.hooke_stiffness, nissen)


def _halved_coefficients(state: World | Snapshot) -> tuple[Floats, Floats]:
    return substep_coefficients(state, highest=SOLVERS[state.settings.solver].highest)


def of_last_tick(state: AnyState) -> AnyState:
    """The state as its last tick had it, for readings of energy and force; itself where nothing ramps.

    It shares all other arrays with the state, and is not to be stepped or changed.
    """
    if not any(getattr(state, name).any() for name in _TICKS):
        return state
    view = copy.copy(state)
    arrays = {name: np.zeros_like(getattr(state, name)) for name in _TICKS} | {
        f"{family}{name}": values
        for family in (SPRINGS, CONSTRAINTS)
        for name, values in zip(COEFFICIENTS, in_force(state, family), strict=True)
    }
    rest = state.constraint_rest.copy()
    rest[:, 0] = np.where(state.constraint_area_ticks > 0, state.constraint_area_now, rest[:, 0])
    numbers = np.where(state.setting_ticks > 0, state.setting_now, state.settings.numbers)
    settings = "_settings" if isinstance(state, World) else "settings"
    vars(view).update(
        arrays, constraint_rest=rest, **{settings: WorldSettings.of(numbers.tolist(), state.settings.choices)}
    )
    return view


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
        settings, flow = world.settings, world.water[:, FLOW_X : FLOW_Y + 1]
        blows = settings.drag > 0.0 and any(settings.wind)
        is_driven = bool(len(world.actuators.muscles.spring)) or bool(np.any(world.actuator_value))
        if world.any_held() or is_driven or blows or flow.any():
            self._before = None
        else:
            self._before = total_energy(world) if changed or self._after is None else self._after

    def after(self, world: World) -> None:
        """Take in the world after the tick."""
        self._after = None
        if self._before is not None:
            self._after = total_energy(world)
            self.energy += self._before - self._after


def water_energy(world: World) -> float:
    """Energy [J] of the water that a world's bodies, hulls and discs have lifted to the surface; 0 without water."""
    if not len(world.water):
        return 0.0
    return float(_energy_lifted(world.derived(_lay_out, of_hands=False), max(0.0, -world.settings.gravity[1])))


def discs_in_water(world: World) -> Slots:
    """The particles of a world with water that displace it by their own discs."""
    place = items_of(world.derived(_lay_out, of_hands=False))
    return np.asarray(place.water.disc)


def _lay_out(world: World) -> Any:
    water = with_empty(Water, pool=world.water, hull=world.hulls)
    pointer = bundle(with_empty(WaterPlace, state=state_of(world), water=water))
    lay_out(_derive_water, pointer, np.zeros(FIRST_ARENA, np.int64))
    return pointer


class WaterPlace(NamedTuple):
    """A world's state, and scratch for its water's displacers."""

    state: State
    water: Water


@kernel
def _derive_water(pointer: Bundle[WaterPlace], arena: Arena) -> None:
    place = unpack(pointer)
    begin(arena)
    set_field(place, "water", new_water(place.state, place.water, arena))


@kernel
def _energy_lifted(pointer: Bundle[WaterPlace], g: float) -> float:
    place = unpack(pointer)
    water, total = place.water, 0.0
    for p in range(water.lifted.shape[0]):
        water.lifted[p], water.due[p] = 0.0, True
        for axis in range(2):
            water.before[p, axis] = water.after[p, axis] = place.state.position[p, axis]
        water.before[p, 1] = ABOVE_ALL
    add_energies(water, place.state, g)
    for p in range(water.lifted.shape[0]):
        total += water.lifted[p]
    return total


@dataclass(frozen=True)
class EnergyTests:
    """How often each way through the energy test was the last that a step of a body or of an island needed.

    passed: the first solve; solved_on: a further one; minimised: the minimum of f, of a body alone; slowed_down: what
    moves within was slowed down.
    """

    passed: int
    solved_on: int
    minimised: int
    slowed_down: int

    def __str__(self) -> str:
        return (
            f"{self.passed:,} passed, {self.solved_on:,} solved on, {self.minimised:,} minimised, "
            f"{self.slowed_down:,} slowed down"
        )


def energy_tests(world: World) -> EnergyTests:
    """The counts of a world since they were forgotten; all 0 in solvers without the test."""
    return EnergyTests(*block_of(world).inputs.workspace.ways[:BY_MASS].tolist())


def steps_by_mass(world: World) -> int:
    """How often a body had no time for its exact answer to contacts, and took that of its particles' masses."""
    return int(block_of(world).inputs.workspace.ways[BY_MASS])


def forget_energy_tests(world: World) -> None:
    """Set the counts of energy tests to 0."""
    block_of(world).inputs.workspace.ways[:] = 0
