"""BackgroundWriter: files that a thread of its own keeps as they were noted last, while the person goes on."""

import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Generic, TypeVar

from sandbox.level.format.level_error import one_line
from sandbox.level.format.writing import refusal_of

Content = TypeVar("Content")

# Pause [s] after a write, as many times the time it took, within these bounds. With the longest write the pause is
# what the newest edit may be behind: together they stay under the promised 10 s.
_PAUSE_FACTOR = 5.0
_PAUSES = (0.25, 4.0)


class BackgroundWriter(Generic[Content]):
    """Writes the content that was noted last for each path; what cannot be written is tried again at each pause.

    noun: what is kept, for the person. write: brings a file to its content; it is called by the thread, and raises
    OSError, ValueError or MemoryError. fault: a line for the person while nothing can be written there, else None.
    """

    def __init__(self, noun: str, write: Callable[[Path, Content], None]) -> None:
        self.fault: str | None = None
        self.is_closing = False
        self._noun, self._write = noun, write
        self._changed = threading.Condition()
        # By path: the number of the note, and the content. untried: numbers of notes that nobody has tried to write.
        self._queued: dict[Path, tuple[int, Content]] = {}
        self._untried: set[int] = set()
        self._noted = self._writing = 0
        self._thread: threading.Thread | None = None

    @property
    def has_begun(self) -> bool:
        """Whether anything was noted since the writer was closed."""
        return self._thread is not None

    def note(self, path: Path, content: Content) -> None:
        """Write this content to a path soon, in place of what was noted before; returns at once."""
        with self._changed:
            self._drop(path)
            self._noted += 1
            self._queued[path] = self._noted, content
            self._untried.add(self._noted)
            if self._thread is None:
                self.is_closing = False
                self._thread = threading.Thread(target=self._work, name=f"keeps the {self._noun}", daemon=True)
                self._thread.start()
            self._changed.notify_all()

    def forget(self, path: Path) -> None:
        """Write nothing more at a path; waits until what was begun has ended."""
        with self._changed:
            self._drop(path)
        self.settle()

    def _drop(self, path: Path) -> None:
        number, _ = self._queued.pop(path, (0, None))
        if number != self._writing:
            self._untried.discard(number)

    def settle(self) -> None:
        """Wait until all that was noted is written, or cannot be."""
        with self._changed:
            self._changed.wait_for(lambda: not self._untried)

    def close(self) -> None:
        """Write the contents noted last and end."""
        with self._changed:
            self.is_closing = True
            # What could not be written has a last chance.
            self._untried.update(number for number, _ in self._queued.values())
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join()
        self._thread = None

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._queued or self.is_closing)
                if not self._queued or (self.is_closing and not self._untried):
                    self._untried.clear()
                    return
                path = next((each for each, (number, _) in self._queued.items() if number in self._untried),
                            next(iter(self._queued)))  # fmt: skip
                number, content = self._queued[path]
                self._writing = number
            start, fault = time.monotonic(), None
            try:
                self._write(path, content)
            except (OSError, ValueError, MemoryError) as error:
                why = refusal_of(error) if isinstance(error, OSError) else one_line(str(error))
                place = one_line(str(path.parent))
                fault = f"The {self._noun} cannot be kept in {place}: {why}. Save it yourself."
            shortest, longest = _PAUSES
            pause = longest if fault else min(max(_PAUSE_FACTOR * (time.monotonic() - start), shortest), longest)
            with self._changed:
                self.fault, self._writing = fault, 0
                self._untried.discard(number)
                if self._queued.get(path, (0,))[0] == number:
                    kept = self._queued.pop(path)
                    if fault is not None:
                        self._queued[path] = kept
                self._changed.notify_all()
                # A file that goes on changing waits; where another one is noted meanwhile, that is the next.
                self._changed.wait_for(partial(self._is_pressed, path), pause)

    def _is_pressed(self, path: Path) -> bool:
        return self.is_closing or any(
            other != path and number in self._untried for other, (number, _) in self._queued.items()
        )
