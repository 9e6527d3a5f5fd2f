"""Collisions of a step: what touches is found and, where no spring holds it, solved; the rest is left to a solver.

Arrays whose length a step decides have room for more than there is. `detect` says where there is too little, and
has changed nothing by then but scratch.
"""

from typing import Annotated, NamedTuple

from sandbox.physics.arrays import Flags, FloatRows, Slots
from sandbox.physics.collision.broad_phase import Boxes, Candidates, Grid, cell_size, fill_grid, find_pairs
from sandbox.physics.collision.contacts import carry_over, fill_boxes, find_contacts, find_terrain, update_aabbs
from sandbox.physics.collision.outline import Outline
from sandbox.physics.collision.surfaces import SURFACE_WEIGHT, choose_partners, find_bounces, load_arms
from sandbox.physics.collision.tunnelling import clamp_at_pins, clamp_at_terrain, clamp_at_tips, stop_discs
from sandbox.physics.collision.types import (
    TOUCHING,
    Colliders,
    Contacts,
    KeptContacts,
    Near,
    contacts_between,
    sort_contacts,
    weight_of,
)
from sandbox.physics.jit import inner_kernel
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.solvers.contact.free_constraints import (
    FreeContactScratch,
    Islands,
    find_islands,
    list_contacts,
    small_steps,
)
from sandbox.physics.solvers.contact.free_contacts import solve_free_contacts
from sandbox.physics.state import State
from sandbox.physics.untangling.depenetration import MovedParticles, depenetrate
from sandbox.physics.untangling.jellies import Inversions, Triangles, find_inverted
from sandbox.physics.untangling.overlaps import (
    CROSSINGS,
    OVERLAPS,
    Overlaps,
    ShapeBounds,
    find_crossings,
    pair_overlaps,
)
from sandbox.physics.ways import Ways

# Places in `counts`: contacts of the present step and of the last, entries of the grid, pairs by boxes, with terrain,
# crossings of outlines, pairs of shapes that overlap; coupled contacts, which a solver solves with springs; islands of
# the others.
CONTACTS, KEPT, ENTRIES, PAIRS, TERRAIN_PAIRS, CROSSED, OVERLAPPING, COUPLED, FREE_ISLANDS, COUNTED = range(10)
# Rounds in which edges are stopped at corners of terrain, and particles at terrain; the latter has the last word.
TIP_ROUNDS = 4


class Collisions(NamedTuple):
    """The part of a world's collisions that its topology decides, and arrays that a step fills in."""

    outline: Outline
    triangles: Triangles
    colliders: Colliders
    boxes: Boxes
    grid: Grid
    candidates: Candidates
    bounds: Annotated[FloatRows, "spans, 5"]  # (k, 5): see update_aabbs
    near: Near
    contacts: Contacts  # the first counts[COUPLED] are solved with springs, the others by free islands
    source: Annotated[Slots, "rows"]  # (k,): scratch
    place: Annotated[Slots, "rows"]  # (k,): where the contacts are, as they were found
    kept: KeptContacts  # contacts of the last step; the first counts[KEPT] are the world's
    islands: Islands
    work: FreeContactScratch
    inversions: Inversions
    shape_bounds: ShapeBounds
    overlaps: Overlaps
    moved: Annotated[Flags, "particles"]  # (n,): scratch
    attached: Annotated[Flags, "particles"]  # (n,): springs, constraints or hands hold it
    counts: Slots


@inner_kernel
def _load_particles(state: State, attached: Flags, colliders: Colliders) -> None:
    for p in range(state.radius.shape[0]):
        for axis in range(2):
            colliders.position[p, axis] = state.position[p, axis]
            colliders.velocity[p, axis] = state.velocity[p, axis]
            colliders.origin[p, axis] = state.origin[p, axis]
        colliders.radius[p] = state.radius[p]
        colliders.friction[p] = state.friction[p]
        colliders.restitution[p] = state.restitution[p]
        colliders.group[p] = state.group[p]
        colliders.collides[p] = state.collides[p] if state.particle_active[p] else 0
        colliders.inverse_mass[p] = state.inverse_mass[p]
        colliders.rolling[p] = state.rolling[p]
        turns = state.rolls[p] and not attached[p] and state.radius[p] > 0.0
        colliders.turning[p] = SURFACE_WEIGHT * state.inverse_mass[p] if turns else 0.0


