"""Rapier, from npm, run by node on the bench scenes. Nothing of it is kept: it is fetched for each use."""

import json
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sandbox.physics.arrays import Floats
from tests.bench.scenes import GRAVITY, Scene

PACKAGE = "@dimforge/rapier2d-compat@0.21.0"
PROGRAM = Path(__file__).with_name("rapier.mjs")
# Moment of inertia [kg m^2] of a link: a joint that turns keeps the length only of what can turn with it. Far less, and
# Rapier's joints come apart; 1, as in the other engines, and the rope is slower than a rope.
MOMENT = 0.01


class NoRapier(Exception):
    """Why there is no Rapier here, in a line."""


@dataclass(frozen=True)
class Rapier:
    """Rapier in a folder that npm has filled."""

    folder: Path

    def run(self, scene: Scene, method: str, frames: int, runs: int) -> tuple[str, Floats, Floats]:
        """Its version; seconds of each frame (runs, frames); and positions [m] (n, 2) after the last.

        method: "impulse" or "multibody", the joints of a chain; every link leads from a particle to the next.
        """
        given = {
            "position": scene.position.tolist(), "mass": scene.mass.tolist(), "pinned": scene.pinned.tolist(),
            "links": scene.links.tolist(), "gravity": GRAVITY, "moment": MOMENT, "method": method, "frames": frames,
            "runs": runs,
        }  # fmt: skip
        command = ["node", str(PROGRAM), str(self.folder)]
        ended = subprocess.run(command, input=json.dumps(given), capture_output=True, text=True, check=True)
        answer = json.loads(ended.stdout)
        return answer["version"], np.array(answer["seconds"]), np.array(answer["places"])


@contextmanager
def fetched() -> Iterator[Rapier]:
    """Rapier, in a folder that is gone afterwards. Raises NoRapier."""
    npm = shutil.which("npm")
    if npm is None or shutil.which("node") is None:
        raise NoRapier("Rapier is left out: it needs node and npm")
    with tempfile.TemporaryDirectory() as folder:
        command = [npm, "install", "--prefix", folder, "--no-audit", "--no-fund", "--loglevel=error", PACKAGE]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        if ended.returncode != 0:
            said = ended.stderr.strip().splitlines() or ["npm says nothing"]
            raise NoRapier(f"Rapier is left out: npm did not fetch {PACKAGE}: {said[-1]}")
        yield Rapier(Path(folder))
