"""salvage: keeps what is valid of a damaged level, with a line for each thing that it leaves out."""

import collections
import itertools
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from pydantic import ValidationError

from sandbox.level.checks import CheckDef
from sandbox.level.document.messages import place, worded
from sandbox.level.document.model import (
    LEVEL_KEYS,
    Level,
    ParticleDef,
    SpringDef,
    TerrainDef,
    ZoneDef,
    version_fault,
)
from sandbox.level.faults.validate import level_faults
from sandbox.level.format.foreign import scan
from sandbox.level.format.level_error import Fault, LevelError, json_path, shown
from sandbox.level.format.limits import FAULT_LIMIT, FILE_LIMIT, FORMAT, VERSION
from sandbox.level.plan.plan import Plan
from sandbox.level.reading.old_sags import SAGS_STAND, with_old_sags
from sandbox.level.reading.parse import BODY_LIMITS, LEVEL_LIMITS, migrated
from sandbox.level.rules.rule import CounterDef, RuleDef

_NAME = "Untitled"
_HEAD = {"format": FORMAT, "version": VERSION, "name": _NAME}
_LISTS = ("tags", "terrain", "zones", "bodies", "particles", "springs", "welds", "counters", "rules", "checks")
# Lists whose items are independent, so that a single one can be left out.
_INDEPENDENT = ("springs", "pinned", "cut", "pin")
# Number of items that are validated together while all are valid, which is many times faster.
_BATCH = 500
# Rounds of taking out one item after another. If the level is still not sound, whole ends of lists go.
_ROUNDS = 20
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
# Required fields of items of these lists; those of a body depend on its kind.
_REQUIRED = {
    key: frozenset(name for name, field in model.model_fields.items() if field.is_required())
    for key, model in (
        ("terrain", TerrainDef),
        ("zones", ZoneDef),
        ("particles", ParticleDef),
        ("springs", SpringDef),
        ("counters", CounterDef),
        ("rules", RuleDef),
        ("checks", CheckDef),
    )
}

Path = Sequence[Any]


def salvage(data: bytes, source: str) -> tuple[Level | None, list[str]]:
    """The valid content of a level, and at most 50 lines about what is left out; source names the level in them.

    An invalid field gets its default. An item that needs the field is left out, and so is everything that refers to the
    item. The level is None if the bytes are not JSON, not a level, or of an unknown version.
    """
    faults: list[Fault] = []
    try:
        raw = _read(data, faults)
        version = VERSION if raw is None else raw.get("version")
        now = None if raw is None else _of_this_version(raw, faults)
        level = None if now is None else _Remains(now, faults).level()
        if level is not None and type(version) is int and version < SAGS_STAND:
            level = with_old_sags(level, source)
    except (MemoryError, RecursionError):
        faults.append(("", "is too large or too deep to be read"))
        level = None
    return level, LevelError(source, dict.fromkeys(faults)).faults


def _read(data: bytes, faults: list[Fault]) -> dict[str, Any] | None:
    """A level's plain JSON as it was written, or None; why goes to `faults`."""
    data = data.removeprefix(_BYTE_ORDER_MARK)
    too_long = ("", f"is larger than {FILE_LIMIT // 1024 // 1024} MiB") if len(data) > FILE_LIMIT else None
    hostile = too_long or scan(data)
    if hostile:
        faults.append(hostile)
        return None
    text = data.decode(errors="replace")
    if "\ufffd" in text and "\ufffd".encode() not in data:
        faults.append(("", "holds bytes that are not UTF-8 text; each is shown as \ufffd"))
    try:
        raw = json.loads(text, object_pairs_hook=_without_repetitions(faults), parse_int=_integer)
    except json.JSONDecodeError as error:
        reason = error.msg[:1].lower() + error.msg[1:]
        faults.append((f"line {error.lineno}, column {error.colno}", f"not JSON: {reason}"))
        return None
    if not isinstance(raw, dict):
        faults.append(("", f"a level is an object {{...}}; this is {shown(raw)}"))
        return None
    if "format" not in raw and raw.keys() & {"bodies", "particles"}:
        faults.append(("format", f'is missing; it is taken for "{FORMAT}"'))
    elif raw.get("format") != FORMAT:
        faults.append(("format", f'{shown(raw.get("format"))} is not "{FORMAT}"; this is no level'))
        return None
    return raw


