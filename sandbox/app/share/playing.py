"""Playing: what a page needs to play a level, or a recording that can be taken over."""

import math
from collections.abc import Generator, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

from sandbox import __version__
from sandbox.app.draw.scene import scene_of
from sandbox.app.run.playback import RAMP_TIME
from sandbox.app.share.recorded import recorded
from sandbox.app.sound.timbre import timbres_of
from sandbox.app.sound.waves import STUFFS
from sandbox.level.assembly.build_world import build_world
from sandbox.level.checks import CheckDef, bounds_of, window_of
from sandbox.level.document.model import Level
from sandbox.level.format.limits import GRAVITY_LIMIT
from sandbox.level.plan.actuators import driving_keys
from sandbox.page.page import page_text, toy_content
from sandbox.page.room import make_room, row_counts
from sandbox.page.start import start_of
from sandbox.physics.analysis.firmness import LARGEST_READ, WORDS, FirmnessRange
from sandbox.physics.equation import of_springs
from sandbox.physics.keeping.forms import Firmness
from sandbox.physics.snapshot import take
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.format import header, seal

# Cs and Cd for the words of firmness where no body's form says what they mean.
USUAL = {"jelly": (0.01, 0.1), "soft": (0.05, 0.2), "firm": (0.3, 0.5), "hard": (0.8, 0.9), "rigid": (1.0, 1.0)}
ALL = "All"
# Metrics that need the energies of areas and bends, which a page does not have.
NOT_MEASURED = ("energy", "potential_energy")
# Digits, and decimals at most, of Cs and Cd.
DIGITS, DECIMALS = 4, 12


class Playable(NamedTuple):
    """What a page plays: its title, what there is to do, and all that scripts open."""

    title: str
    hints: str
    content: bytes


def page_of(level: Level, script: Sequence[ScriptLine] = (), ticks: int | None = None) -> str:
    """The page of a level, in one file; ticks: of a recording, whose commands the script has. Raises CommandError."""
    return page_text(*playable(level, script, ticks))


def playable(level: Level, script: Sequence[ScriptLine] = (), ticks: int | None = None) -> Playable:
    """As `page_of`, for a page of any kind. Raises CommandError."""
    slices = playable_in_slices(level, script, ticks)
    while True:
        try:
            next(slices)
        except StopIteration as end:
            made: Playable = end.value
            return made


def playable_in_slices(
    level: Level, script: Sequence[ScriptLine], ticks: int | None, begin: int = 0
) -> Generator[float, None, Playable]:
    """As `playable`, a slice of the work at a time: each gives the part that is done, 0..1.

    begin: the tick that is shown first. Raises CommandError, also for a recording that begins with nothing.
    """
    until = [line for line in script if ticks is not None and line.tick <= ticks]
    played = None if ticks is None else (yield from recorded(level, until, ticks))
    world = build_world(level)
    counts = row_counts(world)
    if played is not None:
        make_room(world, played.world)
    data = {
        "name": level.name,
        "scene": scene_of(level, take(world)),
        "sounds": _sounds(world),
        "materials": _materials(world),
        "gravity_limit": GRAVITY_LIMIT,
        "ramp_ticks": round(RAMP_TIME * world.settings.tick_rate),
        "checks": _checks(level, world),
        "keys": dict(sorted(driving_keys(level).items())),
        "header": _header(level),
        "recording": None if played is None else {"commands": played.commands, "hashes": played.hashes},
        "begin": begin,
    }
    start = start_of(world, counts)
    return Playable(level.name, level.description, toy_content(data | {"about": start.about}, start.image))


def _checks(level: Level, world: World) -> list[dict[str, Any]]:
    """Checks of a level that a page can follow while somebody plays: those that hold no key, without energies."""
    measured = [check for check in level.checks if not check.hold and check.metric not in NOT_MEASURED]
    return [_check(check, world) for check in measured]


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
    line, _ = seal(header(level, PHYSICS_VERSION, __version__), "")
    return line.decode().rpartition(', "chain"')[0]


def _materials(world: World) -> list[dict[str, Any]]:
    """Materials that springs have, with Cs and Cd by the words of firmness; before several of them, all as one."""
    used = [slot for slot in range(len(world.material_names)) if (world.material == slot).any()]
    rows: list[tuple[str, int | None]] = [(world.material_names[slot], slot) for slot in used]
    if len(rows) > 1:
        rows.insert(0, (ALL, None))
    return [{"name": name, "slot": slot, "words": _words(world, slot)} for name, slot in rows]


def _words(world: World, material: int | None) -> dict[str, tuple[float, float]]:
    """Cs and Cd of springs by the words of firmness, for the largest body of a material."""
    forms = [form for form in world.forms if material in (None, int(world.material[form.springs[0]]))]
    for form in sorted(forms, key=lambda form: -len(form.springs)):
        if len(form.shape.mass) > LARGEST_READ:
            continue
        reach = FirmnessRange.of(form.shape, world.settings.gravity, world.settings.tick_rate)
        if reach.lowest_mode > 0.0 and reach.height > 0.0:
            return {word: _pair(reach, sag) for word, sag in WORDS.items()}
    return USUAL


def _pair(reach: FirmnessRange, sag: float) -> tuple[float, float]:
    stiffness, damping = reach.coefficients(reach.nearest(Firmness(sag=sag)))
    if stiffness < 1.0:
        stiffness, damping = of_springs(stiffness, damping, reach.lowest_mode)
    return _coefficient(stiffness), _coefficient(damping)


def _coefficient(value: float) -> float:
    """In few digits, or with few digits of what it is below 1 by: that says how firm a stiff body is."""
    if value < 0.5:
        return float(f"{value:.{DIGITS}g}")
    return round(1.0 - float(f"{1.0 - value:.{DIGITS}g}"), DECIMALS)


def _sounds(world: World) -> dict[str, Any]:
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
