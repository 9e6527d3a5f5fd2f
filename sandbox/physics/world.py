"""World: particles, springs, constraints, settings and tick, with the only methods that change them."""

from collections.abc import Callable, Sequence
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.arrays import Floats, SlotRows, Slots, empty
from sandbox.physics.breaking import StrainLimits, unlimited
from sandbox.physics.commands.command import NO_ROWS, PROGRAM, Commanded, solve
from sandbox.physics.commands.command_table import (
    KINDS,
    OF_HANDS,
    OF_SOLVER,
    OF_TOPOLOGY,
    RefusedCommand,
    carry_out,
    check_fields,
    numbers_of,
)
from sandbox.physics.commands.cutting import ASKED
from sandbox.physics.constraints import AREA, BEND, ConstraintArrays, constraints_of, rests_of
from sandbox.physics.driving import Actuators, drive_muscles, drives_of
from sandbox.physics.jit import bundle
from sandbox.physics.keeping import arguments
from sandbox.physics.keeping.arguments import CONSTRAINTS, HANDS, PARTICLES
from sandbox.physics.keeping.equipment import Capacity, Equipment, FirmBody, Joined, Names, Surface
from sandbox.physics.keeping.growing import grow
from sandbox.physics.marks import BANK_UNOPENED, GRAB_COUNT, GRAB_DAMPING, GRAB_MATERIAL, GRAB_STIFFNESS, LAW_NISSEN
from sandbox.physics.rules import Rules
from sandbox.physics.sanitise import Containment
from sandbox.physics.settings import AUTO, WorldSettings
from sandbox.physics.softness.kernels.firm import FormTable
from sandbox.physics.state import ABSURD, COLUMNS, GUARDED, OF_RULES, Family, StateArrays, good_of, state_of
from sandbox.physics.terrain import NO_TERRAIN
from sandbox.physics.water.displacers import NO_HULLS, NO_POOLS
from sandbox.physics.ways import Ways

Derived = TypeVar("Derived")
Point = tuple[float, float]

_GRAB_NAMES = [f"+hand.{grab}" for grab in range(GRAB_COUNT)]
# Largest force of a hand over the mass of the body that it holds [m/s^2], where nothing else is said: ten times its
# weight. Lower lags behind the mouse, higher tears what is soft.
HAND_STRENGTH = 100.0

# What a cut may need more rows of.
_OF_CUTS = (Family.PARTICLE, Family.SPRING, Family.CONSTRAINT, Family.CORNER)
# Attributes that another value of counts as a change of topology. From a step's contacts nothing is derived.
_WATCHED = frozenset(
    {"terrain", "water", "hulls", "actuators", "limits", "forms", "rules", "ways", "area_constraints"}
    | {column.name for column in COLUMNS if column.family is not Family.CONTACT}
)


