"""Playing: what a page needs to play a level, or a recording that can be taken over; what it makes things of."""

import contextlib
import functools
import math
from collections.abc import Generator, Iterable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sandbox.app.base.sag_map import NO_SAG, SagMap, own_of, sag_sentence, scale_of, subject_words, word_pairs
from sandbox.app.draw.picture import particles_of
from sandbox.app.draw.scene import made_looks, scene_of
from sandbox.app.run.playback import RAMP_TIME
from sandbox.app.share.runs_for_pages import RunForPages, carried_out, link_to, run_for_pages
from sandbox.app.sound.sound_events import timbres_of
from sandbox.app.sound.waves import STUFFS
from sandbox.editor.document import EditError
from sandbox.editor.edits.joining import joining_commands
from sandbox.editor.storage.level_file import catalogue
from sandbox.level.assembly.build_world import LevelWorld, build_world
from sandbox.level.checks import CheckDef, bounds_of, window_of
from sandbox.level.document.model import ContactsDef, Level, Settings
from sandbox.level.format.limits import DEFAULT_MATERIAL, GRAVITY_LIMIT
from sandbox.level.format.quantities import significant
from sandbox.level.format.slices import at_once
from sandbox.level.plan.actuators import driving_keys
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.reading.parse import parse_level
from sandbox.level.rules.player_limits import left_of
from sandbox.level.rules.rule import has_clock
from sandbox.page.page import page_text, toy_content
from sandbox.page.start import adding, start_of
from sandbox.physics import jit
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.snapshot import take
from sandbox.physics.softness.body_motion import FLAT, BodyMotion
from sandbox.physics.softness.firmness import LARGEST_READ, FirmnessRange, OutOfReach
from sandbox.physics.softness.firmness import WORDS as SAGS
from sandbox.physics.softness.sag_meter import MeasuredBody, SagMeters, measured_bodies
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.commands import Command
from sandbox.session.commands.records import ScriptLine, to_record
from sandbox.session.outcome import measure_of, star_words
from sandbox.session.replay.format import header, seal
from sandbox.session.replay.link import level_record
from sandbox.session.replay.recording import ReplayError
from sandbox.session.session import Session
from sandbox.session.solution import known_solution
from sandbox.tools.drawing import MATERIALS
from sandbox.tools.dropping import COLOURS, PARTS, USUAL_RATE, at_rate, in_pace
from sandbox.tools.dropping import DIGITS as PART_DIGITS
from sandbox.tools.pulling import FIRM
from sandbox.tools.tool import Loop, usual_size

# Metrics that need the energies of areas and bends, which a page does not have.
NOT_MEASURED = ("energy", "potential_energy")
# Digits of what a sound is made of.
DIGITS = 4


class Playable(NamedTuple):
    """The content of a page: its title, its hints as the level gives them, and what the script opens."""

    title: str
    hints: str
    content: bytes


def page_of(level: Level, script: Sequence[ScriptLine] = (), ticks: int | None = None, file: Path | None = None) -> str:
    """The page of a level, in one file; ticks: of a recording, whose commands the script has. Raises CommandError.

    file: of the level, beside which its solution lies.
    """
    return page_text(*playable(level, script, ticks, file))


def playable(
    level: Level, script: Sequence[ScriptLine] = (), ticks: int | None = None, file: Path | None = None
) -> Playable:
    """The run for a page of any kind, as `page_of` makes it. Raises CommandError."""
    return at_once(playable_in_slices(level, script, ticks, file=file))


