"""Connected components of what links join; union-find with path halving (Tarjan 1975)."""

import numpy as np

from sandbox.physics.arrays import Flags, Slots
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.keeping.arguments import active_particles
from sandbox.physics.state import State, StateArrays


@inner_kernel
def label_linked(link_a: Slots, link_b: Slots, label: Slots) -> None:
    """Label every node (n,) with the lowest node of its connected component; label holds 0..n-1 at the start."""
    for k in range(link_a.shape[0]):
        join(label, link_a[k], link_b[k])
    # Labels never point upwards, so one ascending pass flattens them.
    for node in range(label.shape[0]):
        label[node] = label[label[node]]


@kernel
def label_bodies(link_a: Slots, link_b: Slots, label: Slots) -> None:
    """Label every node as `label_linked` does."""
    label_linked(link_a, link_b, label)


@inner_kernel
def find_joined(state: State, springs: Flags, particles: Flags, label: Slots) -> None:
    """Label every particle (n,) with the lowest one that it is joined to.

    springs (m,), particles (n,): which of them join; constraints do where they are active.
    """
    for p in range(label.shape[0]):
        label[p] = p
    for s in range(springs.shape[0]):
        a, b = state.particle_a[s], state.particle_b[s]
        if springs[s] and particles[a] and particles[b]:
            join(label, a, b)
    corner = 0
    for k in range(state.constraint_corners.shape[0]):
        before = -1
        for _ in range(state.constraint_corners[k]):
            p = state.corner_particle[corner]
            corner += 1
            if state.constraint_active[k] and particles[p]:
                if before >= 0:
                    join(label, before, p)
                before = p
    for p in range(label.shape[0]):
        label[p] = root_of(label, p)


@inner_kernel
def list_body(state: State, particle: int, label: Slots, body: Slots) -> int:
    """List the particles that springs join to one, as `body_of` does; how many they are. label, body: (n,), scratch."""
    for p in range(label.shape[0]):
        label[p] = p
    for s in range(state.spring_active.shape[0]):
        if state.spring_active[s] and state.material[s] >= 0:
            join(label, state.particle_a[s], state.particle_b[s])
    own, count = root_of(label, particle), 0
    for p in range(label.shape[0]):
        if state.particle_active[p] and root_of(label, p) == own:
            body[count] = p
            count += 1
    return count


def body_of(world: StateArrays, particle: int) -> Slots:
    """The particles that springs join to one, itself included, also by way of pinned ones; ascending.

    Raises IndexError for a particle that is not there or not in use, and ValueError.
    """
    (particle,) = active_particles(world, "particle", [particle])
    joined = np.flatnonzero(world.spring_active & (world.material >= 0))
    label = np.arange(len(world.particle_active))
    label_bodies(world.particle_a[joined].astype(np.int64), world.particle_b[joined].astype(np.int64), label)
    return np.flatnonzero((label == label[particle]) & world.particle_active)


@inner_kernel
def root_of(label: Slots, node: int) -> int:
    """The label of the set that a node is in."""
    while label[node] != node:
        label[node] = label[label[node]]
        node = label[node]
    return node


@inner_kernel
def united(label: Slots, first: int, node: int) -> int:
    """The label of two sets, by their labels, once they are one; first below 0: there was none before."""
    if first < 0:
        return node
    if node < first:
        label[first] = node
        return node
    label[node] = first
    return first


@inner_kernel
def join(label: Slots, a: int, b: int) -> None:
    """Unite the sets that two nodes are in."""
    first, other = root_of(label, a), root_of(label, b)
    if first != other:
        united(label, first, other)
