"""Failure: a fault of the program's own in a frame is written down and told, and the work goes on."""

import contextlib
import platform
import time
import traceback
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from sandbox.app.base.desktop import copy_text
from sandbox.app.contracts.application import Application
from sandbox.app.widgets.dialogs import choose
from sandbox.editor.storage.preferences import data_folder
from sandbox.level.format.level_error import one_line

# This many faults within this time [s], and no frame can be trusted any more.
MOST, WITHIN = 3, 4.0
# Reports that are kept, the latest.
KEPT = 20


def reports_folder() -> Path:
    """Where reports of faults lie."""
    return data_folder() / "reports"


class FrameGuard:
    """Keeps the program alive through faults of its own; report: the text of the last one."""

    def __init__(self, app: Application) -> None:
        self._app = app
        self._times: list[float] = []
        self.report = ""

    def take(self, error: Exception) -> None:
        """Write a fault down and tell of it. Raises SystemExit where one follows another: then nothing else helps."""
        now = time.monotonic()
        self._times = [*(each for each in self._times if now - each < WITHIN), now]
        where = self._write_down(error)
        if len(self._times) >= MOST:
            raise SystemExit(f"Too many things failed, so the program closes. Your work is kept.{where}") from error
        try:
            # What the frame was at may be half done.
            self._app.rebuild()
        except Exception as again:
            message = f"The program cannot go on, and closes. Your work is kept.{self._write_down(again)}"
            raise SystemExit(message) from again
        text = (
            f"Something in the program failed ({one_line(f'{type(error).__name__}: {error}')[:120]}). "
            f"Your work is kept.{where}"
        )
        choices = [
            ("Go on", lambda: None), ("Copy the report", self._copy), ("Close the program", self._app.quit),
        ]  # fmt: skip
        choose(self._app.ui, "Something went wrong", text, choices)

    def _write_down(self, error: Exception) -> str:
        """Write a report; a sentence that says where it is."""
        self.report = _report(error)
        path = _kept(self.report)
        return f" A report is in {path}." if path is not None else ""

    def _copy(self) -> None:
        copied = copy_text(self.report)
        self._app.say("The report is on the clipboard." if copied else "The clipboard is not available here.")


def _report(error: Exception) -> str:
    with contextlib.suppress(PackageNotFoundError):
        program = f"Spring Sandbox {version('spring-sandbox')}"
        return "\n".join([program, platform.platform(), f"Python {platform.python_version()}", "", *_lines(error)])
    return "\n".join(_lines(error))


def _lines(error: Exception) -> list[str]:
    return "".join(traceback.format_exception(error)).splitlines()


def _kept(report: str) -> Path | None:
    """Write a report; None where that cannot be."""
    folder = reports_folder()
    path = folder / f"{datetime.now():%Y-%m-%d %H-%M-%S}.txt"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.write_text(report + "\n", encoding="utf-8")
        for old in sorted(folder.glob("*.txt"))[:-KEPT]:
            old.unlink(missing_ok=True)
    except OSError:
        return None
    return path
