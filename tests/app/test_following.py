"""The camera goes along with what is driven, pointed at or named by the level, and stands again."""

import json

import numpy as np
import pygame
import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import load_level, parse_level

SHIFT = pygame.KMOD_SHIFT


def flying(**look):
    """A level of two discs that fly apart, which the camera may go along with."""
    data = {
        "format": "spring-sandbox/level", "version": 3, "name": "apart", "settings": {"gravity": [0, 0]},
        "view": [-5, -3, 5, 3], "look": look,
        "particles": [
            {"id": "left", "position": [-1, 0], "velocity": [-6, 0], "radius": 0.3},
            {"id": "right", "position": [1, 0], "velocity": [6, 2], "radius": 0.3},
        ],
    }  # fmt: skip
    return parse_level(json.dumps(data).encode(), "apart")


def places(driver):
    return {name: driver.world.position[driver.world.particle_slot(name)] for name in ("left", "right")}


def test_the_camera_goes_along_with_what_the_level_says(open_app):
    driver = open_app(flying(follow="right"))
    driver.frames(240)
    assert places(driver)["right"] == pytest.approx([25.0, 8.1], rel=0.05)
    # Behind by some 0.25 s of 6 m/s.
    assert np.abs(np.array(driver.stage.camera.centre) - places(driver)["right"]).max() < 2.0
    driver.key(pygame.K_f, SHIFT)
    stands = driver.stage.camera.centre
    driver.frames(30)
    assert driver.stage.camera.centre == stands and "The camera stands still." in driver.notices


def test_a_key_lets_it_go_along_with_what_is_pointed_at(open_app):
    driver = open_app(flying())
    centre = driver.stage.camera.centre
    driver.key(pygame.K_f, SHIFT)
    driver.frames(10)
    assert driver.stage.camera.centre == centre
    driver.app.act("pause")
    driver.move(driver.stage.camera.to_pixels(tuple(places(driver)["left"].tolist())))
    driver.frames(2)
    driver.key(pygame.K_f, SHIFT)
    driver.app.act("pause")
    driver.frames(120)
    assert driver.stage.camera.centre[0] < -8.0


def test_it_goes_along_with_what_is_driven(open_app):
    driver = open_app(load_level("suspension_car"))
    driver.key(pygame.K_f, SHIFT)
    assert driver.stage.following.particle is not None
    driver.frames(60)
    car = driver.world.position[driver.stage.following.particle]
    assert np.abs(np.array(driver.stage.camera.centre) - car).max() < 3.0


def test_what_is_gone_is_not_followed(open_app):
    driver = open_app(flying(follow="right"))
    driver.frames(5)
    slot = driver.world.particle_slot("right")
    driver.world.particle_active[slot] = False
    driver.frames(3)
    driver.playback.session.world.particle_active[slot] = True


@pytest.mark.parametrize(
    ("look", "line"),
    [({"follow": "rihgt"}, 'look.follow: there is no body or particle "rihgt"; did you mean "right"?'),
     ({"material": "glas"}, 'look.material: there is no material "glas"')],
)  # fmt: skip
def test_a_look_that_names_what_is_not_there_is_refused(look, line):
    with pytest.raises(LevelError) as refused:
        flying(**look)
    assert refused.value.faults == [f"apart: {line}"]


def test_the_panel_opens_on_the_material_that_the_level_names(open_app):
    level = load_level("jelly_pile")
    named = parse_level(
        json.dumps({**json.loads(level_text(level)), "look": {"material": "rubber"}}).encode(), "rubber first"
    )
    assert open_app(named).panel.menu.chosen == "rubber"
    assert build_world(named).particle_count == build_world(level).particle_count
