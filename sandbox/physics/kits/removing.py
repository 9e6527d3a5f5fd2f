"""Removing: particles are taken out of a world with everything that holds them; their slots stay."""

from typing import Annotated, NamedTuple

import numpy as np

from sandbox.physics.arena import NO_ARENA, Arena, begin, is_full, new_tuple
from sandbox.physics.arrays import Flags, Slots
from sandbox.physics.commands.changes import is_body, release
from sandbox.physics.commands.command import (
    CUT,
    DENIED,
    HAND,
    NOT_ALLOWED,
    PROGRAM,
    REMOVE,
    SPENT,
    UNTOUCHED,
    CutScratch,
    cut,
    denied,
    refusal,
    spend,
)
from sandbox.physics.commands.command_table import RefusedCommand
from sandbox.physics.jit import Bundle, inner_kernel, kernel, unpack
from sandbox.physics.keeping.arguments import PARTICLES, SPRINGS, whole_numbers
from sandbox.physics.marks import BANK_UNOPENED, GRAB_COUNT, LAW_HAND
from sandbox.physics.pipeline.block import GRAB_PARTICLE, GRAB_SPRING, WorldBlock
from sandbox.physics.pipeline.block_owner import block_of
from sandbox.physics.state import GoodValues, State
from sandbox.physics.world import World

# What of particles and springs goes: these particles; the springs, and those particles that no other spring holds
# then; or what hangs on the first particle.
THESE, BODY, HANGING = range(3)
# An answer of `remove` - the place of a particle or spring: it is not there, not in use, or a hand's.
BAD_SLOT = -2


class RemovingScratch(NamedTuple):
    """Scratch: which particles go; pinned ones at them, and at others; a hand; springs that are cut, and how."""

    gone: Annotated[Flags, "particles"]
    anchor: Annotated[Flags, "particles"]
    hand: Annotated[Slots, "3"]
    cut_there: Annotated[Slots, "springs"]
    cutting: CutScratch


@kernel
def remove(
    pointer: Bundle[WorldBlock], arena: Arena, giver: int, way: int, particles: Slots, springs: Slots
) -> int:  # fmt: skip
    """Take out particles in use, every spring and constraint at them, and springs in use; hands that hold one let go.

    way: see THESE; springs only of a BODY. Returns 0, or NO_ARENA, or BAD_SLOT - the place of one that is not there or
    not in use, counted through both; or see DENIED.
    """
    block = unpack(pointer)
    state, count = block.state, block.state.owner.shape[0]
    begin(arena)
    work = new_tuple(RemovingScratch, arena, particles=count, springs=state.law.shape[0])
    if is_full(arena):
        return NO_ARENA
    for k in range(particles.shape[0]):
        if not is_body(state, block.plan[GRAB_PARTICLE], particles[k]):
            return BAD_SLOT - k
    for k in range(springs.shape[0]):
        s = springs[k]
        if not 0 <= s < state.law.shape[0] or not state.spring_active[s] or state.material[s] < 0:
            return BAD_SLOT - particles.shape[0] - k
    why = refusal(state, giver, REMOVE, 1)
    if why == NOT_ALLOWED:
        return denied(why, 0)
    for k in range(particles.shape[0] if giver == HAND else 0):
        if state.untouchable[particles[k]]:
            return denied(UNTOUCHED, k)
    for k in range(springs.shape[0] if giver == HAND else 0):
        if state.spring_untouchable[springs[k]]:
            return denied(UNTOUCHED, particles.shape[0] + k)
    if why == SPENT:
        return denied(why, 0)
    if way == BODY and springs.shape[0] > 0:
        cut(state, block.good, springs, CUT, work.cutting)
    for k in range(particles.shape[0]):
        work.gone[particles[k]] = True
    if way == BODY:
        for s in range(state.law.shape[0]):
            if state.spring_active[s] and state.material[s] >= 0:
                work.gone[state.particle_a[s]] = work.gone[state.particle_b[s]] = False
    elif way == HANGING:
        _find_hanging(state, block.body_label, particles[0], work)
    _let_go(state, block.plan, work)
    at_gone = 0
    for s in range(state.law.shape[0]):
        if state.spring_active[s] and (work.gone[state.particle_a[s]] or work.gone[state.particle_b[s]]):
            work.cut_there[at_gone] = s
            at_gone += 1
    # None, where a body's were cut: what others hold stays.
    if at_gone > 0:
        cut(state, block.good, work.cut_there[:at_gone], CUT, work.cutting)
    _end_touched(state, work.gone)
    _take_out(state, block.good, work.gone)
    spend(state, giver, REMOVE, 1)
    return 0


