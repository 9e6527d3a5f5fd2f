"""The editor in a real window, by mouse: levels from an empty sheet, saved; the last reopened, played, verified.

Only names of files are typed. SANDBOX_PICTURES names a folder that keeps a picture of each stage.
"""

import os
import shutil

import pytest

from sandbox.app.base.display import WINDOW_SIZE
from sandbox.app.base.shortcuts import tip_of
from sandbox.level.reading.files import read_level
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.support.person import DEADLINE, Person, needs_a_screen
from tests.support.wholes import part_and_whole

pytestmark = needs_a_screen

# What was drawn rests where it moves less than this in so many ticks [m], and does so before the last of these.
STILL, REST_TICKS, LAST = 0.03, 60, 900


class Maker:
    """A person who builds, and a twin of the app without a display that is led the same way.

    The twin says where things are, and its level is what the person's should be.
    """

    def __init__(self, person, twin, folder):
        self.person, self.twin, self.folder = person, twin, folder
        self.stages = 0

    def picture(self, name):
        """Keep what is seen now."""
        self.stages += 1
        self.person.screen.save(self.folder / f"{self.stages:02} {name}.png")

    def place(self, action):
        """Where the button of an action is."""
        tip = tip_of(action, self.twin.app.mode)
        return next(button for button in self.twin.app.ui.buttons() if button.tip == tip).rect.center

    def place_of_label(self, label):
        """Where the button of that label is, on the page that is open."""
        return next(button for button in self.twin.app.ui.buttons() if button.text == label).rect.center

    def press(self, action):
        """Click the button of an action."""
        self.person.click(self.place(action))

    # Building: the same with both.

    def take(self, tool):
        """Take a tool of the palette up."""
        self.press(f"tool_{tool}")
        self.twin.app.act(f"tool_{tool}")
        self.twin.frames(2)
        self.person.wait_for(f"editing - {tool}")

    def draw(self, *points):
        """Drag from the first of points [m] to the last."""
        pixels = [self.twin.at(*point) for point in points]
        self.person.move(pixels[0])
        self.person.seen("mousedown", 1, patience=1.0)
        for pixel in pixels[1:]:
            self.person.move(pixel)
        self.person.do("mouseup", 1)
        self.twin.drag(*points)
        self.person.wait_for("*", "selected")

    def click(self, point):
        """Click a point [m] of the level."""
        particles = self.twin.editor.scene.position
        self.person.click(self.twin.at(*point))
        self.twin.click_at(*point)
        assert len(self.twin.editor.scene.position) == len(particles) + 1

    def outline(self, *corners):
        """Click corners [m] of terrain, and the first of them again."""
        for corner in (*corners, corners[0]):
            self.person.click(self.twin.at(*corner))
            self.twin.click_at(*corner)
        self.person.wait_for("*", "selected")

    def turn(self, option, notches):
        """Turn the wheel over an option of the tool."""
        field = self.twin.editor.options.fields[option][0]
        self.person.move(field.rect.center)
        self.twin.move(field.rect.center)
        for _ in range(abs(notches)):
            assert self.person.seen("click", 4 if notches > 0 else 5)
            field.step(1 if notches > 0 else -1)

    def choose_material(self, name):
        """Open the menu of materials and take one."""
        picker = self.twin.editor.options.pickers["material"]
        self.person.click(picker.rect.center)
        self.twin.click_widget(picker)
        menu = self.twin.app.ui.focus
        index = [row.text for row in menu.rows].index(name)
        row = menu.rect.left + 20, menu.rect.top + menu.rect.height * (index + 0.5) / len(menu.rows)
        self.person.click(row)
        self.twin.click(row)

    # Files.

    def save(self, name):
        """Save under a name, typed into the box that asks for it."""
        self.press("save")
        self.person.wait_for("dialog")
        self.twin.app.act("save")
        self.twin.frames(2)
        self.person.do("type", name)
        self.picture("name")
        self.person.click(self.place_of_label("Save"))
        self.twin.type(name)
        self.twin.choose("Save")
        self.person.wait_for(f"{name} - Level editor", without="dialog")

    def begin(self):
        """Begin a new level."""
        self.press("new")
        self.twin.app.act("new")
        self.twin.frames(2)

    def reopen(self, name):
        """Open a saved level among the person's own."""
        self.press("open")
        self.person.wait_for("Levels")
        self.twin.app.act("open")
        self.twin.frames(2)
        self.person.click(self.place_of_label("My levels"))
        self.twin.choose("My levels")
        self.person.wait_for("My levels")
        self.picture("my levels")
        card = self.twin.app.gallery.cards[0]
        self.person.click(card.rect.center)
        self.twin.click_widget(card)
        self.person.wait_for(f"{name} - Level editor")
        self.picture(f"{name} reopened")

    def record(self, name, particle):
        """Play until all rests, record a drag of a particle, name the recording, and go back to the sheet."""
        self.press("play")
        self.person.wait_for("tick", "playing")
        self.twin.app.act("play")
        # Nobody sees the twin: it draws what has come to rest alone.
        advance_to_rest(self.twin.playback.session)
        self.twin.frames(2)
        self.person.wait_for_tick(self.twin.playback.session.tick)
        self.person.do("key", "ctrl+r")
        self.person.wait_for("recording")
        x, y = self.twin.pixel_of(particle)
        self.person.drag([(x, y), *((x + 12 * k, y - 10 * k) for k in range(7))], while_held="holding 1")
        self.picture(f"{name} played")
        self.person.do("key", "ctrl+r")
        self.person.wait_for("dialog")
        self.person.do("type", name)
        self.twin.app.act("record")
        self.twin.app.act("record")
        self.twin.frames(2)
        self.picture("name the recording")
        self.person.click(self.place_of_label("Save"))
        self.person.wait_for(name, without="dialog")
        self.twin.key(27)
        self.press("edit")
        self.twin.app.act("edit")
        self.twin.frames(2)
        self.person.wait_for(f"{name} - Level editor")


