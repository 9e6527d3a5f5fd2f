"""Backgrounds of widgets: corners as the library draws them, the rest stretched; states that are drawn when seen."""

import numpy as np
import pygame
import pytest
from pygame_gui.core.drawable_shapes import RoundedRectangleShape

from sandbox.app.draw.colours import TEXT
from sandbox.app.widgets.icons import ICONS, painted_icon
from sandbox.app.widgets.shapes import Shapes


class Unstretched(Shapes):
    """The library's own way."""

    def find_surface_in_cache(self, lookup_id):
        return None


def picture(shapes, size, radius, border):
    theming = {
        "normal_bg": pygame.Color("#2d3543c0"),
        "normal_border": pygame.Color("#5ed0b2"),
        "border_width": border,
        "shape_corner_radius": [radius] * 4,
        "border_overlap": 1,
    }
    surface = RoundedRectangleShape(pygame.Rect((0, 0), size), theming, ["normal"], shapes).get_surface("normal")
    return np.dstack([pygame.surfarray.array3d(surface), pygame.surfarray.array_alpha(surface)]).astype(int)


@pytest.fixture
def ui(driver):
    return driver.app.ui


@pytest.mark.parametrize(("radius", "border"), [(0, 0), (0, 2), (5, 0), (6, 1), (12, 1), (13, 2)])
@pytest.mark.parametrize("size", [(300, 34), (34, 201), (90, 33), (36, 36), (10, 60), (401, 246)])
def test_what_is_stretched_is_what_the_library_draws_but_for_shades_of_its_corners(size, radius, border):
    drawn, stretched = (picture(shapes, size, radius, border) for shapes in (Unstretched(), Shapes()))
    differs = (drawn != stretched).any(axis=2)
    # It gives the background the corners of the border, made smaller: how much depends on the size.
    edge = radius + border + 1
    assert not differs[edge : size[0] - edge].any() and not differs[:, edge : size[1] - edge].any()
    assert np.abs(drawn - stretched).max() <= (60 if border else 0)


def test_a_state_that_was_not_seen_yet_shows_what_the_button_says_by_then(ui):
    place = pygame.Rect(10, 10, 120, 34)
    button, fresh = ui.button(place, "before", lambda: None), ui.button(place, "after", lambda: None)
    for each in (button, fresh):
        each.select()
        each.unselect()
    button.set_text("after")
    for state in ("selected", "hovered", "active", "disabled", "normal"):
        for each in (button, fresh):
            each.drawable_shape.set_active_state(state)
        now, wanted = (pygame.image.tobytes(each.drawable_shape.get_surface(state), "RGBA") for each in (button, fresh))
        assert now == wanted, state


def test_a_picture_that_is_shown_later_looks_as_one_that_was_given_at_once(ui):
    place = pygame.Rect(10, 10, 36, 36)
    play, stop = (painted_icon(ICONS[name], 20, TEXT) for name in ("play", "stop"))
    button, fresh = (ui.button(place, "", lambda: None, icon=icon) for icon in (play, stop))
    assert pygame.image.tobytes(button.image, "RGBA") != pygame.image.tobytes(fresh.image, "RGBA")
    button.show_icon(stop)
    assert pygame.image.tobytes(button.image, "RGBA") == pygame.image.tobytes(fresh.image, "RGBA")


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_what_of_an_icon_is_half_transparent_is_half_the_button_it_lies_on(driver, theme):
    driver.app.chosen.choose("theme", theme)
    ui, icon = driver.app.ui, pygame.Surface((12, 12), pygame.SRCALPHA)
    icon.fill((200, 100, 50, 128))
    bare, shown = (ui.button(pygame.Rect(4, 4, 34, 34), "", lambda: None, icon=each) for each in (None, icon))
    below, mixed = bare.image.get_at((17, 17)), shown.image.get_at((17, 17))
    assert all(abs(2 * mixed[k] - below[k] - icon.get_at((0, 0))[k]) <= 6 for k in range(3))


def test_shapes_are_kept_in_so_many_bytes(monkeypatch):
    monkeypatch.setattr("sandbox.app.widgets.shapes.HELD", 2 * 4 * 20 * 10)
    shapes = Shapes()
    pictures = [pygame.Surface((20, 10), pygame.SRCALPHA) for _ in range(3)]
    for name, each in zip("abc", pictures, strict=True):
        shapes.add_surface_to_cache(each, name)
    assert [shapes.find_surface_in_cache(name) for name in "abc"] == [None, *pictures[1:]]
