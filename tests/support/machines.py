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
    driver.fill(driver.editor.options.fields["cells"][0], "2")
    driver.fill(driver.editor.options.fields["sag"][0], "0.03")
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


def build_chain(driver):
    """A ball on a slope, four dominoes, and a ball before a basket; a check that the last ball comes into it."""
    slope, basket = (
        ((-5.5, -2.8), (-5.5, 2.5), (-2.8, 0)),
        ((1.2, 0), (1.2, -2), (4.5, -2), (4.5, -1), (5, -1), (5, -2.8)),
    )
    draw_ground(driver, *slope, *basket)
    driver.key(pygame.K_x, SHIFT)
    driver.type("0.05")
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_a)
    for radius, mass, place in (("0.3", "4", (-5, 2.5)), ("0.3", "0.5", (0.9, 0.3))):
        driver.fill(driver.editor.options.fields["radius"][0], radius)
        driver.fill(driver.editor.options.fields["mass"][0], mass)
        driver.click_at(*place)
    driver.key(pygame.K_j)
    driver.fill(driver.editor.options.fields["cells"][0], "1")
    driver.drag((-2, 0), (-1.9, 0.5), (-1.75, 1))
    driver.key(pygame.K_v)
    for x in (-1.875, -1.175, -0.475):
        driver.drag((x, 0.5), (x + 0.4, 0.5), (x + 0.7, 0.5), mods=pygame.KMOD_CTRL)
    page = open_checks(driver)
    choose_metric(driver, "inside a box")
    driver.click_widget(page.form._named["particle pick"])
    driver.click_at(0.9, 0.3)
    driver.frames(2)
    driver.click_widget(page.form._named["box pick"])
    driver.drag((1.2, -2), (2, -1), (4.5, -0.5))
    driver.frames(2)


def check_car(driver):
    """A check that the car of `build_car` is across after some seconds, with D held."""
    page = open_checks(driver)
    choose_metric(driver, "x")
    driver.click_widget(page.form._named["body pick"])
    driver.click_at(-4.25, -0.3)
    driver.frames(2)
    driver.fill(page.form.fields["at_least"][0], "2.5")
    driver.fill(page.form.fields["after"][0], "6")
    # The page brings into sight what has the keyboard.
    for widget in (lambda: page.form.buttons["hold"], lambda: page.form.keys["hold.0.key"]):
        driver.app.ui.focus_on(widget())
        driver.frames(2)
        driver.click_widget(widget())
        driver.frames(2)
    driver.key(pygame.K_d)
    driver.frames(2)


def open_checks(driver):
    """The page of checks, with a new one."""
    driver.editor.side.choose("checks")
    driver.frames(2)
    driver.click_widget(driver.editor.side.page.buttons[0])
    driver.frames(2)
    return driver.editor.side.page


def choose_metric(driver, words):
    """Choose a metric from its menu by keys."""
    picker = driver.editor.side.page.form.pickers["metric"]
    driver.app.ui.focus_on(picker)
    driver.key(pygame.K_RETURN)
    index = [row.text for row in picker.rows].index(words)
    driver.key(pygame.K_HOME)
    for _ in range(index):
        driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
    driver.frames(2)
