"""Pictures of levels, runs and parts, drawn off screen: for files, for buttons, and of what a click would drop."""

import io
import json
import math
import os
from collections.abc import Generator
from pathlib import Path

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Box, Camera, bounds
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.renderer import Renderer
from sandbox.level.document.model import Level
from sandbox.level.format.limits import FORMAT, VERSION
from sandbox.level.format.writing import write_file
from sandbox.level.reading.parse import parse_level
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.session import Session
from sandbox.tools.dropping import COLOURS, PARTS
from sandbox.tools.tool import DropPicture

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")


def view_of(level: Level, snapshot: Snapshot) -> Box:
    """The first box of the camera: the level's view, or else all of its particles and terrain."""
    return level.view or bounds(_points(snapshot))


def crop_of(level: Level, snapshot: Snapshot) -> Box:
    """The part of the level's view with anything in it, which a small picture shows."""
    left, bottom, right, top = view_of(level, snapshot)
    return bounds(np.clip(_points(snapshot), (left, bottom), (right, top)))


def particles_of(snapshot: Snapshot) -> Box:
    """The box [m] around all particles."""
    return bounds(_corners(snapshot))


def _corners(snapshot: Snapshot) -> NDArray[np.float64]:
    shown = shown_particles(snapshot)
    position, radius = snapshot.position[shown], snapshot.radius[shown, None]
    return np.concatenate([position - radius, position + radius])


def _points(snapshot: Snapshot) -> NDArray[np.float64]:
    # Corners of all that is drawn.
    return np.concatenate([_corners(snapshot), snapshot.terrain.vertex])


def draw_picture(
    level: Level, snapshot: Snapshot, size: tuple[int, int], box: Box | None = None, scale: float | None = None,
    theme: str | None = None, lattice: bool = False,
) -> pygame.Surface:  # fmt: skip
    """A picture of a state of a level; size [pixels]; box [m], None = the level's view; scale: thickness of lines.

    theme: its name, None = the level's; lattice: whether springs are shown by their strain.
    """
    surface = pygame.Surface(size, 0, 32)
    camera = Camera(viewport=(0, 0, *size))
    camera.fit(view_of(level, snapshot) if box is None else box)
    renderer = Renderer(max(0.6, min(size[0] / 1280, size[1] / 720)) if scale is None else scale, level)
    if theme is not None:
        renderer.theme = THEMES[theme]
    renderer.lattice = lattice
    renderer.draw(surface, camera, snapshot, snapshot, 1.0)
    return surface


def save_picture(session: Session, path: Path, size: tuple[int, int] = (1280, 720)) -> None:
    """Draw the present state of a session into a PNG file; needs no display. Raises OSError."""
    write_png(draw_picture(session.level, session.snapshot(), size), path)


def write_png(picture: pygame.Surface, path: Path) -> None:
    """Write a picture into a PNG file, whole or not at all. Raises OSError."""
    # pygame itself says nothing of a disk that is full.
    data = io.BytesIO()
    try:
        pygame.image.save(picture, data, "picture.png")
    except pygame.error as error:
        raise OSError(0, str(error), str(path)) from None
    try:
        write_file(path, data.getvalue())
    except OSError as error:
        raise OSError(error.errno or 0, error.strerror or str(error), str(path)) from None


def run_ahead(level: Level, ticks: int, most_particles: int) -> Generator[bool, None, Snapshot]:
    """Give the state of a level after this many ticks, one a slice; of one of more particles, as it is built."""
    session = Session(level)
    for _ in range(ticks if len(session.world.mass) <= most_particles else 0):
        yield True
        with np.errstate(over="ignore", invalid="ignore"):
            session.advance()
    return session.snapshot()


# Half of what a part's picture shows [m], of a part of 1 m.
SHOWN = {"rope": 1.1, "cart": 0.8}
USUALLY_SHOWN = 0.62
# How much of a part shows where it would be dropped, of 1; and the widest picture of that [pixels]: of larger parts
# the outline is enough.
GHOST_SHARE, GHOST_MOST = 0.55, 600


