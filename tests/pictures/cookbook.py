"""Writes docs/cookbook.md: each level of docs/cookbook with its picture, its text and its file."""

import json
import textwrap
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pygame
from PIL import Image

from sandbox.app.draw.camera import Box
from sandbox.app.draw.picture import draw_picture, view_of
from sandbox.level.document.model import Level
from sandbox.level.reading.files import read_level
from sandbox.level.reference import anchor
from sandbox.session.check_run import HeldKeys
from sandbox.session.session import Session
from tests.pictures.photographer import DOCS, ROOT

PAGE, FOLDER = DOCS / "cookbook.md", DOCS / "cookbook"
SIZE = (480, 270)
# Drawn so much larger, with lines of this thickness; quality of the file.
LARGER, LINE_SCALE, QUALITY = 2, 1.2, 82


@dataclass(frozen=True)
class Recipe:
    """When a level is at its best [s], and the theme of its picture."""

    moment: float
    theme: str = "dark"


# The recipes, by the names of their files, in the order of the page.
SECTIONS: dict[str, dict[str, Recipe]] = {
    "Bodies": {
        "hanging_rope": Recipe(20.0),
        "bending": Recipe(0.9),
        "breaking_bridge": Recipe(1.45, "light"),
        "jelly_box": Recipe(0.7),
        "rolling": Recipe(1.2, "light"),
        "pinned_web": Recipe(1.0),
        "area": Recipe(2.0),
        "mesh": Recipe(0.75, "light"),
    },
    "Materials": {
        "firmness": Recipe(3.0),
        "yield": Recipe(2.2, "light"),
        "loose_springs": Recipe(0.9),
    },
    "Machines": {
        "motor_and_keys": Recipe(0.9, "light"),
        "hydraulic": Recipe(1.5, "light"),
        "muscle": Recipe(0.5),
        "conveyor": Recipe(2.0, "light"),
    },
    "World": {
        "terrain_gaps": Recipe(1.05, "light"),
        "friction": Recipe(1.2, "light"),
        "belts": Recipe(1.2),
        "walls": Recipe(1.9),
        "groups": Recipe(0.9),
        "buoyancy": Recipe(0.95, "light"),
        "wind": Recipe(1.5, "light"),
    },
    "Checks, looks and data": {
        "check": Recipe(2.0, "light"),
        "check_keys": Recipe(1.75, "light"),
        "skins": Recipe(2.0),
        "pictures": Recipe(0.7, "light"),
        "camera_follows": Recipe(2.5, "light"),
        "extras": Recipe(1.0, "light"),
    },
}
RECIPES = {name: recipe for section in SECTIONS.values() for name, recipe in section.items()}
OPENING = """\
# Cookbook

Small levels, one for each subject. Copy one into a file, or play it where it is:

```sh
sandbox play docs/cookbook/hanging_rope.json
```

The [level format](level-format.md) explains every field, and [How to make a level](how-to-levels.md) does the same by
mouse. The program's own levels are in the [gallery](gallery.md).
"""


def path_of(name: str) -> Path:
    """The level file of a recipe."""
    return FOLDER / f"{name}.json"


def page() -> str:
    """The text of the page."""
    lines = [OPENING]
    levels = {name: read_level(path_of(name)) for name in RECIPES}
    for title, recipes in SECTIONS.items():
        links = ", ".join(f"[{levels[name].name}](#{anchor(levels[name].name)})" for name in recipes)
        lines.append(textwrap.fill(f"- {title}: {links}", 120, subsequent_indent="  ", break_on_hyphens=False))
    for title, recipes in SECTIONS.items():
        lines += ["", f"## {title}"]
        for name in recipes:
            lines += ["", *_entry(name, levels[name])]
    lines += ["", "`make pictures` draws the pictures."]
    return "\n".join(lines) + "\n"


def _entry(name: str, level: Level) -> list[str]:
    """The lines of a recipe: its text stands above the file, and not in it."""
    text = path_of(name).read_text(encoding="utf-8").replace(
        f'  "description": {json.dumps(level.description, ensure_ascii=False)},\n', ""
    )  # fmt: skip
    about = textwrap.fill(level.description, 120, break_long_words=False, break_on_hyphens=False)
    picture = f"![{level.name}](cookbook/{name}.webp)"
    command = f"```sh\nsandbox play {path_of(name).relative_to(ROOT).as_posix()}\n```"
    return [f"### {level.name}", "", picture, "", about, "", command, "", f"```json\n{text}```"]


def picture_of(name: str) -> Path:
    """The file of a recipe's picture."""
    return FOLDER / f"{name}.webp"


def at_best(name: str) -> tuple[Session, Box]:
    """A run of a level at its best, with the keys held that its checks hold, and the frame [m] of its picture."""
    session = Session(read_level(path_of(name)))
    level = session.level
    keys = HeldKeys(level, [hold for check in level.checks for hold in check.hold])
    box, followed = np.array(view_of(level, session.snapshot())), _followed(session)
    for _ in range(round(RECIPES[name].moment * level.settings.tick_rate)):
        keys.press(session)
        session.advance()
    left, bottom, right, top = (box + np.tile(_followed(session) - followed, 2)).tolist()
    return session, (left, bottom, right, top)


def drawn(name: str) -> pygame.Surface:
    """The picture of a recipe, in its large size."""
    session, box = at_best(name)
    size = LARGER * SIZE[0], LARGER * SIZE[1]
    return draw_picture(session.level, session.snapshot(), size, box, LINE_SCALE, RECIPES[name].theme)


def _followed(session: Session) -> np.ndarray:
    """Where [m] what the camera follows is; where nothing is followed, always the same place."""
    name, world = session.level.look.follow if session.level.look is not None else None, session.world
    if name is None:
        return np.zeros(2)
    slots = [slot for slot, each in enumerate(world.particle_names) if each.split(".")[0] == name]
    return world.position[slots].mean(axis=0)


def draw() -> None:
    """Write the page and draw its pictures."""
    PAGE.write_text(page(), encoding="utf-8")
    for path in FOLDER.glob("*.webp"):
        if path.stem not in RECIPES:
            path.unlink()
    for name in RECIPES:
        surface = drawn(name)
        picture = Image.frombytes("RGB", surface.get_size(), pygame.image.tobytes(surface, "RGB"))
        picture.resize(SIZE, Image.Resampling.LANCZOS).save(picture_of(name), quality=QUALITY, method=6)
