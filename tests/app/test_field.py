"""A line to type into: what keys, the mouse and an input method do in it, at every scale."""

import pygame
import pytest

from sandbox.app.base.display import Display
from sandbox.app.widgets.ui import Ui

CTRL, SHIFT = pygame.KMOD_LCTRL, pygame.KMOD_LSHIFT


class Person:
    """Somebody at a window with two lines to type into; taken: what was taken of the first."""

    def __init__(self, text="", scale=1.0):
        self.ui = Ui((round(400 * scale), round(200 * scale)), scale)
        self.taken = []
        self.field = self.ui.field(self.ui.rect(20, 20, 120, 30), text, self._take, hint="a name")
        self.other = self.ui.field(self.ui.rect(20, 70, 120, 30), "", lambda _: True)
        self.surface = pygame.Surface(self.ui.size)

    def _take(self, text):
        self.taken.append(text)
        return "!" not in text

    def send(self, kind, **data):
        used = self.ui.process(pygame.event.Event(kind, **data))
        self.ui.draw(self.surface)
        return used

    def key(self, key, mod=0):
        return self.send(pygame.KEYDOWN, key=key, mod=mod, unicode="")

    def type(self, text):
        for letter in text:
            self.send(pygame.TEXTINPUT, text=letter)

    def press(self, at):
        self.send(pygame.MOUSEMOTION, pos=at, rel=(0, 0), buttons=(0, 0, 0))
        self.send(pygame.MOUSEBUTTONDOWN, pos=at, button=1)

    def release(self, at):
        self.send(pygame.MOUSEBUTTONUP, pos=at, button=1)

    def click(self, at):
        self.press(at)
        self.release(at)

    def x_of(self, place):
        """The column of the window where a place in the text is."""
        return next(x for x in range(self.field.rect.left, self.field.rect.right) if self.field._place_at(x) == place)


@pytest.fixture(autouse=True)
def display():
    opened = Display(1.0)
    yield opened
    opened.close()


@pytest.mark.parametrize("scale", [0.5, 1.0, 1.5, 2.0])
def test_what_is_typed_is_taken_by_enter_and_a_refused_text_brings_the_old_one_back(scale):
    person = Person("old", scale)
    person.click(person.field.rect.center)
    person.key(pygame.K_a, CTRL)
    person.type("new")
    person.key(pygame.K_RETURN)
    assert person.taken == ["new"] and person.field.text == "new" and person.ui.focus is None
    person.ui.focus_on(person.field)
    person.type("bad!")
    person.key(pygame.K_RETURN)
    assert person.taken[-1] == "bad!" and person.field.typed == person.field.text == "new"
    # Tab goes on from the line that Enter left.
    person.key(pygame.K_TAB)
    assert person.ui.focus is person.other


def test_escape_brings_the_old_text_back_and_a_click_elsewhere_takes_what_was_typed():
    person = Person("old")
    person.ui.focus_on(person.field)
    person.type("x")
    person.key(pygame.K_ESCAPE)
    assert person.field.typed == "old" and not person.taken and not person.ui.typing
    person.ui.focus_on(person.field)
    person.type("x")
    person.click((300, 150))
    assert person.taken == ["x"] and not person.ui.typing


def test_letters_that_an_input_method_composes_are_shown_and_count_once_they_are_settled():
    person = Person("ab")
    person.ui.focus_on(person.field)
    person.key(pygame.K_HOME)
    person.key(pygame.K_RIGHT)
    person.send(pygame.MOUSEMOTION, pos=(300, 150), rel=(0, 0), buttons=(0, 0, 0))
    before = pygame.image.tobytes(person.surface, "RGB")
    assert person.send(pygame.TEXTEDITING, text="にほ", start=0, length=2)
    assert person.field.composed == "にほ" and person.field.typed == "ab"
    assert pygame.image.tobytes(person.surface, "RGB") != before
    # Until then keys are the input method's, Enter too.
    assert person.key(pygame.K_RETURN) and person.ui.typing
    person.send(pygame.TEXTINPUT, text="日本")
    assert person.field.typed == "a日本b" and person.field.composed == ""
    person.send(pygame.TEXTEDITING, text="に", start=0, length=1)
    person.send(pygame.TEXTEDITING, text="", start=0, length=0)
    assert person.field.typed == "a日本b" and person.field.composed == ""
    assert not Person().send(pygame.TEXTEDITING, text="に", start=0, length=1)


def test_ctrl_z_takes_back_and_ctrl_y_and_shift_bring_it_again():
    person = Person("one")
    person.ui.focus_on(person.field)
    person.key(pygame.K_END)
    person.type(" two")
    person.key(pygame.K_BACKSPACE, CTRL)
    assert person.field.typed == "one "
    person.key(pygame.K_z, CTRL)
    assert person.field.typed == "one two"
    person.key(pygame.K_z, CTRL)
    assert person.field.typed == "one"
    person.key(pygame.K_z, CTRL)
    assert person.field.typed == "one"
    person.key(pygame.K_y, CTRL)
    person.key(pygame.K_z, CTRL | SHIFT)
    assert person.field.typed == "one "
    person.type("x")
    person.key(pygame.K_y, CTRL)
    assert person.field.typed == "one x"
    # What replaced a selection goes as a whole.
    person.key(pygame.K_a, CTRL)
    person.type("all else")
    person.key(pygame.K_z, CTRL)
    assert person.field.typed == "one x" and person.field.selected == (0, 5)


