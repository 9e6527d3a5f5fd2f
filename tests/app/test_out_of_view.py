"""What has left the picture is counted, brought back by one button, and only then said to be gone."""

import numpy as np
import pygame
import pytest

from sandbox.app.play.problems import LEFT_VIEW, NOTHING_BACK
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.physics.analysis.applied_forces import overlapping
from sandbox.session.commands import CutSprings, MoveBody
from tests.app.conftest import small_level
from tests.app.test_following import flying, places
from tests.support.wholes import some_and_whole

# The ball of one throws bricks out of the picture.
LEVELS = [path.stem for path in shipped_levels() if path.stem != "wrecking_ball"]


def button(driver):
    return driver.app.play.problems.quick_fixes.buttons["bring_back"]


def in_picture(driver, body):
    left, bottom, right, top = driver.app.play.problems._pictures[0]
    x, y = driver.world.position[body].mean(axis=0)
    return left <= x <= right and bottom <= y <= top


def test_what_has_left_the_picture_is_brought_back_at_rest_and_that_is_undone(open_app):
    driver = open_app(flying())
    driver.frames(10)
    assert not button(driver).visible
    driver.frames(200)
    assert button(driver).visible and button(driver).text == "Bring back 2" and LEFT_VIEW in driver.notices
    before = driver.world.position.copy()
    driver.click_widget(button(driver))
    driver.frames(2)
    there = np.stack(list(places(driver).values()))
    assert (np.abs(there) <= [5.0, 3.0]).all() and np.abs(driver.world.velocity).max() < 1e-9
    assert not button(driver).visible and LEFT_VIEW not in driver.notices
    assert "2 are back in the picture." in driver.notices
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.frames(60)
    assert np.abs(driver.world.position - before).max() < 20.0 and places(driver)["right"][0] > 15.0
    driver.app.act("reset")
    driver.frames(2)
    driver.app.act("bring_back")
    assert driver.notices[-1] == "Nothing has left the picture."


def test_what_lies_beside_the_picture_comes_back_into_a_free_place_while_others_stay(open_app):
    driver = open_app(load_level("jelly_pile"))
    world = driver.world
    bodies = [np.flatnonzero(world.owner == owner) for owner in np.unique(world.owner[world.owner >= 0])]
    left, _, right, _ = driver.app.play.problems._pictures[0]
    gesture = driver.playback.session.new_gesture()
    for number, body in enumerate(bodies[:3]):
        way = right - left + 3.0 * number
        driver.playback.submit(MoveBody(int(body[0]), (way, 4.0), at_rest=True), gesture)
    driver.pass_unseen(90)
    assert button(driver).text == "Bring back 3" and LEFT_VIEW not in driver.notices
    others = world.position[bodies[5]].mean(axis=0)
    driver.click_widget(button(driver))
    driver.frames(2)
    assert all(in_picture(driver, body) for body in bodies) and not button(driver).visible
    assert np.abs(world.position[bodies[5]].mean(axis=0) - others).max() < 0.5
    assert not overlapping(world)


def test_what_was_thrown_up_and_falls_back_has_not_left(open_app):
    ball = {"id": "ball", "position": [0, 0], "velocity": [0, 14], "radius": 0.3}
    driver = open_app(small_level(bodies=[], particles=[ball], settings={"gravity": [0, -9.81]}, view=[-4, -3, 4, 3]))
    highest, seen = 0.0, []
    for _ in range(160):
        driver.pass_unseen(1)
        highest = max(highest, float(driver.world.position[driver.world.particle_slot("ball"), 1]))
        seen.append(bool(button(driver).visible))
    assert highest > 9.0 and not any(seen) and LEFT_VIEW not in driver.notices
    driver.pass_unseen(150)
    assert button(driver).visible


def test_what_hangs_on_something_that_is_held_stays(open_app):
    driver = open_app(small_level(view=[-1.0, -1.0, 1.0, 3.0]))
    driver.app.display.window.size = (640, 640)
    driver.pass_unseen(100)
    driver.frames(1)
    # The rope reaches out of the picture, and is pinned within it.
    assert not button(driver).visible


@pytest.mark.parametrize("name", some_and_whole(LEVELS[::6], LEVELS[::2]))
def test_no_level_has_lost_anything_by_itself_after_some_seconds(open_app, name):
    driver = open_app(load_level(name))
    driver.pass_unseen(240)
    driver.frames(1)
    assert not button(driver).visible and LEFT_VIEW not in driver.notices


def test_a_flat_bridge_that_sags_under_its_weight_is_in_the_picture(open_app):
    rope = {"type": "rope", "id": "rope", "start": [0, 0], "end": [8, 0], "segments": 32, "pin": ["start", "end"],
            "rest_length": 0.2875, "material": "steel"}  # fmt: skip
    weight = {"id": "weight", "position": [4, 0], "mass": 2000.0}
    level = small_level(bodies=[rope], particles=[weight], welds=[["rope.16", "weight"]], view=None,
                        settings={"gravity": [0, -9.81], "solver": "direct"})  # fmt: skip
    driver = open_app(level)
    driver.frames(300)
    assert not button(driver).visible and LEFT_VIEW not in driver.notices


FIRST_OUT = {"id": "waiting", "position": [40, 2], "radius": 0.2, "mass": 1}


def test_what_was_out_at_the_start_and_stubs_of_cut_ropes_are_not_brought_back(open_app):
    rope = {"type": "rope", "id": "thread", "start": [0, 0], "end": [4, 0], "segments": 8, "pin": ["start"],
            "material": "steel"}  # fmt: skip
    driver = open_app(small_level(bodies=[rope], particles=[FIRST_OUT]))
    driver.frames(120)
    assert not button(driver).visible
    driver.playback.submit(CutSprings((6,)))
    driver.playback.submit(MoveBody(driver.world.particle_slot("thread.end"), (90.0, 0.0), at_rest=True))
    driver.frames(120)
    assert not button(driver).visible
    driver.playback.submit(CutSprings((1,)))
    driver.playback.submit(MoveBody(driver.world.particle_slot("thread.3"), (80.0, 0.0), at_rest=True))
    driver.frames(120)
    assert button(driver).visible and button(driver).text == "Bring back 1"


def test_in_a_level_with_a_goal_nothing_is_brought_back_and_the_key_says_why(open_app):
    rule = {"id": "late", "when": {"time": 500}, "then": [{"win": "Well waited"}]}
    driver = open_app(small_level(goal="Wait", rules=[rule]))
    driver.playback.submit(MoveBody(driver.world.particle_slot("pair.end"), (90.0, 0.0), at_rest=True))
    driver.frames(120)
    assert driver.app.play.problems.out_of_view.lost_count == 1 and not button(driver).visible
    driver.app.act("bring_back")
    driver.frames(2)
    assert NOTHING_BACK in driver.notices and driver.world.position[:, 0].max() > 80.0
