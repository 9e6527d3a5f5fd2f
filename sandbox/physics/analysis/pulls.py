"""The pulls of hands, to be shown; no tick depends on them."""

from dataclasses import dataclass

import numpy as np

from sandbox.physics.marks import GRAB_MATERIAL
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.world import World

# A hand that pulls with this share of what it can is at its limit.
AT_LIMIT = 0.99


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
        """Whether it pulls as hard as it can."""
        return self.force >= AT_LIMIT * self.limit


def pulls_of(world: World) -> list[Pull]:
    """The pulls of the hands that hold something movable."""
    grips, pulls = block_of(world).arrays.joints.hands.grips, []
    for i, hand in enumerate(grips.hand.tolist()):
        x, y = world.hand_force[hand].tolist()
        particle = int(world.particle_b[grips.spring[i]])
        limit = float(world.hand_strength[hand] * grips.mass[i])
        pinned = particle in _joined_to_pins(world)
        # What is clamped may be above by a rounding.
        force = min(float(np.hypot(x, y)), limit)
        pulls.append(Pull(int(grips.cursor[i]), particle, force, limit, pinned))
    return pulls


def _joined_to_pins(world: World) -> frozenset[int]:
    return world.derived(_find_joined, of_hands=False)


def _find_joined(world: World) -> frozenset[int]:
    """The particles of all bodies that springs join to something pinned."""
    free, label = world.inverse_mass > 0.0, block_of(world).arrays.body_label
    joins = world.spring_active & (world.material != GRAB_MATERIAL)
    a, b = world.particle_a[joins], world.particle_b[joins]
    bodies = np.concatenate([label[a[free[a] & ~free[b]]], label[b[free[b] & ~free[a]]]])
    return frozenset(np.flatnonzero(np.isin(label, bodies) | ~free).tolist())
