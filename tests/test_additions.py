"""What it takes to add something: a copy of the package gets it in as many files as the design says, and plays it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.package_copy import copy_of_the_package

ROOT = Path(__file__).resolve().parents[1]

PLAY = """
from pathlib import Path
from sandbox.level.reading.files import parse_level
from sandbox.physics.step import step
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.reader import read_script
from sandbox.session.compare.comparison import verify
from sandbox.session.session import Session

def level(more=""):
    return (
        '{"format": "spring-sandbox/level", "version": 3, "name": "Two",'
        '"settings": {"solver": "iterative"' + more + '},'
        '"bodies": [{"type": "rope", "id": "r", "start": [0, 0], "end": [2, 0], "segments": 2, "pin": ["start"]}]}'
    ).encode()

def played(level, commands="", ticks=20, undo=False):
    Path("script.jsonl").write_text(commands)
    session = Session(parse_level(level, "level"), read_script("script.jsonl"))
    session.record_to(Path("run.replay"))
    for tick in range(ticks):
        if undo and tick == ticks // 2:
            session.undo()
        session.advance()
    assert not session.messages, session.messages
    session.stop_recording()
    assert verify(read_replay("run.replay")) is None
    assert verify(read_replay("run.replay"), start=0) is None
    return session.world
"""

NUDGE = '''
"""Particles are nudged."""

from dataclasses import dataclass

from sandbox.level.format.quantities import Velocity
from sandbox.physics.world import World
from sandbox.session.commands.command import Command, CommandError
from sandbox.session.commands.named import ParticleSlot, particle_of


@dataclass(frozen=True)
class Nudge(Command):
    """Add to a particle's velocity [m/s]."""

    type = "nudge"
    particle: ParticleSlot
    by: Velocity

    def carry_out(self, world: World, giver: int) -> None:
        if world.inverse_mass[self.particle] == 0.0:
            raise CommandError(f"{particle_of(world, self.particle)} is pinned")
        world.velocity[self.particle] += self.by
'''


TRIANGLE = '''
"""The tool that draws triangles."""

import math
from dataclasses import dataclass

from sandbox.editor.document import Document
from sandbox.editor.edits.placing import add_spring
from sandbox.editor.tools.drawing_options import Options, mass_option
from sandbox.editor.tools.drawing_particles import new_particle
from sandbox.editor.tools.drawing_tool import Drawing
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.snap import Snap


@dataclass(frozen=True)
class TriangleOptions(Options):
    """A triangle."""

    mass: float = mass_option(1.0)


class TriangleDrawing(Drawing[TriangleOptions]):
    """A side from end to end, and a corner on its left."""

    defaults = TriangleOptions()
    start_hint = "Drag along a side"

    def placed(self, document: Document, points: list[Snap]) -> Document:
        (ax, ay), (bx, by) = points[0].point, points[1].point
        high = math.sqrt(0.75)
        top = ((ax + bx) / 2 - (by - ay) * high, (ay + by) / 2 + (bx - ax) * high)
        for at in (*points, Snap(top)):
            document = new_particle(document, at, self.options.mass)
        names = [particle.id for particle in document.level.particles[-3:]]
        for end, other in zip(names, names[1:] + names[:1]):
            document = add_spring(document, end, other)
        return document

    def joins(self, index: int) -> bool:
        return False


TRIANGLE = EditorTool("triangle", "Shift+A", "Triangle", TriangleDrawing)
'''

LIFT = '''
"""LiftTool: a click throws what it hits up."""

from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Command, Push
from sandbox.tools.tool import PlayTool
from sandbox.tools.tool import NOTHING, PlacedTool, PointerEvent, Response, Submission


