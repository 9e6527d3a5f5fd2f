"""Starting toys: in this process, or each in one of its own."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.editor.storage.preferences import data_folder
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import write_level

if TYPE_CHECKING:
    from sandbox.level.document.model import Level

# The level of a toy that names none.
USUAL = "desk_toy"


def run_toy(
    find: "Callable[[], Level]", tell: Callable[[str], object], record: Path | None, seconds: float | None,
    scale: float | None, theme: str | None,
) -> None:  # fmt: skip
    """Open a toy and run it until it is closed, or for this many seconds.

    find: the level. tell: told in one line where the system cannot do what a toy needs. record: a file that it is
    recorded to. scale, theme: in place of what is remembered of the person.
    """
    from sandbox.app.settings.chosen import Chosen
    from sandbox.app.toy.toy import Toy
    from sandbox.app.toy.toy_window import ToyWindow

    level, chosen = find(), Chosen(theme=theme)
    left, bottom, right, top = level.view or (0.0, 0.0, 1.0, 1.0)
    window = ToyWindow(scale or chosen["scale"], (right - left) / max(top - bottom, 1e-9), level.name)
    for line in (*chosen.faults, window.refusal):
        if line:
            tell(line)
    toy = Toy(window, level, chosen, record)
    try:
        toy.run(seconds)
    finally:
        toy.close()


class ToyStarter:
    """Opens levels as toys, each in a process of its own, which goes on when this one ends."""

    def __init__(self) -> None:
        self._last: tuple[subprocess.Popen[bytes], Level] | None = None

    def start(self, level: "Level") -> str:
        """Open a level as a toy, unless it is the one that was opened last and still is; what came of it, in a line."""
        if self._last is not None and self._last[0].poll() is None and self._last[1] is level:
            return "The desk toy of this level is open already. Escape in it closes it."
        file = data_folder() / "toy.json"
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            write_level(level, file)
            process = subprocess.Popen([sys.executable, "-m", "sandbox", "toy", str(file)], start_new_session=True)
        except LevelError as error:
            return f"The desk toy cannot be started: {error.faults[0]}."
        except OSError as error:
            return f"The desk toy cannot be started: {error.strerror or error}."
        self._last = process, level
        return "The desk toy opens. Drag its window, and the world shakes."
