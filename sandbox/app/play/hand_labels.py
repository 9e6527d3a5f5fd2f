"""The hand: words beside the pointer, what it pulls with and why a tool did nothing; and its strength, remembered."""

import math

import numpy as np
import pygame

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import NOTICE, TEXT, WARNING, Colour
from sandbox.app.widgets.texts import wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.physics.analysis.applied_forces import Pull
from sandbox.physics.snapshot import Snapshot
from sandbox.tools.drag import STRENGTHS
from sandbox.tools.tool import Tool

# Sizes in layout units: of the text, and how far from the cursor it is.
TEXT_SIZE = 12.0
ASIDE, ABOVE = 14.0, 26.0
HINT_WIDTH, MOST_LINES = 260.0, 4
# What a plate has around the words on it, and how much it hides of what is behind it, of 255.
PLATE, OPACITY = 4.0, 225
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
    for pull in pulls:
        at = current.position[pull.cursor]
        if not (np.isfinite(at).all() and math.isfinite(pull.force)):
            continue
        x, y = camera.to_pixels((float(at[0]), float(at[1])))
        colour = WARNING if pull.at_limit else TEXT
        _write(surface, ui, (x + ui.px(ASIDE), y - ui.px(ABOVE)), text_of(pull), colour)


def draw_hint(surface: pygame.Surface, ui: Ui, camera: Camera, tool: Tool) -> None:
    """Write what a tool has to say beside the pointer, where that is over the world."""
    if not tool.hint or tool.place is None:
        return
    left, top, width, height = camera.viewport
    lines = wrapped(tool.hint, ui.font(TEXT_SIZE), ui.px(HINT_WIDTH), MOST_LINES)
    size = max(ui.font(TEXT_SIZE).size(line)[0] for line in lines), ui.font(TEXT_SIZE).get_linesize() * len(lines)
    x, y = camera.to_pixels(tool.place)
    x, y = min(x + ui.px(ASIDE), left + width - size[0] - ui.px(ASIDE)), min(y + ui.px(ASIDE), top + height - size[1])
    _write(surface, ui, (x, y), lines, WARNING if tool.is_refused else TEXT)


def _write(surface: pygame.Surface, ui: Ui, place: tuple[float, float], lines: list[str], colour: Colour) -> None:
    font, around = ui.font(TEXT_SIZE), ui.px(PLATE)
    step, width = font.get_linesize(), max(font.size(line)[0] for line in lines)
    plate = pygame.Surface((width + 2 * around, step * len(lines) + 2 * around), pygame.SRCALPHA)
    pygame.draw.rect(plate, (*NOTICE, OPACITY), plate.get_rect(), border_radius=around)
    for row, line in enumerate(lines):
        plate.blit(font.render(line, True, colour), (around, around + row * step))
    surface.blit(plate, (place[0] - around, place[1] - around))


# Under what it is remembered.
HAND = "hand"


def kept_strength(otherwise: str) -> str:
    """The strength that was chosen last, or another where none was."""
    kept = preference(HAND)
    return kept if isinstance(kept, str) and kept in STRENGTHS else otherwise


def keep_strength(name: str) -> None:
    """Remember a strength for later runs."""
    set_preference(HAND, name)


def next_strength(name: str) -> tuple[str, str]:
    """The next strength of the hand, with a line about it."""
    names = list(STRENGTHS)
    name = names[(names.index(name) + 1) % len(names)]
    return name, f"Hand: {name}, at most {STRENGTHS[name] / 10.0:g} times the weight of what it holds."
