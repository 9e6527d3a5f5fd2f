"""Edits of a level's data by the paths of its fields: the difference of two levels, and single values that are set."""

import copy
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError, suggestion
from sandbox.level.reading.files import file_of, keep_file, level_data, parse_level, run_with
from sandbox.level.reading.pictures import pictures_of, take_pictures

# What a place holds that is not there.
ABSENT = object()
# Fields that are listed as different, at most.
MOST_LISTED = 10
# Fields that say nothing about a run.
SILENT = ("name", "description", "goal", "author", "licence", "tags", "view", "look", "extras", "checks")


def runs_alike(before: Level, after: Level) -> bool:
    """Whether two levels differ in nothing that a run could tell."""
    names = [name for name in Level.model_fields if name not in (*SILENT, "schema_link", "format")]
    return before is after or all(getattr(before, name) == getattr(after, name) for name in names)


@dataclass(frozen=True)
class Edit:
    """A value of a level's data that is another: place by place from the top, names of parts where they have ids.

    usual: the default that counts on the side that leaves it out, ABSENT where there is none.
    """

    path: tuple[str | int, ...]
    before: Any
    after: Any
    usual: Any = ABSENT

    def __str__(self) -> str:
        return f"{path_text(self.path)}: {self._side(self.before)} -> {self._side(self.after)}"

    def _side(self, value: Any) -> str:
        is_default = value is ABSENT and self.usual not in (ABSENT, None)
        return f"{_shown(self.usual)} (default)" if is_default else _shown(value)


def path_text(path: Sequence[str | int]) -> str:
    """The path of a field as people write it: "bodies.deck.segments"."""
    return ".".join(map(str, path))


def edits_between(before: Any, after: Any, path: tuple[str | int, ...] = ()) -> list[Edit]:
    """The edits, value by value, that lead from one level's data to another's; looks are left out."""
    if before == after and type(before) is type(after):
        return []
    if isinstance(before, dict) and isinstance(after, dict):
        keys = [key for key in {**before, **after} if path or key not in SILENT]
        return [edit for key in keys for edit in
                edits_between(before.get(key, ABSENT), after.get(key, ABSENT), (*path, key))]  # fmt: skip
    if isinstance(before, list) and isinstance(after, list):
        left, right = _named(before), _named(after)
        shared = [name for name in left if name in right]
        if shared == [name for name in right if name in left] and list(left) == [*shared, *list(left)[len(shared) :]]:
            return [edit for name in {**left, **right} for edit in
                    edits_between(left.get(name, ABSENT), right.get(name, ABSENT), (*path, name))]  # fmt: skip
    return [] if _equal(before, after) else [Edit(path, before, after)]


def level_edits(before: Level, after: Level) -> list[Edit]:
    """The edits that lead from one level to another, with the defaults of what one of the two leaves out."""
    edits = edits_between(level_data(before), level_data(after))
    whole: dict[bool, Any] = {}

    def usual(edit: Edit) -> Any:
        is_first = edit.before is ABSENT
        if not is_first and edit.after is not ABSENT:
            return ABSENT
        if is_first not in whole:
            whole[is_first] = (before if is_first else after).model_dump(mode="json")
        return _at(whole[is_first], edit.path)

    return [replace(edit, usual=usual(edit)) for edit in edits]


def edit_lines(before: Level, after: Level, name: str = "level") -> tuple[str, ...]:
    """The edits from one level to another, which is called so, a line each, the first ten of them."""
    edits = level_edits(before, after)
    lines = [f"{name}: {edit}" for edit in edits[:MOST_LISTED]]
    if len(edits) > MOST_LISTED:
        lines.append(f"{name}: and {len(edits) - MOST_LISTED} fields more")
    return tuple(lines)


def _at(data: Any, path: Sequence[str | int]) -> Any:
    """The value at a place of a level's data, ABSENT where there is no such place."""
    for part in path:
        inside = _named(data) if isinstance(data, list) else data
        if not isinstance(inside, dict) or part not in inside:
            return ABSENT
        data = inside[part]
    return data


def _made_again(level: Level, data: dict[str, Any], source: str) -> Level:
    """A level of changed data of another, with the pictures of that. Raises LevelError."""
    found = parse_level(json.dumps(data).encode(), source)
    take_pictures(found, pictures_of(level))
    return found


def edited(level: Level, edits: Iterable[Edit]) -> Level:
    """A level with these edits. Raises LevelError for one that is none."""
    data = copy.deepcopy(level_data(level))
    for edit in edits:
        _put(data, edit.path, edit.after)
    return _made_again(level, data, "the edited level")


def with_settings(level: Level, settings: Mapping[str, Any], source: str) -> Level:
    """A level that is run with other values of some of its settings, which source has given. Raises LevelError."""
    data = level_data(level)
    data["settings"] = {**data.get("settings", {}), **settings}
    found = _made_again(level, data, source)
    keep_file(found, file_of(level), tuple({**dict.fromkeys(run_with(level)), **settings}))
    return found


def field_place(level: Level, name: str) -> str:
    """The place of a field as `with_value` takes it; a body's may be called by its id alone, as in "rope.segments"."""
    is_body = name.partition(".")[0] in {body.id for body in level.bodies}
    return f"bodies.{name}" if is_body else name


def with_value(level: Level, path: str, value: Any) -> Level:
    """A level with another value at a place such as "settings.gravity.1" or "bodies.deck.segments".

    Raises LevelError where there is no such place, or not for this value.
    """
    data = copy.deepcopy(level_data(level))
    # What is left out has a value too.
    data["settings"] = json.loads(level.settings.model_dump_json())
    places: list[str | int] = list(path.split("."))
    try:
        _put(data, places, value)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        part = str(error.args[0]) if error.args else path
        near = suggestion(part, _names(data))
        raise LevelError("the level", [(path, f"there is no such place{near}")]) from None
    return _made_again(level, data, path)


def _put(data: Any, path: Sequence[str | int], value: Any) -> None:
    for number, part in enumerate(path):
        is_last = number == len(path) - 1
        if isinstance(data, list):
            place = _index(data, part)
            if is_last and value is ABSENT:
                del data[place]
            elif is_last:
                data[place : place + 1] = [value]
            elif place < len(data):
                data = data[place]
            else:
                raise IndexError(part)
        elif not isinstance(data, dict):
            raise KeyError(part)
        elif is_last and value is ABSENT:
            data.pop(part, None)
        elif is_last:
            data[part] = value
        else:
            data = data[part]


def _index(parts: list[Any], name: str | int) -> int:
    """The place of a part by its id or number; one beyond the last of an id that there is not."""
    found = next((k for k, each in enumerate(parts) if isinstance(each, dict) and each.get("id") == name), None)
    if found is not None:
        return found
    if str(name).isdecimal():
        place = int(name)
        if place > len(parts):
            raise IndexError(name)
        return place
    return len(parts)


def _named(parts: list[Any]) -> dict[str | int, Any]:
    """Parts by their ids, or else by number."""
    return {each["id"] if isinstance(each, dict) and "id" in each else k: each for k, each in enumerate(parts)}


def _names(data: Any) -> list[str]:
    return [*data, *data.get("settings", {}), *(each["id"] for each in data.get("bodies", []))]


def _equal(before: Any, after: Any) -> bool:
    return before is not ABSENT and after is not ABSENT and before == after


def _shown(value: Any) -> str:
    if value is ABSENT:
        return "left out"
    text = json.dumps(value)
    return text if len(text) <= 80 else text[:77] + "..."
