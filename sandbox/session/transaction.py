"""Doing something to a run whole or not at all: it can be given up while it is under way, and is taken back then."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Interrupted(Exception):
    """Raised by `Session.progress` to give up what a session is doing, which is then as it was before."""


@contextmanager
def all_or_nothing(put_back: Callable[[], object]) -> Iterator[None]:
    """Do something whole or not at all: where it is interrupted, `put_back` is called."""
    try:
        yield
    except Interrupted:
        put_back()
        raise
