"""The table of a world's state arrays: one line each gives its name in files, type, unit and meaning.

World and Snapshot have these attributes, appending, hashing, storing and guarding go through them: a new array is one
line here, and the place that gives it its values.
"""

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import ArrayKind, Floats
from sandbox.physics.marks import EDGES, GRAB_MATERIAL, LAWS, LONGEST_RAMP, MOST_PARTICLES
from sandbox.physics.terrain import Terrain

Scalar = TypeVar("Scalar", bound=np.generic)


# Rolling resistance, unless somebody says otherwise: a torque of at most this share of the push times the radius. Less
# lets a disc in a heap turn for ever; ten times as much is seen on a slope of 10 degrees.
ROLLING_RESISTANCE = 1e-3


# Larger than anything that a level or a command can ask for (1e6 m, 1e9 m/s, 1e9 kg, 1e15 N/m), and small enough that
# energies stay finite; a mistuned spring that passes it is frozen there.
ABSURD = 1e18


@dataclass(frozen=True)
class Range:
    """Good values: from low, or only above it, to high. NaN is never one."""

    low: float
    high: float
    is_above: bool = False

    @property
    def lowest(self) -> float:
        """The lowest good value."""
        return float(np.nextafter(self.low, self.high)) if self.is_above else self.low

    def __str__(self) -> str:
        return f"above {self.low:g} to {self.high:g}" if self.is_above else f"{self.low:g} to {self.high:g}"


FINITE, POSITIVE, NOT_NEGATIVE = Range(-ABSURD, ABSURD), Range(0.0, ABSURD, is_above=True), Range(0.0, ABSURD)
SHARE = Range(0.0, 1.0)


class Family(Enum):
    """A family of arrays: one row for each thing of this kind."""

    PARTICLE = "particle"
    SPRING = "spring"
    CONSTRAINT = "constraint"
    CORNER = "corner of a constraint"
    ACTUATOR = "actuator"
    CONTACT = "contact"
    HAND = "hand"
    SETTING = "number of the settings: gravity x and y, wind x and y, drag, warm start"
    RULE = "rule"
    COUNTER = "counter"
    PROBE = "particle whose way a rule follows"
    STILL = "question of a rule whether something has settled"
    KEY = "key that a rule asks for"
    DEED = "kind of command, where a level says what hands may do"


@dataclass(eq=False)
class Column:
    """A line of the table. stored: the name in files, hashes and messages; name: the attribute in code.

    width: numbers a row, 1 = a flat array (n,), 2 = (n, 2). within: its good values, None = nobody looks. guarded: the
    last good values are kept, and taken back where the present ones are not (sanitise.py). topology: solvers and
    collision derive from it what they keep from step to step (World.derived), so that it is only written by methods of
    World. sparse: no part of the state where all of it is `usual`, so that worlds without what it is for have the
    hashes that they had before there was such a thing. of: what a whole number may be: a slot of a family, of MATERIALS
    or of FEATURES, see OR_NONE, or a mark of a range.
    """

    stored: str
    family: Family
    dtype: type[np.generic]
    unit: str
    meaning: str
    width: int
    within: Range | None
    guarded: bool
    topology: bool
    sparse: bool
    usual: float
    of: "Family | range | str | None"
    name: str = field(default="", init=False)

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @property
    def kind(self) -> Any:
        """The kind of the column's array, for kernels."""
        return Annotated[NDArray[Any], ArrayKind(self.dtype, 2 if self.width > 1 else 1)]

    def empty(self) -> NDArray[Any]:
        """An array of no rows."""
        return self.usual_rows(0)

    def usual_rows(self, count: int) -> NDArray[Any]:
        """Rows of the usual value."""
        return np.full((count, self.width) if self.width > 1 else count, self.usual, dtype=self.dtype)


def _array(
    stored: str, family: Family, dtype: type[Scalar], unit: str, meaning: str, *, width: int = 1,
    within: Range | None = None, guarded: bool = False, topology: bool = False, sparse: bool = False, usual: float = 0,
    of: Family | range | str | None = None,
) -> NDArray[Scalar]:  # fmt: skip
    """A line of the table, which a type checker takes for the array that an instance holds under that name."""
    return cast(Any, Column(stored, family, dtype, unit, meaning, width, within, guarded, topology, sparse, usual, of))


