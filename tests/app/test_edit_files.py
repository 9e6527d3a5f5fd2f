"""Files of the editor: new, open, save, revert, changes that are not saved, other windows, and work found again."""

import json
import os

import pygame
import pytest

from sandbox.app.edit import documents as documents_module
from sandbox.app.edit.documents import OFFERED
from sandbox.editor.edits.fields import set_level_field
from sandbox.editor.storage.autosave import Autosave, orphans
from sandbox.editor.storage.level_file import LevelFile
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import load_level, read_level, shipped_levels, write_level
from tests.app.conftest import small_level

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "small.json"
    write_level(small_level(), path)
    return path


@pytest.fixture
def driver(edit, path):
    driver = edit()
    driver.app.documents.open(path)
    driver.frames(2)
    return driver


def draw(driver):
    driver.key(pygame.K_a)
    driver.click_at(3, 3)
    driver.key(pygame.K_v)


def lose(level, path=None):
    """Leave an autosave behind, as a session that ends badly does."""
    lost = Autosave()
    lost.note(level, path, "Draw rope")
    lost.settle()
    lost.close()


def test_an_edit_shows_in_the_title_and_saving_writes_it_as_it_is(driver, path):
    assert "Small - Level editor (small.json)" in driver.app.title()
    draw(driver)
    assert "Small* - Level editor" in driver.app.title()
    driver.key(pygame.K_s, CTRL)
    assert "Small - Level editor" in driver.app.title()
    assert read_level(path) == driver.editor.document.level
    driver.key(pygame.K_z, CTRL)
    assert "Small*" in driver.app.title()


def test_a_level_without_a_file_asks_for_a_name_and_never_overwrites_without_asking(edit, documents):
    driver = edit()
    draw(driver)
    driver.key(pygame.K_s, CTRL)
    assert driver.app.ui.has_sheet
    driver.type("mine")
    driver.key(pygame.K_RETURN)
    assert not driver.app.ui.has_sheet
    assert read_level(documents / "mine.json") == driver.editor.document.level
    (documents / "other.json").write_text("precious")
    driver.key(pygame.K_s, CTRL | SHIFT)
    driver.type("other")
    driver.key(pygame.K_RETURN)
    assert (documents / "other.json").read_text() == "precious" and driver.app.ui.has_sheet
    driver.choose("Replace it")
    assert read_level(documents / "other.json") == driver.editor.document.level


def test_a_place_that_cannot_be_written_is_said_and_the_level_stays(edit, tmp_path):
    driver = edit()
    draw(driver)
    driver.key(pygame.K_s, CTRL | SHIFT)
    driver.type(str(tmp_path / "no such folder" / "x"))
    driver.key(pygame.K_RETURN)
    assert driver.app.ui.has_sheet and not driver.editor.history.is_saved
    driver.key(pygame.K_ESCAPE)
    assert len(driver.editor.document.level.particles) == 1


@pytest.mark.parametrize("action", ["new", "quit"])
def test_changes_that_are_not_saved_are_asked_about(driver, path, action):
    draw(driver)
    editor, level = driver.editor, driver.editor.document.level
    driver.app.act(action)
    driver.frames()
    driver.choose("Cancel")
    assert driver.editor is editor and driver.app.running
    driver.app.act(action)
    driver.frames()
    driver.choose("Save")
    assert read_level(path) == level
    assert driver.editor is not editor if action == "new" else not driver.app.running


def test_discarding_changes_leaves_the_file_as_it_is(driver, path):
    before = path.read_bytes()
    draw(driver)
    driver.post(pygame.QUIT)
    driver.frames()
    assert driver.app.running
    driver.choose("Discard the changes")
    assert not driver.app.running and path.read_bytes() == before


def test_saving_a_new_level_on_the_way_out_asks_for_its_name_first(edit, documents):
    driver = edit()
    draw(driver)
    driver.key(pygame.K_q, CTRL)
    driver.choose("Save")
    assert driver.app.running
    driver.type("last")
    driver.key(pygame.K_RETURN)
    assert not driver.app.running and (documents / "last.json").is_file()


def test_revert_reads_the_file_again_and_can_be_undone(driver):
    draw(driver)
    edited = driver.editor.document.level
    driver.key(pygame.K_r, CTRL | SHIFT)
    assert driver.editor.document.level == small_level() and driver.editor.history.is_saved
    assert any(text.endswith("was read again. Undo (Ctrl+Z) brings your changes back.") for text in driver.notices)
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level is edited


