"""Sag: jellies of 0.5 to 5 m at 4 to 32 cells across, all of them asked for the same firmness.

    python -m tests.abuse.sag [--all]

For each the height at rest as a share of the height drawn, which is to be within 5 % of the others' and at least 0.85;
and the frequency and damping ratio of its slowest wobble, measured from motion in ticks of 1 and of 8 substeps, which
are to be within 2 % of what is asked; at 32 cells that takes minutes. Without --all only a few, drawn at random by a
fixed seed.
"""

import argparse
import random
import sys
from collections.abc import Iterator
from typing import Any, NamedTuple

from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.firmness import FirmnessRange
from sandbox.physics.step import step
from tests.support.wobbles import firm_world, height, measured_wobble, standing_box

SAG = 0.1
SIZES = (0.5, 1.0, 2.0, 5.0)
CELLS = (4, 8, 16, 32)
SUBSTEPS = (1, 8)
SECONDS = 8.0
LEAST_HEIGHT, HEIGHTS_WITHIN, FREQUENCY_WITHIN = 0.85, 0.05, 0.02
SEED, SAMPLE = 1, 4


class Row(NamedTuple):
    """A jelly: size [m] and cells across; height at rest, as a share; errors of frequency and ratio, by substeps."""

    size: float
    cells: int
    height: float
    errors: tuple[tuple[float, float], ...]

    def __str__(self) -> str:
        wobble = "  ".join(f"{100 * hz:+.3f} % Hz {100 * ratio:+.3f} % ratio" for hz, ratio in self.errors)
        return f"{self.size:4g} m  {self.cells:2} cells  height {self.height:.3f}  {wobble}"


def wobble_errors(size: float, cells: int, substeps: int) -> tuple[float, float]:
    """How far frequency and damping ratio are from what was asked, as shares, measured from motion."""
    gravity: Any = {"gravity": [0, -9.81]}
    box = {"shape": {"box": [size, size]}, "spacing": size / cells}
    reach = FirmnessRange.of(firm_world({"sag": SAG}, gravity, **box).forms[0].shape, (0.0, -9.81), 60)
    _, hz, ratio = reach.reading(*reach.coefficients(Firmness(sag=SAG)))
    world = firm_world({"hz": hz, "ratio": ratio}, {"substeps": substeps}, **box)
    measured = measured_wobble(world)
    return measured[0] / hz - 1.0, measured[1] / ratio - 1.0


def rows(chosen: list[tuple[float, int]]) -> Iterator[Row]:
    """The jellies of these sizes and cells."""
    for size, cells in chosen:
        world = standing_box(size, cells, {"sag": SAG})
        for _ in range(round(60 * SECONDS)):
            step(world)
        yield Row(size, cells, height(world) / size, tuple(wobble_errors(size, cells, count) for count in SUBSTEPS))


def faults(found: list[Row]) -> list[str]:
    """What of it is not as it is to be."""
    heights = [row.height for row in found]
    lines = [f"{row}: too low" for row in found if not row.height >= LEAST_HEIGHT]
    if not max(heights) - min(heights) <= HEIGHTS_WITHIN:
        lines.append(f"heights from {min(heights):.3f} to {max(heights):.3f}")
    return lines + [
        f"{row}: wobbles otherwise" for row in found if any(abs(error) > FREQUENCY_WITHIN for error, _ in row.errors)
    ]


def main(arguments: list[str] | None = None) -> int:
    """Print every jelly and what is wrong; 1 where there is a fault."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--all", action="store_true")
    chosen = [(size, cells) for size in SIZES for cells in CELLS]
    if not parser.parse_args(arguments).all:
        chosen = random.Random(SEED).sample(chosen, SAMPLE)
    found = []
    for row in rows(chosen):
        print(row, flush=True)
        found.append(row)
    lines = faults(found)
    print("\n".join(lines) or "as asked")
    return int(bool(lines))


if __name__ == "__main__":
    sys.exit(main())