# What whole numbers are slots of that are no family: materials, which are no arrays; and what a contact touched, see
# FEATURE_KINDS.
MATERIALS, FEATURES = "material", "feature"
P, S, E, C, A, T, H, G, R, N, B, L, K, D = Family
# Of these -1 stands for none.
OR_NONE = (MATERIALS, Family.COUNTER)
F64, I64, I32, I8, BOOL = np.float64, np.int64, np.int32, np.int8, np.bool_


class StateArrays:
    """Particles, springs, constraints, actuators, contacts, hands and ramps of settings as a struct of arrays.

    The order of the lines is that in which arrays are hashed and stored. It and the names in quotes are part of the
    replay contract: they do not follow a rename in code, and new lines go to the end of their family.
    """

    # fmt: off
    # ruff: noqa: E501
    position = _array("position", P, F64, "m", "its place", width=2, within=FINITE, guarded=True)
    velocity = _array("velocity", P, F64, "m/s", "its velocity; 0 if pinned, except the target of a hand", width=2, within=FINITE, guarded=True)
    origin = _array("origin", P, F64, "m", "its place at creation, which orders the elimination of the direct solver", width=2, topology=True)
    mass = _array("mass", P, F64, "kg", "its mass, pinned or not", within=POSITIVE, guarded=True)
    inverse_mass = _array("inverse_mass", P, F64, "1/kg", "inverse of the mass; 0 = pinned", within=NOT_NEGATIVE, topology=True)
    radius = _array("radius", P, F64, "m", "radius of its disc", within=NOT_NEGATIVE, guarded=True)
    gravity_scale = _array("gravity_scale", P, F64, "1", "factor of the world's gravity", within=FINITE, guarded=True)
    particle_active = _array("particle_active", P, BOOL, "", "whether its slot is in use", topology=True)
    slow_velocity = _array("slow_velocity", P, F64, "m/s", "the slow component of the velocity, for the direct solver", width=2)
    energy_bank = _array("energy_bank", P, F64, "J", "energy bank of a body, at its free particle of lowest slot; -1: a new bank begins, -2: a new bank begins empty")
    friction = _array("friction", P, F64, "1", "friction of its surface; at a contact the geometric mean of both counts", within=NOT_NEGATIVE, guarded=True)
    restitution = _array("restitution", P, F64, "1", "restitution of its surface; at a contact the larger one counts", within=SHARE, guarded=True)
    owner = _array("owner", P, I32, "", "its body; negative: of a body that is named by its first particle p, -1 - p: a loose particle, or a piece that was cut off", topology=True)
    group = _array("group", P, I64, "", "its collision group, one bit", topology=True)
    collides = _array("collides", P, I64, "", "bits of the groups that it touches, TERRAIN_GROUP for terrain, 0 = nothing", topology=True)
    parting_reserve = _array("parting_reserve", P, F64, "J", "energy that a body has lost and may spend on parting from others, at its free particle of lowest slot; negative: what it was lent", sparse=True)
    angle = _array("angle", P, F64, "rad", "angle of its disc, -pi..pi; it is only shown", within=FINITE, guarded=True, sparse=True)
    spin = _array("spin", P, F64, "rad/s", "turning rate of its disc; 0 while springs, constraints or a pin hold it", within=FINITE, guarded=True, sparse=True)
    rolls = _array("rolls", P, BOOL, "", "whether its disc turns while nothing holds it", sparse=True, usual=True)
    rolling = _array("rolling", P, F64, "1", "rolling resistance; at a contact of discs the larger one counts", within=SHARE, guarded=True, sparse=True, usual=ROLLING_RESISTANCE)
    slow_change = _array("slow_change", P, F64, "m/s", "the slow component of the change of slow_velocity in a step, for the direct solver", width=2, sparse=True)
    unmoved = _array("unmoved", P, BOOL, "", "whether it has not taken a step yet: its velocity is that of the tick, not of half a step before", sparse=True)
    untouchable = _array("untouchable", P, BOOL, "", "whether the level lets no hand touch it", sparse=True)
    unreturnable = _array("unreturnable", P, F64, "J", "energy that springs of its body count and cannot give back, at its free particle of lowest slot", sparse=True)
    split_from = _array("split_from", P, I32, "slot", "the particle that it is of the same body as, where a cut made it; -1: none did", sparse=True, usual=-1, of=range(-1, MOST_PARTICLES))

    particle_a = _array("particle_a", S, I32, "slot", "its first end", topology=True, of=P)
    particle_b = _array("particle_b", S, I32, "slot", "its second end", topology=True, of=P)
    rest_length = _array("rest_length", S, F64, "m", "length at which it neither pulls nor pushes", within=NOT_NEGATIVE, guarded=True)
    natural_length = _array("natural_length", S, F64, "m", "its first rest length, before yielding and driving")
    stiffness = _array("stiffness", S, F64, "1", "Cs of a tick", within=SHARE, guarded=True)
    damping = _array("damping", S, F64, "1", "Cd of a tick", within=SHARE, guarded=True)
    law = _array("law", S, I8, "", "LAW_NISSEN, LAW_HOOKE or LAW_HAND", topology=True, of=LAWS)
    hooke_stiffness = _array("hooke_stiffness", S, F64, "N/m", "k of a Hooke spring", within=NOT_NEGATIVE, guarded=True)
    hooke_damping = _array("hooke_damping", S, F64, "N s/m", "c of a Hooke spring", within=NOT_NEGATIVE, guarded=True)
    material = _array("material", S, I32, "", "index into material_names, -1 = of a hand", topology=True, of=MATERIALS)
    spring_active = _array("spring_active", S, BOOL, "", "whether it acts; false: cut, broken, or of a hand that holds nothing", topology=True)
    impulse = _array("impulse", S, F64, "N s", "impulse for the warm start of the iterative solver", width=2)
    tension = _array("tension", S, F64, "N s", "its pulling impulse of the last step, with \"auto\" substeps of the whole tick, for the direct solver")
    edge = _array("edge", S, I8, "", "kind of edge for collisions: none, a line of two sides, or the outline of a solid body on its left or right", topology=True, of=EDGES)
    lowest_mode = _array("lowest_mode", S, F64, "1", "lowest mode of the body whose firmness sets its Cs and Cd; 0: they are its own", within=NOT_NEGATIVE, guarded=True, sparse=True)
    stiffness_now = _array("stiffness_now", S, F64, "1", "Cs of the last tick, while it comes to what is set", sparse=True)
    damping_now = _array("damping_now", S, F64, "1", "Cd of the last tick, while it comes to what is set", sparse=True)
    lowest_mode_now = _array("lowest_mode_now", S, F64, "1", "lowest_mode of the last tick, while Cs and Cd come to what is set", sparse=True)
    ramp_ticks = _array("ramp_ticks", S, I32, "tick", "ticks until Cs and Cd are what is set; 0: they are", sparse=True, of=range(LONGEST_RAMP + 1))
    belt = _array("belt", S, F64, "m/s", "how fast its surface runs as an edge, to the right of who stands on it", topology=True, sparse=True)
    spring_untouchable = _array("spring_untouchable", S, BOOL, "", "whether the level lets no hand touch it", sparse=True)
    is_split = _array("split", S, BOOL, "", "whether a cut made it, along a side of a triangle that it divided", sparse=True)

    constraint_kind = _array("element_kind", E, I8, "", "AREA or BEND (constraints.py)", topology=True, of=range(2))
    constraint_first = _array("element_first", E, I32, "corner", "index of its first corner", topology=True, of=C)
    constraint_corners = _array("element_corners", E, I32, "", "number of its corners", topology=True)
    constraint_rest = _array("element_rest", E, F64, "m^2 or 1", "wanted area and area of the form; or cosine and sine of the angle at rest", width=2, within=FINITE, guarded=True)
    constraint_stiffness = _array("element_stiffness", E, F64, "1", "Cs of a tick", within=SHARE, guarded=True)
    constraint_damping = _array("element_damping", E, F64, "1", "Cd of a tick", within=SHARE, guarded=True)
    constraint_material = _array("element_material", E, I32, "", "index into material_names, -1 = Cs and Cd of its own", of=MATERIALS)
    constraint_active = _array("element_active", E, BOOL, "", "whether it acts; false once a spring along its sides is cut or broken", topology=True)
    constraint_lowest_mode = _array("element_lowest_mode", E, F64, "1", "as lowest_mode of a spring", within=NOT_NEGATIVE, guarded=True, sparse=True)
    constraint_stiffness_now = _array("element_stiffness_now", E, F64, "1", "as stiffness_now of a spring", sparse=True)
    constraint_damping_now = _array("element_damping_now", E, F64, "1", "as damping_now of a spring", sparse=True)
    constraint_lowest_mode_now = _array("element_lowest_mode_now", E, F64, "1", "as lowest_mode_now of a spring", sparse=True)
    constraint_ramp_ticks = _array("element_ramp_ticks", E, I32, "tick", "as ramp_ticks of a spring", sparse=True, of=range(LONGEST_RAMP + 1))
    constraint_area_now = _array("element_area_now", E, F64, "m^2", "wanted area of the last tick, while it comes to what is set", sparse=True)
    constraint_area_ticks = _array("element_area_ticks", E, I32, "tick", "ticks until the wanted area is what is set; 0: it is", sparse=True, of=range(LONGEST_RAMP + 1))

    corner_particle = _array("corner_particle", C, I32, "slot", "particle of the corner", topology=True, of=P)
    corner_weight = _array("corner_weight", C, F64, "m^2 or 1/m^2", "square of its gradient, at rest", within=NOT_NEGATIVE, guarded=True)
    corner_form = _array("corner_form", C, F64, "m", "its place in the form at rest", width=2, within=FINITE, guarded=True, topology=True)

    actuator_value = _array("part_value", A, F64, "1", "its drive value, -1..1")
    actuator_impulse = _array("part_impulse", A, F64, "N m s", "impulse of a motor in the last step, with \"auto\" substeps of the whole tick", sparse=True)

    contact_particle = _array("contact_particle", T, I32, "slot", "the particle of a contact of the last step", of=P)
    contact_feature = _array("contact_feature", T, I64, "", "what the particle touched (contacts.py)", of=FEATURES)
    contact_impulse = _array("contact_impulse", T, F64, "N s", "impulse along and across the contact", width=2, within=FINITE)
    contact_impact = _array("contact_impact", T, F64, "N s", "impulse of its impacts along the contact in the last tick, not part of `contact_impulse`; for sounds and pictures", within=FINITE, sparse=True)

    hand_strength = _array("hand_strength", H, F64, "m/s^2", "largest force divided by the mass of the body; 0: it holds nothing", sparse=True)
    hand_radius = _array("hand_radius", H, F64, "m", "particles of the body within this distance of the grabbed one share the force; 0: only the grabbed one bears it", sparse=True)
    hand_force = _array("hand_force", H, F64, "N", "its force in the last substep", width=2, sparse=True)
    setting_now = _array("setting_now", G, F64, "m/s^2, m/s, 1/s or 1", "its value in the last tick, while it comes to what is set", sparse=True)
    setting_ticks = _array("setting_ticks", G, I32, "tick", "ticks until it is what is set; 0: it is", sparse=True, of=range(LONGEST_RAMP + 1))

    rule_held = _array("rule_held", R, I32, "tick", "for how many ticks on end what it asks has held", sparse=True, of=range(2**31))
    rule_fired = _array("rule_fired", R, I32, "", "how often it fired", sparse=True, of=range(2**31))
    rule_first = _array("rule_first", R, I64, "tick", "the tick at whose end it fired first; -1: it has not", sparse=True, usual=-1)
    rule_last = _array("rule_last", R, I64, "tick", "the tick at whose end it fired last; -1: it has not", sparse=True, usual=-1)
    rule_due = _array("rule_due", R, BOOL, "", "whether it fired in the last tick: its actions come before the next one", sparse=True)
    rule_stars = _array("rule_stars", R, I8, "", "stars of its first win; 0: none yet", sparse=True, of=range(4))
    counter = _array("counter", N, F64, "1", "its value", sparse=True)
    probe_position = _array("probe_position", B, F64, "m", "where it was at the end of the last tick", width=2, sparse=True)
    still_ticks = _array("still_ticks", L, I32, "tick", "for how many ticks on end it has been still", sparse=True, of=range(2**31))
    key_down = _array("key_down", K, BOOL, "", "whether it is held", sparse=True)

    deed_refused = _array("deed_refused", D, BOOL, "", "whether the level lets no hand give it", sparse=True)
    deed_budget = _array("deed_budget", D, I32, "", "the counter that says how often hands may still give it; -1: as often as they like", sparse=True, usual=-1, of=N)
    # fmt: on
    tick: int

    def __repr__(self) -> str:
        """The world in a line; hands that hold are left out."""
        hands = int(np.count_nonzero(self.spring_active & (self.material == GRAB_MATERIAL)))
        particles, springs = (
            int(np.count_nonzero(each)) - hands for each in (self.particle_active, self.spring_active)
        )
        return f"<{type(self).__name__} at tick {self.tick}: {particles:,} particles, {springs:,} springs>"


