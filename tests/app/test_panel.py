"""The panel: sliders, typed values, readings and limits."""

import numpy as np
import pygame
import pytest

from sandbox.app.base.sag_map import PLAIN, CoefficientScale
from sandbox.physics.equation import frequency_from_coefficients
from sandbox.session.commands import SetCoefficients
from tests.app.conftest import small_level


@pytest.fixture
def driver(driver):
    driver.take_sliders()
    return driver


def coefficients(driver):
    steel = driver.world.spring_slot("rope:0")
    rubber = driver.world.spring_slot("pair:0")
    world = driver.world
    return tuple(float(x) for x in (world.stiffness[steel], world.damping[steel], world.stiffness[rubber]))


def logged(driver):
    return [entry for entry in driver.playback.session.history.log if isinstance(entry.command, SetCoefficients)]


def test_a_slider_drag_is_one_gesture_and_undone_at_once(driver):
    slider = driver.panel.form.sliders["stiffness"]
    y = slider.rect.centery
    driver.press((slider.pixel_of(0.01), y))
    for value in (0.02, 0.05, 0.1, 0.2):
        driver.move((slider.pixel_of(value), y))
    driver.release((slider.pixel_of(0.2), y))
    entries = logged(driver)
    assert len(entries) >= 5 and len({entry.gesture for entry in entries}) == 1
    assert coefficients(driver)[0] == pytest.approx(0.2, rel=0.05)
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert coefficients(driver) == (0.3, 0.3, 0.02)


def test_two_slider_drags_are_two_gestures(driver):
    slider = driver.panel.form.sliders["damping"]
    for value in (0.01, 0.1):
        driver.press((slider.pixel_of(value), slider.rect.centery))
        driver.release((slider.pixel_of(value), slider.rect.centery))
    assert len({entry.gesture for entry in logged(driver)}) == 2


def test_a_chosen_material_alone_is_changed(driver):
    driver.panel._choose_material("rubber")
    driver.fill(driver.panel.form.fields["stiffness"][0], "0.5")
    assert coefficients(driver) == (0.3, 0.3, 0.5)


def test_the_menu_shows_the_material_that_the_keyboard_chose(driver):
    menu = driver.panel.menu
    driver.panel.choose_material(None)
    driver.app.ui.focus_on(menu)
    for wanted in ("default", "steel", "rubber"):
        for key in (pygame.K_RETURN, pygame.K_DOWN, pygame.K_RETURN):
            driver.key(key)
        assert menu.chosen == wanted and driver.app.ui.focus is menu
    for key in (pygame.K_DOWN, pygame.K_UP, pygame.K_SPACE):
        driver.key(key)
    assert menu.chosen == "steel"
    driver.key(pygame.K_SPACE)
    driver.key(pygame.K_HOME)
    driver.key(pygame.K_ESCAPE)
    assert menu.chosen == "steel" and not driver.app.ui.has_sheet


def test_a_run_goes_on_while_a_menu_is_open_and_stands_under_a_page(driver):
    driver.click_widget(driver.panel.menu)
    before = driver.playback.session.tick
    driver.frames(20)
    assert driver.app.ui.has_sheet and driver.playback.session.tick > before
    driver.key(pygame.K_ESCAPE)
    driver.app.act("settings")
    before = driver.playback.session.tick
    driver.frames(20)
    assert driver.playback.session.tick == before


def test_the_chosen_material_stays_chosen_in_a_window_of_another_size(driver):
    driver.panel._choose_material("rubber")
    driver.app.display.window.size = (900, 620)
    driver.frames(2)
    assert driver.panel.menu.chosen == "rubber"
    driver.fill(driver.panel.form.fields["stiffness"][0], "0.5")
    assert coefficients(driver) == (0.3, 0.3, 0.5)


def test_all_springs_show_mixed_values_and_take_a_common_one(driver):
    panel = driver.panel
    panel.choose_material(None)
    driver.frames(1)
    assert panel.form.fields["stiffness"][0].text == "mixed" and panel.form.sliders["stiffness"].state.is_mixed
    driver.fill(panel.form.fields["stiffness"][0], "0.07")
    assert coefficients(driver)[0] == coefficients(driver)[2] == 0.07
    assert panel.form.fields["stiffness"][0].text == "0.07" and not panel.form.sliders["stiffness"].state.is_mixed


