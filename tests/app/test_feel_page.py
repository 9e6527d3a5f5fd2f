"""The card of a feel in the window: measured beside the run, dragged to what is wanted, used, undone, taken home."""

import re

import pygame
import pytest

from sandbox.app.draw.colours import show_theme
from sandbox.app.panel.feel.curve_page import FORMS, NAMES
from sandbox.app.panel.feel.feel_curve import FeelCurve
from sandbox.app.panel.feel.feel_page import FeelPage
from sandbox.app.panel.feel.feel_work import HINT, NO_HANDS
from sandbox.app.panel.take_home_page import CodeBlock
from sandbox.app.play.thing_menu import FEEL
from sandbox.app.widgets.texts import TextBlock
from sandbox.export.curves import TOOLS, curve_for
from sandbox.export.feel import feel_of
from sandbox.physics.snapshot import state_hash
from tests.app.conftest import small_level
from tests.app.test_room_for_texts import faults

# A weight on one spring, and what has classic springs.
HANGING = [
    {"type": "rope", "id": "weight", "start": [0, 0], "end": [0, -1], "segments": 1, "pin": ["start"],
     "material": "rubber"},
    {"type": "rope", "id": "classic", "start": [3, 0], "end": [3, -1], "segments": 1, "pin": ["start"],
     "material": "old"},
]  # fmt: skip
MATERIALS = {"rubber": {"stiffness": 0.05, "damping": 0.05}, "old": {"law": "hooke", "k": 100.0, "c": 2.0}}
SHIFT = pygame.KMOD_SHIFT


def level(**changes):
    settings = {"solver": "direct", "gravity": [0.0, -9.81]}
    return small_level(settings=settings, materials=MATERIALS, bodies=HANGING, **changes)


@pytest.fixture
def hanging(open_app):
    return open_app(level())


def only(driver, kind):
    (found,) = [widget for widget in driver.app.ui.walk(driver.app.ui.top_sheet) if isinstance(widget, kind)]
    return found


def texts(driver):
    sheet = driver.app.ui.top_sheet
    return [widget.text for widget in driver.app.ui.walk(sheet) if isinstance(widget, TextBlock) and widget.text]


def page(driver):
    return driver.app.ui._sheets[-1].close.__self__


def end_work(driver):
    for _ in range(200):
        driver.pass_unseen()
        if not driver.app.ui.moves:
            break
    driver.frames(2)
    assert not driver.app.ui.moves


def open_by_menu(driver, name="weight.1"):
    at = driver.pixel_of(name)
    driver.press(at, 3)
    driver.release(at, 3)
    menu = driver.app.ui.focus
    index = [row.text for row in menu.rows].index(FEEL)
    driver.click((menu.rect.left + 30, menu.rect.top + menu._tops[index] - menu._offset + 8))


def coefficients(driver):
    return driver.world.stiffness[0], driver.world.damping[0]


def test_from_the_menu_of_a_thing_it_is_measured_beside_a_run_that_stays_as_it_is(hanging):
    hanging.frames(60)
    hanging.playback.toggle_pause()
    before, tick = state_hash(hanging.world), hanging.playback.session.tick
    expected = feel_of(hanging.world, "weight")
    open_by_menu(hanging)
    end_work(hanging)
    said = texts(hanging)
    assert re.fullmatch(r"It is bouncy: overshoots by [\d.]+ %, still after [\d.]+ s\.", said[0])
    assert f"{expected.hz:.3g} Hz" in said and str(expected.numbers.swings) in said and HINT in said
    curve = only(hanging, FeelCurve)
    assert curve.state.wanted == (expected.numbers.overshoot, expected.numbers.settling)
    assert (state_hash(hanging.world), hanging.playback.session.tick) == (before, tick)
    hanging.choose("Close")
    hanging.playback.toggle_pause()
    hanging.frames(30)
    assert hanging.playback.session.tick > tick


def test_a_peak_that_is_dragged_finds_cs_and_cd_which_are_used_and_undone(hanging):
    open_by_menu(hanging)
    end_work(hanging)
    curve, own = only(hanging, FeelCurve), coefficients(hanging)
    x, y = curve.handles()["peak"]
    to = curve._axes.y_of(120.0)
    hanging.press((curve.rect.left + x, curve.rect.top + y))
    hanging.move((curve.rect.left + x, curve.rect.top + to))
    assert curve.state.wanted[0] == pytest.approx(0.2, abs=0.01)
    hanging.release((curve.rect.left + x, curve.rect.top + to))
    assert coefficients(hanging) == own
    end_work(hanging)
    asked = curve.state.wanted
    found = curve.state.found.numbers
    assert (found.overshoot, found.settling) == pytest.approx(asked, rel=0.03)
    assert texts(hanging)[-1].endswith('for the springs of "rubber": as asked.')
    hanging.choose("Use")
    assert "Ctrl+Z takes it back" in texts(hanging)[-1]
    hanging.choose("Close")
    hanging.frames(60)
    after = coefficients(hanging)
    assert after != own
    card = feel_of(hanging.world, "weight")
    assert (card.numbers.overshoot, card.numbers.settling) == pytest.approx(asked, rel=0.03)
    hanging.key(pygame.K_z, pygame.KMOD_CTRL)
    hanging.frames(2)
    assert coefficients(hanging) == own