def playable_in_slices(
    level: Level, script: Sequence[ScriptLine], ticks: int | None, begin: int = 0, file: Path | None = None
) -> Generator[float, None, Playable]:
    """As `playable`, a slice of the work at a time: each gives the part that is done, 0..1.

    begin: the tick that is shown first. Raises CommandError, also for a recording that begins with nothing.
    """
    until = [line for line in script if ticks is not None and line.tick <= ticks]
    played = None if ticks is None else (yield from run_for_pages(level, until, ticks))
    world = build_world(level)
    scene, hands = scene_of(level, take(world)), level.hands
    data = {
        "name": level.name,
        "scene": scene,
        "sounds": _sounds(world),
        "materials": (yield from material_rows(world if played is None else played.world, level, played is not None)),
        "gravity_limit": GRAVITY_LIMIT,
        "ramp_ticks": round(RAMP_TIME * world.settings.tick_rate),
        "checks": _checks(level, world),
        "goals": _goals(level, world) | {"solved": None if file is None else (yield from _solved(level, file))},
        "absent": []
        if hands is None
        else [name for name, any_of in _NEEDS.items() if not any(map(hands.allows, any_of))],
        "keys": dict(sorted(driving_keys(level).items())),
        "header": _header(level),
        "link": level_record(level) | {"physics": PHYSICS_VERSION},
        "recording": None if played is None else _recording(played),
        "begin": begin,
    }
    _, low, _, high = scene["view"]
    made = made_looks() | materials_for(world.settings.tick_rate) | {"firmness": _firmness_of(world)}
    start, added = start_of(world), adding(world) | {"made": made} | parts_for(level, high - low)
    content = toy_content(data | {"about": start.about | {"adding": added}}, start.image)
    return Playable(level.name, level.description, content)


def _recording(played: RunForPages) -> dict[str, Any]:
    commands = [{"tick": line.tick, "gesture": line.gesture, "named": line.record} for line in played.script]
    return {"commands": commands, "hashes": played.hashes}


# Buttons of a page and parts of its panel, by what hands have to be allowed for them: one of these.
_NEEDS = {
    "drag": ("grab",), "pin": ("pin",), "cut": ("cut",), "make": ("add", "remove"), "erase": ("remove",),
    **dict.fromkeys(("jelly", "wood", "steel", "rope", "spring", "rod", "parts", "catalogue"), ("add",)),
    "springs": ("material",), "world": ("air",), "engineers": ("solver",), "tune": ("material", "air", "solver"),
}  # fmt: skip


def _checks(level: Level, world: World) -> list[dict[str, Any]]:
    """Checks of a level that a page can follow while somebody plays: those that hold no key, without energies."""
    measured = [check for check in level.checks if not check.hold and check.metric not in NOT_MEASURED]
    return [_check(check, world) for check in measured]


def _goals(level: Level, world: World) -> dict[str, Any]:
    """A level's goal and counters, and the budgets of its hands, as a page shows them."""
    counters = [[place, counter.text] for place, counter in enumerate(level.counters) if counter.text]
    counters += [[row, f"{name} left"] for row, name, _ in left_of(level.hands, len(world.counter))]
    stars = {rule: words for rule in range(len(run_rules(level))) if (words := star_words(level, rule))}
    return {
        "goal": level.goal, "counters": counters, "hasClock": has_clock(level.rules), "stars": stars,
        "measure": asdict(measure_of(level)),
    }  # fmt: skip


def _solved(level: Level, file: Path) -> Generator[float, None, dict[str, str] | None]:
    """The solution beside a level's file, in words and as the fragment of a link; None: none wins, or too long."""
    known = at_once(known_solution(level, file))
    with contextlib.suppress(ReplayError):
        return known and {"text": known[1], "fragment": (yield from link_to(known[0], "", 0))}
    return None


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
    """The sounds of bodies, materials by their modes, and motors that hum."""
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


# Cs and Cd of a spring that a page adds: it does not weigh what hangs on it.
SPRINGY = {"stiffness": 0.02, "damping": 0.02}


def materials_for(tick_rate: int) -> dict[str, Any]:
    """Materials, Cs and Cd of ropes and rods and of springs, and Cs and Cd by words of firmness."""
    materials = {
        material.name: {
            **_at_rate(tick_rate, material.stiffness, material.damping),
            "density": material.density,
            "colours": COLOURS if material.name == "jelly" else (),
            "more": material.more,
        }
        for material in MATERIALS.values()
    }
    words = {word: list(_at_rate(tick_rate, *pair).values()) for word, pair in USUAL.items()}
    firmest = {"stiffness": FIRM, "damping": FIRM}
    made = {"stuffs": materials, "firmest": firmest, "springy": at_rate(SPRINGY, tick_rate)}
    return made | {"words": words, "sags": {word: {"sag": sag} for word, sag in SAGS.items()}}


