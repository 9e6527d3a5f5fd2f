"""The font: it comes with its licence, all widgets use it, and other alphabets are shown by another one."""

import pygame
import pytest

from sandbox.app.widgets.fonts import FONTS_HELD, SafeFont, code_font, font_file, plain_font, runs


@pytest.fixture(autouse=True)
def fonts():
    pygame.font.init()


def test_the_font_is_shipped_with_its_licence():
    folder = font_file(False).parent
    assert font_file(True).is_file() and font_file(False).is_file()
    for name in ("OFL.txt", "OFL-NotoSans.txt"):
        assert "SIL Open Font License, Version 1.1" in (folder / name).read_text(encoding="utf-8")
    assert sum(path.stat().st_size for path in folder.iterdir()) < 1_400_000


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


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("rope", ["rope"]),
        ("\u05e9\u05dc\u05d5\u05dd", ["\u05e9\u05dc\u05d5\u05dd"]),
        ("a \u05d0\u05d1 b", ["a ", "\u05d0\u05d1", " b"]),
        ("\u05d0 12 \u05d1, c", [" \u05d1", "12", "\u05d0 ", ", c"]),
        ("\u0645\u064e 3", ["\u0645\u064e", " 3"]),
        ("\u05d0 b \u05d1", ["\u05d0", " b ", "\u05d1"]),
    ],
)
def test_right_to_left_letters_are_seen_last_first_and_numbers_among_them_are_not_turned(text, seen):
    found = runs(text)
    assert [run.text for run in found] == seen
    assert "".join(sorted(text)) == "".join(sorted("".join(seen)))
    for run in found:
        assert run.turned == any(char in "\u05e9\u05dc\u05d5\u05dd\u05d0\u05d1\u0645" for char in run.text)


@pytest.mark.parametrize(
    "other", ["\u05e9\u05dc\u05d5\u05dd", "\u65e5\u672c", "\U0001f600", "\u0939\u093f\u0928\u094d\u0926\u0940"]
)
def test_other_scripts_stand_beside_the_font_s_own_letters_at_their_height(other):
    font = plain_font(20, False)
    alone, mixed = font.size(other), font.size(f"Rope {other}")
    assert mixed[0] == alone[0] + font.size("Rope ")[0]
    assert mixed[1] <= 2 * font.size("Rope")[1]
    picture = font.render(f"Rope {other}", True, (255, 255, 255))
    assert picture.get_width() == mixed[0]
    place = pygame.Rect(font.size("Rope ")[0], 0, alone[0], picture.get_height())
    assert picture.subsurface(place).get_bounding_rect().width > 0
    assert len(font.metrics(f"Rope {other}")) == len(f"Rope {other}")


@pytest.mark.parametrize("bold", [False, True])
def test_zeros_have_a_stroke_in_code_alone(bold):
    def middle(font):
        zero = font.render("0", True, (255, 255, 255))
        place = pygame.mask.from_surface(zero).get_bounding_rects()[0]
        return zero.get_at(place.center).a

    assert middle(plain_font(60, bold)) == 0
    assert middle(code_font(60)) > 0