def test_a_file_that_another_program_writes_is_noticed_when_the_window_comes_back(driver, path):
    level = small_level(name="From elsewhere")
    path.write_text(level_text(level))
    driver.post(pygame.WINDOWFOCUSGAINED)
    driver.frames()
    driver.choose("Read it again")
    assert driver.editor.document.level.name == "From elsewhere"


def test_saving_over_what_another_program_wrote_asks_first(driver, path):
    draw(driver)
    path.write_text(level_text(small_level(name="From elsewhere")))
    driver.key(pygame.K_s, CTRL)
    assert read_level(path).name == "From elsewhere"
    driver.choose("Replace it")
    assert read_level(path) == driver.editor.document.level


def test_a_level_that_is_open_elsewhere_can_be_opened_as_a_copy(edit, path):
    other, _ = LevelFile.open(path)
    driver = edit()
    driver.app.documents.open(path)
    driver.frames()
    driver.choose("Open a copy")
    assert driver.editor.document.level == small_level() and driver.editor.level_file.path is None
    other.close()


def test_a_faulty_level_opens_as_far_as_it_is_valid_only_on_agreement(edit, tmp_path):
    data = json.loads(level_text(small_level()))
    data["bodies"][1]["segments"] = -3
    path = tmp_path / "faulty.json"
    path.write_text(json.dumps(data))
    before = path.read_bytes()
    driver = edit()
    driver.post(pygame.DROPFILE, file=str(path))
    driver.frames(2)
    assert driver.app.ui.has_sheet and not driver.editor.document.level.bodies
    driver.choose("Open the valid rest")
    assert [body.id for body in driver.editor.document.level.bodies] == ["rope"]
    assert driver.editor.level_file.path is None and path.read_bytes() == before


def test_a_file_that_is_no_level_is_shown_as_lines(edit, tmp_path):
    path = tmp_path / "broken.json"
    path.write_text("{")
    driver = edit()
    for missing in (path, tmp_path / "nowhere.json", tmp_path):
        driver.app.documents.open(missing)
        driver.frames()
        assert driver.app.ui.has_sheet
        driver.key(pygame.K_RETURN)
        assert not driver.app.ui.has_sheet
    assert driver.editor.history.labels == ["New"]


def test_the_gallery_opens_a_shipped_level_as_a_copy_and_my_levels_to_edit(edit, path):
    driver = edit()
    driver.key(pygame.K_o, CTRL)
    card = next(card for card in driver.app.gallery.cards if card.name == "Spider web")
    driver.app.gallery.area.scroll_to(card.place.top)
    driver.frames()
    driver.click_widget(card)
    assert driver.editor.document.level.name == "Spider web" and driver.editor.level_file.path is None
    driver.app.documents.open(path)
    driver.key(pygame.K_l, CTRL)
    assert [card.name for card in driver.app.gallery.cards] == ["Small"]


def test_work_of_a_session_that_ended_badly_is_offered_and_comes_back_unsaved(open_app, path):
    ground = [{"id": "far", "polyline": [[-200.0, -3.0], [200.0, -3.0]]}]
    level = small_level(name="Lost work", terrain=ground)
    lose(level, path)
    driver = open_app(small_level())
    driver.app.documents.offer_recovery()
    driver.frames()
    label = next(button.text for button in driver.app.ui.buttons() if "Lost work" in button.text)
    assert path.name in label
    driver.choose(label)
    # The level's view is seen, not all of its ground.
    assert driver.at(7.0, 0.0)[0] - driver.at(-3.0, 0.0)[0] > driver.app.display.surface.get_width() / 4
    assert driver.editor.document.level == level and not driver.editor.history.is_saved
    assert driver.editor.level_file.path == path
    driver.app.documents.close()
    assert [orphan.name for orphan in orphans()] == ["Lost work"]


def test_a_session_that_ends_well_leaves_nothing_to_recover(driver):
    draw(driver)
    driver.key(pygame.K_s, CTRL)
    driver.app.close()
    assert orphans() == []


