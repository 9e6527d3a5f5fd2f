"""Time limit: what takes longer of the processor's time is broken off, from whoever sent it."""

import ctypes
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

# How often it is looked at the time [s].
_EVERY = 0.05


class TimeUp(BaseException):
    """What was begun takes longer than it may; no `except Exception` on its way takes it for a fault of its own."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raises TimeUp in here as soon as this process has used more time of the processor [s].

    What other programs do counts for nothing. It strikes between two steps of Python, so between ticks and commands.
    """
    thread, end = ctypes.c_ulong(threading.get_ident()), time.process_time() + seconds
    over, lock = threading.Event(), threading.Lock()

    def watch() -> None:
        while not over.wait(_EVERY):
            with lock:
                # More than once: what cannot raise, such as the end of an object, swallows it.
                if time.process_time() > end and not over.is_set():
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(thread, ctypes.py_object(TimeUp))

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        with lock:
            over.set()
    if time.process_time() > end:
        raise TimeUp
