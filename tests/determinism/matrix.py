"""Goldens on other interpreters and with kernels that run in other ways, every bit of every tick; a line for each.

Run by hand: python -m tests.determinism.matrix [--python PATH ...] [--setting NAME ...] [LEVEL ...]

Each PYTHON has the project's dependencies (make one with `PATH -m venv` and pip; the oldest and the newest that
pyproject.toml allows are worth two). Exit code 1: a bit differs.
"""

import argparse
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SETTINGS: dict[str, dict[str, str]] = {
    "library": {"SANDBOX_KERNELS": "library"},
    "generic": {"SANDBOX_KERNELS": "generic"},
    "checked": {"SANDBOX_KERNELS": "checked"},
    "interpreted": {"SANDBOX_KERNELS": "interpreted"},
}
# Interpreted kernels are some hundred times slower: no contacts, and so many particles times ticks of each golden.
INTERPRETED_WORK = 12_000
VERSIONS = "import platform, numpy; print(platform.python_version(), numpy.__version__)"


def verified(names: list[str]) -> int:
    """Run goldens in this process; how many differ."""
    from sandbox.physics.jit import COMPILED, way
    from sandbox.session.compare.comparison import verify
    from sandbox.session.replay.reader import read_replay
    from tests.determinism.golden import golden_names, golden_path

    differing = ticks = 0
    for name in names or golden_names():
        replay, end = read_replay(golden_path(name)), None
        if not COMPILED:
            if replay.level.has_contacts:
                continue
            end = min(replay.ticks, INTERPRETED_WORK // len(replay.state(0).mass))
        divergence = verify(replay, end=end)
        ticks += replay.ticks if end is None else end
        if divergence is not None:
            differing += 1
            print(f"{name}: {divergence}")
    print(f"{way()}, {ticks:,} ticks, {differing} goldens differ")
    return differing


def outcome(python: str, setting: str, names: list[str]) -> tuple[bool, str]:
    """Whether the goldens are equal on an interpreter with a setting, and the last lines that it told."""
    environment = os.environ | SETTINGS[setting] | {"PYTHONPATH": str(ROOT)}
    command = [python, "-m", "tests.determinism.matrix", "--here", *names]
    ended = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    lines = ended.stdout.splitlines()
    return ended.returncode == 0, "\n".join(lines) or ended.stderr[-2000:]


def main() -> int:
    """Run all that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", action="append", metavar="PATH", help="an interpreter; default: this one")
    parser.add_argument("--setting", action="append", choices=SETTINGS, help="default: all")
    parser.add_argument("--here", action="store_true", help="run in this process, as it is")
    parser.add_argument("levels", nargs="*", metavar="LEVEL", help="goldens; default: all")
    given = parser.parse_args()
    if given.here:
        return int(verified(given.levels) > 0)
    all_equal = True
    for python in given.python or [sys.executable]:
        told = subprocess.run([python, "-c", VERSIONS], capture_output=True, text=True, check=True).stdout.split()
        for setting in given.setting or SETTINGS:
            equal, text = outcome(python, setting, given.levels)
            all_equal &= equal
            versions = "Python {}, numpy {}".format(*told)
            print(f"{versions}, {setting}: {'equal' if equal else 'DIFFERS'}: {text}", flush=True)
    return int(not all_equal)


if __name__ == "__main__":
    sys.exit(main())
