"""Connected components of what links join; union-find with path halving (Tarjan 1975)."""

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.state import Slots, StateArrays

Flags = NDArray[np.bool_]


@kernel
def label_bodies(link_a: Slots, link_b: Slots, label: Slots) -> None:
    """Label every node (n,) with the lowest node of its connected component; label holds 0..n-1 at the start."""
    for k in range(link_a.shape[0]):
        a = link_a[k]
        b = link_b[k]
        while label[a] != a:
            label[a] = label[label[a]]
            a = label[a]
        while label[b] != b:
            label[b] = label[label[b]]
            b = label[b]
        if a < b:
            label[b] = a
        else:
            label[a] = b
    # Labels never point upwards, so one ascending pass flattens them.
    for node in range(label.shape[0]):
        label[node] = label[label[node]]


def label_joined(world: StateArrays, springs: Flags, particles: Flags) -> Slots:
    """Label every particle (n,) with the lowest one that it is joined to.

    springs (m,), particles (n,): which of them join; constraints do where they are active.
    """
    joins = springs & particles[world.particle_a] & particles[world.particle_b]
    owner = np.repeat(np.arange(len(world.constraint_corners)), world.constraint_corners)
    corner = np.flatnonzero(world.constraint_active[owner] & particles[world.corner_particle])
    goes_on = owner[corner[:-1]] == owner[corner[1:]]
    link_a, link_b = (
        np.concatenate([of_springs[joins], world.corner_particle[corners[goes_on]]]).astype(np.int64)
        for of_springs, corners in ((world.particle_a, corner[:-1]), (world.particle_b, corner[1:]))
    )
    label = np.arange(len(particles))
    label_bodies(link_a, link_b, label)
    return label


def body_of(world: StateArrays, particle: int) -> Slots:
    """The particles that springs join to one, itself included, also by way of pinned ones; ascending."""
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
