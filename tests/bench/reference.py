"""The field's reference scenes with the direct solver, and the figure that each is known for, as one Markdown table.

Run by hand: python -m tests.bench.reference. Sources: Nissen's demo programs, Solver2D, Rapier, the AVBD demo, and
Müller's bead on a wire.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.physics.analysis.energy import kinetic_energy, spring_energy
from sandbox.physics.analysis.query import load_bearing, strain
from sandbox.physics.snapshot import take
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.bench.scenes import Scene, lattice, total_energy


@dataclass(frozen=True)
class Reference:
    """A scene, how it starts, for how long it runs [s] and from when strain is measured [s], and the field's figure."""

    name: str
    build: Callable[[], World]
    seconds: float
    measured_from: float
    known: str


def chain(masses, link: float = 1.0, *, level: bool = True, stretched: float = 1.0, gravity: float = 9.81) -> World:
    """A chain of these masses [kg] on links of one length [m], pinned at its start, placed longer than it is or not."""
    count = len(masses)
    along = link * stretched * np.arange(count)
    position = np.stack([along, np.zeros(count)] if level else [np.zeros(count), -along], axis=1)
    links = np.array([(k, k + 1) for k in range(count - 1)])
    scene = Scene("chain", position, np.array(masses, dtype=float), np.arange(count) == 0, links)
    world = scene.world(gravity=(0.0, -gravity))
    world.rest_length[:] = link
    return world


def random_chain() -> World:
    """96 particles of a chain anywhere within 1,000 m, at any velocity within 1,000 m/s."""
    world = chain(np.ones(96), 10.0)
    generator = np.random.default_rng(96)
    world.position[1:] = generator.uniform(-1000.0, 1000.0, (95, 2))
    world.velocity[1:] = generator.uniform(-1000.0, 1000.0, (95, 2))
    world.slow_velocity[:] = world.velocity
    world.trust()
    return world


def plank_bridge(links: int = 160) -> World:
    """A chain between two pins, level, as long as their distance."""
    world = chain(np.ones(links + 1), 0.5)
    world.pin(links)
    return world


REFERENCES = (
    Reference("wrecking ball, 12 links of 30 m, 1000:1", lambda: chain([*[1.0] * 12, 1000.0], 30.0, gravity=20.0),
              10, 0, "3.8 % at N = 10 (Nissen)"),
    Reference("chain of masses doubling to 1024", lambda: chain([2.0**k for k in range(11)], 10.0), 10, 0,
              "7 % at N = 10 (Nissen)"),
    Reference("96 particles from a random state", random_chain, 20, 18, "recovers (Nissen)"),
    Reference("bridge of 160 links", plank_bridge, 10, 2, "by eye (Solver2D)"),
    Reference("grid 100x100 hung by a corner", lambda: lattice(100).world(), 2, 1, "by eye (Solver2D)"),
    Reference("40 links stretched to twice their length", lambda: chain(np.ones(41), 0.5, stretched=2.0), 10, 1,
              "by eye (Solver2D)"),
    Reference("17 bodies, end 1000:1", lambda: chain([*[1.0] * 17, 1000.0]), 10, 0, "a threshold (Rapier)"),
    Reference("20 links, end 1800:1", lambda: chain([*[1.0] * 20, 1800.0]), 10, 0, "10 iterations (AVBD)"),
    Reference("50 links hanging, end 200:1", lambda: chain([*[1.0] * 50, 200.0], level=False), 10, 0,
              "10 iterations (AVBD)"),
    Reference("rope of 100 links, end 1000:1, swinging", lambda: chain([*[1.0] * 100, 1000.0], 0.1), 10, 0,
              "2.5 % (100 XPBD substeps)"),
    Reference("rope of 100 links, end 1000:1, vertical", lambda: chain([*[1.0] * 100, 1000.0], 0.1, level=False), 10, 0,
              "0.59 % (100 XPBD substeps)"),
)  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """Largest and RMS strain over the measured time; the most energy gained, as a share of the energy in play."""

    largest: float
    rms: float
    gained: float
    finite: bool


def run(reference: Reference) -> Outcome:
    """Run a reference scene and measure."""
    world = reference.build()
    start, squares, largest = total_energy(world), [], 0.0
    energies, in_play = [start], kinetic_energy(world) + spring_energy(world)
    for tick in range(round(60 * reference.seconds)):
        step(world)
        energies.append(total_energy(world))
        in_play = max(in_play, kinetic_energy(world))
        if tick >= 60 * reference.measured_from:
            size = np.abs(strain(world)[load_bearing(world)])
            largest = max(largest, float(size.max()))
            squares.append(float(np.mean(size * size)))
    finite = bool(np.isfinite(take(world).position).all()) and not world.contained
    return Outcome(largest, math.sqrt(float(np.mean(squares))), (max(energies) - start) / in_play, finite)


def rows() -> Iterator[str]:
    """The table, line by line."""
    yield "| scene | largest strain | RMS strain | energy gained | known for |"
    yield "|---|---|---|---|---|"
    for reference in REFERENCES:
        outcome = run(reference)
        figures = f"{outcome.largest:.3%} | {outcome.rms:.4%} | {outcome.gained:.3%}"
        yield f"| {reference.name} | {figures} | {reference.known} |"


if __name__ == "__main__":
    for row in rows():
        print(row, flush=True)
