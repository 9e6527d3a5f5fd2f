"""Time limit: what takes longer of the processor's time is broken off, from whoever sent it."""

import ctypes
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

# How often the watch looks at the time, and after how long it strikes again [s].
_EVERY, _AGAIN = 0.05, 1.0


class TimeUp(BaseException):
    """What was begun takes longer than it may; no `except Exception` on its way takes it for a fault of its own."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raises TimeUp in here as soon as this process has used more time of the processor [s].

    What other programs do counts for nothing. It strikes between two steps of Python, so between ticks and commands.
    """
    thread, end = ctypes.c_ulong(threading.get_ident()), time.process_time() + seconds
    over, lock, strike = threading.Event(), threading.Lock(), ctypes.pythonapi.PyThreadState_SetAsyncExc

    def watch() -> None:
        pause = _EVERY
        while not over.wait(pause):
            with lock:
                if time.process_time() > end and not over.is_set():
                    # More than once: what cannot raise, such as the end of an object, swallows it.
                    strike(thread, ctypes.py_object(TimeUp))
                    pause = _AGAIN

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        try:
            with lock:
                over.set()
        except TimeUp:
            # Struck in here: the next strike is not yet due.
            over.set()
        strike(thread, None)
    if time.process_time() > end:
        raise TimeUp
