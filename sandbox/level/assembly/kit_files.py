"""Kits as JSON: what links and recordings of pages hold of bodies, and the page that describes it, docs/kits.md.

`python -m sandbox.level.assembly.kit_files > docs/kits.md` writes the page.
"""

import json
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from sandbox.level.assembly.kits import Kit, KitNames
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.limits import BODY_RADIUS, FORMAT, VERSION
from sandbox.level.reading.parse import parse_level
from sandbox.physics.constraints import TRIANGLE
from sandbox.physics.keeping.equipment import FirmBody, StiffForm
from sandbox.physics.kits.joining import (
    DOES_NOT_FIT,
    NOT_A_TABLE,
    NUMBER_TABLE,
    SLOT_TABLE,
    UNKNOWN,
    KitError,
    NumberColumn,
    SlotColumn,
    rows_of,
)
from sandbox.physics.kits.kit_kernels import PART_NAMES

# Of a kit beside the columns of its parts.
FIELDS = ("bodies", "names", "areas", "forms", "keys", "look")
# Rows and bodies of a kit at most.
MOST = 5000
_SAFE = 2**53
_TEXT, _DIGITS = re.compile(r"\w{1,40}", re.ASCII), re.compile(r"[0-9]{1,9}")


def written(kit: Kit, keys: Mapping[str, Any], look: Mapping[str, Any]) -> dict[str, Any]:
    """A kit as JSON takes it; keys: that drive parts of it; look: what people see of it, in its own slots."""
    found: dict[str, Any] = {"bodies": kit.bodies}
    for part, columns in _left_out(kit.columns).items():
        plain = {name: _plain(part, name, values) for name, values in columns.items()}
        plain = {name: values for name, values in plain.items() if values is not None}
        if plain:
            found[part] = plain
    names = kit.names
    found["names"] = {
        "particles": _runs((body, int(text)) for body, text in names.particles),
        "springs": _runs((body, int(text)) for body, text in names.springs),
        "second": [list(each) for each in names.second],
        "parts": list(names.parts),
    }
    areas = [[body, each.start, len(each)] for body, each in kit.areas]
    forms = [_form(body, form, kit.columns) for body, form in kit.forms]
    more = {"areas": areas, "forms": forms, "keys": dict(keys), "look": dict(look)}
    return found | {name: values for name, values in more.items() if values}