@pytest.mark.parametrize("typed", ["1.5", "-0.1", "nan", "inf", "soft", ""])
def test_a_typed_value_out_of_range_is_refused_with_a_line_and_the_old_one_stays(driver, typed):
    driver.panel._choose_material("steel")
    driver.frames()
    field = driver.panel.form.fields["stiffness"][0]
    driver.app.ui.focus_on(field)
    driver.key(pygame.K_DELETE)
    driver.fill(field, typed)
    driver.app.ui.blur()
    assert coefficients(driver)[0] == 0.3
    assert field.typed == "0.3"
    assert any(notice.startswith("Cs  stiffness: ") for notice in driver.notices)


def test_typing_hz_and_damping_ratio_sets_cs_and_cd_and_reads_back(driver):
    panel = driver.panel
    panel._choose_material("steel")
    driver.frames()
    driver.fill(driver.entry("frequency"), "3")
    driver.fill(driver.entry("ratio"), "0.2")
    assert (
        float(driver.entry("frequency").text),
        float(driver.entry("ratio").text),
    ) == pytest.approx((3.0, 0.2), rel=1e-3)
    assert coefficients(driver)[2] == 0.02


def test_a_frequency_out_of_reach_is_refused_with_the_highest_one(driver):
    panel = driver.panel
    panel._choose_material("steel")
    driver.frames()
    driver.fill(driver.entry("ratio"), "0.1")
    before = coefficients(driver)
    driver.fill(driver.entry("frequency"), "20")
    assert coefficients(driver) == before
    assert any("highest frequency" in notice for notice in driver.notices)


def test_cd_1_has_no_frequency_and_a_typed_frequency_leads_out_of_it(driver):
    panel = driver.panel
    panel._choose_material("steel")
    driver.fill(panel.form.fields["damping"][0], "1")
    assert driver.entry("frequency").text == driver.entry("ratio").text == "\u221e"
    driver.fill(driver.entry("frequency"), "2")
    assert (
        float(driver.entry("frequency").text),
        float(driver.entry("ratio").text),
    ) == pytest.approx((2.0, 1.0), rel=1e-3)


def test_the_single_pass_marks_its_limit_and_the_iterative_solver_says_that_there_is_none(driver):
    panel = driver.panel
    panel._choose_material("steel")
    driver.frames()
    assert 0.3 < panel.form.sliders["damping"].state.limit < 1.0
    assert "proven for a single pass" in panel.note.text
    driver.click_widget(panel.engineers.form.choices["solver"].buttons["iterative"])
    assert driver.world.settings.solver == "iterative"
    assert panel.form.sliders["damping"].state.limit is None
    assert "Nothing is proven" in panel.note.text


def test_a_hooke_material_cannot_be_tuned_by_cs_and_says_so(open_app):
    level = small_level(materials={"steel": {"law": "hooke", "k": 20.0, "c": 0.5}, "rubber": {}})
    driver = open_app(level)
    driver.take_sliders()
    panel = driver.panel
    panel._choose_material("steel")
    driver.frames()
    assert "k = 20 N/m" in panel.note.text and not panel.form.sliders["stiffness"].state.enabled
    driver.fill(panel.form.fields["stiffness"][0], "0.5")
    assert not logged(driver)


def test_substeps_iterations_warm_start_and_gravity_reach_the_world(driver):
    panel = driver.panel
    driver.click_widget(panel.engineers.form.choices["substeps"].buttons["8"])
    driver.fill(driver.entry("iterations"), "25")
    driver.fill(driver.entry("warm_start"), "0.75")
    driver.fill(driver.entry("gravity_y"), "-3.7")
    settings = driver.world.settings
    assert (settings.substeps, settings.iterations, settings.warm_start) == (8, 25, 0.75)
    assert settings.gravity == (0.0, -3.7)
    driver.click_widget(panel.engineers.form.choices["substeps"].buttons["auto"])
    settings = driver.world.settings
    assert settings.substeps == "auto"
    for field, typed in (
        (driver.entry("iterations"), "2.5"),
        (driver.entry("iterations"), "0"),
        (driver.entry("warm_start"), "2"),
        (driver.entry("gravity_x"), "1e9"),
    ):
        driver.fill(field, typed)
    assert driver.world.settings == settings
    assert len(driver.notices) == 4