# Every array of a world's state, in the order in which it is hashed and stored.
COLUMNS: tuple[Column, ...] = tuple(column for column in vars(StateArrays).values() if isinstance(column, Column))
BY_NAME: dict[str, Column] = {column.name: column for column in COLUMNS}
BY_STORED: dict[str, Column] = {column.stored: column for column in COLUMNS}
FAMILIES: dict[Family, tuple[Column, ...]] = {
    family: tuple(column for column in COLUMNS if column.family is family) for family in Family
}
# Rows that follow from the rules of a level, and never grow.
OF_RULES: frozenset[Family] = frozenset(
    {Family.RULE, Family.COUNTER, Family.PROBE, Family.STILL, Family.KEY, Family.DEED}
)
# Those that no state goes without.
ALWAYS_STORED: frozenset[str] = frozenset(column.stored for column in COLUMNS if not column.sparse)
# Those from which solvers and collision derive, which a tick seldom changes, and all others.
TOPOLOGY: tuple[Column, ...] = tuple(column for column in COLUMNS if column.topology)
MOVING: tuple[Column, ...] = tuple(column for column in COLUMNS if not column.topology)
GUARDED: tuple[Column, ...] = tuple(column for column in COLUMNS if column.guarded)
CHECKED: tuple[Column, ...] = tuple(column for column in COLUMNS if column.within)
# The fields of State. A step's contacts lie elsewhere, with room for more.
STATE_FIELDS: tuple[str, ...] = tuple(column.name for column in COLUMNS if column.family is not Family.CONTACT)

