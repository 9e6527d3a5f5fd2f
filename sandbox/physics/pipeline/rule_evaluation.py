"""Judging: rules are evaluated at the end of a tick, once springs that break have left the world."""

import math

from sandbox.physics.jit import Bundle, inner_kernel, kernel, unpack
from sandbox.physics.marks import DISC, KINDS, TERRAIN, TIP, TIP_SHIFT
from sandbox.physics.pipeline.block import TICK, WorldBlock
from sandbox.physics.pipeline.collide import KEPT
from sandbox.physics.rules import ALL, ANY, NOBODY, NOT, TOUCHES, Terms, Things, measure
from sandbox.physics.settings import TICK_RATE
from sandbox.physics.ways import store_places


@kernel
def judge(pointer: Bundle[WorldBlock]) -> int:
    """Evaluate all rules at the end of a tick; how many fired, whose actions are due before the next one.

    It changes nothing but the arrays of rules, of probes, and of what has settled.
    """
    world = unpack(pointer)
    rules, state = world.rules, world.state
    terms, tick = rules.terms, world.progress[TICK] + 1
    for t in range(terms.kind.shape[0]):
        terms.holds[t] = False
    _find_touches(world)
    for t in range(terms.kind.shape[0]):
        kind = terms.kind[t]
        if kind in (ALL, ANY, NOT):
            terms.holds[t] = _holds_of_members(terms, t)
        elif kind != TOUCHES:
            terms.value[t] = measure(rules, t, state, world.ways, tick, world.choices[TICK_RATE])
            # Of nothing nothing holds.
            terms.holds[t] = terms.low[t] <= terms.value[t] <= terms.high[t] and terms.value[t] < math.inf
    fired = 0
    for r in range(rules.term.shape[0]):
        state.rule_held[r] = state.rule_held[r] + 1 if rules.terms.holds[rules.term[r]] else 0
        is_over = rules.once[r] and state.rule_fired[r] > 0
        if state.rule_held[r] != rules.delay[r] + 1 or is_over:
            continue
        if state.rule_fired[r] == 0:
            state.rule_first[r] = tick
        state.rule_last[r] = tick
        state.rule_fired[r] += 1
        state.rule_due[r] = True
        fired += 1
    store_places(world.ways, state)
    return fired


@inner_kernel
def _holds_of_members(terms: Terms, t: int) -> bool:
    count = 0
    for at in range(terms.first[t], terms.last[t]):
        if terms.holds[terms.member[at]]:
            count += 1
    if terms.kind[t] == ALL:
        return count == terms.last[t] - terms.first[t]
    return count > 0 if terms.kind[t] == ANY else count == 0


@inner_kernel
def _find_touches(world: WorldBlock) -> None:
    """Set terms of TOUCHES to true whose things push each other."""
    terms, things, kept = world.rules.terms, world.rules.things, world.collisions.kept
    asking = 0
    while asking < terms.kind.shape[0] and terms.kind[asking] == TOUCHES:
        asking += 1
    if asking == 0:
        return
    for c in range(world.collisions.counts[KEPT]):
        if not (kept.impulse[c, 0] > 0.0 or kept.impact[c] > 0.0):
            continue
        one, other = _thing(things, kept.particle[c]), _thing_touched(things, kept.feature[c])
        for t in range(asking):
            a, b = terms.zone[t], terms.other[t]
            if (a == one and b in (other, NOBODY)) or (a == other and b in (one, NOBODY)):
                terms.holds[t] = True


@inner_kernel
def _thing(things: Things, p: int) -> int:
    # What joined the world while it ran is named by no rule.
    return things.of_particle[p] if p < things.of_particle.shape[0] else NOBODY


@inner_kernel
def _thing_touched(things: Things, feature: int) -> int:
    number, kind = feature // KINDS, feature % KINDS
    if kind == DISC:
        return _thing(things, number)
    if kind == TERRAIN:
        return things.of_terrain[number]
    s = number % TIP_SHIFT if kind == TIP else number
    return things.of_spring[s] if s < things.of_spring.shape[0] else NOBODY
