"""format_reference(): the reference of the level format for level makers, generated from the schema.

`python -m sandbox.level.reference > docs/level-format.md` writes it anew.
"""

import json
from collections.abc import Iterator
from typing import Any

from sandbox.level.checks import STILL
from sandbox.level.document.schema import TITLES, schema
from sandbox.level.format import limits
from sandbox.level.format.level_error import LevelError
from sandbox.level.kinds.bodies import EXPANSIONS
from sandbox.level.reading.parse import parse_level

EXAMPLE = """\
{
  "format": "spring-sandbox/level",
  "version": 2,
  "name": "A ball under a bridge",
  "settings": {"solver": "iterative", "iterations": 20, "substeps": 4},
  "materials": {"steel": {"stiffness": 1.0, "damping": 1.0}},
  "bodies": [
    {
      "type": "bridge",
      "id": "deck",
      "start": [-5, 2],
      "end": [5, 2],
      "segments": 20,
      "height": 0.5,
      "pin": ["start", "end"],
      "material": "steel"
    }
  ],
  "particles": [{"id": "ball", "position": [0, 0], "mass": 20, "radius": 0.3}],
  "springs": [{"a": "ball", "b": "deck.31", "material": "steel"}],
  "checks": [
    {"name": "the ball hangs", "metric": "y", "particle": "ball", "after": 5, "at_least": -1}
  ]
}
"""

_PLURALS = ", ".join(each.plural for each in EXPANSIONS.values())
_INTRO = f"""\
# Level format, version {limits.VERSION}

A level is one JSON file. It describes bodies ({_PLURALS}), loose
particles and loose springs; the program expands them into particles and springs. Lengths are in metres, masses in
kilograms, times in seconds, angles in radians; y points up. Everything has a default but `format`, `version`, `name`
and what a body cannot do without. Keys that are not listed here are refused, so a misspelt key is noticed; `extras`
is the place for other tools' data.

```json
{EXAMPLE}```

`sandbox check FILE` says what is wrong with a level and runs its checks, `sandbox format FILE` rewrites it in
canonical form, `sandbox schema` prints the JSON Schema for an editor that completes keys.

An editor such as VS Code completes and checks a level whose first line is `"$schema": "./level.schema.json"`, with the
schema beside it: `sandbox schema > level.schema.json`. Or, for every level of a folder, in `.vscode/settings.json`:

```
{{"json.schemas": [{{"fileMatch": ["levels/*.json"], "url": "./level.schema.json"}}]}}
```

The program ships the same file as `sandbox/level/level.schema.json`. `$schema` is kept on
saving and means nothing else.

Files of older versions open as what they were, and are of this version once they are saved. In version 1 substeps of
the direct solver left the motion of each spring as it was; from version 2 on they leave k and c. So Cs and Cd of a file
of version 1 that has several are changed when it is read, such that each of its substeps does what it did.
"""

