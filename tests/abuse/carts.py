"""Motors in figures: carts on wheels of 20 segments, weights at a rim, floating wheels, drives reversed at random.

Run by hand: python -m tests.abuse.carts [--all]. Without --all, the corners of the table. A cart's motors have together
twice the torque that it takes to climb over its wheels' corners, M g r sin(pi / 20 + slope); its speed is that of the
last third of 6 s, as a share of the motors' speed times the wheels' radius. Friction is 2: with 1, wheels slip uphill.
"""

import argparse
import itertools
import sys

import numpy as np

from sandbox.physics.analysis.energy import total_energy
from sandbox.physics.step import step
from tests.support.carts import (
    angular_momentum,
    cart_speed,
    floating_cart,
    row_velocities,
    spin,
    unicycle,
    weighted_wheel,
)
from tests.support.limits import Limits

CARRYING = ("direct", "iterative")
SUBSTEPS = (1, 4)
RIMS = (0.2, 0.5, 1.0, 2.0, 5.0)
LOADS = (0.5, 5.0, 30.0, 120.0)
SLOPES = (0.0, 10.0)
LEAST = 0.93
RIGID = {"stiffness": 1.0, "damping": 1.0}


def speeds(limits: Limits, everything: bool) -> None:
    """The carts' table."""
    rims, loads = (RIMS, LOADS) if everything else (RIMS[::4], LOADS[::3])
    for solver, substeps, slope in itertools.product(CARRYING, SUBSTEPS, SLOPES):
        found = []
        for rim, load in itertools.product(rims, loads):
            for driven in (1, 2) if everything else (2,):
                found.append(cart_speed(rim, load, slope, solver, substeps, driven=driven))
        short = sum(share < LEAST for share in found)
        print(f"{short} of {len(found)} below {LEAST}:", " ".join(f"{share:.3f}" for share in found))
        limits.at_least(f"{solver}, {substeps} substeps, {slope:g} degrees: share of the speed", min(found), LEAST)


def stalls(limits: Limits) -> None:
    """Where a motor stalls at a weight of 20 kg, 5 degrees below level."""
    for solver, substeps in itertools.product(CARRYING, SUBSTEPS):
        lifted = []
        for share in (0.97, 1.03):
            world = weighted_wheel(share, solver=solver, substeps=substeps, **RIGID)
            start = world.position[17, 1]
            for _ in range(45):
                step(world)
            lifted.append(world.position[17, 1] - start)
        name = f"{solver}, {substeps} substeps: lifted in 0.75 s"
        limits.at_most(f"{name} with 0.97 of the torque [m]", lifted[0], 0.0)
        limits.at_least(f"{name} with 1.03 of it [m]", lifted[1], 0.0)


def floats(limits: Limits) -> None:
    """The angular momentum of a wheel and a frame in space."""
    for solver, substeps in itertools.product((*CARRYING, "single_pass"), SUBSTEPS):
        coefficients = {"stiffness": 0.14, "damping": 0.14} if solver == "single_pass" else RIGID
        world = floating_cart(solver=solver, substeps=substeps, **coefficients)
        rim, worst = np.arange(1, 33), 0.0
        for _ in range(120):
            step(world)
            worst = max(worst, abs(angular_momentum(world)) / abs(angular_momentum(world, rim)))
        turn = spin(world, rim) - spin(world, np.array([0, 33, 34]))
        print(f"{solver:11} {substeps} substeps: speed {turn:.6f} of 4")
        limits.at_most("change of angular momentum, of the wheel's", worst, 1e-9)


def faults() -> None:
    """A wheel with 30 kg below its hub: how far it is after 1 to 6 s."""
    for solver, substeps, torque in itertools.product(CARRYING, SUBSTEPS, (60.0, 90.0, 300.0)):
        world = unicycle(torque, solver=solver, substeps=substeps, **RIGID)
        places = []
        for tick in range(1, 361):
            step(world)
            if tick % 60 == 0:
                places.append(f"{world.position[0, 0]:.2f}")
        print(f"{solver:9} {substeps} substeps, {torque:3g} N m: {' '.join(places)} m", flush=True)


def reversals(limits: Limits, seeds: int) -> None:
    """Energy of floating carts beyond the start and their motors' work, driven at random."""
    worst = 0.0
    for seed in range(seeds):
        generator = np.random.default_rng(seed)
        damping = float(10.0 ** generator.uniform(-3.0, 0.0))
        stiffness = damping * float(generator.uniform(0.0, 1.0))
        torque = float(10.0 ** generator.uniform(-1.0, 3.0))
        world = floating_cart(wheels=2, torque=torque, solver="direct", stiffness=stiffness, damping=damping)
        energy, work, scale = total_energy(world), 0.0, 0.0
        for tick in range(300):
            if tick % int(generator.integers(5, 40)) == 0:
                for part in range(2):
                    world.drive(part, float(generator.uniform(-3.0, 3.0)))
            position, velocity = world.position.copy(), world.velocity.copy()
            step(world)
            before, after = (row_velocities(world, position, v) for v in (velocity, world.velocity))
            more = world.actuator_impulse * (before + after) / 2.0
            work += float(np.sum(more))
            scale += float(np.sum(np.abs(more)))
            worst = max(worst, (total_energy(world) - energy - work) / max(scale, 1e-12))
    limits.at_most(f"{seeds} floating carts: energy beyond start and work, of the work both ways", worst, 1e-9)


def main(arguments: list[str] | None = None) -> int:
    """Print the figures; 1 where one is beyond its limit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--all", action="store_true")
    everything, limits = parser.parse_args(arguments).all, Limits()
    stalls(limits)
    floats(limits)
    reversals(limits, 200 if everything else 10)
    faults()
    speeds(limits, everything)
    return int(limits.broken)


if __name__ == "__main__":
    sys.exit(main())
