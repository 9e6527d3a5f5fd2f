"""Fitted meshes of random outlines in figures: smallest angles, what is refused, and the time they take.

Run by hand: python -m tests.abuse.meshes [--all]. Stars of 3 to 60 corners, from smooth to jagged, at several spacings;
300 of them, or --all: 10,000.
"""

import argparse
import math
import random
import sys
import time

import numpy as np

from sandbox.level.kinds.geometry import TooCoarse, fitted_mesh, is_simple

CORNERS = (3, 4, 5, 8, 12, 20, 60)
ROUGH = (0.0, 0.1, 0.3, 0.5)
SPACINGS = (0.1, 0.15, 0.2, 0.25, 0.3)


def star(generator: random.Random) -> tuple[tuple[float, float], ...]:
    """An outline about [0, 0], about 2 m across; what has many corners is smoother."""
    count = generator.choice(CORNERS)
    rough = generator.choice(ROUGH) * min(1.0, 10.0 / count)
    turns = [math.tau * corner / count for corner in range(count)]
    radii = [1.0 + rough * generator.uniform(-1.0, 1.0) for _ in turns]
    return tuple((r * math.cos(turn), r * math.sin(turn)) for r, turn in zip(radii, turns, strict=True))


def smallest_angle(places: np.ndarray, triangles: np.ndarray) -> float:
    """Smallest angle [degrees] of all triangles."""
    corners, least = places[triangles], 180.0
    for k in range(3):
        u, w = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        found = np.arctan2(u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0], np.sum(u * w, axis=1))
        least = min(least, float(np.degrees(found.min())))
    return least


def main(arguments: list[str] | None = None) -> int:
    """Print the angles; 0, there is no limit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--all", action="store_true")
    count = 10_000 if parser.parse_args(arguments).all else 300
    generator, angles, refused, particles, spent = random.Random(1), [], 0, 0, 0.0
    for _ in range(count):
        outline, spacing = star(generator), generator.choice(SPACINGS)
        if not is_simple(outline):
            continue
        began = time.perf_counter()
        try:
            mesh = fitted_mesh(outline, (), spacing)
        except TooCoarse:
            refused += 1
            continue
        spent += time.perf_counter() - began
        particles += len(mesh.places)
        angles.append(smallest_angle(mesh.places, mesh.triangles))
    shares = np.quantile(angles, [0.0, 0.01, 0.05, 0.25, 0.5])
    print(f"{len(angles)} meshes of {particles} particles, {refused} outlines refused as too thin for their spacing")
    print("smallest angle [degrees]: least, of 1 in 100, 1 in 20, 1 in 4, half:", np.round(shares, 1))
    print(f"{1e6 * spent / particles:.0f} us per particle")
    return 0


if __name__ == "__main__":
    sys.exit(main())
