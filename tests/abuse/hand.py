"""The hand in figures: what it holds, how it lags, how hard it pulls, what it strains.

Run by hand: python -m tests.abuse.hand [--all]. Held for 0.75 s, dragged to the right for 0.75 s, let go. --all: every
solver, several substeps, and jellies of other sizes and grids.
"""

import argparse
import sys
from collections.abc import Callable
from functools import partial

import numpy as np

from sandbox.physics.analysis.applied_forces import pulls_of
from sandbox.physics.analysis.query import grip_radius
from sandbox.physics.analysis.stability import report
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.world import World
from sandbox.tools.drag import STRENGTHS
from tests.support.hands import RATE, Drag, dough, drag_away, follow, jelly, momentum_velocity, nearest, rope, truss
from tests.support.limits import Limits

SPEEDS = (5.0, 20.0)
# Of the editor's jelly.
SAG = 0.1
soft = partial(jelly, sag=SAG)
# What is held, and where [m].
HELD: dict[str, tuple[Callable[..., World], tuple[float, float]]] = {
    "rope 1.6 kg, its end": (rope, (1.5, 0.0)),
    "jelly 1 m, its middle": (soft, (0.0, 0.0)),
    "jelly 1 m, its top": (soft, (0.0, 0.5)),
    "jelly 1 m, a corner": (soft, (-0.5, 0.5)),
    "truss 1,000 kg, its end": (truss, (7.0, 1.0)),
}
MORE = {
    f"jelly {size:g} m, {cells} cells, a corner": (partial(jelly, size, cells, SAG), (-9.0, 9.0))
    for size, cells in ((0.5, 4), (0.5, 16), (2.0, 8), (2.0, 16), (3.0, 8), (5.0, 20))
}


def bounded(world: World) -> World:
    """The same, its springs inside the limit of the single pass, where it has that."""
    if world.settings.solver == "single_pass":
        limit = 0.99 * report(world).proven_limit
        world.set_coefficients(limit, limit, None)
    return world


def row(name: str, world: World, held: Drag, drag: Drag, strength: str, speed: float) -> str:
    """One line of the table."""
    away = np.hypot(*momentum_velocity(world))
    share = max(held.force + drag.force) / drag.limit
    return (
        f"{name:34} {strength:7} {speed:4g} m/s  lag {max(drag.lag):5.3f}, last {drag.lag[-1]:5.3f} m  "
        f"force {max(drag.force):9.4g} N, {share:.4f} of its most  strain {held.strain[-1]:6.3g}, "
        f"{max(drag.strain):6.3g}  body {away:5.2f} m/s"
    )


def held_still(limits: Limits) -> None:
    """What is very soft, held by a corner and not moved, for ten seconds."""
    for stiffness, damping in ((0.01, 0.3), (0.02, 0.1), (0.05, 0.3)):
        world = dough(stiffness, damping)
        corner = nearest(world, (-9.0, 9.0))
        start = world.position[corner].copy()
        world.hold(0, corner, tuple(start), STRENGTHS["normal"], grip_radius(world, corner))
        strained = max(follow(world, corner, [start] * (10 * RATE)).strain)
        limits.at_most(f"jelly of Cs {stiffness}, Cd {damping}, held still by a corner: strain", strained, 1.6)


def pinned(strength: str, **settings) -> str:
    """A girder that is pinned at both ends, dragged in its middle."""
    world = bounded(truss(("start", "end"), **settings))
    _, drag = drag_away(world, nearest(world, (3.0, 1.0)), strength, 5.0)
    (pull,) = pulls_of(world)
    return f"girder pinned at both ends         {strength:7} force {drag.force[-1]:9.4g} N of {pull.limit:9.4g}, {pull}"


def main(arguments: list[str] | None = None) -> int:
    """Print the table; 1 where a figure of the usual strength and settings is beyond its limit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--all", action="store_true")
    everything, limits = parser.parse_args(arguments).all, Limits()
    for solver in SOLVERS if everything else ("direct",):
        for substeps in ("auto", 1, 4) if everything else ("auto",):
            print(f"{solver}, substeps {substeps}")
            settings = {"solver": solver, "substeps": substeps}
            for name, (make, where) in (HELD | MORE if everything else HELD).items():
                for strength in STRENGTHS:
                    for speed in SPEEDS:
                        world = bounded(make(**settings))
                        held, drag = drag_away(world, nearest(world, where), strength, speed)
                        print(row(name, world, held, drag, strength, speed), flush=True)
                        if (solver, substeps, strength, speed) == ("direct", "auto", "normal", 5.0):
                            limits.at_most(f"{name}: lag at the start [m]", max(drag.lag), 0.15)
                            limits.at_most(f"{name}: lag once up to speed [m]", drag.lag[-1], 0.05)
                        if (solver, substeps) == ("direct", "auto") and strength != "strong" and "jelly 1 m" in name:
                            limits.at_most(f"{name}: strain", max(drag.strain), 1.0)
            for strength in STRENGTHS:
                print(pinned(strength, **settings), flush=True)
    held_still(limits)
    return int(limits.broken)


if __name__ == "__main__":
    sys.exit(main())
