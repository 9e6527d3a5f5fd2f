"""Failure: something that goes wrong in a run, told tick by tick, so that smaller runs can be tried for the same."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from sandbox.session.session import Session


class FailureError(ValueError):
    """A failure that cannot be looked for in a level; one line."""


@dataclass(frozen=True, repr=False)
class FailureSeen:
    """A failure that was seen. failure: this very one, which smaller runs must have; text: what is wrong, a line."""

    failure: "Failure"
    text: str

    def __repr__(self) -> str:
        return self.text


class FailureWatch:
    """Looks for a failure in one run. is_over: whether it cannot come any more, so that the run may end."""

    is_over = False

    def before(self) -> None:
        """Look at the state that the next tick begins with; its commands are carried out."""

    def after(self) -> FailureSeen | None:
        """Look at the state that a tick has ended with; what has failed in it."""
        return None

    def keep(self) -> Any:
        """All that it remembers of the run until now, for a watch of another run that goes on from the same state."""
        return None


class Failure(ABC):
    """What goes wrong; a value that other processes can be given. Its text says it in a few words.

    beyond: ticks after the end of a recording in which it may show.
    """

    beyond = 0

    @abstractmethod
    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        """FailureWatch a run from its beginning, or from a state at which another watch gave what it kept.

        Raises FailureError where the level has nothing of the kind.
        """

    def raised(self, error: Exception) -> FailureSeen | None:
        """What has failed where a tick raises an exception; None: that is another failure than this one."""
        return None
