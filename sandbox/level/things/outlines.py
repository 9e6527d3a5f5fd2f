"""Outlines of a world as it is now: rims of bodies, ropes and terrain, as places in order, to be drawn or measured."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.format.look import PALETTE, BodyLook, ParticleLook, colour_of
from sandbox.level.kinds.bodies import expansion
from sandbox.level.things.names import ThingNames
from sandbox.physics.arrays import Floats, Slots
from sandbox.physics.geometry.segment import signed_area
from sandbox.physics.keeping.arguments import of_kind
from sandbox.physics.marks import LINE, NO_EDGE, SOLID_LEFT, SOLID_RIGHT

# The colour of terrain and walls.
GROUND_COLOUR = 0x5B6477


@dataclass(frozen=True, eq=False)
class ThingOutline:
    """A rim of a body or of terrain, or the line of a rope.

    name: id of the thing. points (k, 2) [m]: in order, counter-clockwise about what is solid, so that a hole runs
    clockwise. closed: whether the last is joined to the first. solid: whether it encloses something, that of a hole
    not. particles (k,): slots of the points; of terrain there are none. colour: 0xRRGGBB, that of the level or one of
    the palette; terrain is grey.
    """

    name: str
    points: Floats
    closed: bool
    solid: bool
    particles: Slots
    colour: int


def outlines(world: LevelWorld) -> list[ThingOutline]:
    """The outlines of bodies in the order of the level, then those of terrain, then of walls.

    What was cut or broke has the outlines of its pieces; one that is torn open is a line. Balls have none: they are
    discs, by `position` and `radius`. Nor have bodies whose springs branch without a rim, such as a truss: draw their
    springs. In a level where nothing touches, pieces keep the rim that is left of the whole.
    """
    made = of_kind("world", world, LevelWorld).derived(_rims, of_hands=False)
    names, moved = ThingNames.of(world).names, []
    for rim in made.bodies:
        points = world.position[rim.particles]
        encloses = rim.closed and rim.solid
        moved.append(ThingOutline(names[rim.thing], points, rim.closed, encloses and _turns_left(points), rim.particles,
                             made.colours[rim.thing]))  # fmt: skip
    return [*moved, *made.terrain]


@dataclass(frozen=True, eq=False)
class _Rim:
    thing: int
    particles: Slots
    closed: bool
    solid: bool


@dataclass(frozen=True, eq=False)
class _Rims:
    """Rims that stay while nothing joins, leaves or breaks; colours: by thing."""

    bodies: list[_Rim]
    terrain: list[ThingOutline]
    colours: list[int]


def _rims(world: LevelWorld) -> _Rims:
    things, colours = ThingNames.of(world), _colours(world)
    return _Rims(list(_bodies(world, things)), list(_terrain(world, things)), colours)


def _bodies(world: LevelWorld, things: ThingNames) -> Iterator[_Rim]:
    edge = np.where(world.spring_active, _edges(world), NO_EDGE)
    first, second = world.particle_a.astype(np.int64), world.particle_b.astype(np.int64)
    swapped = edge == SOLID_RIGHT
    ways = np.stack([np.where(swapped, second, first), np.where(swapped, first, second)], axis=1)
    thing = things.of_spring
    is_solid = (edge == SOLID_LEFT) | swapped
    for number in np.unique(thing[edge != NO_EDGE]).tolist():
        mine = thing == number
        solid, lines = ways[mine & is_solid].tolist(), ways[mine & (edge == LINE)].tolist()
        for particles, closed in directed_loops(solid):
            yield _Rim(number, np.array(particles, np.int64), closed, True)
        for particles, closed in plain_lines(lines):
            yield _Rim(number, np.array(particles, np.int64), closed, False)


def _edges(world: LevelWorld) -> Slots:
    """The kind of edge of each spring (m,); in a level where nothing touches as the bodies were made."""
    edges = world.edge.astype(np.int64)
    if edges.any():
        return edges
    named = [(body.id, body) for body in world.level.bodies]
    for joined in world.joined:
        named += zip(joined.names, joined.level.bodies, strict=False)
    slots = {name: slot for slot, name in enumerate(world.spring_names)}
    for name, body in named:
        made = expansion(body)
        for number, kind in zip(made.numbers.tolist(), made.edges.tolist(), strict=True):
            if (slot := slots.get(f"{name}:{number}")) is not None:
                edges[slot] = kind
    return edges


def directed_loops(ways: Iterable[list[int]]) -> Iterator[tuple[list[int], bool]]:
    """Ways from particle to particle, joined end to end, each used once; whether they end where they begin."""
    onward: dict[int, list[int]] = {}
    for start, end in ways:
        onward.setdefault(start, []).append(end)
    # What is torn open begins where nothing leads to.
    ends = {end for following in onward.values() for end in following}
    for start in sorted(onward, key=lambda particle: particle in ends):
        while onward[start]:
            loop = [start]
            while onward.get(loop[-1]):
                loop.append(onward[loop[-1]].pop())
                if loop[-1] == start:
                    break
            closed = loop[-1] == start and len(loop) > 1
            yield (loop[:-1] if closed else loop), closed


def plain_lines(pairs: Iterable[list[int]]) -> Iterator[tuple[list[int], bool]]:
    """The lines that springs make, open or closed; nothing of those that hang together with a branch."""
    beside: dict[int, list[int]] = {}
    for a, b in pairs:
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    remaining = dict.fromkeys(beside)
    while remaining:
        joined, found = [next(iter(remaining))], []
        while joined:
            particle = joined.pop()
            if particle in remaining:
                del remaining[particle]
                found.append(particle)
                joined += beside[particle]
        if max(len(beside[particle]) for particle in found) <= 2:
            yield _walked(found, beside)


def _walked(particles: list[int], beside: dict[int, list[int]]) -> tuple[list[int], bool]:
    ends = [particle for particle in particles if len(beside[particle]) == 1]
    line, before = [min(ends or particles)], None
    while True:
        following = [other for other in beside[line[-1]] if other != before]
        if not following or following[0] == line[0]:
            return line, not ends
        before = line[-1]
        line.append(following[0])


def _turns_left(points: Floats) -> bool:
    return bool(signed_area(points, np.roll(points, -1, axis=0)) > 0.0)


def _terrain(world: LevelWorld, things: ThingNames) -> Iterator[ThingOutline]:
    terrain = world.terrain
    for chain in np.unique(terrain.chain).tolist():
        edges = np.flatnonzero(terrain.chain == chain)
        closed = bool(terrain.edge_b[edges[-1]] == terrain.edge_a[edges[0]])
        corners = terrain.edge_a[edges] if closed else np.append(terrain.edge_a[edges], terrain.edge_b[edges[-1]])
        points, thing = terrain.vertex[corners], int(things.of_terrain[edges[0]])
        solid = closed and bool(terrain.solid[edges[0]]) and _turns_left(points)
        yield ThingOutline(things.names[thing], points, closed, solid, np.zeros(0, np.int64), GROUND_COLOUR)


def _colours(world: LevelWorld) -> list[int]:
    """0xRRGGBB for each thing: what the level says, or one of the palette in turn."""
    said: dict[str, int] = {}
    usual = {name: material.look for name, material in world.level.materials.items()}
    for body in world.level.bodies:
        _say(said, body.id, body.look, usual.get(body.material))
    for particle in world.level.particles:
        _say(said, particle.id, particle.look)
    palette = list(PALETTE.values())
    return [said.get(name, palette[number % len(palette)]) for number, name in enumerate(ThingNames.of(world).names)]


def _say(said: dict[str, int], name: str, *looks: BodyLook | ParticleLook | None) -> None:
    """Note the colour of the first look that has one."""
    colour = next((look.colour for look in looks if look is not None and look.colour), None)
    if colour is not None:
        said[name] = colour_of(colour)
