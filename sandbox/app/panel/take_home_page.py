"""The page of what a body takes home: it asks which engine, and shows what to paste there, all else below it."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.base.desktop import copy_text
from sandbox.app.draw.colours import FIELD, LINE, MUTED, TEXT
from sandbox.app.widgets.dialogs import AROUND, MARGIN, Dialog
from sandbox.app.widgets.fonts import code_font
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.scroll import BAR_WIDTH, ScrollArea
from sandbox.app.widgets.styles import BoxLook, box
from sandbox.app.widgets.texts import TextBlock, line_height, text_height
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.export.engines import NoSuchBody, body_names
from sandbox.export.take_home import TakeHome, as_text, pasted, take_home
from sandbox.level.assembly.build_world import LevelWorld

# Sizes in layout units, and how far what does not fit into a line is moved in on the next [letters].
CODE_SIZE, INSET, MOVED_IN, TAB = 12.0, 12.0, 4, 4
# What it can be for, by what a person calls it.
ENGINES = {
    "Box2D": "box2d", "Unity 2D": "unity", "Godot": "godot", "Rapier": "rapier", "pymunk": "pymunk",
    "Chipmunk": "chipmunk",
}  # fmt: skip
LANGUAGES = {"Python": "python", "C#": "csharp", "GDScript": "gdscript", "C++": "cpp", "JavaScript": "javascript"}
ALL = "All numbers"
TARGETS = {**ENGINES, **LANGUAGES, ALL: "all"}
# Sizes in layout units.
WIDTH, HEIGHT, ROW, GAP, TEXT_SIZE = 820.0, 620.0, 34.0, 10.0, 13.0
TOP, BETWEEN = 66.0, 14.0
COLUMNS, MENU_WIDTH, ASKING_HEIGHT = 3, 200.0, 392.0
QUESTION, OWN_LOOP = "Which engine?", "Or a loop of your own, in"


def show_take_home(
    ui: Ui, world: LevelWorld, say: Callable[[str], None], body: str | None = None, target: str | None = None
) -> None:
    """Cover the window by what a body (None: the first) takes home, for one of TARGETS (None: it asks for which)."""
    names = body_names(world)
    if not names:
        say("This level has no springs to take home.")
        return
    body = body if body in names else names[0]
    try:
        take = take_home(world, body)
    except NoSuchBody as error:
        say(f"{error}.")
        return
    _TakeHomePage(ui, world, say, take, names, target)


class _TakeHomePage:
    """The page, for a body and a target, until it is closed or another one is chosen."""

    def __init__(
        self, ui: Ui, world: LevelWorld, say: Callable[[str], None], take: TakeHome, names: list[str],
        target: str | None,
    ) -> None:  # fmt: skip
        self._ui, self._world, self._say, self._take, self._target = ui, world, say, take, target
        self._wide = ui.px(min(WIDTH, ui.units[0] - AROUND) - 2 * MARGIN)
        self._code, self._about = ("", "") if target is None else _texts(take, TARGETS[target])
        high = ASKING_HEIGHT if target is None else TOP + self._content_height() / ui.scale + ROW + 36
        title = target or "Take it home"
        self._dialog = dialog = Dialog(ui, title, WIDTH, min(high, HEIGHT), self._reopen, is_page=True)
        self._width, self._height, self._box = dialog.width, dialog.height, dialog.box
        menu = ui.rect(self._width - MARGIN - MENU_WIDTH, 18, MENU_WIDTH, ROW)
        WordPicker(ui, menu, names, take.chosen.name, lambda name: self._go(target, name), self._box)
        (self._ask if target is None else self._answer)()

    def _reopen(self, ui: Ui) -> None:
        show_take_home(ui, self._world, self._say, self._take.chosen.name, self._target)

    def _go(self, target: str | None, body: str | None = None) -> None:
        self._dialog.end()
        show_take_home(self._ui, self._world, self._say, body or self._take.chosen.name, target)

    def _button(self, place: pygame.Rect, text: str, do: Callable[[], None], style: str = "") -> Any:
        return self._ui.button(place, text, do, self._box, style=style)

    # The question.

    def _ask(self) -> None:
        ui = self._ui
        y = 70.0
        for question, names in ((QUESTION, ENGINES), (OWN_LOOP, LANGUAGES)):
            TextBlock(ui, ui.rect(MARGIN, y, self._width - 2 * MARGIN, 22), question, self._box, 15.0, TEXT)
            y = self._choices(list(names), y + 30) + 12
        wide = (self._width - 2 * MARGIN - GAP) / 2
        place = ui.rect(MARGIN, self._height - 16 - ROW, wide, ROW)
        self._button(place, ALL, lambda: self._go(ALL))
        self._button(ui.rect(MARGIN + wide + GAP, self._height - 16 - ROW, wide, ROW), "Close", self._dialog.end)

    def _choices(self, names: list[str], y: float) -> float:
        """A button for each name, in rows; where these end."""
        wide = (self._width - 2 * MARGIN - (COLUMNS - 1) * GAP) / COLUMNS
        for number, name in enumerate(names):
            row, column = divmod(number, COLUMNS)
            place = self._ui.rect(MARGIN + column * (wide + GAP), y + row * (ROW + GAP), wide, ROW)
            button = self._button(place, name, lambda name=name: self._go(name))  # type: ignore[misc]
            if number == 0 and name in ENGINES:
                self._ui.focus_on(button)
        return y + -(-len(names) // COLUMNS) * (ROW + GAP)

    # The answer.

    def _content_height(self) -> int:
        """How high code and text are [pixels]."""
        ui = self._ui
        high = code_height(ui, self._code, self._wide) + ui.px(BETWEEN) if self._code else 0
        return high + text_height(self._about, ui.font(TEXT_SIZE), self._wide)

    def _go_back(self) -> None:
        self._go(None)

    def _copy(self) -> None:
        copied = copy_text(self._code or self._about)
        self._say("It is on the clipboard." if copied else "The clipboard is not available here.")

    def _answer(self) -> None:
        """Show the code to paste, and below it what to know about it."""
        ui = self._ui
        wide = (self._width - 2 * MARGIN - 2 * GAP) / 3
        actions = (
            ("Copy", self._copy, "primary"),
            ("Another engine", self._go_back, ""),
            ("Close", self._dialog.end, ""),
        )
        for number, (text, do, style) in enumerate(actions):
            place = ui.rect(MARGIN + number * (wide + GAP), self._height - 16 - ROW, wide, ROW)
            button = self._button(place, text, do, style)
            if number == 0:
                ui.focus_on(button)
        box = ui.rect(MARGIN, TOP, self._width - 2 * MARGIN, self._height - TOP - ROW - 32)
        box.width = self._wide + ui.px(BAR_WIDTH)
        area = ScrollArea(ui, box, self._box)
        high = self._content_height()
        tall = text_height(self._about, ui.font(TEXT_SIZE), self._wide)
        if self._code:
            place = pygame.Rect(0, 0, self._wide, code_height(ui, self._code, self._wide))
            CodeBlock(ui, place, self._code, area.content)
        place = pygame.Rect(0, high - tall, self._wide, tall)
        TextBlock(ui, place, self._about, area.content, TEXT_SIZE, MUTED if self._code else TEXT)
        area.set_height(high)


def _texts(take: TakeHome, to: str) -> tuple[str, str]:
    """The code to paste, "" where there is none, and what to know about it."""
    about = as_text(take, to)
    if to == "all":
        return "", about
    # Of a program the text has its listing as well.
    before, _, listed = about.partition("\n----")
    printed = listed.partition("\nWhat it prints")[2]
    return pasted(take, to), f"{before}\nWhat it prints{printed}" if printed else before


class CodeBlock(Widget):
    """The lines of a text on a sheet; a line that is too long goes on below, moved in."""

    def __init__(self, ui: Ui, rect: pygame.Rect, text: str, container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self.text = text

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The sheet and the lines."""
        ui, inset = self.ui, self.ui.px(INSET)
        surface = box(size, BoxLook(FIELD, LINE, TEXT), ui.px(6), 1).copy()
        font = code_font(ui.px(CODE_SIZE))
        for number, line in enumerate(_lines(ui, self.text, size[0])):
            surface.blit(font.render(line, True, TEXT), (inset, inset + number * line_height(font)))
        return surface


def code_height(ui: Ui, text: str, wide: int) -> int:
    """How high a block of that text is whose sheet is so wide [pixels]."""
    return len(_lines(ui, text, wide)) * line_height(code_font(ui.px(CODE_SIZE))) + 2 * ui.px(INSET)


def _lines(ui: Any, text: str, wide: int) -> list[str]:
    columns = max(int((wide - 2 * ui.px(INSET)) / code_font(ui.px(CODE_SIZE)).size("0")[0]), 2 * MOVED_IN)
    return [line for whole in text.expandtabs(TAB).splitlines() for line in _broken(whole, columns)]


def _broken(line: str, columns: int) -> list[str]:
    """A line in lines of at most so many letters, broken between words where that goes."""
    indent = len(line) - len(line.lstrip())
    inner = min(indent + MOVED_IN, columns // 2)
    made = []
    while len(line) > columns:
        end = line.rfind(" ", inner + 1, columns + 1)
        end = columns if end < 0 else end
        made.append(line[:end])
        line = " " * inner + line[end:].lstrip()
    return [*made, line]
