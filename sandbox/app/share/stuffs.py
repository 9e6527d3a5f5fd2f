"""Stuffs: what pages make bodies, ropes and springs of, by the tick rate of a level."""

from typing import Any

from sandbox.app.share.firmness_table import USUAL
from sandbox.tools.parts import COLOURS, DENSITY, at_rate

STUFFS: dict[str, dict[str, Any]] = {
    "jelly": {"stiffness": 0.75, "damping": 0.7, "density": DENSITY, "colours": COLOURS,
              "more": {"look": {"skin": "jelly", "face": True}}},
    "wood": {"stiffness": 0.995, "damping": 0.995, "density": DENSITY, "colours": (),
             "more": {"friction": 0.6, "look": {"skin": "wood"}}},
    "steel": {"stiffness": 1.0, "damping": 1.0, "density": 5.0 * DENSITY, "colours": (),
              "more": {"friction": 0.3, "look": {"skin": "plain", "colour": "#8E99A8"}}},
}  # fmt: skip
SPRINGY = {"stiffness": 0.02, "damping": 0.02}


def stuffs_for(tick_rate: int) -> dict[str, Any]:
    """Stuffs, Cs and Cd of ropes and rods and of springs, and Cs and Cd by words of firmness."""
    return {
        "stuffs": {name: stuff | _pair(stuff, tick_rate) for name, stuff in STUFFS.items()},
        "firmest": {"stiffness": 1.0, "damping": 1.0},
        "springy": at_rate(SPRINGY, tick_rate),
        "words": {word: list(_pair(dict(zip(("stiffness", "damping"), pair, strict=True)), tick_rate).values())
                  for word, pair in USUAL.items()},
    }  # fmt: skip


def _pair(stuff: dict[str, Any], tick_rate: int) -> dict[str, float]:
    return at_rate({name: stuff[name] for name in ("stiffness", "damping")}, tick_rate)
