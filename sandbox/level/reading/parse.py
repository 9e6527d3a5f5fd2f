"""parse_level: makes a Level of the bytes of a file, or lists all of its faults. Hostile input costs little.

Order: size, depth by a scan of the bytes, duplicate keys, sizes of lists, the models on the same bytes, references
and counts. Each stage relies on the ones before.
"""

import codecs
import collections
import itertools
import json
import re
from collections.abc import Iterator
from typing import Any

from pydantic import ValidationError

from sandbox.level.document.messages import place, worded
from sandbox.level.document.model import LEVEL_KEYS, Level
from sandbox.level.faults.validate import check_level
from sandbox.level.format.early_end import early_end
from sandbox.level.format.foreign import foreign_bytes, foreign_fault, foreign_keys
from sandbox.level.format.gc_pause import collector_paused
from sandbox.level.format.level_error import Fault, LevelError, json_path, shown
from sandbox.level.format.limits import (
    CHECK_LIMIT,
    FAULT_LIMIT,
    FILE_LIMIT,
    FORMAT,
    MATERIAL_LIMIT,
    PARTICLE_LIMIT,
    RULE_LIMIT,
    SPRING_LIMIT,
    TAG_LIMIT,
    TERRAIN_LIMIT,
    ZONE_LIMIT,
)
from sandbox.level.format.scan import scan
from sandbox.level.plan.plan import keep_plan
from sandbox.level.reading.migrate import migrated

# Beyond this many errors the library takes seconds to list them all, so they are looked for piece by piece.
_FLOOD = 2_000
_PIECE = 500
_LARGE = 1024 * 1024  # [bytes]

_BODY_LISTS = ("particles", "masses", "velocities", "pinned", "pose")
BODY_LIMITS = {"springs": SPRING_LIMIT, "cut": SPRING_LIMIT} | dict.fromkeys(_BODY_LISTS, PARTICLE_LIMIT)
LEVEL_LIMITS = {
    "terrain": TERRAIN_LIMIT,
    "zones": ZONE_LIMIT,
    "bodies": PARTICLE_LIMIT,
    "particles": PARTICLE_LIMIT,
    "springs": SPRING_LIMIT,
    "welds": PARTICLE_LIMIT,
    "tags": TAG_LIMIT,
    "counters": RULE_LIMIT,
    "rules": RULE_LIMIT,
    "checks": CHECK_LIMIT,
    "materials": MATERIAL_LIMIT,
}


def parse_level(data: bytes, source: str) -> Level:
    """Read a level from the bytes of a file; source names it in messages. Raises LevelError with all faults."""
    try:
        with collector_paused(len(data) > _LARGE):
            level = _parse(data, source)
            keep_plan(level, check_level(level, source))
    except (MemoryError, RecursionError):
        raise LevelError(source, [("", "is too large or too deep to be read")]) from None
    return level


def _parse(data: bytes, source: str) -> Level:
    if len(data) > FILE_LIMIT:
        raise LevelError(source, [("", f"is larger than {FILE_LIMIT // 1024 // 1024} MiB; make it smaller")])
    data = data.removeprefix(codecs.BOM_UTF8)
    raw = json_value(data, source)
    if not isinstance(raw, dict):
        raise LevelError(source, [("", f"a level is an object {{...}}; this is {shown(raw)}")])
    kind = None if "format" in raw else foreign_keys(raw)
    if kind:
        raise LevelError(source, [("", foreign_fault(kind))])
    if raw.get("format", FORMAT) != FORMAT:
        fault = "format", f'{shown(raw["format"])} is not "{FORMAT}"; this is no level'
        raise LevelError(source, [fault])
    try:
        raw, before = migrated(raw), raw
    except ValueError as error:
        raise LevelError(source, [("version", str(error))]) from None
    if raw is not before:
        data = json.dumps(raw).encode()
    too_long = list(itertools.islice(_too_long(raw), FAULT_LIMIT + 1))
    if too_long:
        raise LevelError(source, too_long)
    if len(data) > _LARGE:
        # A flood of faults shows in the first piece already; reading all of it would take a second.
        first = _piece(raw, 0)
        if len(first) > FAULT_LIMIT:
            raise LevelError(source, first)
    try:
        return Level.model_validate_json(data)
    except ValidationError as error:
        raise LevelError(source, _library_faults(error, raw)) from None


