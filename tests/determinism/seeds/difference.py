"""The first bit in which a way differs from the reference, and how it is found and told."""

import struct
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.snapshot import Snapshot, canonical_bytes, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.world import World
from sandbox.session.compare.comparison import recorded_run
from sandbox.session.compare.divergence import Divergence, first_difference
from sandbox.session.replay.recording import Replay

Arrays = Mapping[str, NDArray[Any]]
_SIGN = 1 << 63


class Differs(Exception):
    """A way differs from the reference; says where."""

    def __init__(self, divergence: Divergence) -> None:
        super().__init__(str(divergence))
        self.divergence = divergence


@dataclass(frozen=True)
class Plant:
    """A fault of one ulp, put into a state array, by its name in files, at a row of it, after a tick."""

    tick: int
    array: str
    slot: int

    @classmethod
    def read(cls, text: str) -> "Plant":
        """Of TICK:ARRAY:SLOT. Raises ValueError for what is none, and for an array whose values are no numbers."""
        tick, array, slot = text.split(":")
        column = BY_STORED.get(array)
        if column is None or column.topology or column.dtype is not np.float64:
            raise ValueError(f"there is no array of numbers {array}")
        return cls(int(tick), array, int(slot))

    def place(self, world: World) -> NDArray[Any] | None:
        """The value (1,) that is to be another, None where this is another tick, or the array has not that row."""
        values = getattr(world, BY_STORED[self.array].name)
        if world.tick != self.tick or self.slot >= len(values):
            return None
        return values.reshape(len(values), -1)[self.slot, :1]

    def put(self, world: World) -> bool:
        """Change the value by one ulp; whether it was there."""
        value = self.place(world)
        if value is not None:
            value[:] = np.nextafter(value, np.inf)
        return value is not None


@dataclass(frozen=True)
class Difference:
    """A difference of one way from the reference: of which seed, in a run of how many ticks, and where."""

    seed: int
    way: str
    ticks: int
    divergence: Divergence

    def command(self, plant: str | None = None) -> str:
        """The command line that repeats just this; plant: the fault that was planted."""
        planted = f" --plant {plant}" if plant else ""
        program = "python -m tests.determinism.seeds"
        return f"{program} --first {self.seed} --seeds 1 --ticks {self.ticks} --ways {self.way}{planted}"

    def __str__(self) -> str:
        apart = ulps(self.divergence.expected, self.divergence.actual)
        counted = "" if apart is None else f", {apart:,} ulp apart"
        return f"seed {self.seed}, {self.way}: {self.divergence}{counted}"


class Watch:
    """Compares one run with a recording, tick by tick. checks: states compared; put: a fault was planted."""

    def __init__(self, replay: Replay, plant: Plant | None = None) -> None:
        self.replay = replay
        self.plant = plant
        self.checks = 0
        self.put = False

    def disturb(self, world: World) -> None:
        """Plant the fault, once."""
        if self.plant is not None and not self.put:
            self.put = self.plant.put(world)

    def is_due(self, first: int, last: int) -> bool:
        """Whether the fault is still to be planted after a tick, up to the last one."""
        return self.plant is not None and not self.put and first < self.plant.tick <= last

    def is_equal(self, world: World) -> bool:
        """Whether a world, perhaps with the fault that is planted now, has the recorded bits of its tick."""
        self.disturb(world)
        self.checks += 1
        return self.replay.hashes[world.tick].fits(state_hash(world))

    def see(self, world: World) -> None:
        """Compare a world with the recorded state of its tick. Raises Differs."""
        if not self.is_equal(world):
            raise Differs(first_bit(self.replay, world.tick, arrays_of(world)))


def arrays_of(world: World | Snapshot) -> Arrays:
    """The arrays of a state by their names in files."""
    return {stored: getattr(world, column.name) for stored, column in BY_STORED.items()}


def kept_arrays(world: World) -> Arrays:
    """Copies of the state arrays of a world."""
    return {stored: array.copy() for stored, array in arrays_of(world).items()}


def first_bit(replay: Replay, tick: int, arrays: Arrays) -> Divergence:
    """Where a state differs first, in the order of hashing, from the recorded one of its tick."""
    expected = recorded_run(replay, tick)
    if expected is None:
        return Divergence(
            tick, "hash", None, replay.hashes[tick].whole, "unknown", note="the reference is not repeated"
        )
    found = first_of_two(arrays, expected.world)
    return replace(found, expected=found.actual, actual=found.expected)


def first_of_two(expected: Arrays, world: World) -> Divergence:
    """Where a world differs first, in the order of hashing, from other arrays."""
    for name, column in BY_STORED.items():
        if canonical_bytes(expected[name]) != canonical_bytes(getattr(world, column.name)):
            return first_difference(world.tick, name, expected[name], world)
    return Divergence(world.tick, "settings", None, "equal arrays", "equal arrays")


def ulps(expected: Any, actual: Any) -> int | None:
    """How many numbers of 64 bits lie between two, with the second; None where they are no finite numbers."""
    if not (isinstance(expected, float) and isinstance(actual, float) and np.isfinite([expected, actual]).all()):
        return None
    return abs(_rank(expected) - _rank(actual))


def _rank(value: float) -> int:
    """The place of a number among all of 64 bits."""
    bits: int = struct.unpack("<Q", struct.pack("<d", value))[0]
    return _SIGN - bits if bits & _SIGN else bits
