"""Flush ground is one ground: whatever glides over its seams keeps its height and its speed; real steps stay steps."""

import math

import pytest

from sandbox.physics.jit import COMPILED
from tests.support.situations import advance, session_of, slots_of

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")

PIECES = 30
R = 0.05  # [m] of particles of pinned bodies


def pieces(kind, step=0.0):
    """Terrain and bodies of flush ground at y = 0 in pieces of 1 m; step [m]: by which every second one is higher."""
    terrain, bodies = [], []
    for i in range(PIECES):
        a, b, y = i - 2.0, i - 1.0, step * (i % 2)
        block = {"id": f"t{i}", "polygon": [[a, y - 1], [b, y - 1], [b, y], [a, y]]}
        line = {"start": [a, -R], "end": [b, -R], "segments": 2, "material": "m", "particle_radius": R, "id": f"b{i}"}
        if kind == "blocks" or (kind in ("rope", "bridge") and i % 2 == 0):
            terrain.append(block)
        elif kind == "lines":
            terrain.append({"id": f"t{i}", "polyline": [[a, y], [b, y]]})
        elif kind == "overlapping":
            terrain.append({"id": f"t{i}", "polygon": [[a - 0.1, -1], [b + 0.1, -1], [b + 0.1, 0], [a - 0.1, 0]]})
        elif kind == "rope":
            bodies.append({"type": "rope", "pinned": [0, 1, 2], **line})
        elif kind == "bridge":
            bodies.append({"type": "bridge", "height": 0.5, "pinned": list(range(6)), **line})
        else:
            end = [a, 0] if kind == "walls below" else [b, 0]
            terrain.append({"id": f"t{i}", "polyline": [[a, -0.5], end]})
    if kind in ("walls below", "truss below"):
        terrain.append({"id": "floor", "polyline": [[-2, 0], [PIECES - 2, 0]]})
    return {"terrain": terrain, "bodies": bodies}


def roll(ground, speed, radius, *, restitution=0.0, **settings):
    """The highest hop [m] of a disc that rolls over it, and the share of its speed that it keeps."""
    session = session_of(
        settings=settings, contacts={"friction": 0.5, "restitution": restitution},
        particles=[{
            "id": "d", "position": [-1.5, radius], "radius": radius, "velocity": [speed, 0], "spin": -speed / radius,
            "rolling": 0,
        }],
        **ground,
    )  # fmt: skip
    world, disc, hop = session.world, session.world.particle_slot("d"), 0.0
    for _ in range(int(min(4.0, 26.0 / speed) * 60)):
        advance(session, 1)
        hop = max(hop, float(world.position[disc, 1]) - radius)
    return hop, float(world.velocity[disc, 0]) / speed


@pytest.mark.parametrize(
    "kind", ["blocks", "lines", "overlapping", "rope", "bridge", "walls below", "truss below"]
)  # fmt: skip
def test_a_disc_rolls_over_flush_ground_as_over_one_piece(kind):
    # Ropes and bridges have a rolling resistance of their own.
    kept = 0.97 if kind in ("rope", "bridge") else 1.0 - 1e-4
    for speed in (1.0, 5.0, 20.0, 100.0):
        for radius in (0.05, 0.3):
            hop, share = roll(pieces(kind), speed, radius)
            assert hop < 1e-4 and share > kept, (speed, radius, hop, share)


@pytest.mark.parametrize("settings", [{"substeps": 4}, {"solver": "iterative"}], ids=str)
def test_so_it_does_in_substeps_in_the_iterative_solver_and_with_restitution(settings):
    for kind in ("blocks", "lines"):
        hop, share = roll(pieces(kind), 10.0, 0.3, restitution=0.5, **settings)
        assert hop < 1e-4 and share > 1.0 - 1e-4


def test_a_box_slides_over_flush_ground_without_friction_as_over_one_piece():
    session = session_of(
        contacts={"friction": 0.0, "restitution": 0.0}, terrain=pieces("blocks")["terrain"],
        bodies=[{
            "type": "jelly", "id": "k", "shape": {"box": [0.5, 0.5]}, "spacing": 0.25, "position": [-1.0, 0.3],
            "velocity": [5, 0], "material": "m", "particle_radius": 0.05,
        }],
    )  # fmt: skip
    advance(session, 180)
    assert session.world.velocity[slots_of(session, "k"), 0] == pytest.approx(5.0, rel=1e-4)


@pytest.mark.parametrize(("speed", "within"), [(5.0, 0.25), (10.0, 0.1), (20.0, 0.1)])
def test_a_step_throws_a_disc_up_as_one_that_turns_about_its_edge(speed, within):
    # Angular momentum about the edge: v' = v (1 - 2 s / 3 r) along the tangent, cos t = 1 - s / r.
    r = 0.3
    for s in (0.002, 0.01, 0.03):
        session = session_of(
            contacts={"friction": 0.5, "restitution": 0.0},
            terrain=[
                {"id": "low", "polygon": [[-3, -1], [0, -1], [0, 0], [-3, 0]]},
                {"id": "high", "polygon": [[0, -1], [60, -1], [60, s], [0, s]]},
            ],
            particles=[{
                "id": "d", "position": [-1.5, r], "radius": r, "velocity": [speed, 0], "spin": -speed / r, "rolling": 0,
            }],
        )  # fmt: skip
        world, disc, hop = session.world, session.world.particle_slot("d"), 0.0
        for _ in range(120):
            advance(session, 1)
            hop = max(hop, float(world.position[disc, 1]) - r)
        along = speed * (1.0 - 2.0 * s / (3.0 * r))
        sine = math.sqrt(1.0 - (1.0 - s / r) ** 2)
        assert hop == pytest.approx((along * sine) ** 2 / (2.0 * 9.81), rel=within), s
