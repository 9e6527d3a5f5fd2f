"""Widgets: which of them gets the mouse and the keyboard, where they are, how boxes look, what is said of them."""

import pygame
import pytest

from sandbox.app.base.display import Display
from sandbox.app.draw.colours import TEXT, Tone
from sandbox.app.edit.bar import LEFT, RIGHT
from sandbox.app.play import time_bar
from sandbox.app.widgets import styles as plates
from sandbox.app.widgets.button import painted_icon
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.styles import BoxLook, box
from sandbox.app.widgets.ui import Ui
from sandbox.editor.tools.palette import TOOLS
from sandbox.level.format.shipped import shipped_folder
from sandbox.tools.dropping import PARTS
from sandbox.tools.play_tools import PLAY_TOOLS

PLACE = pygame.Rect(10, 10, 120, 34)
RED, BLUE = Tone((200, 0, 0), (200, 0, 0)), Tone((0, 0, 200), (0, 0, 200))


@pytest.fixture
def ui():
    opened = Display(1.0)
    yield Ui((400, 300), 1.0)
    opened.close()


def send(ui, kind, **data):
    return ui.process(pygame.event.Event(kind, **data))


def move(ui, at):
    return send(ui, pygame.MOUSEMOTION, pos=at, rel=(0, 0), buttons=(0, 0, 0))


def press(ui, at, button=1):
    move(ui, at)
    return send(ui, pygame.MOUSEBUTTONDOWN, pos=at, button=button)


def release(ui, at):
    return send(ui, pygame.MOUSEBUTTONUP, pos=at, button=1)


def test_a_button_acts_once_the_click_ends_on_it_and_not_if_it_ends_elsewhere(ui):
    done = []
    button = ui.button(PLACE, "Go", lambda: done.append(1))
    assert press(ui, PLACE.center) and button.state == "active" and not done
    assert release(ui, PLACE.center) and done == [1] and button.state == "hovered"
    press(ui, PLACE.center)
    move(ui, (300, 200))
    assert release(ui, (300, 200)) and done == [1] and button.state == "normal"
    button.is_enabled = False
    assert not press(ui, PLACE.center) and not release(ui, PLACE.center)
    assert done == [1] and button.state == "disabled"


def test_a_panel_lets_no_press_through_and_a_page_covers_what_lies_under_it(ui):
    done = []
    button = ui.button(PLACE, "Go", lambda: done.append(1))
    assert not press(ui, (300, 200), 3)
    ui.panel(pygame.Rect(200, 100, 200, 200))
    assert press(ui, (300, 200)) and release(ui, (300, 200)) and press(ui, (300, 200), 3)
    sheet = ui.open_sheet()
    assert press(ui, PLACE.center) and release(ui, PLACE.center) and not done and not button.hovered
    sheet.remove()
    press(ui, PLACE.center)
    release(ui, PLACE.center)
    assert done == [1] and button.hovered


def test_what_goes_while_it_is_pressed_is_not_asked_again(ui):
    ui.button(PLACE, "Go", lambda: None)
    panel = ui.panel(pygame.Rect(200, 100, 200, 200))
    ui.button(pygame.Rect(10, 10, 50, 30), "In", panel.remove, panel)
    at = 220, 120
    press(ui, at)
    release(ui, at)
    assert not panel.is_there and not send(ui, pygame.MOUSEBUTTONUP, pos=at, button=1)
    button = ui.button(PLACE, "Go", lambda: None)
    ui.focus_on(button)
    press(ui, PLACE.center)
    button.remove()
    assert ui.focus is ui.held is ui.under is None and not release(ui, PLACE.center)


def test_rectangles_are_kept_and_follow_what_holds_them(ui):
    panel = ui.panel(pygame.Rect(50, 50, 200, 100))
    button = ui.button(PLACE, "Go", lambda: None, panel)
    assert button.rect.topleft == (60, 60)
    panel.move_to((70, 40))
    assert button.rect.topleft == (80, 50) and button.place.topleft == (10, 10)
    panel.visible = False
    ui.draw(pygame.Surface(ui.size))
    assert not button.visible and ui.ring() == [] and not press(ui, button.rect.center)
    panel.visible = True
    panel.resize((60, 100))
    ui.draw(pygame.Surface(ui.size))
    assert button.seen == pygame.Rect(80, 50, 50, 34) and ui.ring() == [button]


def test_tab_goes_round_and_brings_what_has_the_keyboard_into_sight(ui):
    area = ScrollArea(ui, pygame.Rect(0, 0, 200, 100))
    buttons = [ui.button(pygame.Rect(5, 60 * row, 90, 30), str(row), lambda: None, area.content) for row in range(6)]
    area.set_height(400)
    for wanted in (area.bar, *buttons, area.bar):
        send(ui, pygame.KEYDOWN, key=pygame.K_TAB, mod=0, unicode="")
        ui.update(0.0)
        assert ui.focus is wanted and (wanted is area.bar or area.view.rect.contains(wanted.rect))
    send(ui, pygame.KEYDOWN, key=pygame.K_TAB, mod=pygame.KMOD_LSHIFT, unicode="")
    assert ui.focus is buttons[-1]


