"""Scene: what is drawn of a level, as plain data for a page that draws it by itself."""

from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.backdrop import WIDE
from sandbox.app.draw.looks import SOFT_SKINS, Look, ground_look
from sandbox.app.draw.picture import view_of
from sandbox.app.draw.themes import THEMES, Theme
from sandbox.app.draw.things.borders import hull_of
from sandbox.app.draw.things.faces import spot_of
from sandbox.app.draw.things.level_slots import Actor, level_slots_of
from sandbox.app.draw.things.soft import keep_of
from sandbox.level.document.model import Level
from sandbox.level.format.look import PALETTE
from sandbox.physics.snapshot import Snapshot

# Digits of lengths [m]: a tenth of a millimetre.
DIGITS = 4


def scene_of(level: Level, snapshot: Snapshot) -> dict[str, Any]:
    """All that a page draws of a level, as JSON takes it; colours are "#rrggbb", places and lengths in metres."""
    slots = level_slots_of(level)
    return {
        "view": [round(float(value), DIGITS) for value in view_of(level, snapshot)],
        "theme": level.look.theme if level.look is not None else None,
        "themes": {name: _theme(theme) for name, theme in THEMES.items()},
        "palette": [_hex(colour) for colour in PALETTE.values()],
        "bodies": [_body(actor, snapshot) for actor in slots.actors],
        "joins": [{"spring": join.spring, "ends": list(join.ends), **_look(join.look)} for join in slots.joins],
        "balls": [
            {"slot": ball.slot, "kind": ball.kind, "colour": None if ball.colour is None else _hex(ball.colour)}
            for ball in slots.balls
        ],
        "ground": _ground(level, snapshot),
    }


def _hex(colour: int) -> str:
    return f"#{colour:06x}"


def _theme(theme: Theme) -> dict[str, Any]:
    return {name: _colours(value) for name, value in asdict(theme).items()}


def _colours(value: Any) -> Any:
    if not isinstance(value, tuple):
        return value
    return [_colours(each) for each in value] if isinstance(value[0], tuple) else "#{:02x}{:02x}{:02x}".format(*value)


def _look(look: Look) -> dict[str, Any]:
    return {"skin": look.skin, "line": look.line, "colour": _hex(look.colour), "width": look.width}


def _body(actor: Actor, snapshot: Snapshot) -> dict[str, Any]:
    """A body: its look, slots of its particles, its first spring and how many it has."""
    look, there = actor.look, np.ones(len(actor.springs), dtype=np.bool_)
    made: dict[str, Any] = {
        "type": actor.body.type,
        **_look(look),
        "radius": round(float(np.median(snapshot.radius[actor.slots])), DIGITS),
        "cell": round(actor.cell, DIGITS),
        "angle": round(actor.angle, DIGITS),
        "slots": _runs(actor.slots),
        "spring": int(actor.springs[0]) if len(actor.springs) else 0,
        "springs": len(actor.springs),
    }
    if "segments" in actor.body.__dict__:
        made["segments"] = int(actor.body.__dict__["segments"])
        made["numbers"] = actor.made.numbers.tolist() if actor.body.type == "wheel" else None
    if look.panel is not None:
        hull = hull_of(actor.made.form, actor.pairs)
        made["panel"], made["hull"] = _hex(look.panel) if len(hull) else None, actor.slots[hull].tolist()
        made["window"] = [int(actor.slots[k]) for k in look.window if k < len(actor.slots)]
    if actor.body.type == "jelly":
        _, left, loops, _ = actor.filling(there)
        triangles = actor.triangles()
        made["triangles"] = actor.slots[triangles].reshape(-1).tolist()
        made["spacing"] = float(actor.body.__dict__.get("spacing", actor.cell))
        made["keep"] = round(keep_of(actor, loops), DIGITS)
        if look.face and look.skin in SOFT_SKINS and len(left):
            place, room = spot_of(actor, max(loops, key=len))
            made["face"] = [round(float(value), DIGITS) for value in (*place, room)]
    return made


def _runs(slots: NDArray[np.int64]) -> list[list[int]]:
    """Slots as runs of consecutive ones: the first of each, and how many."""
    begins = np.flatnonzero(np.diff(slots, prepend=-2) != 1)
    return [list(run) for run in zip(slots[begins].tolist(), np.diff(begins, append=len(slots)).tolist(), strict=True)]


def _ground(level: Level, snapshot: Snapshot) -> list[str]:
    """What each chain of the terrain is made of."""
    terrain, kinds = snapshot.terrain, []
    left, _, right, _ = view_of(level, snapshot)
    extent = max(float(np.ptp(terrain.vertex[:, 0])) if len(terrain.vertex) else 0.0, right - left)
    for chain in np.unique(terrain.chain).tolist():
        across = terrain.vertex[terrain.edge_a[terrain.chain == chain], 0]
        name = level.terrain[chain].id if chain < len(level.terrain) else ""
        kinds.append(ground_look(level, name, bool(np.ptp(across) > WIDE * extent)))
    return kinds
