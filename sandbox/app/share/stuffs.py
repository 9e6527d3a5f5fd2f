"""Stuffs: what pages make bodies, ropes and springs of, by the tick rate of a level, and parts that they drop."""

import contextlib
import functools
from collections.abc import Iterable
from typing import Any

from sandbox.app.draw.part_pictures import box_of
from sandbox.app.share.firmness_table import USUAL
from sandbox.app.share.runs_for_pages import carried_out
from sandbox.editor.document import EditError
from sandbox.editor.edits.joining import joining_commands
from sandbox.editor.storage.part_files import catalogue
from sandbox.level.assembly.build_world import build_world
from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.document.model import ContactsDef, Level, Settings
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.quantities import significant
from sandbox.level.reading.parse import parse_level
from sandbox.physics.softness.firmness import WORDS as SAGS
from sandbox.session.commands import Command
from sandbox.session.commands.records import to_record
from sandbox.session.session import Session
from sandbox.tools.drawing import STUFFS
from sandbox.tools.dropping import COLOURS, DIGITS, PARTS, USUAL_RATE, at_rate, in_pace
from sandbox.tools.pulling import FIRM
from sandbox.tools.tool import Loop, usual_size

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


def parts_for(level: Level, height: float) -> dict[str, Any]:
    """Parts that a page of a level drops: those of the window's strip, as large as there at first, and the catalogue.

    height: of the view [m]. Each has an id, a name, records that add it about the origin, and its ghost [m].
    """
    bare, size = _bare(level), usual_size(height)
    world, parts = build_world(bare), []
    for number, part in enumerate(PARTS.values()):
        made = part.make(size, (0.0, 0.0), (0.0, 0.0), COLOURS[number % len(COLOURS)])
        ghost = [[(size * x, size * y) for x, y in ([*loop, loop[0]] if part.solid else loop)] for loop in part.ghost]
        commands = [in_pace(made, level.settings.tick_rate)]
        parts.append(_part(f"part-{part.name}", part.name, bare, world, commands, ghost))
    return {"parts": parts, "catalogue": _catalogue_for(bare.model_dump_json(exclude_none=True))}


def _bare(level: Level) -> Level:
    """A level with what kits of bodies follow from, and nothing else: most levels have the same kits."""
    water = [zone for zone in level.zones if zone.water is not None]
    return Level(
        format=level.format, version=level.version, name="parts",
        settings=Settings(tick_rate=level.settings.tick_rate, gravity=level.settings.gravity),
        contacts=(level.contacts or ContactsDef()) if level.has_contacts else None,
        zones=tuple(water[:1]),
    )  # fmt: skip


@functools.cache
def _catalogue_for(text: str) -> list[dict[str, Any]]:
    """Shipped parts of the catalogue that can join the level of this text."""
    bare, found = parse_level(text.encode(), "parts"), []
    world = build_world(bare)
    for file in catalogue():
        if file.is_own or file.level is None:
            continue
        left, low, right, high = box_of(Session(file.level).snapshot())
        x, y = (right + left) / 2, (high + low) / 2
        dx, dy = right - x, high - y
        box = [(-dx, -dy), (dx, -dy), (dx, dy), (-dx, dy), (-dx, -dy)]
        with contextlib.suppress(EditError):
            commands = joining_commands(file.level, world, (-x, -y))
            found.append(_part(f"catalogue-{file.path.stem}", file.name.lower(), bare, world, commands, [box]))
    return found


def _part(
    key: str, name: str, level: Level, world: LevelWorld, commands: Iterable[Command], ghost: Iterable[Loop]
) -> dict[str, Any]:
    records = [carried_out(level, world, to_record(command, world)) for command in commands]
    for stuff in (record["kit"]["materials"] for record in records if "kit" in record):
        # A level may have another of that name.
        stuff["name"] = [each if each == DEFAULT_MATERIAL else f"{each} of {name}" for each in stuff["name"]]
    lines = [[[significant(x, DIGITS), significant(y, DIGITS)] for x, y in loop] for loop in ghost]
    return {"id": key, "name": name, "records": records, "ghost": lines}


def _at(tick_rate: int, stiffness: float, damping: float) -> dict[str, float]:
    pair = {"stiffness": stiffness, "damping": damping}
    return pair if tick_rate == USUAL_RATE else at_rate(pair, tick_rate)
