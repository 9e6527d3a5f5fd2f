"""Between editing and playing: one key there and back, and what is kept of a run."""

from dataclasses import replace

import numpy as np
import pygame
import pytest

from sandbox.editor.edits.placing import set_pinned
from sandbox.level.document.model import WallsDef
from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import write_level
from sandbox.session.commands import CutSprings, SetCoefficients
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.app.conftest import small_level

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


@pytest.fixture
def driver(edit):
    return edit(small_level(settings={"solver": "direct"}))


def test_e_plays_the_document_from_its_beginning_and_comes_back_to_it_untouched(driver):
    editor, document = driver.editor, driver.editor.document
    driver.key(pygame.K_e)
    assert driver.app.mode == "play" and driver.playback.level is document.level
    driver.frames(30)
    assert driver.playback.session.tick > 10
    driver.key(pygame.K_e)
    assert driver.app.screen is editor and editor.document is document
    assert editor.history.labels == ["Open"]
    driver.key(pygame.K_e)
    assert driver.playback.session.tick < 10


@pytest.mark.parametrize(
    "action", ["next_mark", "bookmark", "branches", "pick", "touching", "bring_back", "free", "follow"]
)
def test_a_line_about_a_run_ends_where_the_sheet_is_shown_again(driver, action):
    driver.key(pygame.K_e)
    driver.app.act(action)
    assert len(driver.notices) == 1
    driver.key(pygame.K_e)
    assert driver.notices == []


def test_a_line_about_the_sheet_ends_where_it_is_played(driver):
    driver.key(pygame.K_z, CTRL)
    assert driver.notices == ["There is nothing to undo."]
    driver.key(pygame.K_e)
    assert driver.notices == []


def test_what_is_being_typed_is_in_the_run_and_is_asked_about_before_it_is_left(driver):
    editor = driver.editor
    editor.side.choose("level")
    for name, leave in (("Ann", driver.app.documents.play), ("Bea", driver.app.documents.new)):
        driver.app.ui.focus_on(editor.side.page.form.fields["author"][0])
        driver.type(name)
        leave()
        driver.frames(2)
        assert editor.document.level.author == name
        if leave == driver.app.documents.play:
            assert driver.playback.level.author == name and editor.side is None
            driver.app.documents.back()
            editor.history.mark_saved()
    assert driver.app.ui.has_question and driver.editor is editor and editor.side.tab == "level"


def test_the_picture_stays_where_it_is_when_playing_begins(driver):
    camera = driver.editor.camera
    before = camera.to_pixels((1, 1))
    driver.key(pygame.K_e)
    assert driver.stage.camera.to_pixels((1, 1)) == pytest.approx(before, abs=1)
    assert driver.stage.camera.zoom == camera.zoom


def test_what_was_seen_whole_on_the_sheet_is_so_in_the_run(driver):
    editor, room = driver.editor, (-3.0, -3.0, 6.0, 4.0)
    editor.apply("Walls", replace(editor.document, level=replaced(editor.document.level, walls=WallsDef(box=room))))
    camera = editor.camera
    camera.fit(room)
    camera.zoom *= 1.18
    assert camera.shows(room)
    driver.key(pygame.K_e)
    driver.key(pygame.K_y)
    driver.key(pygame.K_e)
    driver.key(pygame.K_e)
    assert driver.app.play.time.is_shown and driver.stage.camera.shows(room)


def test_e_edits_a_level_that_is_played_and_a_replays_level(open_app):
    driver = open_app(small_level())
    driver.key(pygame.K_e)
    assert driver.app.mode == "edit" and driver.editor.document.level == small_level()
    assert driver.editor.level_file.path is None


def test_the_settled_pose_is_kept_and_undo_takes_it_back(driver):
    before = driver.editor.document.level
    driver.key(pygame.K_e)
    driver.frames(120)
    held = driver.world.position[driver.world.particle_slot("rope.4")].copy()
    assert held[1] < -0.2
    driver.key(pygame.K_k, CTRL)
    driver.choose("Pose: the present positions")
    driver.key(pygame.K_e)
    slot = driver.editor.scene.slot("rope.4")
    assert driver.editor.scene.position[slot] == pytest.approx(held, abs=1e-3)
    assert driver.editor.history.labels[-1].startswith("Keep pose")
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level is before


