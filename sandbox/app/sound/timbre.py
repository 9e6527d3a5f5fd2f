"""Timbre: what each body of a run sounds like: its stuff from its look, its pitch from size, mass and stiffness."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.looks import GRAINS, STRANDS, Look, ball_look, body_looks
from sandbox.app.draw.things.level_slots import level_slots_of
from sandbox.app.sound.waves import STUFFS
from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arrays import Floats, Slots

# What the stuff of a skin, a line or a ball sounds like.
_SKINS = {
    "jelly": "jelly", "plain": "jelly", "rubber": "rubber", "balloon": "rubber", "tyre": "rubber", "cloth": "cloth",
    "wood": "wood", "stone": "stone", "brick": "stone", "steel wheel": "metal",
}  # fmt: skip
_LINES = {
    "steel": "metal", "paint": "metal", "brass": "metal", "chain": "metal", "piston": "metal", "deck": "wood",
    "wood": "wood", "bone": "wood", "muscle": "jelly", "rubber": "rubber", "coil": "metal", "hidden": "rubber",
}  # fmt: skip
_BALLS = {
    "marble": "glass", "stripe": "rubber", "steel": "metal", "sand": "stone", "bumper": "metal", "plain": "wood",
}  # fmt: skip
# What rubs with a squeak.
SQUEAKING = ("jelly", "rubber")
# How fast pitch falls with size [m] and with mass [kg], and rises with Cs over that of a usual jelly.
BY_SIZE, BY_MASS, BY_STIFFNESS, USUAL_STIFFNESS = 0.6, 0.08, 0.15, 0.02
# Small things are quieter than one of 0.6 m, by this power of their size, to no less than this.
LOUD_SIZE, QUIETER, LEAST = 0.6, 0.5, 0.3


@dataclass(frozen=True, eq=False)
class Timbres:
    """The bodies of a world by number, b of them.

    body (n,): of every particle. By number (b,): owner, as the world calls them; mass [kg]; size [m]; pitch [Hz] when
    struck; weight 0..1, how loud they are beside others; strand: whether they are strings; squeaks: whether they do
    where they rub; stuff, of STUFFS. strings: slots of the springs of strings; balls: those that are a body each.
    """

    body: Slots
    owner: Slots
    mass: Floats
    size: Floats
    pitch: Floats
    weight: Floats
    strand: NDArray[np.bool_]
    squeaks: NDArray[np.bool_]
    strings: Slots
    balls: Slots
    stuff: list[str]


def timbres_of(world: LevelWorld) -> Timbres:
    """The bodies of a world as they are now."""
    owners, body = np.unique(world.owner, return_inverse=True)
    body = body.reshape(-1)
    count = len(owners)
    mass = np.bincount(body, world.mass, count).astype(np.float64)
    share = np.bincount(body, minlength=count)
    spread = np.zeros(count)
    for axis in range(2):
        mean = np.bincount(body, world.origin[:, axis], count) / share
        spread += np.bincount(body, (world.origin[:, axis] - mean[body]) ** 2, count) / share
    size = 2.0 * np.sqrt(spread) + 2.0 * np.bincount(body, world.radius, count) / share
    first = body[np.minimum(world.particle_a, len(body) - 1)]
    held = np.bincount(first, minlength=count)
    stiffness = np.where(
        held > 0, np.bincount(first, world.stiffness, count) / np.maximum(held, 1), USUAL_STIFFNESS
    )  # fmt: skip
    kinds = dict(_kinds(world))
    # The number of a piece that was cut off says its first particle alone.
    is_cut = bool(np.any(world.owner[shown_particles(world)] < 0))
    wholes = np.where(owners < 0, _wholes(world)[-1 - np.minimum(owners, -1)], owners) if is_cut else owners
    found = [kinds.get(int(owner), ("rubber", False)) for owner in wholes]
    stuff = [kind for kind, _ in found]
    pitch = np.array([STUFFS[kind].pitch for kind in stuff])
    with np.errstate(all="ignore"):
        pitch = pitch * np.maximum(size, 1e-3) ** -BY_SIZE * np.maximum(mass, 1e-6) ** -BY_MASS
        pitch *= np.clip(stiffness / USUAL_STIFFNESS, 0.01, 100.0) ** BY_STIFFNESS
        weight = np.clip((size / LOUD_SIZE) ** QUIETER, LEAST, 1.0)
    strand = np.array([is_strand for _, is_strand in found], dtype=np.bool_)
    squeaks = np.array([kind in SQUEAKING for kind in stuff], dtype=np.bool_)
    strings = np.flatnonzero(strand[first] & (world.material >= 0))
    balls = np.flatnonzero((share[body] == 1) & (world.owner >= 0))
    return Timbres(body, owners.astype(np.int64), mass, size, pitch, weight, strand, squeaks, strings, balls, stuff)


def _kinds(world: LevelWorld) -> Iterator[tuple[int, tuple[str, bool]]]:
    """Owner, stuff and whether it is a string, of every body of the level and of what joined it."""
    yield from enumerate(_of_level(world.level))
    for joined in world.joined:
        if joined.first_particle < len(world.owner):
            yield from enumerate(_of_level(joined.level), int(world.owner[joined.first_particle]))


def _wholes(world: LevelWorld) -> Slots:
    """The numbers (n,) that the bodies of particles had before anything was cut; -1: it is of no body of a level."""
    found = np.full(len(world.owner), -1, dtype=np.int64)
    parts = [(0, 0, world.level)]
    parts += [(each.first_particle, int(world.owner[each.first_particle]), each.level) for each in world.joined]
    for first, owner, level in parts:
        for number, actor in enumerate(level_slots_of(level).actors):
            found[first + actor.slots] = owner + number
    return found


def _of_level(level: Level) -> Iterator[tuple[str, bool]]:
    for look in body_looks(level):
        yield _of_look(look)
    many = sum(not particle.pinned for particle in level.particles) > GRAINS
    for index, particle in enumerate(level.particles):
        yield _BALLS[ball_look(level, particle, index, many)[0]], False


def _of_look(look: Look) -> tuple[str, bool]:
    if look.skin in _SKINS:
        return _SKINS[look.skin], False
    if look.line in STRANDS and look.line not in ("deck", "chain"):
        return "cloth", True
    return _LINES[look.line], look.line == "chain"
