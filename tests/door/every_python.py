"""python -m tests.door.every_python: the wheel on every Python from 3.11 up that this machine has.

Each gets an environment of its own with the newest dependencies, and the oldest Python once more with the oldest
promised ones. There a stranger runs a level, records, replays, checks, writes a page and opens a window on a driver
that shows nothing. All come to the same state, bit for bit. A line each says what was tried, with which numpy.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from tests.door.front_door import ROOT
from tests.support.person import stranger_environment

OLDEST_PYTHON = (3, 11)
CONSTRAINTS = ROOT / ".ci" / "oldest.txt"
# What is tried, in this order, in one folder; the window closes by itself.
SMOKE = (
    "run rope --seconds 1 --json",
    "run jelly_pile --ticks 60 --record run.replay.gz",
    "replay run.replay.gz",
    "check rope",
    "page rope -o rope.html",
    "play jelly_pile --seconds 1",
)
ASK = "import sys; print(*sys.version_info[:2], sys.executable)"


class Failed(Exception):
    """A step that did not end well, with what it said."""


@dataclass(frozen=True)
class Trial:
    """A Python to try, by its program, and the constraints of its dependencies."""

    python: str
    version: tuple[int, int]
    constraints: Path | None = None

    @property
    def name(self) -> str:
        return f"Python {self.version[0]}.{self.version[1]}, {'oldest' if self.constraints else 'newest'} dependencies"


def candidates() -> Iterator[Path]:
    """Programs that may be a Python: of this environment, on the path, and of pyenv."""
    yield Path(sys.executable)
    for folder in os.environ["PATH"].split(os.pathsep):
        yield from sorted(Path(folder).glob("python3*"))
    versions = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    yield from sorted(versions.glob("*/bin/python"))


def pythons() -> dict[tuple[int, int], str]:
    """The first Python of each version from the oldest supported one up, lowest first."""
    found: dict[tuple[int, int], str] = {}
    for path in candidates():
        if re.fullmatch(r"python(3(\.\d+)?)?(\.exe)?", path.name):
            asked = subprocess.run([path, "-c", ASK], capture_output=True, text=True, check=False)
            if asked.returncode == 0:
                major, minor, program = asked.stdout.split(maxsplit=2)
                found.setdefault((int(major), int(minor)), program.strip())
    return {version: found[version] for version in sorted(found) if version >= OLDEST_PYTHON}


def carried_out(command: list[str], folder: Path, environment: dict[str, str]) -> str:
    """What a command printed. Raises Failed."""
    run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if run.returncode != 0 or "Traceback" in run.stderr:
        raise Failed(f"{' '.join(command)}: exit code {run.returncode}\n{run.stdout[-500:]}{run.stderr[-2000:]}")
    return run.stdout


def installed(trial: Trial, wheel: Path, folder: Path) -> Path:
    """The folder of programs of a fresh environment that holds the wheel. Raises Failed."""
    environment, place = dict(os.environ), str(folder / "venv")
    programs = folder / "venv" / ("Scripts" if os.name == "nt" else "bin")
    python = str(programs / "python")
    if find_spec("uv"):
        # In a tenth of pip's time, and also for a Python that came without pip.
        uv = [sys.executable, "-m", "uv"]
        create, install = (
            [*uv, "venv", "-q", "--python", trial.python, place],
            [*uv, "pip", "install", "-q", "--python", python],
        )
    else:
        create, install = [trial.python, "-m", "venv", place], [python, "-m", "pip", "install", "-q"]
    carried_out(create, folder, environment)
    constraints = ["--constraint", str(trial.constraints)] if trial.constraints else []
    carried_out([*install, *constraints, str(wheel)], folder, environment)
    return programs


def tried(trial: Trial, wheel: Path, folder: Path) -> tuple[str, str]:
    """The numpy that a trial had, and the state's hash that it came to. Raises Failed."""
    folder.mkdir()
    programs = installed(trial, wheel, folder)
    environment = stranger_environment(folder / "home")
    environment |= {
        "SDL_VIDEODRIVER": "dummy",
        "SDL_AUDIODRIVER": "dummy",
        "PYTHONWARNINGS": "error::DeprecationWarning",
    }
    said = [carried_out([str(programs / "sandbox"), *line.split()], folder, environment) for line in SMOKE]
    ask = [str(programs / "python"), "-c", "import numpy; print(numpy.__version__)"]
    return carried_out(ask, folder, environment).strip(), json.loads(said[0])["hash"]


def main() -> int:
    """Try all; the exit code."""
    found = pythons()
    trials = [Trial(python, version) for version, python in found.items()]
    trials.append(Trial(trials[0].python, trials[0].version, CONSTRAINTS))
    failed, hashes = False, set()
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(os.cpu_count()) as pool:
        folder = Path(name)
        build = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-q", "-w", name, str(ROOT)]
        carried_out(build, folder, dict(os.environ))
        (wheel,) = folder.glob("*.whl")
        results = [
            (trial, pool.submit(tried, trial, wheel, folder / str(number))) for number, trial in enumerate(trials)
        ]
        for trial, result in results:
            try:
                numpy, state = result.result()
            except Failed as failure:
                print(f"{trial.name}: {failure}", file=sys.stderr)
                failed = True
            else:
                print(f"{trial.name} (numpy {numpy}): works, state {state}")
                hashes.add(state)
    if len(hashes) > 1:
        print(f"they came to {len(hashes)} states", file=sys.stderr)
    return int(failed or len(hashes) > 1)


if __name__ == "__main__":
    sys.exit(main())
