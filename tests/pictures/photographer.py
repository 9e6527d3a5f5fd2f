"""Photographer: a person at the app who takes pictures of its window, in folders of their own, alike each time."""

import os

os.environ["SDL_VIDEODRIVER"] = "dummy"

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import platformdirs
import pygame
from PIL import Image

from sandbox.app.contracts.screen import Figures
from tests.app.conftest import Driver

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
# Colours of a picture, and of its own so many are looked at in one go.
COLOURS, PART = 255, 4096


def write_small(surface: pygame.Surface, path: Path, size: tuple[int, int]) -> None:
    """Write a picture in a size [pixels] and few colours, in few bytes."""
    picture = Image.frombytes("RGB", surface.get_size(), pygame.image.tobytes(surface, "RGB"))
    small = picture.resize(size, Image.Resampling.LANCZOS)
    path.parent.mkdir(exist_ok=True)
    _in_few_colours(small).save(path, optimize=True)


def _in_few_colours(picture: Image.Image) -> Image.Image:
    """A picture in COLOURS colours, chosen by the square root of how often they are there.

    By their number alone the calm stage takes all of them, and what is small and bright gets one of it.
    """
    pixels = np.asarray(picture).reshape(-1, 3)
    found, place, count = np.unique(pixels, axis=0, return_inverse=True, return_counts=True)
    weighted = np.repeat(found, np.round(np.sqrt(count)).astype(int), axis=0)
    chosen = Image.fromarray(weighted[None]).quantize(COLOURS, kmeans=3, dither=Image.Dither.NONE).getpalette()
    palette = np.array(chosen).reshape(-1, 3)
    # Pillow's own way to the nearest of a palette leaves out the lowest bits, and a gradient shows rings.
    parts = np.array_split(found.astype(int), max(1, len(found) // PART))
    nearest = np.concatenate([((part[:, None] - palette) ** 2).sum(axis=2).argmin(axis=1) for part in parts])
    result = Image.fromarray(nearest[place].reshape(picture.size[::-1]).astype(np.uint8), "P")
    result.putpalette(palette.astype(np.uint8).tobytes())
    return result


class Photographer(Driver):
    """A person who takes pictures of the window; width [pixels] of them, as high as the window's form asks for."""

    width = 640

    def __init__(self, level=None, replay=None):
        super().__init__(level, replay)
        # How fast the machine is would show in the status line.
        self.app._count = lambda *_: None
        self.app._figures = Figures(60.0, 60.0, 5.0)

    def take(self, path: Path) -> None:
        """Keep what the window shows, small."""
        self.frames()
        surface = self.app.display.surface
        wide, tall = surface.get_size()
        write_small(surface, path, (self.width, round(self.width * tall / wide)))

    def throw(self, name: str, by: tuple[float, float]) -> None:
        """Throw what a particle belongs to, by so many metres."""
        x, y = self.pixel_of(name)
        zoom = self.stage.camera.zoom
        self.press((x, y))
        for step in range(1, 9):
            self.move((x + by[0] * zoom * step / 8, y - by[1] * zoom * step / 8))
        self.release((x + by[0] * zoom, y - by[1] * zoom))

    def wait_for_gallery(self) -> None:
        """Until all cards of the gallery are filled."""
        while self.app.gallery is not None and self.app.gallery._unfilled:
            self.frames()


@contextmanager
def own_home() -> Iterator[Path]:
    """Folders of a person who has nothing yet, and whose name is ann; they are gone afterwards."""
    before = dict(os.environ)
    pictures, documents = platformdirs.user_pictures_dir, platformdirs.user_documents_dir
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "ann"
        os.environ |= {"HOME": str(home), "XDG_DATA_HOME": str(home / "data"), "XDG_CONFIG_HOME": str(home / "config")}
        platformdirs.user_pictures_dir = lambda: str(home / "Pictures")
        platformdirs.user_documents_dir = lambda: str(home / "Documents")
        try:
            yield home
        finally:
            platformdirs.user_pictures_dir, platformdirs.user_documents_dir = pictures, documents
            os.environ.clear()
            os.environ.update(before)