_GENERATION = "\n".join(each.generation for each in EXPANSIONS.values() if each.generation)
_NAMES = f"""\
## Names and references

- An id is 1 to 256 characters without `.` `:` `,` and control characters, and does not begin with `+`. Bodies and
  loose particles share one set of ids.
- `deck.7` is particle 7 of the body `deck`, counted from 0 in generation order; `deck.start` and `deck.end` are the
  ends of a rope, of a bridge's top row, or of a girder's first row; `net.centre` is the middle of a web, `cart.hub`
  that of a wheel; a loose particle goes by its id alone. Springs, welds and checks refer so.
- `deck:7` is spring 7 of `deck`, `:7` the loose spring 7: replays use these. Springs that are `cut` leave their
  numbers unused.
- A body's `material` names an entry of `materials`, or is `default`, which exists even where the level has none of
  that name.

## Generation order

- Particles: those of the bodies in file order, then the loose ones. Springs: likewise.
{_GENERATION}
- A pinned particle starts at rest, whatever its velocity.

## Collisions

- Things touch where the level has `contacts`, `walls` or `terrain`. A contact pushes and never pulls. Contacts are
  found anew in every step, along the way that each particle goes in it, so that what is fast does not pass.
- A particle is a disc; the edge of a body is as thick as the particles at its ends. Discs do not turn: they slide, and
  do not roll; a `wheel` or a jelly circle rolls.
- A wheel with `"touches_mount": false` passes through what it is mounted on: all that welds and loose springs join to
  its hub, directly or by way of others, other wheels too. It takes up one of the 60 collision groups.
- Friction between two surfaces is the geometric mean of theirs, restitution the larger one; below 0.5 m/s nothing
  bounces.
- Restitution is what a contact gives back: a loose disc that falls 1 m at 0.8 rises to 0.64 m. A body of springs
  bounces as its damping lets it, whatever that says: a box that falls flat at restitution 1 rises to 0.76 of its height
  where Cs is 0.9 and Cd 0.99, to 0.02 at the default.
- A loose particle, which no spring and no pin holds, is a disc that turns: friction makes it roll, on terrain, on edges
  of bodies and on others. It rolls down a slope up to tan(angle) = 3 times the friction, and slides beyond. With
  `"rolls": false` it slides and never turns: what discs are to stand on each other, in heaps or towers, wants that.
  `rolling` is its rolling resistance; with more than 0.05 heaps do not come to rest. A disc that gets a spring, or is
  pinned or held, loses its `spin`.
- A particle whose centre gets inside solid terrain is out after at most 20 ticks and another 20 for each metre of
  depth, at 60 Hz; one inside a jelly is pushed out too. Weight up to a thousand times that on Earth is held.
- Momentum is kept to rounding. Where no material has Cs above Cd, nothing is driven and nothing overlaps at the start,
  the direct solver keeps the energy of what touches at or below its start.
- Towers buckle under their own weight, as real ones do: eight cubes of 10 by 10 particles on each other stand with
  Cs 0.99 and Cd 0.999, and fold with 0.9 and 0.99.

## Areas and angles

- Areas and angles obey the equation of the springs, with their own error in place of a length's: Cs is the part of it
  that is corrected in a tick, Cd the part of its change that is removed.
- A jelly keeps the signed area of its triangles: two of each cell of its grid, the diagonals between them laid like
  the colours of a chessboard, one where three corners exist. They take Cs and Cd of its material, on sliders too. A
  jelly that is crushed, laid on a line or turned inside out comes back; of one set in a single point or mirrored, only
  the shape is sure to come back, not which way it looks.
- A ring keeps the area inside it as a whole, times its `inflation`. Of Cs and Cd above 0.99 that area takes 0.99: where
  springs and area ask for what cannot both be, the area gives way.
- While a triangle of a jelly is turned over, or its triangles wind round a particle more than once, the jelly is
  tangled: it is also drawn to its form as a whole, with Cs and Cd of its material, and does not touch itself. That
  adds no energy that it has not lost before, and keeps its momentum, but not its spin.
- `bending` puts an angular spring on every particle where just two springs of the body meet, of a rope, a ring, or a
  mesh. At rest the angle is that of the body's form, also where `pose` places it otherwise. It pulls hardest at a fold
  of 180 degrees from there. Its Cs and Cd are its own.
- A triangle, a ring or an angle of which a spring along a side is cut is gone.

## Pins, cuts, poses and welds

- `pinned` and `cut` of a body name particles and springs by number, beside what its `pin` holds. A body stays a rope
  or a wheel with them.
- `pose` places every particle of a body anew and leaves its rest lengths as they are: a rope saved as it hangs.
- The two particles of a weld are one, and so are all that welds join to each other. It stands where the first of them
  in generation order stands, under all their names. Masses add, up to the limit of one particle; the velocity is that
  of the common centre of mass; the radius is the largest; it is held where one of them is. Rest lengths stay as they
  are. A spring that would lose its length so is refused.
"""

