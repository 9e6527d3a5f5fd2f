"""Trails over the sheet: the way of what is selected over the next seconds, and paler its way in the last run."""

from collections.abc import Sequence

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import ACCENT, BACKGROUND, MUTED, TEXT, WARNING, Colour, mixed
from sandbox.app.widgets.ui import Ui
from sandbox.editor.forecast import Trail
from sandbox.editor.items import Selection
from sandbox.editor.range_trial import RangeTrial

Floats = NDArray[np.float64]

# No more things have a trail at a time.
MOST = 8
# Radii of the dots of each whole second, and width of the line [layout units].
DOT, WIDTH = 3.5, 2.0
# A way that is shorter than this [pixels] is none.
SHORTEST = 6.0


def draw_trails(
    surface: pygame.Surface, ui: Ui, camera: Camera, trails: Sequence[tuple[Trail, bool]], selection: Selection
) -> None:
    """Draw the trails of a selection, each with whether it is of the last run."""
    for trail, is_last in trails:
        colour = mixed(BACKGROUND, MUTED, 0.8) if is_last else ACCENT
        for line in trail.lines(selection, MOST):
            draw_way(surface, ui, camera, line, trail.per_second, colour)


def attempt_colour(number: int, count: int) -> Colour:
    """The colour of one of several values that are tried, from the first to the last."""
    return mixed(ACCENT, WARNING, number / max(count - 1, 1))


def draw_attempts(surface: pygame.Surface, ui: Ui, camera: Camera, trial: RangeTrial, chosen: int | None) -> None:
    """Draw the way of what was selected for each value that was tried, that of the chosen one over the others."""
    count, selection = len(trial.attempts), trial.document.selection
    order = sorted(range(count), key=lambda number: number == chosen)
    for number in order:
        trail = trial.attempts[number].trail
        colour = attempt_colour(number, count)
        if chosen is not None and number != chosen:
            colour = mixed(BACKGROUND, colour, 0.45)
        if trail is not None:
            for line in trail.lines(selection, MOST):
                draw_way(surface, ui, camera, line, trail.per_second, colour)


def draw_way(surface: pygame.Surface, ui: Ui, camera: Camera, line: Floats, per_second: float, colour: Colour) -> None:
    """Draw a way [m] (notes, 2): a line, a dot for each whole second, and the last second in words."""
    pixels = camera.project(line)
    if len(pixels) < 2 or float(np.abs(np.ptp(pixels, axis=0)).max()) < SHORTEST:
        return
    # What has flown beyond everything would overflow in the drawing.
    near = np.clip(pixels, -32000.0, 32000.0)
    pygame.draw.lines(surface, colour, False, near.tolist(), max(1, round(WIDTH * ui.scale)))
    seconds = int((len(line) - 1) / per_second)
    for second in range(1, seconds + 1):
        at = near[round(second * per_second)].tolist()
        pygame.draw.aacircle(surface, BACKGROUND, at, (DOT + 1.5) * ui.scale)
        pygame.draw.aacircle(surface, colour, at, DOT * ui.scale)
    if seconds:
        text = ui.font(11).render(f"{seconds} s", True, mixed(colour, TEXT, 0.4))
        x, y = near[round(seconds * per_second)].tolist()
        surface.blit(text, (x + 7 * ui.scale, y - text.get_height() / 2))
