"""Outlines of bodies: their rims as particles in order."""

from collections.abc import Iterable

import numpy as np

from sandbox.export.flat_model import FlatOutline
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef
from sandbox.physics.collision.filter import SOLID_LEFT, SOLID_RIGHT
from sandbox.physics.world import World


def outlines_of(world: World, body: BodyDef) -> tuple[FlatOutline, ...]:
    """The rims of a body of the world's level, with what is solid on the left; of a rope or a ring, its line.

    Nothing of a body whose springs are no rim, such as a truss.
    """
    made = expansion(body)
    pairs, edges = made.pairs, made.edges
    ways = np.concatenate([pairs[edges == SOLID_LEFT], pairs[edges == SOLID_RIGHT][:, ::-1]])
    found = list(_loops(ways.tolist())) if len(ways) else list(_line(pairs.tolist()))
    slots = [world.particle_slot(f"{body.id}.{number}") for number in range(len(made.mass))]
    return tuple(
        FlatOutline(particles=tuple(slots[number] for number in numbers), closed=closed) for numbers, closed in found
    )


def _loops(ways: list[list[int]]) -> Iterable[tuple[list[int], bool]]:
    """Ways from particle to particle, joined end to end, each used once."""
    onward: dict[int, list[int]] = {}
    for start, end in ways:
        onward.setdefault(start, []).append(end)
    for start in list(onward):
        while onward[start]:
            loop = [start]
            while onward.get(loop[-1]):
                loop.append(onward[loop[-1]].pop())
                if loop[-1] == start:
                    break
            closed = loop[-1] == start and len(loop) > 1
            yield (loop[:-1] if closed else loop), closed


def _line(pairs: list[list[int]]) -> Iterable[tuple[list[int], bool]]:
    """The one line that all springs make, open or closed; nothing where they branch or are several."""
    beside: dict[int, list[int]] = {}
    for a, b in pairs:
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    if not beside or max(map(len, beside.values())) > 2:
        return
    ends = [particle for particle, others in beside.items() if len(others) == 1]
    line, before = [ends[0] if ends else pairs[0][0]], None
    while len(line) <= len(beside):
        following = [other for other in beside[line[-1]] if other != before]
        if not following or following[0] == line[0]:
            break
        before = line[-1]
        line.append(following[0])
    if len(line) == len(beside):
        yield line, not ends
