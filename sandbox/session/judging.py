"""Judging: an entry of a board is run again, and wins by the level's own rules, or does not enter for a reason."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from sandbox.level.document.model import Level
from sandbox.level.format.writing import refusal_of
from sandbox.level.reading.files import level_data, read_level
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands import Redo, Undo
from sandbox.session.commands.records import ScriptLine, script_of
from sandbox.session.compare.comparison import verify
from sandbox.session.outcome import measure_of, measured, outcome, outcome_text
from sandbox.session.replay.format import level_digest
from sandbox.session.replay.link import is_link, replay_of, run_of
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session
from sandbox.session.time_limit import TimeUp, time_limit

# What a name holds at most [characters].
NAME_LIMIT = 60


@dataclass(frozen=True)
class BoardEntry:
    """A link or a recording; place: its file, of a link with the line; run: the link, None: the file itself."""

    place: str
    name: str
    run: str | None


@dataclass(frozen=True)
class BoardLevel:
    """A level of a board as a process gets it: where it lies, and what it is called."""

    path: Path
    name: str


@dataclass(frozen=True)
class Win:
    """An entry that wins a level.

    ticks: until it is won; value: of what the level measures, see outcome.measured; run: without what was undone, until
    the rule that wins has done what it does.
    """

    entry: BoardEntry
    stem: str
    stars: int
    ticks: int
    value: float
    run: Replay


def judged(entry: BoardEntry, levels: Mapping[str, BoardLevel], limit: float) -> Win | str:
    """How an entry wins, or the line that says why it does not enter.

    levels: by their digests; limit: time of the processor [s].
    """
    try:
        with time_limit(limit):
            return _win_of(entry, levels)
    except TimeUp:
        said = f"took longer than {limit:g} s of the processor"
    except (ReplayError, OSError) as error:
        said = error.faults[0] if isinstance(error, ReplayError) else f"cannot be read: {refusal_of(error)}"
    return f"{entry.place}: {said.removeprefix(f'{entry.place}: ')}"


def _win_of(entry: BoardEntry, levels: Mapping[str, BoardLevel]) -> Win:
    """An entry that wins. Raises ReplayError, OSError."""
    if len(entry.name) > NAME_LIMIT or not entry.name.isprintable():
        raise ReplayError(f"its name is longer than {NAME_LIMIT} characters, or has some that nobody sees")
    if entry.run is not None and not is_link(entry.run):
        raise ReplayError("is no link to a run: it has no #scene=")
    replay = read_replay(entry.place) if entry.run is None else replay_of(entry.run)
    digest = level_digest(level_data(replay.level))
    if digest not in levels:
        is_edited = any(each.name == replay.level.name for each in levels.values())
        raise ReplayError(f"its level is {'another edition of one' if is_edited else 'none'} of this board")
    level = _level(levels[digest].path, digest)
    replay = replace(replay, source=entry.place, level=level)
    found = verify(replay)
    if found is not None:
        raise ReplayError(f"its run is not what it says: {found}")
    session = _run(level, replay.script, replay.ticks)
    result, rate = outcome(level, session.world), level.settings.tick_rate
    if result is None or not result.is_won:
        raise ReplayError("does not win" if result is None else outcome_text(result, rate))
    script = replay.script
    if any(line.record["type"] in (Undo.type, Redo.type) for line in script):
        counted = [each for each in session.history.timeline if each.in_effect]
        script = script_of(counted, session.world)
    # The rule that wins does what it does in the tick after.
    script, ticks = tuple(line for line in script if line.tick < result.tick), result.tick + 1
    world = _run(level, script, ticks).world
    won, value = outcome(level, world) or result, measured(measure_of(level), world, result.tick)
    run = run_of(entry.place, level, script, ticks, state_hash(world))
    return Win(entry, levels[digest].path.stem, won.stars, result.tick, value, run)


@cache
def _level(path: Path, digest: str) -> Level:
    """The level of a file, which has this digest; entries write the same in other ways."""
    return read_level(path)


def _run(level: Level, script: Sequence[ScriptLine], ticks: int) -> Session:
    """A run of commands that can all be carried out, at its end."""
    session = Session(level, script=script)
    while session.tick < ticks:
        session.advance()
    session.apply_pending()
    return session
