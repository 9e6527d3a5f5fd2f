"""Runs of a sweep in child processes of low priority, for a program that has something else to do meanwhile.

`python -m sandbox.session.sweep.background` is such a child: it reads a request and its points, and prints rows.
"""

import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sandbox.physics.jit import work_beside_others
from sandbox.session.sweep.grid import SweepError, SweepGrid, SweepRequest
from sandbox.session.sweep.running import run_case

# How much nicer than others a child is.
NICENESS = 10
# The package that children import is this one, wherever they are started.
_HOME = Path(__file__).resolve().parents[3]


class BackgroundSweep:
    """Runs points of a grid by their numbers, those named first soonest, in this many children; nothing here waits.

    error: the reason why it cannot go on. Raises OSError where no child can be started.
    """

    def __init__(self, grid: SweepGrid, numbers: Sequence[int], processes: int) -> None:
        self.error: str | None = None
        self._remaining = len(numbers)
        self._rows: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._children: list[subprocess.Popen[str]] = []
        for part in (numbers[first::processes] for first in range(processes)):
            if part:
                points = [[number, grid.cases[number]] for number in part]
                self._start(json.dumps({"request": asdict(grid.request), "points": points}))

    @property
    def is_done(self) -> bool:
        """Whether all rows have been given out."""
        return self._remaining == 0

    def new_rows(self) -> list[tuple[int, list[Any]]]:
        """The rows that have come since the last time, by number."""
        found: list[tuple[int, list[Any]]] = []
        with contextlib.suppress(queue.Empty):
            while True:
                line = self._rows.get_nowait()
                if isinstance(line, str):
                    self.error = line
                else:
                    found.append((line[0], line[1]))
        self._remaining -= len(found)
        return found

    def stop(self) -> None:
        """End the children; rows that have not come are lost."""
        for child in self._children:
            child.kill()
        self._children = []

    def _start(self, task: str) -> None:
        options: dict[str, Any] = {"start_new_session": True}
        if sys.platform == "win32":
            options = {"creationflags": subprocess.BELOW_NORMAL_PRIORITY_CLASS}
        path = os.pathsep.join(filter(None, (str(_HOME), os.environ.get("PYTHONPATH"))))
        child = subprocess.Popen(
            [sys.executable, "-m", "sandbox.session.sweep.background"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, text=True, env={**os.environ, "PYTHONPATH": path}, **options,
        )  # fmt: skip
        self._children.append(child)
        threading.Thread(target=self._talk, args=(child, task), daemon=True).start()

    def _talk(self, child: "subprocess.Popen[str]", task: str) -> None:
        assert child.stdin is not None and child.stdout is not None
        with contextlib.suppress(OSError, ValueError):
            # It stays open: the child ends where it closes, as it does with this program.
            child.stdin.write(task + "\n")
            child.stdin.flush()
            for line in child.stdout:
                self._rows.put(json.loads(line))
        if child.wait() > 0:
            self._rows.put(f"a process of the sweep has ended with code {child.returncode}")
        with contextlib.suppress(OSError):
            child.stdin.close()


def _leave_with_parent() -> None:
    # Not by sys.stdin, whose lock would be held where this process comes to its own end.
    while os.read(0, 4096):
        pass
    os._exit(0)


def main() -> None:
    """Run the points that standard input asks for."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    work_beside_others()
    task = json.loads(sys.stdin.readline())
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    asked = task["request"]
    request = SweepRequest(**{**asked, "columns": tuple(asked["columns"])})
    for number, case in task["points"]:
        try:
            answer: Any = [number, run_case(request, case)]
        except SweepError as error:
            print(json.dumps(str(error)), flush=True)
            return
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
