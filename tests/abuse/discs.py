"""Discs that roll, at length: slopes, crowds, heaps. Tests take a seeded sample of each.

Run by hand: python -m tests.abuse.discs. Prints a line for each; exit code 1 where a limit is broken.
"""

import argparse
import itertools
import math
import sys

import numpy as np

from sandbox.physics.analysis.energy import kinetic_energy
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.state import ROLLING_RESISTANCE
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain
from sandbox.physics.world import World
from tests.support.contact_scenes import add_discs, world
from tests.support.limits import Limits

GRAVITY = 9.81
RADIUS = 0.1


def rolled(degrees: float, friction: float, seconds: float = 1.0, **settings: object) -> tuple[float, float]:
    """Acceleration and that of the surface [m/s^2] of a disc that starts at rest on a slope down to the right."""
    angle = math.radians(degrees)
    along, across = np.array([math.cos(angle), -math.sin(angle)]), np.array([math.sin(angle), math.cos(angle)])
    built = world(Chain([-along, 400.0 * along], friction=friction), **settings)
    add_discs(built, [RADIUS * across], radius=RADIUS, friction=friction)
    for _ in range(round(seconds * built.settings.tick_rate)):
        step(built)
    return float(built.velocity[0] @ along) / seconds, float(-built.spin[0] * RADIUS) / seconds


def expected(degrees: float, friction: float) -> tuple[float, float]:
    """The same of a disc by the book: it rolls up to a slope of 3 mu, else it slides and turns as friction says.

    Rolling resistance counts where it slides: a hundredth of a friction of 0.1.
    """
    angle = math.radians(degrees)
    down, push = GRAVITY * math.sin(angle), GRAVITY * math.cos(angle)
    if math.tan(angle) <= 3.0 * friction:
        return 2.0 / 3.0 * down, 2.0 / 3.0 * down
    return down - friction * push, 2.0 * (friction - ROLLING_RESISTANCE) * push


def crowd(count: int, seed: int, speed: float, restitution: float, friction: float = 0.6) -> World:
    """Turning discs of very unequal mass that fly at each other in empty space."""
    generator = np.random.default_rng(seed)
    built = world(gravity=(0.0, 0.0))
    side = math.ceil(math.sqrt(count))
    k = np.arange(count)
    places = 0.25 * np.stack([k % side, k // side], axis=1) + generator.uniform(-0.02, 0.02, (count, 2)) + 20.0
    velocity = speed * (places.mean(axis=0) - places + generator.normal(0.0, 0.5, (count, 2)) + [1.0, -0.5])
    add_discs(
        built, places, radius=generator.uniform(0.06, 0.11, count), mass=10.0 ** generator.uniform(-1.0, 1.0, count),
        velocity=velocity, spin=generator.normal(0.0, 5.0, count), restitution=restitution, friction=friction,
    )  # fmt: skip
    return built


def angular_momentum(built: World) -> float:
    """About the origin [N m s], the discs' own included."""
    x, y = built.position.T
    u, v = built.velocity.T
    return float(np.sum(built.mass * (x * v - y * u + 0.5 * built.radius**2 * built.spin)))


def turning(built: World) -> float:
    """What of the angular momentum about the centre of mass turns one way or the other [N m s]."""
    mass = built.mass[:, None]
    x, y = (built.position - np.sum(mass * built.position, axis=0) / mass.sum()).T
    u, v = (built.velocity - np.sum(mass * built.velocity, axis=0) / mass.sum()).T
    return float(np.sum(built.mass * np.abs(x * v - y * u) + 0.5 * built.mass * built.radius**2 * np.abs(built.spin)))


def lost_turning(built: World, ticks: int) -> tuple[float, float]:
    """Largest change of a crowd's angular momentum, in shares of what turns, and its most energy over that at first."""
    first, whole, energy = angular_momentum(built), turning(built), kinetic_energy(built)
    worst, most = 0.0, 0.0
    for _ in range(ticks):
        step(built)
        worst = max(worst, abs(angular_momentum(built) - first))
        most = max(most, kinetic_energy(built))
    return worst / whole, most / energy


def heap(count: int, columns: int, seed: int, rolling: float = 1e-3) -> World:
    """Discs that fall into a box."""
    generator = np.random.default_rng(seed)
    half = 0.12 * columns
    built = world(Chain([(-half, 30.0), (-half, 0.0), (half, 0.0), (half, 30.0)]))
    k = np.arange(count)
    places = np.stack([0.21 * (k % columns + 0.5) - 0.105 * columns, 0.2 + 0.21 * (k // columns)], axis=1)
    radius = generator.uniform(0.07, 0.1, count)
    add_discs(
        built, places + generator.uniform(-0.01, 0.01, places.shape), radius=radius, mass=100.0 * radius**2,
        rolling=rolling,
    )  # fmt: skip
    return built


def fastest(built: World) -> float:
    """The fastest motion of any disc's centre or surface [m/s]."""
    return float(max(np.abs(built.velocity).max(), np.abs(built.spin * built.radius).max()))


def main(arguments: list[str] | None = None) -> int:
    """Print the figures; 1 where one is beyond its limit."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--all", action="store_true", help="the usual")
    parser.parse_args(arguments)
    limits = Limits()
    for solver, substeps in itertools.product(SOLVERS, (1, 4)):
        worst = 0.0
        for degrees, friction in itertools.product((10, 15, 20, 30, 40, 50, 60), (0.1, 0.19, 0.2, 0.5, 1.0)):
            if abs(math.tan(math.radians(degrees)) / (3.0 * friction) - 1.0) < 0.02:
                continue
            found, wanted = rolled(degrees, friction, solver=solver, substeps=substeps), expected(degrees, friction)
            worst = max(worst, *(abs(a / b - 1.0) for a, b in zip(found, wanted, strict=True)))
        limits.at_most(f"slopes, {solver}, {substeps} substeps: error of acceleration and spin", worst, 0.01)
    for restitution, speed in itertools.product((0.0, 0.5, 0.8, 1.0), (1.0, 4.0, 20.0)):
        runs = [lost_turning(crowd(200, seed, speed, restitution), 300) for seed in range(10)]
        name = f"crowds of 200, restitution {restitution:g}, {speed:g} m/s"
        limits.at_most(f"{name}: change of angular momentum", max(lost for lost, _ in runs), 1e-9)
        limits.at_most(f"{name}: most energy over that at the start", max(most for _, most in runs), 1.0 + 1e-9)
    for seed in range(5):
        built = heap(500, 25, seed)
        for _ in range(900):
            step(built)
        limits.at_most(f"heap of 500, seed {seed}: fastest after 15 s [m/s]", fastest(built), 1e-3)
    return int(limits.broken)


if __name__ == "__main__":
    sys.exit(main())