def _left_out(columns: Mapping[str, Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """The columns without what follows from others: lengths and forms as placed."""
    particles, springs, corners = columns["particles"], columns["springs"], columns["corners"]
    x, y, a, b = particles["x"], particles["y"], springs["a"], springs["b"]
    dx, dy = x[b] - x[a], y[b] - y[a]
    rest = np.where(springs["rest_length"] == np.sqrt(dx * dx + dy * dy), np.nan, springs["rest_length"])
    form = {
        name: np.where(corners[name] == places[corners["particle"]], np.nan, corners[name])
        for name, places in (("x", x), ("y", y))
    }
    stuff = columns["materials"]
    # Of what does not yield nobody asks how much.
    plain = {"yield_share": np.where(np.isinf(stuff["yielding"]), np.nan, stuff["yield_share"])}
    for name in ("tension", "compression", "yielding"):
        plain[name] = np.where(np.isinf(stuff[name]), np.nan, stuff[name])
    materials = {"name": stuff["name"], **plain}
    return {
        **columns,
        "springs": {**springs, "rest_length": rest},
        "corners": {**corners, **form},
        "materials": materials,
    }


def _plain(part: str, name: str, values: Any) -> Any:
    """A column as JSON takes it; one value, where all are alike; None: as usual, or no rows."""
    column = next((each for each in (*SLOT_TABLE, *NUMBER_TABLE) if (each.part, each.name) == (part, name)), None)
    rows = values if isinstance(values, list) else (np.asarray(values) + 0).tolist()
    if column is None or not isinstance(rows, list):
        return rows or None
    is_whole = isinstance(column, SlotColumn)
    # The first column of a part says how many rows it has.
    is_first = name == next(each.name for each in (*SLOT_TABLE, *NUMBER_TABLE) if each.part == part)
    usual = None if is_first else column.usual
    found = [None if _is_usual(value, usual) else int(value) if is_whole else value for value in rows]
    if all(value is None for value in found):
        return None
    found = [str(value) if isinstance(value, int) and value > _SAFE else value for value in found]
    return found[0] if not is_first and len(set(found)) == 1 else found


def _is_usual(value: float, usual: float | None) -> bool:
    return usual is not None and (value == usual or (math.isnan(usual) and math.isnan(value)))


def _runs(numbers: Iterable[tuple[int, int]]) -> list[list[int]]:
    """Bodies and numbers as runs: a body, the first number, and how many."""
    runs: list[list[int]] = []
    for body, number in numbers:
        if runs and runs[-1][0] == body and (body < 0 or runs[-1][1] + runs[-1][2] == number):
            runs[-1][2] += 1
        else:
            runs.append([body, number, 1])
    return runs


def _form(body: int, form: FirmBody, columns: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    shape = form.shape
    return {
        "body": body,
        "x": shape.points[:, 0].tolist(), "y": shape.points[:, 1].tolist(), "mass": shape.mass.tolist(),
        "pairs": shape.pairs.reshape(-1).tolist(), "areas": shape.areas.reshape(-1).tolist(),
        "bends": shape.bends.reshape(-1).tolist(), "springs": form.springs.tolist(),
        "constraints": form.constraints.tolist(),
    }  # fmt: skip


def read(data: Any) -> Kit:
    """The kit of a table of JSON. Raises KitError; what the kernel looks at is not looked at here."""
    if not isinstance(data, Mapping):
        raise KitError(NOT_A_TABLE.format("kit"))
    stranger = next((name for name in data if name not in (*FIELDS, *PART_NAMES[1:])), None)
    if stranger is not None:
        raise KitError(UNKNOWN.format(stranger[:60]))
    data = _with_whole_numbers(data)
    bodies = data.get("bodies", 0)
    if not _is_whole(bodies, 0, MOST):
        raise KitError(DOES_NOT_FIT.format("bodies", str(bodies)[:20]))
    columns = {part: data[part] for part in PART_NAMES[1:] if part in data}
    counts = {part: rows_of(part, columns.get(part, {})) for part in PART_NAMES}
    if max(counts.values()) > 20 * MOST:
        raise KitError(DOES_NOT_FIT.format("kit", "so many rows"))
    names = _names(data.get("names", {}), bodies, counts)
    areas = tuple(
        (body, range(first, first + count)) for body, first, count in _areas(data.get("areas", []), bodies, counts)
    )
    forms = tuple(_read_form(each, bodies, counts) for each in _listed(data.get("forms", []), "forms"))
    _check_keys(data.get("keys", {}), counts["parts"])
    return Kit(bodies, columns, names, areas, forms, _source(data, columns, names, bodies), {"kit": data})


def _with_whole_numbers(value: Any) -> Any:
    """A value of JSON in which 2.0 is 2, as it is in a page."""
    if isinstance(value, float) and value.is_integer() and abs(value) <= _SAFE:
        return int(value)
    if isinstance(value, Mapping):
        return {name: _with_whole_numbers(each) for name, each in value.items()}
    return [_with_whole_numbers(each) for each in value] if isinstance(value, list) else value


def _is_whole(value: Any, least: int, most: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and least <= value <= most


def _listed(value: Any, name: str) -> list[Any]:
    if not isinstance(value, list) or len(value) > MOST:
        raise KitError(DOES_NOT_FIT.format(name, "what it holds"))
    return value


def _names(names: Any, bodies: int, counts: Mapping[str, int]) -> KitNames:
    if not isinstance(names, Mapping):
        raise KitError(NOT_A_TABLE.format("names"))
    stranger = next((name for name in names if name not in KitNames._fields), None)
    if stranger is not None:
        raise KitError(UNKNOWN.format(f"names.{stranger[:60]}"))
    particles = _numbers_of(names.get("particles"), counts["particles"], bodies, "names.particles")
    springs = _numbers_of(names.get("springs"), counts["springs"], bodies, "names.springs")
    loose = sum(body < 0 for body, _ in springs)
    second, parts = _listed(names.get("second", []), "names.second"), _listed(names.get("parts", []), "names.parts")
    is_right = len(parts) == counts["parts"] and all(_is_whole(part, -loose, bodies - 1) for part in parts)
    for each in second:
        is_right &= isinstance(each, list) and len(each) == 3 and _is_whole(each[0], 0, bodies - 1)
        is_right &= is_right and isinstance(each[1], str) and _TEXT.fullmatch(each[1]) is not None
        is_right &= is_right and _is_whole(each[2], 0, counts["particles"] - 1)
    texts = [(body, str(number)) for body, number in particles]
    named = [each for each in texts if each[0] >= 0] + [(each[0], each[1]) for each in second if is_right]
    of_bodies = [each for each in springs if each[0] >= 0]
    if not is_right or len(set(named)) < len(named) or len(set(of_bodies)) < len(of_bodies):
        raise KitError(DOES_NOT_FIT.format("names", "what it holds"))
    return KitNames(
        tuple(texts), tuple((body, str(number)) for body, number in springs), tuple(map(tuple, second)), tuple(parts)
    )


def _numbers_of(runs: Any, count: int, bodies: int, name: str) -> list[tuple[int, int]]:
    """Body and number of each row; of one body, or of none, where nothing is said."""
    found: list[tuple[int, int]] = []
    for run in _listed([[0 if bodies == 1 else -1, 0, count]] * (count > 0) if runs is None else runs, name):
        is_right = isinstance(run, list) and len(run) == 3 and _is_whole(run[0], -1, bodies - 1)
        if not is_right or not _is_whole(run[1], 0, 2**31) or not _is_whole(run[2], 1, count - len(found)):
            raise KitError(DOES_NOT_FIT.format(name, "a run"))
        found += [(run[0], run[1] + k) for k in range(run[2])]
    if len(found) != count:
        raise KitError(DOES_NOT_FIT.format(name, "what it holds"))
    return found


def _areas(areas: Any, bodies: int, counts: Mapping[str, int]) -> list[list[int]]:
    rows = _listed(areas, "areas")
    for row in rows:
        is_right = isinstance(row, list) and len(row) == 3 and all(_is_whole(each, 0, _SAFE) for each in row)
        if not is_right or row[0] >= bodies or row[2] < 1 or row[1] + row[2] > counts["constraints"]:
            raise KitError(DOES_NOT_FIT.format("areas", "a row"))
    if len({body for body, *_ in rows}) < len(rows):
        raise KitError(DOES_NOT_FIT.format("areas", "a body that comes twice"))
    return rows


def _read_form(form: Any, bodies: int, counts: Mapping[str, int]) -> tuple[int, FirmBody]:
    fault = KitError(DOES_NOT_FIT.format("forms", "a form"))
    if not isinstance(form, Mapping) or not _is_whole(form.get("body"), 0, bodies - 1):
        raise fault
    reals = [_listed(form.get(name), "forms") for name in ("x", "y", "mass")]
    points = len(reals[0])
    most = {"pairs": points, "areas": points, "bends": points, "springs": counts["springs"]}
    wholes = {name: _listed(form.get(name), "forms") for name in (*most, "constraints")}
    is_right = all(len(each) == points for each in reals) and len(form) == 9 and points > 0
    is_right &= all(
        isinstance(x, int | float) and not isinstance(x, bool) and abs(x) < 1e9 for each in reals for x in each
    )
    is_right &= all(x > 0.0 for x in reals[2]) if is_right else False
    for name, values in wholes.items():
        is_right &= all(_is_whole(x, 0, most.get(name, counts["constraints"]) - 1) for x in values)
        is_right &= len(values) % {"pairs": 2, "areas": 3, "bends": 3}.get(name, 1) == 0
    is_right &= len(wholes["pairs"]) == 2 * len(wholes["springs"])
    is_right &= len(wholes["areas"]) + len(wholes["bends"]) == 3 * len(wholes["constraints"])
    if not is_right:
        raise fault
    pairs, areas, bends, springs, constraints = (np.array(each, np.int64) for each in wholes.values())
    x, y, mass = (np.array(each, np.float64) for each in reals)
    shape = StiffForm(np.stack([x, y], axis=1), mass, pairs.reshape(-1, 2), areas.reshape(-1, 3), bends.reshape(-1, 3))
    return form["body"], FirmBody("", shape, springs, constraints)


def _check_keys(keys: Any, parts: int) -> None:
    is_right = isinstance(keys, Mapping) and all(
        isinstance(driven, list)
        and all(isinstance(each, list) and len(each) == 2 and _is_whole(each[0], 0, parts - 1) for each in driven)
        and all(_is_whole(each[1], -1, 1) and each[1] != 0 for each in driven)
        for driven in keys.values()
    )
    if not is_right or any(len(name) > 40 for name in keys):
        raise KitError(DOES_NOT_FIT.format("keys", "what they hold"))


_NOTHING = {"format": FORMAT, "version": VERSION, "name": "kit"}


def _source(data: Mapping[str, Any], columns: Mapping[str, Any], names: KitNames, bodies: int) -> Level:
    """The bodies of a kit as meshes, as well as a level can say them; none, where it cannot."""
    try:
        return parse_level(json.dumps(_NOTHING | _meshes(data, columns, names, bodies)).encode(), "kit")
    except (LevelError, KeyError, IndexError, TypeError, ValueError):
        return parse_level(json.dumps(_NOTHING).encode(), "kit")


def _meshes(data: Mapping[str, Any], columns: Mapping[str, Any], names: KitNames, bodies: int) -> dict[str, Any]:
    springs, materials = columns.get("springs", {}), columns.get("materials", {}).get("name", [])
    ends = list(zip(springs.get("a", []), springs.get("b", []), strict=True))
    order = [body for body, _ in names.springs if body >= 0]
    if order != sorted(order) or any(body >= 0 for body, _ in names.springs[len(order) :]):
        raise ValueError("springs of bodies do not follow each other")
    own: list[list[int]] = [
        [slot for slot, (each, _) in enumerate(names.particles) if each == body] for body in range(bodies)
    ]
    where = {slot: f"b{body}.{k}" for body, slots in enumerate(own) for k, slot in enumerate(slots)}
    corners, sizes = columns.get("corners", {}).get("particle", []), _rows(columns.get("constraints", {}), "corners", 3)
    firsts = [sum(sizes[:k]) for k in range(len(sizes))]
    made, welds, stuffs = [], [], {}
    looks = data.get("look", {}).get("bodies", [])
    for body, slots in enumerate(own):
        pairs = [ends[s] for s, (each, _) in enumerate(names.springs) if each == body]
        foreign = [slot for slot in dict.fromkeys(end for pair in pairs for end in pair) if slot not in slots]
        welds += [[where[slot], f"b{body}.{len(slots) + k}"] for k, slot in enumerate(foreign)]
        index = {slot: k for k, slot in enumerate([*slots, *foreign])}
        triangles = [corners[at : at + 3] for at, size in zip(firsts, sizes, strict=True) if size == TRIANGLE]
        first = next((s for s, (each, _) in enumerate(names.springs) if each == body), None)
        of = {
            name: _row(springs, name, first, usual)
            for name, usual in (("stiffness", 0.5), ("damping", 0.9), ("material", 0))
        }
        stuff = materials[of["material"]] if first is not None else "default"
        if stuff != "default":
            stuffs[stuff] = {"stiffness": of["stiffness"], "damping": of["damping"]}
        particles = columns["particles"]
        look = looks[body] if len(looks) == bodies else {}
        made.append(
            {
                "type": "mesh", "id": f"b{body}", "material": stuff,
                "particles": [[_row(particles, axis, slot, 0.0) for axis in "xy"] for slot in index],
                "masses": [_row(particles, "mass", slot, 1.0) for slot in index],
                "particle_radius": _row(particles, "radius", slots[0], BODY_RADIUS),
                "pinned": [k for slot, k in index.items() if _row(particles, "pinned", slot, 0)],
                "springs": [[index[end] for end in pair] for pair in pairs],
                "triangles": [[index[end] for end in each] for each in triangles if set(each) <= index.keys()],
                "look": {name: look[name] for name in ("skin", "line", "colour", "face") if look.get(name)},
            }
        )  # fmt: skip
    return {"bodies": made, "welds": welds, "materials": stuffs}


def _rows(columns: Mapping[str, Any], name: str, usual: Any) -> list[Any]:
    values = columns.get(name)
    return [usual if each is None else each for each in values] if isinstance(values, list) else []


def _row(columns: Mapping[str, Any], name: str, slot: int | None, usual: Any) -> Any:
    """The value of a row in a column, which is a list, one value for all, or nothing."""
    value = columns.get(name)
    if isinstance(value, list) and slot is not None:
        value = value[slot]
    return usual if value is None or isinstance(value, list) else value


_HEAD = """# Kits

A kit is bodies as rows and nothing else: what joins a running world, as it was given. The command `add_body` takes one
in place of a `body`; links and the recordings of pages hold kits. A kernel in `sandbox/physics/kits` looks at every
number of it, finds what follows from the rows, and appends them: the desktop and pages come to the same bits, and
refuse the same kits in the same words. Made by `python -m sandbox.level.assembly.kit_files > docs/kits.md`.

```json
{"type": "add_body", "kit": {
  "bodies": 1,
  "particles": {"x": [0, 1], "y": [5, 5], "body": 0, "group": 2, "collides": "4611686018427387903"},
  "springs": {"a": [0, 1], "b": [1, "cube.0"]},
  "materials": {"name": ["default"]}}}
```

A part is a table of columns. A column is a list with an item for each row, or one value for all rows; `null` and a
column that is left out are as usual. A part has as many rows as its lists are long.

| beside the parts | is |
|---|---|
| `bodies` | how many bodies it has; they are named +1, +2, ... as all that join |
| `names` | runs of `particles` and `springs`: a body, or -1, its first number, and how many; `second` names; `parts` |
| `areas` | rows of a body, its first constraint that keeps an area, and how many: what `set_inflation` changes |
| `forms` | bodies that may be stiff as a whole: `x`, `y`, `mass`, `pairs`, `areas`, `bends`, `springs`, `constraints` |
| `keys` | by the name of a key, the driven parts that it moves, and which way: 1 or -1 |
| `look` | what is drawn: `bodies`, `joins` and `balls`, as pages have them, in the kit's own rows |

Materials go by `name`: one that the world has is that one, another is added. Bits may be text, where they have more
digits than a number of JSON can be sure of. A kit holds at most 5,000 bodies.
"""
_MEANS = {
    ("particles", "body"): "the number of its body; -1 - p: a piece that is named by its first particle p",
    ("particles", "group"): "its collision group, one bit, but that of terrain; 0: none",
    ("springs", "a"): "its first end: a row of particles; the name of a particle of the world, or -1 - its slot",
    ("springs", "b"): "its second end, another particle",
    ("springs", "rest_length"): "left out: as placed",
    ("constraints", "kind"): "0: an area; 1: a bend, of three corners",
    ("constraints", "corners"): "how many of the corners it has, in order",
    ("constraints", "area"): "the area that it wants; left out: that of its form",
    ("constraints", "material"): "-1: Cs and Cd of its own",
    ("corners", "x"): "where it is in the form at rest; left out: where its particle is placed",
    ("muscles", "force"): "at most; left out: without limit",
    ("hydraulics", "force"): "at most; left out: without limit",
    ("motors", "rim"): "how many of the rims it turns, in order",
    ("materials", "tension"): "the strain beyond which it breaks; left out: never, or as in the world",
    ("hulls", "turned"): "whether what it encloses lies on the left of the way from its second end",
    ("free_wheels", "wheel"): "a body that passes through its mounts, one row for each",
}


def reference() -> str:
    """The page, as Markdown."""
    lines = [_HEAD]
    columns: tuple[SlotColumn | NumberColumn, ...] = (*SLOT_TABLE, *NUMBER_TABLE)
    for part in PART_NAMES[1:]:
        lines += [f"## `{part}`", "", "| column | unit | range | usual | |", "|---|---|---|---|---|"]
        lines += [_line(column) for column in columns if column.part == part and column.name != "slot"]
        lines.append("")
    return "\n".join(lines)


def _line(column: SlotColumn | NumberColumn) -> str:
    means = _MEANS.get((column.part, column.name), "")
    if isinstance(column, NumberColumn):
        usual = "" if column.usual is None or not math.isfinite(column.usual) else f"{column.usual:g}"
        return f"| `{column.name}` | {column.unit} | {column.within} | {usual} | {means} |"
    within = f"a row of {column.of}" if column.of else f"{column.low} to {column.high}"
    if (column.part, column.name) in (("springs", "a"), ("springs", "b"), ("particles", "body")):
        within = "see there"
    usual = "" if column.usual is None else str(column.usual)
    return f"| `{column.name}` | | {within} | {usual} | {means} |"


if __name__ == "__main__":
    print(reference(), end="")
