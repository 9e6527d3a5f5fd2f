"""Looks: what bodies are drawn as, what of it follows tears, and that none of it reaches a run."""

import json

import numpy as np
import pygame
import pytest

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.effects import Effects
from sandbox.app.draw.looks import ball_look, body_looks, ground_look, spring_look
from sandbox.app.draw.picture import draw_picture
from sandbox.app.draw.raster.mark_kernels import ACROSS, ALONG
from sandbox.app.draw.raster.painter import MarkList, Painter
from sandbox.app.draw.renderer import Renderer
from sandbox.app.draw.things.drawables import Drawables
from sandbox.app.draw.things.level_slots import chains_of, hull_of, level_slots_of, sides_of, trace_loops
from sandbox.app.draw.things.wheels import Balls
from sandbox.level.format.look import LINES, PALETTE, SKINS
from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.jit import COMPILED
from sandbox.physics.snapshot import state_hash
from sandbox.session.session import Session
from tests.app.conftest import small_level
from tests.support.zoo import zoo

needs_kernels = pytest.mark.skipif(not COMPILED, reason="kernels are interpreted here")


def jelly(name, **more):
    return {"type": "jelly", "id": name, "shape": {"box": [1, 1]}, "spacing": 0.25} | more


def looks(materials=None, **body):
    level = small_level(materials=materials or {}, bodies=[jelly("it", **body)])
    return body_looks(level)[0]


def drawables_of(session):
    snapshot = session.snapshot()
    return Drawables(level_slots_of(session.level), snapshot, shown_particles(snapshot), shown_springs(snapshot))


def pixels_of(surface):
    return pygame.surfarray.array3d(surface).astype(int)


def test_a_word_in_the_materials_name_says_more_than_its_stiffness_and_the_level_more_than_both():
    stiff = {"stiffness": 0.95}
    assert looks().skin == "jelly"
    assert looks({"firm": stiff}, material="firm").skin == "rubber"
    assert looks({"old wood": stiff}, material="old wood").skin == "wood"
    assert looks({"old wood": stiff | {"look": {"skin": "stone"}}}, material="old wood").skin == "stone"
    both = looks({"m": {"look": {"skin": "stone", "colour": "lime"}}}, material="m")
    assert (both.skin, both.colour) == ("stone", PALETTE["lime"])


def test_what_a_body_says_counts_more_than_what_its_material_says_and_only_where_it_says_it():
    level = small_level(
        materials={"m": {"look": {"skin": "stone", "colour": "lime"}}},
        bodies=[jelly("it", material="m", look={"colour": "#102030"})],
    )
    (look,) = body_looks(level)
    assert (look.skin, look.colour) == ("stone", 0x102030)


def test_names_that_nobody_knows_fall_back_to_automatic():
    level = small_level(bodies=[jelly("it", look={"skin": "velvet", "line": "spaghetti"})], materials={})
    (look,) = body_looks(level)
    assert look.skin == "jelly" and look.line in LINES
    particles = [{"id": "p", "radius": 0.3, "look": {"ball": "moon", "colour": "sky"}}]
    level = small_level(bodies=[], materials={}, particles=particles)
    assert ball_look(level, level.particles[0], 0, False) == ("marble", PALETTE["sky"])


def test_soft_bodies_get_the_colours_of_the_palette_in_order_and_faces_unless_there_are_many():
    few = body_looks(small_level(bodies=[jelly(f"b{k}") for k in range(16)], materials={}))
    assert [look.colour for look in few[:8]] == list(PALETTE.values()) and all(look.face for look in few)
    many = small_level(bodies=[jelly(f"b{k}") for k in range(17)], materials={})
    assert not any(look.face for look in body_looks(many))
    asked = small_level(bodies=[jelly(f"b{k}") for k in range(17)], materials={}, look={"faces": True})
    assert all(look.face for look in body_looks(asked))


def test_loose_springs_and_ground_are_told_by_name_use_and_stiffness():
    level = zoo()
    kinds = {spring_look(level, spring).line for spring in level.springs}
    assert kinds <= {*LINES, "piston"}
    driven = next(spring for spring in level.springs if spring.hydraulic is not None)
    assert spring_look(level, driven).line == "piston"
    assert ground_look(level, "left glass", True) == "glass"
    assert (ground_look(level, "x", True), ground_look(level, "x", False)) == ("soil", "metal")


