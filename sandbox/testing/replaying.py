"""What the test of a recording does: run it again, tell and draw where it parts, or record it again."""

import json
import shlex
import tempfile
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from sandbox.level.document.model import Level
from sandbox.level.format.writing import unfinished
from sandbox.level.reading.files import LevelError, file_of, shipped_levels
from sandbox.session.compare.comparison import Comparison, across_versions, compare, to_the_end
from sandbox.session.level_edits import with_settings
from sandbox.session.replay.nearest_level import NoLevelError, known_level, level_among, level_in, nearest
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import OtherPhysicsError, Replay, ReplayError
from sandbox.session.replay.rerecord import (
    Renames,
    carried_over,
    guessed_renames,
    missing_names,
    new_names,
    record_again,
)
from sandbox.session.solution import Proof
from sandbox.testing.evidence import name_of, pictures_of, place_of
from sandbox.testing.files import SOLUTION, Failed, asked_renames, is_golden, level_files, levels_around

if TYPE_CHECKING:
    from collections.abc import Callable

    from sandbox.level.document.model import Level
    from sandbox.session.compare.comparison import Comparison
    from sandbox.session.replay.recording import Replay

# What is done about a solution that is none any more.
PLAY_AGAIN = "record a run that wins in its place, or edit the level so that this one does"
# In place of a level: the copy that each recording has of its own.
OWN = "own"
# Names that are told of those that a level does not have, and of those that are new there.
MOST_NAMED = 5
# Smaller runs that the test of one recording tries, at most.
MOST_RUNS = 2_000
# Recordings that are named below one cause.
RECORDINGS_NAMED = 12


@dataclass(frozen=True)
class Update:
    """A recording that was recorded again. cause: lines; effect: a line; farthest [m]: how far its runs are apart."""

    name: str
    cause: list[str]
    effect: str
    farthest: float = 0.0
    checks: list[str] = field(default_factory=list)

    def to_text(self) -> str:
        """The update as a line of JSON, which processes hand on."""
        return json.dumps(asdict(self))


def replay_test(config: pytest.Config, path: Path) -> Update | None:
    """Run a recording again as the options say; what changed where it was recorded again. Raises Failed."""
    try:
        golden = _golden(config, path)
        golden.check_names(config)
        if config.getoption("--replay-update"):
            return _update(golden)
        if golden.refused:
            raise _failed(config, golden, golden.refused, golden.differing())
        if config.getoption("--replay-solver"):
            _run_twice(config, golden.replay)
            return None
        found = golden.differing()
        if found is None:
            check_rollback(config, golden.replay, golden.level)
    except ReplayError as error:
        raise Failed(*error.faults) from None
    if golden.is_renamed:
        raise _failed(config, golden, golden.rename_lines()[0], found)
    if found is not None:
        raise _failed(config, golden, found.cause() if found.edits else f"diverged: {found.cause()}", found)
    return None


