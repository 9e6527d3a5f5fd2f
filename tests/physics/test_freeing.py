"""Bodies that are freed: by the shortest way, to where they touch nothing, the same compiled and interpreted."""

import json
import math

import numpy as np
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.parse import parse_level
from sandbox.physics.arena import NO_ARENA
from sandbox.physics.commands.changes import CLEAR, FREED, free_body
from sandbox.physics.commands.command import (
    BODY_PINNED,
    FREE,
    NO_FREE_PLACE,
    NOTHING_TO_FREE,
    PROGRAM,
    REASONS,
    command,
)
from sandbox.physics.components import body_of, list_body
from sandbox.physics.geometry.segment import distances_from_segments, winding_number
from sandbox.physics.state import good_of, state_of
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.physics.world import World
from tests.support.overlaps import overlaps
from tests.support.random_scenes import random_level
from tests.support.tangles import tangle

WORDS = 1 << 20
SEEDS = range(8)
BOX = np.array([[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]])
TABLE = np.array([[-1.0, -1.5], [1.0, -1.5], [1.0, -0.5], [-1.0, -0.5]])


def freed(world, particle, words=WORDS):
    return given_to_kernel(world, particle, np.zeros(words, np.int64))


def given_to_kernel(world, particle, arena):
    result = command(world.lent, arena, PROGRAM, FREE, np.array([-1, particle]), np.zeros(0))
    return result if result == NO_ARENA else -result % REASONS


def discs(places, radius=0.2, chains=()):
    world = World()
    world.add_particles([f"p.{k}" for k in range(len(places))], places, radius=radius, collides=1,
                        owner=-1 - np.arange(len(places)))  # fmt: skip
    world.change("velocity", 3.0)
    world.terrain = make_terrain(chains)
    return world


def crowd(seed):
    """A level of a few bodies and a hill in a room, all of whose bodies were pushed into one corner of it."""
    world = build_world(parse_level(json.dumps(random_level(seed)).encode(), "crowd"))
    particles = np.flatnonzero(world.particle_active)
    for p in particles.tolist():
        body = body_of(world, p)
        if body[0] == p:
            middle = world.position[body].mean(axis=0)
            world.change("position", world.position[body] - middle + [0.1 * (p % 7), 2.0], body)
    return world


def bytes_of(world):
    arrays = [*state_of(world)[:-1], *world.good.values()]
    return [array.tobytes() for array in arrays]


def test_a_disc_that_touches_nothing_in_its_box_comes_to_rest_where_it_is():
    world = discs([[0.5, 0.25], [-1.0, 1.0]], chains=[Chain(BOX, "hollow"), Chain(TABLE, "solid")])
    before = world.position.copy()
    assert freed(world, 0) == FREED
    assert np.array_equal(world.position, before)
    assert not world.velocity[0].any() and (world.velocity[1] == 3.0).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_no_shorter_way_of_those_that_are_tried_would_free_a_disc(seed):
    generator = np.random.default_rng(seed)
    places, radius = generator.uniform(-1.2, 1.2, (40, 2)), generator.uniform(0.1, 0.3, 40)
    world = discs(places, radius, [Chain(BOX, "hollow"), Chain(TABLE, "solid")])
    loops = [(loop, np.roll(loop, -1, axis=0)) for loop in (BOX, TABLE)]

    def is_free(place):
        gaps = np.linalg.norm(places[1:] - place, axis=1) - CLEAR * (radius[1:] + radius[0])
        walls = [distances_from_segments(place, a, b).min() - CLEAR * radius[0] for a, b in loops]
        inside = winding_number(place, *loops[0]) == 1 and winding_number(place, *loops[1]) == 0
        return inside and min(gaps.min(), *walls) >= 0.0

    assert freed(world, 0) == FREED
    way = world.position[0] - places[0]
    ring = math.hypot(*way) / (2.0 * radius[0])
    assert is_free(world.position[0]) and not is_free(places[0])
    assert ring == pytest.approx(round(ring), abs=1e-6) and ring > 0.5
    for far in range(1, round(ring)):
        for angle in np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False):
            assert not is_free(places[0] + 2.0 * radius[0] * far * np.array([np.cos(angle), np.sin(angle)]))


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_freed_lies_in_no_solid_and_has_nothing_in_itself(seed):
    world = crowd(seed)
    terrain = world.terrain
    chains = [np.flatnonzero(terrain.chain == chain) for chain in np.unique(terrain.chain)]
    loops = [(terrain.vertex[terrain.edge_a[edges]], terrain.vertex[terrain.edge_b[edges]]) for edges in chains]
    walls = [winding_number(np.array([0.0, 9.9]), a, b) for a, b in loops]
    for particle in np.flatnonzero(world.particle_active).tolist():
        assert freed(world, particle) == FREED
        for place in world.position[body_of(world, particle)]:
            assert [winding_number(place, a, b) for a, b in loops] == walls
    found = overlaps(world)
    assert not found.depth and not found.lines