_FIRMNESS = """\
## Firmness of a body

- Cs and Cd of a material are those of each spring, so a body on a grid twice as fine is four times as soft. `firmness`
  is of the body: it has the slowest wobble of its form, whatever the grid, the size and the masses, and its springs,
  areas and bends get the Cs and Cd, all the same, that make it so. It keeps it when it is scaled, and at any number of
  substeps. Cs and Cd of its material then do nothing for it; its limits of strain hold.
- `{"sag": 0.1}`: standing on the ground it is 10 % lower than drawn, whatever its height H [m] along gravity g
  [m/s^2]: that is a frequency of `sqrt(0.055 g / (sag H))` Hz, 2.3 Hz for a metre. In words: 0.25 jelly, 0.1 soft,
  0.02 firm, 0.003 hard, 0 rigid. A box comes within 1 % of its height at up to 0.1, within 3 % at 0.25; a disc, which
  stands on a point, sags twice as far. The damping ratio is 0.15, or a little more than the least that is possible.
- `{"hz": 2.3, "ratio": 0.15}`: frequency and damping ratio of the slowest wobble. The ratio is at least about pi hz /
  tick rate, where Cs would exceed Cd; beyond that it is refused, and the nearest is named.
- Only forms that are stiff without pins have one: jellies, wheels, girders, bridges, braced meshes, ropes and rings
  with `bending`. The wobble of a slender one is its bending. A ring's area as a whole keeps Cs and Cd of its material.
  Those of a Hooke material have none.
- The direct solver moves as it says. The other two have the same Cs and Cd, which they follow as far as they can.
- Whatever sets Cs or Cd of its springs while the level runs (`set_coefficients`) ends it, `set_firmness` begins it
  again.
"""

_ACTUATORS = """\
## What breaks, yields and is driven

- Strain is `(length - rest length) / rest length`, of every spring with a rest length above 0, taken once, at the end
  of a tick. First a spring yields: beyond `yield_strain` its rest length follows, so that the strain is `yield_strain`
  again, until it has changed by the share `yield_limit`. Then it breaks, if the strain is still beyond
  `tension_limit` or below minus `compression_limit`. A broken spring is gone for the rest of the run; undo brings it
  back. Both take energy out and never put any in. A stiff material strains little: Cs = Cd = 1 in the direct solver
  hardly at all, so limits need a softer one, such as Cs 0.9 and Cd 0.99.
- A muscle's rest length is `L (1 + amplitude wave)`, where the wave of a tick is made of two parabolas: with
  `u = tick / period + phase`, without its whole part, it is `16 u (1/2 - u)` while `u < 1/2` and
  `-16 (u - 1/2) (1 - u)` after. It repeats exactly. A body's `drive` makes muscles of all its springs. What is driven
  does not yield, but breaks.
- A hydraulic and a motor are driven by a value of -1..1: 1 while the `key` is held down, -1 while the `reverse_key`
  is, 0 otherwise; the command `set_drive` gives any value between. A hydraulic's rest length changes by `rate` times
  the value a second, within `shortest` and `longest`. One that `returns` goes back to its first length at `rate` while
  the value is 0, as a flipper of a pinball table does. A motor without keys has the value 1 from the start.
- A muscle or hydraulic with a `force` pulls and pushes with no more than that, damping included, and gives way beyond.
  Where it is held back its rest length waits for it, so that it does not leap when it is let go.
- A motor brings the wheel's turning rate, against that of its mount, to `speed` times the value, with at most `torque`;
  at the value 0 the wheel turns freely. The mount is the hub with everything that springs join to it from outside the
  wheel; it gets the reaction, so that momentum and angular momentum are kept. Where the hub or part of its mount is
  pinned, the reaction goes to the ground. A wheel whose hub nothing holds has no mount, and its motor does nothing; nor
  does one of which no spoke is left. Torque means what it says: all of it is given until the speed is reached. To roll
  over the corners of a wheel of `segments` takes `M g radius sin(pi / segments + slope)` of all motors of a vehicle of
  mass M together. Under `single_pass` motors turn wheels that float, and carry none under a load.
- `wind` and `drag`: in a step of h seconds a free particle's velocity becomes `(v + drag h wind) / (1 + drag h)`, which
  never overshoots. Drag is a rate for every mass, so heavy and light particles slow down alike.
- `gravity_scale` of welded particles is their mean by mass.
"""