@dataclass(frozen=True)
class _Golden:
    """A recording that is a test, and the level that it is to run on.

    replay: with the level's names; recorded: as its file has it. level: None: its own. renames: names, old to new.
    refused: why it cannot be verified, but recorded again, or "".
    """

    path: Path
    recorded: Replay
    replay: Replay
    level: Level | None
    renames: Renames
    refused: str

    @property
    def is_renamed(self) -> bool:
        """Whether its commands name bodies that are called otherwise now."""
        return [line.record for line in self.replay.script] != [line.record for line in self.recorded.script]

    def differing(self) -> Comparison | None:
        """Where its run differs, measured to the end. Raises ReplayError."""
        if self.refused:
            return across_versions(self.replay, self.level)
        found = compare(self.replay, level=self.level)
        return None if found is None else to_the_end(found)

    def rename_lines(self) -> list[str]:
        """Lines that say which names have changed."""
        return [f"{self.level_name}: {old} is called {new} now" for old, new in self.renames.items()]

    @property
    def level_name(self) -> str:
        """The name in messages of the level that a recording runs on."""
        return (file_of(self.level) if self.level is not None else "") or "level"

    def stops_winning(self) -> bool:
        """Whether it is the solution of a level that its commands won, and now do not."""
        if self.level is None or not self.path.name.endswith(SOLUTION):
            return False
        was_won = Proof(self.recorded.level, self.recorded).whole().passed
        return was_won and not Proof(self.level, self.replay).whole().passed

    def move_lines(self) -> list[str]:
        """Lines that say which title or file of the level has changed."""
        if self.level is None:
            return []
        pairs = {
            "title": (self.recorded.level.name, self.level.name),
            "file": (file_of(self.recorded.level), file_of(self.level)),
        }
        return [
            f"{self.level_name}: {what}: {old} -> {new}"
            for what, (old, new) in pairs.items()
            if old and new and old != new
        ]

    def check_names(self, config: pytest.Config) -> None:
        """Raises ReplayError, with a remedy, where the commands name what the level does not have."""
        missing = [] if self.level is None else missing_names(self.replay, self.level)
        if self.level is None or not missing:
            return
        fresh = new_names(self.replay.level, self.level)
        known = f"; new there: {', '.join(fresh[:MOST_NAMED])}" if fresh else ""
        raise ReplayError(
            f"{self.path}: its commands name {', '.join(missing[:MOST_NAMED])}, which {self.level_name} lacks{known}",
            rename_hint(config, self.path, missing[0]),
            f"if it is gone for good, {_by_commands(config, self.path)}",
        )


def _golden(config: pytest.Config, path: Path) -> _Golden:
    """Read a recording and find its level. Raises ReplayError and Failed."""
    refused = ""
    try:
        recorded = read_replay(path)
    except OtherPhysicsError as error:
        refused, recorded = error.faults[0], read_replay(path, retold=True)
    level = level_against(config, recorded)
    renames = {} if level is None else guessed_renames(recorded.level, level) | asked_renames(config)
    return _Golden(path, recorded, carried_over(recorded, renames), level, renames, refused)


def _failed(config: pytest.Config, golden: _Golden, headline: str, found: Comparison | None) -> Failed:
    """A failure that says what was edited, how far the runs come apart, and how to accept it."""
    path = golden.path
    lines = [*golden.rename_lines(), *(found.lines() if found else ["with these names every bit is equal"])]
    # A single edit is the headline already.
    failure = [headline, *(line for line in lines if line != headline)]
    smaller: list[str] = []
    if found and not golden.refused:
        smaller = shrunk_lines(config, golden.replay, golden.level, lambda: place_of(config, name_of(config, path)))
    pictures = pictures_of(config, found, path) if found else []
    return Failed(*failure, *pictures, *smaller, _way_out(config, golden, found), found=found)


def _named(config: pytest.Config, path: Path) -> str:
    """A file as a command where pytest was started names it."""
    folder = config.invocation_params.dir
    return str(path.relative_to(folder) if path.is_relative_to(folder) else path)


def rename_hint(config: pytest.Config, path: Path, missing: str) -> str:
    """The command for what a level calls otherwise than a recording or a golden file does."""
    command = ["pytest", "--replay-update", "--replay-rename", f"{missing}=NEW", _named(config, path)]
    return f"if {missing} is called otherwise now: {shlex.join(command)}"


def acceptance(config: pytest.Config, path: Path) -> str:
    """The command that accepts what a recording or a golden file does now."""
    against = config.getoption("--replay-against")
    options = [f"--replay-against={against}"] if against else []
    options += [f"--replay-rename={each}" for each in config.getoption("--replay-rename")]
    return f"to accept: {shlex.join(['pytest', '--replay-update', *options, _named(config, path)])}"


def _way_out(config: pytest.Config, golden: _Golden, found: Comparison | None) -> str:
    """How to accept a run; one that a command ends early, or that wins no more, cannot be recorded."""
    path = golden.path
    if found is None or found.distance is None or "the new run ends" not in found.distance.stopped:
        return PLAY_AGAIN if golden.stops_winning() else acceptance(config, path)
    return f"to accept, {_by_commands(config, path)}"


