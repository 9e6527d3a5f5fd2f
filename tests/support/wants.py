"""What tests need that is not installed everywhere: without it they are skipped, and a run says at its end how many."""

from collections import Counter
from typing import Any, NoReturn

import pytest

NEEDS = "needs "


def needs(what: str, is_there: object) -> pytest.MarkDecorator:
    """The mark of tests that need something by this name."""
    return pytest.mark.skipif(not is_there, reason=NEEDS + what)


def skip_without(what: str) -> NoReturn:
    """Skip this test: something by this name is not here."""
    pytest.skip(NEEDS + what)


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Say of each thing that was not here how many tests were skipped for want of it."""
    skipped = terminalreporter.stats.get("skipped", ())
    reasons = [report.longrepr[2].removeprefix("Skipped: ") for report in skipped]
    counts = Counter(reason.removeprefix(NEEDS) for reason in reasons if reason.startswith(NEEDS))
    for what, count in counts.most_common():
        terminalreporter.write_line(f"skipped for want of {what}: {count}")