def json_value(data: bytes, source: str) -> Any:
    """The plain JSON value of a file's bytes. Raises LevelError for what is no JSON, and for repeated keys."""
    fault = _not_text(data) or scan(data)
    if fault:
        raise LevelError(source, [fault])
    repeated: list[tuple[dict[str, Any], str]] = []

    def collect(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        result = dict(pairs)
        if len(result) != len(pairs) and len(repeated) <= FAULT_LIMIT:
            counts = collections.Counter(key for key, _ in pairs)
            repeated.extend((result, key) for key, number in counts.items() if number > 1)
        return result

    decoded = data.decode()
    try:
        raw = json.loads(decoded, object_pairs_hook=collect)
    except json.JSONDecodeError as error:
        text = early_end(decoded, error) or error.msg[:1].lower() + error.msg[1:]
        raise LevelError(source, [(f"line {error.lineno}, column {error.colno}", f"not JSON: {text}")]) from None
    except ValueError:  # Python's own limit of digits
        raise LevelError(source, [("", "an integer has thousands of digits; write a smaller number")]) from None
    if repeated:
        raise LevelError(source, _repeated_keys(raw, repeated))
    return raw


def _not_text(data: bytes) -> Fault | None:
    if not data.strip():
        return "", "is empty; a level is a JSON object {...}"
    kind = foreign_bytes(data)
    if kind:
        return "", foreign_fault(kind)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "line 1", "is UTF-16 text; save it as UTF-8"
    try:
        data.decode()
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        return f"line {line}", f"byte {error.start} is not UTF-8 text; save it as UTF-8"
    return None


def _repeated_keys(raw: Any, repeated: list[tuple[dict[str, Any], str]]) -> Iterator[Fault]:
    keys: dict[int, list[str]] = {}
    for holder, key in repeated[: FAULT_LIMIT + 1]:
        keys.setdefault(id(holder), []).append(key)
    waiting: list[tuple[tuple[Any, ...], Any]] = [((), raw)]
    while waiting and keys:
        path, value = waiting.pop()
        for key in keys.pop(id(value), []):
            yield json_path([*path, key]), "this key stands here more than once; keep one"
        if isinstance(value, dict):
            waiting.extend(((*path, key), item) for key, item in value.items())
        elif isinstance(value, list):
            waiting.extend(((*path, index), item) for index, item in enumerate(value))
    # An object that holds a key twice may itself be the value that a repeated key has replaced.
    for names in keys.values():
        for key in names:
            yield "", f"the key {shown(key)} stands more than once in one object; keep one"


def _too_long(raw: dict[str, Any]) -> Iterator[Fault]:
    whole = list(_long_lists((), raw, LEVEL_LIMITS))
    yield from whole
    bodies = raw.get("bodies")
    if not whole and isinstance(bodies, list):
        for index, body in enumerate(bodies):
            if isinstance(body, dict):
                yield from _long_lists(("bodies", index), body, BODY_LIMITS)


def _long_lists(path: tuple[Any, ...], holder: dict[str, Any], limits: dict[str, int]) -> Iterator[Fault]:
    for key, limit in limits.items():
        value = holder.get(key)
        if isinstance(value, list | dict) and len(value) > limit:
            yield json_path([*path, key]), f"has {len(value):,} items; at most {limit:,} are allowed"


def _library_faults(error: ValidationError, raw: dict[str, Any]) -> Iterator[Fault]:
    if error.error_count() > _FLOOD:
        found = list(itertools.islice(_piecewise(raw), FAULT_LIMIT + 1))
        if found:
            yield from found
            return
    errors: list[dict[str, Any]] = error.errors(include_url=False)  # type: ignore[assignment]
    if errors[0]["type"] == "json_invalid":
        yield _stricter(str(errors[0]["ctx"]["error"]))
        return
    yield from worded(errors)


def _stricter(text: str) -> Fault:
    """Faults that Python's reader does not see: halves of characters in escapes, numbers beyond any range."""
    match = re.fullmatch(r"(.*) at (line \d+) (column \d+)", text)
    what, where = (match[1], f"{match[2]}, {match[3]}") if match else (text, "")
    if "hex escape" in what or "surrogate" in what:
        what = "a \\u escape is half a character; write both halves or the character itself"
    return where, f"not JSON: {what}"


def _piecewise(raw: dict[str, Any]) -> Iterator[Fault]:
    """Faults of a level that has thousands, found piece by piece of every list."""
    longest = max((len(value) for value in raw.values() if isinstance(value, list)), default=0)
    for start in range(0, max(1, longest), _PIECE):
        yield from _piece(raw, start)


def _piece(raw: dict[str, Any], start: int) -> list[Fault]:
    """Faults of a piece of every list of the level, from index start on; at start 0 also of all other fields."""
    piece = {
        key: _cut(value[start : start + _PIECE] if isinstance(value, list) else value)
        for key, value in itertools.chain(_known(raw), itertools.islice(_unknown(raw), _PIECE))
    }
    try:
        Level.model_validate_json(json.dumps(piece))
    except ValidationError as error:
        errors = [_moved(item, start) for item in error.errors(include_url=False)]
        return list(worded([item for item in errors if item is not None and _is_real(item, raw)]))
    return []


def _known(raw: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    return ((key, value) for key, value in raw.items() if key in LEVEL_KEYS)


def _unknown(raw: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    return ((key, value) for key, value in raw.items() if key not in LEVEL_KEYS)


def _cut(value: Any) -> Any:
    if isinstance(value, list):
        return [_cut(item) for item in value[:_PIECE]]
    if isinstance(value, dict):
        return {key: _cut(item) for key, item in itertools.islice(value.items(), _PIECE)}
    return value


def _moved(error: Any, start: int) -> dict[str, Any] | None:
    location = error["loc"]
    if len(location) > 1 and isinstance(location[1], int) and location[0] != "view":
        return {**error, "loc": (location[0], location[1] + start, *location[2:])}
    return dict(error) if start == 0 else None


def _is_real(error: dict[str, Any], raw: Any) -> bool:
    """Whether an error of a piece is an error of the whole level; a missing key may be in another piece."""
    if error["type"] != "missing":
        return True
    parts = place(error["loc"])
    for part in parts[:-1]:
        raw = raw[part]
    return not (isinstance(raw, dict) and parts[-1] in raw)
