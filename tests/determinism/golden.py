"""Goldens: recordings that are kept as files: a minute of most shipped levels, less of those whose ticks take long."""

import gzip
import json
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).with_name("goldens")
SUFFIX = ".replay.gz"
LONG = 3600  # ticks
# Levels whose minute would take too long, or too much room, and the ticks of theirs.
SHORTER = {
    "balloons": 120, "beating_heart": 240, "catapult": 120, "curtain": 180, "dominoes": 240, "hourglass": 240,
    "jelly_pile": 180, "quad_mesh": 60, "rope_bridge_wheel": 240,
    "spider_web": 180, "suspension_bridge": 240, "trampoline": 180, "truck_bridge": 240, "tumble_drum": 180,
    "wrecking_ball": 240, "wrecking_crane": 180,
    "squeeze": 60, "basket_throw": 120, "trampoline_basket": 60, "chain_of_events": 60, "sorting_belt": 60,
    "ferry": 60, "egg_drop": 60, "low_door": 60, "catapult_practice": 60, "bridge_budget": 60, "truck_course": 60,
    "crane": 60, "pinball_score": 60,
}  # fmt: skip
# From one stored state to the next. It is no multiple of a round of scenes, so that each begins in other scenes.
STATE_TICKS = 1500


def golden_path(name: str) -> Path:
    """Where the golden of a level is, by the level's name."""
    return FOLDER / f"{name}{SUFFIX}"


def golden_names() -> list[str]:
    """Names of the levels that have a golden."""
    return sorted(path.name.removesuffix(SUFFIX) for path in FOLDER.glob(f"*{SUFFIX}"))


def golden_commands(name: str) -> list[dict[str, Any]]:
    """The command lines of a golden: {"tick", "gesture", "command"}."""
    with gzip.open(golden_path(name)) as lines:
        return [json.loads(line) for line in lines if b'"command"' in line[:80]]
