"""Commands: everything that a person or a script can do to a running world, as data in metres and slots.

A command is a frozen value; `apply` is the one dispatcher. A command that cannot be carried out changes nothing and
raises CommandError. Command names are part of the replay format and are never reused.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Annotated, Any

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError

from sandbox.level.format.limits import (
    COORDINATE_LIMIT,
    DRAG_LIMIT,
    GRAVITY_LIMIT,
    INFLATION_LIMIT,
    MASS_RANGE,
    PARTICLE_LIMIT,
    SPEED_LIMIT,
    SPRING_LIMIT,
    SUBSTEPS,
)
from sandbox.physics.settings import AUTO, Substeps
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.world import HAND_COUNT, LAW_NISSEN, World

Coordinate = Annotated[float, Field(ge=-COORDINATE_LIMIT, le=COORDINATE_LIMIT, allow_inf_nan=False)]
Acceleration = Annotated[float, Field(ge=-GRAVITY_LIMIT, le=GRAVITY_LIMIT, allow_inf_nan=False)]
WindSpeed = Annotated[float, Field(ge=-SPEED_LIMIT, le=SPEED_LIMIT, allow_inf_nan=False)]
DragRate = Annotated[float, Field(ge=0.0, le=DRAG_LIMIT, allow_inf_nan=False)]
Signed = Annotated[float, Field(ge=-1.0, le=1.0, allow_inf_nan=False)]
Fraction = Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)]
Inflation = Annotated[float, Field(ge=0.0, le=INFLATION_LIMIT, allow_inf_nan=False)]
Length = Annotated[float, Field(ge=0.0, le=COORDINATE_LIMIT, allow_inf_nan=False)]
Mass = Annotated[float, Field(ge=MASS_RANGE[0], le=MASS_RANGE[1], allow_inf_nan=False)]
Point = tuple[Coordinate, Coordinate]
Hand = Annotated[int, Field(ge=0, lt=HAND_COUNT)]
Slot = Annotated[int, Field(ge=0)]


class CommandError(ValueError):
    """A command that cannot be carried out; its text is one line for a person."""


class _Validated:
    """What commands share: strict validation, also of a command that was made without it."""

    __pydantic_config__ = ConfigDict(strict=True, extra="forbid", revalidate_instances="always")


@dataclass(frozen=True)
class Grab(_Validated):
    """Hold a particle with hand number `grab` (0..9) at target [m]."""

    grab: Hand
    particle: Slot
    target: Point


@dataclass(frozen=True)
class MoveGrab(_Validated):
    """Move a hand that holds something to target [m]."""

    grab: Hand
    target: Point


@dataclass(frozen=True)
class Release(_Validated):
    """Let go of what a hand holds."""

    grab: Hand


@dataclass(frozen=True)
class Pin(_Validated):
    """Hold a particle where it is."""

    particle: Slot


@dataclass(frozen=True)
class Unpin(_Validated):
    """Let a pinned particle move."""

    particle: Slot


@dataclass(frozen=True)
class CutSprings(_Validated):
    """Take springs out of the world."""

    springs: tuple[Slot, ...]


@dataclass(frozen=True)
class AddParticle(_Validated):
    """Add a particle at position [m], of mass [kg] and radius [m]; it is named +.0, +.1, ... in order of adding."""

    position: Point
    mass: Mass = 1.0
    radius: Length = 0.05
    pinned: bool = False


@dataclass(frozen=True)
class AddSpring(_Validated):
    """Add a spring between two particles; rest_length [m], None = as placed; it is named +:0, +:1, ..."""

    particle_a: Slot
    particle_b: Slot
    rest_length: Length | None = None
    stiffness: Fraction = 0.5
    damping: Fraction = 0.9


@dataclass(frozen=True)
class SetCoefficients(_Validated):
    """Set Cs, Cd or both (None = leave), of one material by index or of all (None)."""

    stiffness: Fraction | None = None
    damping: Fraction | None = None
    material: Slot | None = None


@dataclass(frozen=True)
class SetGravity(_Validated):
    """Set gravity [m/s^2]."""

    gravity: tuple[Acceleration, Acceleration]


@dataclass(frozen=True)
class SetAir(_Validated):
    """Set the wind [m/s], the drag [1/s] or both (None = leave)."""

    wind: tuple[WindSpeed, WindSpeed] | None = None
    drag: DragRate | None = None


@dataclass(frozen=True)
class SetDrive(_Validated):
    """Drive a part, a motor or hydraulic, forward (1), backward (-1), slower, or not at all (0)."""

    part: Slot
    value: Signed


@dataclass(frozen=True)
class SetInflation(_Validated):
    """Let a body's areas, the one of a ring or those of a jelly, want this multiple of their own."""

    body: Slot
    value: Inflation


