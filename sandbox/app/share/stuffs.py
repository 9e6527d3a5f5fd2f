"""Stuffs: what pages make bodies, ropes and springs of, by the tick rate of a level."""

from typing import Any

from sandbox.app.share.firmness_table import USUAL
from sandbox.physics.analysis.firmness import WORDS as SAGS
from sandbox.tools.drawing import STUFFS
from sandbox.tools.parts import COLOURS, USUAL_RATE, at_rate
from sandbox.tools.pulling import FIRM

# Cs and Cd of a spring that a page adds: it does not weigh what hangs on it.
SPRINGY = {"stiffness": 0.02, "damping": 0.02}


def stuffs_for(tick_rate: int) -> dict[str, Any]:
    """Stuffs, Cs and Cd of ropes and rods and of springs, and Cs and Cd by words of firmness."""
    stuffs = {
        stuff.name: {
            **_at(tick_rate, stuff.stiffness, stuff.damping),
            "density": stuff.density,
            "colours": COLOURS if stuff.name == "jelly" else (),
            "more": stuff.more,
        }
        for stuff in STUFFS.values()
    }
    words = {word: list(_at(tick_rate, *pair).values()) for word, pair in USUAL.items()}
    firmest = {"stiffness": FIRM, "damping": FIRM}
    return {"stuffs": stuffs, "firmest": firmest, "springy": at_rate(SPRINGY, tick_rate), "words": words, "sags": SAGS}


def _at(tick_rate: int, stiffness: float, damping: float) -> dict[str, float]:
    pair = {"stiffness": stiffness, "damping": damping}
    return pair if tick_rate == USUAL_RATE else at_rate(pair, tick_rate)
