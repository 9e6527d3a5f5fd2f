"""What is done to a run whole or not at all: to be given up while it is under way, and to be taken back then."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from sandbox.session.log import LogEntry


class Interrupted(Exception):
    """Raised by `Session.progress` to give up what a session is doing, which is then as it was before."""


@contextmanager
def whole(
    owner: object, names: Iterable[str], put_back: Callable[[], object], entries: Iterable[LogEntry] = ()
) -> Iterator[None]:
    """Do something whole; where it is interrupted, give an object its attributes of these names again.

    put_back: called then, too. entries: whose effects are given back.
    """
    attributes = {name: _copied(getattr(owner, name)) for name in names}
    effects = [(entry, entry.in_effect, entry.implied) for entry in entries]
    try:
        yield
    except Interrupted:
        for name, value in attributes.items():
            setattr(owner, name, value)
        for entry, in_effect, implied in effects:
            entry.in_effect, entry.implied = in_effect, implied
        put_back()
        raise


def _copied(value: Any) -> Any:
    """As it is now, also where it changes in place, as do the lists in a dictionary."""
    if isinstance(value, dict):
        return {key: _copied(each) for key, each in value.items()}
    return value.copy() if hasattr(value, "copy") else value
