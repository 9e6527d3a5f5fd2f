"""How high boxes of springs bounce: as the level format says of `restitution`."""

import math

import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.physics.step import step

# Of Cs and Cd: the part of the height to which a box rises, flat of 4 cells, flat of 8, and 0.3 rad askew of 4.
BOUNCES = {
    (1.0, 1.0): (1.0, 1.0, 0.61),
    (0.9, 0.99): (0.76, 0.38, 0.34),
    (0.7, 0.95): (0.28, 0.0, 0.12),
    (0.5, 0.9): (0.01, 0.01, 0.08),
}


def part_of_height(stiffness, damping, *, size, cells, angle=0.0):
    """Drop a box of restitution 1 by 2 m; the part of that to which its middle rises again."""
    middle = 2.0 + 0.5 * size * (math.cos(angle) + math.sin(angle)) + 0.05
    box = {
        "type": "jelly", "id": "box", "shape": {"box": (size, size)}, "spacing": size / cells,
        "position": (0.0, middle), "angle": angle, "material": "soft",
    }  # fmt: skip
    world = build_world(Level.model_validate({
        "format": "spring-sandbox/level", "version": 3, "name": "bounce", "bodies": (box,),
        "materials": {"soft": {"stiffness": stiffness, "damping": damping}},
        "contacts": {"friction": 0.0, "restitution": 1.0},
        "terrain": ({"id": "ground", "polyline": ((-50.0, 0.0), (50.0, 0.0))},),
    }))  # fmt: skip
    heights = []
    for _ in range(110):
        step(world)
        heights.append(float(world.position[world.particle_active, 1].mean()))
    lowest = heights.index(min(heights[:60]))
    return (max(heights[lowest:]) - 0.5 * size - 0.05) / 2.0


@pytest.mark.parametrize(("stiffness", "damping"), list(BOUNCES))
def test_a_box_bounces_as_high_as_the_level_format_says(stiffness, damping):
    flat, fine, askew = BOUNCES[stiffness, damping]
    for size in (0.7, 1.3):
        assert part_of_height(stiffness, damping, size=size, cells=4) == pytest.approx(flat, abs=0.03)
    assert part_of_height(stiffness, damping, size=1.0, cells=8) == pytest.approx(fine, abs=0.03)
    assert part_of_height(stiffness, damping, size=1.0, cells=4, angle=0.3) == pytest.approx(askew, abs=0.03)
