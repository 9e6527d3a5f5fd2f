"""Recorded: what of a recording a page plays, for its own kernels: slots in place of names, and what they cannot do."""

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.page.about import SETTING_ARRAYS, array_path, is_done_by_pages
from sandbox.page.room import Counts, row_counts
from sandbox.physics.snapshot import Snapshot, state_hash, take
from sandbox.physics.state import COLUMNS
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.session.actions import RuleActions
from sandbox.session.commands import CommandError, Redo, Undo, apply
from sandbox.session.commands.records import ScriptLine, from_record, script_of
from sandbox.session.replay.format import TICK_DIGITS
from sandbox.session.session import Session

T = TypeVar("T")
# What else pages are told of a command that no kernel carries out: of the rows there were before it, and the world now.
Beside = Callable[[Counts, World], dict[str, Any]]


class Recorded(NamedTuple):
    """Commands in order, as a page carries them out, and as lines; the hash of each tick, and the world at the end."""

    commands: list[dict[str, Any]]
    script: Sequence[ScriptLine]
    hashes: list[str]
    world: World


def all_at_once(slices: Generator[float, None, T]) -> T:
    """What work in slices comes to."""
    while True:
        try:
            next(slices)
        except StopIteration as end:
            made: T = end.value
            return made


def nothing_beside(counts: Counts, world: World) -> dict[str, Any]:
    """Nothing more: for a page whose world has all that joins from its start."""
    return {}


def tick_hash(world: World) -> str:
    """What a page compares a tick with."""
    return state_hash(world)[:TICK_DIGITS]


def recorded(
    level: Level,
    script: Sequence[ScriptLine],
    ticks: int,
    beside: Beside = nothing_beside,
    hash_of: Callable[[World], str] = tick_hash,
) -> Generator[float, None, Recorded]:
    """What a page plays of a recording, a slice of the work at a time: each gives the part that is done, 0..1.

    Commands that were undone are left out. Raises CommandError, also where nothing was there at first: hands get their
    slots when they first hold something then.
    """
    begun = 0.0

    def part(tick: int) -> float:
        return begun + (1.0 - begun) * tick / ticks

    if any(line.record["type"] in (Undo.type, Redo.type) for line in script):
        # It is run twice.
        begun = 0.5
        script = yield from _without_undone(level, script, ticks)
    world, commands = build_world(level), []
    if script and world.grab_particle < 0:
        raise CommandError("a page cannot play a recording that begins with nothing")
    hashes, actions = [hash_of(world)], RuleActions(level, world)

    def stepped(tick: int) -> Iterator[int]:
        while world.tick < tick:
            actions.act(world)
            step(world)
            hashes.append(hash_of(world))
            yield world.tick

    for line in script:
        yield from map(part, stepped(line.tick))
        try:
            commands.append(_carried_out(world, line, beside))
        except CommandError as error:
            raise CommandError(f"line {line.line}: {error}") from None
    yield from map(part, stepped(ticks))
    return Recorded(commands, script, hashes, world)


def _without_undone(
    level: Level, script: Sequence[ScriptLine], ticks: int
) -> Generator[float, None, tuple[ScriptLine, ...]]:
    session = Session(level, script)
    while session.tick < ticks:
        session.advance()
        yield 0.5 * session.tick / ticks
    session.apply_pending()
    return script_of([entry for entry in session.history.timeline if entry.in_effect], session.world)


def _carried_out(world: World, line: ScriptLine, beside: Beside) -> dict[str, Any]:
    """Carry out a command of a recording; it as a page reads it, with all that it changed where no kernel does it."""
    command, entry = from_record(line.record, world), {"tick": line.tick, "gesture": line.gesture}
    if is_done_by_pages(command.type):
        apply(world, command)
        return entry | {"record": {"type": command.type, **asdict(command)}}  # type: ignore[call-overload]
    before, counts = take(world), row_counts(world)
    apply(world, command)
    changes, present = _changes(before, world), row_counts(world)
    grown = {"counts": present, **beside(counts, world)} if present != counts else {}
    return entry | {"record": line.record, "changes": changes} | grown


def _changes(before: Snapshot, world: World) -> dict[str, list[list[Any]]]:
    """By the path of an array, runs of its rows that are other ones now: the first, how many, and what each holds."""
    pairs = {array_path(column): (getattr(before, column.name), getattr(world, column.name)) for column in COLUMNS}
    for name in SETTING_ARRAYS:
        pairs[name] = np.array(getattr(before.settings, name)), np.array(getattr(world.settings, name))
    found = {path: _runs(past, present) for path, (past, present) in pairs.items()}
    return {path: runs for path, runs in found.items() if runs}


def _runs(past: NDArray[Any], present: NDArray[Any]) -> list[list[Any]]:
    if not len(present):
        return []
    # By their bits: 0 and -0 differ.
    rows, bits, kept = present.reshape(len(present), -1), _bytes(present), len(past)
    other = np.flatnonzero((_bytes(past) != bits[:kept]).any(axis=1)) if kept else np.zeros(0, np.int64)
    runs: list[list[Any]] = []
    for slot in [*other.tolist(), *range(kept, len(present))]:
        if runs and slot == sum(runs[-1][:2]) and (bits[slot] == bits[slot - 1]).all():
            runs[-1][1] += 1
            continue
        row = rows[slot].tolist()
        # JavaScript reads a long number as a float.
        runs.append([slot, 1, *(map(str, row) if present.dtype == np.int64 else row)])
    return runs


def _bytes(array: NDArray[Any]) -> NDArray[np.uint8]:
    return np.ascontiguousarray(array).view(np.uint8).reshape(len(array), -1)
