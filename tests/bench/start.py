"""How the app starts: when there are words, the first page and the first tick, and how long the window stands still.

Wall time counts what else the machine does; processor time is that of the app alone, its children not among it.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 4.0
PROGRAM = """
import sys, time
began = float(sys.argv.pop(1))
from sandbox.app.profile import Profile
plain = Profile.reached
def reached(profile, what):
    if what not in profile.first_times:
        print(f"  {what}: {time.perf_counter() - began:.2f} s, {time.process_time():.2f} s of processor time")
    plain(profile, what)
Profile.reached = reached
from sandbox.cli import main
main(sys.argv[1:])
"""


def start(*arguments: str, cache: str) -> None:
    """Print when a start comes to what; cache: where the user's caches are."""
    environment = {**os.environ, "SDL_VIDEODRIVER": "dummy", "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": cache}
    environment |= {"NUMBA_CACHE_DIR": cache, "PYGAME_HIDE_SUPPORT_PROMPT": "1"}
    command = [sys.executable, "-c", PROGRAM, str(time.perf_counter()), "play", *arguments]
    ended = subprocess.run(
        [*command, "--profile", "--seconds", str(SECONDS)], cwd=ROOT, env=environment, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    kept = [line for line in ended.stdout.splitlines() if line.startswith(("  ", "longest"))]
    print("\n".join(kept))


def main() -> None:
    """Start with empty caches, then with filled ones."""
    with tempfile.TemporaryDirectory() as cache:
        for arguments in ((), ("rope",)):
            print("empty caches:", *arguments)
            start(*arguments, cache=cache)
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "XDG_CACHE_HOME": cache}
        subprocess.run([sys.executable, "-m", "sandbox", "prepare"], cwd=ROOT, env=environment, check=True)
        for arguments in ((), ("rope",), ("dominoes",)):
            print("filled caches:", *arguments)
            start(*arguments, cache=cache)


if __name__ == "__main__":
    main()