def _without_repetitions(faults: list[Fault]) -> Callable[[list[tuple[str, Any]]], dict[str, Any]]:
    def collect(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        result = dict(pairs)
        if len(result) != len(pairs) and len(faults) <= FAULT_LIMIT:
            counts = collections.Counter(key for key, _ in pairs)
            repeated = (key for key, number in counts.items() if number > 1)
            faults.extend(("", f"the key {shown(key)} stands more than once in one object") for key in repeated)
        return result

    return collect


def _integer(digits: str) -> int | float:
    # Python refuses to read thousands of digits; as a number beyond all limits they fall with their field alone.
    return int(digits) if len(digits) < 400 else float(digits)


def _of_this_version(raw: dict[str, Any], faults: list[Fault]) -> dict[str, Any] | None:
    version = raw.get("version")
    if type(version) is not int:
        faults.append(("version", f"is taken for {VERSION}"))
        return {**raw, "version": VERSION}
    try:
        raw = migrated(raw)
    except ValueError as error:
        faults.append(("version", str(error)))
        return None
    if raw["version"] == VERSION:
        return raw
    faults.append(("version", f"{shown(version)}: {version_fault(version)}"))
    return None


class _Remains:
    """The remaining content of a level as plain JSON, and the places of list items in the file."""

    def __init__(self, raw: dict[str, Any], faults: list[Fault]) -> None:
        self.faults = faults
        self.places: dict[str, list[int]] = {}
        self.parts: dict[str, Any] = dict(_HEAD)
        if "name" not in raw:
            faults.append(("name", f"is missing; it is taken for {shown(_NAME)}"))
        for key in LEVEL_KEYS:
            if key in raw and key not in ("format", "version"):
                self._take(key, raw[key])
        for key in itertools.islice((key for key in raw if key not in LEVEL_KEYS), FAULT_LIMIT + 1):
            self._mended([key], None)

    def level(self) -> Level:
        """The remaining level, in which nothing refers to what was left out."""
        for attempt in itertools.count():
            level = Level.model_validate_json(json.dumps(self.parts))
            found = list(level_faults(level, Plan(level)))
            if not found:
                break
            self._drop(level, found, with_rest=attempt >= _ROUNDS)
        return level

    def _take(self, key: str, value: Any) -> None:
        """Keep what is valid of one field of the level."""
        limit = LEVEL_LIMITS.get(key)
        if limit is not None and isinstance(value, list | dict) and len(value) > limit:
            self.faults.append((key, f"has {len(value):,} items; the first {limit:,} are taken"))
            value = dict(itertools.islice(value.items(), limit)) if isinstance(value, dict) else value[:limit]
        if key in _LISTS and isinstance(value, list):
            taken = list(self._valid_items(key, value))
            self.places[key] = [index for index, _ in taken]
            self.parts[key] = [item for _, item in taken]
        elif key == "materials" and isinstance(value, dict):
            mended = {name: self._mended([key, name], item) for name, item in value.items()}
            self.parts[key] = {name: item for name, item in mended.items() if item is not None}
        else:
            mended_value = self._mended([key], value)
            if mended_value is not None:
                self.parts[key] = mended_value

    def _valid_items(self, key: str, items: list[Any]) -> Iterator[tuple[int, Any]]:
        if key == "bodies":
            items = [self._within_limits([key, index], body) for index, body in enumerate(items)]
        for start in range(0, len(items), _BATCH):
            batch = list(enumerate(items[start : start + _BATCH], start))
            if _errors({key: [item for _, item in batch]}):
                mended = [(index, self._mended([key, index], item)) for index, item in batch]
                batch = [(index, item) for index, item in mended if item is not None]
            yield from batch

    def _within_limits(self, path: Path, body: Any) -> Any:
        """A body without lists that are longer than any file may have."""
        if not isinstance(body, dict):
            return body
        long = [
            name for name, limit in BODY_LIMITS.items() if isinstance(body.get(name), list) and len(body[name]) > limit
        ]
        for name in long:
            text = f"has {len(body[name]):,} items; at most {BODY_LIMITS[name]:,} are allowed"
            self.faults.append((json_path([*path, name]), text))
        return {name: value for name, value in body.items() if name not in long}

    def _mended(self, path: Path, value: Any, mended: bool = False) -> Any:
        """A value of the level, or an item of a list or of the materials, without its invalid content, else None.

        mended: whether a field was taken out already.
        """
        for attempt in itertools.count():
            errors = _errors(_inside(path, value))
            if not errors:
                break
            # A line already names the invalid field that is now missing.
            if len(self.faults) <= FAULT_LIMIT:
                reported = [error for error in errors if error["type"] != "missing" or (attempt == 0 and not mended)]
                self.faults.extend(_as_faults(path, reported))
            wrong = [(place(error["loc"])[len(path) :], error["type"] == "missing") for error in errors]
            value = _without(value, wrong, _REQUIRED.get(path[0], frozenset()))
            if value is None:
                break
        return value

    def _drop(self, level: Level, found: Iterable[Fault], with_rest: bool) -> None:
        """Take out what faults of the whole level name; if asked, also the rest of its list."""
        wrong: dict[tuple[str, int], list[tuple[Path, bool]]] = {}
        for where, text in found:
            key, *rest = where.split(".")
            if key not in self.places:
                self.faults.append((where, text))
                # A fault of the whole level is one of counts, which bodies have reported themselves.
                for name in [key] if key else ["particles", "springs"]:
                    self.parts.pop(name, None)
                    self.places.pop(name, None)
                continue
            index = int(rest[0])
            inner = [int(part) if part.isdigit() else part for part in rest[1:]]
            if len(self.faults) <= FAULT_LIMIT:
                path = json_path([key, self.places[key][index], *inner])
                # Else a check whose particle was left out would be reported as incomplete.
                if path not in (place for place, _ in self.faults):
                    self.faults.append((path, text))
            if key == "bodies" and not inner and self._unweld(level.bodies[index].id):
                continue
            wrong.setdefault((key, index), []).append((inner, False))
        for (key, index), paths in wrong.items():
            item = _without(self.parts[key][index], paths, _REQUIRED.get(key, frozenset()))
            self.parts[key][index] = None if item is None else self._mended([key, self.places[key][index]], item, True)
            if with_rest:
                self.parts[key][index:] = [None] * (len(self.parts[key]) - index)
        for key, places in self.places.items():
            kept = [(index, item) for index, item in zip(places, self.parts[key], strict=True) if item is not None]
            self.places[key] = [index for index, _ in kept]
            self.parts[key] = [item for _, item in kept]

    def _unweld(self, body: str) -> bool:
        """Take out the welds that name a body; whether there were any."""
        found = False
        for index, pair in enumerate(self.parts.get("welds", ())):
            if pair is not None and any(name.partition(".")[0] == body for name in pair):
                self.parts["welds"][index] = None
                found = True
        return found


def _errors(part: dict[str, Any]) -> list[Any]:
    """Errors of the validation library in a level with only this value."""
    try:
        Level.model_validate_json(json.dumps({**_HEAD, **part}))
    except ValidationError as error:
        return error.errors(include_url=False)
    return []


def _inside(path: Path, value: Any) -> dict[str, Any]:
    """A level's field with only this value."""
    if len(path) == 1:
        return {path[0]: value}
    return {path[0]: {path[1]: value} if isinstance(path[1], str) else [value]}


def _as_faults(path: Path, errors: list[Any]) -> Iterator[Fault]:
    """Errors of a value in words, placed where it stands in the file."""
    if any(error["type"] == "json_invalid" for error in errors):
        yield json_path(path), "a \\u escape in it is half a character"
        return
    yield from worded([{**error, "loc": (*path, *error["loc"][len(path) :])} for error in errors])


def _without(value: Any, wrong: Iterable[tuple[Path, bool]], required: frozenset[str]) -> dict[str, Any] | None:
    """A value without the fields or items at these paths, each missing or wrong; None if it must be left out.

    required: fields that it needs, as far as they are known.
    """
    if not isinstance(value, dict):
        return None
    result, items = dict(value), set()
    for path, is_missing in wrong:
        if not path or path[0] not in value or path[0] in required or (is_missing and len(path) == 1):
            return None
        if path[0] in _INDEPENDENT and len(path) > 1 and isinstance(value[path[0]], list):
            items.add((path[0], path[1]))
        else:
            result.pop(path[0], None)
    for key in {key for key, _ in items} & result.keys():
        result[key] = [item for index, item in enumerate(value[key]) if (key, index) not in items]
    return result
