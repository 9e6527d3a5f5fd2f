"""The prose of the reference of the level format: what no table can say. `reference.py` puts it between its tables."""

from sandbox.level.checks import STILL
from sandbox.level.format import limits
from sandbox.level.hints import CONTROLS, KEY
from sandbox.level.kinds.bodies import EXPANSIONS
from sandbox.level.rules.hands import MEANINGS

EXAMPLE = """\
{
  "format": "spring-sandbox/level",
  "version": 3,
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
INTRO = f"""\
A level is one JSON file. It describes bodies ({_PLURALS}), loose
particles and loose springs. The program expands bodies into particles and springs. Lengths are in metres, masses in
kilograms, times in seconds, angles in radians; y points up. The [cookbook](cookbook.md) has a small level for each
subject.
"""

A_FILE = f"""\
## A level file

```json
{EXAMPLE}```

`sandbox check FILE` lists the faults of a level and runs its checks. `sandbox format FILE` rewrites it in canonical
form. `sandbox schema` prints the JSON Schema.

An editor such as VS Code completes and checks a level whose first line is `"$schema": "../level.schema.json"`. Put the
schema beside the folder of the levels: `sandbox schema > level.schema.json`. To do it for every level of a folder, open
the folder in which both lie, and write into its `.vscode/settings.json`:

```json
{{"json.schemas": [{{"fileMatch": ["levels/*.json"], "url": "./level.schema.json"}}]}}
```

The program ships the same file as `sandbox/level/level.schema.json`. It keeps `$schema` when it saves a level and uses
it for nothing else.

The program opens files of older versions without a change of their motion, and saves them in this version. In version 1
substeps of the direct solver left the motion of each spring as it was; since version 2 they leave k and c. If a file of
version 1 has several substeps, the reader therefore changes its Cs and Cd such that each substep does what it did.
Version 3 has `zones`; all that version 2 says, it says too.
"""

TABLES = """\
## How to read the tables

- A field that is not listed is a fault, so you notice a misspelt key. `extras` is the place for data of other tools.
- *If left out* is what holds when a file leaves the field out. Only fields that say **required** must be there. Words
  in place of a value, such as *as placed*, are also what `null` means. A field without such words may not be `null`.
- A number outside its limits is a fault. The program never clamps a number.
- `–` stands for no unit, or for no limits other than the type's.
"""

_CONTROLS = "\n".join(
    f"| `{{{name}}}` | {each.does} | {' | '.join((word or '–').replace(KEY, 'its key') for word in each[-3:])} |"
    for name, each in CONTROLS.items()
)
HINTS = f"""\
## Hints

A `description` names a control by what it does: in place of each of these names people read the word for where they
are. With a capital, as in `{{Again}}`, the word begins a sentence. A sentence with a control that is not there (–) is
left out. All other braces stay as they are.

| name | what the control does | in the window | in a page, by mouse | in a page, by finger |
|---|---|---|---|---|
{_CONTROLS}
"""

WATER_EXAMPLE = """\
{
  "format": "spring-sandbox/level",
  "version": 3,
  "name": "A raft on a river",
  "view": [-6, -4, 6, 3],
  "settings": {"solver": "direct"},
  "materials": {"wood": {"stiffness": 0.9, "damping": 0.99}},
  "walls": {"box": [-9, -5, 9, 9]},
  "terrain": [{"id": "bed", "polygon": [[-9, -5], [9, -5], [9, -3], [-9, -3]]}],
  "zones": [{"id": "river", "box": [-9, -4, 9, 0], "water": {"density": 10, "flow": [0.5, 0]}}],
  "bodies": [
    {
      "type": "jelly",
      "id": "raft",
      "shape": {"box": [2, 0.5]},
      "position": [0, 1],
      "spacing": 0.25,
      "particle_mass": 0.1,
      "material": "wood"
    }
  ]
}
"""

WATER = f"""\
### How water acts

```json
{WATER_EXAMPLE}```

- A body floats if it has less mass per area than the water. The raft has 27 particles of 0.1 kg on 1 m^2, so 0.27 of it
  is under the surface.
- Jellies displace water by their triangles. Wheels, rings that keep an area and jellies without areas do by what their
  outline encloses. Loose particles do by their discs, as do the particles of ropes, bridges, girders, webs and meshes.
  What is cut from a jelly goes on displacing water. A wheel or a ring with a cut outline takes it in.
