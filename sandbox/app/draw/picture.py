"""Pictures of levels and runs, drawn off screen."""

import io
import os
from collections.abc import Generator
from pathlib import Path
from typing import cast

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Box, Camera, bounds
from sandbox.app.draw.renderer import Renderer
from sandbox.app.draw.themes import THEMES
from sandbox.level.document.model import Level
from sandbox.level.format.writing import write_file
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot
from sandbox.session.session import Session


def view_of(level: Level, snapshot: Snapshot) -> Box:
    """What the camera shows at first: the level's view, or else all of its particles and terrain."""
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


def run_at_once(level: Level, ticks: int, most_particles: int) -> Snapshot:
    """As `run_ahead`, in one slice."""
    slices = run_ahead(level, ticks, most_particles)
    while True:
        try:
            next(slices)
        except StopIteration as end:
            return cast(Snapshot, end.value)
