"""Playing: what a page needs to play a level, or a recording that can be taken over."""

import math
from collections.abc import Generator, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

from sandbox.app.draw.scene import made_looks, scene_of
from sandbox.app.run.playback import RAMP_TIME
from sandbox.app.share.firmness_table import material_rows
from sandbox.app.share.runs_for_pages import RunForPages, all_at_once, run_for_pages
from sandbox.app.share.stuffs import parts_for, stuffs_for
from sandbox.app.sound.timbre import timbres_of
from sandbox.app.sound.waves import STUFFS
from sandbox.level.assembly.build_world import build_world
from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.checks import CheckDef, bounds_of, window_of
from sandbox.level.document.model import Level
from sandbox.level.format.limits import GRAVITY_LIMIT
from sandbox.level.plan.actuators import driving_keys
from sandbox.level.rules.hands import left_of
from sandbox.level.rules.rule import has_clock
from sandbox.page.page import page_text, toy_content
from sandbox.page.start import adding, start_of
from sandbox.physics.snapshot import take
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.format import header, seal
from sandbox.session.replay.link import level_record

# Metrics that need the energies of areas and bends, which a page does not have.
NOT_MEASURED = ("energy", "potential_energy")
# Digits of what a sound is made of.
DIGITS = 4


class Playable(NamedTuple):
    """What a page plays: its title, what there is to do as its level says it, and all that scripts open."""

    title: str
    hints: str
    content: bytes


def page_of(level: Level, script: Sequence[ScriptLine] = (), ticks: int | None = None) -> str:
    """The page of a level, in one file; ticks: of a recording, whose commands the script has. Raises CommandError."""
    return page_text(*playable(level, script, ticks))


def playable(level: Level, script: Sequence[ScriptLine] = (), ticks: int | None = None) -> Playable:
    """As `page_of`, for a page of any kind. Raises CommandError."""
    return all_at_once(playable_in_slices(level, script, ticks))


def playable_in_slices(
    level: Level, script: Sequence[ScriptLine], ticks: int | None, begin: int = 0
) -> Generator[float, None, Playable]:
    """As `playable`, a slice of the work at a time: each gives the part that is done, 0..1.

    begin: the tick that is shown first. Raises CommandError, also for a recording that begins with nothing.
    """
    until = [line for line in script if ticks is not None and line.tick <= ticks]
    played = None if ticks is None else (yield from run_for_pages(level, until, ticks))
    world = build_world(level)
    scene = scene_of(level, take(world))
    data = {
        "name": level.name,
        "scene": scene,
        "sounds": _sounds(world),
        "materials": (yield from material_rows(world if played is None else played.world, level, played is not None)),
        "gravity_limit": GRAVITY_LIMIT,
        "ramp_ticks": round(RAMP_TIME * world.settings.tick_rate),
        "checks": _checks(level, world),
        "goals": _goals(level, world),
        "keys": dict(sorted(driving_keys(level).items())),
        "header": _header(level),
        "link": level_record(level) | {"physics": PHYSICS_VERSION},
        "recording": None if played is None else _recording(played),
        "begin": begin,
    }
    _, low, _, high = scene["view"]
    made = made_looks() | stuffs_for(world.settings.tick_rate)
    start, added = start_of(world), adding(world) | {"made": made} | parts_for(level, high - low)
    content = toy_content(data | {"about": start.about | {"adding": added}}, start.image)
    return Playable(level.name, level.description, content)


def _recording(played: RunForPages) -> dict[str, Any]:
    commands = [{"tick": line.tick, "gesture": line.gesture, "named": line.record} for line in played.script]
    return {"commands": commands, "hashes": played.hashes}


def _checks(level: Level, world: World) -> list[dict[str, Any]]:
    """Checks of a level that a page can follow while somebody plays: those that hold no key, without energies."""
    measured = [check for check in level.checks if not check.hold and check.metric not in NOT_MEASURED]
    return [_check(check, world) for check in measured]


def _goals(level: Level, world: World) -> dict[str, Any]:
    """What a page shows of the goal of a level, of its counters, and of what hands have left."""
    counters = [[place, counter.text] for place, counter in enumerate(level.counters) if counter.text]
    counters += [[row, f"{name} left"] for row, name, _ in left_of(level.hands, len(world.counter))]
    return {"goal": level.goal, "counters": counters, "hasClock": has_clock(level.rules)}


def _check(check: CheckDef, world: World) -> dict[str, Any]:
    """A check with slots in place of names; what it does not have is left out."""
    named = [world.particle_slot(name) for name in (check.particle, check.other) if name is not None]
    of_body = [slot for slot, name in enumerate(world.particle_names) if name.startswith(f"{check.body}.")]
    springs = [slot for slot, name in enumerate(world.spring_names) if name.startswith(f"{check.body}:")]
    (low, high), (first, last) = bounds_of(check), window_of(check)
    made = {
        "name": check.name,
        "metric": check.metric,
        "particles": named or (None if check.body is None else of_body),
        "springs": None if check.body is None else springs,
        "box": check.box,
        "from": first,
        "to": last,
        "is_eventual": check.eventually is not None or None,
        "at_least": low if math.isfinite(low) else None,
        "at_most": high if math.isfinite(high) else None,
    }
    return {key: value for key, value in made.items() if value is not None}


def _header(level: Level) -> str:
    """The first line of a recording, without its end."""
    line, _ = seal(header(level), "")
    return line.decode().rpartition(', "chain"')[0]


def _sounds(world: LevelWorld) -> dict[str, Any]:
    """What bodies sound like, stuffs by their modes, and motors that hum."""
    bodies, motors = timbres_of(world), world.actuators.motors
    rows = [
        (motors.rim[motors.rim_start[k] : motors.rim_start[k + 1]].tolist(), k) for k in range(len(motors.part))
    ]  # fmt: skip
    return {
        "bodies": {
            "of": bodies.body.tolist(),
            "mass": [_finite(value) for value in bodies.mass.tolist()],
            "pitch": [_finite(value) for value in bodies.pitch.tolist()],
            "weight": [_finite(value) for value in bodies.weight.tolist()],
            "stuff": bodies.stuff,
            "strand": bodies.strand.tolist(),
        },
        "stuffs": {name: asdict(stuff) for name, stuff in STUFFS.items() if name in bodies.stuff},
        "motors": [
            {"part": int(motors.part[k]), "hub": int(motors.hub[k]), "rim": rim, "speed": float(motors.speed[k])}
            for rim, k in rows
        ],
    }


def _finite(value: float) -> float:
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else 0.0