@pytest.mark.parametrize("path", shipped_levels(), ids=lambda path: path.stem)
def test_looks_of_shipped_levels_are_names_that_exist(path):
    level = read_level(path)
    for look in body_looks(level):
        assert look.skin in (*SKINS, "", "tyre", "steel wheel") and look.line in LINES


def test_a_border_goes_once_around_and_round_a_hole():
    # A square of two triangles, and a ring of eight around a hole.
    assert [sorted(loop.tolist()) for loop in trace_loops(np.array([[0, 1, 2], [0, 2, 3]]))] == [[0, 1, 2, 3]]
    outer, inner = list(range(4)), list(range(4, 8))
    ring = [t for k in range(4) for t in ([outer[k], outer[k - 3], inner[k]], [outer[k - 3], inner[k - 3], inner[k]])]
    assert sorted(sorted(loop.tolist()) for loop in trace_loops(np.array(ring))) == [outer, inner]


def test_the_sides_of_triangles_are_found_among_springs_in_either_direction():
    sides = sides_of(np.array([[0, 1, 2]]), np.array([[2, 1], [0, 1]]))
    assert sides.tolist() == [[1, 0, -1]]


def test_the_hull_of_a_net_leaves_out_what_is_inside_and_what_sticks_out():
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5], [2.0, 2.0]])
    pairs = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [4, 2], [2, 5]])
    assert sorted(hull_of(square, pairs).tolist()) == [0, 1, 2, 3]
    assert len(hull_of(square, np.array([[0, 1]]))) == 0


def test_chains_run_through_particles_of_two_springs_and_end_where_three_meet():
    chains = chains_of(np.array([[0, 1], [1, 2], [2, 3], [2, 4], [5, 6], [6, 7], [7, 5]]))
    found = sorted(sorted(springs.tolist()) for _, springs in chains)
    assert found == [[0, 1], [2], [3], [4, 5, 6]]
    closed = next(particles for particles, springs in chains if len(springs) == 3)
    assert closed[0] == closed[-1]


def test_a_jelly_cut_in_two_has_two_skins_and_a_jelly_torn_to_threads_none():
    session = Session(small_level(bodies=[jelly("it")], materials={}))
    (before,) = drawables_of(session).soft.shapes
    middle = session.world.position.mean(axis=0)
    ends = session.world.position[session.world.particle_a], session.world.position[session.world.particle_b]
    crossing = (ends[0][:, 1] - middle[1] - 0.05) * (ends[1][:, 1] - middle[1] - 0.05) < 0.0
    session.world.cut(np.flatnonzero(crossing & session.world.spring_active).tolist())
    halves = drawables_of(session).soft.shapes
    assert [len(shape.loops) for shape in (before, *halves)] == [1, 1, 1]
    assert not set(halves[0].loops[0]) & set(halves[1].loops[0])
    session.world.cut(np.flatnonzero(session.world.spring_active)[:-10])
    assert drawables_of(session).soft.shapes == []


def test_a_wheel_whose_ring_is_cut_is_drawn_as_its_bars():
    wheel = {"type": "wheel", "id": "w", "radius": 1, "thickness": 0.25, "segments": 8}
    session = Session(small_level(bodies=[wheel], materials={}))
    whole = drawables_of(session)
    assert len(whole.wheels) == 1 and whole.members.count == 0
    session.world.cut([10])
    torn = drawables_of(session)
    assert len(torn.wheels) == 0 and torn.members.count == int(shown_springs(session.snapshot()).sum())


def test_particles_and_springs_that_join_a_run_are_drawn_and_pins_are_no_balls():
    session = Session(small_level())
    world = session.world
    count = len(drawables_of(session).balls.slots)
    world.add_particles(["+1", "+2"], np.array([[0.0, 1.0], [1.0, 1.0]]), radius=0.2)
    world.add_springs(["+s"], [len(world.mass) - 2], [len(world.mass) - 1])
    after = drawables_of(session)
    assert len(after.balls.slots) == count + 2 and after.members.count >= 1
    snapshot = session.snapshot()
    balls = Balls(level_slots_of(session.level), snapshot, np.zeros(0, dtype=np.int64))
    assert (snapshot.inverse_mass[balls.pins] == 0.0).all() and len(balls.pins)


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("lattice", [False, True])
def test_everything_of_a_level_is_drawn_in_both_themes_with_and_without_kernels(theme, lattice):
    level = zoo()
    snapshot = Session(level).snapshot()
    surface = pygame.Surface((320, 200), 0, 32)
    camera = Camera((0.0, 3.0), 9.0, (0, 0, 320, 200))
    for compiled in (True, False):
        renderer = Renderer(0.7, level)
        renderer.theme, renderer.lattice, renderer.compiled = THEMES[theme], lattice, compiled
        renderer.draw(surface, camera, snapshot, snapshot, 1.0)
        bare = pygame.Surface((320, 200), 0, 32)
        empty = small_level(bodies=[], materials={}, view=None)
        other = Renderer(0.7, empty)
        other.theme, other.compiled = THEMES[theme], compiled
        other.draw(bare, camera, Session(empty).snapshot(), Session(empty).snapshot(), 1.0)
        assert (pixels_of(surface) != pixels_of(bare)).any(axis=2).mean() > 0.1
        assert renderer.non_finite == 0