def test_a_disc_inside_of_a_body_comes_out_of_it_and_so_does_the_body_from_round_a_disc():
    ring = 0.8 * np.array([[math.cos(a), math.sin(a)] for a in np.linspace(0.0, 2.0 * math.pi, 12, endpoint=False)])
    for particle in (0, 12):
        world = World()
        world.add_particles([f"ring.{k}" for k in range(12)], ring, radius=0.02, owner=0, collides=1)
        world.add_springs([f"ring:{k}" for k in range(12)], np.arange(12), (np.arange(12) + 1) % 12, edge=2)
        world.add_particles(["disc"], [[0.1, 0.0]], radius=0.1, owner=-13, collides=1)
        assert freed(world, particle) == FREED
        a = world.position[:12]
        assert winding_number(world.position[12], a, np.roll(a, -1, axis=0)) == 0
        assert np.array_equal(world.position[12], [0.1, 0.0]) == (particle == 0)


@pytest.mark.parametrize("seed", SEEDS[:4])
def test_kernels_free_a_body_to_the_same_bits_interpreted_and_compiled(seed):
    compiled, other = crowd(seed), crowd(seed)
    assert freed(compiled, 0) == free_body(state_of(other), good_of(other), np.zeros(WORDS, np.int64), 0) == FREED
    assert bytes_of(compiled) == bytes_of(other)
    assert bytes_of(compiled) != bytes_of(crowd(seed))


def test_an_arena_that_is_too_small_says_how_large_it_has_to_be_and_leaves_the_world_as_it_was():
    world = crowd(1)
    before, words, tries = bytes_of(world), 1, 0
    arena = np.zeros(words, np.int64)
    while given_to_kernel(world, 0, arena) == NO_ARENA:
        assert bytes_of(world) == before and arena[0] > len(arena)
        arena, tries = np.zeros(int(arena[0]), np.int64), tries + 1
    roomy = crowd(1)
    assert tries > 0 and freed(roomy, 0) == FREED and bytes_of(world) == bytes_of(roomy)


def test_what_cannot_be_freed_stays_as_it_is_for_a_reason():
    full = [[x, y] for x in np.linspace(-2.8, 2.8, 15) for y in np.linspace(-2.8, 2.8, 15)]
    world = discs(full, 0.19, [Chain(BOX, "hollow")])
    world.change("position", [0.1, 0.1], 0)
    before = bytes_of(world)
    assert freed(world, 0) == NO_FREE_PLACE and bytes_of(world) == before
    world.pin(0)
    before = bytes_of(world)
    assert freed(world, 0) == BODY_PINNED and bytes_of(world) == before
    world.change("collides", 0)
    before = bytes_of(world)
    assert freed(world, 0) == NOTHING_TO_FREE and bytes_of(world) == before


@pytest.mark.parametrize("seed", SEEDS)
def test_a_body_is_what_springs_join_whether_a_kernel_lists_it_or_not(seed):
    world = tangle(seed, 60)
    world.cut(np.flatnonzero(world.spring_active & (world.material >= 0))[seed % 3 :: 2].tolist())
    label, body = np.zeros((2, world.particle_count), np.int64)
    for particle in np.flatnonzero(world.particle_active).tolist():
        count = list_body(state_of(world), particle, label, body)
        assert body[:count].tolist() == body_of(world, particle).tolist()
