"""Start: the block of a world before its first tick, as a page is given it, and what a page must know of that world.

The image: arrays of the block as bytes for a memory of their own. About: names, codes and tables, what a kit needs to
join, and which arrays get more rows when it does.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.document.model import ContactsDef
from sandbox.level.format.limits import (
    LIMITED_LIMIT,
    LIMITED_WORK_LIMIT,
    MATERIAL_LIMIT,
    MOTOR_LIMIT,
    PARTICLE_LIMIT,
    SPRING_LIMIT,
)
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.plan.surfaces import DEFAULT_GROUP, TERRAIN_NAME, group_bits
from sandbox.level.rules.player_limits import words_of
from sandbox.level.rules.rule import ActionDef
from sandbox.physics.arena import NO_ARENA
from sandbox.physics.commands import command, command_table
from sandbox.physics.constraints import AREA
from sandbox.physics.driving import Actuators, Drives
from sandbox.physics.jit.bundles import HEAD_WORDS, WORD
from sandbox.physics.jit.library import read_manifest
from sandbox.physics.jit.making.platforms import WEB
from sandbox.physics.joints.joint_set import DrivenWheels
from sandbox.physics.keeping.arguments import FARTHEST
from sandbox.physics.kits import joining, kit_kernels, removing
from sandbox.physics.marks import ALL_GROUPS, GRAB_COUNT, LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.pipeline import block, collide, tick
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.settings import SOLVER_NAMES
from sandbox.physics.state import COLUMNS, FAMILIES, GUARDED, STATE_FIELDS, TOPOLOGY, Column, Family, Range
from sandbox.physics.world import World
from sandbox.session.actions import record_of, softening_of
from sandbox.session.commands.adding import SAME_ENDS
from sandbox.session.commands.command import COMMAND_TYPES
from sandbox.session.commands.for_pages import table_of
from sandbox.session.commands.records import from_record
from sandbox.session.commands.removing import ONE_OF_TWO

# Kernels that a page calls.
_CALLED = {path.rpartition(".")[2]: path for path in WEB.entries}
CODES = ("FINISHED", "UNSOUND", "NO_ROOM", "LOST", "BROKE")
PROGRESS = ("TICK", "MAY_FLY", "COUNT", "DONE", "BROKEN", "CHECKED")
# Arrays of a block beside its state that go on from tick to tick.
SETTING_ARRAYS = ("numbers", "choices")
CONTACT = "contact_"
# The rows of a world, by parts of kits.
_KIT_FAMILIES = {
    "particles": "particle", "springs": "spring", "constraints": "constraint", "corners": "corner", "parts": "actuator",
    "muscles": "muscle", "hydraulics": "hydraulic", "motors": "motor", "rims": "rim", "materials": "material",
    "hulls": "hull",
}  # fmt: skip
_CODES = ("NO_ROWS", "NO_LIMIT_ROWS", "TOO_MANY", "BAD_PLACE", "HEADER")
_WORDS = {
    "notATable": joining.NOT_A_TABLE,
    "notRows": joining.NOT_ROWS,
    "notWhole": joining.NOT_WHOLE,
    "notANumber": joining.NOT_A_NUMBER,
    "unknown": joining.UNKNOWN,
    "missing": joining.MISSING,
    "outOfRange": joining.OUT_OF_RANGE,
    "doesNotFit": joining.DOES_NOT_FIT,
    "noParticle": joining.NO_PARTICLE,
    "tooMuch": joining.TOO_MUCH,
    "tooManyWheels": joining.TOO_MANY_WHEELS,
    "sameEnds": SAME_ENDS,
    "oneOfTwo": ONE_OF_TWO,
    "notThere": "it is not there any more",
}
# By the path of an array: its family, what numbers of a new row are, as JavaScript reads them, and how many rows more
# than of the family it has.
Growth = dict[str, tuple[str, float | str, int]]
Counts = dict[str, int]
# The families that kits add rows to, in arrays of the state; and the hands of a level that begins with nothing.
_GROWING = (Family.PARTICLE, Family.SPRING, Family.CONSTRAINT, Family.CORNER, Family.ACTUATOR, Family.HAND)
_HYDRAULIC = ("hydraulic", "shortest", "longest", "rate", "part", "hydraulic_force", "returns")
# Rows of forms by what they count, in the order of their columns in `first`; and arrays of them by their paths.
FORM_ROWS = ("formPoint", "formSpring", "formConstraint", "formArea", "formBend")
_OF_FORMS = {
    "forms.first": "form", "forms.shapes.points": "formPoint", "forms.shapes.mass": "formPoint",
    "forms.shapes.pairs": "formSpring", "forms.shapes.areas": "formArea", "forms.shapes.bends": "formBend",
    "forms.spring": "formSpring", "forms.constraint": "formConstraint", "modes.body": "form",
    "modes.piece": "formPoint", "modes.point": "formPoint", "modes.spring": "formSpring",
    "modes.constraint": "formConstraint",
}  # fmt: skip
_LIMITS: dict[str, float | str] = {
    "tension": "Infinity",
    "compression": "Infinity",
    "yielding": "Infinity",
    "yield_share": 0.0,
}
# Where arrays begin [bytes].
ALIGNED = 16
# Smaller arrays [bytes] are not looked at for being copies.
LEAST_COPY = 64


class ArrayPlace(NamedTuple):
    """The place of an array in a block: the first of its words, its dtype as numpy writes it, and its dimensions."""

    word: int
    dtype: str
    dimensions: int


class Image(NamedTuple):
    """A block as bytes: its words, then its arrays; addresses count from the first byte. table: by path of the array.

    copies: of arrays that are as another one is, where to and from, and how many bytes; content has zeros there.
    """

    content: bytes
    table: dict[str, ArrayPlace]
    copies: list[tuple[int, int, int]]


class Start(NamedTuple):
    """The image of a world, with all that a page needs to know of it."""

    image: Image
    about: dict[str, Any]


def start_of(world: LevelWorld) -> Start:
    """The start of a world."""
    own = block_of(world)
    own.begin(world)
    image = image_of(own.inputs)
    # Words follow each other as the arrays do.
    table = {path: [place.dtype, place.dimensions] for path, place in image.table.items()}
    known = about(world, own.pointer.nbytes // 8)
    rows = {"counts": row_counts(world), "grows": growth_of(), "kit": kit_table(world)}
    return Start(image, known | {"table": table, "copies": image.copies} | rows)


def about(world: LevelWorld, words: int) -> dict[str, Any]:
    """All that a page must know of a world whose block has so many words, as JSON takes it."""
    entries = read_manifest()["entries"]
    # What grows with what joins, but for what was found of it, which is found again.
    equipment = [path for path in growth_of() if not path.startswith("modes.")]
    kept = [f"state.{name}" for name in STATE_FIELDS] + [f"good.{column.name}" for column in GUARDED]
    return {
        "kernels": {name: entries[path]["symbol"] for name, path in _CALLED.items()},
        "words": words,
        "codes": {name: getattr(tick, name) for name in CODES},
        "plan": {name: getattr(block, name) for name in ("GRAB_PARTICLE", "GRAB_SPRING")},
        "progress": {name: getattr(block, name) for name in PROGRESS} | {"KEPT": collide.KEPT},
        "kinds": {name: kind._asdict() for name, kind in command_table.KINDS.items()},
        "choices": command_table.CHOICES,
        "answers": command_table.ANSWERS,
        "givers": {name: getattr(command, name) for name in ("HAND", "RULE", "PROGRAM")},
        "refusals": {
            "reasons": command.REASONS,
            "words": command_table.WORDS,
            "bad": command.BAD,
            "noRows": command.NO_ROWS,
        },
        "filled": {
            "doing": command.FORBIDDEN,
            "counted": command.EXHAUSTED,
            "thing": command.UNTOUCHABLE,
            "reach": command.BEYOND_REACH,
        },
        "denied": {
            "size": command.DENIED,
            "reasons": {
                command.NOT_ALLOWED: command.FORBIDDEN,
                command.SPENT: command.EXHAUSTED,
                command.UNTOUCHED: command.UNTOUCHABLE,
            },
        },
        "deeds": {name: words_of(name) for name in command_table.CODES},
        "codeOf": command_table.CODES,
        **table_of(set(filter(is_done_by_pages, COMMAND_TYPES)) - {"add_body"}),
        "rate": world.settings.tick_rate,
        "solvers": SOLVER_NAMES,
        "hands": {"particle": world.grab_particle, "spring": world.grab_spring, "count": GRAB_COUNT},
        "area": AREA,
        "columns": [_column(column) for column in COLUMNS],
        "topology": [*(f"state.{column.name}" for column in TOPOLOGY), "choices"],
        "kept": list(dict.fromkeys([*kept, *SETTING_ARRAYS, *equipment])),
        "names": {
            "particle": world.particle_names,
            "spring": world.spring_names,
            "material": world.material_names,
            "part": world.actuators.names,
            "key": world.rule_keys,
            "area": world.area_names,
            "form": [form.name for form in world.forms],
        },
        "rules": [[_action(action, world) for action in rule.then] for rule in run_rules(world.level)],
        "second": {"particle": dict(world.particle_naming.second), "spring": dict(world.spring_naming.second)},
    }


def is_done_by_pages(name: str) -> bool:
    """Whether pages carry out commands of that type."""
    return name in command_table.KINDS or name in ("add_particle", "add_spring", "add_body", "remove")


def _action(action: ActionDef, world: LevelWorld) -> dict[str, Any]:
    """An action as a page does it: what it says, and a counter or a command with slots in place of names."""
    level, rate = world.level, world.settings.tick_rate
    counters = level.counter_names
    made: dict[str, Any] = action.model_dump(include={"win", "fail", "say", "sound"}, exclude_none=True)
    if action.stars is not None:
        stars = action.stars
        place = None if stars.counter is None else counters.index(stars.counter)
        made["stars"] = {"counter": place, "second": stars.second, "third": stars.third}
    if action.count is not None:
        made |= {"count": counters.index(action.count), "by": action.by}
    record = record_of(action, world, rate)
    if record is not None:
        made["commands"] = [{"type": record["type"], **vars(from_record(record, world))}]
    elif action.sag is not None:
        made["commands"] = [{"type": "soften", **softening_of(action, level, world)}]
    return made | ({"isCheckpoint": True} if action.checkpoint else {})


def _column(column: Column) -> dict[str, Any]:
    return {
        "stored": column.stored,
        "path": array_path(column),
        "width": column.width,
        "family": column.family.name.lower(),
        "isContact": column.family is Family.CONTACT,
        "isSparse": column.sparse,
        "usual": float(column.usual),
    }


def array_path(column: Column) -> str:
    """Where in a block the array of a line of the table of state is."""
    if column.family is Family.CONTACT:
        return f"collisions.kept.{column.name.removeprefix(CONTACT)}"
    return f"state.{column.name}"


def kit_table(world: LevelWorld) -> dict[str, Any]:
    """The tables of a kit's columns, limits, answers of kernels and words; 64-bit numbers as text."""
    return {
        "parts": kit_kernels.PART_NAMES,
        "families": _KIT_FAMILIES,
        "slots": [[c.part, c.name, c.usual, _range(c)] for c in joining.SLOT_TABLE],
        "numbers": [[c.part, c.name, _number(c.usual), _range(c)] for c in joining.NUMBER_TABLE],
        "table": [str(value) for value in joining.TABLE.tolist()],
        "ranges": [_number(value) for value in joining.RANGES.tolist()],
        "codes": {name: getattr(kit_kernels, name) for name in _CODES}
        | {"NO_ARENA": NO_ARENA, "BAD_SLOT": removing.BAD_SLOT},
        "ways": {name: getattr(removing, name) for name in ("BODY", "HANGING")},
        "most": {
            "particles": PARTICLE_LIMIT, "springs": SPRING_LIMIT, "motors": MOTOR_LIMIT,
            "materials": MATERIAL_LIMIT + 1, "muscles": LIMITED_LIMIT,
        },
        "limitedWork": LIMITED_WORK_LIMIT,
        "far": str(FARTHEST),
        "groupBits": str(max(group_bits(world.level).values())),
        "nouns": joining.NOUNS,
        "words": _WORDS,
    }  # fmt: skip


