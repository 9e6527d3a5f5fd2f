"""The scenes on which solvers and engines are compared: particles, pins and rigid links, as plain arrays."""

from dataclasses import dataclass

import numpy as np

from sandbox.physics.analysis.energy import gravity_energy, kinetic_energy, spring_energy
from sandbox.physics.analysis.query import load_bearing, strain
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.settings import WorldSettings
from sandbox.physics.world import World

LINK = 0.1
GRAVITY = 9.81


@dataclass(frozen=True)
class Scene:
    """Positions [m] (n, 2), masses [kg] (n,), pins (n,), links (m, 2) between particles, of their placed length."""

    name: str
    position: Floats
    mass: Floats
    pinned: np.ndarray
    links: Slots

    def world(self, *, stiffness: float = 1.0, damping: float = 1.0, **settings) -> World:
        """The scene as a world of springs."""
        world = World(WorldSettings(**{"solver": "direct", "gravity": (0.0, -GRAVITY), **settings}))
        names = [f"p.{k}" for k in range(len(self.mass))]
        world.add_particles(names, self.position, mass=self.mass, pinned=self.pinned)
        names = [f"p:{k}" for k in range(len(self.links))]
        world.add_springs(names, self.links[:, 0], self.links[:, 1], stiffness=stiffness, damping=damping)
        return world


def _scene(name, position, links, pinned, heavy=()) -> Scene:
    position = np.asarray(position, dtype=np.float64)
    mass = np.ones(len(position))
    for slot, kilograms in heavy:
        mass[slot] = kilograms
    return Scene(name, position, mass, np.isin(np.arange(len(mass)), pinned), np.asarray(links, dtype=np.int64))


def rope(count: int, end_mass: float = 1.0, *, vertical: bool = False) -> Scene:
    """A rope of `count` links, pinned at its start, level or hanging."""
    along = LINK * np.arange(count + 1)
    across = np.zeros(count + 1)
    position = np.stack([across, -along] if vertical else [along, across], axis=1)
    links = [(k, k + 1) for k in range(count)]
    name = f"rope {count}" if end_mass == 1.0 else f"rope {count}, end {end_mass:g}:1"
    return _scene(name, position, links, [0], [(count, end_mass)])


def bridge(segments: int = 40, load: float = 100.0) -> Scene:
    """A truss bridge, both rows pinned at both ends, with a load in the middle of its top row."""
    width = segments + 1
    top = [(0.25 * k, 0.5) for k in range(width)]
    bottom = [(0.25 * k, 0.0) for k in range(width)]
    links = [(k, k + 1) for k in range(segments)] + [(width + k, width + k + 1) for k in range(segments)]
    links += [(k, width + k) for k in range(width)]
    links += [link for k in range(segments) for link in ((k, width + k + 1), (k + 1, width + k))]
    ends = [0, segments, width, width + segments]
    return _scene(f"bridge {segments}, load {load:g}:1", top + bottom, links, ends, [(segments // 2, load)])


def lattice(side: int, *, hung: bool = True) -> Scene:
    """A square of side x side particles with diagonals, hung from its top left corner, or free."""
    position = [(LINK * x, LINK * y) for y in range(side) for x in range(side)]
    links = []
    for y in range(side):
        for x in range(side):
            for right, up in ((1, 0), (0, 1), (1, 1), (-1, 1)):
                if 0 <= x + right < side and y + up < side:
                    links.append((y * side + x, (y + up) * side + x + right))
    return _scene(f"lattice {side}x{side}", position, links, [side * (side - 1)] if hung else [])


def joint_grid(side: int = 100) -> Scene:
    """A net that hangs by seven pins in the middle of its top row: Box2D's benchmark scene."""
    position = [(LINK * x, -LINK * y) for y in range(side) for x in range(side)]
    right = [(y * side + x, y * side + x + 1) for y in range(side) for x in range(side - 1)]
    down = [(y * side + x, y * side + x + side) for y in range(side - 1) for x in range(side)]
    pins = range(side // 2 - 3, side // 2 + 4)
    return _scene(f"joint grid {side}x{side}", position, right + down, list(pins))


def blocks(count: int = 500, side: int = 4) -> Scene:
    """Separate small lattices in a row, in free fall."""
    one = lattice(side, hung=False)
    particles = len(one.mass)
    position = np.concatenate([one.position + np.array([2.0 * LINK * side * k, 0.0]) for k in range(count)])
    links = np.concatenate([one.links + particles * k for k in range(count)])
    return _scene(f"{count} blocks {side}x{side}", position, links, [])


def bench_scenes() -> list[Scene]:
    """The scenes of the table against other engines."""
    return [rope(100), rope(50, 1000.0), bridge(), rope(1000), lattice(32), blocks()]


def square_strains(world: World) -> Floats:
    """Squares of the strain of every spring that bears load."""
    return strain(world)[load_bearing(world)] ** 2


def total_energy(world: World) -> float:
    """Kinetic, spring and gravity energy [J], the last at x - h v / 2: symplectic Euler keeps that sum in free fall."""
    h = 1.0 / (world.settings.tick_rate * world.settings.fewest_substeps)
    free = world.inverse_mass > 0.0
    momentum = np.sum(world.mass[free, None] * world.velocity[free], axis=0)
    half = float(np.sum(momentum * np.asarray(world.settings.gravity))) * 0.5 * h
    return kinetic_energy(world) + spring_energy(world) + gravity_energy(world) + half


def swing_energy(scene: Scene) -> float:
    """Energy [J] that a rope gives off from level to hanging straight down."""
    return float(GRAVITY * np.sum(scene.mass * np.sqrt(np.sum((scene.position - scene.position[0]) ** 2, axis=1))))
