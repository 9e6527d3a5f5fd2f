"""Packing: commands as short lists for links, and back to the very bits.

    [ticks since the one before, gesture, record]       a command
    [[ticks...], [hands...], [x...], [y...]]            moves of hands, one after another

Moves of a hand belong to the gesture of its last grab. Their places are whole millimetres, as differences to the place
before of the same hand; a move to another place, or of another gesture, is a command as all others.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from sandbox.session.commands.records import ScriptLine

# Places of moves are packed in units of which a metre has this many.
PER_METRE = 1000
# A script holds no more commands, and a run no more ticks.
COMMAND_LIMIT, TICK_LIMIT = 200_000, 2**31
HANDS = 10
_COLUMNS = 4
# Places of moves are no farther out [mm].
FARTHEST = 2**39
MOVE = "move_grab"


class PackingError(ValueError):
    """Packed commands that cannot be read."""


@dataclass
class _Hands:
    """Where each hand moved to last [mm], and the gesture of its grab."""

    places: dict[int, tuple[int, int]] = field(default_factory=dict)
    gestures: dict[int, int] = field(default_factory=dict)

    def note(self, gesture: int, record: dict[str, Any]) -> None:
        """Take a command into account that is no packed move."""
        if record.get("type") == "grab" and isinstance(record.get("grab"), int):
            self.gestures[record["grab"]] = gesture

    def place(self, hand: int) -> tuple[int, int]:
        """Where it moved to last."""
        return self.places.get(hand, (0, 0))


def pack(script: Sequence[ScriptLine]) -> list[Any]:
    """The commands of a script, gestures numbered anew from 1 on in the order in which they begin."""
    packed: list[Any] = []
    moves: list[list[int]] = []
    hands, numbers, tick = _Hands(), dict[int, int](), 0
    for line in script:
        gesture = numbers.setdefault(line.gesture, len(numbers) + 1)
        move = _move(line.record, gesture, hands)
        if move is None:
            moves = []
            packed.append([line.tick - tick, gesture, line.record])
            hands.note(gesture, line.record)
        else:
            if not moves:
                moves = [[] for _ in range(_COLUMNS)]
                packed.append(moves)
            hand, (x, y) = move
            before = hands.place(hand)
            row = line.tick - tick, hand, x - before[0], y - before[1]
            for column, value in zip(moves, row, strict=True):
                column.append(value)
            hands.places[hand] = x, y
        tick = line.tick
    return packed


def _move(record: dict[str, Any], gesture: int, hands: _Hands) -> tuple[int, tuple[int, int]] | None:
    """The hand of a move and its place in millimetres, where that is all that the record says."""
    if record.get("type") != MOVE or set(record) != {"type", "grab", "target"}:
        return None
    hand, target = record["grab"], record["target"]
    if hands.gestures.get(hand) != gesture:
        return None
    x, y = (round(each * PER_METRE) for each in target)
    is_exact = [_metres(x), _metres(y)] == list(target) and all(_is_plain(each) for each in target)
    return (hand, (x, y)) if is_exact and max(abs(x), abs(y)) <= FARTHEST else None


def _metres(place: int) -> float:
    return place / PER_METRE


def _is_plain(value: float) -> bool:
    """Whether it is no -0.0, which no whole number is."""
    return value != 0.0 or str(value)[0] != "-"


def unpack(packed: Any) -> tuple[ScriptLine, ...]:
    """The commands that `pack` made short. Raises PackingError."""
    if not isinstance(packed, list):
        raise PackingError("its commands are no list")
    script: list[ScriptLine] = []
    hands, tick = _Hands(), 0
    for entry in packed:
        for passed, gesture, record in _entry(entry, hands):
            if not (_is_number(passed, TICK_LIMIT) and _is_number(gesture, COMMAND_LIMIT)):
                raise PackingError("a tick or a gesture of its commands is no whole number")
            tick += passed
            script.append(ScriptLine(tick, gesture, record, len(script) + 1))
            if len(script) > COMMAND_LIMIT or tick > TICK_LIMIT:
                raise PackingError(f"it holds more than {COMMAND_LIMIT:,} commands or {TICK_LIMIT:,} ticks")
    return tuple(script)


def _entry(entry: Any, hands: _Hands) -> Iterator[tuple[Any, Any, dict[str, Any]]]:
    if isinstance(entry, list) and len(entry) == _COLUMNS and all(isinstance(each, list) for each in entry):
        yield from _moves(entry, hands)
    elif isinstance(entry, list) and len(entry) == 3 and isinstance(entry[2], dict):
        passed, gesture, record = entry
        yield passed, gesture, record
        hands.note(gesture, record)
    else:
        raise PackingError("one of its commands is neither a command nor moves")


def _moves(columns: list[list[Any]], hands: _Hands) -> Iterator[tuple[Any, Any, dict[str, Any]]]:
    if len({len(column) for column in columns}) != 1:
        raise PackingError("the columns of its moves are not of one length")
    for passed, hand, dx, dy in zip(*columns, strict=True):
        if not (_is_number(hand, HANDS - 1) and _is_step(dx) and _is_step(dy)):
            raise PackingError("a move of a hand is no whole number")
        if hand not in hands.gestures:
            raise PackingError("a hand moves that holds nothing")
        before = hands.place(hand)
        x, y = before[0] + dx, before[1] + dy
        hands.places[hand] = x, y
        yield passed, hands.gestures[hand], {"type": MOVE, "grab": hand, "target": [_metres(x), _metres(y)]}


def _is_step(value: Any) -> bool:
    return _is_int(value) and abs(value) <= 2 * FARTHEST


def _is_int(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: Any, most: int) -> bool:
    return _is_int(value) and 0 <= value <= most
