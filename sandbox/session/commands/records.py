"""Commands as the JSON objects of replay and script files, where everything goes by name."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from typing import Any, Protocol

import numpy as np
from pydantic import ValidationError

from sandbox.level.format.level_error import shown
from sandbox.physics.world import World
from sandbox.session.commands.command import COMMAND_TYPES, Command, CommandError, adapter
from sandbox.session.commands.faults import NO_COMMAND, UNKNOWN, plain_fault
from sandbox.session.commands.named import namespaces

# Gestures that a script does not number are numbered by line from here, beyond those that it does.
UNNUMBERED = 2**40


@dataclass(frozen=True)
class ScriptLine:
    """A recorded command: the JSON object `record` of a gesture, for a tick; line: where it stands in its file."""

    tick: int
    gesture: int
    record: dict[str, Any]
    line: int


def to_record(command: Command, world: World) -> dict[str, Any]:
    """A command as the JSON object of a file: slots become names, those that were said where
    a thing has two; settings that it leaves alone are left out."""
    record: dict[str, Any] = {"type": command.type}
    named = namespaces(type(command))
    for field, value in asdict(command).items():  # type: ignore[call-overload]
        if value is None or (value == () and field not in named):
            continue
        if field in named:
            names = named[field].names(world)
            called = [
                getattr(slot, "said", "") or names[slot] for slot in (value if isinstance(value, tuple) else [value])
            ]
            record[field] = called if isinstance(value, tuple) else called[0]
        else:
            record[field] = list(value) if isinstance(value, tuple) else value
    return record


def from_record(record: Any, world: World) -> Command:
    """The command of a JSON object, its names looked up in the world. Raises CommandError, one line."""
    if not isinstance(record, dict) or not isinstance(record.get("type"), str):
        raise CommandError(NO_COMMAND)
    values = dict(record)
    type_name = values.pop("type")
    kind = COMMAND_TYPES.get(type_name)
    if kind is None:
        raise CommandError(UNKNOWN.format(shown(type_name), ", ".join(COMMAND_TYPES)))
    slots: dict[str, Any] = {}
    for field, names in namespaces(kind).items():
        if isinstance(values.get(field), list):
            slots[field] = tuple(names.slot(world, name) for name in values[field])
        elif values.get(field) is not None:
            slots[field] = names.slot(world, values[field])
    try:
        # JSON mode: lists stand for tuples and whole numbers for floats, and nothing else is converted.
        command = adapter(kind).validate_json(json.dumps(values | slots, default=_plain), strict=True)
    except (ValidationError, ValueError) as error:
        text = plain_fault(error, namespaces(kind)) if isinstance(error, ValidationError) else str(error)
        raise CommandError(f"{type_name}: {text}") from None
    return replace(command, **slots) if slots else command


def _plain(value: Any) -> Any:
    """What numpy has, as JSON has it."""
    if not isinstance(value, np.ndarray | np.generic):
        raise CommandError(f"{type(value).__name__} is no value of a command")
    return value.tolist()


class Applied(Protocol):
    """A command that was applied to a world."""

    tick: int
    gesture: int
    command: Command


def script_of(entries: Iterable[Applied], world: World) -> tuple[ScriptLine, ...]:
    """The lines of a script that carries out what was applied to a world."""
    return tuple(
        ScriptLine(each.tick, each.gesture, to_record(each.command, world), number)
        for number, each in enumerate(entries, 1)
    )