def test_every_shipped_level_opens_and_saves_as_it_was(edit, tmp_path):
    driver = edit()
    for shipped in shipped_levels():
        driver.app.documents.open_copy(shipped)
        driver.frames(2)
        target = tmp_path / shipped.name
        driver.editor.level_file.save_as(driver.editor.document.level, target)
        assert target.read_bytes() == shipped.read_bytes(), shipped.name
        driver.rest()


def test_closing_the_window_twice_asks_once_and_also_from_a_page(driver):
    draw(driver)
    driver.key(pygame.K_F1)
    for _ in range(3):
        driver.post(pygame.QUIT)
        driver.frames()
    driver.choose("Cancel")
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.ui.has_sheet and driver.app.running


def test_a_folder_that_the_autosave_cannot_write_is_said_and_editing_goes_on(edit, tmp_path):
    (tmp_path / "data").write_text("a file where the folder should be")
    driver = edit()
    draw(driver)
    driver.app.documents._autosave.settle()
    driver.frames(2)
    assert any("cannot be kept" in text for text in driver.notices)
    assert len(driver.editor.document.level.particles) == 1


def test_work_on_the_file_that_is_open_comes_back_into_that_file(driver, path):
    lose(small_level(name="Lost work"), path)
    driver.app.documents.offer_recovery()
    driver.choose(next(button.text for button in driver.app.ui.buttons() if "Lost work" in button.text))
    assert driver.editor.level_file.path == path and not driver.editor.history.is_saved
    driver.key(pygame.K_s, CTRL)
    assert read_level(path).name == "Lost work"


def test_saving_under_a_new_name_tells_where_the_file_cannot_be_locked(driver, path, tmp_path):
    (tmp_path / "blocked").write_text("a file, no folder")
    driver.editor.level_file.folder = tmp_path / "blocked"
    driver.app.documents.save_as()
    driver.type(str(tmp_path / "other"))
    driver.choose("Save")
    told = [text for text in driver.notices if "cannot be locked against other windows" in text]
    assert len(told) == 1 and told[0].startswith(str(tmp_path / "other.json"))
    driver.app.status.notices.clear()
    driver.key(pygame.K_s, CTRL)
    assert not any("cannot be locked" in text for text in driver.notices)


def test_discarding_what_is_offered_keeps_what_is_not(edit):
    for number in range(OFFERED + 1):
        lose(small_level(name=f"Level {number}"))
    driver = edit()
    driver.app.documents.offer_recovery()
    driver.choose("Discard all of these")
    assert len(orphans()) == 1


@pytest.mark.parametrize("answer", ["Discard the changes", "Cancel"])
def test_a_question_about_changes_outlives_a_new_layout(driver, path, answer):
    draw(driver)
    driver.post(pygame.QUIT)
    driver.frames()
    driver.app.rebuild()
    driver.frames()
    assert driver.app.ui.has_sheet
    driver.choose(answer)
    driver.app.rebuild()
    driver.frames()
    assert not driver.app.ui.has_sheet and driver.app.running == (answer == "Cancel")


def test_the_offer_of_lost_work_outlives_a_new_layout(edit):
    lose(small_level(name="Lost work"))
    driver = edit()
    driver.app.documents.offer_recovery()
    driver.app.rebuild()
    driver.frames()
    assert any("Lost work" in button.text for button in driver.app.ui.buttons())


def test_a_level_that_was_read_again_leaves_nothing_to_recover(driver):
    draw(driver)
    driver.app.documents.revert()
    driver.app.documents._autosave.settle()
    driver.app.documents.close()
    assert orphans() == []


def test_all_that_opening_what_is_valid_leaves_out_is_shown(edit, tmp_path, monkeypatch):
    shown = []
    monkeypatch.setattr(documents_module, "show_lines", lambda ui, title, lines, other: shown.extend(lines))
    data = json.loads(level_text(small_level()))
    data["nonsense"], data["bodies"][1]["material"] = 1, "wood"
    path = tmp_path / "faulty.json"
    path.write_text(json.dumps(data))
    edit().app.documents.open(path)
    assert any("nonsense" in line for line in shown) and any("wood" in line for line in shown)


@pytest.mark.parametrize(
    ("ask", "typed"),
    [("save_as", "~nobody-of-that-name/x"), ("open_file", "~nobody-of-that-name/x"), ("open_file", "x" * 300)],
)
def test_names_that_lead_nowhere_are_answered_in_a_line(edit, ask, typed):
    driver = edit()
    draw(driver)
    driver.app.act(ask)
    driver.type(typed)
    driver.key(pygame.K_RETURN)
    assert driver.app.ui.has_sheet and not driver.editor.history.is_saved


