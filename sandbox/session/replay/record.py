"""Lines of recordings and of scripts: JSON objects with known fields; each fault is one line."""

import json
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sandbox.level.format.level_error import shown
from sandbox.session.commands.faults import plain_fault
from sandbox.session.replay.recording import ReplayError

Tick = Annotated[int, Field(ge=0, le=2**53)]
Digest = Annotated[str, Field(max_length=128)]


class Line(BaseModel):
    """A line's fields; others are refused."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class CommandLine(Line):
    """A command at a tick, of a gesture."""

    tick: Tick
    gesture: Tick = 0
    command: dict[str, Any]


AnyLine = TypeVar("AnyLine", bound=Line)


def json_object(where: str, line: bytes) -> dict[str, Any]:
    """The JSON object that a line is. Raises ReplayError for anything else, and for a key that stands twice in it."""
    try:
        values = json.loads(line, object_pairs_hook=_distinct)
    except _RepeatedKeyError as error:
        raise ReplayError(f"{where}: {error}") from None
    except (ValueError, RecursionError):
        raise ReplayError(f"{where}: not a line of JSON") from None
    if not isinstance(values, dict):
        raise ReplayError(f"{where}: not a JSON object")
    return values


class _RepeatedKeyError(Exception):
    pass


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for key, value in pairs:
        if key in values:
            raise _RepeatedKeyError(f"{shown(key)}: this key stands here more than once; keep one")
        values[key] = value
    return values


def checked(where: str, kind: type[AnyLine], line: bytes) -> AnyLine:
    """A line's fields, checked; of a command no key may stand twice anywhere. Raises ReplayError."""
    try:
        if issubclass(kind, CommandLine):
            return kind.model_validate(json_object(where, line))
        return kind.model_validate_json(line)
    except ValidationError as error:
        raise ReplayError(f"{where}: {plain_fault(error)}") from None
