"""Machines that a person builds by mouse from an empty sheet, and what they do when they play."""

import pygame
import pytest

SHIFT = pygame.KMOD_SHIFT


def draw_ground(driver, *corners):
    """Solid ground, corner by corner."""
    driver.key(pygame.K_d)
    for corner in corners:
        driver.click_at(*corner)
    driver.key(pygame.K_RETURN)


def play(driver):
    """Play what is drawn, at once."""
    driver.key(pygame.K_e)
    driver.frames(2)


def place(driver, name):
    return driver.world.position[driver.world.particle_slot(name)]


def test_a_car_built_by_mouse_crosses_a_bridge(edit):
    driver = edit()
    draw_ground(driver, (-6, -2.5), (-2, -2.5), (-2, -1), (-6, -1))
    draw_ground(driver, (2, -2.5), (6, -2.5), (6, -1), (2, -1))
    driver.key(pygame.K_b)
    driver.drag((-2, -1), (0, -1), (2, -1))
    driver.key(pygame.K_g, SHIFT)
    driver.drag((-5, -0.5), (-4, -0.5), (-3.5, -0.5))
    driver.key(pygame.K_q, SHIFT)
    driver.drag((-5, -0.5), (-5, -0.9))
    driver.drag((-3.5, -0.5), (-3.5, -0.9))
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
    draw_ground(driver, (-7, -4), (7, -4), (7, -2), (-7, -2))
    driver.key(pygame.K_j)
    driver.fill(driver.editor.options.fields["cells"], "1")
    driver.drag((-5.5, -1), (-4, -0.8), (-2.5, -0.5))
    driver.key(pygame.K_s)
    # A foot under every second cell, each on two muscles.
    legs = [((hip, -1.0), (-5.0 + foot, -2.0)) for foot in range(3) for hip in (-5.5 + foot, -4.5 + foot)]
    for hip, foot in legs:
        driver.drag(hip, foot)
    level = driver.editor.document.level
    assert [particle.position[0] for particle in level.particles] == pytest.approx([-5.0, -4.0, -3.0], abs=0.02)
    assert [spring.a for spring in level.springs] == [f"jelly.{k}" for k in (0, 2, 2, 4, 4, 6)]
    driver.key(pygame.K_v)
    for number, (hip, foot) in enumerate(legs):
        driver.click_at((hip[0] + foot[0]) / 2, (hip[1] + foot[1]) / 2)
        driver.frames(2)
        form = driver.editor.side.page.form
        driver.click_widget(form.buttons["drive"])
        driver.frames(2)
        # Opposite feet step in turns; of each the one behind swings a quarter of a period later.
        phase = (0.5 * (number // 2) + 0.75 * (number % 2)) % 1.0
        driver.fill(driver.editor.side.page.form.fields["drive.phase"][0], str(phase))
    drives = [spring.drive for spring in driver.editor.document.level.springs]
    assert [drive.phase for drive in drives] == [0.0, 0.75, 0.5, 0.25, 0.0, 0.75]
    play(driver)
    start = float(place(driver, "jelly.3")[0])
    driver.frames(480)
    assert place(driver, "jelly.3")[0] > start + 2.0
    # On its feet, not on its side.
    assert place(driver, "jelly.10")[1] > place(driver, "jelly.3")[1] > place(driver, "particle")[1] + 0.5
