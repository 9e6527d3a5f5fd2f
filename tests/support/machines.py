"""Machines that a person builds by mouse from an empty sheet; docs/built-by-mouse.md tells the same deeds."""

import pygame

SHIFT = pygame.KMOD_SHIFT


def draw_ground(driver, *corners):
    """Solid ground, corner by corner."""
    driver.key(pygame.K_d)
    for corner in corners:
        driver.click_at(*corner)
    driver.key(pygame.K_RETURN)


def build_car(driver):
    """Two cliffs, a bridge between them, and a car with a driven wheel on each axle before it."""
    draw_ground(driver, (-6, -2.5), (-2, -2.5), (-2, -1), (-6, -1))
    draw_ground(driver, (2, -2.5), (6, -2.5), (6, -1), (2, -1))
    driver.key(pygame.K_b)
    driver.drag((-2, -1), (0, -1), (2, -1))
    driver.key(pygame.K_g, SHIFT)
    driver.drag((-5, -0.5), (-4, -0.5), (-3.5, -0.5))
    driver.key(pygame.K_q, SHIFT)
    driver.drag((-5, -0.5), (-5, -0.9))
    driver.drag((-3.5, -0.5), (-3.5, -0.9))


def build_walker(driver):
    """A jelly on three feet of two springs each, which are muscles with a wave through them."""
    draw_ground(driver, (-7, -3.5), (7, -3.5), (7, -2), (-7, -2))
    driver.key(pygame.K_j)
    driver.fill(driver.editor.options.fields["cells"], "2")
    driver.drag((-5.5, -1), (-4, -0.8), (-2.5, -0.5))
    driver.key(pygame.K_s)
    for foot in (-5.0, -4.0, -3.0):
        for hip in (foot - 0.5, foot + 0.5):
            driver.drag((hip, -1.0), (foot, -2.0))
    # A box over feet and hips takes the springs, and leaves the jelly.
    driver.key(pygame.K_v)
    driver.drag((-6.2, -0.8), (-4.0, -1.5), (-1.8, -2.4))
    driver.frames(2)
    driver.click_widget(driver.editor.side.page.form.buttons["drive"])
    driver.frames(2)
    driver.key(pygame.K_w, SHIFT)
    driver.drag((-5.5, -1.5), (-4.0, -1.5), (-2.5, -1.5))