- Bodies are measured from centre to centre of their particles. They are drawn larger by the radius of those.
- The surface is flat and is the top of the box. Its sides and its floor are no walls: put a pool between terrain or
  walls, or make it wider than the view. A body that leaves it through a side falls.
- Lift needs gravity that points down. `gravity_scale` changes the weight of a body and not its lift.
- Where the water is thick, take more `slow_drag`: 5 is honey. Without any drag a body bobs for ever.
- Water in two zones that overlap lifts twice.
"""

BODIES = """\
## Bodies

A body is an entry of `bodies`. Its `type` says which kind it is. All kinds share the fields of [Every
body](#every-body). The table of a kind lists only the other fields.
"""

_GENERATION = "\n".join(each.generation for each in EXPANSIONS.values() if each.generation)
NAMES = f"""\
## Names and references

- An id has 1 to 256 characters without `.` `:` `,` and control characters, and does not begin with `+`. No two bodies,
  loose particles, pieces of terrain or zones have the same id.
- `deck.7` is particle 7 of the body `deck`, counted from 0 in generation order. `deck.start` and `deck.end` are the
  ends of a rope, of a bridge's top row, or of a girder's first row. `net.centre` is the middle of a web, `cart.hub` the
  hub of a wheel. The name of a loose particle is its id. Springs, welds and checks use these names.
- `deck:7` is spring 7 of `deck`, and `:7` is loose spring 7. Recordings use these names. Springs that are `cut` leave
  their numbers unused.
- A body's `material` names an entry of `materials`, or is `default`. `default` exists even if the level has no entry of
  that name.

## Generation order

- Particles: first those of the bodies in file order, then the loose ones. Springs: likewise.
{_GENERATION}
- A pinned particle starts at rest, even if it has a velocity.
"""

COLLISIONS = """\
## Collisions

- Things touch if the level has `contacts`, `walls` or `terrain`. A contact pushes and never pulls. Every step finds the
  contacts along the way that each particle goes in it, so fast particles do not pass through walls.
- A particle is a disc. The edge of a body is as thick as the particles at its ends. Particles of bodies turn with their
  springs, and friction acts at their rims: a box of width w and height h whose particles have radius r tips over from
  `tan(angle) = (w/2)/(h/2 + r)` on, and a `wheel` rolls by its own radius and that of its particles. A `wheel` or a
  jelly circle rolls as a whole. Left to roll, it loses `g h/4` of its speed for each radian that it turns, beside what
  its corners take; h is a substep. At 60 Hz that is 0.04 m/s, with 4 substeps 0.01 m/s.
- A wheel with `"touches_mount": false` passes through its mount: all bodies that welds and loose springs join to its
  hub, directly or through other bodies, other wheels too. It takes up one of the 60 collision groups.
- The friction between two surfaces is the geometric mean of the two values; the restitution is the larger one. Below
  0.5 m/s nothing bounces.
- A `belt` is the speed of a surface that runs, to the right of who stands on it: a polygon's all round it, a line's to
  the right above and to the left below. Friction brings to that speed what it carries, up to the slope that friction
  holds. A disc that rolls comes to a third of it, since it begins to turn: use boxes, or discs with `"rolls": false`.
- A loose disc of restitution 0.8 that falls 1 m rises to 0.64 m. A body of springs bounces less: restitution turns back
  what touches, springs pass that on from cell to cell, and each damps its part. A box of 4 cells across with
  restitution 1 that falls flat rises to all of its height if Cs and Cd are 1, to 0.76 of it if they are 0.9 and 0.99,
  to 0.28 at 0.7 and 0.95, and to 0.01 at 0.5 and 0.9, the default material. Of 8 cells across it rises to 1.00, 0.38, 0
  and 0.01. A box that lands on a corner turns instead: 0.3 rad askew, that of 4 cells rises to 0.61, 0.34, 0.12 and
  0.08.
- A loose particle that no spring and no pin holds is a disc that turns. Friction makes it roll on terrain, on edges of
  bodies and on other discs. It rolls down a slope up to tan(angle) = 3 times the friction, and slides on steeper ones.
  With `"rolls": false` it slides and never turns. Use that for discs that stand on each other, in heaps or towers.
  `rolling` is its rolling resistance; with more than 0.05, heaps do not come to rest. A disc loses its `spin` when it
  gets a spring, or when a pin or a hand holds it.
- A particle whose centre gets inside solid terrain is out after at most 20 ticks, and another 20 for each metre of
  depth, at 60 Hz. A particle inside a jelly is pushed out too. Contacts carry weights up to a thousand times that on
  Earth.
- Momentum is constant up to rounding. The energy of what touches never rises above its start with the direct solver, if
  no material has Cs above Cd, nothing is driven and nothing overlaps at the start.
- Towers buckle under their own weight, as real ones do. Eight cubes of 10 by 10 particles on each other stand with Cs
  0.99 and Cd 0.999, and fold with 0.9 and 0.99.
"""

AREAS = """\
## Areas and angles

- Areas and angles obey the equation of the springs, with an error of their own in place of a length's: Cs is the share
  of the error that a tick corrects, Cd the share of its change that a tick removes.
- A jelly keeps the signed area of its triangles. Each cell of its grid has two, with diagonals that alternate like the
  colours of a chessboard; a cell of three corners has one. They use Cs and Cd of the material, and follow the sliders.
  A jelly that is crushed, laid on a line or turned inside out comes back. One that is set in a single point or mirrored
  gets its shape back, but may be mirrored.
- A ring keeps the area inside it as a whole, times its `inflation`. That area uses Cs and Cd of at most 0.99: if
  springs and area contradict each other, the area gives way.
- A jelly is tangled while one of its triangles is turned over, or while its triangles wind round a particle more than
  once. Then it is also drawn to its form as a whole, with Cs and Cd of its material, and does not touch itself. That
  returns no more energy than it took before, and keeps momentum, but not angular momentum.
- `bending` puts an angular spring on every particle of a rope, a ring or a mesh where just two springs of the body
  meet. The rest angle is that of the body's form, even if `pose` places the particles elsewhere. The pull is largest at
  a fold of 180 degrees from there. Its Cs and Cd are its own.
- A cut spring takes with it the triangles and angles of which it is a side, and the area of its ring.

## Pins, cuts, poses and welds

- `pinned` and `cut` of a body name particles and springs by number. They add to the ends that `pin` names. The body
  stays a rope or a wheel.
- `pose` places every particle of a body and leaves its rest lengths as they are, as in a rope that is saved as it
  hangs.
- The two particles of a weld are one particle, and so are all that a chain of welds joins. It stands where the first of
  them in generation order stands, and has all their names. Its mass is the sum, up to the limit of one particle; its
  velocity is that of the common centre of mass; its radius is the largest; it is pinned if one of them is. Rest lengths
  stay as they are. A weld that would leave a spring without length is a fault.
"""

FIRMNESS = """\
## Firmness of a body

- Cs and Cd of a material belong to each spring, so a body on a grid twice as fine is four times as soft. `firmness`
  belongs to the body: its slowest wobble is the same at any grid, size and mass. The program finds the Cs and Cd that
  make it so, and gives them to all of its springs, areas and angles. The body keeps its firmness when it is scaled, and
  at any number of substeps. Cs and Cd of its material then have no effect on it; the limits of strain still hold.
- `{"sag": 0.1}`: standing on the ground, the body is 10 % lower than drawn, at any height H [m] along gravity g
  [m/s^2]. Its frequency is `sqrt(0.055 g / (sag H))` Hz, 2.3 Hz for a metre. In words: 0.25 jelly, 0.1 soft, 0.02 firm,
  0.003 hard, 0 rigid. A box comes within 1 % of its height at up to 0.1, within 3 % at 0.25. A disc, which stands on a
  point, sags twice as far. The damping ratio is 0.15, or a little more than the least possible.
- `{"hz": 2.3, "ratio": 0.15}`: frequency and damping ratio of the slowest wobble. The least ratio is about pi hz /
  tick rate; below it, Cs would exceed Cd. A smaller ratio is a fault, and the message names the nearest possible one.
- Only forms that are stiff without pins have a firmness: jellies, wheels, girders, bridges, braced meshes, and ropes
  and rings with `bending`. The wobble of a slender body is its bending. The area of a ring keeps Cs and Cd of the
  material. A body of a Hooke material has no firmness.
- With the direct solver the body wobbles at that frequency. The other two solvers have the same Cs and Cd, and follow
  them as far as they can.
- `set_coefficients` ends the firmness of a body while the level runs; `set_firmness` begins it.
"""

ACTUATORS = """\
### How actuators move

- Muscle: the rest length is `L (1 + amplitude wave)`. The wave of a tick consists of two parabolas. Let `u` be
  `tick / period + phase` without its whole part: the wave is `16 u (1/2 - u)` while `u < 1/2`, and
  `-16 (u - 1/2) (1 - u)` after that. It repeats exactly. `drive` of a body makes muscles of all its springs.
- Hydraulics and motors have a drive value of -1 to 1. It is 1 while a player holds the `key`, -1 while a player holds
  the `reverse_key`, and else 0. The command `set_drive` sets any value between. A motor without keys has the value 1
  from the start.
- Hydraulic: in a second the rest length changes by `rate` times the value, between `shortest` and `longest`. One that
  `returns` goes back to its first length at `rate` while the value is 0, as a flipper of a pinball table does.
- A muscle or hydraulic with a `force` pulls and pushes with no more than that, damping included. Under a larger load it
  gives way. Its rest length waits while something stops it, so it does not jump when it is released.
- Motor: it brings the wheel to the turning rate `speed` times the value, relative to its mount, with at most `torque`.
  At the value 0 the wheel turns freely. The mount is the hub, and all particles that springs join to it from outside
  the wheel. The mount takes the reaction, so momentum and angular momentum are constant. If the hub or a particle of
  the mount is pinned, the ground takes the reaction. A wheel whose hub is joined to nothing has no mount, and its
  motor has no effect; nor has a motor without spokes. The motor gives all of its torque until it reaches the speed. To
  roll over the corners of a wheel of `segments`, all motors of a vehicle of mass M together need the torque
  `M g radius sin(pi / segments + slope)`. With `single_pass` motors turn wheels that float, but cannot drive a load.
- Muscles and hydraulics do not yield, but they break.

## Strain, wind and weight

- Strain is `(length - rest length) / rest length`, at the end of a tick, for every spring with a rest length above 0.
- Yielding comes first. Beyond `yield_strain` the rest length follows until the strain is `yield_strain` again, or until
  the rest length has changed by the share `yield_limit`.
- Then a spring breaks if its strain is still above `tension_limit`, or below minus `compression_limit`. It is gone for
  the rest of the run; undo brings it back. Yielding and breaking take energy out and never add any.
- A stiff material hardly strains: with Cs = Cd = 1 in the direct solver hardly at all. Limits of strain need a softer
  material, such as Cs 0.9 and Cd 0.99.
- `wind` and `drag`: in a step of h seconds the velocity of a free particle becomes `(v + drag h wind) / (1 + drag h)`,
  which never overshoots. Drag is the same rate for every mass, so heavy and light particles slow down alike.
- `gravity_scale` of welded particles is their mean by mass.
"""

RULES = """\
## Rules and counters

A rule asks a question at the end of each tick. When that has held for `for_seconds`, its actions are done before the
next tick, in the order of the file; it acts again once its question has ceased to hold and holds again. What a rule
does, other rules find at the end of the next tick, so that a chain of rules takes a tick a link. Rules follow from the
state alone: an undo takes back a win, and a recording holds nothing of them. An action on what is gone, such as a
spring that broke, does nothing. [How to make a level that answers](how-to-rules.md) has whole examples.

```text
{"id": "goal", "when": {"metric": "inside", "body": "ball", "zone": "basket"}, "for_seconds": 0.5,
  "then": [{"win": "In the basket!", "stars": {"second": 20, "third": 10}}]}
{"id": "bumper", "when": {"touches": ["ball", "bumper"]}, "then": [{"count": "score", "by": 10}, {"sound": "bell"}]}
{"id": "lost", "when": {"crosses": "pit", "particle": "ball"}, "then": [{"fail": "The ball fell into the pit."}]}
{"id": "gate", "when": {"all": [{"key": "g"}, {"counter": "score", "at_least": 100}]}, "then": [{"cut": "bar"}]}
```
"""

HANDS = """\
## What hands may do

Who plays a level may do everything to it, unless `hands` says less. A level of softness allows `firmness` alone; one to
build in allows `add`, and says how many parts there are:

```text
"hands": {"may": ["firmness"]}
"hands": {"may": ["add", "grab"], "at_most": {"add": 4}}
```

The window, scripts, recordings and pages refuse all else, in one line. What hands have left is a counter of the level,
so it is part of the state. A part that is taken out again counts all the same; undo gives it back. Each word stands for
[commands](commands.md):

| word | commands |
|---|---|
""" + "".join(
    f"| `{deed}` | {', '.join(f'`{kind}`' for kind in meaning.commands)} |\n" for deed, meaning in MEANINGS.items()
)

CHECKS = """\
## Checks

A check measures one value of the level as it runs, and compares it with `at_most`, `at_least` or both. It measures
once, `after` a number of seconds. With `always` it measures at every tick of a span of time, and all of them must hold;
with `eventually` likewise, and one of them must hold. `sandbox check`, the editor's page Checks and
[pytest](testing.md) run checks. No keys are pressed, except those that the check names in `hold`. Five examples:

```text
{"name": "the rope never tears", "metric": "strain", "body": "rope", "always": [0, 10], "at_most": 0.2}
{"name": "in the cup", "metric": "inside", "particle": "ball", "box": [4, 0, 5, 2], "eventually": [0, 20]}
{"name": "the cube stands still", "metric": "settled", "body": "cube", "after": 15}
{"name": "it stays together", "metric": "distance", "particle": "a", "other": "b", "always": [0, 10], "at_most": 1.5}
{"name": "it crosses", "metric": "x", "body": "car", "eventually": [0, 9], "at_least": 12,
  "hold": [{"key": "d", "during": [0, 8]}]}
```
"""

METRICS = f"""\
### Metrics

| metric | unit | measures | value |
|---|---|---|---|
| `strain` | – | the level, or a `body` | largest strain of a spring under load, stretched or compressed |
| `max_strain`, `rms_strain` | – | the level | largest strain and root mean square of the last 2 s; only with `after` |
| `x`, `y` | m | a `particle` or a `body` | its place; for a body the centre of mass |
| `speed` | m/s | a `particle` or a `body` | its speed; for a body that of the centre of mass |
| `max_speed` | m/s | the level | speed of the fastest particle |
| `distance` | m | a `particle` | its distance from the `other` |
| `inside` | m | a `particle`, a `body`, or all | how far the outermost centre is inside the `box`; below 0 outside |
| `settled` | s | the level, or a `body` | how long nothing has been faster than {STILL:g} m/s |
| `energy` | J | the level | kinetic and potential energy together |
| `kinetic_energy`, `potential_energy` | J | the level | each of them; the zero of gravity's is at y = 0 |
| `broken_springs` | – | the level, or a `body` | number of springs that broke |
| `non_finite` | – | the level | number of particles without a finite position and velocity |
"""

LOOKS = """\
## Looks

- `look` says how things are drawn, and nothing else. Runs, hashes and recordings ignore it. The look of a body comes
  first, then that of its material, then the automatic one.
- A skin, a line, a ball or a ground that is not in the lists below counts as left out; Findings in the editor name it.
  A colour that is not in the list and not of the form `#RRGGBB` is a fault.
- Automatic looks go by a word in the material's name ("wood", "rope", "steel", "cloth" ...), then by the kind of body:
  rings that keep an area are balloons, wheels have tyres, bridges are painted and have a deck. Then they go by
  stiffness: from 0.85 on, bodies are rubber and lines are steel; loose springs below 0.3 are coils; soft jelly with
  pins is cloth. A loose particle of 20 kg or more is a ball of steel, a large pinned one is a bumper, and more than 60
  loose particles are sand. The ground of terrain goes by a word in its id; wide terrain is soil.
- Automatic colours go by the order in the file. Jellies have faces in levels of at most 16 bodies.
"""

LIMITS = f"""\
## Limits

The program refuses a file beyond one of these limits before it builds anything.

| of | limit |
|---|---|
| file | {limits.FILE_LIMIT // 1024 // 1024} MiB, UTF-8, with or without a byte order mark |
| nesting of lists and objects | {limits.DEPTH_LIMIT} |
| lists and objects in a file | {limits.CONTAINER_LIMIT:,} |
| particles and springs, after expansion | {limits.PARTICLE_LIMIT:,} and {limits.SPRING_LIMIT:,} |
| corners of all polygons of a level | {limits.CORNER_LIMIT:,} |
| coordinates, after expansion too | {limits.COORDINATE_LIMIT:,.0f} m either way |
| velocities, the sum of a mesh's and its body's too | {limits.SPEED_LIMIT:,.0f} m/s each way |
| text, in `extras` too | {limits.TEXT_LIMIT} characters |
| motors | {limits.MOTOR_LIMIT} |
| springs of limited force | {limits.LIMITED_LIMIT:,}, times particles {limits.LIMITED_WORK_LIMIT:,} |
| numbers | finite: no NaN, Infinity, 1e999; true and "1" are no numbers, 1.0 is no whole number |
| keys | no key twice in one object |
"""

FAULTS = f"""\
## When something is wrong

The program lists all faults at once, at most {limits.FAULT_LIMIT}. Each line names the file, the place and the remedy.
These are mistakes in the example above, and the lines that the program prints:
"""
