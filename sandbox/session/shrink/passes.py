"""Passes: how a play is made smaller, each by candidates that are tried in order.

The methods are those of delta debugging (Zeller and Hildebrandt 2002) and of Hypothesis' shrinker (MacIver and
Donaldson 2020): parts are taken out in large pieces first, then in halves, then one by one, from the end on, as what
comes later rests on what comes before; all passes are repeated until none finds anything.

A pass is a generator. It gives candidates; it is sent the place of the first that fails as the play did, with what came
of it, or None where none does.
"""

import itertools
import json
from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from functools import cached_property
from typing import Any

from sandbox.session.commands import COMMAND_TYPES, Redo, Undo
from sandbox.session.commands.records import ScriptLine

_ABOUT_COMMANDS = (Undo.type, Redo.type)
# What times are rounded to [ticks], the coarsest first.
ROUND_TICKS = (60, 30, 10, 5)
# Digits behind the point that places are rounded to, two are centimetres; and digits in all of other numbers.
DECIMALS, SIGNIFICANT = (0, 1, 2), (1, 2, 3)
# Fields of commands that are places [m].
PLACES = ("target", "position", "by")
# A run with rounder numbers may last longer by so much before it fails: by a part, and by so many ticks.
LONGER_PART, LONGER_TICKS = 0.1, 10
# Shares of an idle time that are left of it, the smallest first; and from how many ticks on one is long.
LEFT_OF_IDLE, LONG_IDLE = (0.0, 0.5, 0.75, 0.875, 0.94, 0.97), 20
# Where less than this share of an idle time goes, it is left as it is.
LITTLE = 0.1
# Of lists in commands those entries are taken out that are names.
_NAMES = str


@dataclass(frozen=True)
class Play:
    """Commands by their ticks, in order, and how many ticks the run has; of what is done at its end nothing is seen."""

    lines: tuple[ScriptLine, ...]
    ticks: int

    @cached_property
    def key(self) -> str:
        """Key that two plays share in which the same is done."""
        lines = [[line.tick, line.gesture, line.record] for line in self.lines]
        return json.dumps([self.ticks, lines], sort_keys=True)

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
        """Whether the play undoes or redoes anything."""
        return any(line.record.get("type") in _ABOUT_COMMANDS for line in self.lines)

    def without_gestures(self, gestures: Collection[int]) -> "Play":
        """The play without some gestures."""
        return replace(self, lines=tuple(line for line in self.lines if line.gesture not in gestures))

    def without_lines(self, places: Collection[int]) -> "Play":
        """The play without some commands, by their places."""
        return replace(self, lines=tuple(line for place, line in enumerate(self.lines) if place not in places))

    def without_ticks(self, first: int, count: int) -> "Play":
        """The play without some ticks: their commands move to the first of them, later ones come that much earlier."""

        def moved(tick: int) -> int:
            return tick if tick < first else max(first, tick - count)

        return self.at_ticks({line.tick: moved(line.tick) for line in self.lines}, self.ticks - count)

    def at_ticks(self, ticks: Mapping[int, int], end: int | None = None) -> "Play":
        """The play at other ticks, in the same order; end: how many ticks the run has then."""
        lines = tuple(replace(line, tick=ticks.get(line.tick, line.tick)) for line in self.lines)
        return Play(tuple(sorted(lines, key=lambda line: line.tick)), self.ticks if end is None else end)

    def with_record(self, place: int, record: dict[str, Any]) -> "Play":
        """The play with another command at a place."""
        return replace(
            self, lines=(*self.lines[:place], replace(self.lines[place], record=record), *self.lines[place + 1 :])
        )

    def parting(self, other: "Play") -> int | None:
        """The first tick before which two plays differ; None: all of the shorter is in both."""
        for ours, theirs in zip(self.lines, other.lines, strict=False):
            if (ours.tick, ours.gesture, ours.record) != (theirs.tick, theirs.gesture, theirs.record):
                return min(ours.tick, theirs.tick)
        shorter = min(len(self.lines), len(other.lines))
        rest = [*self.lines[shorter : shorter + 1], *other.lines[shorter : shorter + 1]]
        return rest[0].tick if rest else None

    def counts(self) -> str:
        """The size of the play, in words."""
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
    """A count with its noun."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


Answer = tuple[int, Play] | None


Pass = Callable[[Play], Generator[Iterable[Play], Answer, None]]


def last_gestures(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Only the last gestures: none, one, two, four and so on. What goes wrong has often just been done."""
    counts = [0, *(2**power for power in range(len(play.gestures).bit_length()))]
    gestures = play.gestures
    yield [play.without_gestures(set(gestures[: len(gestures) - count])) for count in counts if count < len(gestures)]