def _firmness_of(world: World) -> list[dict[str, Any]]:
    """What makes each body of a level's as soft as each word says, where that can be had: in commands' words."""
    settings, found = world.settings, list[dict[str, Any]]()
    for body in world.forms:
        found.append({})
        reach = FirmnessRange.of(body.shape, settings.gravity, settings.tick_rate)
        for word, sag in SAGS.items() if jit.COMPILED and len(body.shape.mass) <= LARGEST_READ else ():
            with contextlib.suppress(OutOfReach):
                asked = asdict(reach.as_wobble(reach.nearest(Firmness(sag=sag))))
                found[-1][word] = {name: value for name, value in asked.items() if value is not None}
    return found


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
        left, low, right, high = particles_of(Session(file.level).snapshot())
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
    lines = [[[significant(x, PART_DIGITS), significant(y, PART_DIGITS)] for x, y in loop] for loop in ghost]
    return {"id": key, "name": name, "records": records, "ghost": lines}


def _at_rate(tick_rate: int, stiffness: float, damping: float) -> dict[str, float]:
    pair = {"stiffness": stiffness, "damping": damping}
    return pair if tick_rate == USUAL_RATE else at_rate(pair, tick_rate)


# Cs and Cd for the words of firmness where nothing sags that could tell what they mean.
USUAL = {"jelly": (0.01, 0.1), "soft": (0.05, 0.2), "firm": (0.3, 0.5), "hard": (0.8, 0.9), "rigid": (1.0, 1.0)}
_ALL = "All"
# Work [s] on runs between two answers.
_SLICE = 0.02

_Rows = list[dict[str, Any]]


def material_rows(world: World, level: Level, done: bool) -> Generator[float, None, _Rows]:
    """Materials that springs have; before several of them, all as one. Yields how much is done while runs go on.

    What is shown first is the material that the level's text speaks of, else that of the most springs.
    """
    used = [slot for slot in range(len(world.material_names)) if (world.material == slot).any()]
    rows: list[tuple[str, int | None]] = [(world.material_names[slot], slot) for slot in used]
    if len(rows) > 1:
        rows.insert(0, (_ALL, None))
    counts = np.bincount(world.material[world.material >= 0], minlength=1)
    first = None if level.look is None else level.look.material
    shown = first if first in world.material_names else world.material_names[int(np.argmax(counts))]
    subjects, meters, found = measured_bodies(world), SagMeters(), []
    for name, slot in rows:
        own = own_of(level, name) if slot is not None else None
        made = yield from _words(world, slot, subjects, meters, own or (), float(done))
        found.append({"name": name, "slot": slot, "is_first": slot is not None and name == shown, **made})
    return found


def _words(
    world: World,
    material: int | None,
    subjects: dict[str, MeasuredBody],
    meters: SagMeters,
    own: tuple[float, ...],
    done: float,
) -> Generator[float, None, dict[str, Any]]:
    """The words, the sentence and the map of the largest body of a material."""
    of_it = [each for each in subjects.values() if material in (None, int(world.material[each.body.springs[0]]))]
    if not of_it or not jit.COMPILED:
        return {"words": USUAL}
    subject = max(of_it, key=lambda each: len(each.body.springs))
    meter = meters.of(world, subject)
    meter.trace()
    while meter.is_busy:
        meter.advance(_SLICE)
        yield done
    if meter.curve is None:
        return {"words": USUAL}
    motion = BodyMotion.of(subject.body.shape, world.settings, subject.lowest_mode or 1.0)
    motion = replace(motion, curve=meter.curve)
    support, pairs = meter.body.support, word_pairs(meter, motion)
    said = sag_sentence(subject.name, support)
    return {
        "words": pairs,
        "subject": subject_words(subject.name, support),
        "says": {**said._asdict(), "flat_from": FLAT, "none_below": NO_SAG},
        "map": SagMap.of(motion, scale_of(motion, pairs, own)).as_data(),
    }
