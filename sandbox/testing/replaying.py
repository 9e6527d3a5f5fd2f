"""What the test of a recording does: run it again, tell and draw where it parts, or record it again."""

import os
import tempfile
from contextlib import suppress
from pathlib import Path

import pytest

from sandbox.level.document.model import Level
from sandbox.level.reading.files import LevelError, load_level
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.replay.rerecord import record_again, with_settings
from sandbox.session.replay.verify import compare
from sandbox.testing.evidence import pictures_of
from sandbox.testing.failed import Failed
from sandbox.testing.files import level_files

# In place of a level: the copy that each recording has of its own.
OWN = "own"
_PRESENT = pytest.StashKey[list[Level]]()


def replay_test(config: pytest.Config, path: Path) -> str | None:
    """Run a recording again as the options say; what changed where it was recorded again. Raises Failed."""
    try:
        if config.getoption("--replay-update"):
            return _update(config, path)
        replay = read_replay(path)
        if config.getoption("--replay-solver"):
            _run_twice(config, replay)
            return None
        found = compare(replay, level=level_against(config, replay))
    except ReplayError as error:
        raise Failed(*error.faults) from None
    if found is not None:
        raise Failed(f"{path.name}: diverged: {found.divergence}", *found.lines(), *pictures_of(config, found, path))
    return None


def level_of(path: Path) -> Level:
    """A level. Raises Failed with its faults."""
    try:
        return load_level(str(path))
    except LevelError as error:
        raise Failed(*error.faults) from None


def level_against(config: pytest.Config, replay: Replay) -> Level | None:
    """The level on which a recording runs instead of its own copy: one file, or that of the same name in a folder.

    Without a word about it, that of the same name among the files of `sandbox_levels`, if there is one.
    """
    given, set_down = config.getoption("--replay-against"), config.getini("sandbox_against")
    if (given or set_down) == OWN:
        return None
    if given:
        place = config.invocation_params.dir / given
    elif set_down:
        place = (config.inipath.parent if config.inipath else config.rootpath) / set_down
    else:
        named = [level for level in _present_levels(config) if level.name == replay.level.name]
        return replay.level if replay.level in named[1:] else next(iter(named), None)
    if not place.is_dir():
        return level_of(place)
    found = next(
        (level for level in map(level_of, sorted(place.glob("*.json"))) if level.name == replay.level.name), None
    )
    if found is None:
        raise Failed(f"{replay.source}: no level in {place} is called {replay.level.name!r}, as the recorded one is")
    return found


def _present_levels(config: pytest.Config) -> list[Level]:
    """The sound levels among the files of `sandbox_levels`, by their paths; of the others their own tests tell."""
    if _PRESENT not in config.stash:
        config.stash[_PRESENT] = levels = []
        for path in sorted(level_files(config)):
            with suppress(LevelError):
                levels.append(load_level(str(path)))
    return config.stash[_PRESENT]


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


def _update(config: pytest.Config, path: Path) -> str | None:
    """Record again what diverges; what changed, None where nothing did. Raises ReplayError and Failed."""
    try:
        replay = read_replay(path)
        level = level_against(config, replay)
        found = compare(replay, level=level)
        if found is None:
            return None
        changed = str(found.divergence)
    except ReplayError as error:
        replay = read_replay(path, retold=True)
        level, changed = level_against(config, replay), error.faults[0]
    fresh = path.with_name(f".{os.getpid()}-{path.name}")
    try:
        record_again(replay, level or replay.level, fresh)
        fresh.replace(path)
    except OSError as error:
        raise Failed(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        fresh.unlink(missing_ok=True)
    return f"before: {changed}"
