"""Golden pictures of levels as they begin; `python -m tests.app.golden_pictures` draws them anew."""

import os
from pathlib import Path

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

import pygame

from sandbox.app.draw.picture import draw_picture
from sandbox.level.reading.files import load_level
from sandbox.session.session import Session

FOLDER = Path(__file__).parent
# Drawn at this size [pixels] and kept at half of it.
DRAWN, KEPT = (480, 270), (240, 135)
# Level, theme, and whether by strain.
PICTURES = (
    ("jelly_pile", "dark", False), ("truck_bridge", "light", False), ("balloons", "light", False),
    ("rope_bridge_jelly", "dark", False), ("wrecking_crane", "dark", False), ("curtain", "light", False),
    ("pinball", "light", False), ("jelly_cube", "dark", True),
)  # fmt: skip


def golden(name: str) -> Path:
    """The file of a level's picture."""
    return FOLDER / f"{name}.png"


def drawn(name: str, theme: str, lattice: bool) -> pygame.Surface:
    """The picture as it is drawn now."""
    session = Session(load_level(name))
    picture = draw_picture(session.level, session.snapshot(), DRAWN, scale=0.7, theme=theme, lattice=lattice)
    return pygame.transform.smoothscale(picture, KEPT)
