"""Release: how a thing comes back that is pulled aside and let go, measured in copies of its world.

See step_response.py for how; here are the copies.
"""

import copy
from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from sandbox.physics.analysis import step_response as kernels
from sandbox.physics.arena import FIRST_ARENA, answer_of
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.step import step
from sandbox.physics.world import World

# Why there is no curve, in a line for a person: with what was seen.
REASONS = {
    kernels.NOTHING_FREE: "nothing of it is free to move",
    kernels.NOTHING_HOLDS: "nothing holds it: pin it, or let it lie on something first",
    kernels.NO_SIZE: "it has no size, or the way to pull it has no length",
    kernels.MOVES_ON: "it still moves after {seconds} s, or something else does: let all come to rest first",
    kernels.GOES_FURTHER: "it does not come back: let go, it goes further than it was pulled",
    kernels.STAYS_AWAY: "it does not come back: {left} % of the way is left, at rest, after {seconds} s",
}


class NoCurve(ValueError):
    """A thing does not come back, or nothing holds it; its text is one line for a person."""


@dataclass(frozen=True, eq=False)
class StepResponse:
    """How a thing came back: tick [s]; errors (n,): how far it is from its place, 1 as it is let go, tick by tick.

    particle: the slot that was pulled; way (2,): where to; pull [m]: how far.
    """

    tick: float
    errors: Floats
    particle: int
    way: tuple[float, float]
    pull: float


def release_in_slices(
    world: World, springs: Slots, is_aside: bool = False, particle: int | None = None
) -> Generator[float, None, StepResponse]:
    """Pull a particle of the thing of some springs as gravity has it, or across that, let it go, and see how it comes
    back: a tick at a time; says how much is done, 0..1.

    particle: its slot; None: what is farthest from all that holds the thing. The world stays as it is. Raises NoCurve
    where it does not come back to its place.
    """
    rate = world.settings.tick_rate
    release = np.zeros(kernels.release_length(rate))
    touching = world.contact_particle.astype(np.int64)
    own, _ = answer_of(
        kernels.choose_pull, FIRST_ARENA, world.lent, springs.astype(np.int64), touching, int(is_aside), release
    )
    if own < 0 and (particle is None or own == kernels.NO_SIZE):
        raise NoCurve(REASONS[own])
    if particle is not None:
        release[kernels.PARTICLE] = particle
    found = yield from _followed(world, release)
    seconds = release[kernels.COUNT] / rate
    if found != kernels.FOUND:
        left = 100.0 * release[kernels.REST]
        raise NoCurve(REASONS[found].format(seconds=f"{seconds:.0f}", left=f"{left:.0f}"))
    errors = release[kernels.ERRORS : kernels.ERRORS + int(release[kernels.COUNT])].copy()
    x, y = release[kernels.ALONG : kernels.ALONG + 2].tolist()
    return StepResponse(1.0 / rate, errors, int(release[kernels.PARTICLE]), (x, y), float(release[kernels.PULLED]))


def _followed(world: World, release: Floats) -> Generator[float, None, int]:
    # Do as the kernel says until it has found a curve, or says why there is none.
    slot = int(release[kernels.PARTICLE])
    rested = still = pulled = copy.deepcopy(world)
    follows = kernels.STEP
    while follows < kernels.FOUND:
        if follows == kernels.BEGIN:
            if release[kernels.NUMBER] == 0.0:
                rested = still
            still, pulled = copy.deepcopy(rested), copy.deepcopy(rested)
            pulled.pin(slot)
        elif follows != kernels.STEP:
            if follows == kernels.LET_GO:
                pulled.unpin(slot)
            if follows != kernels.FREE:
                held = release[kernels.HELD : kernels.HELD + 4]
                pulled.change("position", held[:2], slot)
                pulled.change("velocity", held[2:], slot)
            step(pulled)
        if follows != kernels.BEGIN:
            step(still)
            yield float(release[kernels.DONE])
        flat = (each.reshape(-1) for each in (still.position, still.velocity, pulled.position, pulled.velocity))
        follows = kernels.follow_release(release, *flat)
    return follows
