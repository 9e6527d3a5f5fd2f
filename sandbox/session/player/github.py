"""What GitHub shows of failures: annotations, and a summary of the job."""

import os
from collections.abc import Sequence
from pathlib import Path

from sandbox.session.player.report import ReportedFailure

# Failures that the summary tells whole, at most; GitHub shows no more than a megabyte of it.
MOST_TOLD = 50


def tell_github(failures: Sequence[ReportedFailure], tests: int, folder: Path) -> list[str]:
    """Write the summary where GitHub asks for it; the lines of the annotations, to be printed.

    folder: from which the names of the failures are seen. Raises OSError.
    """
    summary = os.environ.get("GITHUB_STEP_SUMMARY")
    if summary:
        with open(summary, "a", encoding="utf-8") as file:
            file.write(_summary(failures, tests))
    root = Path(os.environ.get("GITHUB_WORKSPACE", Path.cwd()))
    return [_annotation(each, os.path.relpath(folder / each.name.partition("::")[0], root)) for each in failures]


def _annotation(failure: ReportedFailure, file: str) -> str:
    place = _escaped(Path(file).as_posix()).replace(":", "%3A").replace(",", "%2C")
    title = _escaped(failure.cause).replace(":", "%3A").replace(",", "%2C")
    return f"::error file={place},title={title}::{_escaped(chr(10).join(failure.lines))}"


def _escaped(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _summary(failures: Sequence[ReportedFailure], tests: int) -> str:
    """The job's summary, in Markdown; text as code, so that it is shown as it is."""
    lines = [f"### Spring Sandbox: {len(failures)} of {tests} tests failed", ""]
    for each in failures[:MOST_TOLD]:
        # Indented text is code whatever is in it.
        lines += [f"**`{each.name.replace('`', chr(39))}`**", "", *(f"    {line}" for line in each.lines), ""]
    if len(failures) > MOST_TOLD:
        lines.append(f"{len(failures) - MOST_TOLD} more are in the report.")
    return "\n".join(lines) + "\n"
