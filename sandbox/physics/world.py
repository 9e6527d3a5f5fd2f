"""World: particles, springs, settings and tick, with the only methods that change them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.arrays import CORNER_ARRAYS, GUARDED, PARTICLE_ARRAYS, SPRING_ARRAYS
from sandbox.physics.elements import BEND
from sandbox.physics.settings import AUTO, WorldSettings
from sandbox.physics.slots import BANK_UNOPENED, ElementSlots

Floats = NDArray[np.float64]
Slots = NDArray[np.int64]

LAW_NISSEN = 0
LAW_HOOKE = 1

# How many particles can be held at once. A hand is a pinned cursor particle and one spring, in slots reserved when
# the world is built, so that grabbing never moves another slot.
HAND_COUNT = 10
# The material index of a hand's spring: of no material, so that no slider reaches it.
HAND_MATERIAL = -1
# Cs and Cd of a hand's spring, for a whole tick. (Cs + 2 Cd) = 0.8 of the proven bound 4, so that a body inside the
# article's 1/(n+1) stays bounded while it is held; higher values grip harder and use that margin up.
HAND_STIFFNESS = 0.2
HAND_DAMPING = 0.3


class World(ElementSlots):
    """Particles and springs as a struct of arrays, plus the settings of a tick.

    Arrays, n particles and m springs, float64 unless said: position [m] (n, 2), velocity [m/s] (n, 2), origin [m]
    (n, 2) = where each was created, which orders the direct solver's elimination, mass [kg], inverse_mass [1/kg]
    (0 = pinned), radius [m], particle_active (bool); particle_a, particle_b (int32 slots), rest_length [m], stiffness,
    damping (Cs, Cd per tick), law (int8), hooke_stiffness [N/m], hooke_damping [N s/m],
    material (int32 index into material_names, -1 = a hand's), spring_active (bool), impulse [N s] (m, 2) = what the
    iterative solver keeps for its warm start. The direct solver keeps slow_velocity [m/s] (n, 2) = the slow part of the
    velocity, energy_bank [J] (n,) = what a body's earlier losses still allow it, at its free particle of lowest slot
    (-1: to be begun anew), tension [N s] (m,) = the impulse by which a spring pulled in the last step, of a whole tick
    where substeps are "auto", as impulse then is.

    Of t elements (elements.py) with q corners in all: element_kind (int8), element_first, element_corners (int32: where
    its corners begin, and how many), element_rest (t, 2), element_stiffness, element_damping (Cs, Cd per tick),
    element_material (int32, -1 = Cs and Cd of its own), element_active (bool); corner_particle (int32),
    corner_weight (q,), corner_form [m] (q, 2) = where it stands at rest. An element goes with any of the
    springs along its sides.

    Slots are append-only: an index stays a particle's or spring's handle for ever; removing clears the active flag.
    Pinned particles have velocity 0, except a hand's cursor while it moves.
    """

    position: Floats
    velocity: Floats
    origin: Floats
    mass: Floats
    inverse_mass: Floats
    radius: Floats
    particle_active: NDArray[np.bool_]
    slow_velocity: Floats
    energy_bank: Floats
    particle_a: NDArray[np.int32]
    particle_b: NDArray[np.int32]
    rest_length: Floats
    stiffness: Floats
    damping: Floats
    law: NDArray[np.int8]
    hooke_stiffness: Floats
    hooke_damping: Floats
    material: NDArray[np.int32]
    spring_active: NDArray[np.bool_]
    impulse: Floats
    tension: Floats

    def __init__(self, settings: WorldSettings | None = None, material_names: Sequence[str] = ("default",)) -> None:
        super().__init__()
        self._settings = settings or WorldSettings()
        self.tick = 0
        self.material_names = tuple(material_names)
        self.particle_names: list[str] = []
        self.spring_names: list[str] = []
        self._particle_slots: dict[str, int] = {}
        self._spring_slots: dict[str, int] = {}
        self.hand_particle = -1
        self.hand_spring = -1
        # What a solver derives from topology and pins alone; never state.
        self.solver_cache: Any = None
        # What the quarantine has taken back since somebody last looked, and, in `good`, the last good values by array;
        # never state.
        self.contained: list[Any] = []

    def __getstate__(self) -> dict[str, Any]:
        """What a copy starts from: all but what solvers derive, which may hold a thread."""
        return self.__dict__ | {"solver_cache": None}

    @property
    def settings(self) -> WorldSettings:
        """Settings of a tick, replaced as a whole; another solver begins anew what solvers keep, auto the banks."""
        return self._settings

    @settings.setter
    def settings(self, settings: WorldSettings) -> None:
        if settings.solver != self._settings.solver:
            self.slow_velocity[:] = self.velocity
            self.energy_bank[:] = BANK_UNOPENED
            self.impulse[:] = 0.0
            self.tension[:] = 0.0
        if (settings.substeps == AUTO) != (self._settings.substeps == AUTO):
            self.energy_bank[:] = BANK_UNOPENED
            self.scale_impulses(self._settings.fewest_substeps / settings.fewest_substeps)
        self._settings = settings

    def scale_impulses(self, factor: float) -> None:
        """Turn what solvers keep of the last step's impulses into those of a step of another length."""
        if factor != 1.0:
            self.impulse *= factor
            self.tension *= factor

    @property
    def particle_count(self) -> int:
        """Particle slots in use, active or not, hands included."""
        return len(self.mass)

    @property
    def spring_count(self) -> int:
        """Spring slots in use, active or not, hands included."""
        return len(self.rest_length)

    def particle_slot(self, name: str) -> int:
        """Slot of the particle of that name. Raises KeyError."""
        return self._particle_slots[name]

    def name_particle(self, slot: int, name: str) -> None:
        """Give a particle a second name to be found by. Raises ValueError where that is taken."""
        if name in self._particle_slots:
            raise ValueError(f"the name {name!r} is taken")
        self._particle_slots[name] = slot

    def spring_slot(self, name: str) -> int:
        """Slot of the spring of that name. Raises KeyError."""
        return self._spring_slots[name]

    def slot_name(self, array: str, slot: int) -> str:
        """What a person calls the owner of a slot of the state array of that name."""
        if array in SPRING_ARRAYS:
            return self.spring_names[slot]
        if array in PARTICLE_ARRAYS:
            return self.particle_names[slot]
        if array in CORNER_ARRAYS:
            return f"corner at {self.particle_names[self.corner_particle[slot]]}"
        middle = self.element_first[slot] + (self.element_kind[slot] == BEND)
        kind = "bend" if self.element_kind[slot] == BEND else "area"
        return f"{kind} at {self.particle_names[self.corner_particle[middle]]}"

    def is_hand_particle(self, slot: int) -> bool:
        """Whether the slot is a hand's cursor."""
        return 0 <= self.hand_particle <= slot < self.hand_particle + HAND_COUNT

    def is_hand_spring(self, slot: int) -> bool:
        """Whether the slot is a hand's spring."""
        return 0 <= self.hand_spring <= slot < self.hand_spring + HAND_COUNT

    def add_particles(
        self,
        names: Sequence[str],
        position: ArrayLike,
        *,
        velocity: ArrayLike = (0.0, 0.0),
        mass: ArrayLike = 1.0,
        radius: ArrayLike = 0.05,
        pinned: ArrayLike = False,
    ) -> int:
        """Append particles, one per name, and return the first slot.

        position [m] (k, 2); velocity [m/s] (k, 2) or one for all; mass [kg], radius [m] and pinned (k,) or one for all.
        A pinned particle starts at rest. Raises ValueError for a name that is taken or a mass that is not above 0.
        """
        count, first = len(names), self.particle_count
        masses = np.broadcast_to(np.asarray(mass, dtype=np.float64), count)
        is_pinned = np.broadcast_to(np.asarray(pinned, dtype=np.bool_), count)
        if not np.all(masses > 0.0):
            raise ValueError("every particle has a mass above 0 kg")
        _register(self._particle_slots, self.particle_names, names)
        velocities = np.broadcast_to(np.asarray(velocity, dtype=np.float64), (count, 2))
        self._append(
            position=np.asarray(position, dtype=np.float64).reshape(count, 2),
            origin=np.asarray(position, dtype=np.float64).reshape(count, 2),
            velocity=np.where(is_pinned[:, None], 0.0, velocities),
            slow_velocity=np.where(is_pinned[:, None], 0.0, velocities),
            energy_bank=np.full(count, BANK_UNOPENED),
            mass=masses,
            inverse_mass=np.where(is_pinned, 0.0, 1.0 / masses),
            radius=np.broadcast_to(np.asarray(radius, dtype=np.float64), count),
            particle_active=np.ones(count, dtype=np.bool_),
        )
        return first

    def add_springs(
        self,
        names: Sequence[str],
        particle_a: ArrayLike,
        particle_b: ArrayLike,
        *,
        rest_length: ArrayLike | None = None,
        stiffness: ArrayLike = 0.5,
        damping: ArrayLike = 0.9,
        law: ArrayLike = LAW_NISSEN,
        hooke_stiffness: ArrayLike = 0.0,
        hooke_damping: ArrayLike = 0.0,
        material: ArrayLike = 0,
    ) -> int:
        """Append springs, one per name, and return the first slot.

        particle_a, particle_b: slots (k,); the others (k,) or one for all. rest_length [m]: None or NaN = as placed.
        Raises ValueError for a name that is taken, a slot that does not exist, or a spring from a particle to itself.
        """
        count, first = len(names), self.spring_count
        a = np.asarray(particle_a, dtype=np.int64).reshape(count)
        b = np.asarray(particle_b, dtype=np.int64).reshape(count)
        if count and (min(a.min(), b.min()) < 0 or max(a.max(), b.max()) >= self.particle_count):
            raise ValueError("a spring names a particle slot that does not exist")
        if np.any(a == b):
            raise ValueError("a spring joins two different particles")
        _register(self._spring_slots, self.spring_names, names)
        separation = self.position[b] - self.position[a]
        placed = np.sqrt(separation[:, 0] * separation[:, 0] + separation[:, 1] * separation[:, 1])
        given = np.broadcast_to(np.asarray(np.nan if rest_length is None else rest_length, dtype=np.float64), count)
        self._append(
            particle_a=a,
            particle_b=b,
            rest_length=np.where(np.isnan(given), placed, given),
            stiffness=np.broadcast_to(stiffness, count),
            damping=np.broadcast_to(damping, count),
            law=np.broadcast_to(law, count),
            hooke_stiffness=np.broadcast_to(hooke_stiffness, count),
            hooke_damping=np.broadcast_to(hooke_damping, count),
            material=np.broadcast_to(material, count),
            spring_active=np.ones(count, dtype=np.bool_),
            impulse=np.zeros((count, 2)),
            tension=np.zeros(count),
        )
        self._disturb(a, b)
        return first

    def reserve_hands(self) -> None:
        """Reserve the slots of all hands, inactive; done once, when the world is built."""
        if self.hand_particle >= 0 or self.particle_count == 0:
            return
        names = _hand_names()
        self.hand_particle = self.add_particles(names, np.zeros((HAND_COUNT, 2)), pinned=True, radius=0.0)
        held = np.zeros(HAND_COUNT, dtype=np.int64)
        cursors = self.hand_particle + np.arange(HAND_COUNT)
        self.hand_spring = self.add_springs(
            names,
            cursors,
            held,
            rest_length=0.0,
            stiffness=HAND_STIFFNESS,
            damping=HAND_DAMPING,
            material=HAND_MATERIAL,
        )
        self.particle_active[self.hand_particle :] = False
        self.spring_active[self.hand_spring :] = False

    def pin(self, particle: int) -> None:
        """Hold a particle where it is."""
        self.inverse_mass[particle] = 0.0
        self.velocity[particle] = 0.0
        self.slow_velocity[particle] = 0.0
        self._disturb(particle)

    def freeze(self, particle: int) -> None:
        """Bring a particle back to its last good values and pin it there."""
        self.position[particle] = self.good["position"][particle]
        self.mass[particle] = self.good["mass"][particle]
        self.pin(particle)

    def unpin(self, particle: int) -> None:
        """Let a pinned particle move again, with the mass it has."""
        self.inverse_mass[particle] = 1.0 / self.mass[particle]
        self.slow_velocity[particle] = self.velocity[particle]
        self._disturb(particle)

    def cut(self, springs: Sequence[int]) -> None:
        """Take springs out of the world; their slots stay."""
        for slot in springs:
            self.spring_active[slot] = False
            self.impulse[slot] = 0.0
            self.tension[slot] = 0.0
            self._disturb(self.particle_a[slot], self.particle_b[slot])
            self._drop_elements(slot)

    def hold(self, hand: int, particle: int, target: tuple[float, float]) -> None:
        """Join a particle to a hand's cursor at target [m] by a spring of rest length 0."""
        self.reserve_hands()
        cursor, spring = self.hand_particle + hand, self.hand_spring + hand
        self.particle_active[cursor] = True
        self.position[cursor] = target
        self.velocity[cursor] = 0.0
        self.slow_velocity[cursor] = 0.0
        self.particle_b[spring] = particle
        self.spring_active[spring] = True
        self.impulse[spring] = 0.0
        self.tension[spring] = 0.0
        self._disturb(particle)

    def is_held(self, hand: int) -> bool:
        """Whether a hand holds a particle."""
        return self.hand_spring >= 0 and bool(self.spring_active[self.hand_spring + hand])

    def hands_in_use(self) -> bool:
        """Whether any hand holds a particle."""
        return any(self.is_held(hand) for hand in range(HAND_COUNT))

    def move_hand(self, hand: int, target: tuple[float, float]) -> None:
        """Send a hand's cursor to target [m]: it travels there in the coming tick."""
        cursor = self.hand_particle + hand
        self.velocity[cursor] = (np.asarray(target) - self.position[cursor]) * float(self.settings.tick_rate)

    def rest_hands(self) -> None:
        """Stop every cursor; the end of a tick."""
        if self.hand_particle >= 0:
            self.velocity[self.hand_particle : self.hand_particle + HAND_COUNT] = 0.0

    def release(self, hand: int) -> None:
        """Let go; the hand's slots wait for its next use."""
        cursor, spring = self.hand_particle + hand, self.hand_spring + hand
        self.particle_active[cursor] = False
        self._disturb(self.particle_b[spring])
        self.position[cursor] = 0.0
        self.velocity[cursor] = 0.0
        self.slow_velocity[cursor] = 0.0
        self.particle_b[spring] = 0
        self.spring_active[spring] = False
        self.impulse[spring] = 0.0
        self.tension[spring] = 0.0

    def set_coefficients(self, stiffness: float | None, damping: float | None, material: int | None) -> None:
        """Set Cs, Cd or both, of one material's springs and areas or (None) of all.

        Hands, Hooke springs and elements with Cs and Cd of their own keep theirs.
        """
        for family, materials in (("", self.material), ("element_", self.element_material)):
            chosen = materials >= 0 if material is None else materials == material
            for name, value in ((f"{family}stiffness", stiffness), (f"{family}damping", damping)):
                if value is not None:
                    getattr(self, name)[chosen] = value
                self.good[name][chosen] = getattr(self, name)[chosen]
            if not family:
                self._disturb(self.particle_a[chosen], self.particle_b[chosen])
            else:
                self._disturb(self.corner_particle[np.repeat(chosen, self.element_corners)])

    def trust(self) -> None:
        """Take everything as it is now for good."""
        self.good = {name: getattr(self, name).copy() for name in GUARDED}

    def name_slots(self, particles: Sequence[str], springs: Sequence[str]) -> None:
        """Name the slots that a restored state brought along, from the first one without a name on."""
        _register(self._particle_slots, self.particle_names, particles)
        _register(self._spring_slots, self.spring_names, springs)

    def name_hands(self) -> None:
        """Name the hands' slots, where a restored state brought them along."""
        self.name_slots(_hand_names(), _hand_names())

    def forget_names_beyond(self, particle_count: int, spring_count: int) -> None:
        """Drop the names of slots that a restored state does not have."""
        for slots, names, count in (
            (self._particle_slots, self.particle_names, particle_count),
            (self._spring_slots, self.spring_names, spring_count),
        ):
            for name in names[count:]:
                del slots[name]
            del names[count:]


def _hand_names() -> list[str]:
    return [f"+hand.{hand}" for hand in range(HAND_COUNT)]


def _register(slots: dict[str, int], names: list[str], added: Sequence[str]) -> None:
    fresh = {name: len(names) + index for index, name in enumerate(added)}
    taken = next((name for name in added if name in slots), None)
    if taken is not None or len(fresh) != len(added):
        raise ValueError(f"the name {taken or 'of two new slots'!r} is taken")
    slots.update(fresh)
    names.extend(added)