def advance_to_rest(session):
    """Advance a run until nothing in it moves any more to speak of."""
    moved = STILL
    while moved >= STILL:
        assert session.tick < LAST
        before = session.world.position.copy()
        for _ in range(REST_TICKS):
            session.advance()
        moved = abs(session.world.position - before).max()


def draw_rope(maker):
    maker.take("rope")
    maker.draw((0.0, 4.0), (0.0, 2.5), (0.0, 1.0))
    maker.take("particle")
    maker.turn("mass", 4)
    maker.turn("radius", 2)
    maker.click((0.0, 1.0))
    return "particle"


def draw_bridge(maker):
    maker.take("bridge")
    maker.draw((-4.0, 1.0), (0.0, 1.0), (4.0, 1.0))
    maker.take("particle")
    maker.turn("mass", 5)
    maker.turn("radius", 2)
    maker.click((0.0, 1.0))
    assert maker.twin.editor.document.level.particles[0].mass == 50.0
    return "particle"


def draw_wheel(maker):
    maker.take("ground")
    maker.outline((-4.0, -0.5), (4.0, -0.5), (4.0, 1.0), (-4.0, 0.5))
    maker.take("circle")
    maker.choose_material("rubber")
    maker.draw((0.0, 3.0), (1.0, 3.0), (1.5, 3.0))
    maker.take("pin")
    maker.person.click(maker.twin.at(0.0, 3.0))
    maker.twin.click_at(0.0, 3.0)
    (wheel,) = maker.twin.editor.document.level.bodies
    assert (wheel.type, wheel.material, len(wheel.pinned)) == ("jelly", "rubber", 1)
    *_, ground = maker.twin.editor.document.level.terrain
    assert len(ground.polygon) == 4
    scene = maker.twin.editor.scene
    return scene.names(int(scene.position[:, 0].argmax()))


BUILDS = {"pinned rope": draw_rope, "loaded bridge": draw_bridge, "jelly wheel": draw_wheel}


@pytest.fixture
def maker(screen, tmp_path, edit):
    """A person before a new place."""
    twin = edit()
    twin.app.display.window.size = WINDOW_SIZE
    twin.frames(2)
    twin.app.guide.may_offer = True
    twin.app.documents.new_place()
    twin.frames(2)
    folder = tmp_path / "person"
    (folder / "pictures").mkdir(parents=True)
    person = Person(screen, ["edit"], folder)
    yield Maker(person, twin, folder / "pictures")
    person.app.kill()
    if os.environ.get("SANDBOX_PICTURES"):
        shutil.copytree(folder / "pictures", os.environ["SANDBOX_PICTURES"], dirs_exist_ok=True)


@pytest.mark.slow
@pytest.mark.parametrize("names", part_and_whole(["jelly wheel"], list(BUILDS)))
def test_levels_are_built_by_mouse_and_saved_and_one_is_reopened_and_played_and_its_recording_verifies(maker, names):
    documents = maker.folder.parent / "documents" / "Spring Sandbox"
    # What was drawn in the plain way until then changes once, which is no answer to the person.
    maker.person.wait_for("Untitled - Level editor")
    maker.picture("the tour is offered")
    maker.person.click(maker.place_of_label("Skip"))
    maker.twin.choose("Skip")
    for name in names:
        particle = BUILDS[name](maker)
        maker.picture(name)
        maker.save(name)
        drawn = maker.twin.editor.document.level
        assert read_level(documents / f"{name}.json") == drawn
        maker.begin()
    maker.reopen(name)
    maker.record(name, particle)
    recording = documents / f"{name}.replay.jsonl"
    replay = read_replay(recording)
    assert replay.level == drawn and verify(replay) is None
    assert {line.record["type"] for line in replay.script} >= {"grab", "release"}
    maker.person.do("key", "ctrl+q")
    assert maker.person.app.wait(DEADLINE) == 0
