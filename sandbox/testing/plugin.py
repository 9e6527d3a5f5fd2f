"""The plugin of pytest: recordings and the checks of levels are tests; a fixture plays levels.

It is loaded in every project of an environment, so nothing here takes long to import, and a file is taken only if it
says of itself that it is a recording's or a level.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from sandbox.testing.files import given_renames, is_golden, is_recording, level_files, names_a_level
from sandbox.testing.goldens import GoldenTest
from sandbox.testing.items import LevelTests, RecordingTest
from sandbox.testing.updates import grouped

if TYPE_CHECKING:
    from sandbox.testing.driver import Driver

# Recordings that --replay-update wrote, with what changed, as lines; workers of xdist hand them to the first process.
UPDATED = "sandbox_updated"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options and settings of the plugin."""
    group = parser.getgroup("sandbox", "Spring Sandbox: recordings and levels")
    group.addoption("--replay-update", action="store_true", help="record again what diverges, and show what changed")
    group.addoption(
        "--replay-solver",
        metavar="NAME",
        help="run recordings and checks with this solver; recordings are compared with a second run, not with their "
        "own bits",
    )
    group.addoption("--replay-against", metavar="LEVEL", help="as the setting sandbox_against, before it")
    group.addoption(
        "--replay-shrink", action="store_true", help="of a recording that diverges on a level, write the smallest run"
    )
    group.addoption(
        "--replay-rollback",
        metavar="N",
        type=int,
        default=0,
        help="at every tick of a recording, and of a level under random hands, also go back N ticks and compare",
    )
    group.addoption(
        "--replay-rename",
        metavar="OLD=NEW",
        action="append",
        default=[],
        help="a body that the level calls otherwise now, for --replay-update; may be given several times",
    )
    group.addoption("--replay-output", metavar="DIR", help="where pictures go; default: .pytest_cache/d/replays")
    parser.addini(
        "sandbox_levels", "Files whose level checks are tests, as patterns.", "args", default=["levels/*.json"]
    )
    parser.addini(
        "sandbox_against",
        "A level file on which recordings run instead of their own, or a folder with one of its name.",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse what cannot go together before anything runs."""
    if config.getoption("--replay-update") and config.getoption("--replay-solver"):
        raise pytest.UsageError("--replay-update records with each level's own solver: leave --replay-solver out")
    given_renames(config)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Recordings and golden files by names; levels that the setting names, or the command line."""
    if is_recording(file_path):
        return RecordingTest.from_parent(parent, path=file_path)
    if is_golden(file_path):
        return GoldenTest.from_parent(parent, path=file_path)
    if file_path.suffix != ".json":
        return None
    asked = parent.session.isinitpath(file_path) or file_path in level_files(parent.config)
    return LevelTests.from_parent(parent, path=file_path) if asked and names_a_level(file_path) else None


@pytest.fixture
def sandbox_session(request: pytest.FixtureRequest) -> "Callable[[Any], Driver]":
    """Begins a run of a level: a file beside the test or below the root, a shipped level's name, or a Level.

    What it gives drags, cuts, drives, runs and measures, see `sandbox.testing.driver.Driver`.
    """
    from sandbox.testing.driver import Driver, found_level

    folders = [request.path.parent, request.config.rootpath]
    return lambda level: Driver(found_level(level, folders))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Gather what was recorded again; in the first process, whichever process did it."""
    if report.when == "call":
        _updated.extend(str(value) for name, value in report.user_properties if name == UPDATED)


_updated: list[str] = []


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Show what was recorded again."""
    if _updated:
        terminalreporter.section("recorded again")
        for line in grouped(_updated):
            terminalreporter.write_line(line)
        _updated.clear()
