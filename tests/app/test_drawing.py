"""Camera, clock, lines, renderer and pictures."""

from dataclasses import replace

import numpy as np
import pygame
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.app.base.loop import LONGEST_FRAME, SPEEDS, TickClock
from sandbox.app.draw.camera import Camera, bounds, grid_spacing
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.lines import Canvas
from sandbox.app.draw.overlays import strain_tones
from sandbox.app.draw.picture import crop_of, draw_picture, save_picture, view_of
from sandbox.app.draw.raster.bodies import BodyRows, Flush, Outlines, Skins
from sandbox.app.draw.raster.mark_kernels import SHEET, CellArrays
from sandbox.app.draw.raster.painter import BodyLayer, MarkList, Painter
from sandbox.app.draw.renderer import Renderer
from sandbox.app.draw.textures import Tiles, grains, skin_table
from sandbox.app.run.playback import Playback, interpolated
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import Level
from sandbox.level.kinds.jelly import BoxShape, JellyDef, PolygonShape
from sandbox.level.kinds.ring import RingDef
from sandbox.physics.jit import COMPILED
from sandbox.physics.snapshot import take
from sandbox.session.session import Session
from tests.app.conftest import small_level

FRAME = 1 / 60
within = st.floats(-1e4, 1e4)
zooms = st.floats(0.01, 1e4)


@given(x=within, y=within, cx=within, cy=within, zoom=zooms)
def test_pixels_and_metres_map_back_and_forth(x, y, cx, cy, zoom):
    camera = Camera((cx, cy), zoom, (10, 20, 800, 600))
    assert camera.to_world(camera.to_pixels((x, y))) == pytest.approx((x, y), abs=1e-6)
    assert camera.project(np.array([[x, y]]))[0] == pytest.approx(camera.to_pixels((x, y)))


@given(px=st.floats(0, 800), py=st.floats(0, 600), factor=st.floats(0.2, 5.0), zoom=st.floats(1.0, 500.0))
def test_zooming_keeps_the_point_under_the_pointer(px, py, factor, zoom):
    camera = Camera((3.0, -2.0), zoom, (0, 0, 800, 600))
    before = camera.to_world((px, py))
    camera.zoom_about((px, py), factor)
    assert camera.zoom == pytest.approx(zoom * factor)
    assert camera.to_world((px, py)) == pytest.approx(before, abs=1e-6)


def test_y_points_up_and_panning_follows_the_pointer():
    camera = Camera((0.0, 0.0), 10.0, (0, 0, 200, 100))
    assert camera.to_pixels((1.0, 1.0)) == (110.0, 40.0)
    camera.pan(10, 20)
    assert camera.to_pixels((0.0, 0.0)) == (110.0, 70.0)


@pytest.mark.parametrize("box", [(-4.0, 0.0, 4.0, 1.0), (2.0, -30.0, 3.0, 30.0), (1.0, 1.0, 1.0, 1.0)])
def test_fit_shows_the_whole_box_in_the_viewport(box):
    camera = Camera(viewport=(100, 50, 640, 480))
    camera.fit(box)
    for corner in ((box[0], box[1]), (box[2], box[3])):
        x, y = camera.to_pixels(corner)
        assert 100 <= x <= 740 and 50 <= y <= 530


def test_bounds_leave_out_what_is_not_finite():
    points = np.array([[0.0, 1.0], [np.nan, 5.0], [2.0, -1.0], [np.inf, 0.0]])
    assert bounds(points) == (0.0, -1.0, 2.0, 1.0)
    assert bounds(points[1:2]) == (-1.0, -1.0, 1.0, 1.0)


@given(zoom=st.floats(1e-4, 1e6))
def test_grid_lines_are_never_closer_than_wanted_and_never_ten_times_farther(zoom):
    pixels = grid_spacing(zoom, 64.0) * zoom
    assert 64.0 * (1 - 1e-6) <= pixels < 640.0


def test_the_clock_gives_the_same_number_of_ticks_at_every_frame_rate():
    for rate in (24, 60, 144, 1000):
        clock = TickClock()
        assert sum(clock.ticks(1 / rate, 60) for _ in range(5 * rate)) == pytest.approx(300, abs=1)


