"""Tests that are files: a recording, and what a level promises of itself."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from sandbox.testing.files import Failed, asked_renames, check_names, has_solution, marks_of, says_it_is_a_level

if TYPE_CHECKING:
    from sandbox.level.checks import CheckResult
    from sandbox.level.document.model import Level

# The tests of a level that are no checks.
VALID, GOAL = "is valid", "goal"
# Told where a file does not even say that it is a level.
ELSEWHERE = "it lies where levels lie; if it is something else, keep it elsewhere, or name levels by sandbox_levels"


class ReportedItem(pytest.Item):
    """A test whose failures are told in lines; mark: what all of its kind have."""

    mark = "level"

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        for name in (self.mark, *marks_of(self.config, self.path)):
            self.add_marker(name)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The lines of a failure that this plugin has found; anything else with its traceback."""
        if isinstance(excinfo.value, Failed):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """File, line and name of the test, for pytest's report."""
        return self.path, 0, self.name


class RecordingTest(pytest.File):
    """Collects the one test of a recording."""

    def collect(self) -> Iterator[pytest.Item]:
        """The test."""
        yield ReplayItem.from_parent(self, name="replay")


class ReplayItem(ReportedItem):
    """A recording runs again, bit for bit."""

    mark = "replay"

    def runtest(self) -> None:
        """Verify the recording. Raises Failed."""
        from sandbox.testing.replaying import replay_test

        updated = replay_test(self.config, self.path)
        if updated is not None:
            self.user_properties.append(("sandbox_updated", updated.to_text()))


class LevelTests(pytest.File):
    """Collects the tests of a level file: that it can be built, and each of its checks."""

    _running: "Iterator[tuple[int, CheckResult] | None] | None" = None

    def collect(self) -> Iterator[pytest.Item]:
        """A test that it is a level, and one a check."""
        yield LevelItem.from_parent(self, name=VALID)
        taken = {VALID, GOAL}
        for number, check in enumerate(check_names(self.path)):
            # An id is of one test, and "::" is between its parts.
            name = check.replace("::", ":")
            name = f"{name}, check {number + 1}" if name in taken else name
            taken.add(name)
            yield CheckItem.from_parent(self, name=name, number=number)
        if has_solution(self.path):
            yield GoalItem.from_parent(self, name=GOAL)

    def result(self, number: int) -> "CheckResult":
        """The result of a check; all of the file are measured in the same run, as far as needed. Raises Failed."""
        if self._running is None:
            from sandbox.session.check_run import checks_as_they_end
            from sandbox.testing.replaying import with_solver

            try:
                level = self.level()
            except Failed:
                raise Failed(f"{self.path.name} is no level, see its test {VALID!r}") from None
            self._running = checks_as_they_end(with_solver(self.config, level))
            self._results: dict[int, CheckResult] = {}
        while number not in self._results:
            self._results.update(filter(None, [next(self._running)]))
        return self._results[number]

    def level(self) -> "Level":
        """The level. Raises Failed with its faults."""
        from sandbox.testing.replaying import level_of

        return level_of(self.path)


class LevelItem(ReportedItem):
    """A level is read and built without a fault."""

    def runtest(self) -> None:
        """Build the level. Raises Failed."""
        from sandbox.level.assembly.build_world import build_world
        from sandbox.testing.replaying import check_rollback_of_level

        assert isinstance(self.parent, LevelTests)
        try:
            level = self.parent.level()
            build_world(level)
        except Failed as error:
            if says_it_is_a_level(self.path):
                raise
            raise Failed(str(error), ELSEWHERE) from None
        check_rollback_of_level(self.config, level)


class CheckItem(ReportedItem):
    """A check of a level holds."""

    def __init__(self, *, number: int, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.number = number

    def runtest(self) -> None:
        """Run the check. Raises Failed."""
        assert isinstance(self.parent, LevelTests)
        result = self.parent.result(self.number)
        if not result.passed:
            raise Failed(result.text)


class GoalItem(ReportedItem):
    """The test that the solution beside a level wins it."""

    def runtest(self) -> None:
        """Run the solution. Raises Failed."""
        from sandbox.session.solution import try_goal

        assert isinstance(self.parent, LevelTests)
        result = try_goal(self.parent.level(), self.path)
        if result is None:
            raise Failed("no rule of the level wins, but a solution lies beside it")
        if not result.passed:
            raise Failed(f"goal {result.text}")


class GoldenTest(pytest.File):
    """Collects the one test of a golden file."""

    def collect(self) -> Iterator[pytest.Item]:
        """The test."""
        yield GoldenItem.from_parent(self, name="golden")


class GoldenItem(ReportedItem):
    """The test that a golden file's values come out again, within its tolerances."""

    mark = "golden"

    def runtest(self) -> None:
        """Compare with the golden file. Raises Failed."""
        from sandbox.level.format.level_error import LevelError
        from sandbox.session.golden import GoldenError, differences, read_golden, write_golden
        from sandbox.session.replay.recording import ReplayError
        from sandbox.testing.replaying import Update, acceptance, rename_hint, with_solver

        try:
            recorded = read_golden(self.path)
            golden = recorded.carried_over(asked_renames(self.config))
            measured = golden.measured(with_solver(self.config, golden.level))
        except (GoldenError, LevelError, ReplayError) as error:
            missing = getattr(error, "missing", "")
            raise Failed(*error.faults, *([rename_hint(self.config, self.path, missing)] if missing else [])) from None
        old_names, new_names = ([*each.file.places, *each.file.values] for each in (recorded, golden))
        pairs = zip(old_names, new_names, strict=True)
        renamed = [f"{old} is called {new} now" for old, new in pairs if old != new]
        found = [*renamed, *differences(golden.file, measured)]
        if not found:
            return
        if not self.config.getoption("--replay-update"):
            raise Failed(*(f"{self.path.name}: {line}" for line in found), acceptance(self.config, self.path))
        try:
            write_golden(self.path, measured)
        except OSError as error:
            raise Failed(f"{self.path}: cannot be written: {error.strerror or error}") from None
        update = Update(self.path.name, [f"{self.path.name}: {line}" for line in found], "recorded as it is now")
        self.user_properties.append(("sandbox_updated", update.to_text()))