@inner_kernel
def update_terrain_aabbs(collisions: Collisions) -> None:
    """Update the bounding boxes of solid terrain, which does not move."""
    outline = collisions.outline
    update_aabbs(collisions.colliders, outline, outline.dynamic[1], outline.solid.shape[0], collisions.bounds)


@inner_kernel
def _find_overlaps(collisions: Collisions, larges: int) -> bool:
    # Which bodies part in this step; whether there is room for them.
    outline, colliders, overlaps = collisions.outline, collisions.colliders, collisions.overlaps
    counts = collisions.counts
    counts[CROSSED] = find_crossings(
        collisions.boxes, collisions.grid, larges, colliders, outline, collisions.shape_bounds, overlaps
    )
    if overlaps.counts[CROSSINGS] > overlaps.edge.shape[0]:
        return False
    counts[OVERLAPPING] = pair_overlaps(
        colliders, outline, collisions.bounds, collisions.kept, counts[KEPT], overlaps
    )  # fmt: skip
    return counts[OVERLAPPING] <= overlaps.shape.shape[0]


@inner_kernel
def detect(state: State, collisions: Collisions, grab_spring: int, tick: int, h: float) -> bool:
    """Broad and narrow phase of a step of h [s]: its contacts, and which are left to a solver; whether there is room.

    Bounces and impulses come later. grab_spring: the first spring of a hand, -1: there is none.
    """
    outline, colliders, counts, boxes = collisions.outline, collisions.colliders, collisions.counts, collisions.boxes
    # Mark what springs, constraints or hands hold.
    attached = collisions.attached
    for p in range(attached.shape[0]):
        attached[p] = collisions.outline.attached[p]
    if grab_spring >= 0:
        for s in range(grab_spring, grab_spring + GRAB_COUNT):
            if state.spring_active[s]:
                attached[state.particle_a[s]] = True
                attached[state.particle_b[s]] = True
    _load_particles(state, collisions.attached, colliders)
    if collisions.triangles.constraint.shape[0] > 0:
        find_inverted(
            state.position, state.constraint_rest, collisions.triangles, collisions.inversions, colliders.inverted
        )
    fill_boxes(colliders, outline.dynamic[0], h, boxes)
    cell = cell_size(boxes.box)
    larges, entries = fill_grid(boxes, cell, collisions.grid)
    counts[ENTRIES] = entries
    if entries > collisions.grid.object.shape[0]:
        return False
    pairs, terrain_pairs = collisions.candidates.pairs, collisions.candidates.terrain
    counts[PAIRS] = find_pairs(boxes, collisions.grid, larges, pairs)
    counts[TERRAIN_PAIRS] = find_terrain(boxes, state.terrain, terrain_pairs)
    if counts[PAIRS] > pairs.other.shape[0] or counts[TERRAIN_PAIRS] > terrain_pairs.other.shape[0]:
        return False
    update_aabbs(colliders, outline, 0, outline.dynamic[1], collisions.bounds)
    if not _find_overlaps(collisions, larges):
        return False
    count = find_contacts(
        colliders, outline, collisions.candidates, collisions.bounds, collisions.near,
        collisions.kept, counts[KEPT], tick, h, collisions.contacts, state.terrain,
    )  # fmt: skip
    counts[CONTACTS] = count
    if count >= collisions.contacts.particle.shape[0]:
        return False
    carry_over(collisions.contacts, count, collisions.kept, counts[KEPT])
    choose_partners(collisions.contacts, count, collisions.attached, colliders, collisions.moved)
    counts[COUPLED] = find_islands(
        collisions.contacts, count, state.inverse_mass, collisions.attached, collisions.islands
    )  # fmt: skip
    counts[FREE_ISLANDS] = list_contacts(collisions.islands, collisions.place[:count], collisions.source[:count])
    return True


@inner_kernel
def sort_by_solver(collisions: Collisions) -> None:
    """Sort contacts by who solves them, once a solver has put the coupled ones of `source` into its order."""
    sort_contacts(collisions.contacts, collisions.source[: collisions.counts[CONTACTS]], collisions.place)


