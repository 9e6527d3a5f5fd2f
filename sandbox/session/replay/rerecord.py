"""Recording again: the commands of a recording, on its level or another, as this version steps them."""

import json
import os
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.plan.plan import Plan, kept_plan
from sandbox.level.reading.files import file_of, keep_file, level_data, parse_level, run_with
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import CommandError
from sandbox.session.commands.command import COMMAND_TYPES
from sandbox.session.commands.named import namespaces
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.format import STATE_TICKS
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session

# Kinds of names in commands that no body gives.
_OTHER_KINDS = ("key", "material")
# Fields of levels whose texts name no body.
_NO_NAMES = (
    "name",
    "material",
    "materials",
    "description",
    "goal",
    "author",
    "licence",
    "tags",
    "format",
    "type",
    "key",
)


def record_again(replay: Replay, level: Level, path: Path) -> None:
    """Write a recording of as many ticks with the same commands on a level; states as far apart as they were.

    Raises ReplayError where a command cannot be carried out there, OSError where the file cannot be written.
    """
    stored = sorted(replay.states)
    apart = stored[1] - stored[0] if len(stored) > 2 else STATE_TICKS
    session = Session(replay.on(level), script=replay.script)
    session.record_to(path, apart)
    try:
        while session.tick < replay.ticks:
            session.advance()
        session.apply_pending()
    except CommandError as error:
        session.abandon_recording()
        raise ReplayError(*(f"{replay.source}: {fault}" for fault in error.faults)) from None
    if session.stop_recording() is None:
        raise OSError(0, "; ".join(session.refusals), str(path))


def resume(replay: Replay, ticks: int, progress: Callable[[int], object] | None = None) -> None:
    """Put in the place of a recording one that goes on where it was cut off, to this many ticks in all, and is whole.

    progress: called with each tick that was run. Raises ReplayError where the run is not the recorded one any more,
    CommandError where a command cannot be carried out, OSError where the file cannot be written; whatever is raised,
    the recording stays as it is.
    """
    path = Path(replay.source)
    # Compressed where the recording is.
    part = path.with_name(f"{path.stem}.part{path.suffix}")
    session = Session(replay.level, replay.script)
    session.record_to(part)
    try:
        while session.tick < ticks:
            session.advance()
            _compare(session, replay)
            if progress is not None:
                progress(session.tick)
        if session.stop_recording() is None:
            raise OSError(None, "cannot be written to its end", str(part))
        os.replace(part, path)
    except BaseException:
        session.abandon_recording()
        part.unlink(missing_ok=True)
        raise


# Names of bodies and loose particles, old to new.
Renames = Mapping[str, str]


def guessed_renames(before: Level, after: Level) -> dict[str, str]:
    """The certain renames: one body is gone and one is new, of the same type and counts."""
    gone, fresh = defaultdict(list), defaultdict(list)
    old, new = _kinds(before), _kinds(after)
    for name in old.keys() - new.keys():
        gone[old[name]].append(name)
    for name in new.keys() - old.keys():
        fresh[new[name]].append(name)
    pairs = {gone[kind][0]: fresh[kind][0] for kind in gone if len(gone[kind]) == len(fresh[kind]) == 1}
    return {name: pairs[name] for name in old if name in pairs}


def carried_over(replay: Replay, renames: Renames) -> Replay:
    """A recording as it is with other names in its level and its commands."""
    if not renames:
        return replay
    script = tuple(replace(line, record=renamed_record(line.record, renames)) for line in replay.script)
    return replace(replay, level=_renamed_level(replay.level, renames), script=script)


def missing_names(replay: Replay, level: Level) -> list[str]:
    """Bodies and loose particles of the recorded level that its commands name and another level does not have."""
    gone = _kinds(replay.level).keys() - _kinds(level).keys()
    named = {owner_of(text) for line in replay.script for text in _names_in(line)}
    return [name for name in _kinds(replay.level) if name in gone & named]


def new_names(before: Level, after: Level) -> list[str]:
    """Bodies and loose particles of a level that another does not have."""
    known = _kinds(before)
    return [name for name in _kinds(after) if name not in known]


def renamed_name(name: str, renames: Renames) -> str:
    """A name of a body, or of a particle or spring of it, as it is after bodies were called otherwise."""
    if name in renames:
        return renames[name]
    owner = owner_of(name)
    return f"{renames[owner]}{name[len(owner) :]}" if owner in renames else name


def owner_of(name: str) -> str:
    """The body that a particle, a spring or a part is of, by its name."""
    return max((name.rpartition(sign)[0] for sign in ".:"), key=len) or name


def _kinds(level: Level) -> dict[str, tuple[Any, ...]]:
    """Type and counts of each body and loose particle that has a name."""
    bodies = (kept_plan(level) or Plan(level)).bodies
    found: dict[str, tuple[Any, ...]] = {
        each.id: (each.type, *made.count) for each, made in zip(level.bodies, bodies, strict=True)
    }
    return found | {each.id: ("particle",) for each in level.particles if each.id is not None}


def _names_in(line: ScriptLine) -> Iterator[str]:
    for field in _named_fields(line.record):
        value = line.record[field]
        yield from (each for each in (value if isinstance(value, list) else [value]) if isinstance(each, str))


def _named_fields(record: Mapping[str, Any]) -> list[str]:
    """The fields of a command that name bodies, or parts of bodies."""
    kind = COMMAND_TYPES.get(str(record.get("type")))
    if kind is None:
        return []
    named = [field for field, names in namespaces(kind).items() if names.kind not in _OTHER_KINDS]
    # What a command adds is a body as well, but a whole one.
    return [field for field in {*named, "body"} if isinstance(record.get(field), str | list)]


def renamed_record(record: dict[str, Any], renames: Renames) -> dict[str, Any]:
    """A command's record as it is after bodies were called otherwise."""
    return record | {field: _renamed_value(record[field], renames) for field in _named_fields(record)}


def _renamed_level(level: Level, renames: Renames) -> Level:
    """A level with other names; the level itself where that would be none."""
    data = {
        key: value if key in _NO_NAMES else _renamed_value(value, renames) for key, value in level_data(level).items()
    }
    try:
        found = parse_level(json.dumps(data).encode(), level.name)
    except LevelError:
        return level
    keep_file(found, file_of(level), run_with(level))
    return found


def _renamed_value(value: Any, renames: Renames) -> Any:
    if isinstance(value, str):
        return renamed_name(value, renames)
    if isinstance(value, list):
        return [_renamed_value(each, renames) for each in value]
    if isinstance(value, dict):
        return {key: each if key in _NO_NAMES else _renamed_value(each, renames) for key, each in value.items()}
    return value


def _compare(session: Session, replay: Replay) -> None:
    tick = session.tick
    if tick <= replay.ticks and not replay.hashes[tick].fits(state_hash(session.world)):
        raise ReplayError(
            f"{replay.source}: the run differs at tick {tick}, so nothing goes on from there; "
            "`sandbox replay --partial` says what differs"
        )