def _by_commands(config: pytest.Config, path: Path) -> str:
    """The way out where the commands of a recording do not fit the level any more."""
    commands = f"{_named(config, path).partition('.replay')[0]}.commands.jsonl"
    export = shlex.join(["sandbox", "export", _named(config, path), "--to", "commands", "-o", commands])
    return f"edit its commands and record them again by `sandbox run --record`: {export}"


def level_against(config: pytest.Config, replay: Replay) -> Level | None:
    """The level on which a recording runs instead of its own copy: one file, or its file in a folder.

    Without a word about it, the file of its name that is nearest, or of its title.
    """
    against, set_down = config.getoption("--replay-against"), config.getini("sandbox_against")
    if (against or set_down) == OWN:
        return None
    if against:
        place = config.invocation_params.dir / against
    elif set_down:
        place = (config.inipath.parent if config.inipath else config.rootpath) / set_down
    else:
        return _usual_level(config, replay)
    return _read(level_in, place, replay)


def _read(read: "Callable[..., Level]", *what: Any) -> Level:
    """The level that a function reads. Raises Failed with its faults, and with the way out where there is none."""
    try:
        return read(*what)
    except NoLevelError as error:
        command = ["pytest", "--replay-update", "--replay-against", f"{error.folder}/NAME.json", what[1].source]
        raise Failed(*error.faults, f"name its file: {shlex.join(command)}") from None
    except LevelError as error:
        raise Failed(*error.faults) from None


def _usual_level(config: pytest.Config, replay: Replay) -> Level | None:
    """The level file of a project that a recording is of, the nearest; None: a shipped level. Raises Failed."""
    here, name = Path(replay.source).resolve(), file_of(replay.level)
    found = nearest({*(path.resolve() for path in level_files(config)), *levels_around(here, name)}, replay)
    if not found:
        if not name or _is_shipped(replay):
            return None
        raise Failed(
            f"{replay.source}: its level, {name} with the title {replay.level.name!r}, is neither beside it nor in a "
            "folder levels there or around, nor among sandbox_levels",
            "to run recordings on the copies that they hold: sandbox_against = own",
        )
    if len(found) > 1 and any(replay.level == replay.on(level_of(path)) for path in found):
        return replay.level
    return _read(level_among, found, replay, found[0].parent)


def _is_shipped(replay: Replay) -> bool:
    """Whether the level of a recording is as the program ships it."""
    level = replay.level
    return any(path.name == file_of(level) and replay.on(level_of(path)) == level for path in shipped_levels())


def level_of(path: Path) -> Level:
    """A level. Raises Failed with its faults."""
    return _read(known_level, path)


def with_solver(config: pytest.Config, level: Level) -> Level:
    """A level with the solver of --replay-solver, where that is given. Raises Failed."""
    solver = config.getoption("--replay-solver")
    try:
        return with_settings(level, {"solver": solver}, "--replay-solver") if solver else level
    except LevelError as error:
        raise Failed(*error.faults) from None


def _run_twice(config: pytest.Config, replay: Replay) -> None:
    """Run a recording's commands with another solver, and that run again. Raises Failed and ReplayError."""
    level = with_solver(config, level_against(config, replay) or replay.level)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "again.replay.gz"
        record_again(replay, level, path)
        found = compare(read_replay(path))
    if found is not None:
        raise Failed(f"{replay.source}: two runs with {level.settings.solver} differ", *found.lines())


