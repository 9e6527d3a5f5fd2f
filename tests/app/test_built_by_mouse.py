"""Machines that a person builds by mouse from an empty sheet, and what they do when they play."""

import pygame
import pytest

from tests.support.machines import build_car, build_walker


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
        driver.frames()
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
