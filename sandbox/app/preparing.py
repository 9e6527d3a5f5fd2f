"""Preparation: the physics is compiled on threads of its own, so that no tick waits for it in a playing window."""

import threading

from sandbox.app.draw.lines import warm_up_lines
from sandbox.physics.step import warm_up


class Preparation:
    """Prepares what every level needs, and what things that touch need, as much again, once that is asked for."""

    def __init__(self) -> None:
        self._basics = threading.Thread(target=_prepare_basics, daemon=True)
        self._basics.start()
        self._contacts: threading.Thread | None = None

    def is_ready(self, contacts: bool) -> bool:
        """Whether a run can begin; contacts: one in which things touch, which is prepared from then on."""
        if self._basics.is_alive():
            return False
        return not contacts or not self._prepare_contacts().is_alive()

    def finish(self, contacts: bool = False) -> None:
        """Wait until a run can begin."""
        self._basics.join()
        if contacts:
            self._prepare_contacts().join()

    def _prepare_contacts(self) -> threading.Thread:
        if self._contacts is None:
            self._contacts = threading.Thread(target=warm_up, daemon=True)
            self._contacts.start()
        return self._contacts


def _prepare_basics() -> None:
    warm_up(contacts=False)
    warm_up_lines()