@dataclass(frozen=True)
class SetSolver(_Validated):
    """Set the solver or any of its settings (None = leave); substeps is a power of two or "auto"."""

    solver: str | None = None
    iterations: Annotated[int, Field(ge=1, le=1000)] | None = None
    substeps: Substeps | None = None
    warm_start: Fraction | None = None


@dataclass(frozen=True)
class Undo(_Validated):
    """Take the last gesture back, as if it had never been made; the session carries it out."""


@dataclass(frozen=True)
class Redo(_Validated):
    """Make the gesture again that was undone last; the session carries it out."""


Command = (
    Grab | MoveGrab | Release | Pin | Unpin | CutSprings | AddParticle | AddSpring | SetCoefficients | SetGravity
    | SetAir | SetDrive | SetInflation | SetSolver | Undo | Redo
)  # fmt: skip


_adapters: dict[Any, TypeAdapter[Any]] = {}


def adapter(kind: Any) -> TypeAdapter[Any]:
    """The strict validator of one command type, made when it is first needed."""
    if kind not in _adapters:
        _adapters[kind] = TypeAdapter(kind)
    return _adapters[kind]


def plain_fault(error: ValidationError) -> str:
    """The first fault of a validation as `field: what is wrong`, in one line."""
    fault = error.errors(include_url=False, include_context=False, include_input=False)[0]
    place = ".".join(part if part.isprintable() else repr(part) for part in map(str, fault["loc"]))[:80]
    text = fault["msg"].replace("Input should be", "must be").splitlines()[0]
    return f"{place}: {text}" if place else text


def apply(world: World, command: Command) -> None:
    """Carry a command out. Raises CommandError and changes nothing where it cannot be."""
    action = _ACTIONS.get(type(command))
    if action is None:
        raise CommandError(f"{type(command).__name__} is no command for a world")
    try:
        adapter(type(command)).validate_python(command)
    except ValidationError as error:
        raise CommandError(plain_fault(error)) from None
    action(world, command)


def _particle(world: World, slot: int) -> str:
    """The name of a particle that a command may work on."""
    if slot >= world.particle_count or world.is_hand_particle(slot) or not world.particle_active[slot]:
        raise CommandError(f"there is no particle {slot}")
    return world.particle_names[slot]


def _held(world: World, hand: int) -> None:
    if not world.is_held(hand):
        raise CommandError(f"hand {hand} holds nothing")


def _grab(world: World, command: Grab) -> None:
    name = _particle(world, command.particle)
    if world.is_held(command.grab):
        raise CommandError(f"hand {command.grab} holds something already")
    if world.inverse_mass[command.particle] == 0.0:
        raise CommandError(f"{name} is pinned: unpin it to drag it")
    world.hold(command.grab, command.particle, command.target)


def _move_grab(world: World, command: MoveGrab) -> None:
    _held(world, command.grab)
    world.move_hand(command.grab, command.target)


def _release(world: World, command: Release) -> None:
    _held(world, command.grab)
    world.release(command.grab)


def _pin(world: World, command: Pin) -> None:
    name = _particle(world, command.particle)
    if world.inverse_mass[command.particle] == 0.0:
        raise CommandError(f"{name} is pinned already")
    world.pin(command.particle)


def _unpin(world: World, command: Unpin) -> None:
    name = _particle(world, command.particle)
    if world.inverse_mass[command.particle] > 0.0:
        raise CommandError(f"{name} is not pinned")
    world.unpin(command.particle)


