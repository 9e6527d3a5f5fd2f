"""Interrupts in tests: the same wherever a run of tests was started, also by a shell that ignores or blocks them."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts(how) -> Iterator[None]:
    """In here SIGINT is not blocked, and does this; processes started in here inherit it as from a shell."""
    mask = signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT}) if hasattr(signal, "pthread_sigmask") else None
    previous = signal.signal(signal.SIGINT, how)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous)
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
