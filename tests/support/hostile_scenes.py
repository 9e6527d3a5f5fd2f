"""Scenes that somebody changed and sealed anew, as anybody can."""

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from sandbox.session.replay.format import seal

JELLY = {"type": "jelly", "position": [0.0, 5.0], "shape": {"box": [0.6, 0.6]}, "spacing": 0.2}


def resealed(path: Path, change: Callable[[dict[str, Any]], Iterable[dict[str, Any]]]) -> None:
    """Seal a scene's file anew, with what becomes of each of its lines."""
    digest, lines = "", []
    for line in path.read_bytes().splitlines():
        values = json.loads(line)
        del values["chain"]
        for each in change(values):
            sealed, digest = seal(each, digest)
            lines.append(sealed)
    path.write_bytes(b"".join(lines))


def bodies_far_out(values: dict[str, Any]) -> Iterable[dict[str, Any]]:
    """A state to which bodies have come beyond any array."""
    if "state" in values:
        values["joined"] = [{"particle": 20_000_000, "spring": 20_000_000, "definition": {"body": JELLY}}]
    yield values
