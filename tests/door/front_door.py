"""python -m tests.door.front_door: `make play` in a fresh clone and an empty home, with a click and a drag.

The window stands, takes both, moves, and closes with exit code 0 and nothing on the standard error. Where Xvfb or
xdotool is missing, one line says so.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.support.person import DEADLINE, HAS_A_SCREEN, VirtualScreen, Visitor, looks, stranger_environment

ROOT = Path(__file__).resolve().parents[2]
COMMAND = "make play"
# A drag, as shares of the window: from the middle of the scene up and aside.
WAY = ((0.5, 0.55), (0.55, 0.45), (0.6, 0.35), (0.4, 0.3))
# How long the first command may take to install everything [s].
INSTALLING = 300.0


def visit(visitor: Visitor) -> None:
    """Click a card of the gallery, drag in the level that opens, and leave. Raises AssertionError."""
    visitor.wait_for("Levels - Spring Sandbox", patience=INSTALLING)
    visitor.click_inside()
    visitor.wait_for(" - Spring Sandbox", without="Levels")
    width, height = visitor.size()
    before = visitor.screen.dump()
    visitor.drag([(x * width, y * height) for x, y in WAY])
    assert any(visitor.screen.dump() != before for _ in looks(DEADLINE, 0.02)), "nothing moves"
    visitor.leave()


def main() -> int:
    """Try the front door; the exit code."""
    if not HAS_A_SCREEN:
        print(f"no Xvfb and xdotool here: the window of `{COMMAND}` is not tried")
        return 0
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder / "clone")], check=True)
        (folder / "screen").mkdir()
        screen = VirtualScreen(folder / "screen")
        visitor = Visitor(screen, f"exec {COMMAND}", folder / "clone", stranger_environment(folder / "home"))
        try:
            visit(visitor)
        except AssertionError as fault:
            print(f"`{COMMAND}` in a fresh clone: {fault}", file=sys.stderr)
            return 1
        finally:
            visitor.end()
            screen.close()
    print(f"`{COMMAND}` in a fresh clone: took a click and a drag, and closed; {time.monotonic() - began:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