def test_a_long_frame_is_not_made_up_for_and_a_negative_one_takes_nothing_back():
    clock = TickClock()
    assert clock.ticks(30.0, 60) == int(LONGEST_FRAME * 60)
    assert clock.ticks(-5.0, 60) == 0
    assert clock.accumulator >= 0.0


@pytest.mark.parametrize("speed", SPEEDS)
def test_slow_motion_scales_ticks_and_alpha_stays_in_0_to_1(speed):
    clock, ticks = TickClock(speed=speed), 0
    for _ in range(480):
        ticks += clock.ticks(FRAME, 60)
        assert 0.0 <= clock.alpha(60) <= 1.0
    assert ticks == pytest.approx(480 * speed, abs=1)


def test_a_paused_clock_gives_single_ticks_only():
    clock = TickClock(paused=True)
    assert clock.ticks(1.0, 60) == 0
    clock.step_once()
    clock.step_once()
    assert [clock.ticks(FRAME, 60), clock.ticks(FRAME, 60)] == [2, 0]


def test_a_run_that_is_too_slow_loses_time_instead_of_running_away(monkeypatch):
    playback = Playback(small_level(settings={"solver": "single_pass", "tick_rate": 10_000}))
    now = [0.0]
    monkeypatch.setattr("sandbox.app.run.playback.time.perf_counter", lambda: now[0])
    advance = playback.session.advance

    def slow_tick():
        now[0] += 0.02
        advance()

    monkeypatch.setattr(playback.session, "advance", slow_tick)
    for _ in range(5):
        assert playback.advance(0.1) <= 4
        assert playback.behind
        assert playback.clock.accumulator == 0.0


def test_positions_are_interpolated_and_fall_back_to_the_current_ones():
    session = Session(small_level())
    first = session.snapshot()
    moved = replace(first, arrays={**first.arrays, "position": first.position + 2.0})
    assert np.allclose(interpolated(first, moved, 0.25), first.position + 0.5)
    fewer = {name: first.arrays[name][:-1] for name in ("position", "mass")}
    longer = replace(first, arrays={**first.arrays, **fewer})
    assert interpolated(longer, first, 0.5) is first.position


@pytest.mark.parametrize("theme", THEMES.values(), ids=THEMES)
def test_compressed_is_blue_rest_is_grey_and_stretched_is_warm(theme):
    tones = strain_tones(np.array([-0.3, 0.0, 0.3]), theme.strain)
    red, green, blue = ((tones >> shift) & 255 for shift in (16, 8, 0))
    assert blue[0] > red[0] + 80
    assert red[2] > blue[2] + 80
    assert abs(int(red[1]) - int(blue[1])) < 40 and abs(int(red[1]) - int(green[1])) < 40
    strains = np.array([-np.inf, np.nan, np.inf, -5.0, 1e300])
    wild = strain_tones(strains, theme.strain)
    assert (wild >= 0).all() and (wild <= 0xFFFFFF).all()


def canvas(width=60, height=40, compiled=COMPILED):
    surface = pygame.Surface((width, height), 0, 32)
    return Canvas(surface, compiled)


def brightness(surface):
    return pygame.surfarray.array3d(surface).astype(float).sum(axis=2) / 765.0


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("ends", [(5, 20, 55, 20), (30, 5, 30, 35), (5, 5, 45, 35), (50, 35, 8, 12), (20, 4, 26, 36)])
def test_a_line_covers_about_its_length_times_its_width(ends, compiled):
    drawn = canvas(compiled=compiled)
    drawn.lines(np.array([ends], dtype=float), np.array([0xFFFFFF]), 2.0)
    length = np.hypot(ends[2] - ends[0], ends[3] - ends[1])
    exact = drawn.compiled
    assert brightness(drawn.surface).sum() == pytest.approx(2.0 * length, rel=0.12 if exact else 0.7)


def triangles(surface, corners, colours, compiled=True):
    count = len(corners)
    painter = Painter(compiled)
    painter.begin(surface)
    cells = CellArrays(
        np.array(corners, dtype=float).reshape(count, 6), np.zeros((count, 6)), np.zeros((count, 3)), np.arange(count)
    )
    painter.cells(cells, np.array(colours)[:, None, None] * np.ones((count, SHEET, SHEET), dtype=np.int64))


