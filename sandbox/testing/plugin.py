"""The plugin of pytest: recordings and the checks of levels are tests; a fixture plays levels.

It is loaded in every project of an environment, so nothing here takes long to import. A file is taken for a recording
by its name, for a level by where it lies, unless it says that it is something else.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from sandbox.testing.files import USUAL_LEVELS, is_golden, is_level, is_recording, level_files
from sandbox.testing.goldens import GoldenTest
from sandbox.testing.items import LevelTests, RecordingTest

if TYPE_CHECKING:
    from sandbox.testing.driver import SandboxSession

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
    group.addoption("--replay-output", metavar="DIR", help="where pictures go; default: .pytest_cache/d/replays")
    parser.addini("sandbox_levels", "Files whose level checks are tests, as patterns.", "args", default=USUAL_LEVELS)
    parser.addini(
        "sandbox_against",
        "A level file on which recordings run, or a folder with one of the same name, or the word own: on the copy "
        "that each has. Default: on the level of the same name in sandbox_levels, if there is one.",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse what cannot go together, and what names nothing, before anything runs."""
    if config.getoption("--replay-update") and config.getoption("--replay-solver"):
        raise pytest.UsageError("--replay-update records with each level's own solver: leave --replay-solver out")
    level_files(config)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Recordings and golden files by names; levels that the setting names, or the command line."""
    if is_recording(file_path):
        return RecordingTest.from_parent(parent, path=file_path)
    if is_golden(file_path):
        return GoldenTest.from_parent(parent, path=file_path)
    if file_path.suffix != ".json":
        return None
    asked = parent.session.isinitpath(file_path) or file_path in level_files(parent.config)
    return LevelTests.from_parent(parent, path=file_path) if asked and is_level(file_path) else None


@pytest.fixture
def sandbox_session(request: pytest.FixtureRequest) -> "SandboxSession":
    """Begins a run of a level: a file beside the test or below the root, a shipped level's name, or a Level.

    What it gives drags, cuts, drives, runs and measures, see `sandbox.testing.Driver`.
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
        for line in _updated:
            terminalreporter.write_line(line)
        _updated.clear()
