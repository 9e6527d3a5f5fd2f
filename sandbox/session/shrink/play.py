"""Play: what is done in a run, as a value of which smaller ones are made."""

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from sandbox.session.commands import Redo, Undo
from sandbox.session.commands.records import ScriptLine

_ABOUT_COMMANDS = (Undo.type, Redo.type)


@dataclass(frozen=True)
class Play:
    """Commands by their ticks, in order, and how many ticks the run has; of what is done at its end nothing is seen."""

    lines: tuple[ScriptLine, ...]
    ticks: int

    @cached_property
    def key(self) -> str:
        """The same for two plays in which the same is done."""
        told = [[line.tick, line.gesture, line.record] for line in self.lines]
        return json.dumps([self.ticks, told], sort_keys=True)

    @cached_property
    def gestures(self) -> tuple[int, ...]:
        """The gestures, by the order of their first commands."""
        return tuple(dict.fromkeys(line.gesture for line in self.lines))

    @cached_property
    def size(self) -> tuple[int, int, int, int, int]:
        """The smaller, the better: gestures, commands, digits in these, ticks, digits of the commands' ticks."""
        records = sum(len(short_json(line.record)) for line in self.lines)
        digits = sum(len(str(line.tick).rstrip("0")) for line in self.lines)
        return len(self.gestures), len(self.lines), records, self.ticks, digits

    @property
    def is_about_commands(self) -> bool:
        """Whether it undoes or redoes anything."""
        return any(line.record.get("type") in _ABOUT_COMMANDS for line in self.lines)

    def without_gestures(self, gestures: Collection[int]) -> "Play":
        """The same without some gestures."""
        return replace(self, lines=tuple(line for line in self.lines if line.gesture not in gestures))

    def without_lines(self, places: Collection[int]) -> "Play":
        """The same without some commands, by their places."""
        return replace(self, lines=tuple(line for place, line in enumerate(self.lines) if place not in places))

    def without_ticks(self, first: int, count: int) -> "Play":
        """The same without some ticks: what is done in them is done at the first, what follows that much earlier."""

        def moved(tick: int) -> int:
            return tick if tick < first else max(first, tick - count)

        return self.at_ticks({line.tick: moved(line.tick) for line in self.lines}, self.ticks - count)

    def at_ticks(self, ticks: Mapping[int, int], end: int | None = None) -> "Play":
        """The same at other ticks, in the same order; end: how many ticks the run has then."""
        lines = tuple(replace(line, tick=ticks.get(line.tick, line.tick)) for line in self.lines)
        return Play(tuple(sorted(lines, key=lambda line: line.tick)), self.ticks if end is None else end)

    def with_record(self, place: int, record: dict[str, Any]) -> "Play":
        """The same with another command at a place."""
        return replace(
            self, lines=(*self.lines[:place], replace(self.lines[place], record=record), *self.lines[place + 1 :])
        )

    def parting(self, other: "Play") -> int | None:
        """The first tick before which something else is done in another; None: all of the shorter is in both."""
        for ours, theirs in zip(self.lines, other.lines, strict=False):
            if (ours.tick, ours.gesture, ours.record) != (theirs.tick, theirs.gesture, theirs.record):
                return min(ours.tick, theirs.tick)
        shorter = min(len(self.lines), len(other.lines))
        rest = [*self.lines[shorter : shorter + 1], *other.lines[shorter : shorter + 1]]
        return rest[0].tick if rest else None

    def counts(self) -> str:
        """How large it is, for a person."""
        gestures, commands, _, ticks, _ = self.size
        return f"{counted(gestures, 'gesture')}, {counted(commands, 'command')}, {counted(ticks, 'tick')}"


def short_json(record: Any) -> str:
    """A record as it is counted and shown: whole numbers without a point."""
    return json.dumps(_whole(record))


def _whole(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _whole(each) for name, each in value.items()}
    if isinstance(value, list):
        return [_whole(each) for each in value]
    return int(value) if isinstance(value, float) and value == int(value) and abs(value) < 1e15 else value


def counted(count: int, noun: str) -> str:
    """So many of something."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"
