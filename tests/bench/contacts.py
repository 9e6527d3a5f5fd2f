"""Figures of contacts: piles and heaps that come to rest, and what they cost beside pymunk.

Run by hand: python -m tests.bench.contacts. Times are of the process, in milliseconds a tick; prints Markdown.
"""

import itertools
import statistics
import time
from collections.abc import Callable

import numpy as np
import pymunk

from sandbox.physics.energy import kinetic_energy
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from sandbox.physics.world import World
from tests.physics.contact_scenes import GROUND, add_discs, add_jelly, world

SECONDS = 10


def stack() -> World:
    """Eight jelly cubes of 10 x 10 particles on each other."""
    built = world(GROUND)
    for k in range(8):
        add_jelly(built, (0.02 * (-1) ** k, 0.5 + 0.96 * k), stiffness=0.99, damping=0.999)
    return built


def pile() -> World:
    """Thirty jelly cubes of 10 x 10 particles dropped into a pit."""
    built = world(Chain([(-4.0, 12.0), (-4.0, 0.0), (4.0, 0.0), (4.0, 12.0)]))
    generator = np.random.default_rng(3)
    for k in range(30):
        place = (-2.8 + 1.4 * (k % 5) + generator.uniform(-0.1, 0.1), 0.8 + 1.5 * (k // 5))
        add_jelly(built, place, angle=generator.uniform(0.0, 1.5))
    return built


def disc_places(count: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Places [m] (n, 2) and radii [m] (n,) of discs in shifted rows."""
    generator = np.random.default_rng(1)
    k = np.arange(count)
    x = -0.145 * columns + 0.29 * (k % columns) + 0.1 * (k // columns % 2) + generator.uniform(0.0, 0.05, count)
    return np.stack([x, 0.3 + 0.22 * (k // columns)], axis=1), generator.uniform(0.07, 0.1, count)


def heap(count: int, columns: int) -> World:
    """Loose discs dropped into a pit."""
    half = 0.15 * columns
    built = world(Chain([(-half, 15.0), (-half, 0.0), (half, 0.0), (half, 15.0)]))
    places, radii = disc_places(count, columns)
    add_discs(built, places, radius=radii, mass=100.0 * radii**2)
    return built


def pymunk_heap(count: int, columns: int) -> pymunk.Space:
    """The same heap, discs that do not turn, at pymunk's defaults."""
    space, half = pymunk.Space(), 0.15 * columns
    space.gravity = (0.0, -9.81)
    corners = [(-half, 15.0), (-half, 0.0), (half, 0.0), (half, 15.0)]
    shapes: list[pymunk.Shape] = [pymunk.Segment(space.static_body, a, b, 0.0) for a, b in itertools.pairwise(corners)]
    places, radii = disc_places(count, columns)
    for place, radius in zip(places.tolist(), radii.tolist(), strict=True):
        body = pymunk.Body(100.0 * radius**2, float("inf"))
        body.position = tuple(place)
        shapes.append(pymunk.Circle(body, radius))
        space.add(body)
    for shape in shapes:
        # pymunk multiplies the frictions of two surfaces.
        shape.friction = 0.5**0.5
    space.add(*shapes)
    return space


def times_of(tick: Callable[[], object], ticks: int) -> list[float]:
    """Time [ms] of each tick."""
    spent = []
    for _ in range(ticks):
        began = time.process_time()
        tick()
        spent.append(1e3 * (time.process_time() - began))
    return spent


def row(name: str, built: World, other: pymunk.Space | None = None) -> str:
    """Energy over its peak, overlap and creep after the time, and the ticks' times."""
    step(built)
    peak, spent, theirs = 0.0, [], []
    for _ in range(60 * SECONDS):
        spent += times_of(lambda: step(built), 1)
        if other is not None:
            theirs += times_of(lambda: other.step(1.0 / 60.0), 1)
        peak = max(peak, kinetic_energy(built))
    share, before = kinetic_energy(built) / peak, built.position.copy()
    times_of(lambda: step(built), 60)
    creep, overlap = 1e3 * float(np.abs(built.position - before).max()), -1e3 * float(built.contacts.gap.min())
    late = f"{np.quantile(spent, 0.95):.1f}"
    peer = f"{statistics.median(theirs):.1f}" if theirs else ""
    return f"| {name} | {share:.1e} | {overlap:.2f} | {creep:.3f} | {statistics.median(spent):.1f} | {late} | {peer} |"


def main() -> None:
    """Print the table."""
    print("| scene, 10 s | kinetic energy / peak | overlap [mm] | creep [mm/s] | tick [ms] | 95 % | pymunk [ms] |")
    print("|---|---|---|---|---|---|---|")
    print(row("stack of 8 jelly cubes", stack()), flush=True)
    print(row("pile of 30 jelly cubes", pile()), flush=True)
    print(row("heap of 500 discs", heap(500, 24), pymunk_heap(500, 24)), flush=True)
    print(row("heap of 2,000 discs", heap(2000, 40), pymunk_heap(2000, 40)), flush=True)


if __name__ == "__main__":
    main()
