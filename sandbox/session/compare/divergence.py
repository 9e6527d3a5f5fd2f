"""The first bit in which two states differ: where it is, whose value, and how that is reported."""

import hashlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.analysis.query import row_names, slot_name
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import Snapshot, array_hash, canonical_bytes
from sandbox.physics.state import BY_STORED, OF_RULES, Family
from sandbox.physics.world import World
from sandbox.session.probe import ADDED

# What holds a hand is named by this and the hand's number.
HAND = "+hand"
# Bodies whose counts are told, and rules that one of two worlds has alone, at most.
MOST_COUNTED = 4


@dataclass(frozen=True)
class Divergence:
    """The first difference between a recording and its verification.

    array: a state array, or `settings`; index: into that array, an int or (slot, component), None where the array's
    length differs; name: of the particle or spring; note: what else there is to know. seen: the tick at which index and
    values were seen, where those of `tick` itself are not known.
    """

    tick: int
    array: str
    index: int | tuple[int, int] | None
    expected: Any
    actual: Any
    name: str = ""
    note: str = ""
    seen: int | None = None

    def __str__(self) -> str:
        name = f" ({self.name})" if self.name else ""
        note = f"; {self.note}" if self.note else ""
        place = f"{self.array}{self.place}{name}"
        if self.seen is not None:
            place = f"{self.array}; {self._elsewhere}{place}"
        return f"tick {self.tick}: {place}: expected {_plain(self.expected)}, got {_plain(self.actual)}{note}"

    @property
    def _elsewhere(self) -> str:
        """The tick at which index and values were seen, if not that of the difference."""
        return f"at the next stored state, tick {self.seen}: "

    @property
    def place(self) -> str:
        """The index in brackets, or nothing."""
        return "" if self.index is None else str(list(np.atleast_1d(self.index).tolist()))

    def owner(self) -> str:
        """Whose value it is: body and particle or spring by number, where the name says them; else the name."""
        family = BY_STORED[self.array].family if self.array in BY_STORED else None
        match family:
            case Family.PARTICLE | Family.SPRING:
                return _owner_of(self.name)
            case Family.CONSTRAINT | Family.CORNER:
                kind, _, name = self.name.partition(" at ")
            case Family.CONTACT:
                kind, _, name = self.name.partition(" of ")
            case Family.ACTUATOR | Family.HAND | Family.SETTING | None:
                return self.name
            case Family.RULE | Family.COUNTER | Family.PROBE | Family.STILL | Family.KEY | Family.DEED:
                return self.name
            case _:
                assert_never(family)
        return f"{kind} of {_owner_of(name)}"

    def lines(self, expected: str = "expected", actual: str = "actual") -> list[str]:
        """All that is known, a line each: place, owner, both values in decimal and hexadecimal, and the note."""
        wide = max(len(expected), len(actual))
        shown = [(expected, self.expected), (actual, self.actual)]
        first = f"first difference at tick {self.tick}, in {self.array}"
        return [
            *([f"{first}{self.place}"] if self.seen is None else [first, f"{self._elsewhere}{self.array}{self.place}"]),
            *([f"of {self.owner()}"] if self.name else []),
            *(f"{side:<{wide}}  {number_text(value)}" for side, value in shown),
            *([self.note] if self.note else []),
        ]


def _plain(value: Any) -> str:
    """A value in decimal; words as they are."""
    return value if isinstance(value, str) else repr(value)


def _owner_of(name: str) -> str:
    """A particle or spring in words, by its name; what joined a running world is called "added"."""
    if not name:
        return name
    for sign, kind in ((".", "particle"), (":", "spring")):
        body, found, number = name.partition(sign)
        if not found:
            continue
        if body == HAND:
            return f"hand {number}"
        if body.startswith(ADDED):
            body = body.removeprefix(ADDED)
            return f"added body {body}, {kind} {number}" if body else f"added {kind} {number}"
        return f"body {body}, {kind} {number}" if body else f"loose {kind} {number}"
    return f"particle {name}"


def number_text(value: Any) -> str:
    """A value in decimal and, where it is a float, in hexadecimal, which shows every bit."""
    if isinstance(value, float):
        return f"{value!r}  {value.hex()}"
    return f"{value}  {value:#x}" if type(value) is int else str(value)


def first_divergence(expected: World | Snapshot, world: World) -> Divergence | None:
    """The first bit, in the order of hashing, in which a world differs from an expected state; None where none does.

    What the two have of arrays that are as usual, and so in no hash, is no difference.
    """
    for stored, column in BY_STORED.items():
        there, found = getattr(expected, column.name), getattr(world, column.name)
        if there.tobytes() == found.tobytes() or canonical_bytes(there) == canonical_bytes(found):
            continue
        if array_hash(column, there) != array_hash(column, found):
            known = expected if isinstance(expected, World) else None
            return first_difference(world.tick, stored, there, world, known)
    return settings_difference(world.tick, expected.settings, world.settings)


def settings_difference(tick: int, before: WorldSettings, found: WorldSettings) -> Divergence | None:
    """The settings in which two worlds differ, by name; None where they are equal."""
    names = [each.name for each in fields(WorldSettings) if getattr(before, each.name) != getattr(found, each.name)]
    if not names:
        return None
    expected, actual = (
        ", ".join(f"{name} {_setting_text(getattr(side, name))}" for name in names) for side in (before, found)
    )
    return Divergence(tick, "settings", None, expected, actual)


def _setting_text(value: Any) -> str:
    return str(list(value)) if isinstance(value, tuple) else f"{value:g}" if isinstance(value, float) else str(value)


