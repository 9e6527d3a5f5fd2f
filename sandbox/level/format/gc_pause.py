"""Python's collector of cycles, which takes most of the time where many small objects are made at once."""

import contextlib
import gc
from collections.abc import Iterator


@contextlib.contextmanager
def collector_paused(pause: bool) -> Iterator[None]:
    """Let the collector rest inside, if that is asked for and it does not rest already."""
    pause = pause and gc.isenabled()
    if pause:
        gc.disable()
    try:
        yield
    finally:
        if pause:
            gc.enable()
