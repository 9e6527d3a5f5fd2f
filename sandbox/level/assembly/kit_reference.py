"""The page of kits: every column with its range, from the tables by which the kernel looks at them.

python -m sandbox.level.assembly.kit_reference > docs/kits.md writes it.
"""

import math

from sandbox.physics.kits.kit import NUMBER_TABLE, PART_NAMES, SLOT_TABLE, NumberColumn, SlotColumn

_HEAD = """# Kits

A kit is bodies as rows and nothing else: what joins a running world, as it was given. The command `add_body` takes one
in place of a `body`; links and the recordings of pages hold kits. A kernel in `sandbox/physics/changing` looks at every
number of it, finds what follows from the rows, and appends them: the desktop and pages come to the same bits, and
refuse the same kits in the same words. Made by `python -m sandbox.level.assembly.kit_reference > docs/kits.md`.

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
