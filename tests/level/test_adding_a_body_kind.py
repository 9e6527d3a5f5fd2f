"""A body kind is two new files and a line in two tables: one is added to a copy of the package, and played."""

import os
import subprocess
import sys

import pytest

from tests.support.package_copy import copy_of_the_package

LEVEL_KIND = '''
"""Ladder: two rows that rungs join."""

from functools import cached_property
from typing import Literal

import numpy as np
from pydantic import Field

from sandbox.level.format.quantities import Mass, Point, Size
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.geometry import Pairs, Points


class LadderDef(BodyDef):
    """A strip of square cells that hang from the first rung."""

    type: Literal["ladder"] = Field(description="Kind of body.")
    position: Point = Field(default=(0.0, 0.0), description="Place of the left end of the first rung.")
    width: Size = Field(description="Length of a rung.")
    segments: int = Field(ge=1, description="Number of cells.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    pin: tuple[Literal["top"], ...] = Field(default=(), max_length=1, description="The first rung is held.")


class Ladder(Expansion[LadderDef]):
    """Rung by rung from the top."""

    model = LadderDef
    plural = "ladders"
    generation = "- Ladder: rung by rung from the top. Springs: rungs, left rail, right rail."

    @property
    def form_count(self) -> tuple[int, int]:
        return 2 * self.body.segments + 2, 3 * self.body.segments + 1

    @cached_property
    def local_form(self) -> tuple[Points, Pairs]:
        rung = np.arange(self.body.segments + 1)
        left = np.stack([0.0 * rung, -self.body.width * rung], axis=1)
        places = np.stack([left, left + [self.body.width, 0.0]], axis=1).reshape(-1, 2)
        rungs = np.stack([2 * rung, 2 * rung + 1], axis=1)
        rails = [np.stack([2 * rung[:-1] + side, 2 * rung[1:] + side], axis=1) for side in (0, 1)]
        return places, np.concatenate([rungs, *rails])

    @property
    def named_particles(self) -> dict[str, int]:
        return {"foot": 2 * self.body.segments}

    def named_pins(self) -> list[int]:
        return [0, 1] if self.body.pin else []
'''

EDITOR_KIND = '''
"""Ladders in the editor."""

from dataclasses import dataclass
from typing import Any, ClassVar

from sandbox.editor.kinds.editing import BodyEditing
from sandbox.editor.kinds.editing import PlaneMap
from sandbox.editor.tools.drawing_bodies import BodyDrawing, length
from sandbox.editor.tools.drawing_options import BodyOptions, count_option, mass_option, material_option
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.kinds.ladder import LadderDef


@dataclass(frozen=True)
class LadderOptions(BodyOptions):
    """A ladder."""

    segments: int = count_option("cells", "Number of cells.", 1, 4)
    particle_mass: float = mass_option(1.0)
    material: str = material_option()


class LadderDrawing(BodyDrawing[LadderOptions]):
    """A ladder along its first rung."""

    defaults = LadderOptions()
    kind = "ladder"
    counted = "segments"

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        return {"position": points[0].point, "width": length(points), "segments": self.options.segments}


class LadderEditing(BodyEditing[LadderDef]):
    """A ladder hangs straight down."""

    tools: ClassVar = (EditorTool("ladder", "Shift+K", "Ladder", LadderDrawing),)
    formless = frozenset({"particle_mass", "pin"})

    def mapped(self, motion: PlaneMap) -> dict[str, Any]:
        return {"position": motion.point(self.body.position), "width": self.body.width * motion.factor}
'''

PLAY = """
import json

from sandbox import build_world, step
from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.moving import move
from sandbox.editor.items import items_of
from sandbox.editor.scene import make_scene
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.parse import parse_level
from sandbox.level.reference import format_reference
from sandbox.level.document.schema import schema

body = {"type": "ladder", "id": "l", "width": 0.5, "segments": 3, "pin": ["top"]}
level = {"format": "spring-sandbox/level", "version": 3, "name": "A ladder", "bodies": [body]}
level["checks"] = [{"name": "it hangs", "metric": "y", "particle": "l.foot", "after": 1, "at_least": -3}]
level = parse_level(json.dumps(level).encode(), "x.json")
assert parse_level(level_text(level).encode(), "x.json") == level

world = build_world(level)
for _ in range(5):
    step(world)
foot = world.particle_slot("l.foot")
assert world.position[foot, 1] < -1.5
assert (world.position[:2, 1] == 0.0).all()

assert schema()["$defs"]["LadderDef"]["title"] == "Ladder"
assert "## Ladder" in format_reference() and "- Ladder: rung by rung" in format_reference()

document = Document(level, frozenset(items_of(level)))
assert make_scene(move(document, 1.0, 2.0).level).bounds() == (1.0, 0.5, 1.5, 2.0)
drawing = TOOLS["ladder"].drawing()
drawing.down(Snap((0.0, 0.0)))
drawing.up(Snap((1.0, 0.0)))
drawn = drawing.done(Document(empty_level())).level
assert (drawn.bodies[0].type, build_world(drawn).particle_slot("ladder.9")) == ("ladder", 9)
print("played")
"""


def inserted(path, line, addition):
    """Put an addition before a line of a file, which is there once."""
    text = path.read_text(encoding="utf-8")
    assert text.count(line) == 1
    path.write_text(text.replace(line, addition + line), encoding="utf-8")


@pytest.fixture
def package(tmp_path):
    """A copy of the package."""
    return copy_of_the_package(tmp_path)


def test_a_body_kind_of_four_files_is_read_played_moved_drawn_and_documented(package):
    before = {path: path.read_bytes() for path in package.rglob("*.py")}
    (package / "level/kinds/ladder.py").write_text(LEVEL_KIND.lstrip(), encoding="utf-8")
    (package / "editor/kinds/ladder.py").write_text(EDITOR_KIND.lstrip(), encoding="utf-8")
    models, editing = package / "level/kinds/bodies.py", package / "editor/kinds/table.py"
    inserted(models, "from sandbox.level.kinds.mesh import", "from sandbox.level.kinds.ladder import Ladder\n")
    inserted(models, "Mesh)", "Ladder, ")
    inserted(
        editing, "from sandbox.editor.kinds.mesh import", "from sandbox.editor.kinds.ladder import LadderEditing\n"
    )
    inserted(editing, '    "mesh":', '    "ladder": LadderEditing,\n')
    changed = [path for path in package.rglob("*.py") if before.get(path) != path.read_bytes()]
    assert len(changed) == 4

    # The kernels of a copy are not worth compiling for five ticks.
    environment = os.environ | {"PYTHONPATH": str(package.parent), "SANDBOX_KERNELS": "interpreted"}
    ended = subprocess.run(
        [sys.executable, "-c", PLAY], cwd=package.parent, env=environment, capture_output=True, text=True, check=False
    )
    assert ended.stdout == "played\n", ended.stderr
