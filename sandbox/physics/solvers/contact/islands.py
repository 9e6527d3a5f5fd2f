"""Contact islands: which bodies and loose particles contacts touch, and which of them touch each other."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.collision.types import Contacts, weight_of
from sandbox.physics.jit import inner_kernel, kernel
from sandbox.physics.solvers.contact.gauss_seidel import Blocks
from sandbox.physics.solvers.direct.system import Pattern
from sandbox.physics.world import Floats, Slots, World


class Touching(NamedTuple):
    """The bodies and the loose particles that something touches, in this order a cluster's members; and scratch.

    By member: cluster, before, held, after, limit [J], fresh = its bank is begun in this step; member: of each particle
    (n,), -1: none; row likewise. By body: misfit; due: to be solved again; bouncy, spread: of its springs and elements;
    tangled, aimed: see shape_matching.py. By cluster: total, allowed [J], fails. By row: free, pushed [m/s]. By
    particle: given, change [m/s]: velocities without contacts, and what those add.
    """

    body: Slots
    loose: Slots
    cluster: Slots
    member: Slots
    row: Slots
    before: Floats
    held: Floats
    after: Floats
    limit: Floats
    fresh: NDArray[np.bool_]
    misfit: Floats
    due: NDArray[np.bool_]
    bouncy: NDArray[np.bool_]
    spread: NDArray[np.bool_]
    tangled: NDArray[np.bool_]
    aimed: NDArray[np.bool_]
    total: Floats
    allowed: Floats
    fails: NDArray[np.bool_]
    free: Floats
    pushed: Floats
    given: Floats
    change: Floats


@inner_kernel
def _root(label, node):  # type: ignore[no-untyped-def]
    while label[node] != node:
        label[node] = label[label[node]]
        node = label[node]
    return node


@kernel
def _join(contacts, block, inverse_mass, label):  # type: ignore[no-untyped-def]
    # Label the nodes that touch each other alike: particles (n,), then blocks; what cannot move joins nothing.
    count = block.shape[0]
    for c in range(contacts.particle.shape[0]):
        first = -1
        for end in range(3):
            p, _ = weight_of(contacts, c, end)
            if p < 0 or inverse_mass[p] == 0.0:
                continue
            node = _root(label, p if block[p] < 0 else count + block[p])
            if first < 0:
                first = node
            elif node < first:
                label[first] = node
                first = node
            else:
                label[node] = first
    for node in range(label.shape[0]):
        label[node] = _root(label, node)


def find_touching(world: World, pattern: Pattern, contacts: Contacts) -> tuple[Touching, Blocks]:
    """What contacts touch, and the room for the responses of bodies."""
    rows, bodies, count = pattern.rows, pattern.bodies, world.particle_count
    free_count = int(bodies.row_start[-1])
    row = np.full(count, -1, dtype=np.int64)
    row[rows.particle[:free_count]] = np.arange(free_count)
    ends = np.concatenate([contacts.particle, contacts.end_a, contacts.end_b])
    ends = np.unique(ends[ends >= 0])
    ends = ends[world.inverse_mass[ends] > 0.0]
    points = np.sort(row[ends[row[ends] >= 0]])
    loose = ends[row[ends] < 0]
    body_of_point = np.searchsorted(bodies.row_start, points, side="right") - 1
    body, first, sizes = np.unique(body_of_point, return_index=True, return_counts=True)
    block, place = np.full((2, count), -1, dtype=np.int64)
    particles = rows.particle[points]
    block[particles] = np.repeat(np.arange(len(body)), sizes)
    place[particles] = np.arange(len(points)) - np.repeat(first, sizes)
    base = np.append(0, np.cumsum(4 * sizes * sizes)).astype(np.int64)
    blocks = Blocks(block, place, np.append(first, len(points)), particles, base, np.zeros(base[-1]))
    label = np.arange(count + len(body))
    _join(contacts, block, world.inverse_mass, label)
    _, cluster = np.unique(label[np.append(count + np.arange(len(body)), loose)], return_inverse=True)
    clusters = int(cluster.max()) + 1 if len(cluster) else 0
    size = len(body)
    member = block.copy()
    member[loose] = size + np.arange(len(loose))
    members = size + len(loose)
    flags, sums = np.zeros((5, size), dtype=np.bool_), np.zeros((2, clusters))
    energies, vectors = np.zeros((4, members)), np.zeros((2, free_count, 2))
    touching = Touching._make(
        [
            body, loose, cluster.astype(np.int64), member, row, *energies, np.zeros(members, dtype=np.bool_),
            np.zeros(size), *flags, *sums, np.zeros(clusters, dtype=np.bool_), *vectors, world.velocity.copy(),
            np.zeros((count, 2)),
        ]
    )  # fmt: skip
    return touching, blocks
