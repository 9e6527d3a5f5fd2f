"""python -m tests.door.front_door: README's two commands in a fresh clone and an empty home: to play, and to test.

The window stands, takes a click and a drag, moves, and closes with exit code 0 and nothing on the standard error. Where
Xvfb or xdotool is missing, one line says so. Tests are all found, and those of one file pass.
"""

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.support.person import DEADLINE, HAS_A_SCREEN, VirtualScreen, Visitor, looks, stranger_environment

ROOT = Path(__file__).resolve().parents[2]
# What README names: how it is played, and how its tests are run.
PLAY, TEST = "make play", "make test"
# What stands in for all tests: they are run by themselves.
SOME = "-k test_quick"
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


def play(clone: Path, folder: Path, environment: dict[str, str]) -> str:
    """Play in a clone by the window; what to say of it. Raises AssertionError."""
    if not HAS_A_SCREEN:
        return f"no Xvfb and xdotool here: the window of `{PLAY}` is not tried"
    began = time.monotonic()
    (folder / "screen").mkdir()
    screen = VirtualScreen(folder / "screen")
    visitor = Visitor(screen, f"exec {PLAY}", clone, environment)
    try:
        visit(visitor)
    finally:
        visitor.end()
        screen.close()
    return f"`{PLAY}` in a fresh clone: took a click and a drag, and closed; {time.monotonic() - began:.0f} s"


def test(clone: Path, environment: dict[str, str]) -> str:
    """Find all tests in a clone and run some; what to say of it. Raises AssertionError."""
    began = time.monotonic()
    run = subprocess.run(
        TEST, shell=True, cwd=clone, env=environment | {"PYTEST_ADDOPTS": SOME}, capture_output=True, text=True
    )
    passed = re.search(r"\b[1-9]\d* passed", run.stdout)
    assert run.returncode == 0 and passed, f"exit code {run.returncode}\n{run.stdout[-2000:]}{run.stderr[-2000:]}"
    return f"`{TEST}` in a fresh clone: found all tests, {passed[0]} of one file; {time.monotonic() - began:.0f} s"


def main() -> int:
    """Try the front door; the exit code."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"`{PLAY}`" in readme and f"`{TEST}`" in readme
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        clone, environment = folder / "clone", stranger_environment(folder / "home")
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        try:
            print(play(clone, folder, environment), flush=True)
            print(test(clone, environment))
        except AssertionError as fault:
            print(f"in a fresh clone: {fault}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
