"""What hands pull with, written beside their cursors."""

import math

import numpy as np
import pygame

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import BACKGROUND, TEXT, WARNING
from sandbox.app.widgets.ui import Ui
from sandbox.physics.analysis.pulls import Pull
from sandbox.physics.snapshot import Snapshot

# Sizes in layout units: of the text, and how far from the cursor it is.
TEXT_SIZE = 12.0
ASIDE, ABOVE = 14.0, 26.0
UNITS = ((1e9, "GN"), (1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"))


def newtons(force: float) -> str:
    """A force [N] in at most three digits and its unit."""
    scale, name = next((unit for unit in UNITS if force >= unit[0]), (1.0, "N"))
    value = float(f"{force / scale:.3g}")
    # Three digits of 1,000 would be written with an exponent.
    return f"{value:.0f} {name}" if value >= 100.0 else f"{value:.3g} {name}"


def text_of(pull: Pull) -> list[str]:
    """The lines that say what a hand does: how much it pulls, and at its limit why nothing more happens."""
    if not pull.at_limit:
        return [newtons(pull.force)]
    lines = [f"{newtons(pull.force)} of {newtons(pull.limit)}"]
    return [*lines, "pinned: the body can only bend"] if pull.pinned else lines


def draw_labels(surface: pygame.Surface, ui: Ui, camera: Camera, current: Snapshot, pulls: list[Pull]) -> None:
    """Write beside every cursor how much its hand pulls."""
    font = ui.font(TEXT_SIZE)
    for pull in pulls:
        at = current.position[pull.cursor]
        if not (np.isfinite(at).all() and math.isfinite(pull.force)):
            continue
        x, y = camera.to_pixels((float(at[0]), float(at[1])))
        colour = WARNING if pull.at_limit else TEXT
        for row, line in enumerate(text_of(pull)):
            place = (x + ui.px(ASIDE), y - ui.px(ABOVE) + row * font.get_linesize())
            for dx, dy in ((-1, 0), (1, 0), (0, -1), (0, 1)):
                surface.blit(font.render(line, True, BACKGROUND), (place[0] + dx, place[1] + dy))
            surface.blit(font.render(line, True, colour), place)