def test_a_tip_comes_after_a_while_and_goes_with_the_mouse(ui):
    button = ui.button(PLACE, "Go", lambda: None, tip="Goes <on> & on\nfor ever")
    pygame.mouse.set_pos(PLACE.center)
    move(ui, PLACE.center)
    ui.update(0.3)
    assert ui.tip.text == ""
    ui.update(0.4)
    bare, surface = pygame.Surface(ui.size), pygame.Surface(ui.size)
    ui.draw(surface)
    assert ui.tip.text == button.tip and not ui.tip.place.colliderect(button.rect)
    assert surface.subsurface(ui.tip.place).get_bounding_rect() and bare.get_at(ui.tip.place.center)[:3] == (0, 0, 0)
    move(ui, (300, 250))
    assert ui.tip.text == ""


@pytest.mark.parametrize("size", [(40, 24), (300, 40), (7, 7), (9, 200), (3, 2)])
@pytest.mark.parametrize("radius", [0, 6, 13])
def test_a_box_has_its_line_all_around_and_its_corners_are_clear(size, radius):
    picture = box(size, BoxLook(RED, BLUE, RED), radius, 1)
    assert picture.get_size() == size
    (wide, high), across = size, (size[0] // 2, size[1] // 2)
    for at in ((across[0], 0), (across[0], high - 1), (0, across[1]), (wide - 1, across[1])):
        assert picture.get_at(at).b > 100
    if min(size) > 4:
        assert picture.get_at(across) == pygame.Color(200, 0, 0)
    if radius and min(size) > 20:
        assert all(picture.get_at((x, y)).a < 60 for x in (0, wide - 1) for y in (0, high - 1))


def test_boxes_are_kept_in_so_many_bytes(monkeypatch):
    monkeypatch.setattr(plates, "_kept", plates.RecentPictures(2 * 4 * 20 * 10))
    first = box((20, 10), BoxLook(RED, BLUE, RED), 3, 1)
    assert box((20, 10), BoxLook(RED, BLUE, RED), 3, 1) is first
    for colour in (BLUE, TEXT):
        box((20, 10), BoxLook(colour, BLUE, RED), 3, 1)
    assert box((20, 10), BoxLook(RED, BLUE, RED), 3, 1) is not first


def test_a_picture_that_is_shown_later_looks_as_one_that_was_given_at_once(ui):
    button, fresh = (ui.button(PLACE, "", lambda: None, icon=icon) for icon in ("play", "stop"))
    assert pygame.image.tobytes(button.image, "RGBA") != pygame.image.tobytes(fresh.image, "RGBA")
    button.show_icon("stop")
    assert pygame.image.tobytes(button.image, "RGBA") == pygame.image.tobytes(fresh.image, "RGBA")


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_what_of_an_icon_is_half_transparent_is_half_the_button_it_lies_on(driver, theme):
    driver.app.chosen.choose("theme", theme)
    ui, icon = driver.app.ui, pygame.Surface((12, 12), pygame.SRCALPHA)
    icon.fill((200, 100, 50, 128))
    bare, shown = (ui.button(pygame.Rect(4, 4, 34, 34), "", lambda: None, icon=each) for each in ("", icon))
    below, mixed = bare.image.get_at((17, 17)), shown.image.get_at((17, 17))
    assert all(abs(2 * mixed[k] - below[k] - icon.get_at((0, 0))[k]) <= 6 for k in range(3))


def test_a_text_that_has_no_room_ends_in_an_ellipsis_and_never_leaves_its_widget(ui):
    for scale in (0.5, 1.0, 2.0):
        own = Ui((400, 300), scale)
        label = own.label(own.rect(0, 0, 60, 20), "A text of many words")
        button = own.button(own.rect(0, 40, 60, 20), "A text of many words", lambda: None)
        for widget in (label, button):
            assert widget.image.get_size() == widget.rect.size
            assert widget.font.size(widget.text)[0] > widget.rect.width


def test_an_icon_is_the_file_of_its_name_in_any_size_and_colour_and_without_one_a_letter(ui):
    for size in (12, 20, 41):
        icon = painted_icon("play", size, (10, 200, 30))
        assert icon.get_size() == (size, size) and icon.get_at((size // 2, size // 2)) == (10, 200, 30, 255)
        assert icon.get_at((0, 0)).a == 0 and painted_icon("play", size, (10, 200, 30)) is icon
    letters = [painted_icon(name, 24, (10, 200, 30)) for name in ("lift", "loft", "mast")]
    first, same, other = (pygame.image.tobytes(each, "RGBA") for each in letters)
    assert first == same != other and letters[0].get_bounding_rect().width > 4


def test_every_tool_and_every_button_of_the_bars_has_its_icon():
    wanted = {*TOOLS, *(name for group in (*LEFT, RIGHT) for _, name in group), "settings", "more", "part"}
    wanted |= {picture for _, picture in (*time_bar.LEFT, *time_bar.RIGHT)} | {"pause", "stop", "muted", "play"}
    wanted |= {name for name, tool in PLAY_TOOLS.items() if name not in PARTS}
    folder = shipped_folder("assets") / "icons"
    assert not [name for name in wanted if not (folder / f"{name}.svg").is_file()]
