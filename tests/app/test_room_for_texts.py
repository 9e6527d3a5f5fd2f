"""No text of a widget is cut and no widget lies over another, on the screens of the app, in windows of many sizes."""

from itertools import combinations

import pygame
import pytest

from sandbox.app.widgets.button import Button
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.styles import Plate
from sandbox.app.widgets.texts import Label, TextBlock, wrapped
from sandbox.editor.items import items_of
from tests.app.conftest import small_level
from tests.support.wholes import some_and_whole

# Sizes of windows [pixels], and scales.
WINDOWS = [((640, 480), 1.0), ((800, 600), 1.5), ((1280, 720), 1.0), ((1280, 720), 1.5), ((640, 480), 2.0)]


def show_panel(app):
    """Show the panel, also where there is little room."""
    if not app.play.show_panel:
        app.act("panel")


PLAYED = {
    "pad": lambda app: (show_panel(app), app.play._set_by("pad")),
    "sliders": lambda app: app.play._set_by("sliders"),
    "toy": lambda app: app.play.fold("more"),
    "engineers": lambda app: (app.play.fold("more"), app.play.fold("springs")),
    "world": lambda app: app.play.fold("engineers"),
    "everything": lambda app: [app.act(name) for name in ("graphs", "timeline", "palette")],
    "catalogue": lambda app: app.act("catalogue"),
    "compare": lambda app: app.act("compare"),
    "lesson": lambda app: app.start_lesson(),
    "more": lambda app: app.play.toolbar._show_menu() if app.play.toolbar.left_out else None,
    "settings": lambda app: app.act("settings"),
    "share": lambda app: app.act("share"),
    "help": lambda app: app.act("help"),
    "files": lambda app: app.act("open"),
    "gallery": lambda app: app.open_gallery("mine"),
}
PAGES = ("properties", "materials", "parts", "level", "checks", "history", "findings")


def texts_cut(ui):
    """Texts of widgets that are wider than these, or end in an ellipsis before all is said."""
    found = []
    for widget in shown(ui):
        if isinstance(widget, WordPicker):
            # Beside the mark that says that it opens.
            wide = widget.rect.width - ui.px(32)
            found += [text for text in widget.words if ui.font(12.5).size(text)[0] > wide]
        elif isinstance(widget, TextBlock):
            found += [widget.text] if is_shortened(ui, widget) else []
        elif isinstance(widget, (Button, Label)) and widget.text:
            found += [widget.text] if widget.font.size(widget.text)[0] > widget.rect.width else []
    return found


def is_shortened(ui, block):
    font, left = ui.font(block.text_size, block.is_bold), block.rect.height
    height = round(font.get_linesize() * 0.95)
    lines = 0
    for paragraph in block.text.split("\n"):
        most = max(1, (left - lines * height) // height)
        made = wrapped(paragraph, font, block.rect.width, most)
        if made[-1].endswith("…") and not paragraph.endswith("…"):
            return True
        lines += len(made)
    return False


def shown(ui):
    """What can be pressed, typed into or read, that is in sight."""
    found = []
    for widget in ui.walk():
        is_solid = not isinstance(widget, Plate) and widget.image is not None
        if is_solid and widget.visible and in_sight(widget, ui).size != (0, 0):
            found.append(widget)
    return found


def in_sight(widget, ui):
    """What of a widget its containers do not clip."""
    place, holder = widget.rect.copy(), widget.parent
    while holder is not None:
        place = place.clip(holder.rect)
        holder = holder.parent if holder is not ui.root else None
    return place


def overlaps(ui):
    """Pairs of widgets of one container of which one lies over the other."""
    homes = {}
    for widget in shown(ui):
        homes.setdefault(widget.parent, []).append(widget)
    return [
        (one, other)
        for own in homes.values()
        for one, other in combinations(own, 2)
        if filled(one).inflate(-2, -2).colliderect(filled(other).inflate(-2, -2))
    ]


def filled(widget):
    """Where a widget shows anything: labels may have more room than text."""
    place = widget.rect.copy()
    if isinstance(widget, (Label, TextBlock)):
        wide = place.width if widget.text else 0
        if isinstance(widget, Label):
            wide = min(wide, widget.font.size(widget.text or " ")[0])
            place.left += round((place.width - wide) * widget.style.side)
        place.width = wide
    return place


def outside(ui):
    """What is beyond the window, or cut by what holds it, unless it is scrolled."""
    window = pygame.Rect((0, 0), ui.size)
    return [widget for widget in shown(ui) if not window.contains(in_sight(widget, ui))]


def faults(driver):
    ui = driver.app.ui
    said = [f"cut: {text}" for text in texts_cut(ui)]
    said += [f"over each other: {name(one)}, {name(other)}" for one, other in overlaps(ui)]
    return said + [f"outside: {name(widget)}" for widget in outside(ui)]


def name(widget):
    return f"{type(widget).__name__} {getattr(widget, 'text', '')!r} {tuple(widget.rect)}"


@pytest.mark.parametrize(("size", "scale"), some_and_whole(WINDOWS[::3], WINDOWS))
def test_every_screen_of_a_run_has_room_for_all_its_texts(driver, size, scale, monkeypatch):
    monkeypatch.setattr("sandbox.app.base.desktop.platformdirs.user_pictures_dir", lambda: "/home/ann/Pictures")
    found = {}
    driver.app.chosen.choose("scale", scale)
    driver.app.display.window.size = size
    for screen, show in PLAYED.items():
        driver.frames(2)
        show(driver.app)
        driver.frames(2)
        said = faults(driver)
        if said:
            found[screen] = said
        while driver.app.ui.has_sheet:
            driver.app.ui._sheets[-1].close()
            driver.app.close_gallery()
    assert not found


@pytest.mark.parametrize(("size", "scale"), some_and_whole(WINDOWS[::3], WINDOWS))
def test_every_page_of_the_editor_has_room_for_all_its_texts(edit, size, scale):
    driver, found = edit(small_level()), {}
    driver.app.chosen.choose("scale", scale)
    driver.app.display.window.size = size
    driver.frames(2)
    if not driver.editor.show_side:
        driver.editor.toggle_side()
    for page in PAGES:
        driver.editor.side.choose(page)
        driver.frames(2)
        said = faults(driver)
        if said:
            found[page] = said
    driver.editor.select(frozenset([min(items_of(driver.editor.document.level))]))
    driver.editor.side.choose("properties")
    driver.app.act("menu")
    driver.frames(2)
    assert not (found | ({"menu": faults(driver)} if faults(driver) else {}))