if TYPE_CHECKING:

    class State(StateArrays):
        """The arrays of a world as kernels take them, all but its contacts; and its Terrain."""

        terrain: Any

    class GoodValues(StateArrays):
        """The last good values of a world's guarded arrays, as kernels take them."""

    class Ranges(StateArrays):
        """Of each array that is looked at the lowest and the highest good value, and its place among all columns."""

else:
    State = NamedTuple("State", [*((name, BY_NAME[name].kind) for name in STATE_FIELDS), ("terrain", Terrain)])
    GoodValues = NamedTuple("GoodValues", [(column.name, column.kind) for column in GUARDED])
    Ranges = NamedTuple("Ranges", [(column.name, Floats) for column in CHECKED])

RANGES: Ranges = cast(Any, Ranges)(
    *(np.array([each.within.lowest, each.within.high, COLUMNS.index(each)]) for each in CHECKED if each.within)
)


def state_of(world: Any) -> State:
    """The arrays of a World as kernels take them."""
    made: State = cast(Any, State)(*(getattr(world, name) for name in STATE_FIELDS), world.terrain)
    return made


def good_of(world: Any) -> GoodValues:
    """The last good values of a World's guarded arrays as kernels take them."""
    made: GoodValues = cast(Any, GoodValues)(*(world.good[column.name] for column in GUARDED))
    return made


def reference() -> str:
    """The table as a page of Markdown."""
    lines = [
        "# State arrays",
        "",
        "Every array of a world's state, in the order in which it is hashed and stored. Names are those of files and",
        "messages. A tick takes back what is out of its range, or NaN. Made by",
        "`python -m sandbox.physics.state > docs/state.md`.",
    ]
    for family in Family:
        lines += ["", f"## One row for each {family.value}", ""]
        lines += ["| name | type | unit | range | meaning |", "|---|---|---|---|---|"]
        for column in FAMILIES[family]:
            kind = np.dtype(column.dtype).name + (f", {column.width} a row" if column.width > 1 else "")
            within = "" if column.within is None else str(column.within)
            lines.append(f"| `{column.stored}` | {kind} | {column.unit} | {within} | {column.meaning} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(reference(), end="")