def test_keys_move_by_letters_and_words_and_select_with_shift():
    person = Person("ab cd, ef")
    person.ui.focus_on(person.field)
    assert person.field.selected == (0, 9)
    person.key(pygame.K_RIGHT)
    assert person.field.selected == (9, 9)
    person.key(pygame.K_LEFT, CTRL)
    assert person.field.selected == (7, 7)
    person.key(pygame.K_LEFT, CTRL | SHIFT)
    assert person.field.selected == (3, 7)
    person.key(pygame.K_LEFT)
    assert person.field.selected == (3, 3)
    person.key(pygame.K_END, SHIFT)
    person.key(pygame.K_DELETE)
    assert person.field.typed == "ab "
    person.key(pygame.K_HOME)
    person.key(pygame.K_RIGHT, CTRL)
    assert person.field.selected == (2, 2)
    person.key(pygame.K_DELETE)
    assert person.field.typed == "ab"


def test_what_is_selected_is_copied_cut_and_pasted(monkeypatch):
    board = []
    monkeypatch.setattr("sandbox.app.widgets.field.copy_text", board.append)
    monkeypatch.setattr("sandbox.app.widgets.field.copied_text", lambda: board[-1])
    person = Person("left right")
    person.ui.focus_on(person.field)
    person.key(pygame.K_HOME)
    person.key(pygame.K_c, CTRL)
    assert not board
    person.key(pygame.K_RIGHT, CTRL | SHIFT)
    person.key(pygame.K_x, CTRL)
    assert board == ["left"] and person.field.typed == " right"
    person.key(pygame.K_END)
    board.append(" two\r\nlines\0\tof\u3000words\n")
    person.key(pygame.K_v, CTRL)
    assert person.field.typed == " right two lines of words"
    board.append("x" * 500)
    person.key(pygame.K_v, CTRL)
    assert len(person.field.typed) == 200


def test_a_double_click_selects_a_word_a_third_all_and_a_drag_what_it_passes():
    person = Person("left right")
    at = person.x_of(7), person.field.rect.centery
    person.click(at)
    assert person.field.selected == (7, 7)
    person.click(at)
    assert person.field.selected == (5, 10)
    person.click(at)
    assert person.field.selected == (0, 10)
    person.ui.blur()
    person.press((person.x_of(2), at[1]))
    person.send(pygame.MOUSEMOTION, pos=(person.x_of(6), at[1]), rel=(0, 0), buttons=(1, 0, 0))
    # Beyond its end, too.
    assert person.field.selected == (2, 6)
    person.send(pygame.MOUSEMOTION, pos=(399, 0), rel=(0, 0), buttons=(1, 0, 0))
    person.release((399, 0))
    assert person.field.selected == (2, 10)


def test_the_first_click_on_a_number_selects_it_and_the_next_places_the_caret():
    person = Person("12.5")
    person.click(person.field.rect.center)
    assert person.field.selected == (0, 4)
    person.ui._clicks = (-1_000, (0, 0), 0)
    person.click((person.x_of(2), person.field.rect.centery))
    assert person.field.selected == (2, 2)


def test_the_caret_is_seen_however_long_the_text_is_and_it_blinks():
    person = Person()
    person.ui.focus_on(person.field)
    person.type("a long text that has no room at all, whose end is far to the right")
    inside = person.field.rect.inflate(-2 * person.ui.px(9), 0)
    at = person.field._x_of(len(person.field.typed)) - person.field._scrolled
    assert 0 < at < inside.width
    lit = pygame.image.tobytes(person.surface, "RGB")
    person.ui.update(0.6)
    person.ui.draw(person.surface)
    assert pygame.image.tobytes(person.surface, "RGB") != lit
    person.key(pygame.K_HOME)
    assert person.field._scrolled == 0


def test_up_and_down_and_the_wheel_step_a_number_and_take_what_was_typed_first():
    person, steps = Person("5"), []
    person.field.step_value = steps.append
    person.ui.focus_on(person.field)
    person.type("7")
    person.key(pygame.K_UP)
    person.key(pygame.K_DOWN)
    person.send(pygame.MOUSEMOTION, pos=person.field.rect.center, rel=(0, 0), buttons=(0, 0, 0))
    person.send(pygame.MOUSEWHEEL, x=0, y=1, precise_y=1.0)
    assert person.taken == ["7"] and steps == [1, -1, 1]


def test_letters_are_no_keys_of_the_line_and_other_keys_with_ctrl_are_the_window_s():
    person = Person("a")
    person.ui.focus_on(person.field)
    assert not person.key(pygame.K_s) and not person.key(pygame.K_s, CTRL)
    assert person.field.typed == "a"
