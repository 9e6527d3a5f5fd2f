"""Belts: surfaces of terrain and of bodies' edges that run along, to the right of who stands on them."""

from sandbox.physics.collision.narrow_phase import EDGE, INSIDE, KINDS, TERRAIN, TIP, TIP_SHIFT
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.types import Contacts
from sandbox.physics.jit import inner_kernel
from sandbox.physics.state import State


@inner_kernel
def has_belts(state: State) -> bool:
    """Whether any surface runs."""
    found = False
    for s in range(state.belt.shape[0]):
        found = found or state.belt[s] != 0.0
    for e in range(state.terrain.belt.shape[0]):
        found = found or state.terrain.belt[e] != 0.0
    return found


@inner_kernel
def _belt_at(v: int, outline: Outline, state: State) -> float:
    # The mean speed of the edges that end at a vertex, 0: there are none.
    first, last = outline.edge_start[v], outline.edge_start[v + 1]
    total = 0.0
    for at in range(first, last):
        e = outline.edge_of[at]
        number = outline.number[e]
        total += state.belt[number] if e < outline.dynamic[0] else state.terrain.belt[number]
    return total / (last - first) if last > first else 0.0


@inner_kernel
def load_belts(contacts: Contacts, count: int, outline: Outline, state: State) -> None:
    """Load how fast both surfaces of the first `count` contacts run, each to the right of who stands on it."""
    for c in range(count):
        kind, number = contacts.feature[c] % KINDS, contacts.feature[c] // KINDS
        p = contacts.particle[c]
        if kind == TIP:
            # An edge of a body on a corner of terrain.
            corner = state.owner.shape[0] + number // TIP_SHIFT
            contacts.belt[c] = state.belt[number % TIP_SHIFT] + _belt_at(corner, outline, state)
            continue
        belt = 0.0
        if kind == TERRAIN:
            belt = state.terrain.belt[number]
        elif kind in (EDGE, INSIDE):
            belt = state.belt[number]
        contacts.belt[c] = belt + _belt_at(p, outline, state)
