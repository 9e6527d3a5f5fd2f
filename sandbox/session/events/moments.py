"""Moments: what a run itself keeps of its ticks: springs that broke, rules that fired, values that were taken back."""

from dataclasses import dataclass

import numpy as np

from sandbox.physics.world import World

# Ticks in which nothing but a rule fired are kept up to this many: one may fire in every other tick for hours.
MOST_FIRED = 10_000


@dataclass(frozen=True)
class KeptMoment:
    """What happened in a tick that the state after it does not tell.

    broken: slots of springs; rules: of the level, by number; counters: their values, before what those rules do;
    frozen: names of what the quarantine froze.
    """

    broken: tuple[int, ...] = ()
    rules: tuple[int, ...] = ()
    counters: tuple[float, ...] = ()
    frozen: tuple[str, ...] = ()


# By the tick, in no order.
Moments = dict[int, KeptMoment]


def note_moment(moments: Moments, world: World) -> None:
    """Take in the last tick of a world, in place of what was known of it; most ticks have nothing."""
    moments.pop(world.tick, None)
    fired = world.rule_last == world.tick if len(world.rule_last) else None
    rules = () if fired is None or not fired.any() else tuple(np.flatnonzero(fired).tolist())
    if not (len(world.broken) or rules or world.contained):
        return
    frozen = tuple(dict.fromkeys(hit.name for hit in world.contained if hit.frozen))
    moment = KeptMoment(tuple(world.broken.tolist()), rules, tuple(world.counter.tolist()) if rules else (), frozen)
    if moment.broken or moment.frozen or (rules and len(moments) < MOST_FIRED):
        moments[world.tick] = moment


def until(moments: Moments, tick: int) -> Moments:
    """Those up to a tick."""
    return {each: moment for each, moment in moments.items() if each <= tick}