def history(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try to leave out what was undone in the end and all undoing; then each undo with the gesture that it undid."""
    about = {line.gesture for line in play.lines if line.record.get("type") in (Undo.type, Redo.type)}
    if not about:
        return
    undone = _undone(play)
    answer = yield [play.without_gestures(about | undone), play.without_gestures(about)]
    if answer is None:
        yield [play.without_gestures(pair) for pair in _pairs(play)]


def _undone(play: Play) -> set[int]:
    """The gestures that are undone at the end, if each undo takes back the one before it."""
    done: list[int] = []
    undone: list[int] = []
    for gesture in play.gestures:
        kind = next(line.record.get("type") for line in play.lines if line.gesture == gesture)
        if kind == Undo.type:
            undone += [done.pop()] if done else []
        elif kind == Redo.type:
            done += [undone.pop()] if undone else []
        else:
            done.append(gesture)
    return set(undone)


def _pairs(play: Play) -> Iterator[set[int]]:
    """Neighbours in order, of which the second undoes or redoes."""
    kinds = {line.gesture: line.record.get("type") for line in play.lines}
    for first, second in itertools.pairwise(play.gestures):
        if kinds[second] in (Undo.type, Redo.type):
            yield {first, second}


def gestures_out(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try to leave out gestures: a grab with its moves and its release is one."""
    yield from _taken_out(play, lambda play: play.gestures, lambda play, gestures: play.without_gestures(gestures))


def commands_out(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try to leave out commands: moves of a hand become fewer, and what was held is held to the end."""
    yield from _taken_out(play, lambda play: range(len(play.lines)), lambda play, places: play.without_lines(places))


def _taken_out(
    play: Play,
    parts_of: Callable[[Play], Sequence[int]],
    without: Callable[[Play, Collection[int]], Play],
) -> Generator[Iterable[Play], Answer, None]:
    """Try to leave out parts, `size` at a time from the end to the beginning; size is halved down to 1."""
    size = max(1, len(parts_of(play)))
    while True:
        end = len(parts_of(play))
        while end > 0:
            parts, ends = parts_of(play), range(end, 0, -size)
            answer = yield (without(play, set(parts[max(0, last - size) : last])) for last in ends)
            if answer is None:
                break
            place, play = answer
            end = min(ends[place] - size, len(parts_of(play)))
        if size == 1:
            return
        size = min(size // 2, max(1, len(parts_of(play))))


def moves_joined(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try to leave out moves of a hand: the command before takes it there."""
    place = len(play.lines) - 1
    while place > 0:
        answer = yield [joined for joined in [_joined(play, place)] if joined is not None]
        play = play if answer is None else answer[1]
        place = min(place, len(play.lines)) - 1


def _joined(play: Play, place: int) -> Play | None:
    line = play.lines[place]
    for before in reversed(range(place)):
        other = play.lines[before]
        if other.gesture == line.gesture and "target" in other.record and "target" in line.record:
            moved = play.with_record(before, {**other.record, "target": line.record["target"]})
            return moved.without_lines({place})
    return None


def long_idle_out(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try to shorten long times without commands: all other plays are shorter then."""
    yield from _idle_out(play, LONG_IDLE)


def idle_out(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try to shorten every time without commands."""
    yield from _idle_out(play, 1)


def _idle_out(play: Play, least: int) -> Generator[Iterable[Play], Answer, None]:
    """The longest gap first. A gap is known by its place from the end, as those before it may go."""
    tried: set[int] = set()
    while True:
        ticks = sorted({0, *(line.tick for line in play.lines), play.ticks}, reverse=True)
        gaps = [(end - first, place) for place, (end, first) in enumerate(itertools.pairwise(ticks))]
        length, place = max((gap for gap in gaps if gap[1] not in tried), default=(0, 0))
        if length < least:
            return
        counts = dict.fromkeys(max(1, length - round(fraction * length)) for fraction in LEFT_OF_IDLE)
        answer = yield [play.without_ticks(ticks[place + 1], count) for count in counts]
        if answer is None:
            tried.add(place)
            continue
        if answer[1].ticks < play.ticks - length or len(answer[1].lines) < len(play.lines):
            # It fails earlier now: gaps behind that are gone.
            tried.clear()
        elif play.ticks - answer[1].ticks < LITTLE * length:
            # More would go, little by little: that is not worth the runs.
            tried.add(place)
        play = answer[1]


def ticks_round(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try rounder ticks: for all commands, then for each tick that has any."""
    answer = yield [play.at_ticks({line.tick: _floor(line.tick, to) for line in play.lines}) for to in ROUND_TICKS]
    if answer is not None:
        play = answer[1]
    place = 0
    while place < len(ticks := sorted({line.tick for line in play.lines})):
        tick = ticks[place]
        earlier = ticks[place - 1] if place else 0
        rounded = dict.fromkeys(_floor(tick, to) for to in ROUND_TICKS)
        answer = yield [play.at_ticks({tick: max(each, earlier)}) for each in rounded if each != tick]
        play = play if answer is None else answer[1]
        place += 1


def _floor(tick: int, to: int) -> int:
    return tick // to * to


def numbers_round(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try rounder numbers: first all of them, then each."""
    answer = yield [_longer(_all_rounded(play, level)) for level in range(len(DECIMALS))]
    play = play if answer is None else answer[1]
    place = 0
    while place < len(play.lines):
        for path in list(_numbers(play.lines[place].record)):
            record = play.lines[place].record
            value = _at(record, path)
            rounder = simpler(value, path[0] in PLACES)
            answer = yield [_longer(play.with_record(place, _with(record, path, each))) for each in rounder]
            if answer is not None:
                lines, play = len(play.lines), answer[1]
                if len(play.lines) != lines:
                    break
        place += 1


def fields_out(play: Play) -> Generator[Iterable[Play], Answer, None]:
    """Try to leave out optional fields of commands, and some of the names in their lists."""
    for place in reversed(range(len(play.lines))):
        for name in _optional(play.lines[place].record) if place < len(play.lines) else ():
            record = play.lines[place].record
            answer = yield [play.with_record(place, {key: each for key, each in record.items() if key != name})]
            if answer is not None and len(answer[1].lines) != len(play.lines):
                return
            play = play if answer is None else answer[1]
        if place < len(play.lines):
            play = yield from _names_out(play, place)


def _names_out(play: Play, place: int) -> Generator[Iterable[Play], Answer, Play]:
    """The play without some of the names in the lists of a command."""
    for field, listed in play.lines[place].record.items():
        if not isinstance(listed, list) or not all(isinstance(each, _NAMES) for each in listed):
            continue
        size = len(listed)
        while size >= 1 and len(listed) > 1:
            pieces = [listed[:k] + listed[k + size :] for k in range(0, len(listed), size)]
            record = play.lines[place].record
            answer = yield [play.with_record(place, {**record, field: piece}) for piece in pieces if piece]
            if answer is None:
                size //= 2
                continue
            if len(answer[1].lines) != len(play.lines):
                return answer[1]
            play = answer[1]
            listed = play.lines[place].record[field]
            size = min(size, len(listed) - 1)
    return play


def _longer(play: Play) -> Play:
    """The play in a run that may last a little longer."""
    return play.at_ticks({}, play.ticks + int(LONGER_PART * play.ticks) + LONGER_TICKS)


def _all_rounded(play: Play, level: int) -> Play:
    """The play with every number rounded as the entry `level` of its roundings says."""
    for place, line in enumerate(play.lines):
        record = line.record
        for path in _numbers(record):
            value = _at(record, path)
            rounded = _roundings(value, path[0] in PLACES)[level]
            if _digits(rounded) < _digits(value):
                record = _with(record, path, rounded)
        play = play.with_record(place, record)
    return play


def simpler(value: float, is_place: bool) -> list[float]:
    """Rounder numbers near a number, the roundest first; is_place: by digits behind the point, else by digits in
    all. A whole number stays one.
    """
    return [each for each in dict.fromkeys(_roundings(value, is_place)) if _digits(each) < _digits(value)]


def _roundings(value: float, is_place: bool) -> list[float]:
    if isinstance(value, int):
        return [int(float(f"{value:.{digits}g}")) for digits in SIGNIFICANT]
    if is_place:
        return [round(value, decimals) for decimals in DECIMALS]
    return [float(f"{value:.{digits}g}") for digits in SIGNIFICANT]


def _digits(value: float) -> int:
    return len(short_json(value))


Path = tuple[str | int, ...]


def _numbers(record: dict[str, Any]) -> Iterator[Path]:
    """Where numbers stand in a record: in its fields, and in those that are lists of numbers."""
    for name, value in record.items():
        if _is_number(value):
            yield (name,)
        elif isinstance(value, list) and all(map(_is_number, value)):
            yield from ((name, place) for place in range(len(value)))


def _is_number(value: Any) -> bool:
    return type(value) in (int, float)


def _at(record: dict[str, Any], path: Path) -> Any:
    value: Any = record
    for part in path:
        value = value[part]
    return value


def _with(record: dict[str, Any], path: Path, value: float) -> dict[str, Any]:
    name = path[0]
    if len(path) == 1:
        return {**record, str(name): value}
    listed = list(record[str(name)])
    listed[int(path[1])] = value
    return {**record, str(name): listed}


def _optional(record: dict[str, Any]) -> list[str]:
    """The fields of a record that may be left out."""
    kind = COMMAND_TYPES.get(str(record.get("type")))
    described = fields(kind) if kind is not None else ()  # type: ignore[arg-type]
    return [each.name for each in described if each.name in record and each.default is not MISSING]


# In this order; those first that make the runs shorter that the others try.
SHORTER: tuple[Pass, ...] = (
    history, last_gestures, gestures_out, long_idle_out, commands_out, moves_joined, idle_out,
)  # fmt: skip


# Of what is as short as it gets.
ROUNDER: tuple[Pass, ...] = (fields_out, numbers_round, ticks_round)
