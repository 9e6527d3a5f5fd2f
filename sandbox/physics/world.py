"""World: particles, springs, settings and tick, with the only methods that change them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sandbox.physics.actuators import Driven, StrainLimits, Surface, unlimited
from sandbox.physics.constraints import BEND
from sandbox.physics.names import Names
from sandbox.physics.settings import AUTO, WorldSettings
from sandbox.physics.slots import ElementSlots
from sandbox.physics.state import (
    BANK_UNOPENED,
    CONTACT_ARRAYS,
    CORNER_ARRAYS,
    PART_ARRAYS,
    PARTICLE_ARRAYS,
    SPRING_ARRAYS,
    Floats,
    Slots,
)
from sandbox.physics.terrain import NO_TERRAIN, Terrain

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
    """Particles and springs as a struct of arrays, see StateArrays, plus the settings of a tick.

    Slots are append-only: an index stays a particle's or spring's handle for ever; removing clears the active flag.
    Pinned particles have velocity 0, except a hand's cursor while it moves. limits and driven: equipment, see there.
    """

    def __init__(self, settings: WorldSettings | None = None, material_names: Sequence[str] = ("default",)) -> None:
        super().__init__()
        self._settings = settings or WorldSettings()
        self.tick = 0
        self.material_names = tuple(material_names)
        self.limits: StrainLimits = unlimited(len(self.material_names))
        self.driven = Driven()
        # What a particle that is added while the world runs is like to the touch.
        self.surface = Surface()
        self._particles, self._springs = Names(), Names()
        self.hand_particle = -1
        self.hand_spring = -1
        self.terrain: Terrain = NO_TERRAIN
        # What a solver derives from topology and pins alone; never state.
        self.solver_cache: Any = None
        # The contacts of the present step, and what finding them derives from topology alone; never state.
        self.contacts: Any = None
        self.contact_cache: Any = None
        # What the quarantine has taken back since somebody last looked; never state.
        self.contained: list[Any] = []
        # The springs that broke in the last tick; never state.
        self.broken: Slots = np.zeros(0, dtype=np.int64)
        self._touching = False

    def __getstate__(self) -> dict[str, Any]:
        """What a copy starts from: all but what solvers derive, which may hold a thread."""
        return self.__dict__ | {"solver_cache": None}

    def drop_caches(self) -> None:
        """Forget what solvers and contacts derive, which holds for interpreted kernels or for compiled ones alone."""
        self.solver_cache = self.contact_cache = self.contacts = None

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
            self.contact_impulse[:] = 0.0
        if (settings.substeps == AUTO) != (self._settings.substeps == AUTO):
            self.energy_bank[:] = BANK_UNOPENED
            self.scale_impulses(self._settings.fewest_substeps / settings.fewest_substeps)
        self._settings = settings

    def scale_impulses(self, factor: float) -> None:
        """Turn what solvers keep of the last step's impulses into those of a step of another length."""
        if factor != 1.0:
            self.impulse *= factor
            self.tension *= factor
            self.contact_impulse *= factor

    @property
    def has_contacts(self) -> bool:
        """Whether anything in the world can touch anything."""
        return self._touching

    def see_what_touches(self) -> None:
        """Note whether anything can touch anything, where particles have come or gone."""
        self._touching = bool(self.collides.any())

    def keep_contacts(self, particle: NDArray[np.int32], feature: Slots, impulse: Floats) -> None:
        """Keep the contacts of a step and their impulses [N s] for the next."""
        self.contact_particle, self.contact_feature, self.contact_impulse = particle, feature, impulse

    @property
    def particle_count(self) -> int:
        """Particle slots in use, active or not, hands included."""
        return len(self.mass)

    @property
    def spring_count(self) -> int:
        """Spring slots in use, active or not, hands included."""
        return len(self.rest_length)

    @property
    def particle_names(self) -> list[str]:
        """Name of each particle, by slot."""
        return self._particles.in_order

    @property
    def spring_names(self) -> list[str]:
        """Name of each spring, by slot."""
        return self._springs.in_order

    def particle_slot(self, name: str) -> int:
        """Slot of the particle of that name. Raises KeyError."""
        return self._particles.slot(name)

    def name_particle(self, slot: int, name: str) -> None:
        """Give a particle a second name to be found by. Raises ValueError where that is taken."""
        self._particles.add_second(slot, name)

    def spring_slot(self, name: str) -> int:
        """Slot of the spring of that name. Raises KeyError."""
        return self._springs.slot(name)

    def slot_name(self, array: str, slot: int) -> str:
        """What a person calls the owner of a slot of the state array of that name."""
        if array in PARTICLE_ARRAYS:
            return self.particle_names[slot]
        if array in SPRING_ARRAYS:
            return self.spring_names[slot]
        if array in PART_ARRAYS:
            return self.driven.part_names[slot]
        if array in CONTACT_ARRAYS:
            return f"contact of {self.particle_names[self.contact_particle[slot]]}"
        if array in CORNER_ARRAYS:
            return f"corner at {self.particle_names[self.corner_particle[slot]]}"
        bend = self.element_kind[slot] == BEND
        middle = self.corner_particle[self.element_first[slot] + bend]
        return f"{'bend' if bend else 'area'} at {self.particle_names[middle]}"

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
        gravity_scale: ArrayLike = 1.0,
        friction: ArrayLike = 0.0,
        restitution: ArrayLike = 0.0,
        owner: ArrayLike | None = None,
        group: ArrayLike = 0,
        collides: ArrayLike = 0,
    ) -> int:
        """Append particles, one per name, and return the first slot.

        position [m] (k, 2); velocity [m/s] (k, 2) or one for all; the others (k,) or one for all; owner: None = each
        its own.
        A pinned particle starts at rest. Raises ValueError for a name that is taken or a mass that is not above 0.
        """
        count, first = len(names), self.particle_count
        masses = np.broadcast_to(np.asarray(mass, dtype=np.float64), count)
        is_pinned = np.broadcast_to(np.asarray(pinned, dtype=np.bool_), count)
        if not np.all(masses > 0.0):
            raise ValueError("every particle has a mass above 0 kg")
        self._particles.append(names)
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
            gravity_scale=np.broadcast_to(np.asarray(gravity_scale, dtype=np.float64), count),
            particle_active=np.ones(count, dtype=np.bool_),
            friction=np.broadcast_to(np.asarray(friction, dtype=np.float64), count),
            restitution=np.broadcast_to(np.asarray(restitution, dtype=np.float64), count),
            owner=np.broadcast_to(-1 - first - np.arange(count) if owner is None else np.asarray(owner), count),
            group=np.broadcast_to(group, count),
            collides=np.broadcast_to(collides, count),
        )
        self.see_what_touches()
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
        edge: ArrayLike = 0,
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
        self._springs.append(names)
        separation = self.position[b] - self.position[a]
        placed = np.sqrt(separation[:, 0] * separation[:, 0] + separation[:, 1] * separation[:, 1])
        given = np.broadcast_to(np.asarray(np.nan if rest_length is None else rest_length, dtype=np.float64), count)
        rest = np.where(np.isnan(given), placed, given)
        self._append(
            particle_a=a,
            particle_b=b,
            rest_length=rest,
            natural_length=rest,
            stiffness=np.broadcast_to(stiffness, count),
            damping=np.broadcast_to(damping, count),
            law=np.broadcast_to(law, count),
            hooke_stiffness=np.broadcast_to(hooke_stiffness, count),
            hooke_damping=np.broadcast_to(hooke_damping, count),
            material=np.broadcast_to(material, count),
            spring_active=np.ones(count, dtype=np.bool_),
            impulse=np.zeros((count, 2)),
            tension=np.zeros(count),
            edge=np.broadcast_to(edge, count),
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
        self._drop_elements(springs)

    def break_springs(self, springs: Slots) -> None:
        """Take springs out that broke by themselves: what is left of a body goes on with the energy that it has."""
        self.spring_active[springs] = False
        self.impulse[springs] = 0.0
        self.tension[springs] = 0.0
        self._drop_elements(springs)
        self.broken = springs

    def fit(self, driven: Driven, values: ArrayLike) -> None:
        """Give the world its driven parts, with the value (k,) of each, -1..1; done once, when the world is built."""
        self.driven = driven
        self.part_value = np.array(values, dtype=np.float64)

    def drive(self, part: int, value: float) -> None:
        """Drive a part, -1..1: a motor at that share of its speed, a hydraulic at that share of its rate."""
        self.part_value[part] = value

    def set_rest_lengths(self, springs: Slots, lengths: Floats) -> None:
        """Give springs other rest lengths [m]; what they yielded by stays what it was."""
        self.rest_length[springs] = lengths
        self.good["rest_length"][springs] = lengths

    def hold(self, hand: int, particle: int, target: tuple[float, float]) -> None:
        """Join a particle to a hand's cursor at target [m] by a spring of rest length 0: a mouse joint."""
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

    def name_slots(self, particles: Sequence[str], springs: Sequence[str]) -> None:
        """Name the slots that a restored state brought along, from the first one without a name on."""
        self._particles.append(particles)
        self._springs.append(springs)

    def name_hands(self) -> None:
        """Name the hands' slots, where a restored state brought them along."""
        self.name_slots(_hand_names(), _hand_names())

    def forget_names_beyond(self, particle_count: int, spring_count: int) -> None:
        """Drop the names of slots that a restored state does not have."""
        self._particles.forget_beyond(particle_count)
        self._springs.forget_beyond(spring_count)


def _hand_names() -> list[str]:
    return [f"+hand.{hand}" for hand in range(HAND_COUNT)]
