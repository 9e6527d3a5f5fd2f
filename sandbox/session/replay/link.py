"""Links: a run in the fragment of an address, which no browser sends to a server.

    https://example.org/toys/#scene=eNq...

It holds the level, or the name of a shipped one, the commands of the run, its length and the hash of its last state:
JSON, deflated, in the letters of base64 that addresses may have.
"""

import base64
import binascii
import hashlib
import json
import re
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sandbox.level.document.canonical import level_data
from sandbox.level.document.model import Level
from sandbox.level.format.foreign import scan
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import load_level, parse_level, shipped_levels
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.commands.faults import plain_fault
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.recording import Replay, ReplayError, TickHashes

VERSION = 2
# What comes before the packed run in a fragment; and before that, with a name, where the run is to be raced.
MARK, BEAT = "scene=", "beat="
# A longer link is cut by programs that pass it on [characters]; a longer run goes into a file.
LONGEST = 32_000
# What a link may unpack to [bytes], and ticks of its run: an hour at 60 a second.
UNPACKED_LIMIT = 4 * 2**20
RUN_LIMIT = 216_000
_DIGEST = 8
# Whole numbers that a float is sure of are below this.
_SAFE = 2**53

_LINK = re.compile(rf"(?:^|#)(?:{BEAT}[^&#]*&)?{MARK}(.*)$", re.DOTALL)
_NO_HASHES = TickHashes("", ("",) * len(BY_STORED))