def test_keys_alone_open_it_set_it_and_give_a_search_up(hanging):
    hanging.playback.toggle_pause()
    hanging.key(pygame.K_n)
    hanging.key(pygame.K_q, SHIFT)
    opened = page(hanging)
    assert isinstance(opened, FeelPage)
    end_work(hanging)
    before = opened.work.wanted
    hanging.app.ui.focus_on(opened.curve)
    # One frame of work: the search has begun, and not ended.
    opened.work.step = lambda: False
    hanging.key(pygame.K_DOWN)
    assert opened.work.wanted[0] == pytest.approx(before[0] - 0.02, abs=1e-3) and hanging.app.ui.moves
    hanging.key(pygame.K_ESCAPE)
    assert opened.work.wanted == before and "Cancelled." in texts(hanging)
    del opened.work.step
    hanging.fill(opened.fields["settling"], "0.5")
    end_work(hanging)
    assert opened.note.text == "No spring that swings so far settles before 0.521 s here."
    hanging.fill(opened.fields["overshoot"], "20 %")
    end_work(hanging)
    assert opened.work.found is not None, opened.note.text
    hanging.app.ui.blur()
    hanging.key(pygame.K_RETURN)
    assert opened.work.found is None and "Set: " in texts(hanging)[-1]
    hanging.key(pygame.K_ESCAPE)
    assert not hanging.app.ui.has_sheet


def test_bad_numbers_are_said_on_the_card_and_change_nothing(hanging):
    open_by_menu(hanging)
    opened = page(hanging)
    end_work(hanging)
    before = opened.work.wanted
    for name, text, said in (
        ("overshoot", "much", "Overshoot: 'much' is not a number."),
        ("overshoot", "120", "Overshoot: 120 is outside 0 to 99. The old value stays."),
        ("settling", "0.01", "Still after: 0.01 is outside 0.034 to 60. The old value stays."),
    ):
        hanging.fill(opened.fields[name], text)
        assert opened.note.text == said
        assert opened.work.wanted == before and not hanging.app.ui.moves


def test_what_cannot_be_set_is_measured_all_the_same_and_says_why(open_app):
    driver = open_app(level())
    open_by_menu(driver, "classic.1")
    opened = page(driver)
    end_work(driver)
    assert opened.work.feel is not None and not opened.fields["overshoot"].is_enabled
    assert opened.note.text == "Its springs are classic Hooke springs, which have no Cs and Cd."
    driver = open_app(level(version=4, hands={"may": ["grab"]}))
    open_by_menu(driver)
    opened = page(driver)
    end_work(driver)
    assert opened.note.text == NO_HANDS and not opened.curve.handles()


def test_the_panel_opens_it_and_tools_have_their_text_in_every_form_and_files(hanging, monkeypatch, tmp_path):
    copied = []
    monkeypatch.setattr("sandbox.app.panel.feel.curve_page.copy_text", lambda text: copied.append(text) or True)
    hanging.click_in_panel(hanging.panel.feel)
    opened = page(hanging)
    end_work(hanging)
    feel = opened.work.feel
    hanging.choose("Take it home")
    assert NAMES.keys() == TOOLS.keys()
    for tool in ("css", "godot", "swiftui"):
        hanging.choose(NAMES[tool])
        for form in TOOLS[tool]:
            if len(TOOLS[tool]) > 1:
                hanging.choose(FORMS[form])
            hanging.choose("Copy")
            about, text = curve_for(feel, tool, form)
            assert only(hanging, CodeBlock).text == copied.pop() == text
            assert f"{about[0].upper()}{about[1:]}." in texts(hanging)
    for words, suffix in (("Picture (.png)", "png"), ("Picture (.svg)", "svg"), ("Page that plays it (.html)", "html")):
        hanging.choose("Save ...")
        hanging.choose(words)
        (path,) = (tmp_path / "pictures").rglob(f"*.{suffix}")
        assert texts(hanging)[-1] == f"Saved as {path}" and path.stat().st_size > 1000
    hanging.choose("Back")
    assert only(hanging, FeelCurve)


@pytest.mark.parametrize(("size", "scale", "theme"), [((640, 480), 1.0, "light"), ((1280, 720), 1.5, "dark")])
def test_both_pages_have_room_for_their_texts(hanging, size, scale, theme):
    show_theme(theme)
    hanging.app.chosen.choose("scale", scale)
    hanging.app.display.window.size = size
    hanging.frames(2)
    open_by_menu(hanging)
    assert not faults(hanging)
    end_work(hanging)
    assert not faults(hanging)
    hanging.choose("Take it home")
    for tool in ("Unity", "SwiftUI"):
        hanging.choose(tool)
        assert not faults(hanging), tool
    show_theme("dark")