def _range(column: joining.SlotColumn | joining.NumberColumn) -> list[Any] | None:
    """Least, most and words of a range; None: of what counts rows."""
    if isinstance(column, joining.SlotColumn):
        within = Range(column.low, column.high)
        return None if column.of else [str(column.low), str(column.high), str(within)]
    return [_number(column.within.lowest), _number(column.within.high), str(column.within)]


def _number(value: float | None) -> float | str | None:
    return value if value is None or math.isfinite(value) else "NaN" if math.isnan(value) else "Infinity"


def adding(world: LevelWorld) -> dict[str, Any]:
    """Surfaces, groups and kinds of edge, for who makes kits, as JSON takes them; 64-bit numbers as text."""
    level = world.level
    usual, surface, bits = level.contacts or ContactsDef(), vars(world.surface), group_bits(level)
    return {
        "surface": {name: str(value) if isinstance(value, int) else value for name, value in surface.items()},
        "body": {
            "friction": usual.friction, "restitution": usual.restitution, "group": str(bits[DEFAULT_GROUP]),
            "collides": str(ALL_GROUPS if level.has_contacts else 0),
        },
        "terrain": str(bits[TERRAIN_NAME] if level.has_contacts else 0),
        "touches": level.has_contacts,
        "edges": {"none": NO_EDGE, "line": LINE, "left": SOLID_LEFT, "right": SOLID_RIGHT},
    }  # fmt: skip