@inner_kernel
def separate_overlaps(state: State, start: FloatRows, collisions: Collisions) -> None:
    """Push overlapping bodies apart; start [m/s] (n, 2): velocities before anything acted."""
    if collisions.overlaps.counts[OVERLAPS] > 0:
        moved = MovedParticles(
            state.velocity, start, state.mass, state.inverse_mass, state.energy_bank, state.parting_reserve
        )
        depenetrate(
            collisions.outline, collisions.colliders, collisions.bounds, moved, collisions.overlaps, collisions.moved
        )


@inner_kernel
def prepare_contacts(state: State, start: FloatRows, collisions: Collisions, h: float) -> None:
    """Find what bounces in a step of h [s], and how the particles of coupled contacts turn."""
    contacts, counts = collisions.contacts, collisions.counts
    find_bounces(contacts, counts[CONTACTS], start, state.velocity, collisions.attached, h, h / small_steps(h))
    load_arms(contacts, counts[COUPLED], collisions.colliders)


@inner_kernel
def solve_free(state: State, start: FloatRows, collisions: Collisions, ways: Ways, h: float) -> None:
    """Solve contacts of particles that no spring or constraint holds, and follow those."""
    solve_free_contacts(
        collisions.contacts, collisions.islands, collisions.counts[FREE_ISLANDS], collisions.colliders, start,
        state.velocity, state.spin, h, collisions.work, ways,
    )  # fmt: skip


@inner_kernel
def coupled_contacts(collisions: Collisions) -> Contacts:
    """The coupled contacts of a step, which a solver solves with springs."""
    return contacts_between(collisions.contacts, 0, collisions.counts[COUPLED])


@inner_kernel
def mark_pushed(collisions: Collisions, label: Slots, marks: Flags) -> None:
    """Mark the labels of the particles that contacts of the present step push."""
    contacts = collisions.contacts
    for c in range(collisions.counts[CONTACTS]):
        if contacts.impulse[c, 0] > 0.0:
            for end in range(TOUCHING):
                p, _ = weight_of(contacts, c, end)
                if p >= 0:
                    marks[label[p]] = True


@inner_kernel
def store_impulses(collisions: Collisions) -> None:
    """Keep a step's contacts with their impulses for the next, as they were found."""
    contacts, kept, counts = collisions.contacts, collisions.kept, collisions.counts
    for c in range(counts[COUPLED]):
        if contacts.bounce[c] >= 0.0:
            # The impulse of an impact is no guess of what the next step needs.
            contacts.impact[c] += contacts.impulse[c, 0]
            contacts.impulse[c, 0], contacts.impulse[c, 1] = 0.0, 0.0
    for k in range(counts[CONTACTS]):
        c = collisions.place[k]
        kept.particle[k] = contacts.particle[c]
        kept.feature[k] = contacts.feature[c]
        kept.impulse[k, 0] = contacts.impulse[c, 0]
        kept.impulse[k, 1] = contacts.impulse[c, 1]
        kept.impact[k] = contacts.impact[c]
    counts[KEPT] = counts[CONTACTS]


@inner_kernel
def clamp(state: State, collisions: Collisions, h: float) -> None:
    """Stop particles that would cross terrain, or come behind an edge, in the coming h [s]."""
    outline, colliders, ahead = collisions.outline, collisions.colliders, collisions.work.ahead
    terrain, box, candidates = state.terrain, collisions.boxes.box, collisions.candidates
    velocity, inverse_mass = state.velocity, state.inverse_mass
    if outline.dynamic[1] > 0:
        stop_discs(
            collisions.contacts, collisions.place[: collisions.counts[CONTACTS]], outline, colliders, velocity,
            state.mass, inverse_mass, h,
        )  # fmt: skip
    clamp_at_pins(state.position, velocity, ahead, inverse_mass, outline, colliders, box, candidates.pairs.start, h)
    for k in range(TIP_ROUNDS):
        if not clamp_at_tips(
            velocity, inverse_mass, terrain, outline.dynamic[0], colliders, k == TIP_ROUNDS - 1, h
        ):  # fmt: skip
            break
        clamp_at_terrain(
            state.position, velocity, ahead, state.collides, state.particle_active, inverse_mass, terrain, box,
            candidates.terrain.start, h,
        )  # fmt: skip
    clamp_at_terrain(
        state.position, velocity, ahead, state.collides, state.particle_active, inverse_mass, terrain, box,
        candidates.terrain.start, h,
    )  # fmt: skip
    for p in range(ahead.shape[0]):
        state.position[p, 0] += ahead[p, 0]
        state.position[p, 1] += ahead[p, 1]