_CHECKS = f"""\
## Checks

A check measures one thing of the level as it runs by itself, and holds it against `at_most`, `at_least` or both. It is
measured once, `after` so many seconds; with `always` at every tick of a span of time, all of which must hold; with
`eventually` likewise, of which one must hold. `sandbox check` and the editor's Checks page run them, and so does
[pytest](testing.md). Nobody presses a key meanwhile, but those that `hold` names. Five examples:

```
{{"name": "the rope never tears", "metric": "strain", "body": "rope", "always": [0, 10], "at_most": 0.2}}
{{"name": "in the cup", "metric": "inside", "particle": "ball", "box": [4, 0, 5, 2], "eventually": [0, 20]}}
{{"name": "the cube stands still", "metric": "settled", "body": "cube", "after": 15}}
{{"name": "it stays together", "metric": "distance", "particle": "a", "other": "b", "always": [0, 10], "at_most": 1.5}}
{{"name": "it crosses", "metric": "x", "body": "car", "eventually": [0, 9], "at_least": 12,
  "hold": [{{"key": "d", "during": [0, 8]}}]}}
```

| metric | unit | measured of | is |
|---|---|---|---|
| `strain` | 1 | the level, or a `body` | largest strain of a spring, stretched or compressed, that bears a load |
| `max_strain`, `rms_strain` | 1 | the level | largest strain and root mean square of the last 2 s; with `after` only |
| `x`, `y` | m | a `particle` or a `body` | where it is; of a body its centre of mass |
| `speed` | m/s | a `particle` or a `body` | how fast it is; of a body its centre of mass |
| `max_speed` | m/s | the level | the speed of the fastest |
| `distance` | m | a `particle` | how far it is from the `other` |
| `inside` | m | a `particle`, a `body`, all | how far the outermost centre is inside the `box`, below 0 outside |
| `settled` | s | the level, or a `body` | for how long nothing has been faster than {STILL:g} m/s |
| `energy` | J | the level | kinetic and potential energy together |
| `kinetic_energy`, `potential_energy` | J | the level | each of them; gravity's zero is at y = 0 |
| `broken_springs` | 1 | the level, or a `body` | springs that broke |
| `non_finite` | 1 | the level | particles without a finite position and velocity |
"""

_LOOKS = """\
## Looks

- `look` says how things are drawn, and nothing else: neither a run nor its hashes nor recordings' checks know it. What
  a body says counts more than what its material says, and that more than what is found automatically.
- A name of a skin, a line, a ball or a ground that is not listed counts as left out; the editor's findings name it.
  A colour that is none is refused, and so is a key that is not known.
- Automatic: a word in the material's name ("wood", "rope", "steel", "cloth" ...); then the kind of body: rings that
  hold an area are balloons, wheels have tyres, bridges are painted and have a deck; then stiffness: from 0.85 on rubber
  (bodies) or steel (lines), loose springs below 0.3 are coils, and soft jelly that is pinned is cloth. A loose particle
  of 20 kg or more is a ball of steel, one that is pinned and large a bumper, and more than 60 of them are sand. Terrain
  goes by a word in its id; what is wide is soil.
- Colours are given out by order in the file. Jellies have faces in levels of at most 16 bodies.
"""

# Each is one mistake in the example above; the reference shows what the program says to it.
_MISTAKES = [
    ('"stiffness": 1.0', '"stiffness": 1.3'),
    ('"stiffness": 1.0', '"stifness": 1.0'),
    ('"segments": 20', '"segments": true'),
    ('"segments": 20', '"segments": 1000000000000'),
    ('"b": "deck.31"', '"b": "dek.31"'),
    ('"b": "deck.31"', '"b": "deck"'),
    ('"height": 0.5', '"height": 0.5, "cut": [101]'),
    ('"mass": 20', '"mass": -20'),
    ('"mass": 20', '"mass": 20, "mass": 30'),
    ('"mass": 20,', '"mass": 20'),
]


def format_reference() -> str:
    """The reference as Markdown."""
    return "\n".join([_INTRO, *_tables(), _NAMES, _FIRMNESS, _ACTUATORS, _CHECKS, _LOOKS, _limits(), _errors()])


def _tables() -> Iterator[str]:
    whole = schema()
    for title, model in [("Level", whole), *((title, whole["$defs"][name]) for name, title in TITLES.items())]:
        required = model.get("required", [])
        rows = [
            f"| `{name}` | {_type(field, whole)} | {_unit(field)} | {_range(field)} | "
            f"{'required' if name in required else _default(field)} | {field.get('description', '')} |"
            for name, field in model["properties"].items()
        ]
        head = "| field | type | unit | range | default | meaning |\n|---|---|---|---|---|---|"
        yield "\n".join([f"## {title}\n", f"{model['description']}\n", head, *rows, ""])


