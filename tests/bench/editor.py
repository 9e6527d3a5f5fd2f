"""How long the editor takes on 20,000 particles: `python -m tests.bench.editor [page of the panel]`, in milliseconds.

Every figure is the wall time from an event to the end of the frame that answers it, or of the frame after it where
that takes longer, in the whole app on a driver that shows nothing. At 60 Hz two frames are 33 ms. Run it while nothing
else runs.
"""

import os

os.environ["SDL_VIDEODRIVER"] = "dummy"

import sys
import tempfile
import time

import pygame

from sandbox.app.base.display import Display, StartRequest
from sandbox.app.edit.edit_screen import EditScreen
from sandbox.app.window.app import App
from sandbox.editor.document import empty_level
from sandbox.level.document.model import Level, ParticleDef, SpringDef
from sandbox.level.kinds.jelly import BoxShape, JellyDef

FRAME = 1.0 / 60.0  # [s]
# How often everything is done; the figures are medians.
REPEATS = 5
CTRL = pygame.KMOD_CTRL
Pixel = tuple[float, float]


def jelly(name: str, columns: int, rows: int, x: float, y: float) -> JellyDef:
    shape = BoxShape(box=(0.25 * (columns - 1), 0.25 * (rows - 1)))
    return JellyDef(type="jelly", id=name, shape=shape, spacing=0.25, position=(x, y))


def levels() -> dict[str, Level]:
    """Levels of 20,000 particles, by what they are made of."""
    cubes = tuple(jelly(f"cube {k}", 4, 4, 2.0 * (k % 50), 2.0 * (k // 50)) for k in range(1250))
    loose = tuple(ParticleDef(id=f"p {k}", position=(0.5 * (k % 200), 0.5 * (k // 200))) for k in range(20_000))
    springs = tuple(SpringDef(a=f"p {k}", b=f"p {k + 1}") for k in range(19_999))
    return {
        "one jelly": empty_level().model_copy(update={"bodies": (jelly("jelly", 200, 100, 0.0, 0.0),)}),
        "1,250 cubes": empty_level().model_copy(update={"bodies": cubes}),
        "20,000 loose": empty_level().model_copy(update={"particles": loose, "springs": springs}),
    }


class Maker:
    """A person at the editor who does one thing after another, and how long each of them took [ms]."""

    def __init__(self, app: App, page: str) -> None:
        self.app = app
        self.times: dict[str, list[float]] = {}
        self.editor.side.choose(page)
        self.rest()

    @property
    def editor(self) -> EditScreen:
        editor = self.app.documents.editor
        assert editor is not None
        return editor

    def rest(self, frames: int = 150) -> None:
        """Let frames pass, until the linter and the autosave have nothing to do."""
        for _ in range(frames):
            self.app.frame(FRAME)
        time.sleep(1.0)

    def post(self, what: str, kind: int, **data: object) -> None:
        """Let an event happen, and note how long the answer takes, unless `what` is empty."""
        times = []
        pygame.event.post(pygame.event.Event(kind, **data))
        for _ in range(2):
            start = time.perf_counter()
            self.app.frame(FRAME)
            times.append(1000.0 * (time.perf_counter() - start))
        if what:
            self.times.setdefault(what, []).append(max(times))
        for _ in range(10):
            self.app.frame(FRAME)

    def key(self, what: str, key: int, mod: int = 0) -> None:
        self.post(what, pygame.KEYDOWN, key=key, mod=mod, unicode="", scancode=0)
        self.post("", pygame.KEYUP, key=key, mod=mod, unicode="", scancode=0)

    def drag(self, what: str, start: Pixel, end: Pixel) -> None:
        self.move("", start)
        self.post(f"{what} press", pygame.MOUSEBUTTONDOWN, pos=start, button=1)
        for part in (0.3, 0.6, 1.0):
            at = round(start[0] + part * (end[0] - start[0])), round(start[1] + part * (end[1] - start[1]))
            self.move(what, at)
        self.post(f"{what} release", pygame.MOUSEBUTTONUP, pos=end, button=1)

    def move(self, what: str, pixel: Pixel) -> None:
        pygame.mouse.set_pos(pixel)
        pygame.event.get(pygame.MOUSEMOTION)
        self.post(what, pygame.MOUSEMOTION, pos=pixel, rel=(1, 1), buttons=(1, 0, 0))

    def work(self) -> None:
        """What a maker does to a whole level."""
        camera, scene = self.editor.camera, self.editor.scene
        first, last = (tuple(map(round, camera.to_pixels(tuple(scene.position[k].tolist())))) for k in (0, -1))
        self.key("select all", pygame.K_a, CTRL)
        self.drag("drag", first, (first[0] + 40, first[1] - 30))
        self.key("undo", pygame.K_z, CTRL)
        self.key("redo", pygame.K_y, CTRL)
        self.key("nudge", pygame.K_UP)
        self.key("nudge", pygame.K_UP)
        self.key("undo", pygame.K_z, CTRL)
        self.key("undo", pygame.K_z, CTRL)
        self.key("delete", pygame.K_DELETE)
        self.key("undo delete", pygame.K_z, CTRL)
        self.key("deselect", pygame.K_ESCAPE)
        self.drag("box", (first[0] - 20, first[1] + 20), (last[0] + 20, last[1] - 20))
        assert len(self.editor.document.selection) == len(scene.items), "the box was to select everything"
        self.key("deselect", pygame.K_ESCAPE)
        self.rest()


def measure(level: Level, page: str) -> dict[str, float]:
    """Medians [ms] of what a maker does to a whole level, with a page of the panel open."""
    app = App(Display(1.0))
    app.open(StartRequest(level))
    try:
        app.documents.edit_level(level)
        maker = Maker(app, page)
        maker.work()
        maker.times.clear()
        for _ in range(REPEATS):
            maker.work()
        return {what: sorted(times)[len(times) // 2] for what, times in maker.times.items()}
    finally:
        app.close()


def main() -> None:
    page = (sys.argv[1:] or ["properties"])[0]
    with tempfile.TemporaryDirectory() as folder:
        os.environ |= {"XDG_DATA_HOME": folder, "XDG_DOCUMENTS_DIR": folder}
        table = {name: measure(level, page) for name, level in levels().items()}
    print(f"{page:16}" + "".join(f"{name:>14}" for name in table))
    for what in next(iter(table.values())):
        print(f"{what:16}" + "".join(f"{figures[what]:14.1f}" for figures in table.values()))


if __name__ == "__main__":
    main()
