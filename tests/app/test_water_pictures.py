"""Water as it is seen and heard: in runs, and as zones while a level is edited."""

import json

import numpy as np
import pygame
import pytest

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.effects import Effects
from sandbox.app.draw.picture import draw_picture
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.renderer import Renderer
from sandbox.app.draw.water import HIGHEST, Pools
from sandbox.app.sound.sound_events import SoundEvents
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.parse import parse_level
from sandbox.session.session import Session
from tests.support.pools import jelly, pool

SIZE, VIEW = (480, 360), (-4.0, -3.0, 4.0, 3.0)
GROUND = {"id": "ground", "polygon": [[-4, -3], [4, -3], [4, -2], [-4, -2]]}


def level(zones, **parts):
    head = {"format": "spring-sandbox/level", "version": 3, "name": "water", "view": list(VIEW), "zones": zones}
    return parse_level(json.dumps(head | parts).encode(), "water")


def pixels(made, theme="dark"):
    picture = draw_picture(made, Session(made).snapshot(), SIZE, VIEW, theme=theme)
    return pygame.surfarray.array3d(picture).astype(int)


def at(picture, x, y):
    camera = Camera(viewport=(0, 0, *SIZE))
    camera.fit(VIEW)
    across, down = map(round, camera.to_pixels((x, y)))
    return picture[across, down]


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_water_lies_before_what_is_in_it_and_not_on_the_ground(theme):
    ball = [{"id": "ball", "position": [0, -1], "radius": 0.4, "look": {"ball": "plain", "colour": "#D06020"}}]
    wet, dry = (pixels(level(zones, particles=ball, terrain=[GROUND]), theme) for zones in ([pool((-3, -3, 3, 0))], []))
    for place in ((0.0, -1.0), (2.0, -1.5)):
        # Bluer than without: red is taken away more than blue.
        change = at(wet, *place) - at(dry, *place)
        assert change[2] - change[0] > 20, place
    for place in ((0.0, 1.0), (-3.5, -1.0), (0.0, -2.6)):
        assert np.abs(at(wet, *place) - at(dry, *place)).max() <= 1, place


def test_water_has_the_colour_that_its_look_says():
    lava = pool((-3, -3, 3, 0)) | {"look": {"colour": "#FF4010"}}
    red, green, blue = at(pixels(level([lava])), 0.0, -0.5)
    assert red > 1.5 * max(green, blue)


def test_zones_without_water_are_not_seen_in_a_run():
    assert np.array_equal(pixels(level([{"id": "goal", "circle": [0, 0, 1]}])), pixels(level([])))


def drawn(renderer, session, picture=None):
    surface, camera = pygame.Surface(SIZE, 0, 32), Camera(viewport=(0, 0, *SIZE))
    camera.fit(VIEW)
    now = session.snapshot()
    renderer.draw(surface, camera, now, now, 1.0)
    return pygame.surfarray.array3d(surface)


def test_the_surface_moves_where_something_crosses_it_and_is_a_line_elsewhere():
    made = level([pool((-4, -3, 4, 0))], particles=[{"id": "ball", "position": [0, 1], "radius": 0.2, "mass": 0.5}])
    session = Session(made)
    renderer = Renderer(1.0, made)
    still = drawn(renderer, session)
    for _ in range(27):
        session.advance()
    moving = drawn(renderer, session)
    camera = Camera(viewport=(0, 0, *SIZE))
    camera.fit(VIEW)
    row = round(camera.to_pixels((0.0, 0.0))[1])
    rows = slice(row - 12, row + 12)
    changed = np.abs(moving.astype(int) - still)[:, rows].max(axis=(1, 2)) > 12
    near, far = round(camera.to_pixels((-1.0, 0.0))[0]), round(camera.to_pixels((-3.9, 0.0))[0])
    assert changed[near : near + 30].any() and not changed[far : far + 5].any()


def test_what_falls_into_water_splashes_and_drops_fall_back():
    made = level([pool((-4, -3, 4, 0))], **jelly((1.0, 0.5), 0.5, 1.5))
    session, effects, boxes = Session(made), Effects(), Pools(made).boxes
    seen = []
    for tick in range(120):
        effects.see(session.snapshot(), tick / 60, None, boxes)
        layer = MarkList()
        effects.mark_drops(layer, Camera(), THEMES["dark"], 1.0)
        marks = layer.arrays()
        seen.append(0 if marks is None else len(marks.kind))
        session.advance()
    assert seen[0] == 0 and max(seen) > 10 and seen[-1] == 0


def test_a_picture_of_water_at_rest_is_not_drawn_again_but_one_of_water_that_flows_is():
    assert not Pools(level([pool()])).flow
    assert Pools(level([pool(flow=[0.5, 0.0])])).flow
    # Waves are no higher than what is kept free for them.
    assert HIGHEST < 0.2


@pytest.mark.parametrize(("height", "is_heard"), [(2.0, True), (0.31, False)])
def test_a_splash_is_heard_the_louder_the_faster(height, is_heard):
    loudness = []
    for y in (height, height + 2.0):
        made = level([pool()], particles=[{"id": "ball", "position": [0, y], "radius": 0.3, "mass": 1.0}])
        session, events = Session(made), SoundEvents()
        for _ in range(90 if is_heard else 8):
            session.advance()
            events.hear(session.world)
        found = [each for each in events.heard if each.note.kind == "splash"]
        loudness.append(max((each.loudness for each in found), default=0.0))
        if not is_heard:
            break
    assert (loudness[0] > 0.0) == is_heard
    assert not is_heard or loudness[1] > loudness[0]


GATE = {"id": "gate", "polygon": [[-3, 1], [-2, 1], [-2, 2]]}
ZONES = [pool((-3, -2, 3, 0)), {"id": "goal", "circle": [2, 2, 0.5]}, GATE]


def shades(driver):
    """Pixels in the pool and in the goal."""
    picture = pygame.surfarray.array3d(driver.app.display.surface).astype(int)
    return [picture[tuple(map(round, driver.at(*place)))] for place in ((0.03, -1.03), (2.03, 2.03))]


def test_the_editor_shades_zones_and_keeps_them_through_edits_undo_and_a_save(edit):
    made = level(ZONES)
    driver = edit(made)
    driver.frames(2)
    shaded, before = shades(driver), driver.editor.document.level
    assert before.zones == made.zones
    driver.key(pygame.K_r)
    driver.drag((-2, 1), (0, 1), (1, 1))
    changed = driver.editor.document.level
    assert len(changed.bodies) == 1 and changed.zones == made.zones
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.editor.document.level == before
    assert parse_level(level_text(driver.editor.document.level).encode(), "saved") == made
    plain = edit(level([]))
    plain.frames(2)
    assert all(np.abs(one - other).max() > 8 for one, other in zip(shaded, shades(plain), strict=True))


def test_a_new_body_does_not_take_the_name_of_a_zone(edit):
    driver = edit(level([{"id": "rope", "circle": [0, 0, 1]}]))
    driver.key(pygame.K_r)
    driver.drag((-2, 1), (0, 1), (1, 1))
    (body,) = driver.editor.document.level.bodies
    assert body.id != "rope"