def _cut(world: World, command: CutSprings) -> None:
    for slot in command.springs:
        if slot >= world.spring_count or world.is_hand_spring(slot) or not world.spring_active[slot]:
            raise CommandError(f"there is no spring {slot} to cut")
    world.cut(command.springs)


def _next_names(prefix: str, names: list[str], count: int = 1) -> list[str]:
    first = sum(name.startswith(prefix) for name in names)
    return [f"{prefix}{number}" for number in range(first, first + count)]


def name_added(world: World) -> None:
    """Name the slots that a restored state brought along as the commands that added them did."""
    if len(world.particle_names) <= world.hand_particle:
        # A level without particles reserves its hands at the first grab, behind what was added until then.
        _name_slots(world, world.hand_particle, world.hand_spring)
        world.name_hands()
    _name_slots(world, world.particle_count, world.spring_count)


def _name_slots(world: World, particle_count: int, spring_count: int) -> None:
    """Name the slots up to these counts that have no name yet."""
    world.name_slots(
        _next_names("+.", world.particle_names, particle_count - len(world.particle_names)),
        _next_names("+:", world.spring_names, spring_count - len(world.spring_names)),
    )


def _add_particle(world: World, command: AddParticle) -> None:
    if world.particle_count >= PARTICLE_LIMIT:
        raise CommandError(f"a world holds at most {PARTICLE_LIMIT:,} particles")
    world.add_particles(
        _next_names("+.", world.particle_names),
        [command.position],
        mass=command.mass,
        radius=command.radius,
        pinned=command.pinned,
        **asdict(world.surface),
    )


def _add_spring(world: World, command: AddSpring) -> None:
    if world.spring_count >= SPRING_LIMIT:
        raise CommandError(f"a world holds at most {SPRING_LIMIT:,} springs")
    name = _particle(world, command.particle_a)
    _particle(world, command.particle_b)
    if command.particle_a == command.particle_b:
        raise CommandError(f"a spring joins two different particles, not {name} to itself")
    world.add_springs(
        _next_names("+:", world.spring_names),
        [command.particle_a],
        [command.particle_b],
        rest_length=command.rest_length,
        stiffness=command.stiffness,
        damping=command.damping,
        law=LAW_NISSEN,
    )


def _set_coefficients(world: World, command: SetCoefficients) -> None:
    if command.material is not None and command.material >= len(world.material_names):
        raise CommandError(f"there is no material {command.material}")
    world.set_coefficients(command.stiffness, command.damping, command.material)


def _set_gravity(world: World, command: SetGravity) -> None:
    world.settings = replace(world.settings, gravity=command.gravity)


def _set_air(world: World, command: SetAir) -> None:
    given = {name: value for name, value in asdict(command).items() if value is not None}
    world.settings = replace(world.settings, **given)


def _set_drive(world: World, command: SetDrive) -> None:
    if command.part >= len(world.part_value):
        raise CommandError(f"there is no driven part {command.part}")
    world.drive(command.part, command.value)


def _set_inflation(world: World, command: SetInflation) -> None:
    if command.body >= len(world.area_names):
        raise CommandError(f"there is no body {command.body} that keeps an area")
    world.inflate(command.body, command.value)


def _set_solver(world: World, command: SetSolver) -> None:
    if command.solver is not None and command.solver not in SOLVERS:
        raise CommandError(f"there is no solver {command.solver!r}; there are {', '.join(SOLVERS)}")
    if command.substeps is not None and command.substeps not in (*SUBSTEPS, AUTO):
        raise CommandError(f'substeps is a power of two from 1 to 64 or "{AUTO}", not {command.substeps}')
    given = {name: value for name, value in asdict(command).items() if value is not None}
    world.settings = replace(world.settings, **given)


_ACTIONS: dict[type, Callable[[World, Any], None]] = {
    Grab: _grab,
    MoveGrab: _move_grab,
    Release: _release,
    Pin: _pin,
    Unpin: _unpin,
    CutSprings: _cut,
    AddParticle: _add_particle,
    AddSpring: _add_spring,
    SetCoefficients: _set_coefficients,
    SetGravity: _set_gravity,
    SetAir: _set_air,
    SetDrive: _set_drive,
    SetInflation: _set_inflation,
    SetSolver: _set_solver,
}
