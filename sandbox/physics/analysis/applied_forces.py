"""What pushed, turned and pulled in the last step, for who looks on: contacts, motors, hands; no tick reads it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.geometry.segment import lengths, nearest_on_segments
from sandbox.physics.marks import DISC, EDGE, GRAB_MATERIAL, INSIDE, KINDS, LINE, SOLID_RIGHT, TERRAIN, TIP, TIP_SHIFT
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.substeps import substep_time
from sandbox.physics.world import World

# A motor that uses this share of its torque is at its limit.
MOTOR_AT_LIMIT = 0.999
# A hand that pulls with this share of what it can is at its limit.
HAND_AT_LIMIT = 0.99


class ContactPoints(NamedTuple):
    """Contacts of the last step: slot of the particle (k,), point [m], normal towards it and force on it [N] (k, 2)."""

    particle: Slots
    point: Floats
    normal: Floats
    force: Floats


@np.errstate(over="ignore", invalid="ignore")
def contact_points(state: World | Snapshot, position: Floats | None = None) -> ContactPoints:
    """The contacts that a state keeps of its last step; position (n, 2) [m]: where particles are, None = as they are.

    Contacts with something that is gone are left out. force is the mean one of the step, that of impacts over the tick.
    """
    position = state.position if position is None else position
    kind, number = state.contact_feature % KINDS, state.contact_feature // KINDS
    chosen = (state.contact_particle >= 0) & (state.contact_particle < len(position))
    last = np.where(
        kind == DISC,
        len(position),
        np.where((kind == EDGE) | (kind == INSIDE), len(state.edge), len(state.terrain.edge_a)),
    )
    last = np.where(kind == TIP, len(state.terrain.vertex) * TIP_SHIFT, last)
    chosen &= (number < last) & ((kind != TIP) | (number % TIP_SHIFT < len(state.edge)))
    kind, number, particle = kind[chosen], number[chosen], state.contact_particle[chosen].astype(np.int64)
    impulse = state.contact_impulse[chosen]
    start, end, is_solid = _features(state, position, kind, number)
    centre = position[particle]
    tips = np.flatnonzero(kind == TIP)
    # The edge pushes against the corner; what is said is how the corner pushes the edge.
    centre[tips] = state.terrain.vertex[number[tips] // TIP_SHIFT]
    fraction, away = nearest_on_segments(centre, start, end)
    # Right of the way along an edge is outside of what is solid.
    outward = np.stack([end[:, 1] - start[:, 1], start[:, 0] - end[:, 0]], axis=1)
    beside = (fraction > 0.0) & (fraction < 1.0)
    side = np.where(is_solid | (np.sum(outward * away, axis=1) >= 0.0), 1.0, -1.0)
    normal = _unit(np.where(beside[:, None], side[:, None] * outward, away))
    normal[tips] *= -1.0
    radius = np.where(kind == TIP, 0.0, 1.0) * np.where(
        kind == DISC, state.radius[particle], np.minimum(state.radius[particle], lengths(away))
    )
    # An impact's is that of a tick, beside what a step pushes.
    impact = state.contact_impact[chosen, None] * state.settings.tick_rate * substep_time(state.settings)
    along_normal, across = impulse[:, :1] + impact, impulse[:, 1:]
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    force = (along_normal * normal + across * tangent) / substep_time(state.settings)
    return ContactPoints(particle, centre - radius[:, None] * normal, normal, force)


def _features(
    state: World | Snapshot, position: Floats, kind: Slots, number: Slots
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Start and end [m] (k, 2) of the features of contacts, and whether they are solid on the left (k,)."""
    start, end = np.zeros((2, len(kind), 2))
    is_solid = np.zeros(len(kind), dtype=np.bool_)
    discs, edges, ground = (
        np.flatnonzero(each)
        for each in (kind == DISC, (kind == EDGE) | (kind == INSIDE) | (kind == TIP), kind == TERRAIN)
    )
    start[discs] = end[discs] = position[number[discs]]
    springs = np.where(kind[edges] == TIP, number[edges] % TIP_SHIFT, number[edges])
    swapped = state.edge[springs] == SOLID_RIGHT
    first, last = state.particle_a[springs], state.particle_b[springs]
    start[edges] = position[np.where(swapped, last, first)]
    end[edges] = position[np.where(swapped, first, last)]
    is_solid[edges] = state.edge[springs] > LINE
    terrain = state.terrain
    start[ground] = terrain.vertex[terrain.edge_a[number[ground]]]
    end[ground] = terrain.vertex[terrain.edge_b[number[ground]]]
    is_solid[ground] = terrain.solid[number[ground]]
    return start, end, is_solid


