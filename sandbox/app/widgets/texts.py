"""Texts: Label, one line; TextBlock, which wraps; how texts are broken into lines, and how high they are."""

import pygame

from sandbox.app.draw.colours import MUTED, Colour
from sandbox.app.widgets.styles import LABELS
from sandbox.app.widgets.widget import Widget, WindowLayout


def wrapped(text: str, font: pygame.font.Font, widest: int, most_lines: int) -> list[str]:
    """The words of a text in lines no wider than `widest` [pixels]; what does not fit ends in an ellipsis."""
    lines: list[str] = []
    for word in text.split():
        if lines and font.size(f"{lines[-1]} {word}")[0] <= widest:
            lines[-1] += f" {word}"
        elif len(lines) == most_lines:
            while lines[-1] and font.size(f"{lines[-1]}…")[0] > widest:
                lines[-1] = lines[-1][:-1]
            lines[-1] += "…"
            break
        else:
            lines.append(word)
    return lines or [""]


def shortened(text: str, font: pygame.font.Font, widest: int, in_middle: bool = False) -> str:
    """A text on one line no wider than `widest` [pixels], with an ellipsis at its end or in its middle for the rest."""
    kept, shown = len(text), text
    while kept and font.size(shown)[0] > widest:
        kept -= 1
        end = kept // 2 if in_middle else 0
        shown = f"{text[: kept - end]}…{text[len(text) - end :]}"
    return shown


def line_height(font: pygame.font.Font) -> int:
    """Distance [pixels] of the lines of a text that wraps."""
    return round(font.get_linesize() * 0.95)


def text_height(text: str, font: pygame.font.Font, widest: int) -> int:
    """How high a text is [pixels] whose lines are no wider than `widest`."""
    return sum(len(wrapped(each, font, widest, len(each) + 1)) for each in text.split("\n")) * line_height(font)


class Written(Widget):
    """A widget with a text."""

    text = ""

    def show_text(self, text: str) -> None:
        """Show another text."""
        if text != self.text:
            self.text = text
            self.repaint()


class Label(Written):
    """One line of text in one of the styles, in the middle of the height."""

    def __init__(
        self, ui: WindowLayout, rect: pygame.Rect, text: str, parent: Widget | None = None, style: str = ""
    ) -> None:
        super().__init__(ui, rect, parent)
        self.text, self.style = text, LABELS[style]

    @property
    def font(self) -> pygame.font.Font:
        """The font of the label."""
        return self.ui.font(self.style.size, self.style.is_bold)

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """As much of the label's text as fits."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        text = self.font.render(shortened(self.text, self.font, size[0]), True, self.style.text)
        surface.blit(text, (round((size[0] - text.width) * self.style.side), (size[1] - text.height - 1) // 2))
        return surface


class TextBlock(Written):
    """Text that wraps; colour, and size in layout units."""

    def __init__(
        self,
        ui: WindowLayout,
        rect: pygame.Rect,
        text: str,
        parent: Widget | None = None,
        size: float = 11.0,
        colour: Colour = MUTED,
        *,
        is_bold: bool = False,
    ) -> None:
        super().__init__(ui, rect, parent)
        self.text, self.text_size, self.colour, self.is_bold = text, size, colour, is_bold

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """As many lines of the text as fit."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        font = self.ui.font(self.text_size, self.is_bold)
        height = line_height(font)
        y = 0
        for paragraph in self.text.split("\n"):
            if y and y + height > size[1]:
                break
            for line in wrapped(paragraph, font, size[0], max(1, (size[1] - y) // height)):
                surface.blit(font.render(line, True, self.colour), (0, y))
                y += height
        return surface