def _update(golden: _Golden) -> Update | None:
    """Record again what differs; what changed, None where nothing did. Raises ReplayError and Failed."""
    path, level = golden.path, golden.level
    found = golden.differing()
    moved = [*golden.move_lines(), *(golden.rename_lines() if golden.is_renamed else [])]
    if found is None and not moved:
        return None
    if golden.stops_winning():
        raise Failed(f"{path.name}: not recorded again: it no longer wins {golden.level_name}", PLAY_AGAIN)
    fresh = unfinished(path, "".join(path.suffixes[-2:]))
    try:
        record_again(golden.replay, level or golden.replay.level, fresh)
        fresh.replace(path)
    except OSError as error:
        raise Failed(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        fresh.unlink(missing_ok=True)
    return update_of(path.name, golden.recorded, moved, found)


def shrunk_lines(
    config: pytest.Config, replay: "Replay", level: "Level | None", output: "Callable[[], Path]"
) -> list[str]:
    """The smallest run that still diverges on a level, as lines, and written; none where nobody asks for it.

    output: where what is written of the recording goes.
    """
    if not config.getoption("--replay-shrink"):
        return []
    if level is None:
        return ["smallest: only the build that recorded it knows the bits of other commands; --replay-against compares "
                "with a level"]  # fmt: skip
    from sandbox.session.shrink.passes import short_json
    from sandbox.session.shrink.shrinker import shrinker_against, write_recording

    shrinker = shrinker_against(replay, level)
    if shrinker.seen is None:
        return ["smallest: what differs does so from the beginning, without any command"]
    for _ in shrinker.steps():
        if shrinker.tries >= MOST_RUNS:
            break
    try:
        path = Path(f"{str(output()).partition('.replay')[0]}.smallest.replay.gz")
        write_recording(shrinker.smallest, shrinker.level, path)
    except OSError as error:
        return [f"smallest: {error}"]
    return [
        f"smallest: {path}: {shrinker.smallest.counts()}: {shrinker.seen}",
        *(f"  tick {line.tick}: {short_json(line.record)}" for line in shrinker.smallest.lines),
    ]


def check_rollback(config: pytest.Config, replay: "Replay", level: "Level | None") -> None:
    """Go back at every tick of a recording, where --replay-rollback says so. Raises Failed and ReplayError."""
    from sandbox.session.compare.rollback import roll_back

    back = config.getoption("--replay-rollback")
    found = roll_back(replay, back, level).found if back else None
    if found is not None:
        raise Failed(f"{Path(replay.source).name}: rolled back {back} ticks, diverged: {found}", *found.lines())


def check_rollback_of_level(config: pytest.Config, level: "Level") -> None:
    """Check rollback of a level that random hands play. Raises Failed."""
    from sandbox.session.compare.rollback import roll_back_level

    back = config.getoption("--replay-rollback")
    found = roll_back_level(level, back).found if back else None
    if found is not None:
        raise Failed(f"{level.name}: rolled back {back} ticks under random hands, diverged: {found}", *found.lines())


def update_of(name: str, recorded: "Replay", moved: list[str], found: "Comparison | None") -> Update:
    """The report of a recording that was recorded again."""
    old = [] if recorded.is_of_this_physics else [f"recorded with physics version {recorded.physics_version}"]
    cause = [*old, *moved]
    if found is None:
        return Update(name, cause, "equal in every bit")
    if found.edits:
        cause += found.edits
    elif recorded.is_of_this_physics:
        cause.append(str(found.by_hand) if found.by_hand else f"this build steps differently: {found.divergence.array}")
    if found.distance is None:
        return Update(name, cause, str(found.divergence))
    return Update(name, cause, str(found.distance), found.distance.farthest, list(found.distance.lines))


def grouped(texts: Iterable[str]) -> list[str]:
    """The lines of all updates, given as JSON: each cause once, with the largest effect, and the recordings."""
    groups: dict[tuple[str, ...], list[Update]] = defaultdict(list)
    for text in texts:
        update = Update(**json.loads(text))
        groups[tuple(update.cause)].append(update)
    lines = []
    for cause, updates in groups.items():
        most = max(updates, key=lambda each: each.farthest)
        names = sorted(each.name for each in updates)
        more = f" and {len(names) - RECORDINGS_NAMED} more" if len(names) > MOST_NAMED else ""
        what = "golden file" if is_golden(Path(most.name)) else "recording"
        of = f" ({most.name})" if len(names) > 1 and most.farthest else ""
        lines += [
            *cause,
            f"  {most.effect}{of}",
            *(f"  {line}{of}" for line in most.checks),
            f"  {len(names)} {what}{'s' if len(names) > 1 else ''}: {', '.join(names[:RECORDINGS_NAMED])}{more}",
        ]
    return lines
