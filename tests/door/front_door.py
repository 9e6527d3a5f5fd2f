"""python -m tests.door.front_door: `make play` in a fresh clone and an empty home, with a click and a drag.

The window stands, takes both, moves, and closes with exit code 0 and nothing on the standard error. Where Xvfb or
xdotool is missing, one line says so.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.support.person import DEADLINE, VirtualScreen, Visitor, looks

ROOT = Path(__file__).resolve().parents[2]
COMMAND = "make play"
# Of the person who runs this, and no stranger's.
OWN = ("XDG_", "SANDBOX_", "PYTEST", "VIRTUAL_ENV", "PYTHONPATH", "MAKE", "MFLAGS")
# A drag, as shares of the window: from the middle of the scene up and aside.
WAY = ((0.5, 0.55), (0.55, 0.45), (0.6, 0.35), (0.4, 0.3))
# How long the first command may take to install everything [s].
INSTALLING = 300.0


def stranger_environment(home: Path) -> dict[str, str]:
    """The variables of somebody who has never been here."""
    home.mkdir(exist_ok=True)
    kept = {name: value for name, value in os.environ.items() if not name.startswith(OWN)}
    return {**kept, "HOME": str(home)}


def visit(visitor: Visitor) -> None:
    """Click a card of the gallery, drag in the level that opens, and leave. Raises AssertionError."""
    for _ in looks(INSTALLING, 1.0):
        if "Levels - Spring Sandbox" in visitor.title():
            break
        assert visitor.app.poll() is None, b"\n".join(visitor.app.communicate()).decode()
    visitor.wait_for("Levels - Spring Sandbox")
    visitor.click_inside()
    visitor.wait_for(" - Spring Sandbox", without="Levels")
    width, height = visitor.size()
    before = visitor.screen.dump()
    visitor.drag([(x * width, y * height) for x, y in WAY])
    assert any(visitor.screen.dump() != before for _ in looks(DEADLINE, 0.02)), "nothing moves"
    visitor.leave()


def main() -> int:
    """Try the front door; the exit code."""
    if not (shutil.which("Xvfb") and shutil.which("xdotool")):
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
