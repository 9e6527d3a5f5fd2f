"""How programs start: what commands take, when the app has words, the first page and the first tick, and how long its
window stands still.

Wall time counts what else the machine does; processor time is that of the app alone, its children not among it.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

# What is started again and again; the median is of so many starts.
COMMANDS = (
    ("--help",), ("check", "rope"), ("check", "dominoes"), ("run", "rope", "--seconds", "5", "--json"),
    ("run", "dominoes", "--seconds", "1", "--json"),
)  # fmt: skip
STARTS = 7
ROOT = Path(__file__).resolve().parents[2]
SECONDS = 4.0
PROGRAM = """
import sys, time
began = float(sys.argv.pop(1))
from sandbox.app.base.loop import Profile
plain = Profile.reached
def reached(profile, what):
    if what not in profile.first_times:
        print(f"  {what}: {time.perf_counter() - began:.2f} s, {time.process_time():.2f} s of processor time")
    plain(profile, what)
Profile.reached = reached
from sandbox.cli import program
program()
"""


def start(*arguments: str, cache: str) -> None:
    """Print when a start comes to what; cache: where the user's caches are."""
    environment = {**os.environ, "SDL_VIDEODRIVER": "dummy", "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": cache}
    environment |= {"PYGAME_HIDE_SUPPORT_PROMPT": "1"}
    command = [sys.executable, "-c", PROGRAM, str(time.perf_counter()), "play", *arguments]
    ended = subprocess.run(
        [*command, "--profile", "--seconds", str(SECONDS)], cwd=ROOT, env=environment, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    kept = [line for line in ended.stdout.splitlines() if line.startswith(("  ", "longest"))]
    print("\n".join(kept))


def spent(arguments: Sequence[str], environment: Mapping[str, str]) -> float:
    """Processor time [s] of a command and of the processes that it starts."""
    before = os.times()
    command = [sys.executable, "-m", "sandbox", *arguments]
    subprocess.run(command, cwd=ROOT, env=environment, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def main() -> None:
    """Start with empty caches, then with filled ones."""
    for arguments in ((), ("rope",), ("dominoes",)):
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as cache:
            for what in ("empty caches:", "filled caches:"):
                print(what, *arguments)
                start(*arguments, cache=cache)
    with tempfile.TemporaryDirectory() as cache:
        for command in COMMANDS:
            times = sorted(spent(command, {**os.environ, "XDG_CACHE_HOME": cache}) for _ in range(STARTS))
            print(*command, f"- {times[STARTS // 2]:.2f} s of processor time, at least {times[0]:.2f}")


if __name__ == "__main__":
    main()