@inner_kernel
def _find_hanging(state: State, label: Slots, particle: int, work: RemovingScratch) -> None:
    # The body of a particle; what is pinned goes along where all that it holds does.
    for p in range(label.shape[0]):
        work.gone[p] = state.particle_active[p] and label[p] == label[particle]
    for s in range(state.law.shape[0]):
        a, b = state.particle_a[s], state.particle_b[s]
        if state.spring_active[s] and state.material[s] >= 0 and (work.gone[a] or work.gone[b]):
            work.anchor[a] = work.anchor[a] or not work.gone[a]
            work.anchor[b] = work.anchor[b] or not work.gone[b]
    for s in range(state.law.shape[0]):
        a, b = state.particle_a[s], state.particle_b[s]
        if state.spring_active[s] and state.material[s] >= 0 and not work.gone[a] and not work.gone[b]:
            work.anchor[a] = work.anchor[b] = False
    for p in range(label.shape[0]):
        work.gone[p] = work.gone[p] or work.anchor[p]


@inner_kernel
def _let_go(state: State, plan: Slots, work: RemovingScratch) -> None:
    work.hand[0], work.hand[1] = plan[GRAB_PARTICLE], plan[GRAB_SPRING]
    for hand in range(GRAB_COUNT if plan[GRAB_SPRING] >= 0 else 0):
        spring = plan[GRAB_SPRING] + hand
        if state.law[spring] == LAW_HAND and state.spring_active[spring] and work.gone[state.particle_b[spring]]:
            work.hand[2] = hand
            release(state, work.hand)


@inner_kernel
def _end_touched(state: State, gone: Flags) -> None:
    # The constraints that have a corner among what goes: their bodies are changed where one at least was there.
    is_any = False
    for k in range(state.constraint_kind.shape[0]):
        is_any = is_any or (state.constraint_active[k] and _is_touched(state, gone, k))
    for k in range(state.constraint_kind.shape[0] if is_any else 0):
        if _is_touched(state, gone, k):
            state.constraint_active[k] = False
            for c in range(state.constraint_first[k], state.constraint_first[k] + state.constraint_corners[k]):
                state.energy_bank[state.corner_particle[c]] = BANK_UNOPENED


@inner_kernel
def _is_touched(state: State, gone: Flags, k: int) -> bool:
    for c in range(state.constraint_first[k], state.constraint_first[k] + state.constraint_corners[k]):
        if gone[state.corner_particle[c]]:
            return True
    return False


@inner_kernel
def _take_out(state: State, good: GoodValues, gone: Flags) -> None:
    for p in range(gone.shape[0]):
        if gone[p]:
            state.particle_active[p] = False
            state.collides[p] = 0
            state.spin[p] = good.spin[p] = 0.0
            for axis in range(2):
                state.velocity[p, axis] = good.velocity[p, axis] = state.slow_velocity[p, axis] = 0.0


def remove_particles(
    world: World, particles: object, springs: object = (), way: int = THESE, giver: int = PROGRAM
) -> None:  # fmt: skip
    """Take particles out, and every spring and constraint at them; hands that hold one let go. way: see THESE.

    Raises IndexError for one that is not there or not in use, ValueError, and RefusedCommand.
    """
    listed = [whole_numbers(PARTICLES, particles), whole_numbers(SPRINGS, springs)]
    pointer, arena = block_of(world).pointer, np.zeros(1, np.int64)
    while (result := remove(pointer, arena, giver, way, *listed)) == NO_ARENA:
        arena = np.zeros(int(arena[0]), np.int64)
    place = -result % DENIED if result <= -DENIED else BAD_SLOT - result
    if result <= BAD_SLOT:
        name, slots = (PARTICLES, listed[0]) if place < len(listed[0]) else (SPRINGS, listed[1])
        slot = slots[place - (0 if name == PARTICLES else len(listed[0]))]
        if result <= -DENIED:
            raise RefusedCommand.of_denied(result, "particle" if name == PARTICLES else "spring", int(slot))
        raise IndexError(f"{name} {slot}: it is not there, not in use, or a hand's")
    world.topology_version += 1