def _other_rows(family: Family, known: World, found: World) -> str:
    """The rules, or else the bodies, that one of two worlds has alone and that rows of a family belong to."""
    if family not in OF_RULES:
        return counts_by_body(known, found)
    rows: list[str] = []
    # What a rule follows comes and goes with it.
    for each in (Family.RULE, family) if family in (Family.PROBE, Family.STILL) else (family,):
        before, after = (Counter(row_names(side, each)) for side in (known, found))
        rows = rows or [*(f"{name} is gone" for name in before - after), *(f"{name} is new" for name in after - before)]
    return _first_of(rows)


def counts_by_body(known: World, found: World) -> str:
    """The bodies that have other counts of particles or springs in two worlds: "cable: 17 -> 16 particles"."""
    lines = []
    for kind, sign, names in (
        ("particles", ".", [side.particle_names for side in (known, found)]),
        ("springs", ":", [side.spring_names for side in (known, found)]),
    ):
        before, after = (Counter(name.rpartition(sign)[0] for name in each) for each in names)
        lines += [
            f"{body or 'loose'}: {before[body]} -> {after[body]} {kind}"
            for body in {**before, **after}
            if before[body] != after[body] and body != HAND
        ]
    return _first_of(lines)


def _first_of(lines: Sequence[str]) -> str:
    more = len(lines) - MOST_COUNTED
    return ", ".join(lines[:MOST_COUNTED]) + (f" and {more} more" if more > 0 else "")


def first_difference(
    tick: int, array: str, known: NDArray[Any], world: World, expected: World | None = None
) -> Divergence:
    """The first bit of an array, by its name in files, in which a world differs from the expected values.

    expected: the world that has them, where there is one.
    """
    column = BY_STORED[array]
    found: NDArray[Any] = getattr(world, column.name)
    if len(known) != len(found):
        note = "" if expected is None else _other_rows(column.family, expected, world)
        return Divergence(tick, array, None, f"{len(known)} values", f"{len(found)} values", note=note)
    size = found.dtype.itemsize
    left, right = (np.frombuffer(canonical_bytes(side), dtype=f"V{size}") for side in (known, found))
    different = np.flatnonzero(left != right)
    if not len(different):
        return Divergence(tick, array, None, "equal", "equal", note="the two runs agree here")
    place = tuple(int(part) for part in np.unravel_index(different[0], found.shape))
    index = place[0] if len(place) == 1 else (place[0], place[1])
    name = slot_name(world, array, place[0])
    there = name if expected is None else slot_name(expected, array, place[0])
    note = "" if there == name else f"what is expected is of {there}"
    return Divergence(tick, array, index, known[place].item(), found[place].item(), name, note)


def differing_particle(divergence: Divergence, state: Snapshot) -> int | None:
    """The slot of the particle that a divergence is about, or of an end of its spring."""
    column = BY_STORED.get(divergence.array)
    if column is None or divergence.index is None:
        return None
    slot = int(np.atleast_1d(divergence.index)[0])
    match column.family:
        case Family.PARTICLE:
            return slot
        case Family.SPRING:
            owners = state.particle_a
        case Family.CONTACT:
            owners = state.contact_particle
        case Family.CORNER:
            owners = state.corner_particle
        case Family.CONSTRAINT:
            owners = state.corner_particle[state.constraint_first]
        case Family.ACTUATOR | Family.HAND | Family.SETTING:
            return None
        case Family.RULE | Family.COUNTER | Family.PROBE | Family.STILL | Family.KEY | Family.DEED:
            return None
        case _:
            assert_never(column.family)
    return int(owners[slot]) if slot < len(owners) else None


# Bytes that are hashed before it is given up: a second or two.
_MOST_WORK = 1_500_000_000
# Neighbours of a number that are tried, in units of its last place.
_NEIGHBOURS = 8


def array_of_hash(found: NDArray[Any], fits: Callable[[str], bool]) -> NDArray[Any] | None:
    """The array that differs from the one found in a single number, by a few last places or in one bit; else None.

    fits: whether an array whose hash has these digits (see `hash_by_array`) is the recorded one.
    """
    data, size = canonical_bytes(found), found.dtype.itemsize
    numbers = np.frombuffer(data, dtype=f"<u{size}")
    work = 0
    for change in _likely_changes(8 * size):
        changed = change(numbers)
        before = hashlib.blake2b(digest_size=8)
        for place, number in enumerate(changed):
            end = (place + 1) * size
            attempt = before.copy()
            attempt.update(number.tobytes() + data[end:])
            if fits(attempt.hexdigest()):
                tried = numbers.copy()
                tried[place] = number
                return tried.view(found.dtype.newbyteorder("<")).astype(found.dtype).reshape(found.shape)
            before.update(data[end - size : end])
            work += len(data) - end + size
            if work > _MOST_WORK:
                return None
    return None


def _likely_changes(bits: int) -> Iterator[Callable[[NDArray[Any]], NDArray[Any]]]:
    """Ways in which numbers of this many bits, read as unsigned, may have changed, the likeliest first."""

    def moved(step: int) -> Callable[[NDArray[Any]], NDArray[Any]]:
        return lambda numbers: numbers + numbers.dtype.type(step % 2**bits)

    def flipped(bit: int) -> Callable[[NDArray[Any]], NDArray[Any]]:
        return lambda numbers: numbers ^ numbers.dtype.type(1 << bit)

    yield moved(1)
    yield moved(-1)
    yield from (flipped(bit) for bit in range(bits))
    yield from (moved(sign * step) for step in range(2, _NEIGHBOURS + 1) for sign in (1, -1))
