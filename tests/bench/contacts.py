"""Figures of contacts and their limits: what comes to rest and what that costs beside pymunk, energy, tunnelling.

Run by hand: python -m tests.bench.contacts. Times are of the process, in milliseconds a tick. Prints Markdown; exit
code 1 where a limit is broken.
"""

import functools
import itertools
import math
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pymunk

from sandbox.physics import jit
from sandbox.physics.analysis.energy import kinetic_energy
from sandbox.physics.pipeline.block_owner import outline_of
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from sandbox.physics.world import World
from tests.support.contact_scenes import GROUND, add_chain, add_discs, add_jelly, world
from tests.support.contacts import last_contacts

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


def disc_places(
    count: int, columns: int, seed: int = 1, radii: tuple[float, float] = (0.07, 0.1)
) -> tuple[np.ndarray, np.ndarray]:
    """Places [m] (n, 2) and radii [m] (n,) of discs in shifted rows."""
    generator = np.random.default_rng(seed)
    k = np.arange(count)
    x = -0.145 * columns + 0.29 * (k % columns) + 0.1 * (k // columns % 2) + generator.uniform(0.0, 0.05, count)
    return np.stack([x, 0.3 + 0.22 * (k // columns)], axis=1), generator.uniform(*radii, count)


def heap(
    count: int, columns: int, seed: int = 1, radii: tuple[float, float] = (0.07, 0.1), spread: float | None = None
) -> World:
    """Loose discs dropped into a pit; spread: masses are 10^-spread..10^spread kg, else as the areas."""
    half = 0.15 * columns
    built = world(Chain([(-half, 15.0), (-half, 0.0), (half, 0.0), (half, 15.0)]))
    places, radius = disc_places(count, columns, seed, radii)
    powers = np.random.default_rng(seed).uniform(-1.0, 1.0, count)
    add_discs(built, places, radius=radius, mass=100.0 * radius**2 if spread is None else 10.0 ** (spread * powers))
    return built


def pymunk_heap(count: int, columns: int) -> pymunk.Space:
    """The same heap, of discs that turn as well, at pymunk's defaults."""
    space, half = pymunk.Space(), 0.15 * columns
    space.gravity = (0.0, -9.81)
    corners = [(-half, 15.0), (-half, 0.0), (half, 0.0), (half, 15.0)]
    shapes: list[pymunk.Shape] = [pymunk.Segment(space.static_body, a, b, 0.0) for a, b in itertools.pairwise(corners)]
    places, radii = disc_places(count, columns)
    for place, radius in zip(places.tolist(), radii.tolist(), strict=True):
        mass = 100.0 * radius**2
        body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0.0, radius))
        body.position = tuple(place)
        shapes.append(pymunk.Circle(body, radius))
        space.add(body)
    for shape in shapes:
        # pymunk multiplies the frictions of two surfaces.
        shape.friction = 0.5**0.5
    space.add(*shapes)
    return space


def time_of(tick: Callable[[], object], ticks: int) -> float:
    """Time [ms] of a tick among so many, which are too short for the clock one by one."""
    began = time.process_time()
    for _ in range(ticks):
        tick()
    return 1e3 * (time.process_time() - began) / ticks


def times_of(tick: Callable[[], object], ticks: int) -> list[float]:
    """Time [ms] of each tick."""
    spent = []
    for _ in range(ticks):
        began = time.process_time()
        tick()
        spent.append(1e3 * (time.process_time() - began))
    return spent


class Table:
    """Rows of figures with their limits; whether any is broken."""

    broken = False

    def add(self, name: str, *figures: tuple[str, float, float]) -> None:
        """Print a row: of each figure what it is, its value and the most that it may be."""
        cells = []
        for what, value, most in figures:
            self.broken = self.broken or not value <= most
            limit = "" if most == math.inf else f" (at most {most:g}{'' if value <= most else ', BROKEN'})"
            cells.append(f"{what} {value:.3g}{limit}")
        print(f"| {name} | {'; '.join(cells)} |", flush=True)


def settles(table: Table, name: str, built: World, other: pymunk.Space | None = None, most_time: float = 16.6) -> None:
    """What is left at the end: energy over its peak, overlap over the smaller radius, creep; and the time of a tick."""
    step(built)
    peak, spent, theirs = 0.0, [], []
    for _ in range(60 * SECONDS):
        spent += times_of(lambda: step(built), 1)
        if other is not None:
            theirs += times_of(lambda: other.step(1.0 / 60.0), 1)
        peak = max(peak, kinetic_energy(built))
    share, contacts = kinetic_energy(built) / peak, last_contacts(built)
    smaller = np.where(contacts.end_a < 0, np.inf, built.radius[contacts.end_a])
    deepest = float(np.max(-contacts.gap / np.minimum(built.radius[contacts.particle], smaller), initial=0.0))
    before = built.position.copy()
    times_of(lambda: step(built), 60)
    creep, median = 1e3 * float(np.abs(built.position - before).max()), statistics.median(spent)
    peer = (("over pymunk's", median / statistics.median(theirs), 1.5),) if theirs else ()
    table.add(
        name, ("energy / peak", share, 1e-4), ("overlap / radius", deepest, 0.05), ("creep [mm/s]", creep, 1.0),
        ("tick [ms]", median, most_time), ("95 % [ms]", float(np.quantile(spent, 0.95)), math.inf), *peer,
    )  # fmt: skip


@contextmanager
def counted_entries(spent: list[float]) -> Iterator[None]:
    """Add the calls of compiled kernels that Python makes, and their time [ms], to spent meanwhile."""
    entries = {id(entry.held) for entry in jit.entries()}
    modules = [module for name, module in sys.modules.items() if name.startswith("sandbox.physics.")]
    held = [(module, name, item) for module in modules for name, item in vars(module).items() if id(item) in entries]

    def call(entry: Callable[..., object], *arguments: object) -> object:
        began = time.process_time()
        result = entry(*arguments)
        spent[1] += 1e3 * (time.process_time() - began)
        spent[0] += 1
        return result

    for module, name, item in held:
        setattr(module, name, functools.partial(call, item))
    try:
        yield
    finally:
        for module, name, item in held:
            setattr(module, name, item)


def costs(table: Table, count: int, columns: int, substeps: int, most: float) -> None:
    """A tick of a heap at rest over as many steps of pymunk, run in turns; kernels called in it, Python's share of it.

    Best of blocks of some ticks: what else the machine does makes each longer.
    """
    built, other = heap(count, columns), pymunk_heap(count, columns)
    built.settings = replace(built.settings, substeps=substeps)
    for _ in range(400):
        step(built)
        other.step(1.0 / 60.0)
    block, ours, theirs = max(1, 200 // count), [], []
    for _ in range(40):
        ours.append(time_of(lambda: step(built), block))
        theirs.append(substeps * time_of(lambda: other.step(1.0 / 60.0 / substeps), block * substeps))
    ticks, spent = 20 * block, [0.0, 0.0]
    whole = ticks * time_of(lambda: step(built), ticks)
    with counted_entries(spent):
        time_of(lambda: step(built), ticks)
    table.add(
        f"heap of {count:,} discs at rest, {substeps} substep{'s' if substeps > 1 else ''}",
        ("over pymunk's", min(ours) / min(theirs), most),
        ("median", statistics.median(ours) / statistics.median(theirs), math.inf), ("tick [ms]", min(ours), math.inf),
        ("kernels called", spent[0] / ticks, math.inf), ("Python's share", 1.0 - spent[1] / whole, math.inf),
    )  # fmt: skip


def stands(table: Table) -> None:
    """How far the top of a stack is from its place after 30 s, and how fast it sways in the tenth and thirtieth."""
    built, sways = stack(), []
    for _ in range(30):
        before = built.position.copy()
        times_of(lambda: step(built), 60)
        sways.append(1e3 * float(np.abs(built.position - before).max()))
    away = float(np.abs(built.position[-100:].mean(axis=0) - (0.0, 7.1)).max())
    table.add(
        "stack of 8 jelly cubes, 30 s", ("top away [m]", away, 0.2), ("sway in the 10th [mm/s]", sways[9], math.inf),
        ("in the 30th [mm/s]", sways[29], 1.0),
    )  # fmt: skip


def boxes(table: Table) -> None:
    """Discs of masses 1e-2..1e2 at 20 m/s in closed boxes: the largest rise of energy in a tick over the start."""
    for restitution in (0.0, 0.5, 1.0):
        rise = 0.0
        for seed in range(3):
            generator = np.random.default_rng(seed)
            built = world(Chain([(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)], "hollow"), gravity=(0.0, 0.0))
            k = np.arange(60)
            add_discs(
                built, np.stack([-1.6 + 0.45 * (k % 8), -1.6 + 0.45 * (k // 8)], axis=1),
                radius=generator.uniform(0.05, 0.16, 60), mass=10.0 ** generator.uniform(-2.0, 2.0, 60),
                velocity=20.0 * generator.normal(size=(60, 2)), restitution=restitution,
            )  # fmt: skip
            start = energy = kinetic_energy(built)
            for _ in range(300):
                step(built)
                rise, energy = max(rise, (kinetic_energy(built) - energy) / start), kinetic_energy(built)
        table.add(f"closed boxes, restitution {restitution:g}", ("rise / start", rise, 1e-12))


def is_inside(outline: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether each of the points (k, 2) is inside a polygon (m, 2)."""
    x, y = points[:, :1], points[:, 1:]
    a, b = outline, np.roll(outline, -1, axis=0)
    crossed = (a[:, 1] <= y) != (b[:, 1] <= y)
    rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
    return ((crossed & (x < a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0]))).sum(axis=1) % 2).astype(bool)


def tunnels(table: Table, tries: int = 1000, at_once: int = 50) -> None:
    """Chains of balls at 100 m/s onto jellies, from anywhere: how many are inside one 40 ticks later."""
    inside, longest = 0, 0
    for seed in range(tries // at_once):
        generator, built = np.random.default_rng(seed), world()
        jellies, chains = [], []
        for k in range(at_once):
            angle = generator.uniform(0.0, math.tau)
            way = np.array([math.cos(angle), math.sin(angle)])
            aside = generator.uniform(-0.3, 0.3) * np.array([-way[1], way[0]])
            size = (0.5, float(generator.choice([0.2, 0.5, 1.0])))
            jellies.append(add_jelly(built, (12.0 * k, 0.0), size=size, angle=generator.uniform(0.0, math.tau)))
            start = (12.0 * k, 0.0) - generator.uniform(2.2, 3.5) * way + aside
            chains.append(add_chain(built, generator, start, tuple(100.0 * way)))
        outlines = [_outline(built, jelly) for jelly in jellies]
        held = np.zeros(at_once, dtype=np.int64)
        for _ in range(40):
            step(built)
            for k in range(at_once):
                deep = is_inside(built.position[outlines[k]], built.position[chains[k]]).any()
                held[k] = held[k] + 1 if deep else 0
            longest = max(longest, int(held.max()))
        inside += int(np.count_nonzero(held))
    table.add(f"{tries} chains of balls at 100 m/s onto jellies", ("inside at the end", inside, 0),
              ("longest inside [ticks]", longest, math.inf))  # fmt: skip


def _outline(built: World, jelly: slice) -> list[int]:
    shape = outline_of(built)
    after = {a: b for a, b in zip(shape.edge_a.tolist(), shape.edge_b.tolist(), strict=True)
             if jelly.start <= a < jelly.stop}  # fmt: skip
    around = [jelly.start]
    while after[around[-1]] != jelly.start:
        around.append(after[around[-1]])
    return around


def main() -> int:
    """Print the table; 1 where a limit is broken."""
    table = Table()
    print("| scene | figures |\n|---|---|")
    for count, columns, most in ((5, 3, 2.0), (20, 6, 1.2), (100, 12, 1.5), (500, 24, 1.5), (2000, 40, 1.5)):
        for substeps in (1, 4):
            costs(table, count, columns, substeps, most)
    settles(table, "heap of 2,000 discs", heap(2000, 40), pymunk_heap(2000, 40))
    for seed in range(1, 6):
        settles(table, f"heap of 500 discs, seed {seed}", heap(500, 24, seed))
    settles(table, "heap of 500 discs, radii 0.04..0.12 m", heap(500, 24, 1, (0.04, 0.12)))
    settles(table, "heap of 500 discs, masses 0.1..10 kg", heap(500, 24, 1, spread=1.0))
    settles(table, "pile of 30 jelly cubes", pile())
    stands(table)
    boxes(table)
    tunnels(table)
    return int(table.broken)


if __name__ == "__main__":
    sys.exit(main())
