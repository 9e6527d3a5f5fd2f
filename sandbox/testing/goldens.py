"""Tests that are golden files: they run and are compared within their tolerances, or are recorded again."""

from collections.abc import Iterator

import pytest

from sandbox.testing.failed import Failed
from sandbox.testing.items import ToldItem
from sandbox.testing.updates import Update


class GoldenTest(pytest.File):
    """A golden file, which is one test."""

    def collect(self) -> Iterator[pytest.Item]:
        """The test."""
        yield GoldenItem.from_parent(self, name="golden")


class GoldenItem(ToldItem):
    """What a golden file holds comes out again, within its tolerances."""

    mark = "golden"

    def runtest(self) -> None:
        """Run it. Raises Failed."""
        from sandbox.level.format.level_error import LevelError
        from sandbox.session.golden import GoldenError, differences, read_golden, write_golden
        from sandbox.session.replay.recording import ReplayError
        from sandbox.testing.replaying import with_solver

        try:
            golden = read_golden(self.path)
            measured = golden.measured(with_solver(self.config, golden.level))
        except (GoldenError, LevelError, ReplayError) as error:
            raise Failed(*error.faults) from None
        found = differences(golden.file, measured)
        if not found:
            return
        if not self.config.getoption("--replay-update"):
            raise Failed(*(f"{self.path.name}: {line}" for line in found), "to accept: pytest --replay-update")
        try:
            write_golden(self.path, measured)
        except OSError as error:
            raise Failed(f"{self.path}: cannot be written: {error.strerror or error}") from None
        update = Update(self.path.name, [f"{self.path.name}: {line}" for line in found], "recorded as it is now")
        self.user_properties.append(("sandbox_updated", update.to_text()))