def test_edits_show_while_the_run_is_paused(driver):
    driver.app.act("pause")
    driver.frames()
    tick = driver.playback.session.tick
    driver.fill(driver.panel.form.fields["damping"][0], "0.5")
    assert driver.playback.session.tick == tick
    assert driver.panel.form.fields["damping"][0].text == "0.5"


def test_arrow_keys_move_the_focused_slider_and_tab_reaches_every_widget(driver):
    ui, panel = driver.app.ui, driver.panel
    reached = []
    for _ in range(60):
        driver.key(pygame.K_TAB)
        reached.append(ui.focus)
    wanted = [
        panel.form.sliders["stiffness"],
        panel.form.sliders["damping"],
        panel.menu,
        driver.entry("frequency"),
        *panel.engineers.form.choices["substeps"].buttons.values(),
    ]
    assert all(widget in reached for widget in wanted)
    ui.focus_on(panel.form.sliders["damping"])
    before = driver.world.damping[0]
    driver.key(pygame.K_LEFT)
    after = driver.world.damping[0]
    assert after < before
    driver.key(pygame.K_RIGHT, pygame.KMOD_SHIFT)
    assert after < driver.world.damping[0] < before
    driver.key(pygame.K_HOME)
    assert driver.world.damping[0] == panel.form.sliders["damping"].state.scale.lowest
    driver.key(pygame.K_ESCAPE)
    assert ui.focus is None


@pytest.mark.parametrize("scale", [PLAIN, CoefficientScale(0.03, 0.1), CoefficientScale(0.001, 0.0003)])
def test_a_scale_maps_back_and_gives_what_is_near_1_room(scale):
    assert scale.place_of(0.0) == scale.place_of(scale.lowest) == 0.0 and scale.place_of(1.0) == 1.0
    for place in (0.0, 0.13, 0.5, 0.77, 0.9, 1.0):
        assert scale.place_of(scale.value_at(place)) == pytest.approx(place, abs=4e-3)
    assert scale.value_at(-1.0) == scale.lowest and scale.value_at(2.0) == 1.0
    assert 1.0 - scale.place_of(0.9) > 0.13
    assert [scale.place_of(value) for value in scale.values(7)] == pytest.approx(np.linspace(0, 1, 7).tolist())


def test_another_tick_rate_begins_the_run_anew_at_the_same_pace_or_with_the_same_coefficients(driver):
    for label, keeps_pace in (("Keep the behaviour per second", True), ("Keep Cs and Cd as they are", False)):
        before, rate = coefficients(driver), driver.world.settings.tick_rate
        hertz = frequency_from_coefficients(*before[:2], 1.0 / rate)[0]
        driver.fill(driver.entry("tick_rate"), str(2 * rate))
        assert driver.world.settings.tick_rate == rate and driver.app.ui.has_sheet
        driver.choose(label)
        driver.frames(2)
        assert driver.world.settings.tick_rate == 2 * rate and driver.world.tick < 20
        after = coefficients(driver)
        assert (frequency_from_coefficients(*after[:2], 0.5 / rate)[0] == pytest.approx(hertz, rel=1e-4)) == keeps_pace
        assert (after == before) != keeps_pace
        driver.take_sliders()


def test_a_run_at_another_tick_rate_has_the_solver_and_the_springs_that_were_set(driver):
    driver.fill(driver.panel.form.fields["stiffness"][0], "0.07")
    driver.click_widget(driver.panel.engineers.form.choices["solver"].buttons["iterative"])
    driver.fill(driver.entry("tick_rate"), "240")
    driver.choose("Keep Cs and Cd as they are")
    driver.frames(2)
    assert coefficients(driver)[0] == 0.07 and driver.world.settings.solver == "iterative"


@pytest.mark.parametrize("typed", ["fast", "0", "-60", "99999"])
def test_a_tick_rate_that_no_level_has_is_refused_with_a_line(driver, typed):
    driver.fill(driver.entry("tick_rate"), typed)
    if driver.app.ui.has_sheet:
        driver.choose("Keep the behaviour per second")
    assert driver.world.settings.tick_rate == 60 and driver.notices[-1].endswith(".")
    assert driver.entry("tick_rate").text == "60"
