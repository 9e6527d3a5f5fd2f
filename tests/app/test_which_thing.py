"""Which thing it is: clicks choose bodies, menus light them up, lines to type into select their numbers."""

import numpy as np
import pygame
import pytest

from sandbox.level.reading.files import load_level
from sandbox.session.commands import Grab, MoveBody


@pytest.fixture
def pile(open_app):
    driver = open_app(load_level("jelly_pile"))
    driver.app.display.window.size = (1280, 860)
    driver.frames(3)
    return driver


def middle_of(driver, name):
    world = driver.world
    slots = [k for k, each in enumerate(world.particle_names) if each.startswith(f"{name}.")]
    return driver.stage.camera.to_pixels(tuple(world.position[slots].mean(axis=0).tolist()))


def test_a_click_on_a_body_chooses_it_and_its_material(pile):
    at = middle_of(pile, "cube 1")
    pile.press(at)
    pile.release(at)
    panel = pile.panel
    assert panel.firmness.menu.chosen == "cube 1"
    assert panel.menu.chosen == "jelly"
    pile.click_widget(panel.firmness.words.buttons["rigid"])
    pile.frames(3)
    world = pile.world
    rigid = world.stiffness == 1.0
    own = panel.firmness.springs_of("cube 1")
    assert rigid[own].all() and not rigid[~own & (world.material >= 0)].any()


def test_a_drag_of_a_body_chooses_nothing(pile):
    x, y = middle_of(pile, "cube 1")
    pile.press((x, y))
    pile.move((x + 40, y))
    pile.release((x + 40, y))
    assert pile.panel.firmness.menu.chosen == "All bodies"


def test_what_a_menu_points_at_is_lit_on_the_stage(pile):
    panel = pile.panel
    assert pile.stage.lit is None
    pile.move(panel.menu.rect.center)
    pile.frames(2)
    chosen = panel.menu.chosen
    of_chosen = pile.world.material == list(pile.world.material_names).index(chosen)
    assert np.array_equal(pile.stage.lit, of_chosen)
    before = pile.app.display.surface.copy()
    pile.move((200, 200))
    pile.frames(2)
    assert pile.stage.lit is None
    shown, bare = (pygame.surfarray.array3d(each) for each in (before, pile.app.display.surface))
    assert np.any(shown[:900, 60:800] != bare[:900, 60:800])


def test_a_click_into_a_number_selects_it_and_tab_goes_on_from_there(pile):
    panel, ui = pile.panel, pile.app.ui
    entry = panel.form.fields["stiffness"][0]
    pile.press(entry.rect.center)
    pile.release(entry.rect.center)
    assert entry.focused and entry.selected == (0, len(entry.typed))
    pile.key(pygame.K_TAB)
    assert ui.focus is panel.form.fields["damping"][0]


def test_the_wheel_steps_the_pad_that_was_clicked_and_scrolls_elsewhere(pile):
    pad = pile.panel.pad
    at = pad.pixel_of(0.5, 0.6)
    pile.move(at)
    before = pad.state
    pile.post(pygame.MOUSEWHEEL, x=0, y=1, precise_x=0.0, precise_y=1.0)
    pile.frames(2)
    assert pad.state == before
    pile.press(at)
    pile.release(at)
    pile.frames(1)
    first = pad.state.stiffness
    pile.post(pygame.MOUSEWHEEL, x=0, y=1, precise_x=0.0, precise_y=1.0)
    pile.frames(2)
    assert first < pad.state.stiffness < 1.1 * first


def test_a_drag_while_paused_moves_a_body_and_one_while_time_goes_on_holds_it(pile):
    pile.app.act("pause")
    pile.frames(2)
    x, y = middle_of(pile, "cube 1")
    place = pile.world.position.copy()
    pile.press((x, y))
    pile.move((x + 30, y - 50))
    pile.release((x + 30, y - 50))
    kinds = {type(entry.command) for entry in pile.playback.session.history.log}
    assert kinds == {MoveBody}
    moved = np.abs(pile.world.position - place).max(axis=1) > 1e-9
    assert 0 < moved.sum() < len(moved) / 4
    pile.key(pygame.K_z, pygame.KMOD_CTRL)
    assert pile.world.position == pytest.approx(place, nan_ok=True)
    pile.app.act("pause")
    pile.press(middle_of(pile, "cube 1"))
    pile.frames(2)
    assert any(isinstance(entry.command, Grab) for entry in pile.playback.session.history.log)