class LiftTool(PlacedTool):
    """Throw up what is within a circle; size [m]: its radius."""

    def __init__(self, new_gesture):
        self.size, self._new_gesture = 1.0, new_gesture

    def handle(self, event, snapshot):
        if event.kind != "down":
            return NOTHING
        return Response((Submission(Push(event.position, self.size, (0.0, 50.0)), self._new_gesture()),))

    def cancel(self):
        return NOTHING

    def take_up(self, size, height):
        self.size = size

    @property
    def size_to_share(self):
        return self.size

    def resize(self, steps):
        self.size *= 2.0
        return True

    @property
    def ghost(self):
        return [] if self.place is None else [[self.place, (self.place[0], self.place[1] + self.size)]]


LIFT = PlayTool("lift", ("Shift+I",), "Lift: click throws up", "Parts", LiftTool)
'''

GENTLE = '''
"""Gentle: each spring and area gives half of what it gives in the single pass; nothing else acts."""

from sandbox.physics.jit import inner_kernel
from sandbox.physics.solvers.single_pass import apply_explicit, spring_constant

__all__ = ["solve", "spring_constant"]


@inner_kernel
def solve(state, step, inputs, h):
    for p in range(state.velocity.shape[0]):
        step.change[p, 0] = state.velocity[p, 0]
        step.change[p, 1] = state.velocity[p, 1]
    apply_explicit(state, inputs, step, True, h)
    for p in range(state.velocity.shape[0]):
        state.velocity[p, 0] = 0.5 * (state.velocity[p, 0] + step.change[p, 0])
        state.velocity[p, 1] = 0.5 * (state.velocity[p, 1] + step.change[p, 1])
'''

GREET = '''
"""`sandbox greet`."""

from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand
from sandbox.cli.base.inputs import EXIT_OK, Refused, level_of
from sandbox.cli.base.command import argument


@dataclass(frozen=True, kw_only=True)
class GreetOptions:
    level: str = argument(str, "LEVEL")


def greet(options: GreetOptions) -> int:
    level = level_of(options.level)
    if not level.bodies:
        raise Refused(f"{options.level}: there is nobody to greet")
    print(f"Hello, {level.name}")
    return EXIT_OK


COMMAND = Subcommand("greet", "say the name of a level", GreetOptions, greet)
'''

COUNTS = '''
"""CountsPage: how many bodies there are."""

from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.widgets.rows import Row, RowList


class CountsPage(SidePage):
    def __init__(self, screen, place, container):
        self._screen = screen
        self.list = RowList(screen.ui, place, lambda index: None, container)

    def refresh(self):
        self.list.show_rows([Row(f"{len(self._screen.document.level.bodies)} bodies")], 0)
'''

CLOCK = '''
"""ClockRows: how far the run is, and a field that sets gravity upside down."""

from sandbox.app.panel.panel_rows import ROW, PanelSection
from sandbox.session.commands import SetGravity


class ClockRows:
    def __init__(self, panel):
        self.playback = panel.playback

    def build(self, rows):
        self.tick = rows.ui.field(rows.row(ROW, 4), "", lambda text: False, rows.back)
        self.flip = rows.ui.button(rows.row(ROW, 6), "Upside down", self._flip, rows.back)

    def refresh(self, is_look):
        self.tick.show(str(self.playback.session.tick))

    def _flip(self):
        x, y = self.playback.session.world.settings.gravity
        self.playback.submit(SetGravity((x, -y)))


