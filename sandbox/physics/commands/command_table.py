"""The table of commands: what kernels take of each by its name in files, how they are called, words for refusals."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from sandbox.physics.arena import NO_ARENA
from sandbox.physics.arrays import Floats
from sandbox.physics.commands import command
from sandbox.physics.commands.command import DENIED, NOT_ALLOWED, SPENT, UNTOUCHED
from sandbox.physics.commands.cutting import ASKED
from sandbox.physics.keeping.arguments import (
    CONSTRAINTS,
    FARTHEST,
    HANDS,
    KEYS,
    PARTICLES,
    PARTS,
    SPRINGS,
    listed,
    no_slot,
    number,
    point,
    shown,
    ticks,
    whole,
    whole_from,
    whole_numbers,
)
from sandbox.physics.marks import FARTHEST_PLACE, LEAST_MASS, MOST_MASS, MOST_PARTICLES, MOST_SPRINGS
from sandbox.physics.settings import AUTO, SOLVER_NAMES
from sandbox.physics.state import StateArrays

# Words for them; {}: the name of what it is about, or its number.
WORDS = {
    command.BAD: "{} is not there, not in use, or out of range",
    command.FORBIDDEN: "in this level hands may not {}",
    command.UNTOUCHABLE: "in this level hands may not touch {}",
    command.EXHAUSTED: "not enough {} left",
    command.HOLDS: "hand {} holds something already",
    command.HOLDS_NOTHING: "hand {} holds nothing",
    command.TOO_PINNED: "{} is pinned: unpin it to drag it",
    command.PINNED: "{} is pinned already",
    command.NOT_PINNED: "{} is not pinned",
    command.NOTHING_THERE: "there is nothing to push there",
    command.NOTHING_MOVES: "there is nothing that moves to be shaken",
    command.TOO_FAR: f"what hangs on {{}} would be beyond {FARTHEST_PLACE:g} m",
    command.NOTHING_TO_FREE: "nothing touches anything here: there is nothing to free",
    command.BODY_PINNED: "the body of {} is pinned: unpin it to free it",
    command.NO_FREE_PLACE: "there is no free place for the body of {} near by",
    command.UNSAID: "say sag, or hz with or without ratio",
    command.NO_FIRMNESS: "{}: its form is not stiff without pins, so it has no firmness",
    command.FLAT: "{}: it has no height along gravity to sag by; say its frequency in Hz",
    command.BEYOND_REACH: "{}: {} is out of reach at {} ticks a second; the nearest is {}{}",
    command.NO_ROWS: "there are no rows for the pieces of {}",
    command.TOO_MANY: f"there is no room for the pieces: a world holds at most {MOST_PARTICLES:,} particles and "
    f"{MOST_SPRINGS:,} springs",
    command.TOO_HEAVY: f"{{}}: a mass is from {LEAST_MASS:g} to {MOST_MASS:g} kg",
}
# What has to be derived again after a command: nothing, what follows from hands, what follows from topology, all of it
# as by another solver.
NOTHING, OF_HANDS, OF_TOPOLOGY, OF_SOLVER = "", "hands", "topology", "solver"


class KernelCommand(NamedTuple):
    """A kind of command: its number; what lies in `slots` and `numbers` then; what has to be derived again.

    first_cursor, first_spring: of hands; grab: a hand; materials: how many there are; tick_rate [1/s]; duration
    [ticks]: see ramps.py; ?name: whether that is given; of ANSWERS: what the kernel writes. Others are what commands of
    files call so: places have two numbers, springs as many slots as there are.
    """

    code: int
    slots: tuple[str, ...]
    numbers: tuple[str, ...] = ()
    changes: str = NOTHING


_HAND = ("first_cursor", "first_spring", "grab")
_PARTICLE = ("first_cursor", "particle")
_SOLVER = ("?solver", "solver", "?iterations", "iterations", "?substeps", "substeps", "?warm_start", "duration")
# Numbers that a kernel writes, and how many they are: by what the host is to multiply kept impulses of contacts; the
# nearest firmness that can be had; rows of particles, springs, constraints and corners that a cut needs, or is given.
ANSWERS = {"contacts": 1, "nearest": 2, "rows": ASKED}
# What a world says itself of every command, if nobody else does.
_OF_WORLD = {"first_cursor", "first_spring", "tick_rate", "materials", "duration"}
UNEQUAL = "at of {} springs: {} are cut"
# What somebody may leave out.
_MAY_LACK = {"at"}
# Slots that are true or false.
_FLAGS = frozenset({"down", "at_rest", "whole"})
# Numbers that are pairs; ranges of others, where they have any, and of values.
_PAIRS = frozenset({"target", "gravity", "wind", "position", "impulse", "acceleration", "by"})
_RANGES = {
    "strength": (0.0,), "radius": (0.0,), "stiffness": (0.0, 1.0), "damping": (0.0, 1.0), "lowest_mode": (0.0,),
    "drag": (0.0,), "factor": (0.0, 1000.0), "warm_start": (0.0, 1.0), "sag": (0.0,), "hz": (0.0,), "ratio": (0.0,),
}  # fmt: skip
_VALUES = {command.DRIVE: (-1.0, 1.0), command.SET_INFLATION: (0.0,)}
# What is a list of slots, of which a command has one alone.
_LISTS = ("springs", "constraints")
# Kinds of commands by their names in files. Files have no `break_springs`, which a tick ends with; no `part_bodies`,
# which building a level with cut bodies does; and no `soften`, by which levels and rules make a body soft.
KINDS = {
    "grab": KernelCommand(command.GRAB, (*_HAND, "particle"), ("target", "strength", "radius"), OF_HANDS),
    "move_grab": KernelCommand(command.MOVE_GRAB, _HAND, ("target", "tick_rate")),
    "release": KernelCommand(command.RELEASE, _HAND, (), OF_HANDS),
    "pin": KernelCommand(command.PIN, _PARTICLE, (), OF_TOPOLOGY),
    "unpin": KernelCommand(command.UNPIN, _PARTICLE, (), OF_TOPOLOGY),
    "cut_springs": KernelCommand(command.CUT, ("springs",), ("at", "rows"), OF_TOPOLOGY),
    "break_springs": KernelCommand(command.BREAK, ("springs",), (), OF_TOPOLOGY),
    "part_bodies": KernelCommand(command.PART, ("springs",), (), OF_TOPOLOGY),
    "set_coefficients": KernelCommand(
        command.SET_COEFFICIENTS,
        ("?material", "material", "?stiffness", "?damping", "duration", "materials"),
        ("stiffness", "damping"),
    ),
    "set_gravity": KernelCommand(command.SET_GRAVITY, ("duration",), ("gravity",)),
    # What may be left out and is a pair comes last.
    "set_air": KernelCommand(command.SET_AIR, ("?wind", "?drag", "duration"), ("drag", "wind")),
    "set_drive": KernelCommand(command.DRIVE, ("part",), ("value",)),
    "hold_key": KernelCommand(command.HOLD_KEY, ("key", "down")),
    "push": KernelCommand(command.PUSH, ("first_cursor",), ("position", "impulse", "outward", "radius")),
    "shake": KernelCommand(command.SHAKE, ("first_cursor",), ("acceleration", "tick_rate")),
    "set_inflation": KernelCommand(command.SET_INFLATION, ("body", "duration"), ("value",)),
    "scale_mass": KernelCommand(command.SCALE_MASS, _PARTICLE, ("factor",), OF_TOPOLOGY),
    "move_body": KernelCommand(command.MOVE_BODY, (*_PARTICLE, "at_rest"), ("by",)),
    "free": KernelCommand(command.FREE, _PARTICLE),
    "set_firmness": KernelCommand(
        command.SET_FIRMNESS, ("body", "?sag", "?hz", "?ratio", "duration"), ("sag", "hz", "ratio", "nearest")
    ),
    "soften": KernelCommand(
        command.SOFTEN, ("body", "whole", "way", "duration"), ("value", "second", "gravity", "nearest")
    ),
    "set_solver": KernelCommand(command.SET_SOLVER, _SOLVER, ("warm_start", "contacts"), OF_SOLVER),
}
# Kinds by their numbers, those that have kernels of their own too: rows of the family DEED.
CODES = {name: kind.code for name, kind in KINDS.items()} | {
    "remove": command.REMOVE,
    "add_particle": command.ADD_PARTICLE,
    "add_spring": command.ADD_SPRING,
    "add_body": command.ADD_BODY,
}
# Rows that a slot of that name is one of, and how many there are.
_ROWS: dict[str, tuple[str, Callable[[Any], int]]] = {
    "grab": (HANDS, lambda world: len(world.hand_strength)),
    "particle": (PARTICLES, lambda world: len(world.owner)),
    "springs": (SPRINGS, lambda world: len(world.law)),
    "constraints": (CONSTRAINTS, lambda world: len(world.constraint_kind)),
    "part": (PARTS, lambda world: len(world.actuator_value)),
    "material": ("materials", lambda world: len(world.material_names)),
    "key": (KEYS, lambda world: len(world.key_down)),
}
# What goes by words, as kernels have it.
CHOICES: dict[str, dict[str, int]] = {
    "solver": {name: place for place, name in enumerate(SOLVER_NAMES)},
    "substeps": {AUTO: 0},
}
_OF_DENIED = {
    NOT_ALLOWED: command.FORBIDDEN, SPENT: command.EXHAUSTED, UNTOUCHED: command.UNTOUCHABLE
}  # fmt: skip


class RefusedCommand(ValueError):
    """A command that is refused, as it cannot be carried out as things are, or hands may not give it.

    reason: see WORDS. field: what of the command it is about, and value: its slot. numbers: with answers.
    """

    def __init__(self, reason: int, field: str, value: Any, numbers: Sequence[float]) -> None:
        super().__init__(WORDS[reason].replace("{}", str(value), 1))
        self.reason, self.field, self.value, self.numbers = reason, field, value, numbers

    @classmethod
    def of_denied(cls, answer: int, field: str, value: Any) -> "RefusedCommand":
        """That of an answer of another kernel that asks, see DENIED."""
        return cls(_OF_DENIED[-answer // DENIED], field, value, ())


def carry_out(pointer: Any, giver: int, name: str, values: Mapping[str, Any], world: StateArrays) -> Floats:
    """Carry out a command of KINDS with these values of its fields; the numbers of the kernel's input, or answers.

    pointer: `world.lent`. Raises IndexError for a slot that is not there or not in use,
    ValueError for a number that is not finite or out of range, and RefusedCommand; nothing is changed then.
    """
    kind = KINDS[name]
    if kind.slots[0] in _LISTS:
        slots = whole_numbers(kind.slots[0], values[kind.slots[0]])
    else:
        slots = np.array([_packed(kind, each, values) for each in kind.slots], np.int64)
    numbers = numbers_of(name, values)
    arena = np.zeros(1, np.int64)
    while (result := command.command(pointer, arena, giver, kind.code, slots, numbers)) == NO_ARENA:
        arena = np.zeros(int(arena[0]), np.int64)
    if result < 0:
        raise _fault(kind, -result, values, numbers.tolist(), world)
    return numbers


def lets_hands(state: StateArrays, name: str) -> bool:
    """Whether the level lets hands give a command of CODES."""
    return not len(state.deed_refused) or not state.deed_refused[CODES[name]]


def check_fields(name: str, giver: int, values: Mapping[str, Any]) -> None:
    """Whether that is a command of KINDS and somebody who gives it, with all that it is told. Raises ValueError."""
    whole_from("giver", giver, 0, command.PROGRAM)
    if not isinstance(name, str) or name not in KINDS:
        raise ValueError(f"name {shown(name)}: there is no such command; there are {', '.join(KINDS)}")
    needed = {each.lstrip("?") for each in (*KINDS[name].slots, *KINDS[name].numbers)} - ANSWERS.keys() - _OF_WORLD
    needed -= _MAY_LACK
    if missing := sorted(needed - values.keys()):
        raise ValueError(f"{', '.join(missing)}: {name} needs a value")


def numbers_of(name: str, values: Mapping[str, Any]) -> Floats:
    """The numbers of a command of KINDS, checked. Raises ValueError."""
    kind = KINDS[name]
    return np.array([x for each in kind.numbers for x in _checked(kind, each, values)], np.float64)


def _checked(kind: KernelCommand, name: str, values: Mapping[str, Any]) -> tuple[float, ...]:
    """The checked numbers of a field of a command; none if it is left out. Raises ValueError."""
    if name in ANSWERS:
        return tuple(values.get(name, (0.0,) * ANSWERS[name]))
    if name == "at":
        shares = tuple(number("at", each, 0.0, 1.0) for each in listed("at", values.get("at", ())))
        if len(shares) not in (0, len(values["springs"])):
            raise ValueError(UNEQUAL.format(len(shares), len(values["springs"])))
        return shares
    value = values[name]
    if value is None and f"?{name}" in kind.slots:
        return (0.0,)
    if name in _PAIRS:
        return point(name, value)
    return (number(name, value, *(_VALUES.get(kind.code, ()) if name == "value" else _RANGES.get(name, ()))),)


def _packed(kind: KernelCommand, name: str, values: Mapping[str, Any]) -> int:
    if name[0] == "?":
        return int(values[name[1:]] is not None)
    value = values[name]
    if value is None and f"?{name}" in kind.slots:
        return 0
    if isinstance(value, str) and name in CHOICES:
        value = CHOICES[name].get(value, value)
    if name == "duration":
        return ticks(name, value)
    return int(value) if isinstance(value, bool) and name in _FLAGS else max(-1, min(whole(name, value), FARTHEST))


def _fault(
    kind: KernelCommand, result: int, values: Mapping[str, Any], numbers: Sequence[float], world: StateArrays
) -> Exception:
    """Why a command was refused, as the kernel said it."""
    reason, place = result % command.REASONS, result // command.REASONS
    is_list = kind.slots[0] in _LISTS
    beyond = place - (len(values[kind.slots[0]]) if is_list else len(kind.slots))
    if beyond >= 0:
        return ValueError(f"{', '.join(kind.numbers)} {list(numbers)}: finite numbers are needed")
    name = kind.slots[0 if is_list else place].lstrip("?")
    value = values[name][place] if is_list else values[name]
    if reason != command.BAD:
        return RefusedCommand(reason, name, value, numbers)
    if name not in _ROWS:
        return IndexError(f"{name} {value}: there is none, or it is out of range")
    rows, count = _ROWS[name][0], _ROWS[name][1](world)
    if 0 <= value < count:
        return IndexError(f"{name} {value}: it is not in use, or a hand's")
    return no_slot(name, value, rows, count)