@pytest.mark.parametrize("compiled", [True, False])
def test_triangles_that_share_a_side_fill_their_square(compiled):
    if compiled and not COMPILED:
        pytest.skip("kernels are interpreted here")
    surface = pygame.Surface((60, 60), 0, 32)
    corners = [[[10.2, 10.7], [50.2, 12.7], [48.2, 50.7]], [[10.2, 10.7], [48.2, 50.7], [8.2, 48.7]]]
    triangles(surface, corners, [0xFF0000, 0x0000FF], compiled)
    red, _, blue = pygame.surfarray.array3d(surface).transpose(2, 0, 1) > 0
    # pygame fills the pixels that a side touches, too.
    slack = 3.0 if compiled else 80.0
    assert np.count_nonzero(red) == pytest.approx(762, abs=slack)
    assert np.count_nonzero(red | blue) == pytest.approx(1524, abs=2 * slack)
    middle = (red | blue)[20:40, 20:40]
    assert middle.all()


def test_triangles_outside_the_clip_draw_nothing_and_of_no_height_do_not_fail():
    surface = pygame.Surface((40, 40), 0, 32)
    surface.set_clip(pygame.Rect(10, 10, 20, 20))
    flat = [[5.0, 20.5], [35.0, 20.5], [20.0, 20.5]]
    around = [[-1e5, -1e5], [1e5, -1e5], [0.0, 1e5]]
    wild = [[np.nan, 0.0], [1e300, 5.0], [3.0, 4.0]]
    triangles(surface, [flat, around, wild], [0xFFFFFF, 0xFFFFFF, 0xFFFFFF])
    white = pygame.surfarray.array3d(surface)[..., 0] > 0
    assert np.count_nonzero(white) == 400 and white[10:30, 10:30].all()


def test_lines_and_discs_outside_the_clip_or_beyond_all_sense_draw_nothing_and_do_not_fail():
    drawn = canvas()
    drawn.surface.set_clip((20, 10, 10, 10))
    wild = np.array([[-1e300, 0, 1e300, 0], [np.nan, 0, 5, 5], [np.inf, 0, 0, 0], [0, 0, 5, 2]], dtype=float)
    drawn.lines(wild, np.full(4, 0xFFFFFF), 2.0)
    drawn.discs(np.array([[np.nan, 1.0], [1e30, 1.0], [3.0, 3.0]]), np.full(3, 2.0), np.full(3, 0xFFFFFF))
    assert brightness(drawn.surface).sum() == 0.0
    drawn.lines(np.array([[-1e4, 15.0, 1e4, 15.0]]), np.array([0xFFFFFF]), 2.0)
    drawn.discs(np.array([[25.0, 15.0]]), np.array([30.0]), np.array([0xFFFFFF]))
    lit = np.argwhere(brightness(drawn.surface) > 0)
    assert (lit.min(axis=0) >= (20, 10)).all() and (lit.max(axis=0) < (30, 20)).all()


@pytest.mark.parametrize("compiled", [True, False])
def test_a_disc_covers_about_its_area(compiled):
    drawn = canvas(compiled=compiled)
    drawn.discs(np.array([[30.0, 20.0]]), np.array([9.0]), np.array([0xFFFFFF]))
    assert brightness(drawn.surface).sum() == pytest.approx(np.pi * 81, rel=0.15)


def draw(level, change=None):
    session = Session(level)
    snapshot = session.snapshot()
    if change is not None:
        position = snapshot.position.copy()
        change(position)
        snapshot = replace(snapshot, arrays={**snapshot.arrays, "position": position})
    surface = pygame.Surface((400, 300), 0, 32)
    camera = Camera(viewport=(0, 0, 400, 300))
    camera.fit((-1.0, -3.0, 7.0, 3.0))
    renderer = Renderer(level=level)
    renderer.lattice = True
    renderer.draw(surface, camera, snapshot, snapshot, 1.0)
    return surface, camera, renderer


def colour_on_the_last_link(shift):
    """Average (red, blue) of the middle of the rope's last link, its end moved along it, with the lattice in front."""

    def change(position):
        position[4, 0] += shift

    surface, camera, _ = draw(small_level(), change)
    x, y = camera.to_pixels((3.5 + shift / 2, 0.0))
    area = pygame.surfarray.array3d(surface)[round(x) - 2 : round(x) + 3, round(y) - 2 : round(y) + 2]
    line = area[area.sum(axis=2) > 200]
    return line[:, 0].mean(), line[:, 2].mean()