def test_a_light_picture_is_lighter_than_a_dark_one_and_a_level_may_ask_for_it():
    session = Session(small_level())
    pictures = [draw_picture(session.level, session.snapshot(), (160, 90), theme=name) for name in ("dark", "light")]
    dark, light = (pixels_of(picture).mean() for picture in pictures)
    assert light > dark + 80
    asked = Session(small_level(look={"theme": "light"}))
    assert pixels_of(draw_picture(asked.level, asked.snapshot(), (160, 90))).mean() == light


@needs_kernels
def test_pictures_of_the_same_state_are_the_same_to_the_last_pixel():
    session = Session(zoo())
    first, second = (pixels_of(draw_picture(session.level, session.snapshot(), (320, 180))) for _ in range(2))
    assert (first == second).all()


@needs_kernels
def test_a_strip_is_as_wide_as_asked_and_marks_leave_what_the_clip_keeps():
    surface = pygame.Surface((60, 40), 0, 32)
    surface.set_clip(pygame.Rect(10, 0, 40, 40))
    tiles = np.full((1, ACROSS, ALONG), 0xFFFFFFFF, dtype=np.uint32)
    layer = MarkList()
    layer.strips(np.array([[-20.0, 20.0, 80.0, 20.0]]), 4.0, 0, 0.0)
    painter = Painter()
    painter.begin(surface)
    painter.marks(layer, tiles)
    lit = pixels_of(surface)[..., 0] / 255.0
    assert lit[:10].sum() == 0.0 and lit[50:].sum() == 0.0
    assert lit.sum() == pytest.approx(40 * 8.0, rel=0.03)


def test_looks_change_no_bit_of_a_run_and_drawing_none_either():
    plain = small_level()
    data = plain.model_dump(mode="json", exclude_defaults=True)
    data["look"] = {"theme": "light", "faces": False, "ground": {"nothing": "glass"}}
    data["bodies"][0]["look"] = {"line": "chain", "width": 2.0, "colour": "lemon"}
    dressed = parse_level(json.dumps(data).encode(), "dressed")
    renderer, surface = Renderer(1.0, dressed), pygame.Surface((200, 120), 0, 32)
    camera = Camera(viewport=(0, 0, 200, 120))
    runs = [Session(plain), Session(dressed)]
    for _ in range(30):
        for session in runs:
            session.advance()
        snapshot = runs[1].snapshot()
        renderer.draw(surface, camera, snapshot, snapshot, 1.0)
        assert len({state_hash(session.world) for session in runs}) == 1


def test_what_tears_sparks_what_hits_raises_dust_and_both_are_gone_after_a_while():
    session = Session(small_level())
    effects, camera = Effects(), Camera()

    def count(mark):
        layer = MarkList()
        mark(layer)
        arrays = layer.arrays()
        return 0 if arrays is None else len(arrays.kind)

    strikes = np.ones(len(session.world.spring_active), dtype=np.bool_)
    effects.see(session.snapshot(), 0.0, strikes)
    session.advance()
    session.world.cut([1])
    effects.see(session.snapshot(), 1 / 60, strikes)
    assert count(lambda layer: effects.mark_sparks(layer, camera, 1.0)) > 0
    assert count(lambda layer: effects.mark_dust(layer, camera, THEMES["dark"], 1.0)) == 0
    for k in range(120):
        effects.see(session.snapshot(), (k + 2) / 60, strikes)
    assert count(lambda layer: effects.mark_sparks(layer, camera, 1.0)) == 0