def test_only_what_differs_is_offered_and_the_chosen_material_stays_chosen(driver):
    driver.editor.turn_to("materials")
    page = driver.editor.side.page
    page.chosen = "rubber"
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_e)
    driver.frames(30)
    driver.key(pygame.K_p)
    driver.app.act("pause")
    driver.click(driver.pixel_of("pair.1"))
    driver.key(pygame.K_k, CTRL)
    offered = [button.text for button in driver.app.ui.buttons() if ":" in button.text or button.text == "Pins"]
    assert offered == ["Pose: the present positions", "Pins"]
    driver.choose("Pins")
    driver.key(pygame.K_e)
    assert driver.editor.side.page is not page and driver.editor.side.page.chosen == "rubber"


def test_coefficients_cuts_and_pins_are_kept_together(driver):
    driver.key(pygame.K_e)
    driver.playback.submit(SetCoefficients(stiffness=0.11, damping=0.22, material=None))
    driver.playback.submit(CutSprings(springs=(1,)))
    driver.key(pygame.K_p)
    driver.app.act("pause")
    driver.click(driver.pixel_of("pair.1"))
    driver.key(pygame.K_k, CTRL)
    driver.choose("All of it")
    level = driver.editor.document.level
    assert level.materials["steel"].stiffness == 0.11 and level.materials["rubber"].damping == 0.22
    assert level.bodies[0].cut == (1,)
    assert len(driver.editor.history.labels) == 2
    driver.key(pygame.K_k, CTRL)
    assert driver.notices[-1] == "The level has all of the run already." and not driver.app.ui.has_sheet
    driver.key(pygame.K_e)
    assert driver.editor.scene.pinned[driver.editor.scene.slot("pair.1")]
    assert driver.editor.history.index == len(driver.editor.history.labels) - 1


def test_what_is_drawn_plays_and_its_recording_verifies(edit, documents):
    driver = edit()
    driver.key(pygame.K_r)
    driver.drag((-2, 1), (0, 1), (2, 1))
    driver.key(pygame.K_e)
    driver.key(pygame.K_r, CTRL)
    driver.frames(40)
    driver.key(pygame.K_e)
    (path,) = documents.glob("*.replay.jsonl")
    assert verify(read_replay(path)) is None


def test_dropping_a_level_opens_it_for_editing_while_editing_and_plays_it_while_playing(driver, tmp_path):
    path = tmp_path / "dropped.json"
    write_level(small_level(name="Dropped"), path)
    driver.post(pygame.DROPFILE, file=str(path))
    driver.frames(2)
    assert driver.app.mode == "edit" and driver.editor.document.level.name == "Dropped"
    assert driver.editor.level_file.path == path
    driver.key(pygame.K_e)
    driver.post(pygame.DROPFILE, file=str(path))
    driver.frames(2)
    assert driver.app.mode == "play"
    driver.key(pygame.K_e)
    assert driver.app.mode == "edit" and driver.editor.level_file.path == path


def test_a_wheel_that_is_drawn_and_given_a_motor_is_driven_by_its_key(edit):
    driver = edit()
    driver.key(pygame.K_d)
    for corner in ((-4, -2), (4, -2), (4, -1.5), (-4, -1.5)):
        driver.click_at(*corner)
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_q)
    driver.drag((0, 0), (0.5, 0), (0.9, 0))
    driver.editor.edit("Pin", lambda document: set_pinned(document, ["wheel.hub"], True))
    driver.frames(2)
    form = driver.editor.side.page.form
    form.area.scroll_to(form.area.offset + form.buttons["motor"].rect.centery - driver.editor.side.back.rect.centery)
    driver.frames(2)
    driver.click_widget(form.buttons["motor"])
    driver.frames(2)
    driver.app.ui.focus_on(form.keys["motor.key"])
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_u)
    level = driver.editor.document.level
    assert level.bodies[0].motor.key == "u" and level.terrain[0].polygon is not None
    driver.app.act("play")
    driver.frames(2)
    driver.post(pygame.KEYDOWN, key=pygame.K_u, mod=0, unicode="u")
    driver.frames(60)
    hub = driver.world.particle_slot("wheel.hub")
    arms = driver.world.position[hub : hub + 25] - driver.world.position[hub]
    speeds = driver.world.velocity[hub : hub + 25]
    assert np.sum(arms[:, 0] * speeds[:, 1] - arms[:, 1] * speeds[:, 0]) > 1.0