def test_a_stretched_spring_is_drawn_warm_and_a_compressed_one_blue():
    red, blue = colour_on_the_last_link(0.4)
    assert red > blue + 60
    red, blue = colour_on_the_last_link(-0.4)
    assert blue > red + 60


def test_a_jelly_and_a_balloon_are_filled_and_a_crushed_jelly_is_bluer():
    bodies = (
        JellyDef(type="jelly", id="cube", shape=BoxShape(box=(2.0, 2.0)), spacing=1.0),
        RingDef(type="ring", id="balloon", radius=1.0, segments=16, position=(4.0, 0.0)),
    )
    level = Level(format="spring-sandbox/level", version=4, name="Filled", bodies=bodies)
    empty = Level(format="spring-sandbox/level", version=4, name="Empty")
    camera = Camera((2.0, 0.0), 50.0, (0, 0, 400, 200))

    def colour_at(level, world, place):
        surface = pygame.Surface((400, 200), 0, 32)
        snapshot = take(world)
        Renderer(level=level).draw(surface, camera, snapshot, snapshot, 1.0)
        x, y = camera.to_pixels(place)
        return np.array(surface.get_at((round(x), round(y)))[:3], dtype=int)

    world = build_world(level)
    # Beside the faces, and off the lines of the grid.
    spots = (-0.8, -0.7), (4.1, 0.1)
    bare = [colour_at(empty, build_world(empty), (x, 0.7 * y)) for x, y in spots]
    at_rest = [colour_at(level, world, spot) for spot in spots]
    assert all(np.abs(colour - stage).max() > 60 for colour, stage in zip(at_rest, bare, strict=True))
    world.position *= [1.0, 0.7]
    crushed = colour_at(level, world, (spots[0][0], 0.7 * spots[0][1]))
    if COMPILED:
        assert crushed[2] - crushed[0] > at_rest[0][2] - at_rest[0][0] + 20
    world.cut(np.flatnonzero(world.spring_active))
    torn = [colour_at(level, world, (x, 0.7 * y)) for x, y in spots]
    assert all((colour == stage).all() for colour, stage in zip(torn, bare, strict=True))


def filled_share(shape, spacing, box, mesh="grid"):
    """How much of a box [m] of a jelly is not as it is without the jelly."""
    jelly = JellyDef(type="jelly", id="one", shape=shape, spacing=spacing, mesh=mesh)
    camera, pictures = Camera((0.0, 0.0), 100.0, (0, 0, 400, 400)), []
    for bodies in ((jelly,), ()):
        level = Level(format="spring-sandbox/level", version=4, name="One", bodies=bodies)
        surface = pygame.Surface((400, 400), 0, 32)
        snapshot = take(build_world(level))
        Renderer(level=level).draw(surface, camera, snapshot, snapshot, 1.0)
        pictures.append(pygame.surfarray.array3d(surface).astype(int))
    differs = np.abs(pictures[0] - pictures[1]).max(axis=2) > 24
    half = [round(50 * side) for side in box]
    return differs[200 - half[0] : 200 + half[0], 200 - half[1] : 200 + half[1]].mean()


@pytest.mark.parametrize(("box", "spacing"), [((2.0, 2.0), 2.0), ((3.0, 1.0), 1.0), ((2.0, 2.0), 0.25)])
def test_a_jelly_of_few_cells_has_the_corners_that_it_was_drawn_with(box, spacing):
    assert filled_share(BoxShape(box=box), spacing, box) > 0.965
    triangle = PolygonShape(polygon=((-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)))
    assert 0.49 < filled_share(triangle, 2.0, (2.0, 2.0), "fitted") < 0.56


def test_drawing_changes_nothing_in_the_snapshot():
    session = Session(small_level())
    before, snapshot = session.snapshot(), session.snapshot()
    draw_picture(session.level, snapshot, (200, 100))
    assert (before.position == snapshot.position).all() and (before.spring_active == snapshot.spring_active).all()


def test_non_finite_particles_are_counted_and_the_rest_is_drawn():
    def change(position):
        position[2] = (np.nan, np.inf)
        position[3] = (np.inf, 0.0)

    surface, camera, renderer = draw(small_level(), change)
    assert renderer.non_finite == 2
    x, y = camera.to_pixels((1.0, 0.0))
    stage, _, _ = draw(small_level(bodies=[], materials={}))
    lit = np.abs(brightness(surface) - brightness(stage))[round(x) - 4 : round(x) + 5, round(y) - 4 : round(y) + 5]
    assert lit.max() > 0.2