@pytest.mark.skipif(os.name != "posix", reason="names are bytes on POSIX alone")
def test_a_file_whose_name_is_no_text_is_opened_and_saved(edit, tmp_path):
    path = os.fsdecode(os.fsencode(tmp_path) + b"/b\xffd.json")
    write_level(small_level(), path)
    driver = edit()
    driver.app.documents.open(path)
    driver.frames(2)
    draw(driver)
    driver.key(pygame.K_s, CTRL)
    assert read_level(path) == driver.editor.document.level
    driver.app.act("save_as")
    driver.frames(2)
    assert driver.app.ui.has_sheet


def test_a_level_that_nobody_has_named_is_called_as_its_file_and_others_keep_their_name(edit, tmp_path):
    driver = edit()
    for name, wanted in (("bridge one", "bridge one"), ("bridge two", "bridge one")):
        draw(driver)
        driver.key(pygame.K_s, CTRL | SHIFT)
        driver.app.ui.focus.typed = str(tmp_path / name)
        driver.key(pygame.K_RETURN)
        driver.frames(2)
        assert read_level(tmp_path / f"{name}.json").name == wanted == driver.editor.document.level.name
        assert driver.editor.history.is_saved
    driver.editor.step_to(1)
    assert driver.editor.document.level.name == "Untitled"


def test_arrow_keys_go_through_a_question_and_a_folder_alone_is_no_name(driver, documents):
    driver.editor.edit("Name", lambda document: set_level_field(document, "name", "Other"))
    driver.key(pygame.K_n, pygame.KMOD_CTRL)
    assert driver.app.ui.focus.text == "Save"
    driver.key(pygame.K_DOWN)
    assert driver.app.ui.focus.text == "Discard the changes"
    driver.key(pygame.K_RETURN)
    assert not driver.app.ui.has_sheet and driver.editor.document.level.name == "Untitled"
    driver.key(pygame.K_s, pygame.KMOD_CTRL | pygame.KMOD_SHIFT)
    before = sorted(documents.parent.glob("*.json"))
    for typed in (f"{documents.parent}/", f"{documents.parent}/nowhere/x"):
        driver.key(pygame.K_a, pygame.KMOD_CTRL)
        driver.type(typed)
        driver.key(pygame.K_RETURN)
        assert driver.app.ui.has_sheet
    assert sorted(documents.parent.glob("*.json")) == before


def test_a_file_that_is_not_there_yet_begins_as_an_empty_sheet_that_is_saved_there(edit, tmp_path):
    driver, path = edit(), tmp_path / "cart.json"
    driver.app.documents.begin(str(path))
    driver.frames(2)
    assert driver.editor.level_file.path == path and driver.editor.document.level.name == "cart"
    assert "cart.json is not there yet. Ctrl+S writes it." in driver.notices and not path.exists()
    driver.key(pygame.K_r)
    driver.drag((0, 0), (2, 0), (4, 0))
    driver.key(pygame.K_s, CTRL)
    assert [body.id for body in load_level(path).bodies] == ["rope"] and driver.editor.history.is_saved


def test_a_name_in_no_folder_or_of_no_level_is_refused(edit, tmp_path):
    driver = edit()
    for name in (str(tmp_path / "nowhere" / "cart.json"), "ropee"):
        driver.app.documents.begin(name)
        driver.frames(2)
        assert driver.editor.level_file.path is None and driver.app.ui.has_sheet
        driver.key(pygame.K_ESCAPE)


def test_a_path_that_cannot_be_written_is_kept_for_the_next_try(edit, tmp_path):
    driver = edit(small_level())
    driver.key(pygame.K_s, CTRL | SHIFT)
    driver.type("/proc/bridge")
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    driver.choose("Save under another name")
    driver.frames(2)
    assert driver.app.ui.focus.text == "/proc/bridge"


def test_the_editor_begins_without_a_file_as_a_new_level_does(edit):
    driver = edit()
    driver.app.documents.begin("")
    driver.frames(2)
    begun = driver.editor.document.level
    driver.key(pygame.K_n, CTRL)
    assert begun.walls is not None and driver.editor.document.level == begun
