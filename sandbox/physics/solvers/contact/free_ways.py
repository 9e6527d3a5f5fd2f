"""The ways of free particles that are followed, through the impacts of a small step (free_impacts.py)."""

from sandbox.physics.arrays import FloatRows
from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.contact.free_constraints import (
    GAP,
    NX,
    NY,
    VX,
    VY,
    WEIGHT_P,
    WEIGHT_Q,
    WX,
    WY,
    FreeContactScratch,
)
from sandbox.physics.ways import Ways, go, is_followed


@inner_kernel
def lead(work: FreeContactScratch, k: int, late: float, ways: Ways, position: FloatRows) -> None:
    """Lead the particle of a place to where it is, so late in the step [s]."""
    p, motion = work.particle[k], work.motion
    go(ways, p, position[p, 0] + motion[k, WX], position[p, 1] + motion[k, WY], late, False)


@inner_kernel
def follow_pass(
    work: FreeContactScratch, hits: int, small: float, late: float, ways: Ways, position: FloatRows
) -> None:  # fmt: skip
    """Lead what is followed to where the hits of a solved pass are; the small step [s] begins so late [s]."""
    for k in range(hits):
        for end in range(2):
            place = work.end[work.hit[k], end]
            if not work.weight[place] > 0.0 or not is_followed(ways, work.particle[place]):
                continue
            is_first = True
            for j in range(k):
                i = work.hit[j]
                is_first = is_first and work.end[i, 0] != place and work.end[i, 1] != place
            if is_first:
                _follow_hits(work, place, k, hits, small, late, ways, position)


@inner_kernel
def _follow_hits(
    work: FreeContactScratch, place: int, first: int, hits: int, small: float, late: float, ways: Ways,
    position: FloatRows,
) -> None:  # fmt: skip
    # Lead a particle from hit to hit, the first of which is given, each of which pushes it where it is.
    p, motion = work.particle[place], work.motion
    x, y = position[p, 0] + motion[place, WX], position[p, 1] + motion[place, WY]
    vx, vy = motion[place, VX], motion[place, VY]
    for k in range(first, hits):
        # As before the pass.
        ux, uy = _pushed(work, k, place)
        vx, vy = vx - ux, vy - uy
        x, y = x + work.met[k] * ux, y + work.met[k] * uy
    now, last = 0.0, -1
    for _ in range(first, hits):
        soonest, found = small, -1
        for k in range(first, hits):
            i = work.hit[k]
            if work.end[i, 0] == place or work.end[i, 1] == place:
                met = _time_of(work, k)
                if met < soonest and (met > now or (met == now and k > last)):
                    soonest, found = met, k
        if found < 0:
            return
        x, y = x + (soonest - now) * vx, y + (soonest - now) * vy
        go(ways, p, x, y, late + soonest, True)
        ux, uy = _pushed(work, found, place)
        vx, vy = vx + ux, vy + uy
        now, last = soonest, found


@inner_kernel
def _time_of(work: FreeContactScratch, k: int) -> float:
    # When a hit is [s]: the surfaces meet where they are, though an impulse against an edge acts as the step begins.
    gap, speed = work.constraint[work.hit[k], GAP], work.speed[k]
    return max(0.0, gap) / -speed if speed < 0.0 else 0.0


@inner_kernel
def _pushed(work: FreeContactScratch, k: int, place: int) -> tuple[float, float]:
    # What a hit adds to the velocity of a place [m/s].
    i, row = work.hit[k], work.constraint
    nx, ny, weight = row[i, NX], row[i, NY], 0.0
    if work.end[i, 0] == place:
        weight = row[i, WEIGHT_P]
    elif work.end[i, 1] == place:
        weight = -row[i, WEIGHT_Q]
    jn, jt = weight * work.pushed[k], weight * work.across[k]
    return jn * nx - jt * ny, jn * ny + jt * nx
