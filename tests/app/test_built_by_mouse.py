"""Machines that a person builds by mouse from an empty sheet, and what they do when they play."""

import numpy as np
import pygame
import pytest

from sandbox.editor.edits.copying import place_part
from sandbox.editor.storage.level_file import catalogue
from tests.support.machines import build_car, build_chain, build_walker, check_car


def play(driver):
    """Play what is drawn, at once."""
    driver.key(pygame.K_e)
    driver.frames(2)


def place(driver, name):
    return driver.world.position[driver.world.particle_slot(name)]


def test_a_car_built_by_mouse_crosses_a_bridge(edit):
    driver = edit()
    build_car(driver)
    level = driver.editor.document.level
    assert [body.type for body in level.bodies] == ["bridge", "mesh", "wheel", "wheel"]
    assert [a for a, _ in level.welds] == ["rear axle", "front axle"]
    play(driver)
    assert place(driver, "front axle")[0] < -3.0
    driver.post(pygame.KEYDOWN, key=pygame.K_d, mod=0, unicode="d")
    deepest = 0.0
    for _ in range(600):
        driver.pass_unseen()
        deepest = min(deepest, float(place(driver, "bridge.4")[1]))
        if place(driver, "rear axle")[0] > 2.5:
            break
    # Both axles are across, the right way up, and the bridge has carried them and is whole.
    assert place(driver, "rear axle")[0] > 2.5
    assert place(driver, "chassis.5")[1] > place(driver, "rear axle")[1]
    assert deepest > -1.5 and driver.world.spring_active[: driver.world.grab_spring].all()
    assert abs(place(driver, "bridge.4")[1] + 1.0) < 0.1


def test_a_jelly_built_by_mouse_walks_on_three_feet(edit):
    driver = edit()
    build_walker(driver)
    level = driver.editor.document.level
    assert [particle.position for particle in level.particles] == [(-5.0, -2.0), (-4.0, -2.0), (-3.0, -2.0)]
    assert [spring.a for spring in level.springs] == [f"jelly.{k}" for k in (0, 4, 4, 8, 8, 12)]
    phases = [spring.drive.phase for spring in level.springs]
    # The wave runs ahead: what lies farther along it swings later.
    assert phases == sorted(phases, reverse=True) and phases[0] - phases[-1] == pytest.approx(2.5 / 3.0, abs=0.001)
    play(driver)
    start = float(place(driver, "jelly.6")[0])
    driver.frames(480)
    assert place(driver, "jelly.6")[0] > start + 1.5
    # On its feet, not on its side.
    assert place(driver, "jelly.32")[1] > place(driver, "jelly.6")[1] > place(driver, "particle")[1] + 0.5


def checked(driver):
    """Run the checks by their button; the last row of the list."""
    page = driver.editor.side.page
    driver.click_widget(page.buttons[2])
    page.trial.wait()
    driver.frames(2)
    return page.list.rows[-1].detail


def test_the_car_has_a_check_that_holds_because_it_holds_the_key(edit):
    driver = edit()
    build_car(driver)
    check_car(driver)
    assert checked(driver).startswith("holds"), checked(driver)
    driver.editor.side.page.form._press_key("hold.0.key", None)
    driver.frames(2)
    assert checked(driver).startswith("fails")


def test_a_chain_of_a_ball_dominoes_and_a_ball_ends_in_the_basket(edit):
    driver = edit()
    driver.app.display.window.size = (1280, 720)
    driver.frames(2)
    build_chain(driver)
    level = driver.editor.document.level
    assert [body.position[0] for body in level.bodies] == pytest.approx([-1.875, -1.175, -0.475, 0.225])
    assert checked(driver).startswith("holds"), checked(driver)
    play(driver)
    driver.frames(300)
    x, y = place(driver, "particle 2")
    assert 1.2 < x < 4.5 and y < -1.5


@pytest.mark.parametrize("deed", ["move", "turn", "copy"])
def test_a_ready_car_is_moved_turned_and_copied_whole(edit, deed):
    driver = edit()
    part = next(part for part in catalogue() if part.path.stem == "car")
    driver.editor.edit("Put", lambda document: place_part(document, part.level, (0.0, 0.0)))
    driver.editor.select(frozenset())
    driver.app.act("fit")
    driver.frames(2)
    before = driver.editor.scene
    lengths = before.rest_length.copy()
    hub = before.position[before.slot("car.0")]
    if deed == "turn":
        driver.click_at(*hub)
        handles = driver.editor.pointer_tool.handles()
        x, y = driver.editor.camera.to_world(handles.knob)
        driver.drag((x, y), (x + 0.3, y), (x + 0.6, y - 0.05))
    else:
        if deed == "copy":
            driver.click_at(*hub)
        driver.drag(hub, hub + 1.0, np.add(hub, (3.0, 1.0)), mods=pygame.KMOD_CTRL if deed == "copy" else 0)
    after = driver.editor.scene
    apart = np.linalg.norm(after.position[after.particle_a] - after.position[after.particle_b], axis=1)
    count = 2 if deed == "copy" else 1
    assert len(after.rest_length) == count * len(lengths)
    # Nothing is torn: each spring has the length that it had.
    was = np.linalg.norm(before.position[before.particle_a] - before.position[before.particle_b], axis=1)
    assert np.allclose(np.sort(apart), np.sort(np.tile(was, count)), atol=1e-9)
    assert not np.allclose(after.position[-1], before.position[-1])
