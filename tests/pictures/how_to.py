"""Draws the pictures of README and of the how-tos: what these pages describe, done in a window that nobody sees."""

from contextlib import closing

import numpy as np
import pygame

from sandbox.app.panel.sweeps.sweep_chart import draw_map
from sandbox.level.reading.files import load_level
from sandbox.processors import cores
from sandbox.session.sweep.grid import SweepGrid
from sandbox.session.sweep.running import swept
from tests.pictures.photographer import DOCS, ROOT, Photographer, write_small
from tests.support.machines import build_car, build_chain, build_walker

FOLDER, BUILT = DOCS / "how-to", DOCS / "built-by-mouse"
# What is drawn on a sheet: corners of solid ground, and tools, each from where to where it is dragged [m].
SOLID = ((-6.0, -3.5), (-3.5, -3.5), (-3.5, -0.5), (-6.0, -0.5)), ((3.5, -3.5), (6.0, -3.5), (6.0, -0.5), (3.5, -0.5))
DRAWN = (
    ("tool_bridge", (-3.5, -0.5), (3.5, -0.5)), ("tool_box", (-2.0, 1.5), (-0.5, 2.7)),
    ("tool_circle", (1.6, 2.0), (2.3, 2.0)),
)  # fmt: skip
# What a rope is swept over.
SWEPT = {
    "settings.solver": ("single_pass", "iterative", "direct"), "cs": tuple(map(float, np.geomspace(0.001, 1.0, 16))),
    "cd": tuple(map(float, np.linspace(0.0, 1.0, 12))),
}  # fmt: skip


def _played(level: str, ticks: int) -> Photographer:
    driver = Photographer(load_level(level))
    driver.app._describe("")
    driver.frames(ticks)
    return driver


def design() -> None:
    """What a designer does: plays, looks inside, compares."""
    driver = _played("jelly_pile", 70)
    driver.take(ROOT / "assets" / "screenshot.png")
    driver.frames(120)
    driver.app.act("palette")
    driver.app.act("tool_balloon")
    driver.move(driver.stage.camera.to_pixels((0.0, 5.0)))
    driver.take(FOLDER / "parts.png")
    driver.app.close()
    driver = _played("truck_bridge", 170)
    driver.app.act("lattice")
    driver.take(FOLDER / "strain.png")
    driver.app.close()
    driver = _played("jelly_cube", 30)
    driver.app.act("compare")
    driver.frames(3)
    driver.app._notices.clear()
    driver.choose("B")
    driver.fill(driver.panel.form.fields["stiffness"][0], "0.02")
    driver.frames(60)
    driver.take(FOLDER / "compare.png")
    driver.app.close()


def build() -> None:
    """What a maker of levels does: draws, plays, checks."""
    driver = Photographer(load_level("rope"))
    driver.app._describe("")
    driver.app.documents.new()
    driver.frames(3)
    for corners in SOLID:
        driver.app.act("tool_ground")
        for corner in corners:
            driver.click_at(*corner)
        driver.key(pygame.K_RETURN)
    for tool, start, end in DRAWN:
        driver.app.act(tool)
        driver.drag(start, end)
    driver.app.act("cancel")
    driver.app.act("tool_select")
    driver.click_at(-1.2, 2.1)
    driver.take(FOLDER / "sheet.png")
    driver.take(ROOT / "assets" / "editor.png")
    driver.app.act("play")
    driver.frames(100)
    driver.take(FOLDER / "try.png")
    driver.app.close()


def machines() -> None:
    """What a maker of machines does: a car that crosses a bridge, a jelly that walks, and a chain."""
    built = (
        ("car", build_car, pygame.K_d, 105), ("walker", build_walker, None, 200), ("chain", build_chain, None, 160),
    )  # fmt: skip
    for name, make, key, ticks in built:
        driver = Photographer(load_level("rope"))
        driver.app._describe("")
        driver.app.documents.new()
        driver.frames(3)
        make(driver)
        driver.app._notices.clear()
        driver.take(BUILT / f"{name}-sheet.png")
        driver.app.act("play")
        driver.frames(2)
        if key is not None:
            driver.post(pygame.KEYDOWN, key=key, mod=0, unicode="")
        driver.frames(ticks)
        driver.app._notices.clear()
        driver.take(BUILT / f"{name}-play.png")
        driver.app.close()


def test() -> None:
    """What a tester does: goes back and forth in a run, and keeps it."""
    driver = _played("wrecking_crane", 60)
    driver.app.act("timeline")
    driver.frames(60)
    driver.throw(driver.world.particle_names[-1], (-2.0, 3.0))
    driver.frames(90)
    driver.app.act("bookmark")
    driver.take(FOLDER / "timeline.png")
    driver.app.close()


def sweep() -> None:
    """What a tester looks up: how a rope does with each Cs and Cd."""
    grid = SweepGrid(load_level("rope"), SWEPT, 600)
    with closing(swept(grid, [], cores())) as rows:
        known = dict(rows)
    picture = FOLDER / "sweep.png"
    draw_map(grid, known, ["max_strain", "check: the rope hardly stretches"], picture)
    write_small(pygame.image.load(picture), picture, pygame.image.load(picture).get_size())


def draw() -> None:
    """Draw them all."""
    sweep()
    design()
    build()
    machines()
    test()