def row_counts(world: World) -> Counts:
    """How many rows there are of each family, of materials and of what is driven.

    limit: materials, where any has limits, else none; breakable: springs, where there are such limits.
    """
    rows = {
        family.name.lower(): len(getattr(world, FAMILIES[family][0].name))
        for family in Family
        if family is not Family.CONTACT
    }
    driven: Actuators = world.actuators
    return rows | {
        "material": len(world.material_names),
        "muscle": len(driven.muscles.spring),
        "hydraulic": len(driven.hydraulics.spring),
        "motor": len(driven.motors.hub),
        "rim": len(driven.motors.rim),
        "hull": len(world.hulls),
        "area": len(world.area_names),
        "form": len(world.forms),
        **dict(zip(FORM_ROWS, world.form_table.forms.first[-1].tolist(), strict=True)),
        "limit": len(world.material_names) if world.limits.exist else 0,
        "breakable": world.spring_count if world.limits.exist else 0,
    }


def growth_of() -> Growth:
    """The fields of a world's block that grow."""
    found: Growth = {}
    for family in _GROWING:
        for column in FAMILIES[family]:
            usual = float(column.usual)
            assert math.isfinite(usual)
            for path in (f"state.{column.name}", *([f"good.{column.name}"] if column.guarded else [])):
                found[path] = family.name.lower(), usual, 0
    for name in Drives._fields:
        found[f"drives.{name}"] = "hydraulic" if name in _HYDRAULIC else "muscle", 0.0, 0
    for name in DrivenWheels._fields:
        family_name = "rim" if name == "rim" else "motor"
        found[f"wheels.{name}"] = family_name, 0.0, int(name == "rim_start")
    found |= {f"limits.{name}": ("limit", fill, 0) for name, fill in _LIMITS.items()}
    found |= {f"limits.{name}": ("breakable", 0.0, 0) for name in ("driven", "broken")}
    for path, family_name in _OF_FORMS.items():
        found[path] = family_name, 0.0, int(path == "forms.first")
    return found | {"water.hull": ("hull", 0.0, 0), "areas": ("area", 0.0, 0)}


