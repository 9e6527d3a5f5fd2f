"""The pad: Cs and Cd by one point on a map of what theory says of them, and the curve of one spring beside it."""

import numpy as np
import pygame
import pytest

from sandbox.physics.analysis.stability import coefficient_zones
from sandbox.physics.equation import frequency_from_coefficients, spring_impulse
from sandbox.physics.softness.body_motion import errors_of, motion_of, swings_back
from sandbox.session.commands import SetCoefficients
from sandbox.session.session import Session
from tests.app.conftest import small_level


@pytest.fixture
def padded(open_app):
    """The app on the small level, with the pad in the panel."""
    driver = open_app(small_level())
    driver.click_widget(driver.panel.ways.buttons["pad"])
    driver.frames(2)
    return driver


def pair(driver, name="rope:0"):
    slot = driver.world.spring_slot(name)
    return float(driver.world.stiffness[slot]), float(driver.world.damping[slot])


def test_the_curve_tells_springs_that_differ_from_none_at_all(padded, open_app):
    curve = padded.panel.engineers.curve
    assert curve.words == ""
    padded.panel.choose_material(None)
    padded.frames(2)
    assert "differ" in curve.words
    bare = open_app(small_level(bodies=[], particles=[{"id": "ball", "position": [0, 0]}]))
    bare.click_widget(bare.panel.ways.buttons["pad"])
    bare.frames(2)
    assert "no spring" in bare.panel.engineers.curve.words and bare.panel.note.text == "There are no springs."


def test_a_drag_over_the_pad_sets_both_in_one_gesture_that_is_undone_at_once(padded):
    pad = padded.panel.pad
    padded.press(pad.pixel_of(0.01, 0.01))
    for value in (0.02, 0.05, 0.1):
        padded.move(pad.pixel_of(value, 2 * value))
    padded.release(pad.pixel_of(0.1, 0.2))
    assert pair(padded) == pytest.approx((0.1, 0.2), rel=0.05)
    assert pair(padded, "pair:0") == (0.02, 0.1)
    entries = [each for each in padded.playback.session.history.log if isinstance(each.command, SetCoefficients)]
    assert len(entries) >= 4 and len({each.gesture for each in entries}) == 1
    padded.key(pygame.K_z, pygame.KMOD_CTRL)
    assert pair(padded) == (0.3, 0.3)


def test_arrow_keys_move_the_focused_pad_along_one_axis_alone(padded):
    padded.app.ui.focus_on(padded.panel.pad)
    padded.key(pygame.K_UP)
    stiffness, damping = pair(padded)
    assert stiffness == 0.3 and damping > 0.3
    padded.key(pygame.K_LEFT, pygame.KMOD_SHIFT)
    assert 0.25 < pair(padded)[0] < 0.3 and pair(padded)[1] == damping
    padded.key(pygame.K_HOME)
    assert pair(padded) == (padded.panel.pad.state.scale.lowest, damping)


def test_numbers_hz_and_pad_show_the_same_pair(padded):
    panel = padded.panel
    padded.fill(padded.entry("frequency"), "3")
    padded.fill(padded.entry("ratio"), "0.5")
    assert (panel.pad.state.stiffness, panel.pad.state.damping) == pair(padded)
    assert frequency_from_coefficients(*pair(padded), 1 / 60) == pytest.approx((3.0, 0.5))
    panel.choose_material(None)
    padded.frames(1)
    assert panel.pad.state.is_mixed and panel.form.fields["stiffness"][0].text == "mixed"


def test_the_knob_tells_what_is_proven_of_where_it_stands(padded):
    panel = padded.panel
    for typed in ("0.3", "0.99"):
        padded.fill(panel.form.fields["stiffness"][0], typed)
        padded.fill(panel.form.fields["damping"][0], typed)
    beyond = panel.pad._knob_colour()
    padded.fill(panel.form.fields["damping"][0], "0.01")
    assert panel.pad._knob_colour() is not beyond


def test_the_pad_is_whole_in_the_smallest_window_and_the_world_folds(padded):
    padded.app.display.window.size = (640, 480)
    padded.frames(2)
    if padded.panel is None:
        padded.app.act("panel")
        padded.frames(2)
    panel = padded.panel
    assert panel.is_open("engineers") and panel.engineers.form.choices["solver"].buttons["direct"].visible
    padded.app.ui.focus_on(panel.pad)
    padded.frames(2)
    assert panel.area.view.rect.contains(panel.pad.rect)
    padded.app.play.fold("engineers")
    padded.frames(2)
    assert not padded.panel.engineers.form.choices["solver"].buttons["direct"].visible


def test_who_chose_the_pad_finds_it_in_the_next_run(padded):
    padded.app.start(type(padded.playback)(small_level()))
    padded.frames(2)
    assert padded.panel.by_pad
    padded.click_widget(padded.panel.ways.buttons["sliders"])
    assert not padded.panel.by_pad and padded.panel.pad is None


def test_the_article_s_limit_lies_in_what_is_proven_and_that_in_what_is_estimated(padded):
    zones = coefficient_zones(padded.world, None, np.array([1e-4, 0.1, 0.3]))
    assert zones.most_springs == 2 and zones.holds and not zones.bounded
    assert zones.article == pytest.approx([1 / 3] * 3, abs=1e-5)
    assert np.all(zones.article <= zones.proven) and np.all(zones.proven <= zones.estimated)


def test_with_substeps_a_tick_may_have_more_and_the_direct_solver_bounds_everything():
    def zones(**settings):
        return coefficient_zones(Session(small_level(settings=settings)).world, None, np.array([0.3]))

    plain, fine = zones(solver="single_pass"), zones(solver="single_pass", substeps=4)
    assert fine.article[0] > plain.article[0]
    bounded = zones(solver="direct")
    assert bounded.bounded and bounded.proven is None
    assert not zones(solver="iterative").holds


def test_a_spring_swings_just_where_its_errors_change_sign():
    for stiffness in (0.001, 0.05, 0.3, 0.9):
        for damping in (0.01, 0.2, 0.6, 0.95, 1.0):
            swings = bool(swings_back(np.array(stiffness), np.array(damping)))
            assert swings == bool(errors_of(stiffness, damping, 4000).min() < -1e-12), (stiffness, damping)


@pytest.mark.parametrize("stiffness", [1e-5, 0.001, 0.1, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("damping", [0.01, 0.3, 0.9, 0.99, 1.0])
def test_what_is_said_of_a_spring_is_what_a_run_of_it_does(stiffness, damping):
    error, speed, errors = 1.0, 0.0, [1.0]
    for _ in range(60_000):
        speed += spring_impulse(stiffness, damping, error, speed, 1.0, 1.0)
        error += speed
        errors.append(error)
    errors = np.array(errors)
    assert errors_of(stiffness, damping, 200) == pytest.approx(errors[:201], abs=1e-9)
    motion = motion_of(stiffness, damping, 0.5)
    for share, said in ((0.5, motion.half), (0.02, motion.rest)):
        above = np.flatnonzero(np.abs(errors) > share)[-1] + 1
        assert said == 0.5 * above if above < 60_000 else said > 29_000.0
    assert motion.swings == bool(errors.min() < -1e-9)