CLOCK = PanelSection("Clock", ClockRows)
'''

# What a script that drives the window begins with.
WINDOW = f"""
import sys
sys.path.append({str(ROOT)!r})
import pytest
from tests.app.conftest import Driver
import pygame
from sandbox.app.base.shortcuts import tip_of
for name in ("user_data_dir", "user_documents_dir", "user_cache_dir"):
    pytest.MonkeyPatch().setattr(f"platformdirs.{{name}}", lambda *_, **__: "person")
driver = Driver(parse_level(level(), "level"))
"""


@pytest.fixture
def package(tmp_path):
    """A copy of the package."""
    return copy_of_the_package(tmp_path)


def with_assets(package):
    """Give the copy the files that the window needs."""
    shutil.copytree(ROOT / "assets", package / "_shipped/assets", dirs_exist_ok=True)


def put(path, text, before=None):
    """Write text into a file: the whole of a new one, before the line that contains `before`, or at the end."""
    if before is None:
        with path.open("a", encoding="utf-8") as file:
            file.write(text)
        return
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    place = next(number for number, line in enumerate(lines) if before in line)
    path.write_text("".join([*lines[:place], text, *lines[place:]]), encoding="utf-8")


def changed(package):
    """Files of the copy that the package does not have, or has otherwise."""
    files = [path.relative_to(package) for path in package.rglob("*.py")]
    original = ROOT / "sandbox"
    return sorted(
        file.as_posix()
        for file in files
        if not (original / file).exists() or (original / file).read_bytes() != (package / file).read_bytes()
    )


def play(package, script):
    """Run a script with the copy, interpreted; whatever it prints."""
    environment = os.environ | {"PYTHONPATH": str(package.parent), "SANDBOX_KERNELS": "interpreted"}
    ended = subprocess.run(
        [sys.executable, "-c", PLAY + script],
        cwd=package.parent, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.strip()


def test_a_command_is_one_file(package):
    put(package / "session/commands/nudging.py", NUDGE)
    script = r"""
line = '{"tick": 3, "command": {"type": "nudge", "particle": "r.end", "by": [0, 5]}}\n'
still, nudged, undone = played(level()), played(level(), line), played(level(), line, undo=True)
assert nudged.position[2, 1] > still.position[2, 1] + 0.1
assert (undone.position == still.position).all()
for name in ("r.start", "nobody"):
    try:
        played(level(), line.replace("r.end", name))
    except ValueError as error:
        print(error)
"""
    assert play(package, script).splitlines() == ["line 1: r.0 is pinned", 'line 1: there is no particle "nobody"']
    assert changed(package) == ["session/commands/nudging.py"]


def test_a_level_setting_is_three_files(package):
    put(package / "physics/settings.py", "    lift: float = 0.0\n", before="    drag: float = 0.0")
    put(
        package / "level/document/model.py",
        '    lift: float = Field(default=0.0, ge=-1e6, le=1e6, description="Acceleration upward.")\n',
        before="    drag: Drag = Field(",
    )
    put(package / "physics/settings.py", "LIFT = 6\n", before="SOLVER, TICK_RATE")
    numbers = "        return (*self.gravity, *self.wind, self.drag, self.warm_start, self.lift)\n"
    put(package / "physics/settings.py", numbers, before="        return (*self.gravity, *self.wind")
    put(
        package / "physics/integrate.py",
        "from sandbox.physics.settings import LIFT\n",
        before="from sandbox.physics.state",
    )
    lifted = "            velocity[p, 1] += numbers[LIFT] * h\n"
    put(package / "physics/integrate.py", lifted, before="            velocity[p, 0] += gravity_x")
    script = """
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import state_hash
from sandbox.physics.world import World
fallen, risen = played(level()), played(level(', "lift": 20'))
assert fallen.position[2, 1] < -0.1 and risen.position[2, 1] > 0.1
assert state_hash(World(WorldSettings(lift=1.0))) != state_hash(World(WorldSettings()))
try:
    parse_level(level(', "lift": 1e7'), "level")
except ValueError as error:
    print(error)
"""
    assert "settings.lift" in play(package, script)
    assert changed(package) == ["level/document/model.py", "physics/integrate.py", "physics/settings.py"]


def test_a_state_array_is_one_line(package):
    line = '    charge = _array("charge", P, F64, "C", "its charge", guarded=True)\n'
    put(package / "physics/state.py", line, before="    particle_a = ")
    script = """
from sandbox.physics.snapshot import hash_by_array, state_hash
world = played(level())
assert world.charge.tolist() == [0.0] * world.particle_count
before = state_hash(world)
world.change("charge", 2.0, 1)
assert state_hash(world) != before and list(hash_by_array(world))[15] == "charge"
"""
    play(package, script)
    assert changed(package) == ["physics/state.py"]


def test_an_editor_tool_is_one_file_and_its_place_in_the_palette(package):
    with_assets(package)
    put(package / "editor/tools/drawing_triangle.py", TRIANGLE)
    palette = package / "editor/tools/palette.py"
    put(palette, "from sandbox.editor.tools.drawing_triangle import TRIANGLE\n", before="import WAVE")
    palette.write_text(palette.read_text(encoding="utf-8").replace(" PIN),", " TRIANGLE, PIN),"))
    script = """
driver.app.documents.new()
driver.frames(2)
driver.click_widget(driver.editor.palette.tools["triangle"])
tools = list(driver.editor.palette.tools)
assert tools[tools.index("triangle") + 1] == "pin"
driver.fill(driver.editor.options.fields["mass"][0], "3")
driver.drag((0, 0), (1, 0), (2, 0))
driver.key(pygame.K_v)
driver.key(pygame.K_a, pygame.KMOD_SHIFT)
driver.drag((-3, 0), (-2, 0))
drawn = driver.editor.document.level
assert [particle.mass for particle in drawn.particles] == [3.0] * 6 and len(drawn.springs) == 6
driver.app.close()
print(tip_of("tool_triangle", "edit"), driver.editor.history.labels, sep="\\n")
"""
    assert play(package, WINDOW + script).splitlines() == [
        "Triangle  [Shift+A]",
        "['New', 'Draw triangle', 'Draw triangle']",
    ]
    assert changed(package) == ["editor/tools/drawing_triangle.py", "editor/tools/palette.py"]


def test_a_tool_in_play_is_one_file_and_its_line_in_the_table(package):
    with_assets(package)
    put(package / "tools/lifting.py", LIFT)
    table = package / "tools/play_tools.py"
    put(table, "from sandbox.tools.lifting import LIFT\n", before="from sandbox.tools.pulling")
    table.write_text(table.read_text(encoding="utf-8").replace("WIND, DELETE", "WIND, LIFT, DELETE"))
    script = """
driver.key(pygame.K_b)
palette = driver.app.play.palette
assert list(palette.buttons).index("lift") + 1 == list(palette.buttons).index("delete")
driver.click_widget(palette.buttons["lift"])
assert driver.stage.tool_name == "lift"
driver.key(pygame.K_i, pygame.KMOD_SHIFT)
assert driver.stage.tool_name == "drag"
driver.key(pygame.K_i, pygame.KMOD_SHIFT)
size = driver.stage.tool.size
driver.app.play.turn_wheel((300, 300), 1)
assert driver.stage.tool.size == 2 * size and driver.stage.size == 2 * size
driver.move(driver.pixel_of("r.end"))
assert driver.stage.tool.ghost and driver.stage.pointed is None
driver.key(pygame.K_0)
assert driver.stage.tool_name == "push" and driver.stage.tool.size == 2 * size
driver.key(pygame.K_i, pygame.KMOD_SHIFT)
driver.click(driver.pixel_of("r.end"))
(entry,) = driver.playback.session.gestures
assert entry.command.type == "push"
driver.app.close()
print(tip_of("tool_lift", "play"))
"""
    assert play(package, WINDOW + script) == "Lift: click throws up  [Shift+I]"
    assert changed(package) == ["tools/lifting.py", "tools/play_tools.py"]


def test_a_solver_is_one_file_its_line_in_the_table_its_name_and_its_branch_of_the_tick(package):
    put(package / "physics/solvers/gentle.py", GENTLE)
    table = package / "physics/solvers/__init__.py"
    settings = package / "physics/settings.py"
    settings.write_text(settings.read_text(encoding="utf-8").replace('"direct"]\n', '"direct", "gentle"]\n', 1))
    put(settings, "GENTLE = 3\n", before="SINGLE_PASS, ITERATIVE, DIRECT")
    tick = package / "physics/pipeline/tick.py"
    put(tick, "from sandbox.physics.settings import GENTLE\n", before="from sandbox.physics.settings import (")
    solve = "from sandbox.physics.solvers.gentle import solve as solve_gently\n"
    put(tick, solve, before="from sandbox.physics.solvers.iterative")
    branch = "    if solver == GENTLE:\n        solve_gently(state, world.explicit, inputs, h)\n        return\n"
    put(tick, branch, before="    if solver == SINGLE_PASS:")
    put(table, '    "gentle": Solver("gentle", proven_limit=False, bounded=False),\n', before='    "direct": Solver(')
    script = """
text = level().replace(b'"iterative"', b'"gentle"')
gentle, single = played(text), played(level().replace(b'"iterative"', b'"single_pass"'))
assert gentle.settings.solver == "gentle" and (gentle.position != single.position).any()
try:
    parse_level(level().replace(b'"iterative"', b'"gentler"'), "level")
except ValueError as error:
    print(error)
"""
    assert "gentle" in play(package, script)
    parts = ["pipeline/tick.py", "settings.py", "solvers/__init__.py", "solvers/gentle.py"]
    assert changed(package) == [f"physics/{part}" for part in parts]


def test_a_command_of_the_shell_is_one_file_and_its_name_in_the_table(package):
    put(package / "cli/greet.py", GREET)
    table = package / "cli/__init__.py"
    put(table, "    greet,\n", before="    play,")
    table.write_text(table.read_text(encoding="utf-8").replace("in (play, toy", "in (greet, play, toy"))
    script = """
from sandbox.cli import main
Path("two.json").write_bytes(level())
Path("none.json").write_text('{"format": "spring-sandbox/level", "version": 3, "name": "Nobody"}')
assert main(["greet", "two.json"]) == 0 and main(["greet", "none.json"]) == 2
"""
    assert play(package, script) == "Hello, Two"
    assert changed(package) == ["cli/__init__.py", "cli/greet.py"]


def test_a_page_of_the_editors_side_is_one_file_and_its_line_in_the_table(package):
    with_assets(package)
    put(package / "app/edit/side/counts.py", COUNTS)
    side = package / "app/edit/side/side.py"
    put(side, "from sandbox.app.edit.side.counts import CountsPage\n", before="import FindingsPage")
    put(side, '    "counts": ("Counts", "How many there are", CountsPage),\n', before='    "history": ("History"')
    script = """
driver.app.documents.edit_level(parse_level(level(), "level"))
driver.frames(2)
side = driver.editor.side
driver.click_widget(side._tab_button("counts"))
print(side.page.list.rows[0].text)
driver.key(pygame.K_TAB, pygame.KMOD_CTRL)
print(side.tab)
driver.app.close()
"""
    assert play(package, WINDOW + script).splitlines() == ["1 bodies", "history"]
    assert changed(package) == ["app/edit/side/counts.py", "app/edit/side/side.py"]


def test_a_section_of_the_play_panel_is_one_file_and_its_line_in_the_table(package):
    with_assets(package)
    put(package / "app/panel/clock_rows.py", CLOCK)
    panel = package / "app/panel/panel.py"
    put(panel, "from sandbox.app.panel.clock_rows import CLOCK\n", before="import STIFFNESSES")
    put(panel, '    "clock": CLOCK,\n', before='    "world": PanelSection(')
    script = """
panel = driver.panel
assert not panel.is_open("more") and not panel.sections["clock"].flip.visible
low = panel.rows.y
driver.app.play.fold("more")
driver.frames(2)
assert driver.panel.sections["clock"].flip.visible and driver.panel.rows.y > low
rows = driver.panel.sections["clock"]
before = driver.world.settings.gravity
driver.app.ui.focus_on(rows.flip)
driver.key(pygame.K_RETURN)
driver.frames(2)
assert driver.world.settings.gravity == (before[0], -before[1]), driver.world.settings.gravity
assert int(rows.tick.text) == driver.playback.session.tick
driver.app.close()
print("played")
"""
    assert play(package, WINDOW + script) == "played"
    assert changed(package) == ["app/panel/clock_rows.py", "app/panel/panel.py"]
