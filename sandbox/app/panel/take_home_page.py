"""The page of what a body takes home: its numbers for another loop or engine, as text to be read and copied."""

from collections.abc import Callable

import pygame

from sandbox.app.base.desktop import copy_text
from sandbox.app.draw.colours import TEXT
from sandbox.app.widgets.painted import TextBlock, line_height, wrapped
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.ui import Ui
from sandbox.export.chosen_body import NoSuchBody, body_names
from sandbox.export.take_home_text import take_home_text
from sandbox.physics.world import World

# What it can be for, by what a person calls it.
TARGETS = {
    "All numbers": "all", "Python": "python", "C#": "csharp", "GDScript": "gdscript", "C++": "cpp",
    "JavaScript": "javascript", "Box2D": "box2d", "Unity 2D": "unity", "Godot": "godot", "Rapier": "rapier",
    "pymunk": "pymunk", "Chipmunk": "chipmunk",
}  # fmt: skip
# Sizes in layout units.
WIDTH, HEIGHT, MARGIN, ROW, TEXT_SIZE = 760.0, 620.0, 28.0, 32.0, 13.0


def show_take_home(
    ui: Ui, world: World, say: Callable[[str], None], body: str | None = None, target: str = "All numbers"
) -> None:
    """Cover the window by what a body (None: the first) takes home, for one of TARGETS, until it is closed."""
    names = body_names(world)
    if not names:
        say("This level has no springs to take home.")
        return
    body = body if body in names else names[0]
    try:
        text = take_home_text(world, body, TARGETS[target])
    except NoSuchBody as error:
        say(f"{error}.")
        return
    width, height = min(WIDTH, ui.units[0] - 16), min(HEIGHT, ui.units[1] - 16)

    def close() -> None:
        ui.close_sheet(sheet)

    def other(new_body: str | None = None, new_target: str | None = None) -> None:
        close()
        show_take_home(ui, world, say, new_body or body, new_target or target)

    def copy() -> None:
        say("It is on the clipboard." if copy_text(text) else "The clipboard is not available here.")

    sheet = ui.open_sheet(close, is_page=True, again=lambda there: show_take_home(there, world, say, body, target))
    box = ui.panel(ui.rect((ui.units[0] - width) / 2, (ui.units[1] - height) / 2, width, height), sheet, "@dialog")
    ui.label(ui.rect(MARGIN, 18, 160, 28), "Take it home", box, "@title")
    copied = ui.button(ui.rect(width - MARGIN - 204, 16, 100, ROW), "Copy", copy, box, style="@primary")
    ui.button(ui.rect(width - MARGIN - 90, 16, 90, ROW), "Close", close, box)
    half = (width - 2 * MARGIN - 12) / 2
    ui.menu(ui.rect(MARGIN, 60, half, ROW), names, body, lambda name: other(new_body=name), box)
    place = ui.rect(MARGIN + half + 12, 60, half, ROW)
    ui.menu(place, list(TARGETS), target, lambda name: other(new_target=name), box)
    area = ScrollArea(ui, ui.rect(MARGIN, 106, width - 2 * MARGIN + 12, height - 106 - 16), box)
    _write(ui, area, text)
    ui.focus_on(copied)


def _write(ui: Ui, area: ScrollArea, text: str) -> None:
    font, wide = ui.font(TEXT_SIZE), area.view.rect.width
    lines = [line for paragraph in text.split("\n") for line in wrapped(paragraph, font, wide, 99) or [""]]
    tall = len(lines) * line_height(font)
    area.set_height(tall)
    TextBlock(ui, pygame.Rect(0, 0, wide, tall), "\n".join(lines), area.content, TEXT_SIZE, TEXT)
