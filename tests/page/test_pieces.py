"""A page cuts jellies into bodies as the desktop does, bit for bit, and draws them alike."""

import base64
import io
import json
from pathlib import Path

import numpy as np
import pygame
import pytest

from sandbox import load_level
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.picture import view_of
from sandbox.app.draw.renderer import Renderer
from sandbox.physics.snapshot import state_hash
from sandbox.replay import read_replay, verify
from sandbox.session.commands import CutSprings
from sandbox.session.session import Session
from tests.page.browser import Browser
from tests.page.levels import level_page
from tests.page.opened import START_OVER, opened, saved
from tests.page.test_drawing import DRAW, MOST, SIZE, USUAL, _blocks
from tests.support.cutting import actor_of, advance, crossed, cut_along

BEFORE, AFTER = 60, 120
CUTS = {
    "jelly_pile": (("cube 1", "across"), ("wheel 4", "corner"), ("cube 6", "along")),
    "desk_toy": (("raspberry", "along"), ("lemon", "across")),
    "jelly_wheel": (("wheel", "across"),),
}


@pytest.mark.parametrize("is_along", [False, True])
@pytest.mark.parametrize("name", CUTS)
def test_a_page_parts_bodies_to_the_bits_and_the_picture_of_the_desktop(
    browser: Browser, tmp_path: Path, name: str, is_along: bool
) -> None:
    level = load_level(name)
    session = Session(level)
    advance(session, BEFORE)
    cuts = [cut_along(session, body, stroke) for body, stroke in CUTS[name]]
    cuts = cuts if is_along else [CutSprings(each.springs) for each in cuts]
    for each in cuts:
        session.submit(each)
    records = [{"type": "cut_springs", "springs": each.springs, "at": each.at} for each in cuts]
    advance(session, AFTER)
    tab = opened(browser, tmp_path, level_page(name))
    tab.evaluate(START_OVER)
    found = tab.evaluate(
        f"""for (let k = 0; k < {BEFORE}; k++) page.toy.tick();
        const whole = page.toy.world.view('state.owner').join();
        {json.dumps(records)}.forEach((record, k) => page.toy.run.submit(record, 100 + k));
        for (let k = 0; k < {AFTER}; k++) page.toy.tick();
        [page.toy.world.hash().whole, whole !== page.toy.world.view('state.owner').join()]"""
    )
    assert found == [state_hash(session.world), True]
    camera, snapshot = Camera(viewport=(0, 0, *SIZE)), session.snapshot()
    camera.fit(view_of(level, snapshot))
    surface, renderer = pygame.Surface(SIZE, 0, 32), Renderer(1.0, level)
    renderer.theme, renderer.has_effects = THEMES["dark"], False
    renderer.draw(surface, camera, snapshot, snapshot, 1.0)
    seconds = (snapshot.tick + 1.0) / snapshot.settings.tick_rate
    drawn = tab.evaluate(DRAW.format(*SIZE, *camera.centre, camera.zoom, "dark", seconds))
    page = pygame.image.load(io.BytesIO(base64.b64decode(drawn)), "page.png")
    apart = np.abs(_blocks(page) - _blocks(surface)).mean(axis=2)
    assert apart.mean() < USUAL and np.quantile(apart, 0.99) < MOST
    assert tab.faults == []


def test_undo_in_a_page_joins_the_pieces_and_what_it_saves_is_verified(browser: Browser, tmp_path: Path) -> None:
    level = load_level("jelly_pile")
    session = Session(level)
    advance(session, BEFORE)
    springs = crossed(session, actor_of(level, "cube 1"), "across")
    tab = opened(browser, tmp_path, level_page("jelly_pile"))
    tab.evaluate(START_OVER)
    owners = tab.evaluate(
        f"""for (let k = 0; k < {BEFORE}; k++) page.toy.tick();
        const owners = () => new Set(page.toy.world.view('state.owner').slice(0, 25)).size, found = [owners()];
        page.toy.run.submit({{ type: 'cut_springs', springs: {json.dumps(springs)} }}, 5);
        page.toy.tick();
        found.push(owners());
        document.getElementById('undo').click();
        found.push(owners());
        page.toy.run.submit({{ type: 'cut_springs', springs: {json.dumps(springs)} }}, 6);
        for (let k = 0; k < 30; k++) page.toy.tick();
        [...found, owners()]"""
    )
    assert owners == [1, 2, 1, 2]
    recording = read_replay(saved(tab, tmp_path))
    assert verify(recording) is None and recording.ticks == BEFORE + 30
