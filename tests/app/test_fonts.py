"""The font: it comes with its licence, all widgets use it, and other alphabets are shown by another one."""

import json

import pygame
import pytest

from sandbox.app.widgets.fonts import FONT, FONTS_HELD, SafeFont, font_file, plain_font
from sandbox.app.widgets.theme import scaled_theme
from sandbox.level.format.shipped import shipped_folder


@pytest.fixture(autouse=True)
def fonts():
    pygame.font.init()


def test_the_font_is_shipped_with_its_licence():
    folder = font_file(False).parent
    assert font_file(True).is_file() and font_file(False).is_file()
    assert "SIL Open Font License, Version 1.1" in (folder / "OFL.txt").read_text(encoding="utf-8")
    assert sum(path.stat().st_size for path in folder.iterdir()) < 150_000


def test_every_widget_is_written_in_it_at_every_scale():
    for scale in (1.0, 1.5, 2.0):
        fonts = {name: block["font"] for name, block in scaled_theme(scale).items() if "font" in block}
        # The arrow of a menu is a sign, not a text, and as large as its text.
        assert fonts.pop("drop_down_menu.#expand_button")["size"] == str(round(14 * scale))
        assert fonts and {font["name"] for font in fonts.values()} == {FONT}
    assert "noto" not in json.dumps(json.loads((shipped_folder("assets") / "theme.json").read_text(encoding="utf-8")))


def test_widgets_are_painted_by_it(driver):
    label = driver.app.ui.label(pygame.Rect(0, 0, 200, 20), "Iterative 10")
    own = plain_font(13, False).size("Iterative 10")
    assert label.font.size("Iterative 10")[0] == own[0]


@pytest.mark.parametrize("bold", [False, True])
def test_letters_that_it_lacks_are_drawn_by_another_and_not_as_boxes(bold):
    font = SafeFont(str(font_file(bold)), 16)

    def picture(text):
        return pygame.image.tobytes(font.render(text, True, (255, 255, 255)), "RGBA")

    boxes = [picture(text) for text in ("П", "ж", "→")]
    assert len(set(boxes)) == 3
    assert font.size("Привет")[0] > 0 and len(font.metrics("Привет")) == 6
    plain = pygame.font.Font(str(font_file(bold)), 16)
    assert font.size("Level 3: 50 %")[0] == plain.size("Level 3: 50 %")[0]


@pytest.mark.parametrize("text", ["\ud800", "\0", "a\0b", "", "\u0301", None])
def test_no_text_is_an_error(text):
    font = SafeFont(str(font_file(False)), 12)
    font.render(text, True, (255, 255, 255))
    assert font.size("" if text is None else text)[1] > 0


def test_fonts_are_held_for_the_sizes_used_last(open_app):
    open_app()
    first = plain_font(11, False)
    assert plain_font(11, False) is first
    for size in range(12, 12 + FONTS_HELD):
        plain_font(size, False)
    assert plain_font(11, False) is not first


def test_marks_that_turn_the_order_of_text_are_not_drawn():
    font = plain_font(14, False)
    assert font.size("ab\u202ecd\u2066e") == font.size("abcde")
