"""The canonical text of a level: without defaults, keys in the order of the models, good for line-by-line diffs."""

import json
import math
from typing import Any

from sandbox.level.document.model import LEVEL_KEYS, Level, Settings
from sandbox.level.kinds.body_def import file_order

# A value goes on one line where it fits into this many columns; otherwise its items go one to a line.
_WIDTH = 100
# Parts of a level whose items always go one to a line, so that adding one changes one line.
_LISTED = ("materials", "terrain", "zones", "bodies", "particles", "springs", "welds", "counters", "rules", "checks")

_encoded = json.JSONEncoder(ensure_ascii=False).encode


def level_data(level: Level) -> dict[str, Any]:
    """A level as JSON data in canonical form: without defaults, except the solver, whose default may change."""
    data = level.model_dump(mode="json", exclude_defaults=True)
    settings = data.get("settings", {}) | {"solver": level.settings.solver}
    data["settings"] = {name: settings[name] for name in Settings.model_fields if name in settings}
    if "bodies" in data:
        data["bodies"] = [{name: body[name] for name in file_order(body)} for body in data["bodies"]]
    return {name: data[name] for name in LEVEL_KEYS if name in data}


def level_text(level: Level) -> str:
    """A level as the text of its file."""
    lines = [f"  {json.dumps(key)}: {_part(key, value)}" for key, value in level_data(level).items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _part(key: str, value: Any) -> str:
    if key not in _LISTED:
        return _fitted(value, 2, len(key) + 6)
    if key == "bodies":
        return _broken(value, 2, [_broken_body(body, 4) for body in value])
    if isinstance(value, dict):
        return _broken(value, 2, [_fitted(item, 4, len(_dump(name)) + 6) for name, item in value.items()])
    return _broken(value, 2, [_fitted(item, 4, 4) for item in value])


def _broken_body(body: dict[str, Any], indent: int) -> str:
    return _broken(body, indent, [_fitted(value, indent + 2, indent + len(key) + 6) for key, value in body.items()])


def _fitted(value: Any, indent: int, column: int) -> str:
    """Text of a value that begins at a column, on one line if it fits."""
    if not isinstance(value, list | dict) or not value:
        return _dump(value)
    # An item takes three columns at least, with what parts it from the next.
    if column + 3 * len(value) < _WIDTH:
        line = _dump(value)
        if column + len(line) < _WIDTH:
            return line
    if isinstance(value, dict):
        items = [_fitted(item, indent + 2, indent + len(_dump(key)) + 4) for key, item in value.items()]
    else:
        items = [_fitted(item, indent + 2, indent + 2) for item in value]
    return _broken(value, indent, items)


def _broken(value: list[Any] | dict[str, Any], indent: int, items: list[str]) -> str:
    if isinstance(value, dict):
        items = [f"{_dump(key)}: {item}" for key, item in zip(value, items, strict=True)]
    if not items:
        return "{}" if isinstance(value, dict) else "[]"
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    margin = "\n" + " " * (indent + 2)
    return opening + margin + ("," + margin).join(items) + "\n" + " " * indent + closing


def _dump(value: Any) -> str:
    """Text of a value on one line."""
    # The encoder takes long to begin, and most values are numbers, or short lists of them.
    kind = type(value)
    if kind is float and math.isfinite(value):
        return float.__repr__(value)
    if kind is int:
        return int.__repr__(value)
    if kind is list:
        return f"[{', '.join(map(_dump, value))}]"
    if kind is dict:
        return f"{{{', '.join([f'{_dump(key)}: {_dump(item)}' for key, item in value.items()])}}}"
    return _encoded(value)