class World(StateArrays):
    """A world's state, see StateArrays, plus the settings of a tick, and its constants: limits, driven, terrain.

    Methods raise IndexError for a slot that is not there or not in use, and ValueError for what makes no sense, such as
    a number that is not finite; nothing has changed then. Slots are append-only: an index stays a particle's or
    spring's handle; removing clears the active flag. Arrays that are topology are written by methods of World (`change`
    where there is no other), or `derived` would not notice.
    """

    def __init__(self, settings: WorldSettings | None = None, material_names: Sequence[str] = ("default",)) -> None:
        # Never state: counts of changes of topology, those by hands apart; whether any may be `unmoved`.
        self.topology_version, self.hand_version, self.may_fly = 0, 0, True
        self._derived: dict[Callable[[Any], Any], tuple[int, Any]] = {}
        self._lasting: dict[Callable[[Any], Any], Any] = {}
        self._capacity = Capacity()
        for column in COLUMNS:
            setattr(self, column.name, column.empty())
        # The last good values of what is guarded; never state.
        self.good: dict[str, Floats] = {}
        self.trust()
        self._settings = WorldSettings() if settings is None else arguments.of_kind("settings", settings, WorldSettings)
        self._numbers, self._choices = np.array(self._settings.numbers), np.array(self._settings.choices)
        grow(self, Family.SETTING, len(self._numbers), {})
        self.tick = 0
        self.material_names = tuple(arguments.texts("material_names", material_names))
        self.limits: StrainLimits = unlimited(len(self.material_names))
        self.actuators = Actuators()
        # What a particle that is added while the world runs is like to the touch.
        self.surface = Surface()
        self.particle_naming, self.spring_naming = Names(), Names()
        self.area_names: tuple[str, ...] = ()  # bodies that keep areas, and the constraints of each
        self.area_constraints: tuple[range, ...] = ()
        self.forms: tuple[FirmBody, ...] = ()  # bodies that may be stiff by their form
        self.rules: Rules = empty(Rules)
        self.ways: Ways = empty(Ways)  # the first are of rules, see Family.PROBE
        # Of each row of rules: the name of the rule, the counter or the key; of probes and stills that of the rule.
        self.row_names: dict[Family, tuple[str, ...]] = dict.fromkeys(OF_RULES, ())
        self.joined: tuple[Joined, ...] = ()
        self.grab_particle = self.grab_spring = -1
        self.terrain, self.water, self.hulls = NO_TERRAIN, NO_POOLS, NO_HULLS  # see terrain.py and water/displacers.py
        # What was taken back since somebody last looked, and the springs that broke in the last tick; never state.
        self.contained: list[Containment] = []
        self.broken: Slots = np.zeros(0, dtype=np.int64)

    def __setattr__(self, name: str, value: Any) -> None:
        """Replace an attribute; another array in place of one of the table counts as a change of topology."""
        if name in _WATCHED and value is not self.__dict__.get(name):
            self.topology_version += 1
        object.__setattr__(self, name, value)

    def __getstate__(self) -> dict[str, Any]:
        """The state that a copy starts from: derived values are left out."""
        return self.__dict__ | {"_derived": {}, "_lasting": {}, "_capacity": Capacity()}

    def derived(self, make: Callable[[Self], Derived], of_hands: bool = True) -> Derived:
        """The result of `make` for this world, kept until topology changes or an array is replaced.

        of_hands: whether it also follows from what hands hold, which changes far more often. For layouts and scratch
        that outlive a step; they follow from the arrays, so they are no state.
        """
        present = self.topology_version + self.hand_version if of_hands else self.topology_version
        version, kept = self._derived.get(make, (-1, None))
        if version != present:
            kept = make(self)
            self._derived[make] = present, kept
        return kept

    def lasting(self, make: Callable[[Self], Derived]) -> Derived:
        """The result of `make` for this world, made once; who made it follows changes of topology itself."""
        if make not in self._lasting:
            self._lasting[make] = make(self)
        return self._lasting[make]

    def change(self, name: str, values: ArrayLike, slots: Any = slice(None)) -> None:
        """Write values into slots of the state array of that attribute, in place, topology or not, and trust them.

        slots: one, a list, a slice or flags.
        """
        column = arguments.column_of("name", name)
        array = getattr(self, name)
        rows = arguments.rows_at("slots", slots, len(array))
        said, room = f"values of {name}", arguments.room_of(self)
        checked = arguments.values_of(said, column, values, array[rows].shape, room)
        arguments.replaced(self, name, rows, checked)
        array[rows] = checked
        if name in self.good:
            self.good[name][rows] = checked
        if column.topology:
            self.topology_version += 1

    def trust(self) -> None:
        """Take the present state as the last good one."""
        for column in GUARDED:
            values = getattr(self, column.name)
            good = self.good.get(column.name)
            # In place where it can be: what was derived points to them.
            if good is not None and len(good) == len(values):
                good[:] = values
            else:
                self.good[column.name] = values.copy()

    def append(self, family: Family, count: int, **arrays: ArrayLike) -> None:
        """Append `count` particles or springs with values of the arrays of that family: (count, ...) or one for all.

        What is not given is as usual; they are named +.0, +.1, ... or +:0, +:1, ...
        """
        grow(self, family, count, arguments.added_rows(self, family, count, arrays))
        self.name_slots_to(self.particle_count, self.spring_count)

    @property
    def rule_keys(self) -> tuple[str, ...]:
        """The keys that rules ask for."""
        return self.row_names[Family.KEY]

    def disturb(self, *particles: NDArray[np.integer] | int) -> None:
        """Begin new energy banks for the bodies of these particles, which something outside has changed."""
        for rows in [arguments.rows_at("particles", slots, self.particle_count) for slots in particles]:
            self.energy_bank[rows] = BANK_UNOPENED

    @property
    def settings(self) -> WorldSettings:
        """Settings of a tick, replaced as a whole; another solver resets what solvers keep, auto the energy banks."""
        return self._settings

    @settings.setter
    def settings(self, settings: WorldSettings) -> None:
        before = self._settings
        if settings.solver != before.solver or (settings.substeps == AUTO) != (before.substeps == AUTO):
            self._choices[:] = before.choices
            self._multiply_contacts(solve(self.lent, np.array(settings.choices)))
        # What is set so is in force at once.
        is_set = np.array(settings.numbers) != np.array(before.numbers)
        self.setting_now[is_set] = self.setting_ticks[is_set] = 0
        self._settings = settings

    def _multiply_contacts(self, factor: float) -> None:
        # Those of another solver are nothing, whatever they were.
        self.contact_impulse[:] = self.contact_impulse * factor if factor != 0.0 else 0.0

    @property
    def commanded(self) -> Commanded:
        """The arrays that commands change."""
        self._numbers[:], self._choices[:] = self._settings.numbers, self._settings.choices
        table, areas = self.form_table, areas_of(self)
        return Commanded(
            state_of(self), good_of(self), self._numbers, self._choices, areas, table.forms, table.modes
        )  # fmt: skip

    @property
    def lent(self) -> Any:
        """The arrays that commands change, as kernels take them."""
        return self.derived(_lend, of_hands=False)

    @property
    def form_table(self) -> FormTable:
        """The forms of bodies as kernels take them, with what was found of them."""
        table = self.lasting(FormTable)
        table.follow(self.forms)
        return table

    @property
    def has_contacts(self) -> bool:
        """Whether anything in the world can touch anything."""
        return self.derived(_collides, of_hands=False)

    @property
    def equipment(self) -> Equipment:
        """The world's constant part, beside its state; replaced as a whole."""
        return Equipment(*(getattr(self, name) for name in Equipment._fields))

    @equipment.setter
    def equipment(self, equipment: Equipment) -> None:
        for name, value in equipment._asdict().items():
            setattr(self, name, value)

    @property
    def particle_count(self) -> int:
        """Particle slots in use, active or not, grabs included."""
        return len(self.mass)

    @property
    def spring_count(self) -> int:
        """Spring slots in use, active or not, grabs included."""
        return len(self.rest_length)

    @property
    def constraint_count(self) -> int:
        """Constraint slots in use, active or not."""
        return len(self.constraint_kind)

    @property
    def constraints(self) -> ConstraintArrays:
        """The constraints as kernels read them."""
        return constraints_of(self)

    @property
    def particle_names(self) -> list[str]:
        """Name of each particle, by slot."""
        return self.particle_naming.in_order

    @property
    def spring_names(self) -> list[str]:
        """Name of each spring, by slot."""
        return self.spring_naming.in_order

    def particle_slot(self, name: str) -> int:
        """Slot of the particle of that name. Raises KeyError."""
        return self.particle_naming.slot(name)

    def name_particle(self, slot: int, name: str) -> None:
        """Give a particle a second name to be found by. Raises ValueError where that is taken."""
        arguments.slot("slot", slot, PARTICLES, len(self.particle_names))
        self.particle_naming.add_second(slot, arguments.text("name", name))

    def spring_slot(self, name: str) -> int:
        """Slot of the spring of that name. Raises KeyError."""
        return self.spring_naming.slot(name)

    def is_grab_particle(self, slot: int) -> bool:
        """Whether the slot is a grab's cursor."""
        return 0 <= self.grab_particle <= arguments.whole("slot", slot) < self.grab_particle + GRAB_COUNT

    def is_grab_spring(self, slot: int) -> bool:
        """Whether the slot is a grab's spring."""
        return 0 <= self.grab_spring <= arguments.whole("slot", slot) < self.grab_spring + GRAB_COUNT

    def add_particles(
        self,
        names: Sequence[str],
        position: ArrayLike,
        *,
        velocity: ArrayLike = (0.0, 0.0),
        mass: ArrayLike = 1.0,
        radius: ArrayLike = 0.05,
        pinned: ArrayLike = False,
        gravity_scale: ArrayLike = 1.0,
        friction: ArrayLike = 0.0,
        restitution: ArrayLike = 0.0,
        owner: ArrayLike | None = None,
        group: ArrayLike = 0,
        collides: ArrayLike = 0,
        **others: ArrayLike,
    ) -> int:
        """Append particles, one per name, and return the first slot.

        position [m] (k, 2); velocity [m/s] (k, 2) or one for all; the others (k,) or one for all; owner: None = each
        its own; others: arrays of the state by name, such as spin, which springs and constraints take away again.
        A pinned particle starts at rest. Raises ValueError for a name that is taken, no mass above 0, what is
        out of its range (docs/state.md), and other shapes.
        """
        count, first = len(arguments.texts("names", names)), self.particle_count
        masses = arguments.floats("mass", mass, (count,), 1.0 / ABSURD)
        is_pinned = arguments.flags("pinned", pinned, (count,))
        places = arguments.floats("position", position, (count, 2))
        velocities = np.where(is_pinned[:, None], 0.0, arguments.floats("velocity", velocity, (count, 2)))
        spins = np.where(is_pinned, 0.0, arguments.floats("spin", others.get("spin", 0.0), (count,)))
        columns = others | dict(
            position=places, origin=places, velocity=velocities, slow_velocity=velocities, energy_bank=BANK_UNOPENED,
            mass=masses, inverse_mass=np.where(is_pinned, 0.0, 1.0 / masses), radius=radius, spin=spins,
            gravity_scale=gravity_scale, particle_active=True, unmoved=True, friction=friction, restitution=restitution,
            owner=-1 - first - np.arange(count) if owner is None else owner, group=group, collides=collides,
        )  # fmt: skip
        rows = arguments.rows_of(self, Family.PARTICLE, count, columns)
        self.particle_naming.append(names)
        grow(self, Family.PARTICLE, count, rows)
        return first

    def add_springs(
        self, names: Sequence[str], particle_a: ArrayLike, particle_b: ArrayLike, *,
        rest_length: ArrayLike | None = None, stiffness: ArrayLike = 0.5, damping: ArrayLike = 0.9,
        law: ArrayLike = LAW_NISSEN, hooke_stiffness: ArrayLike = 0.0, hooke_damping: ArrayLike = 0.0,
        material: ArrayLike = 0, edge: ArrayLike = 0, belt: ArrayLike = 0.0,
    ) -> int:  # fmt: skip
        """Append springs, one per name, and return the first slot.

        particle_a, particle_b: slots (k,); the others (k,) or one for all. rest_length [m]: None or NaN = as placed.
        Raises IndexError for a slot that does not exist, and ValueError for a name that is taken, a spring from a
        particle to itself, numbers out of their range (docs/state.md), and other shapes.
        """
        count, first = len(arguments.texts("names", names)), self.spring_count
        a = arguments.slots("particle_a", particle_a, PARTICLES, self.particle_count)
        b = arguments.slots("particle_b", particle_b, PARTICLES, self.particle_count)
        if not len(a) == len(b) == count:
            raise ValueError(f"{count} names, {len(a)} slots particle_a and {len(b)} particle_b: one each is needed")
        separation = self.position[b] - self.position[a]
        placed = np.sqrt(separation[:, 0] * separation[:, 0] + separation[:, 1] * separation[:, 1])
        rest = placed if rest_length is None else arguments.floats_or("rest_length", rest_length, placed, 0.0)
        columns: dict[str, ArrayLike] = dict(
            particle_a=a, particle_b=b, rest_length=rest, natural_length=rest, stiffness=stiffness, damping=damping,
            law=law, hooke_stiffness=hooke_stiffness, hooke_damping=hooke_damping, material=material,
            spring_active=True, edge=edge, belt=belt,
        )  # fmt: skip
        rows = arguments.rows_of(self, Family.SPRING, count, columns)
        self.spring_naming.append(names)
        grow(self, Family.SPRING, count, rows)
        # A grab's spring joins nothing yet.
        joins = np.broadcast_to(np.asarray(material) != GRAB_MATERIAL, count)
        self.spin[a[joins]] = self.spin[b[joins]] = 0.0
        self.disturb(a, b)
        return first

    def add_constraints(
        self, kind: int, corners: ArrayLike, *, form: ArrayLike | None = None, inflation: ArrayLike = 1.0,
        stiffness: ArrayLike = 0.5, damping: ArrayLike = 0.9, material: ArrayLike = 0,
    ) -> int:  # fmt: skip
        """Append constraints of one kind, AREA or BEND, with k corners each, and return the first slot.

        corners: particle slots (t, k), of an area in the order of its outline. form [m] (t, k, 2): their places at
        rest, None = as they stand. inflation: area wanted as a multiple of the form's, below 0 turned over. The others
        (t,) or one for all.
        Raises IndexError for a slot that does not exist, and ValueError for one that comes twice, a bend with no three
        corners or with a link of no length, an area with fewer than three corners, and numbers out of their range.
        """
        slots = arguments.slot_rows("corners", corners, PARTICLES, self.particle_count)
        count, size = slots.shape
        if (arguments.whole_from("kind", kind, AREA, BEND) == BEND and size != 3) or size < 3:
            raise ValueError("corners: an area has three corners or more, a bend three")
        if np.any(np.diff(np.sort(slots, axis=1), axis=1) == 0):
            raise ValueError("the corners of a constraint are different particles")
        places = self.position[slots] if form is None else arguments.floats("form", form, (count, size, 2))
        inflations = arguments.floats("inflation", inflation, (count,))
        rest, weight = rests_of(kind, places, inflations)
        first = self.constraint_count
        columns: dict[str, ArrayLike] = dict(
            constraint_kind=kind, constraint_corners=size, constraint_rest=rest, constraint_stiffness=stiffness,
            constraint_damping=damping, constraint_material=material, constraint_active=True,
        )  # fmt: skip
        of_corners: dict[str, ArrayLike] = dict(
            corner_particle=slots.reshape(-1), corner_weight=weight, corner_form=places.reshape(-1, 2)
        )
        corner_rows = arguments.rows_of(self, Family.CORNER, count * size, of_corners)
        rows = arguments.rows_of(self, Family.CONSTRAINT, count, columns)
        rows["constraint_first"] = len(self.corner_particle) + size * np.arange(count)
        grow(self, Family.CONSTRAINT, count, rows)
        grow(self, Family.CORNER, count * size, corner_rows)
        self.spin[slots] = 0.0
        self.disturb(slots)
        return first

    def name_areas(self, name: str, constraints: range) -> None:
        """Name the areas of a body, to be inflated together. Raises IndexError."""
        if arguments.text("name", name) and arguments.of_kind("constraints", constraints, range).step != 1:
            raise ValueError(f"constraints {constraints}: a range of step 1 is needed")
        arguments.slots("constraints", constraints[:1] or constraints[-1:], CONSTRAINTS, self.constraint_count)
        arguments.slots("constraints", constraints[-1:], CONSTRAINTS, self.constraint_count)
        self.area_names += (name,)
        self.area_constraints += (constraints,)

    def set_coefficients(
        self, stiffness: float | None, damping: float | None, material: int | None, duration: int = 0
    ) -> None:
        """Set Cs, Cd or both, of one material's springs and areas or (None) of all, and end their bodies' firmness.

        Grabs, Hooke springs and constraints with Cs and Cd of their own keep theirs. duration [ticks]: see ramps.py.
        """
        self.command("set_coefficients", stiffness=stiffness, damping=damping, material=material, duration=duration)

    def set_gravity(self, gravity: Point, duration: int = 0) -> None:
        """Set gravity [m/s^2]; duration [ticks]: see ramps.py."""
        self.command("set_gravity", gravity=gravity, duration=duration)

    def set_air(self, wind: Point | None, drag: float | None, duration: int = 0) -> None:
        """Set the wind [m/s], the drag [1/s] or both (None: it stays); duration [ticks]: see ramps.py."""
        self.command("set_air", wind=wind, drag=drag, duration=duration)

    def reserve_grabs(self) -> None:
        """Reserve the slots of all grabs, inactive; done once, when the world is built."""
        if self.grab_particle >= 0 or self.particle_count == 0:
            return
        self.grab_particle = self.add_particles(_GRAB_NAMES, np.zeros((GRAB_COUNT, 2)), pinned=True, radius=0.0)
        held = np.zeros(GRAB_COUNT, dtype=np.int64)
        cursors = self.grab_particle + np.arange(GRAB_COUNT)
        self.grab_spring = self.add_springs(
            _GRAB_NAMES, cursors, held, rest_length=0.0, stiffness=GRAB_STIFFNESS, damping=GRAB_DAMPING,
            material=GRAB_MATERIAL,
        )  # fmt: skip
        grow(self, Family.HAND, GRAB_COUNT, {})
        self.change("particle_active", False, slice(self.grab_particle, None))
        self.change("spring_active", False, slice(self.grab_spring, None))

    def command(self, name: str, giver: int = PROGRAM, /, **values: Any) -> None:
        """Carry out a command of KINDS (command.py) that a hand, a rule or a program gives.

        values: its fields, by name. Raises IndexError, ValueError and RefusedCommand; nothing is changed then.
        """
        check_fields(name, giver, values)
        if name == "grab" and self.grab_particle < 0:
            # Nothing is left of a hold that cannot be, no slots of hands either.
            arguments.slot("grab", values["grab"], HANDS, GRAB_COUNT)
            arguments.active_particles(self, "particle", [values["particle"]])
            numbers_of(name, values)
            self.reserve_grabs()
        values.update(
            first_cursor=self.grab_particle, first_spring=self.grab_spring, tick_rate=self._settings.tick_rate,
            materials=len(self.material_names),
        )  # fmt: skip
        values.setdefault("duration", 0)
        self._numbers[:], self._choices[:] = self._settings.numbers, self._settings.choices
        try:
            numbers = carry_out(self.lent, giver, name, values, self)
        except RefusedCommand as refused:
            if refused.reason != NO_ROWS:
                raise
            rows = refused.numbers[-ASKED:]
            for family, count in zip(_OF_CUTS, map(int, rows), strict=True):
                grow(self, family, count, {})
            numbers = carry_out(self.lent, giver, name, {**values, "rows": rows}, self)
            self.name_slots_to(self.particle_count, self.spring_count)
        changes = KINDS[name].changes
        if changes == OF_SOLVER:
            self._multiply_contacts(numbers[-1])
        if changes == OF_SOLVER or name in ("set_gravity", "set_air"):
            self._settings = WorldSettings.of(self._numbers.tolist(), self._choices.tolist())
        if changes == OF_TOPOLOGY:
            self.topology_version += 1
        elif changes == OF_HANDS:
            self.hand_version += 1

    def pin(self, particle: int) -> None:
        """Hold a particle at its place."""
        self.command("pin", particle=particle)

    def unpin(self, particle: int) -> None:
        """Let a pinned particle move again, with the mass it has."""
        self.command("unpin", particle=particle)

    def cut(self, springs: Sequence[int] | Slots, at: Sequence[float] | Floats = ()) -> None:
        """Take springs out of the world, and the constraints that they were a side of; their slots stay.

        at: where each is cut, as a share of it from its first end. What keeps areas is parted there, see cutting.py.
        """
        self.command("cut_springs", springs=springs, at=at)

    def break_springs(self, springs: Sequence[int] | Slots) -> None:
        """Take out springs that broke by themselves: the pieces of a body keep its energy."""
        self.command("break_springs", springs=springs)
        self.broken = np.asarray(springs, np.int64)

    def push(self, position: Point, impulse: Point, outward: float, radius: float) -> None:
        """Give the free particles nearer to position [m] than radius [m] an impulse [N s] together.

        outward [N s]: the sum of the impulses that also drive each one straight away from there. See `_push` in
        command.py: what is near moves more, whatever its mass.
        """
        self.command("push", position=position, impulse=impulse, outward=outward, radius=radius)

    def shake(self, acceleration: Point) -> None:
        """Accelerate the frame of terrain and pins by `acceleration` [m/s^2] for a tick: free particles stay behind."""
        self.command("shake", acceleration=acceleration)

    def fit(self, driven: Actuators, values: ArrayLike) -> None:
        """Give the world its driven parts, with the value (k,) of each, -1..1; done once, when the world is built.

        Muscles get the rest lengths that they have at the present tick.
        """
        arguments.check_driven(self, arguments.of_kind("driven", driven, Actuators))
        checked = [arguments.number("values", value, -1.0, 1.0) for value in arguments.listed("values", values)]
        if len(checked) != len(driven.names):
            raise ValueError(f"values of {len(checked)} parts: {len(driven.names)} are driven")
        self.actuators = driven
        self.actuator_value = np.array(checked, dtype=np.float64)
        self.actuator_impulse = np.zeros_like(self.actuator_value)
        if len(driven.muscles.spring):
            pointer = bundle((state_of(self), good_of(self), drives_of(driven)))
            drive_muscles(pointer, self.tick, *self._settings.choices[:2])

    def drive(self, part: int, value: float) -> None:
        """Drive a part, -1..1: a motor at that share of its speed, a hydraulic at that share of its rate."""
        self.command("set_drive", part=part, value=value)

    def hold(
        self, grab: int, particle: int, target: Point, strength: float = HAND_STRENGTH, radius: float = 0.0
    ) -> None:
        """Grab a particle with a hand, which draws it to its cursor, at target [m]: a mouse joint (joints/hands.py).

        strength [m/s^2]: largest force over the mass of the body held. radius [m]: particles of the body that
        are nearer to this one share the force; 0: it bears all of it.
        """
        self.command("grab", grab=grab, particle=particle, target=target, strength=strength, radius=radius)

    def is_held(self, grab: int) -> bool:
        """Whether a grab holds a particle."""
        arguments.slot("grab", grab, HANDS, GRAB_COUNT)
        return self.grab_spring >= 0 and bool(self.spring_active[self.grab_spring + grab])

    def any_held(self) -> bool:
        """Whether any grab holds a particle."""
        return any(map(self.is_held, range(GRAB_COUNT)))

    def move_grab(self, grab: int, target: Point) -> None:
        """Send a grab's cursor to target [m]: it travels there in the coming tick."""
        self.command("move_grab", grab=grab, target=target)

    def end_tick(self) -> None:
        """Count a tick, past the watch over attributes, which takes as long as a tenth of it."""
        self.__dict__["tick"] += 1
        self.__dict__["may_fly"] = False

    def release(self, grab: int) -> None:
        """Release a hand's particle; its slots wait for the next use. No bank keeps energy that the hand put in."""
        self.command("release", grab=grab)

    def name_slots(self, particles: Sequence[str], springs: Sequence[str]) -> None:
        """Name the slots that a restored state brought along, from the first one without a name on."""
        self.particle_naming.check("particles", arguments.texts("particles", particles), self.particle_count)
        self.spring_naming.check("springs", arguments.texts("springs", springs), self.spring_count)
        self.particle_naming.append(particles)
        self.spring_naming.append(springs)

    def name_slots_to(self, particle_count: int, spring_count: int) -> None:
        """Name the slots up to these counts that have no name yet, those of hands too."""
        arguments.whole_from("particle_count", particle_count, 0, self.particle_count)
        arguments.whole_from("spring_count", spring_count, 0, self.spring_count)
        if len(self.particle_names) <= self.grab_particle < particle_count:
            # A level without particles reserves its hands at the first grab, behind what was added until then.
            self.name_slots_to(self.grab_particle, self.grab_spring)
            self.name_slots(_GRAB_NAMES, _GRAB_NAMES)
        self.name_slots(
            self.particle_naming.unused("+.", particle_count - len(self.particle_names)),
            self.spring_naming.unused("+:", spring_count - len(self.spring_names)),
        )

    def forget_names_beyond(self, particle_count: int, spring_count: int) -> None:
        """Drop the names of slots that a restored state does not have."""
        for argument, count in (("particle_count", particle_count), ("spring_count", spring_count)):
            arguments.slot(argument, count, "rows", arguments.FARTHEST)
        self.particle_naming.forget_beyond(particle_count)
        self.spring_naming.forget_beyond(spring_count)


def _lend(world: World) -> Any:
    return bundle(world.commanded)


def areas_of(world: World) -> SlotRows:
    """Of each body that keeps areas its first constraint, and the one behind its last (k, 2)."""
    return np.array([(each.start, each.stop) for each in world.area_constraints], np.int64).reshape(-1, 2)


def _collides(world: World) -> bool:
    return bool(world.collides.any())