def _type(field: dict[str, Any], whole: dict[str, Any]) -> str:
    choices = field.get("anyOf") or field.get("oneOf")
    if choices:
        return " or ".join(_type(choice, whole) for choice in choices)
    if "$ref" in field:
        return str(whole["$defs"][field["$ref"].rsplit("/", 1)[1]]["title"]).lower()
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    if "enum" in field:
        return " or ".join(f"`{json.dumps(value)}`" for value in field["enum"])
    if "prefixItems" in field:
        return "[" + ", ".join(_type(item, whole) for item in field["prefixItems"]) + "]"
    if field["type"] == "array":
        return f"list of {_type(field['items'], whole)}"
    if "patternProperties" in field:
        return "object of " + " or ".join(_type(item, whole) for item in field["patternProperties"].values())
    return {"integer": "whole number", "string": "text", "boolean": "true or false"}.get(field["type"], field["type"])


def _unit(field: dict[str, Any]) -> str:
    if "unit" in field:
        return str(field["unit"])
    inner = [*field.get("anyOf", []), *([field["items"]] if isinstance(field.get("items"), dict) else [])]
    return next((unit for unit in map(_unit, inner) if unit), "")


def _range(field: dict[str, Any]) -> str:
    if "minimum" in field and "maximum" in field:
        return f"{field['minimum']:g}..{field['maximum']:g}"
    if "exclusiveMinimum" in field:
        return f"above 0, up to {field['maximum']:g}"
    if "minimum" in field:
        return f"{field['minimum']:g} or more"
    if field.get("type") == "string" and "maxLength" in field:
        return f"{field.get('minLength', 0)}..{field['maxLength']} characters"
    inner = [*field.get("anyOf", []), *field.get("prefixItems", [])[:1]]
    if isinstance(field.get("items"), dict):
        inner.append(field["items"])
    each = next((text for text in map(_range, inner) if text), "")
    counts = {"minItems": "at least", "maxItems": "at most", "maxProperties": "at most"}
    sizes = [f"{word} {field[key]:,}" for key, word in counts.items() if key in field and "prefixItems" not in field]
    return "; ".join(part for part in (" ".join(sizes), each) if part)


def _default(field: dict[str, Any]) -> str:
    value = field["default"]
    return "as below" if isinstance(value, dict) and value else f"`{json.dumps(value)}`"


def _limits() -> str:
    return f"""\
## Limits

A file beyond one of these is refused before anything is built; nothing is ever clamped.

| what | limit |
|---|---|
| file | {limits.FILE_LIMIT // 1024 // 1024} MiB, UTF-8, with or without a byte order mark |
| nesting of lists and objects | {limits.DEPTH_LIMIT} |
| lists and objects in a file | {limits.CONTAINER_LIMIT:,} |
| particles and springs, after expansion | {limits.PARTICLE_LIMIT:,} and {limits.SPRING_LIMIT:,} |
| corners of all polygons of a level | {limits.CORNER_LIMIT:,} |
| coordinates, of what bodies expand to as well | {limits.COORDINATE_LIMIT:g} m either way |
| velocities, a mesh's own added to the body's | {limits.SPEED_LIMIT:g} m/s each way |
| text, in `extras` as well | {limits.TEXT_LIMIT} characters |
| motors | {limits.MOTOR_LIMIT} |
| springs of limited force | {limits.LIMITED_LIMIT} |
| numbers | finite: no NaN, Infinity, 1e999; true and "1" are no numbers, 1.0 is no whole number |
| keys | no key twice in one object |
"""


def _errors() -> str:
    lines = []
    for right, wrong in _MISTAKES:
        try:
            parse_level(EXAMPLE.replace(right, wrong, 1).encode(), "levels/x.json")
        except LevelError as error:
            lines += [f"- `{wrong}`", "", "  ```", *(f"  {fault}" for fault in error.faults), "  ```"]
    return f"""\
## When something is wrong

All faults are listed at once, at most {limits.FAULT_LIMIT}, each on a line with the file, the place and what to do.
Mistakes in the example above, and what the program says to them:

{chr(10).join(lines)}
"""


if __name__ == "__main__":
    print(format_reference(), end="")
