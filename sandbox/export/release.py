"""Release: how a thing comes back that is pulled aside and let go, measured in a copy of its world.

One particle is held a little aside until all else rests, and let go; how far it is from its place, as a share of the
first, is the curve. A second copy, in which nothing is pulled, says where its place is, as it is held and later: what
moves by itself does not count.
"""

import copy
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.level.format.slices import as_part, at_once
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.components import label_linked
from sandbox.physics.step import step
from sandbox.physics.world import World

# Pulls that are tried, as shares of the thing's size: as a finger pokes, then so little that nothing slips or yields.
PULLS = (0.01, 1e-4)
# Longest wait for all to rest before the pull and while it lasts, and longest curve [s].
MOST_BEFORE, MOST_HELD, MOST_SECONDS = 10.0, 10.0, 30.0
# It rests once nothing of it moves further in a second than this share of the pull; so does the curve.
AT_REST = 1e-3
# What does not come back within this share of the pull has been moved for good.
LEFT = 0.05
# The share of the work that is the wait before the pull, and that of one pull.
WAIT, PULL = 0.2, 0.4


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


def particle_to_pull(world: World, particles: Slots) -> int:
    """The slot among a thing's that is farthest from all that holds it: pins that it is joined to, and what it lies on.

    Raises NoCurve where nothing holds it, or nothing of it is free.
    """
    free = particles[world.inverse_mass[particles] > 0.0]
    if not len(free):
        raise NoCurve("nothing of it is free to move")
    label = np.arange(world.particle_count)
    springs = np.flatnonzero(world.spring_active)
    label_linked(world.particle_a[springs].astype(np.int64), world.particle_b[springs].astype(np.int64), label)
    joined = np.flatnonzero(np.isin(label, label[particles]))
    held = joined[world.inverse_mass[joined] == 0.0]
    holders = np.concatenate([held, np.intersect1d(joined, world.contact_particle)])
    if not len(holders):
        raise NoCurve("nothing holds it: pin it, or let it lie on something first")
    places, ends = world.position[free], world.position[holders]
    nearest = np.min(np.sum((places[:, None] - ends[None]) ** 2, axis=2), axis=1)
    return int(free[np.argmax(nearest)])


def release(world: World, particle: int, towards: Sequence[float], size: float) -> StepResponse:
    """Pull a particle of a thing of a size [m] aside, towards somewhere, let it go, and see how it comes back.

    The world stays as it is. Raises NoCurve where it does not come back to its place.
    """
    return at_once(release_in_slices(world, particle, towards, size))


def release_in_slices(
    world: World, particle: int, towards: Sequence[float], size: float
) -> Generator[float, None, StepResponse]:
    """As `release`, a tick at a time; says how much is done, 0..1."""
    length = float(np.hypot(towards[0], towards[1]))
    if not length > 0.0 or not size > 0.0:
        raise NoCurve("it has no size, or the way to pull it has no length")
    along = np.asarray(towards, float) / length
    rested = copy.deepcopy(world)

    def wait() -> bool:
        step(rested)
        return float(np.max(np.abs(rested.velocity), initial=0.0)) <= AT_REST * size

    yield from as_part(_run(wait, round(MOST_BEFORE * world.settings.tick_rate)), 0.0, WAIT)
    for number, share in enumerate(PULLS):
        first = WAIT + PULL * number
        errors = yield from as_part(_pulled(rested, particle, along, share * size), first, first + PULL)
        left = float(np.mean(errors[-_window(world) :])) / errors[0]
        # What is let go from rest never goes further than it was pulled, as long as it neither slips nor breaks.
        is_further = float(np.max(np.abs(errors))) > (1.0 + LEFT) * errors[0]
        if abs(left) <= LEFT and not is_further:
            break
        if number == len(PULLS) - 1:
            took = len(errors) / world.settings.tick_rate
            if took >= MOST_SECONDS:
                raise NoCurve(f"it still moves after {took:.0f} s, or something else does: let all come to rest first")
            if is_further:
                raise NoCurve("it does not come back: let go, it goes further than it was pulled")
            raise NoCurve(
                f"it does not come back: {100.0 * left:.0f} % of the way is left, at rest, after {took:.0f} s"
            )
    end = left * errors[0]
    shares = (errors - end) / (errors[0] - end)
    way = float(along[0]), float(along[1])
    return StepResponse(1.0 / world.settings.tick_rate, shares, particle, way, share * size)


def _window(world: World) -> int:
    return max(2, world.settings.tick_rate // 2)


def _run(advance: Callable[[], bool], ticks: int) -> Generator[float, None, None]:
    """Ticks until all rests, three times in a row, or so many; advance: makes one, and says whether all rests."""
    resting = 0
    for tick in range(ticks):
        resting = resting + 1 if advance() else 0
        if resting >= 3:
            break
        yield tick / ticks


def _pulled(rested: World, particle: int, along: Floats, pull: float) -> Generator[float, None, Floats]:
    # How far a particle [m] is from where it would be without a pull, tick by tick from when it is let go.
    still, pulled = copy.deepcopy(rested), copy.deepcopy(rested)
    pulled.pin(particle)

    def hold() -> None:
        # Where it would be moves by itself, where a motor runs or what holds it swings.
        pulled.change("position", still.position[particle] + pull * along, particle)
        pulled.change("velocity", still.velocity[particle], particle)

    def hold_on() -> bool:
        step(still)
        step(pulled)
        hold()
        apart, own = pulled.velocity - still.velocity, still.velocity[particle]
        return float(max(np.max(np.abs(apart)), np.max(np.abs(own)))) <= AT_REST * pull

    hold()
    rate = rested.settings.tick_rate
    yield from as_part(_run(hold_on, round(MOST_HELD * rate)), 0.0, 0.5)
    pulled.unpin(particle)
    hold()
    errors = [float((pulled.position[particle] - still.position[particle]) @ along)]
    window, ticks = _window(rested), round(MOST_SECONDS * rate)
    for tick in range(ticks):
        step(still)
        step(pulled)
        yield 0.5 + 0.5 * tick / ticks
        errors.append(float((pulled.position[particle] - still.position[particle]) @ along))
        recent = errors[-window:]
        if len(errors) > window and max(recent) - min(recent) <= AT_REST * pull:
            break
    return np.array(errors)
