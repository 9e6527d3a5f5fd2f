"""parse_level: makes a Level of the bytes of a file, or lists all of its faults. Hostile input costs little.

Order: size, depth by a scan of the bytes, duplicate keys, conversion of older versions, sizes of lists, the models on
the same bytes, references and counts. Each stage relies on the ones before.
"""

import codecs
import collections
import contextlib
import gc
import itertools
import json
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from sandbox.level.document.messages import place, worded
from sandbox.level.document.model import LEVEL_KEYS, Level
from sandbox.level.faults.validate import check_level
from sandbox.level.format.foreign import CONFLICT, foreign_bytes, foreign_fault, foreign_keys, scan
from sandbox.level.format.level_error import Fault, LevelError, json_path, shown
from sandbox.level.format.limits import (
    CHECK_LIMIT,
    DEFAULT_MATERIAL,
    DEFAULT_SOLVER,
    FAULT_LIMIT,
    FILE_LIMIT,
    FORMAT,
    MATERIAL_LIMIT,
    PARTICLE_LIMIT,
    RULE_LIMIT,
    SPRING_LIMIT,
    TAG_LIMIT,
    TERRAIN_LIMIT,
    VERSION,
    ZONE_LIMIT,
)
from sandbox.level.plan.plan import keep_plan
from sandbox.level.reading.old_sags import SAGS_STAND, with_old_sags
from sandbox.physics.equation import HIGHEST_COEFFICIENT, half_step, whole_of_parts

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
        with _collector_paused(len(data) > _LARGE):
            level, version = _parse(data, source)
            if version < SAGS_STAND:
                level = with_old_sags(level, source)
            keep_plan(level, check_level(level, source))
    except (MemoryError, RecursionError):
        raise LevelError(source, [("", "is too large or too deep to be read")]) from None
    return level


def _parse(data: bytes, source: str) -> tuple[Level, int]:
    """A level, not yet checked as a whole, and the version that it was written in."""
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
        return Level.model_validate_json(data), before["version"]
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
        text = _early_end(decoded, error) or error.msg[:1].lower() + error.msg[1:]
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
    if conflict := CONFLICT.search(data):
        line = data.count(b"\n", 0, conflict.start()) + 1
        return f"line {line}", "a merge conflict of git; keep one side of it, and take out its marks <<<, === and >>>"
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


_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"?|[{}\[\]:,]|[^\s{}\[\]:,"]+', re.DOTALL)
# What may follow the place of an error in a text that merely stops: part of a word or number.
_STUMP = re.compile(r"[\w.+-]*\s*", re.ASCII)


def _early_end(text: str, error: json.JSONDecodeError) -> str | None:
    """Where a text ends too early, in words; None if it has another fault."""
    is_cut = error.msg.startswith("Unterminated string") or _STUMP.fullmatch(text, error.pos)
    path = _open_path(text) if is_cut else None
    if path is None:
        return None
    return f"the file ends inside {json_path(path)}" if path else "the file ends inside the level"


def _open_path(text: str) -> list[str | int] | None:
    """Keys and indices of the lists and objects that are open at the end of a text; None if there are none."""
    opened: list[list[str | int | None]] = []
    last = ""
    for found in _TOKEN.finditer(text):
        token = found[0]
        if token in "{[":
            opened.append([None if token == "{" else 0])
        elif token in "}]":
            if not opened:
                return None
            opened.pop()
            if opened and not isinstance(opened[-1][0], int):
                opened[-1][0] = None
        elif not opened:
            return None
        elif token == ":":
            opened[-1][0] = last.strip('"')
        elif token == ",":
            place = opened[-1][0]
            opened[-1][0] = place + 1 if isinstance(place, int) else None
        last = token
    places = [place for (place,) in opened]
    return [place for place in places if place is not None] if opened else None


@contextlib.contextmanager
def _collector_paused(pause: bool) -> Iterator[None]:
    """Pause the collector inside, if asked, unless it is paused already."""
    pause = pause and gc.isenabled()
    if pause:
        gc.disable()
    try:
        yield
    finally:
        if pause:
            gc.enable()


Migration = Callable[[dict[str, Any]], dict[str, Any]]


def migrated(
    raw: dict[str, Any], migrations: Mapping[int, Migration] | None = None, version: int = VERSION
) -> dict[str, Any]:
    """The JSON of a level converted to this version of the format; unchanged if its version is this one or unknown.

    Raises ValueError if it is not valid in its own version.
    """
    migrations = MIGRATIONS if migrations is None else migrations
    while type(raw.get("version")) is int and raw["version"] < version and raw["version"] in migrations:
        before = raw["version"]
        try:
            raw = {**migrations[before](raw), "version": before + 1}
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            raise ValueError(f"is no valid level of version {before}, so it cannot be brought to {version}") from None
    return raw


def _springs_keep_their_constant(raw: dict[str, Any]) -> dict[str, Any]:
    """Version 1 to 2: substeps of the direct solver keep k and c of springs; before, they kept the motion of each.

    Changes Cs and Cd of a tick so that those of a substep stay the same. Materials at 1, and bodies with a firmness,
    stay as they are.
    """
    settings = raw.get("settings") or {}
    parts = settings.get("substeps", 1)
    if settings.get("solver", DEFAULT_SOLVER) != "direct" or type(parts) is not int or parts < 2:
        return raw
    materials = dict(raw.get("materials") or {})
    sprung = [*(raw.get("bodies") or []), *(raw.get("springs") or [])]
    if any(part.get("material", DEFAULT_MATERIAL) == DEFAULT_MATERIAL for part in sprung):
        materials.setdefault(DEFAULT_MATERIAL, {})
    return {
        **raw,
        "materials": {
            name: material if "law" in material else _same_in_parts(material, parts)
            for name, material in materials.items()
        },
        "bodies": [
            {**body, "bending": _same_in_parts(body["bending"], parts)} if body.get("bending") is not None else body
            for body in raw.get("bodies") or []
        ],
    }


def _same_in_parts(springs: dict[str, Any], parts: int) -> dict[str, Any]:
    stiffness, damping = springs.get("stiffness", 0.5), springs.get("damping", 0.9)
    if not (0.0 <= stiffness <= 1.0 and 0.0 <= damping <= HIGHEST_COEFFICIENT):
        return springs
    halved = 1
    while halved < parts:
        stiffness, damping = half_step(stiffness, damping)
        halved *= 2
    stiffness, damping = whole_of_parts(stiffness, damping, parts)
    return {**springs, "stiffness": stiffness, "damping": damping}


# From a version to the next: the plain JSON of a level, not yet looked at, in; another object out, whose version is
# set here. What version 2 says, version 3 says too; what that says of sags, old_sags.py reads. A file keeps its version
# until it is saved. Taking a step out makes every file of its version unreadable.
MIGRATIONS: dict[int, Migration] = {1: _springs_keep_their_constant, 2: dict, 3: dict}