class _LinkedRun(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    v: Literal[2]
    physics: int
    level: dict[str, Any] | Annotated[str, Field(max_length=80)]
    digest: Annotated[str, Field(max_length=_DIGEST)]
    ticks: Annotated[int, Field(ge=0, le=RUN_LIMIT)]
    at: Annotated[int, Field(ge=0, le=RUN_LIMIT)] = 0
    hash: Annotated[str, Field(pattern="^[0-9a-f]{32}$")]
    commands: list[Any]


def is_link(text: str) -> bool:
    """Whether a text is a link, of any site or of none."""
    return _LINK.search(text.strip()) is not None


def fragment_of(replay: Replay, at: int = 0) -> str:
    """The fragment of a link to a recorded run, which pages show from a tick on.

    Raises ReplayError for a recording that is cut off, and for one that is too long for a link.
    """
    if replay.end_hash is None:
        raise ReplayError(f"{replay.source}: is cut off; a link holds the hash of its end")
    if replay.ticks > RUN_LIMIT:
        raise ReplayError(f"{replay.source}: {replay.ticks:,} ticks are too long for a link; send the file")
    whole = {
        "v": VERSION, "physics": PHYSICS_VERSION, **level_record(replay.level), "ticks": replay.ticks, "at": at,
        "hash": replay.end_hash, "commands": pack(replay.script),
    }  # fmt: skip
    data = json.dumps(whole, separators=(",", ":"), ensure_ascii=False).encode()
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    text = MARK + base64.urlsafe_b64encode(packer.compress(data) + packer.flush()).decode().rstrip("=")
    if len(data) > UNPACKED_LIMIT or len(text) > LONGEST:
        raise ReplayError(
            f"{replay.source}: a link to it would have {len(text):,} characters, where {LONGEST:,} are the most; "
            "send the file"
        )
    return text


def level_record(level: Level) -> dict[str, Any]:
    """The level as links hold it: the name of a shipped one, or all of it; and its digest."""
    shipped = (path.stem for path in shipped_levels() if load_level(path) == level)
    return {"level": next(shipped, None) or level_data(level), "digest": _digest(level)}


def _digest(level: Level) -> str:
    text = json.dumps(level_data(level), sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=_DIGEST // 2).hexdigest()


def replay_of(link: str) -> Replay:
    """The run of a link, as a recording that knows the hash of its end alone.

    Raises ReplayError, in one line, for a link that is broken, of another version, or not one of ours.
    """
    found = _LINK.search(link.strip())
    if found is None:
        raise ReplayError(f"the link holds no run: it has no #{MARK}...")
    packed = _unpacked(found[1])
    try:
        script = unpack(packed.commands)
    except PackingError as error:
        raise ReplayError(f"the link is broken: {error}") from None
    if any(line.tick > packed.ticks for line in script[-1:]) or packed.at > packed.ticks:
        raise ReplayError("the link is broken: it goes on after its end")
    return run_of("link", _level_of(packed), script, packed.ticks, packed.hash)


def run_of(source: str, level: Level, script: Sequence[ScriptLine], ticks: int, end_hash: str) -> Replay:
    """A run of which the hash of its end is known alone, as a recording."""
    return Replay(source, level, tuple(script), (_NO_HASHES,) * (ticks + 1), {}, end_hash)


def _unpacked(text: str) -> _LinkedRun:
    """The content of a link's fragment. Raises ReplayError."""
    if len(text) > LONGEST:
        raise ReplayError(f"the link is longer than {LONGEST:,} characters")
    try:
        data = base64.b64decode(text + "=" * (-len(text) % 4), altchars=b"-_", validate=True)
        opener = zlib.decompressobj(-zlib.MAX_WBITS)
        plain = opener.decompress(data, UNPACKED_LIMIT)
    except (binascii.Error, ValueError, zlib.error):
        raise ReplayError("the link is damaged: copy it again, whole") from None
    if opener.unconsumed_tail:
        raise ReplayError(f"the link unpacks to more than {UNPACKED_LIMIT // 2**20} MiB")
    if not opener.eof:
        raise ReplayError("the link is cut off: copy it again, whole")
    if opener.unused_data:
        raise ReplayError("the link goes on after its end: copy it again, without what follows")
    if fault := scan(plain):
        raise ReplayError(f"the link is damaged: {fault[1]}")
    try:
        values = json.loads(plain, parse_float=_number)
    except (ValueError, RecursionError):
        raise ReplayError("the link is damaged: copy it again, whole") from None
    if isinstance(values, dict):
        _check_versions(values)
    try:
        return _LinkedRun.model_validate(values)
    except ValidationError as error:
        raise ReplayError(f"the link is broken: {plain_fault(error)}") from None


def _number(text: str) -> int | float:
    """A number as pages read it, for which 3.0 is 3; but no -0.0, which is none."""
    value = float(text)
    return int(value) if value.is_integer() and abs(value) < _SAFE and text[0] != "-" else value


def _check_versions(values: dict[str, Any]) -> None:
    if values.get("v") != VERSION:
        raise ReplayError(f"the link is of version {str(values.get('v'))[:20]}; this program reads {VERSION}")
    if values.get("physics") != PHYSICS_VERSION:
        raise ReplayError(
            f"the link was made with physics version {str(values.get('physics'))[:20]}; this program has "
            f"{PHYSICS_VERSION}, whose bits differ"
        )


def _level_of(packed: _LinkedRun) -> Level:
    """The level of a link. Raises ReplayError."""
    try:
        if isinstance(packed.level, dict):
            level = parse_level(json.dumps(packed.level).encode(), "the level of the link")
        else:
            shipped = {path.stem: path for path in shipped_levels()}
            if packed.level not in shipped:
                raise ReplayError(f"the link is to a level that is not here: {packed.level!r}")
            level = load_level(shipped[packed.level])
    except LevelError as error:
        raise ReplayError(*error.faults) from None
    if _digest(level) != packed.digest:
        raise ReplayError(f"the link is to another edition of the level {level.name!r}")
    return level


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
    """The last place of each hand [mm], and the gesture of its grab."""

    places: dict[int, tuple[int, int]] = field(default_factory=dict)
    gestures: dict[int, int] = field(default_factory=dict)

    def note(self, gesture: int, record: dict[str, Any]) -> None:
        """Note a command that is no packed move."""
        if record.get("type") == "grab" and isinstance(record.get("grab"), int):
            self.gestures[record["grab"]] = gesture

    def place(self, hand: int) -> tuple[int, int]:
        """Where the hand moved to last."""
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
    """Whether a value is no -0.0, which no whole number is."""
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
