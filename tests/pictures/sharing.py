"""Draws the pictures of docs/sharing.md: the deeds of that page, by mouse, in a window that nobody sees."""

import os

os.environ["SDL_VIDEODRIVER"] = "dummy"

import tempfile
from pathlib import Path

import platformdirs
import pygame
from PIL import Image

from tests.app.conftest import Driver

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "sharing"
SIZE, COLOURS = (720, 506), 255
# What is drawn on the sheet: a tool, and from where to where it is dragged [m].
DRAWN = (
    ("tool_walls", (-6.5, -4.0), (6.5, 4.5)),
    ("tool_box", (-4.5, -3.5), (-2.0, -1.5)),
    ("tool_circle", (0.5, -2.5), (1.3, -2.0)),
    ("tool_box", (3.0, -3.5), (5.0, -2.5)),
)


class Photographer(Driver):
    """A person who takes pictures of the window."""

    def take(self, name: str) -> None:
        """Keep what the window shows, small."""
        self.frames()
        surface = self.app.display.surface
        picture = Image.frombytes("RGB", surface.get_size(), pygame.image.tobytes(surface, "RGB"))
        small = picture.resize(SIZE, Image.Resampling.LANCZOS)
        small.quantize(COLOURS, kmeans=1, dither=Image.Dither.NONE).save(FOLDER / f"{name}.png", optimize=True)

    def throw(self, name: str, by: tuple[float, float]) -> None:
        """Throw what a particle belongs to, by so many metres."""
        x, y = self.pixel_of(name)
        zoom = self.stage.camera.zoom
        self.press((x, y))
        for step in range(1, 9):
            self.move((x + by[0] * zoom * step / 8, y - by[1] * zoom * step / 8))
        self.release((x + by[0] * zoom, y - by[1] * zoom))


def draw() -> None:
    """Do what the page says and draw each step."""
    driver = Photographer()
    while driver.app.gallery._unfilled:
        driver.frames()
    driver.take("1-gallery")
    driver.choose("New")
    for tool, start, end in DRAWN:
        driver.app.act(tool)
        driver.drag(start, end)
    driver.app.act("cancel")
    driver.app.act("tool_select")
    driver.take("2-sheet")
    driver.app.act("play")
    driver.frames(60)
    names = driver.world.particle_names
    first = {name.partition(".")[0]: name for name in names}
    for name, by in zip(first.values(), ((6.0, 6.0), (-4.0, 5.0), (-5.0, 5.0)), strict=False):
        driver.throw(name, by)
        driver.frames(25)
    driver.take("3-play")
    driver.frames(200)
    driver.app.act("share")
    while driver.app.sharing._filming is not None:
        driver.app.sharing.update(0.0)
    driver.frames(240)
    driver.take("4-share")
    driver.choose("Save")
    while driver.app.sharing.step == "work" or driver.app.sharing._copying is not None:
        driver.app.sharing.update(0.0)
    driver.take("5-saved")
    driver.app.sharing.saved.replace(FOLDER / "my-toy.gif")
    driver.app.close()


def main() -> None:
    """Draw them with folders of a person who has nothing yet."""
    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "ann"
        os.environ |= {"HOME": str(home), "XDG_DATA_HOME": str(home / "data")}
        platformdirs.user_pictures_dir = lambda: str(home / "Pictures")
        draw()


if __name__ == "__main__":
    main()