def _unit(vectors: Floats) -> Floats:
    """Vectors (k, 2) of length 1; upward where they have none."""
    length = lengths(vectors)[:, None]
    up = np.broadcast_to(np.array([0.0, 1.0]), vectors.shape)
    return np.where(length > 0.0, np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0), up)


def overlapping(world: World) -> list[tuple[int, int]]:
    """The pairs of bodies that lay in each other in the last step, by a particle of each; twice the same: in itself.

    Lines that cross lines do not count.
    """
    if not world.has_contacts:
        return []
    collisions = block_of(world).arrays.collisions
    outline, colliders = collisions.outline, collisions.colliders
    shapes = colliders.parted[: colliders.parted_count[0], :2]
    first = outline.member[outline.member_start[:-1]]
    is_solid = outline.solid_of >= 0
    return [(int(first[s]), int(first[t])) for s, t in shapes.tolist() if is_solid[s] or is_solid[t]]


class MotorReading(NamedTuple):
    """A motor's name, the torque that it gave in the last step [N m], the most that it has, and whether it can act.

    pushes: its wheel is on its hub, and there is something to push against.
    """

    name: str
    torque: float
    limit: float
    pushes: bool

    @property
    def share(self) -> float:
        """The fraction of its largest torque that the motor gives, 0..1."""
        return abs(self.torque) / self.limit if self.limit > 0.0 else 0.0

    @property
    def at_limit(self) -> bool:
        """Whether the motor gives its largest torque: with more load it falls behind its speed or stalls."""
        return self.share >= MOTOR_AT_LIMIT


def motor_readings(world: World) -> list[MotorReading]:
    """The reading of every motor, in the order of a world's motors."""
    motors, joints = world.actuators.motors, block_of(world).arrays.joints
    # What is kept is that of a substep, with "auto" as if the tick were one.
    h = substep_time(world.settings)
    first = joints.rows.first
    return [
        MotorReading(
            world.actuators.names[part],
            float(world.actuator_impulse[part]) / h,
            float(motors.torque[k]),
            bool(first[k] < first[k + 1]),
        )
        for k, part in enumerate(motors.part.tolist())
    ]


@dataclass(frozen=True)
class Pull:
    """The pull of a hand in the last tick.

    cursor: its slot; particle: the one that it holds; force, limit [N]; pinned: the held body has a pinned particle.
    """

    cursor: int
    particle: int
    force: float
    limit: float
    pinned: bool

    @property
    def at_limit(self) -> bool:
        """Whether the grab pulls as hard as it can."""
        return self.force >= HAND_AT_LIMIT * self.limit


def pulls_of(world: World) -> list[Pull]:
    """The pulls of the hands that hold something movable."""
    grips, pulls = block_of(world).arrays.joints.hands.grips, []
    for i, hand in enumerate(grips.hand.tolist()):
        x, y = world.hand_force[hand].tolist()
        particle = int(world.particle_b[grips.spring[i]])
        limit = float(world.hand_strength[hand] * grips.mass[i])
        pinned = particle in world.derived(_joined_to_pins, of_hands=False)
        # What is clamped may be above by a rounding.
        force = min(float(np.hypot(x, y)), limit)
        pulls.append(Pull(int(grips.cursor[i]), particle, force, limit, pinned))
    return pulls


def _joined_to_pins(world: World) -> frozenset[int]:
    """The particles of all bodies that springs join to something pinned."""
    free, label = world.inverse_mass > 0.0, block_of(world).arrays.body_label
    joins = world.spring_active & (world.material != GRAB_MATERIAL)
    a, b = world.particle_a[joins], world.particle_b[joins]
    bodies = np.concatenate([label[a[free[a] & ~free[b]]], label[b[free[b] & ~free[a]]]])
    return frozenset(np.flatnonzero(np.isin(label, bodies) | ~free).tolist())
