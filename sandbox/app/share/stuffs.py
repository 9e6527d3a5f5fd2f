"""Stuffs: what pages make bodies, ropes and springs of, by the tick rate of a level, and parts that they drop."""

from typing import Any

from sandbox.app.share.firmness_table import USUAL
from sandbox.app.share.runs_for_pages import carried_out
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.physics.analysis.firmness import WORDS as SAGS
from sandbox.session.commands.records import to_record
from sandbox.tools.drawing import STUFFS
from sandbox.tools.parts import COLOURS, PARTS, USUAL_RATE, at_rate, in_pace
from sandbox.tools.pulling import FIRM
from sandbox.tools.sizing import usual_size

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


def parts_for(level: Level, height: float) -> list[dict[str, Any]]:
    """Parts that a page of a level drops: name, the record that adds one about the origin, and its ghost [m].

    height: of the view [m]; parts are as large as in the window at first.
    """
    # Whether hands may add them, the page asks when they do.
    bare, size = level.model_copy(update={"hands": None}), usual_size(height)
    world, found = build_world(bare), []
    for number, part in enumerate(PARTS.values()):
        made = part.make(size, (0.0, 0.0), (0.0, 0.0), COLOURS[number % len(COLOURS)])
        record = carried_out(bare, world, to_record(in_pace(made, level.settings.tick_rate), world))
        ghost = [[[size * x, size * y] for x, y in ([*loop, loop[0]] if part.solid else loop)] for loop in part.ghost]
        found.append({"id": f"part-{part.name}", "name": part.name, "record": record, "ghost": ghost})
    return found


def _at(tick_rate: int, stiffness: float, damping: float) -> dict[str, float]:
    pair = {"stiffness": stiffness, "damping": damping}
    return pair if tick_rate == USUAL_RATE else at_rate(pair, tick_rate)
