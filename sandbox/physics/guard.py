"""Last of all in a step: whatever the solver has left, no particle's centre crosses terrain in the step."""

import math

from sandbox.physics.contacts import span
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.outline import TERRAIN_GROUP
from sandbox.physics.world import Floats, World

# A particle that would cross a line of terrain is stopped this far in front of it, in units of its distance.
STOP_SHARE = 0.01
STOPS = 3


@kernel
def _stop(position, velocity, ahead, collides, active, inverse_mass, terrain, h):  # type: ignore[no-untyped-def]
    # No particle crosses an edge of terrain: its velocity towards the first in its way is cut.
    for p in range(position.shape[0]):
        if not active[p] or inverse_mass[p] == 0.0 or not collides[p] & TERRAIN_GROUP:
            continue
        for stop in range(STOPS + 1):
            wx = h * velocity[p, 0] + ahead[p, 0]
            wy = h * velocity[p, 1] + ahead[p, 1]
            e, signed, nx, ny = _crossing(p, position, wx, wy, terrain)
            if e < 0:
                break
            if stop == STOPS:
                velocity[p, 0] = 0.0
                velocity[p, 1] = 0.0
                ahead[p, 0] = 0.0
                ahead[p, 1] = 0.0
                break
            after = signed + wx * nx + wy * ny
            missing = (STOP_SHARE * signed - after) / h
            velocity[p, 0] += missing * nx
            velocity[p, 1] += missing * ny


@inner_kernel
def _crossing(p, position, wx, wy, terrain):  # type: ignore[no-untyped-def]
    # The first edge that the way w of a particle's centre crosses (-1: none), distance from it, normal towards it.
    x = position[p, 0]
    y = position[p, 1]
    cell = terrain.cell[0]
    left, right = span(x + min(0.0, wx), x + max(0.0, wx), terrain.corner[0], cell, terrain.size[0])
    bottom, top = span(y + min(0.0, wy), y + max(0.0, wy), terrain.corner[1], cell, terrain.size[1])
    soonest = 2.0
    found = -1
    distance = 0.0
    nx = 0.0
    ny = 0.0
    for row in range(bottom, top + 1):
        for column in range(left, right + 1):
            at = row * terrain.size[0] + column
            for entry in range(terrain.cell_start[at], terrain.cell_start[at + 1]):
                e = terrain.cell_edge[entry]
                a = terrain.edge_a[e]
                dx = terrain.vertex[terrain.edge_b[e], 0] - terrain.vertex[a, 0]
                dy = terrain.vertex[terrain.edge_b[e], 1] - terrain.vertex[a, 1]
                px = x - terrain.vertex[a, 0]
                py = y - terrain.vertex[a, 1]
                # Signed area, above 0 on the right of the edge; it changes by `change` on the way.
                before = px * dy - py * dx
                change = wx * dy - wy * dx
                if before < 0.0 and terrain.solid[e] == 0:
                    before, change, dx, dy = -before, -change, -dx, -dy
                    px = x - terrain.vertex[terrain.edge_b[e], 0]
                    py = y - terrain.vertex[terrain.edge_b[e], 1]
                if not (before > 0.0 and before + change < 0.0):
                    continue
                when = before / -change
                squared = dx * dx + dy * dy
                share = ((px + when * wx) * dx + (py + when * wy) * dy) / squared
                if when < soonest and -1e-9 <= share <= 1.0 + 1e-9:
                    length = math.sqrt(squared)
                    soonest = when
                    found = e
                    distance = before / length
                    nx = dy / length
                    ny = -dx / length
    return found, distance, nx, ny


def stop_at_terrain(world: World, ahead: Floats, h: float) -> None:
    """Cut the velocities [m/s] of particles that would cross terrain in the coming h [s], on ways h v + ahead [m]."""
    if len(world.terrain.edge_a):
        _stop(
            world.position, world.velocity, ahead, world.collides, world.particle_active, world.inverse_mass,
            world.terrain, h,
        )  # fmt: skip
