"""Writes docs/gallery.md: each shipped level with its picture, what to do with it, and the command that opens it."""

import textwrap
from pathlib import Path

import pygame

from sandbox.app.base.shortcuts import hint
from sandbox.app.draw.picture import crop_of, draw_picture
from sandbox.app.gallery.sections import SECTIONS
from sandbox.level.reading.files import load_level
from sandbox.session.session import Session
from tests.pictures.photographer import DOCS, write_small

PAGE, FOLDER = DOCS / "gallery.md", DOCS / "gallery"
SIZE = (480, 270)
# Drawn so much larger, with lines of this thickness.
LARGER, LINE_SCALE = 2, 1.2
# When a level is at its best [s], and which are drawn in the light theme; the others after a usual time, dark.
USUAL = 1.2
MOMENTS = {
    "beating_heart": 0.4, "breaking_bridge": 2.0, "catapult": 0.5, "curtain": 2.0, "dominoes": 1.6, "hourglass": 3.0,
    "jelly_pile": 1.0, "marble_mill": 4.0, "newtons_cradle": 0.9, "pinball": 1.5, "quad_mesh": 2.0, "rope": 0.8,
    "rope_bridge_wheel": 5.0, "side_by_side": 0.3, "suspension_car": 3.5, "truck_bridge": 3.0, "trampoline": 1.3,
    "sorting_belt": 3.0, "tumble_drum": 3.0, "walker": 3.0, "wrecking_ball": 2.7, "wrecking_crane": 1.9,
}  # fmt: skip
LIGHT = frozenset({
    "truck_bridge", "balloons", "pinball", "curtain", "catapult", "walker", "beating_heart", "suspension_car",
    "ferris_wheel", "dominoes", "rope_bridge_wheel", "hourglass", "suspension_bridge", "truss_bridge",
})  # fmt: skip


OPENING = (
    "The {} levels that come with Spring Sandbox. A command opens one; `sandbox` alone shows them all, and "
    "`sandbox edit NAME` opens a copy in the editor. In a level, F2 says what it is about, and R begins it again."
)


def _wrapped(text: str) -> str:
    return textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False)


def page() -> str:
    """The text of the page."""
    count = sum(len(section.levels) for section in SECTIONS)
    lines = ["# Gallery", "", _wrapped(OPENING.format(count))]
    for section in SECTIONS:
        lines += ["", f"## {section.title}", "", section.line]
        for name, deed in section.levels.items():
            level = load_level(name)
            about = _wrapped(f"{deed}. {hint(level.description)}")
            picture = f"![{level.name}](gallery/{name}.png)"
            lines += ["", f"### {level.name}", "", picture, "", about, "", "```sh", f"sandbox play {name}", "```"]
    lines += ["", "The pictures are drawn by `make pictures`."]
    return "\n".join(lines) + "\n"


def picture_of(name: str) -> Path:
    """The file of a level's picture."""
    return FOLDER / f"{name}.png"


def drawn(name: str) -> pygame.Surface:
    """A level at its best."""
    session = Session(load_level(name))
    for _ in range(round(MOMENTS.get(name, USUAL) * session.level.settings.tick_rate)):
        session.advance()
    now = session.snapshot()
    size = LARGER * SIZE[0], LARGER * SIZE[1]
    theme = "light" if name in LIGHT else "dark"
    return draw_picture(session.level, now, size, crop_of(session.level, now), LINE_SCALE, theme)


def draw() -> None:
    """Write the page and draw its pictures."""
    PAGE.write_text(page(), encoding="utf-8")
    wanted = [name for section in SECTIONS for name in section.levels]
    for path in FOLDER.glob("*.png"):
        if path.stem not in wanted:
            path.unlink()
    for name in wanted:
        write_small(drawn(name), picture_of(name), SIZE)