def test_a_picture_shows_every_particle_and_is_written_as_png(tmp_path):
    session = Session(small_level())
    save_picture(session, tmp_path / "picture.png", (320, 240))
    picture = pygame.image.load(tmp_path / "picture.png")
    assert picture.get_size() == (320, 240)
    empty = small_level(bodies=[], materials={})
    box = view_of(session.level, session.snapshot())
    stage = draw_picture(empty, Session(empty).snapshot(), (320, 240), box)
    assert (pygame.surfarray.array3d(picture) != pygame.surfarray.array3d(stage)).any(axis=2).sum() > 300
    with pytest.raises(OSError):
        save_picture(session, tmp_path / "missing" / "picture.png")


def test_a_small_picture_shows_ground_and_what_lies_in_the_view_and_no_empty_part_of_it():
    ground = {"id": "ground", "polygon": [[-4, -1], [4, -1], [4, 0], [-4, 0]]}
    far = [{"id": "near", "position": [0, 1], "radius": 0.5}, {"id": "flown", "position": [90, 2], "radius": 0.5}]
    level = small_level(bodies=[], materials={}, particles=far, terrain=[ground], view=[-8, -3, 8, 9])
    assert crop_of(level, Session(level).snapshot()) == (-4.0, -1.0, 8.0, 2.5)
    unframed = small_level(bodies=[], materials={}, particles=far[:1], terrain=[ground], view=None)
    assert view_of(unframed, Session(unframed).snapshot()) == (-4.0, -1.0, 4.0, 1.5)


def test_an_empty_level_and_a_level_of_one_particle_can_be_drawn():
    empty = small_level(bodies=[], materials={}, view=None)
    one = small_level(bodies=[], materials={}, view=None, particles=[{"id": "ball"}])
    for level in (empty, one):
        surface = draw_picture(level, Session(level).snapshot(), (100, 80))
        assert surface.get_size() == (100, 80)


def test_a_kernel_that_leaves_garbage_which_holds_the_pixels_leaves_no_locked_surface(monkeypatch):
    def leave_garbage(pixels, *_):
        garbage = [pixels]
        garbage.append(garbage)

    monkeypatch.setattr("sandbox.app.draw.raster.painter.paint_marks", leave_garbage)
    surface, painter, layer = pygame.Surface((8, 8), 0, 32), Painter(), MarkList()
    layer.discs(np.array([[4.0, 4.0]]), 2.0, 0xFFFFFF)
    if painter.begin(surface):
        painter.marks(layer, Tiles(THEMES["dark"]).array)
    assert not surface.get_locked()


@pytest.mark.skipif(not COMPILED, reason="bodies are lit by kernels")
@pytest.mark.parametrize("half", [0.9, 2.7])
def test_the_line_round_a_body_is_as_dark_where_its_sides_meet_as_between(half):
    along = np.arange(20.0, 100.0, 5.0)
    sides = [np.column_stack(side) for side in (
        (along, np.full(16, 20.3)), (np.full(16, 100.0), along), (120 - along, np.full(16, 100.3)),
        (np.full(16, 20.0), 120 - along),
    )]  # fmt: skip
    corners, nothing = np.concatenate(sides), np.zeros((1, 2), dtype=np.int64)
    rows = BodyRows(np.array([[0, 1]]), np.array([[0, -1, 0x802040]]), np.array([[12.0, half, 0.9]]), nothing)
    skins = Skins(skin_table("jelly", 0xF2557B, THEMES["light"])[None], grains())
    flush = Flush(np.zeros((0, 4)), np.zeros(2, dtype=np.int64))
    surface, painter = pygame.Surface((120, 120), 0, 32), Painter()
    surface.fill((255, 255, 255))
    assert painter.begin(surface)
    painter.bodies(
        BodyLayer(Outlines(corners, np.array([0, 64])), rows, skins, flush, np.full(1, 0xF2557B, dtype=np.int64))
    )
    # Across the upper line, away from the corners of the square: every column is the same.
    seen = pygame.surfarray.array3d(surface)[40:80, 14:20].astype(int)
    assert np.ptp(seen, axis=0).max() <= 1 and np.ptp(seen, axis=1).max() > 60
