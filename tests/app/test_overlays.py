"""Overlays: each shows what it says, on every theme, by its key and its button, with a legend; none writes."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pygame
import pytest

from sandbox.app.base.shortcuts import SHORTCUTS
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.effects import Effects
from sandbox.app.draw.overlays import LONGEST_ARROW, NAMES, Overlays, Scale, names_for, stability_tones
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.renderer import Overlay, Renderer
from sandbox.app.draw.textures import Tiles
from sandbox.app.draw.things.level_slots import Frame
from sandbox.app.play.legend import Legend, rows_of
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.snapshot import state_hash
from sandbox.physics.solvers import SOLVERS
from sandbox.session.session import Session
from tests.app.conftest import small_level

SIZE = (240, 160)


def box_level(**changes):
    """A jelly that has fallen on the ground, with a bar that yields hung above it."""
    return small_level(
        contacts={}, view=[-3, -1, 3, 3], settings={"solver": "direct"},
        materials={"soft": {"tension_limit": 0.5}, "lead": {"yield_strain": 0.001}},
        terrain=[{"id": "ground", "polyline": [[-3, -0.5], [3, -0.5]]}],
        bodies=[
            {"type": "jelly", "id": "box", "shape": {"box": [1, 1]}, "spacing": 0.5, "position": [0, 0.1]},
            {"type": "rope", "id": "bar", "material": "lead", "start": [-2, 2], "end": [2, 2], "segments": 4,
             "pin": ["start", "end"], "particle_mass": 9},
        ],
        **changes,
    )  # fmt: skip


@pytest.fixture(scope="module")
def fallen():
    session = Session(box_level())
    for _ in range(30):
        session.advance()
    return session


def picture(session, shown, theme="dark", compiled=True, scale=1.0):
    surface, camera = pygame.Surface(SIZE, 0, 32), Camera(viewport=(0, 0, *SIZE))
    camera.fit((-3.0, -1.0, 3.0, 3.0))
    renderer, snapshot = Renderer(scale, session.level), session.snapshot()
    renderer.theme, renderer.compiled = THEMES[theme], compiled
    renderer.overlays.shown |= set(shown)
    shares = np.linspace(0.0, 2.0, len(snapshot.rest_length))
    renderer.draw(surface, camera, snapshot, snapshot, 1.0, Overlay(stability=shares))
    return pygame.surfarray.array3d(surface).astype(int), renderer


@pytest.mark.parametrize("theme", THEMES)
def test_each_overlay_is_seen_in_both_themes_with_kernels_and_without(fallen, theme):
    for compiled in (True, False):
        bare, _ = picture(fallen, (), theme, compiled)
        for name in names_for(box_level()):
            shown, _ = picture(fallen, [name], theme, compiled)
            assert (np.abs(shown - bare).max(axis=2) > 40).sum() > 20, (name, compiled)


def test_overlays_change_no_bit_of_a_run():
    watched, alone = Session(box_level()), Session(box_level())
    for _ in range(12):
        watched.advance()
        alone.advance()
        picture(watched, NAMES)
        assert state_hash(watched.world) == state_hash(alone.world)


def test_a_scale_is_a_round_number_that_stays_until_what_it_shows_is_much_larger_or_smaller():
    scale = Scale()
    assert scale.follow(np.array([0.0, np.nan])) == 1.0
    assert scale.follow(np.full(9, 13.0)) == 20.0
    assert scale.follow(np.full(9, 35.0)) == 20.0
    assert scale.follow(np.full(9, 6.0)) == 20.0
    assert scale.follow(np.full(9, 41.0)) == 50.0
    assert scale.follow(np.full(9, 0.003)) == 0.005


def test_what_rests_has_no_arrows_of_rounding():
    resting = Session(box_level())
    resting.world.velocity[:] = np.random.default_rng(3).normal(0.0, 1e-14, resting.world.velocity.shape)
    bare, _ = picture(resting, ())
    shown, renderer = picture(resting, ["velocities"])
    assert (shown == bare).all() and renderer.overlays.velocity.value == 0.01
    slow = Session(box_level())
    slow.world.velocity[:] = (0.01, 0.0)
    assert (picture(slow, ["velocities"])[0] != bare).any()


def test_arrows_are_as_long_as_the_legend_says_and_never_cross_the_screen(fallen):
    _, renderer = picture(fallen, ["velocities"])
    snapshot = fallen.snapshot()
    speeds = np.sqrt((snapshot.velocity**2).sum(axis=1))
    assert renderer.overlays.velocity.value >= 0.4 * np.quantile(speeds[speeds > 0], 0.9)
    layer = MarkList()
    fast = Overlays({"velocities"}, velocity=Scale(1.0))
    wild = snapshot.velocity.copy()
    wild[0] = (1.5, 1e9)
    state = replace(snapshot, arrays={**snapshot.arrays, "velocity": wild})
    camera = Camera((0.0, 1.0), 40.0, (0, 0, *SIZE))
    at = camera.project(state.position)
    frame = Frame(
        state, at, state.angle, np.zeros(len(state.rest_length)), 40.0, 1.0, THEMES["dark"], Tiles(THEMES["dark"])
    )
    fast.mark(layer, frame, state, camera, shown_particles(state), shown_springs(state), None)
    ends = layer.arrays().ends
    lengths = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    assert lengths.max() == pytest.approx(LONGEST_ARROW)


def test_what_is_past_the_limit_of_stability_has_a_colour_of_its_own():
    tones = stability_tones(np.array([0.0, 0.5, 1.0, 1.01, np.nan, np.inf]), THEMES["dark"])
    assert len(set(tones.tolist())) == 4
    assert tones[3] == tones[5] and tones[2] == tones[4]


@pytest.mark.parametrize("solver", SOLVERS)
def test_every_overlay_has_a_row_in_the_legend_and_a_key(solver):
    overlays = Overlays(set(NAMES), Scale(2.0), Scale(50.0), Scale(1000.0))
    texts = [text for text, _ in rows_of(overlays, solver)]
    assert len(texts) == len(set(texts)) >= len(NAMES)
    assert "contact pushes with 50 N" in texts and "moves at 2 m/s" in texts
    assert rows_of(Overlays(), solver) == []
    keys = {entry.action: entry.keys for entry in SHORTCUTS if entry.mode == "play"}
    assert all(keys[name] for name in NAMES)


@pytest.mark.parametrize(
    ("size", "scale"), [((1200, 800), 1.0), ((700, 420), 1.5), ((300, 200), 1.33), ((90, 60), 2.0)]
)
def test_the_legend_stays_in_its_room_smaller_or_with_fewer_rows(size, scale):
    pygame.font.init()
    ui, drawn = SimpleNamespace(scale=scale, px=lambda units: round(units * scale)), pygame.Surface((1400, 900))
    overlays, room = Overlays(set(NAMES), Scale(2.0), Scale(50.0), Scale(1000.0)), pygame.Rect((100, 50), size)
    Legend().draw(drawn, ui, overlays, THEMES["light"], "direct", room)
    covered = pygame.surfarray.array3d(drawn).any(axis=2)
    outside = covered.copy()
    outside[room.left : room.right, room.top : room.bottom] = False
    assert not outside.any() and covered.any() == (size != (90, 60))


def test_keys_and_buttons_show_overlays_with_their_legend_and_take_them_away(driver):
    driver.take_sliders()
    shown = driver.stage.renderer.overlays.shown
    keys = dict(zip(names_for(driver.playback.level), (pygame.K_l, *range(pygame.K_F3, pygame.K_F8)), strict=True))
    for name, key in keys.items():
        driver.key(key)
        driver.frames(1)
        assert shown == {name}
        driver.click_in_panel(driver.panel.world.views.buttons[name])
        driver.frames(1)
        assert shown == set()
    before = pygame.surfarray.array3d(driver.app.display.surface).astype(int)
    driver.playback.clock.paused = True
    driver.key(pygame.K_F6)
    driver.frames(2)
    after = pygame.surfarray.array3d(driver.app.display.surface).astype(int)
    left, top, width, _ = driver.app.play.viewport
    corner = np.s_[left + width - 60 : left + width - 20, top + 16 : top + 40]
    assert np.abs(after[corner] - before[corner]).mean() > 2.0


def test_the_lattice_dashes_what_has_yielded_and_crosses_where_something_broke():
    bar = box_level()
    data = bar.model_dump(mode="json", exclude_defaults=True)
    data["materials"]["lead"] = {}
    stiff = Session(parse_level(json.dumps(data).encode(), "stiff"))
    soft = Session(bar)
    for _ in range(20):
        soft.advance()
        stiff.advance()
    renderer = Renderer(1.0, bar)
    state = soft.snapshot()
    bars = np.flatnonzero(state.material == 2)
    assert renderer._yielded(state, bars).any()
    assert not Renderer(1.0, stiff.level)._yielded(stiff.snapshot(), bars).any()

    effects, camera = Effects(), Camera()
    effects.see(soft.snapshot(), 0.0, None)
    assert effects.is_at_rest
    soft.advance()
    soft.world.cut([3])
    effects.see(soft.snapshot(), 0.1, None)
    layer = MarkList()
    effects.mark_breaks(layer, camera, THEMES["dark"], 1.0)
    assert len(layer.arrays().kind) == 4 and not effects.is_at_rest
