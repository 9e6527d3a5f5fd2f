"""Preparation: the physics is compiled on a thread of its own, so that no tick waits for it in a playing window."""

import threading

from sandbox.app.lines import warm_up_lines
from sandbox.physics.step import warm_up


class Preparation:
    """Prepares what every level needs, and what things that touch need as soon as a level has them: far more."""

    def __init__(self) -> None:
        self._for_contacts = False
        self._thread = threading.Thread(target=_prepare_all, daemon=True)
        self._thread.start()

    def is_ready(self, contacts: bool) -> bool:
        """Whether a run can begin; contacts: one in which things touch."""
        if self._thread.is_alive():
            return False
        if contacts and not self._for_contacts:
            self._for_contacts = True
            self._thread = threading.Thread(target=warm_up, daemon=True)
            self._thread.start()
            return False
        return True

    def finish(self) -> None:
        """Wait for what is being prepared."""
        self._thread.join()


def _prepare_all() -> None:
    warm_up(contacts=False)
    warm_up_lines()
