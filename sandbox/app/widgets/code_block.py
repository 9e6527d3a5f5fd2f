"""CodeBlock: lines of code as they are to be pasted, in letters of one width, with their indentation."""

from typing import Any

import pygame

from sandbox.app.draw.colours import FIELD, LINE, TEXT
from sandbox.app.widgets.fonts import code_font
from sandbox.app.widgets.plate import box
from sandbox.app.widgets.styles import BoxLook
from sandbox.app.widgets.texts import line_height
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget

# Sizes in layout units, and how far what does not fit into a line is moved in on the next [letters].
TEXT_SIZE, INSET, MOVED_IN, TAB = 12.0, 12.0, 4, 4


class CodeBlock(Widget):
    """The lines of a text on a sheet; a line that is too long goes on below, moved in."""

    def __init__(self, ui: Ui, rect: pygame.Rect, text: str, container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self.text = text

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The sheet and the lines."""
        ui, inset = self.ui, self.ui.px(INSET)
        surface = box(size, BoxLook(FIELD, LINE, TEXT), ui.px(6), 1).copy()
        font = code_font(ui.px(TEXT_SIZE))
        for number, line in enumerate(_lines(ui, self.text, size[0])):
            surface.blit(font.render(line, True, TEXT), (inset, inset + number * line_height(font)))
        return surface


def code_height(ui: Ui, text: str, wide: int) -> int:
    """How high a block of that text is whose sheet is so wide [pixels]."""
    return len(_lines(ui, text, wide)) * line_height(code_font(ui.px(TEXT_SIZE))) + 2 * ui.px(INSET)


def _lines(ui: Any, text: str, wide: int) -> list[str]:
    columns = max(int((wide - 2 * ui.px(INSET)) / code_font(ui.px(TEXT_SIZE)).size("0")[0]), 2 * MOVED_IN)
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
