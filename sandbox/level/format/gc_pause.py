"""Pauses Python's collector of cycles: it takes most of the time if a program makes many small objects at once."""

import contextlib
import gc
from collections.abc import Iterator


@contextlib.contextmanager
def collector_paused(pause: bool) -> Iterator[None]:
    """Pause the collector inside, if asked, unless it is paused already."""
    pause = pause and gc.isenabled()
    if pause:
        gc.disable()
    try:
        yield
    finally:
        if pause:
            gc.enable()