def picture_of(part: str, size: int) -> pygame.Surface:
    """A picture of a part, on a square of size [pixels]."""
    level, state = _alone(part, 1.0, COLOURS[0])
    half, times = _half_shown(part), 3
    large = draw_picture(level, state, (times * size, times * size), (-half, -half, half, half), 1.0)
    # Round corners, as buttons have.
    mask = pygame.Surface(large.get_size(), pygame.SRCALPHA)
    # What is outside has the colours of the picture too, or the corners would be dark once they are made small.
    mask.fill((255, 255, 255, 0))
    pygame.draw.rect(mask, (255, 255, 255, 255), mask.get_rect(), border_radius=times * size // 6)
    mask.blit(large, (0, 0), special_flags=pygame.BLEND_RGB_MULT)
    return pygame.transform.smoothscale(mask, (size, size))


class PartGhost:
    """The pale picture of what would be dropped; it is drawn again where the part, its size or the zoom are others."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._picture: pygame.Surface | None = None
        # What is in hand of the catalogue: a level, its state, and the box around it.
        self._known: tuple[Level, Snapshot, Box] | None = None

    def picture(self, preview: DropPicture, zoom: float, like: Renderer) -> pygame.Surface | None:
        """The part that would be added, in the middle of a picture; None where that would be too large.

        zoom [pixels/m]; like: a renderer of the run, whose theme and scale the picture has.
        """
        if isinstance(preview.part, str):
            return self._picture_of_part(preview.part, preview.size, preview.colour, zoom, like)
        # A part that is twice as large as it was kept looks like one that is seen from half as far.
        return self._picture_of_level(preview.part, zoom * preview.size, like)

    def _picture_of_part(
        self, part: str, size: float, colour: str, zoom: float, like: Renderer
    ) -> pygame.Surface | None:
        key = part, size, colour, zoom, like.scale, like.theme.name, like.compiled
        if key != self._key:
            half, self._key = _half_shown(part) * size, key
            self._picture = None
            if _pixels_of(2.4 * half, zoom) <= GHOST_MOST:
                self._picture = self._drawn(*_alone(part, size, colour), (-half, -half, half, half), zoom, like)
        return self._picture

    def _picture_of_level(self, part: Level, zoom: float, like: Renderer) -> pygame.Surface | None:
        if self._known is None or self._known[0] is not part:
            state = Session(part).snapshot()
            self._known = part, state, particles_of(state)
        _, state, (left, bottom, right, top) = self._known
        key = id(part), zoom, like.scale, like.theme.name, like.compiled
        if key != self._key:
            is_small = max(_pixels_of(1.2 * side, zoom) for side in (right - left, top - bottom)) <= GHOST_MOST
            self._key = key
            self._picture = self._drawn(part, state, (left, bottom, right, top), zoom, like) if is_small else None
        return self._picture

    def _drawn(self, level: Level, state: Snapshot, box: Box, zoom: float, like: Renderer) -> pygame.Surface:
        """A state of a level in a picture of a box [m] and some room around it."""
        left, bottom, right, top = box
        size = _pixels_of(1.2 * (right - left), zoom), _pixels_of(1.2 * (top - bottom), zoom)
        on = []
        for ground in (0, 255):
            surface = pygame.Surface(size, 0, 32)
            surface.fill((ground, ground, ground))
            renderer = Renderer(like.scale, level)
            renderer.theme, renderer.compiled, renderer.has_stage = like.theme, like.compiled, False
            camera = Camera(((left + right) / 2, (bottom + top) / 2), zoom, (0, 0, *size))
            renderer.draw(surface, camera, state, state, 1.0)
            on.append(pygame.surfarray.array3d(surface).astype(np.float64))
        # What of a black and a white ground shows through says how much of each pixel is covered.
        cover = 1.0 - (on[1] - on[0]).mean(axis=2) / 255.0
        colours = on[0] / np.maximum(cover, 1.0 / 255.0)[..., None]
        picture = pygame.Surface(size, pygame.SRCALPHA)
        pygame.surfarray.blit_array(picture, np.clip(colours, 0, 255).astype(np.uint8))
        pygame.surfarray.pixels_alpha(picture)[...] = np.clip(255.0 * GHOST_SHARE * cover, 0, 255).astype(np.uint8)
        return picture


def _pixels_of(length: float, zoom: float) -> int:
    return max(2 * math.ceil(length * zoom / 2), 2)


def _half_shown(part: str) -> float:
    return SHOWN.get(part, USUALLY_SHOWN)


def _alone(part: str, size: float, colour: str) -> tuple[Level, Snapshot]:
    """An empty level with a part of a size [m] in its middle."""
    empty = json.dumps({"format": FORMAT, "version": VERSION, "name": part, "contacts": {}})
    session = Session(parse_level(empty.encode(), part))
    session.submit(PARTS[part].make(size, (0.0, 0.0), (0.0, 0.0), colour))
    session.apply_pending()
    return session.level, session.snapshot()
