"""Offers: buttons over the world that are there only while there is something for them to do."""

from collections.abc import Callable
from typing import Any

import pygame

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.play.toolbar import BAR_HEIGHT
from sandbox.app.widgets.ui import Ui

# How far they are below the bar, and the size of those at the left and of the one in the middle [layout units].
TOP, SIZE, AGAIN_SIZE = 12.0, (110.0, 34.0), (150.0, 40.0)


def add_offers(
    ui: Ui, left: float, middle: float, again_top: float, free: Callable[[], None], bring_back: Callable[[], None],
    again: Callable[[], None],
) -> tuple[Any, Any, Any]:  # fmt: skip
    """The hidden buttons that free, that bring back and that begin again, what each does being given.

    left: of the first two; middle: of the last, which is again_top below the bar [layout units].
    """
    freeing = ui.button(ui.rect(left, BAR_HEIGHT + TOP, *SIZE), "Free it", free, tip=tip_of("free", "play"))
    place = ui.rect(middle - AGAIN_SIZE[0] / 2, BAR_HEIGHT + again_top, *AGAIN_SIZE)
    beginning = ui.button(place, "Again", again, style="@primary", tip=tip_of("reset", "play"))
    x, y = freeing.relative_rect.bottomleft
    place = pygame.Rect((x, y + ui.px(TOP / 2)), freeing.relative_rect.size)
    bringing = ui.button(place, "Bring back", bring_back, tip=tip_of("bring_back", "play"))
    for button in (freeing, bringing, beginning):
        button.hide()
    return freeing, bringing, beginning


def show_while(button: Any, wanted: bool) -> None:
    """Show a button, or hide it, where it is not so already."""
    if wanted != bool(button.visible):
        (button.show if wanted else button.hide)()
