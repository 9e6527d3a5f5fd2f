"""The panel of who plays: firmness, gravity, wind, melting and what the level's text asks for; all else by a word."""

import pygame
import pytest

from sandbox.app.panel.panel import MORE, SECTIONS, has_use
from sandbox.app.run.playback import RAMP_TIME
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.physics.analysis.query import shown_particles
from sandbox.session.commands import SetAir, SetGravity
from tests.app.conftest import small_level
from tests.support.wholes import some_and_whole

LEVELS = [path.stem for path in shipped_levels()]


@pytest.fixture
def player(open_app):
    """The app on the small level for somebody who has opened nothing of the panel."""
    return open_app(small_level(settings={"gravity": [0.0, -9.81]}), more=False)


def in_sight(driver, widget):
    """Whether a widget of the panel is seen whole, as it lies there."""
    return bool(widget.visible) and driver.panel.area.view.rect.contains(widget.rect)


def asked_for(driver, name):
    """Widgets of a section that a level's text can mean."""
    panel = driver.panel
    solvers = panel.engineers.form.choices["solver"].buttons.values()
    return {
        "springs": [panel.menu, panel.form.fields["stiffness"][0], panel.form.fields["damping"][0]],
        "engineers": [*solvers, driver.entry("iterations"), driver.entry("tick_rate")],
        "world": [driver.entry("gravity_x")],
    }[name]


def commands(driver, kind):
    return [each for each in driver.playback.session.history.log if isinstance(each.command, kind)]


def test_a_player_sees_what_play_needs_and_one_word_opens_the_rest_for_later_runs_too(player, open_app):
    panel = player.panel
    assert in_sight(player, panel.play.gravity) and in_sight(player, panel.play.melt)
    rest = [widget for name in SECTIONS for widget in asked_for(player, name)]
    assert not any(widget.visible for widget in rest)
    heading = next(each for each in panel.area.content.children if getattr(each, "text", "") == "More")
    player.click_widget(heading)
    assert all(widget.visible for name in SECTIONS for widget in asked_for(player, name))
    assert open_app(small_level(), more=False).panel.is_open(MORE)


@pytest.mark.parametrize("name", some_and_whole(LEVELS[::4], LEVELS))
def test_what_the_text_of_a_level_asks_for_is_in_sight_without_scrolling(name, open_app):
    driver = open_app(load_level(name), more=False)
    driver.app.display.window.size = (1280, 720)
    driver.frames(2)
    panel, hands = driver.panel, driver.playback.level.hands
    assert (panel is not None) == has_use(driver.playback.level)
    if panel is None:
        return
    wanted = [panel.play.gravity, panel.play.wind] if hands is None or hands.allows("air") else []
    wanted += [panel.play.melt] if hands is None or hands.allows("solver") else []
    wanted += panel.firmness.words.buttons.values() if panel.firmness.shown else []
    for section in (name for name, each in SECTIONS.items() if each.is_asked_for(driver.playback.level.description)):
        wanted += asked_for(driver, section)
    hidden = [widget for widget in wanted if not in_sight(driver, widget)]
    assert not hidden


def test_gravity_is_turned_over_in_one_drag_that_is_undone_at_once(open_app):
    driver = open_app(load_level("hourglass"), more=False)
    dial = driver.panel.play.gravity
    driver.press(dial.pixel_of((0.0, -9.81)))
    for y in (-5.0, 0.0, 5.0, 9.7):
        driver.move(dial.pixel_of((0.0, y)))
    driver.release(dial.pixel_of((0.0, 9.7)))
    # It comes to rest on the ring of the Earth's gravity.
    assert driver.world.settings.gravity == (0.0, 9.81)
    assert len({each.gesture for each in commands(driver, SetGravity)}) == 1
    grains = shown_particles(driver.world) & (driver.world.inverse_mass > 0.0)
    driver.frames(round(RAMP_TIME * driver.world.settings.tick_rate))
    before = driver.world.position[grains, 1].copy()
    driver.frames(30)
    assert (driver.world.position[grains, 1] > before).mean() > 0.9
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.world.settings.gravity == (0.0, -9.81)


def test_the_wind_moves_things_and_in_the_middle_the_air_is_the_level_s_own(player):
    dial = player.panel.play.wind
    player.press(dial.pixel_of((0.0, 0.0)))
    player.move(dial.pixel_of((10.0, 0.0)))
    player.release(dial.pixel_of((10.0, 0.0)))
    speed, still = player.world.settings.wind
    assert speed == pytest.approx(10.0, abs=0.5) and still == 0.0 and player.world.settings.drag > 0.0
    player.frames(20)
    pair = player.world.particle_slot("pair.0")
    assert player.world.velocity[pair, 0] > 1.0
    player.click(dial.rect.center)
    assert player.world.settings.wind == (0.0, 0.0) and player.world.settings.drag == 0.0
    assert len({each.gesture for each in commands(player, SetAir)}) == 2


def test_keys_turn_a_dial_by_steps_as_far_as_its_rim(player):
    dial = player.panel.play.gravity
    player.app.ui.focus_on(dial)
    player.key(pygame.K_UP)
    assert player.world.settings.gravity == pytest.approx((0.0, -8.83), abs=0.01)
    player.key(pygame.K_RIGHT, pygame.KMOD_SHIFT)
    assert player.world.settings.gravity == pytest.approx((0.1, -8.83), abs=0.01)
    for _ in range(40):
        player.key(pygame.K_DOWN)
    assert player.world.settings.gravity[1] == pytest.approx(-19.62, abs=0.02)
    player.key(pygame.K_HOME)
    assert player.world.settings.gravity == (0.0, 0.0)


def test_without_springs_there_is_nothing_to_melt_or_to_take_home(open_app):
    driver = open_app(small_level(bodies=[], particles=[{"id": "ball", "position": [0, 0]}]), more=False)
    assert not driver.panel.play.melt.is_enabled and not driver.panel.play.take_home.is_enabled
    assert open_app(small_level(), more=False).panel.play.melt.is_enabled


def test_the_first_body_that_joins_a_run_brings_the_rows_of_its_firmness(player):
    player.app.documents.play_new()
    player.frames(2)
    assert not player.panel.firmness.shown
    player.key(pygame.K_6)
    left, top, width, height = player.app.play.viewport
    player.click((left + width // 2, top + height // 2))
    player.frames(5)
    assert player.panel.firmness.shown and len(player.panel.firmness.bodies) == 1
    assert in_sight(player, player.panel.firmness.sag)
