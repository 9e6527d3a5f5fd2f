"""The plugin of pytest: recordings and the checks of levels are tests; a fixture plays levels.

It is loaded in every project of an environment, so nothing here takes long to import. A file is taken for a recording
by its name, for a level by where it lies, unless it says that it is something else.
"""

import os
from collections import deque
from collections.abc import Generator
from dataclasses import astuple
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from sandbox.session.replay import is_recording
from sandbox.testing.evidence import CHOICES, FIRST, is_of_here, runs_of
from sandbox.testing.files import (
    USUAL_LEVELS,
    asked_renames,
    fits,
    has_test,
    is_asked_level,
    is_golden,
    is_level,
    level_files,
    marked,
    why_untested,
)
from sandbox.testing.items import GoldenTest, LevelTests, RecordingTest

if TYPE_CHECKING:
    from sandbox.testing.driver import Driver, LevelLike, SandboxSession

MARKERS = (
    "replay: the test of a recording, which runs again bit for bit",
    "level: a test of a level file: that it is valid, or one of its checks",
    "golden: the test of a golden file, whose values come out again within their tolerances",
)
# Recordings that --replay-update wrote, with what changed, as lines; workers of xdist hand them to the first process.
UPDATED = "sandbox_updated"
# Runs of one test in Python that are kept where it fails, the last ones.
RUNS_KEPT = 3
_RUNS: "pytest.StashKey[deque[Driver]]" = pytest.StashKey()
# Files that look like tests and are none, with the reason; and folders that were looked at.
_UNTESTED = pytest.StashKey[dict[str, str]]()
_FOLDERS = pytest.StashKey[set[Path]]()
# What the page of all failures has of each, and of how many tests there are results.
_FAILURES: pytest.StashKey[list[tuple[Any, ...]]] = pytest.StashKey()
# So many of them are listed.
MOST_UNTESTED = 20


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
    group.addoption(
        "--replay-pictures",
        choices=CHOICES,
        default="first",
        help=f"of which failures there are pictures, recordings and pages; default: of the first {FIRST}",
    )
    group.addoption(
        "--replay-report", metavar="FILE.html", help="write a page of all failures, which plays both runs of each"
    )
    group.addoption(
        "--replay-github", action="store_true", help="annotate files on GitHub, and write the summary of the job"
    )
    parser.addini("sandbox_levels", "Files whose level checks are tests, as patterns.", "args", default=USUAL_LEVELS)
    parser.addini(
        "sandbox_against",
        "A level file on which recordings run, or a folder with one of the same name, or the word own: on the copy "
        "that each has. Default: on the level of the same name in sandbox_levels, if there is one.",
    )
    parser.addini(
        "sandbox_marks",
        "Marks of recordings and levels, a line each: a mark, a colon, and a pattern of files from the root on.",
        "linelist",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse what cannot go together, and what names nothing, before anything runs."""
    config.stash[_UNTESTED], config.stash[_FOLDERS], config.stash[_FAILURES] = {}, set(), []
    for line in MARKERS:
        config.addinivalue_line("markers", line)
    if hasattr(config, "workerinput"):
        # One of the processes of xdist: cores are theirs already.
        os.environ.setdefault("SANDBOX_THREADS", "1")
    solver = config.getoption("--replay-solver")
    if solver:
        _refuse_unknown_solver(solver)
    if config.getoption("--replay-update") and config.getoption("--replay-solver"):
        raise pytest.UsageError("--replay-update records with each level's own solver: leave --replay-solver out")
    back = config.getoption("--replay-rollback")
    if back is not None and back < 1:
        raise pytest.UsageError(f"--replay-rollback: {back}: at least 1 tick")
    asked_renames(config)
    level_files(config)
    marked(config)


def _refuse_unknown_solver(name: str) -> None:
    from sandbox.physics.settings import SOLVER_NAMES

    if name not in SOLVER_NAMES:
        raise pytest.UsageError(f"--replay-solver: there is no solver {name!r}; there are {', '.join(SOLVER_NAMES)}")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Recordings and golden files by names; levels that the setting names, or the command line."""
    _note_untested(parent.config, file_path)
    if is_recording(file_path):
        if has_test(file_path):
            return None
        return RecordingTest.from_parent(parent, path=file_path)
    if is_golden(file_path):
        return GoldenTest.from_parent(parent, path=file_path)
    if file_path.suffix != ".json":
        return None
    asked = parent.session.isinitpath(file_path) or is_asked_level(parent.config, file_path)
    return LevelTests.from_parent(parent, path=file_path) if asked and is_level(file_path) else None


def _note_untested(config: pytest.Config, path: Path) -> None:
    """Note a file that looks like a test and is none."""
    config.stash[_FOLDERS].add(path.parent)
    why = why_untested(path)
    if why is not None:
        root = config.rootpath
        name = path.relative_to(root).as_posix() if path.is_relative_to(root) else str(path)
        config.stash[_UNTESTED][name] = why


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Note links to nothing, which pytest passes over; and where all is collected, marks that fit nothing."""
    seen = config.stash[_FOLDERS]
    for folder in seen | {each for path in seen for each in path.parents if each.is_relative_to(config.rootpath)}:
        for each in folder.iterdir():
            if each.is_symlink() and not each.exists():
                _note_untested(config, each)
    if config.args_source is config.ArgsSource.ARGS:
        return
    for mark, pattern in marked(config):
        if not any(fits(config, item.path, pattern) for item in items):
            config.stash[_UNTESTED][f"{mark}: {pattern}"] = "sandbox_marks: fits no recording and no level"


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Hand what is not tested, and what failed, to the first process of xdist."""
    output = getattr(session.config, "workeroutput", None)
    if output is not None:
        output["sandbox_untested"] = session.config.stash[_UNTESTED]
        output["sandbox_failures"] = session.config.stash[_FAILURES]


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Take over what a process of xdist found that is not tested."""
    output = getattr(node, "workeroutput", {})
    node.config.stash[_UNTESTED].update(output.get("sandbox_untested", {}))
    node.config.stash[_FAILURES] += output.get("sandbox_failures", [])


@pytest.fixture
def sandbox_session(request: pytest.FixtureRequest) -> "SandboxSession":
    """Begins a run of a level: a file beside the test or below the root, a shipped level's name, or a Level.

    What it gives drags, cuts, drives, runs and measures, see `sandbox.testing.Driver`.
    """
    from sandbox.testing.driver import Driver, found_level

    folders = [request.path.parent, request.config.rootpath]
    runs = request.node.stash.setdefault(_RUNS, deque(maxlen=RUNS_KEPT))

    def begin(level: "LevelLike") -> Driver:
        driver = Driver(found_level(level, folders))
        runs.append(driver)
        return driver

    return begin


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, Any, Any]:
    """Keep the runs of a test in Python that fails, and what a page of all failures has of any."""
    report = yield
    if report.failed and (item.config.getoption("--replay-report") or item.config.getoption("--replay-github")):
        from sandbox.session.player.report import ReportedFailure

        lines = [line for line in report.longreprtext.splitlines() if not is_of_here(line)]
        found = getattr(call.excinfo.value, "found", None) if call.excinfo else None
        item.config.stash[_FAILURES].append(astuple(ReportedFailure.of(item.nodeid, lines, found)))
    runs = item.stash.get(_RUNS, None)
    if runs and report.when == "call" and report.failed:
        reason = call.excinfo.exconly() if call.excinfo else ""
        lines = runs_of(item.config, item.nodeid, [run.session for run in runs], reason)
        if lines:
            report.sections.append(("Spring Sandbox", "\n".join(lines)))
    return report


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Gather what was recorded again; in the first process, whichever process did it."""
    if report.when == "call":
        _updated.extend(str(value) for name, value in report.user_properties if name == UPDATED)


_updated: list[str] = []


def _tell_failures(terminalreporter: Any, config: pytest.Config) -> None:
    """Write the page of all failures, and tell GitHub of them."""
    from sandbox.session.player.github import tell_github
    from sandbox.session.player.report import ReportedFailure, write_report

    failures = sorted((ReportedFailure(*each) for each in config.stash[_FAILURES]), key=lambda each: each.name)
    stats = terminalreporter.stats
    tests = sum(len(stats.get(kind, ())) for kind in ("passed", "failed", "error"))
    page = config.getoption("--replay-report")
    try:
        lines = tell_github(failures, tests, config.rootpath) if config.getoption("--replay-github") else []
        lines += [write_report(failures, tests, config.invocation_params.dir / page)] if page else []
    except OSError as error:
        lines = [f"{error.filename or page}: cannot be written: {error.strerror or error}"]
    for line in lines:
        terminalreporter.write_line(line)


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """List the recordings that were recorded again, and what looks like a test and is none."""
    if _updated:
        from sandbox.testing.replaying import grouped

        terminalreporter.section("recorded again")
        for line in grouped(_updated):
            terminalreporter.write_line(line)
        _updated.clear()
    if config.getoption("--replay-report") or config.getoption("--replay-github"):
        _tell_failures(terminalreporter, config)
    untested = sorted(config.stash[_UNTESTED].items())
    if untested:
        terminalreporter.section("not tested")
        for name, why in untested[:MOST_UNTESTED]:
            terminalreporter.write_line(f"not tested: {name}: {why}")
        if len(untested) > MOST_UNTESTED:
            terminalreporter.write_line(f"not tested: {len(untested) - MOST_UNTESTED} more")
