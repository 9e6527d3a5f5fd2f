"""Preparation: the physics is compiled on a thread of its own, so that no tick waits for it in a playing window."""

import threading

from sandbox.app.lines import warm_up_lines
from sandbox.physics.step import warm_up


class Preparation:
    """Prepares what every level needs, and then what things that touch need, which is as much again."""

    def __init__(self) -> None:
        self._basics = threading.Event()
        self._all = threading.Event()
        threading.Thread(target=self._prepare, daemon=True).start()

    def _prepare(self) -> None:
        warm_up(contacts=False)
        warm_up_lines()
        self._basics.set()
        warm_up()
        self._all.set()

    def is_ready(self, contacts: bool) -> bool:
        """Whether a run can begin; contacts: one in which things touch."""
        return (self._all if contacts else self._basics).is_set()

    def finish(self, contacts: bool = False) -> None:
        """Wait until a run can begin."""
        (self._all if contacts else self._basics).wait()