def image_of(block: tuple[Any, ...]) -> Image:
    """The image of a named tuple of contiguous arrays and of such tuples; arrays that share memory share it there."""
    arrays = dict(arrays_of(block))
    table, words = {}, 0
    for path, array in arrays.items():
        table[path] = ArrayPlace(words, array.dtype.str.lstrip("<|"), array.ndim)
        words += HEAD_WORDS + 2 * array.ndim
    where, content = _laid_out(list(arrays.values()), _aligned(WORD * words))
    values = [
        value
        for array in arrays.values()
        for value in (
            0, 0, array.size, array.itemsize, where.get(array.ctypes.data, 0), *array.shape, *array.strides,
        )
    ]  # fmt: skip
    content[: WORD * words] = np.array(values, "<i8").tobytes()
    copies = _leave_out_copies(list(arrays.values()), where, content)
    return Image(bytes(content), table, copies)


def arrays_of(item: Any, path: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """The arrays of a named tuple of such and of named tuples, by their paths."""
    if isinstance(item, np.ndarray):
        yield path, item
        return
    for name, part in zip(item._fields, item, strict=True):
        yield from arrays_of(part, f"{path}.{name}" if path else name)


def _laid_out(arrays: list[NDArray[Any]], end: int) -> tuple[dict[int, int], bytearray]:
    """Where in an image each address here is, and the image with all arrays; end [bytes]: where there is room."""
    where: dict[int, int] = {}
    content = bytearray(end)
    reached = start = 0
    for array in sorted((array for array in arrays if array.nbytes), key=lambda array: array.ctypes.data):
        first = array.ctypes.data
        if first >= reached:
            start, end = first, _aligned(len(content))
        reached = max(reached, first + array.nbytes)
        where[first] = end + first - start
        content.extend(bytes(max(0, end + reached - start - len(content))))
        content[where[first] : where[first] + array.nbytes] = array.tobytes()
    return where, content


def _leave_out_copies(
    arrays: list[NDArray[Any]], where: dict[int, int], content: bytearray
) -> list[tuple[int, int, int]]:
    first: dict[bytes, int] = {}
    copies = []
    for array in arrays:
        held, place = array.tobytes(), where.get(array.ctypes.data, 0)
        if len(held) < LEAST_COPY or not any(held) or first.setdefault(held, place) == place:
            continue
        copies.append((place, first[held], len(held)))
        content[place : place + len(held)] = bytes(len(held))
    return copies


def _aligned(size: int) -> int:
    return -(-size // ALIGNED) * ALIGNED
