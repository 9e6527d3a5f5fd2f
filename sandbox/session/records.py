"""Records: commands as the JSON objects of replay and script files, where everything goes by name."""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from pydantic import ValidationError

from sandbox.physics.world import World
from sandbox.session.commands import (
    AddParticle,
    AddSpring,
    Command,
    CommandError,
    CutSprings,
    Grab,
    MoveGrab,
    Pin,
    Redo,
    Release,
    SetAir,
    SetCoefficients,
    SetDrive,
    SetGravity,
    SetInflation,
    SetSolver,
    Undo,
    Unpin,
    adapter,
    plain_fault,
)


@dataclass(frozen=True)
class ScriptLine:
    """A recorded command: the JSON object `record` of a gesture, for a tick; line: where it stands in its file."""

    tick: int
    gesture: int
    record: dict[str, Any]
    line: int


COMMAND_TYPES: dict[str, type[Command]] = {
    "grab": Grab,
    "move_grab": MoveGrab,
    "release": Release,
    "pin": Pin,
    "unpin": Unpin,
    "cut_springs": CutSprings,
    "add_particle": AddParticle,
    "add_spring": AddSpring,
    "set_coefficients": SetCoefficients,
    "set_gravity": SetGravity,
    "set_air": SetAir,
    "set_drive": SetDrive,
    "set_inflation": SetInflation,
    "set_solver": SetSolver,
    "undo": Undo,
    "redo": Redo,
}
_TYPE_NAMES = {kind: name for name, kind in COMMAND_TYPES.items()}


def to_record(command: Command, world: World) -> dict[str, Any]:
    """A command as the JSON object of a file: slots become names, settings that it leaves alone are left out."""
    record: dict[str, Any] = {"type": _TYPE_NAMES[type(command)]}
    for field, value in asdict(command).items():
        if value is None:
            continue
        if field in ("particle", "particle_a", "particle_b"):
            record[field] = world.particle_names[value]
        elif field == "springs":
            record[field] = [world.spring_names[slot] for slot in value]
        elif field == "part":
            record[field] = world.driven.part_names[value]
        elif field == "body":
            record[field] = world.area_names[value]
        elif field == "material":
            record[field] = world.material_names[value]
        else:
            record[field] = list(value) if isinstance(value, tuple) else value
    return record


def from_record(record: dict[str, Any], world: World) -> Command:
    """The command of a JSON object, its names looked up in the world. Raises CommandError, one line."""
    values = dict(record)
    type_name = values.pop("type", None)
    kind = COMMAND_TYPES.get(type_name) if isinstance(type_name, str) else None
    if kind is None:
        raise CommandError(f"unknown command {type_name!r:.80}; there are {', '.join(COMMAND_TYPES)}")
    for field in ("particle", "particle_a", "particle_b"):
        if field in values:
            values[field] = _slot("particle", values[field], world.particle_slot)
    if isinstance(values.get("springs"), list):
        values["springs"] = [_slot("spring", name, world.spring_slot) for name in values["springs"]]
    if "part" in values:
        values["part"] = _slot("driven part", values["part"], world.driven.part_names.index)
    if "body" in values:
        values["body"] = _slot("body that keeps an area", values["body"], world.area_names.index)
    if values.get("material") is not None:
        values["material"] = _slot("material", values["material"], world.material_names.index)
    try:
        # JSON mode: lists stand for tuples and whole numbers for floats, and nothing else is converted.
        return adapter(kind).validate_json(json.dumps(values), strict=True)
    except (ValidationError, ValueError) as error:
        text = plain_fault(error) if isinstance(error, ValidationError) else str(error)
        raise CommandError(f"{type_name}: {text}") from None


def _slot(noun: str, name: Any, find: Callable[[str], int]) -> int:
    if not isinstance(name, str):
        raise CommandError(f"a {noun} goes by its name in quotes, not {name!r:.80}")
    try:
        return find(name)
    except (KeyError, ValueError):
        raise CommandError(f"there is no {noun} {name!r:.80}") from None
