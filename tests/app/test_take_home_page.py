"""Take home: which engine, and then the lines to paste there with the numbers of a jelly that feels right."""

import pygame
import pytest

from sandbox.app.panel.take_home_page import ALL, ENGINES, LANGUAGES, QUESTION, TARGETS, CodeBlock, _broken
from sandbox.app.widgets.fonts import code_font
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.rows import RowList
from sandbox.app.widgets.texts import TextBlock
from sandbox.level.reading.files import load_level
from tests.app.test_room_for_texts import faults

WINDOWS = [((640, 480), 1.0), ((1280, 720), 1.0), ((1280, 720), 1.5)]


@pytest.fixture
def page(open_app):
    driver = open_app(load_level("jelly_pile"))
    driver.app.display.window.size = (1280, 860)
    driver.frames(2)
    driver.panel.choose_body("cube 1")
    driver.click_widget(driver.panel.play.take_home)
    driver.frames(2)
    return driver


@pytest.fixture
def clipboard(monkeypatch):
    copied = []
    monkeypatch.setattr("sandbox.app.panel.take_home_page.copy_text", lambda text: copied.append(text) or True)
    return copied


def blocks(driver, kind):
    sprites = driver.app.ui.walk()
    return [each.text for each in sprites if isinstance(each, kind) and each.parent is not driver.panel.area.content]


def shown(driver):
    return max(blocks(driver, TextBlock), key=len)


def test_it_asks_for_the_engine_first_and_shows_no_numbers_yet(page):
    assert QUESTION in blocks(page, TextBlock) and not blocks(page, CodeBlock)
    assert {button.text for button in page.app.ui.buttons()} >= set(TARGETS)
    page.choose("Unity 2D")
    (code,) = blocks(page, CodeBlock)
    assert "joint.frequency = 9.55f;" in code and "joint.dampingRatio = 0.25f;" in code
    page.choose("Another engine")
    assert QUESTION in blocks(page, TextBlock)


def test_every_target_has_lines_that_are_copied_as_they_stand(page, clipboard):
    for target in TARGETS:
        page.choose(target)
        page.key(pygame.K_RETURN)
        assert any("clipboard" in notice for notice in page.notices)
        code, copied = blocks(page, CodeBlock), clipboard.pop()
        if target == ALL:
            assert copied == shown(page) and all(name in copied for name in ("Box2D", "Godot", "single pass"))
        else:
            # What is said below is not the code again.
            assert [copied] == code and copied not in shown(page), target
            assert shown(page).startswith('"cube 1" of "Jelly pile": 72 springs of jelly.'), target
        if target in LANGUAGES:
            assert any(line.startswith(("    ", "\t", "  ")) for line in copied.splitlines()), target
            assert "What it prints" in shown(page), target
        page.choose("Another engine")


def test_the_body_can_be_another_one_on_either_page(page):
    for target in (None, "Godot"):
        if target is not None:
            page.choose(target)
        (menu,) = [widget for widget in page.app.ui.ring() if isinstance(widget, WordPicker)]
        page.click_widget(menu)
        (listed,) = [widget for widget in page.app.ui.ring() if isinstance(widget, RowList)]
        page.app.ui.focus_on(listed)
        for _ in range(menu.words.index("plank 7") - menu.words.index(menu.chosen)):
            page.key(pygame.K_DOWN)
        page.key(pygame.K_RETURN)
        page.frames(2)
    assert shown(page).startswith('"plank 7"') and "joint.stiffness" in blocks(page, CodeBlock)[0]


def test_it_says_what_the_springs_are_now(page):
    page.key(pygame.K_ESCAPE)
    page.frames(1)
    page.fill(page.panel.form.fields["stiffness"][0], "0.05")
    page.fill(page.panel.form.fields["damping"][0], "0.07")
    page.click_widget(page.panel.play.take_home)
    page.frames(2)
    page.choose("Python")
    assert "Here: Cs 0.05, Cd 0.07 in a tick of 1/60 s" in shown(page)
    assert "the level's own numbers are inside" in shown(page)


def test_code_is_of_one_width_and_long_lines_go_on_moved_in(page):
    font = code_font(13)
    widths = [font.size(40 * letter)[0] for letter in "iW{.0 "]
    assert max(widths) - min(widths) <= 2
    line = "    total = first + second + third"
    assert _broken(line, 20) == ["    total = first +", "        second +", "        third"]
    assert "".join(_broken("x" * 50, 20)).replace(" ", "") == "x" * 50


@pytest.mark.parametrize(("size", "scale"), WINDOWS)
def test_each_page_has_room_for_its_texts_in_every_window(page, size, scale):
    page.app.chosen.choose("scale", scale)
    page.app.display.window.size = size
    page.frames(2)
    assert not faults(page)
    for target in (next(iter(ENGINES)), "Python", ALL):
        page.choose(target)
        assert not faults(page), target
        page.choose("Another engine")
