"""SolutionStrip: whether the level's solution wins it, as a part of a page, and what one may do about it."""

from collections.abc import Callable
from functools import partial
from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.widgets.boxes import ProgressBar
from sandbox.app.widgets.texts import TextBlock

# Sizes in layout units: of the strip, its text, bar and buttons.
STRIP, TEXT, BAR, BUTTON, GAP = 106.0, 48.0, 6.0, 28.0, 6.0


class SolutionStrip:
    """The strip in a place [pixels]."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, ui = screen, screen.ui
        self._do: list[Callable[[], None]] = []
        wide, top = place.width, place.top
        self.text = TextBlock(ui, pygame.Rect(place.left, top, wide, ui.px(TEXT)), "", container, 12.0)
        self.bar = ProgressBar(ui, pygame.Rect(place.left, top + ui.px(TEXT), wide, ui.px(BAR)), container)
        y, half = top + ui.px(TEXT + BAR + GAP), (wide - ui.px(GAP)) // 2
        self.buttons = [
            ui.button(
                pygame.Rect(place.left + number * (half + ui.px(GAP)), y, half, ui.px(BUTTON)), "",
                partial(self._press, number), container, style="segment",
            )
            for number in range(2)
        ]  # fmt: skip

    def _press(self, number: int) -> None:
        self._do[number]()

    def refresh(self) -> None:
        """Show what is known of the solution now."""
        proving = self._screen.watch.proving
        text, colour = proving.text
        if (text, colour) != (self.text.text, self.text.colour):
            self.text.colour = colour
            self.text.show_text(text)
            self.text.repaint()
        self.bar.visible = proving.done is not None
        self.bar.show_fraction(proving.done or 0.0)
        choices = self._choices() if text else []
        self._do = [do for _, do in choices]
        for number, button in enumerate(self.buttons):
            button.visible = number < len(choices)
            if button.visible:
                button.show_text(choices[number][0])

    def _choices(self) -> list[tuple[str, Callable[[], None]]]:
        """What one may do, two things at most."""
        proving, documents = self._screen.watch.proving, self._screen.app.documents
        found = None if proving.looking is None else proving.looking.found
        if found is not None:
            return [
                ("Play with ghost", lambda: documents.play(ghost=found)),
                ("Keep it", lambda: documents.keep_solution(found)),
            ]
        if proving.done is not None:
            return [("Cancel", proving.stop)] if proving.looking is not None else []
        run = proving.run
        if run is not None:
            return [("Watch it", lambda: documents.play(watched=run))]
        return [("Look for a way", proving.look)]
