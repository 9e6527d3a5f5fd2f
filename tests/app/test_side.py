"""The panel at the side of the editor, page by page, by mouse and by keyboard."""

import pygame
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sandbox.app.edit.side.checks import Trial
from sandbox.app.edit.side.side import PAGES
from sandbox.app.widgets.rows import RowList
from sandbox.editor.document import empty_level
from sandbox.editor.edits.additions import add_object
from sandbox.editor.items import Item
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import Level, ZoneDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.jelly import BoxShape, JellyDef
from sandbox.level.reading.files import parse_level, read_level
from sandbox.session.level_edits import runs_alike
from tests.app.conftest import small_level

ROPE, PAIR = Item("body", "rope"), Item("body", "pair")
LOOSE = {
    "particles": [{"id": "ball", "position": [5, 1]}, {"id": "nail", "position": [6, 1], "pinned": True}],
    "springs": [{"a": "ball", "b": "nail"}],
    "checks": [{"name": "still", "metric": "max_speed", "after": 0.5, "at_most": 1.0},
               {"name": "low", "metric": "y", "particle": "ball", "after": 0.25, "at_most": 0.5}],
}  # fmt: skip


@pytest.fixture
def driver(edit):
    return edit(small_level(**LOOSE))


def level(driver):
    return driver.editor.document.level


def body(driver, name="rope"):
    return next(body for body in level(driver).bodies if body.id == name)


def choose(driver, *items):
    driver.editor.select(frozenset(items))
    driver.frames(2)


def form(driver):
    return driver.editor.side.page.form


def entry(driver, name, axis=0):
    return form(driver).fields[name][axis]


def open_tab(driver, tab):
    side = driver.editor.side
    press(driver, next(row.buttons[tab] for row in side._rows if tab in row.buttons))
    driver.frames(2)
    return driver.editor.side.page


def press(driver, widget):
    """Click, and let the panel follow, which it does a frame after the canvas."""
    driver.click_widget(widget)
    driver.frames(2)


def click_row(driver, rows: RowList, index):
    middle = (rows._tops[index] + rows._tops[index + 1]) / 2
    driver.click((rows.rect.centerx, rows.rect.top + middle - rows._offset))
    driver.frames(2)


def wheel(driver, widget, notches):
    driver.move(widget.rect.center)
    driver.post(pygame.MOUSEWHEEL, x=0, y=notches, precise_x=0.0, precise_y=float(notches), flipped=False)
    driver.frames(2)


def test_the_tab_of_the_page_stays_lit_when_it_is_clicked_again(driver):
    open_tab(driver, "checks")
    button = driver.editor.side._tab_button("checks")
    driver.move((5, 5))
    lit = pygame.image.tobytes(button.image, "RGB")
    open_tab(driver, "checks")
    driver.move((5, 5))
    assert pygame.image.tobytes(button.image, "RGB") == lit


def test_while_nothing_is_selected_the_panel_says_so_and_a_search_finds_fields_of_the_level(driver):
    assert not form(driver).properties and "page Level" in form(driver).empty
    driver.fill(driver.editor.side.page.search, "rate")
    driver.frames(2)
    driver.fill(entry(driver, "tick_rate"), "120")
    assert level(driver).settings.tick_rate == 120
    choose(driver, ROPE)
    assert "tick_rate" not in form(driver).fields and "segments" in form(driver).fields


def test_rare_fields_are_folded_until_wanted_and_the_panel_keeps_that(driver):
    choose(driver, ROPE)
    assert "cut" not in form(driver).fields
    heading = form(driver)._named["fold More"]
    reveal(driver, heading)
    press(driver, heading)
    assert "cut" in form(driver).fields
    open_tab(driver, "history")
    open_tab(driver, "properties")
    assert "cut" in form(driver).fields
    driver.app.ui.focus_on(form(driver)._named["fold Springs"])
    driver.key(pygame.K_RETURN)
    assert "material" not in form(driver).pickers and "cut" in form(driver).fields


def test_words_find_fields_that_are_folded_away_and_selecting_shows_all_again(driver):
    choose(driver, ROPE)
    driver.app.ui.focus_on(driver.editor.side.page.search)
    driver.type("cut")
    driver.frames(2)
    assert set(form(driver).fields) >= {"cut"} and "segments" not in form(driver).fields
    driver.type("qq")
    driver.frames(2)
    assert form(driver).fields == {}
    choose(driver, Item("body", "pair"))
    assert "segments" in form(driver).fields


def test_what_is_selected_is_shown_and_a_typed_value_is_one_step(driver):
    driver.click_at(1, 0)
    driver.frames(2)
    assert entry(driver, "segments").text == "4"
    driver.fill(entry(driver, "segments"), "8")
    assert body(driver).segments == 8
    assert driver.editor.history.labels[1:] == ["Segments"]
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert body(driver).segments == 4
    assert entry(driver, "segments").text == "4"


def test_a_typed_value_is_shown_as_the_document_has_it(driver):
    choose(driver, ROPE)
    driver.fill(entry(driver, "particle_mass"), "2,50")
    assert body(driver).particle_mass == 2.5
    assert entry(driver, "particle_mass").typed == "2.5"
    driver.fill(entry(driver, "particle_mass"), "2.500")
    assert entry(driver, "particle_mass").typed == "2.5"
    assert len(driver.editor.history.labels) == 2


def test_a_wrong_text_gives_one_line_and_the_old_value_comes_back(driver):
    choose(driver, ROPE)
    driver.fill(entry(driver, "particle_mass"), "heavy")
    assert 'Particle mass: "heavy" is not a number.' in driver.notices
    assert entry(driver, "particle_mass").typed == "1"
    assert driver.editor.history.labels == driver.editor.history.labels[:1]


def test_several_things_show_what_they_share_and_change_together(driver):
    choose(driver, ROPE, PAIR)
    assert entry(driver, "segments").text == "mixed"
    assert entry(driver, "start", 0).text == "0" and entry(driver, "start", 1).text == "mixed"
    driver.fill(entry(driver, "start", 1), "3")
    assert (body(driver).start, body(driver, "pair").start) == ((0, 3), (0, 3))


def test_leaving_a_mixed_field_as_it_is_changes_nothing(driver):
    choose(driver, ROPE, PAIR)
    driver.app.ui.focus_on(entry(driver, "segments"))
    driver.key(pygame.K_RETURN)
    assert len(driver.editor.history.labels) == 1


def test_a_click_elsewhere_takes_what_was_typed_before_it_selects(driver):
    choose(driver, ROPE)
    driver.app.ui.focus_on(entry(driver, "particle_mass"))
    driver.type("7")
    driver.click_at(1, 2)
    driver.frames(2)
    assert body(driver).particle_mass == 7.0 and body(driver, "pair").particle_mass == 1.0
    assert driver.editor.document.selection == {PAIR}
    assert entry(driver, "particle_mass").text == "1"


def test_another_page_takes_what_was_typed(driver):
    choose(driver, ROPE)
    driver.app.ui.focus_on(entry(driver, "particle_mass"))
    driver.type("7")
    open_tab(driver, "history")
    assert body(driver).particle_mass == 7.0


def test_saving_and_leaving_count_what_is_being_typed(driver, documents):
    documents.mkdir()
    driver.editor.level_file.save_as(level(driver), documents / "x.json")
    choose(driver, ROPE)
    driver.app.ui.focus_on(entry(driver, "segments"))
    driver.type("8")
    driver.key(pygame.K_s, pygame.KMOD_CTRL)
    assert read_level(documents / "x.json").bodies[0].segments == 8
    driver.app.ui.focus_on(entry(driver, "segments"))
    driver.type("9")
    driver.key(pygame.K_q, pygame.KMOD_CTRL)
    assert driver.app.ui.has_sheet and driver.app.running
    assert body(driver).segments == 9


def test_a_box_is_ticked_by_mouse_and_by_key(driver):
    choose(driver, ROPE)
    boxes = form(driver).boxes["pin"]
    reveal(driver, boxes["end"])
    assert boxes["start"].state and not boxes["end"].state
    press(driver, boxes["end"])
    assert body(driver).pin == ("start", "end")
    driver.app.ui.focus_on(boxes["start"])
    driver.key(pygame.K_SPACE)
    assert body(driver).pin == ("end",)
    choose(driver, Item("particle", "ball"))
    reveal(driver, form(driver).boxes["pinned"]["yes"])
    press(driver, form(driver).boxes["pinned"]["yes"])
    assert level(driver).particles[0].pinned


@pytest.fixture
def rolling(edit):
    """An editor with a wheel, which is selected."""
    body = {"type": "wheel", "id": "w", "position": [2, 2], "radius": 1, "thickness": 0.3, "segments": 6}
    driver = edit(small_level(bodies=[body]))
    choose(driver, Item("body", "w"))
    return driver


def test_a_motor_is_added_gets_its_keys_and_goes_again_with_undo(rolling):
    reveal(rolling, form(rolling).buttons["motor"])
    press(rolling, form(rolling).buttons["motor"])
    assert body(rolling, "w").motor.speed == 3.0
    reveal(rolling, form(rolling).keys["motor.reverse_key"])
    press(rolling, form(rolling).keys["motor.key"])
    rolling.key(pygame.K_c)
    assert body(rolling, "w").motor.key == "c" and rolling.editor.tool == "select"
    assert any("Cut tool" in notice for notice in rolling.notices)
    rolling.app.ui.focus_on(form(rolling).keys["motor.reverse_key"])
    for key in (pygame.K_SPACE, pygame.K_F5, pygame.K_LEFT):
        rolling.key(key)
    assert body(rolling, "w").motor.reverse_key == "left"
    rolling.fill(entry(rolling, "motor.speed"), "-2")
    assert body(rolling, "w").motor.speed == -2.0
    press(rolling, form(rolling).keys["motor.key"])
    rolling.key(pygame.K_DELETE)
    assert body(rolling, "w").motor.key is None
    labels = ["Add: motor", "Key", "Reverse key", "Speed", "Key"]
    assert rolling.editor.history.labels[1:] == labels
    for _ in labels:
        rolling.key(pygame.K_z, pygame.KMOD_CTRL)
    assert body(rolling, "w").motor is None and "motor.key" not in form(rolling).keys


def test_what_something_touches_is_picked_group_by_group(edit):
    ball = {"id": "ball", "position": [5, 1], "collision_group": "balls"}
    driver = edit(small_level(contacts={}, particles=[ball]))
    choose(driver, ROPE)
    reveal(driver, form(driver).pickers["collides"])

    def pick(index):
        press(driver, form(driver).pickers["collides"])
        click_row(driver, driver.app.ui.focus, index)
        return body(driver).collides

    press(driver, form(driver).pickers["collides"])
    assert [row.text for row in driver.app.ui.focus.rows] == ["everything", "nothing", "terrain", "default", "balls"]
    driver.key(pygame.K_ESCAPE)
    assert [pick(index) for index in (4, 3, 4, 1, 0)] == [("balls",), ("balls", "default"), ("default",), False, True]
    assert form(driver).pickers["collides"].shown.text == "everything"


def test_a_key_that_is_not_pressed_after_all_leaves_the_drive_as_it_is(rolling):
    rolling.editor.edit("Motor", lambda document: add_object(document, [Item("body", "w")], "motor"))
    rolling.frames(2)
    reveal(rolling, form(rolling).keys["motor.key"])
    for leave in (lambda: rolling.key(pygame.K_ESCAPE), lambda: rolling.click_at(2, 3.9)):
        press(rolling, form(rolling).keys["motor.key"])
        assert form(rolling).keys["motor.key"].listening
        leave()
        rolling.frames(2)
        if "motor.key" in form(rolling).keys:
            assert not form(rolling).keys["motor.key"].listening
        choose(rolling, Item("body", "w"))
    rolling.key(pygame.K_r)
    assert rolling.editor.tool == "rope" and body(rolling, "w").motor.key is None


def reveal(driver, widget):
    """Scroll the panel to a widget."""
    area = form(driver).area
    area.scroll_to(area.offset + widget.rect.centery - driver.editor.side.back.rect.centery)
    driver.frames(2)


def test_a_number_is_dragged_by_its_label_in_one_step(driver):
    choose(driver, ROPE)
    scrub = form(driver).scrubs["segments"]
    x, y = scrub.rect.center
    driver.press((x, y))
    for step in (1, 2, 3):
        driver.move((x + 12 * step, y))
    driver.release((x + 36, y))
    assert body(driver).segments > 8
    assert driver.editor.history.labels[1:] == ["Segments"]
    assert entry(driver, "segments").text == str(body(driver).segments)
    driver.move((x - 200, y))
    assert driver.editor.history.labels[1:] == ["Segments"]


def test_a_material_is_picked_by_mouse_and_by_key(driver):
    choose(driver, ROPE)
    picker = form(driver).pickers["material"]
    press(driver, picker)
    menu = driver.app.ui.focus
    names = [row.text for row in menu.rows]
    assert names == ["default", "steel", "rubber"]
    click_row(driver, menu, names.index("rubber"))
    assert body(driver).material == "rubber" and not driver.app.ui.has_sheet
    driver.app.ui.focus_on(form(driver).pickers["material"])
    driver.key(pygame.K_RETURN)
    driver.key(pygame.K_UP)
    driver.key(pygame.K_RETURN)
    assert body(driver).material == "steel"


def test_a_menu_is_left_by_escape_and_by_a_click_beside_it(driver):
    choose(driver, ROPE)
    for leave in (lambda: driver.key(pygame.K_ESCAPE), lambda: driver.click_at(3, 2)):
        press(driver, form(driver).pickers["material"])
        assert driver.app.ui.has_sheet
        leave()
        assert not driver.app.ui.has_sheet
        assert body(driver).material == "steel" and driver.editor.document.selection == {ROPE}


def test_the_wheel_scrolls_the_panel_and_leaves_the_camera(driver):
    choose(driver, ROPE)
    area, zoom = form(driver).area, driver.editor.camera.zoom
    wheel(driver, area.view, -2)
    assert area.offset > 0.0 and driver.editor.camera.zoom == zoom
    wheel(driver, area.view, 50)
    assert area.offset == 0.0


def test_the_scroll_bar_moves_by_mouse_and_by_keys(driver):
    choose(driver, ROPE)
    area = form(driver).area
    x = area.bar.rect.centerx
    driver.press((x, area.bar.rect.top + 10))
    driver.move((x, area.bar.rect.top + 60))
    dragged = area.offset
    driver.release((x, area.bar.rect.top + 60))
    assert dragged > 0.0
    driver.app.ui.focus_on(area.bar)
    driver.key(pygame.K_END)
    assert area.offset > dragged
    driver.key(pygame.K_HOME)
    assert area.offset == 0.0


def test_tab_goes_through_the_fields_and_keeps_them_in_sight(driver):
    driver.editor.folds["More"] = False
    choose(driver, ROPE)
    driver.app.ui.focus_on(entry(driver, "id"))
    seen = []
    for _ in range(40):
        driver.key(pygame.K_TAB)
        focus = driver.app.ui.focus
        seen.append(focus)
        if focus.parent is form(driver)._holder:
            assert form(driver).area.view.rect.contains(focus.rect)
    assert entry(driver, "group") in seen
    assert form(driver).area.offset > 0.0


def test_keyboard_and_scroll_place_stay_while_values_are_typed(driver):
    choose(driver, ROPE)
    area = form(driver).area
    area.scroll_to(120)
    driver.app.ui.focus_on(entry(driver, "velocity", 0))
    driver.frames(2)
    offset = area.offset
    driver.type("2")
    driver.key(pygame.K_TAB)
    assert body(driver).velocity == (2.0, 0.0)
    assert driver.app.ui.focus is entry(driver, "velocity", 1)
    assert form(driver).area is area and area.offset == offset


def test_renaming_follows_every_reference(driver):
    choose(driver, Item("particle", "ball"))
    driver.fill(entry(driver, "id"), "weight")
    assert level(driver).springs[0].a == "weight" and level(driver).checks[1].particle == "weight"
    assert driver.editor.document.selection == {Item("particle", "weight")}
    assert entry(driver, "id").text == "weight"


def test_every_page_opens_by_mouse_and_by_keyboard(driver):
    for tab in PAGES:
        open_tab(driver, tab)
        assert driver.editor.side.tab == tab
    for tab in PAGES:
        button = next(row.buttons[tab] for row in driver.editor.side._rows if tab in row.buttons)
        driver.app.ui.focus_on(button)
        driver.key(pygame.K_RETURN)
        assert driver.editor.side.tab == tab


def test_ctrl_and_tab_turn_the_pages_also_while_typing(driver):
    choose(driver, ROPE)
    driver.app.ui.focus_on(entry(driver, "particle_mass"))
    driver.type("7")
    driver.key(pygame.K_TAB, pygame.KMOD_CTRL)
    assert driver.editor.side.tab == "objects" and body(driver).particle_mass == 7.0
    driver.key(pygame.K_TAB, pygame.KMOD_CTRL | pygame.KMOD_SHIFT)
    driver.key(pygame.K_TAB, pygame.KMOD_CTRL | pygame.KMOD_SHIFT)
    assert driver.editor.side.tab == "findings"


def test_what_is_being_typed_survives_that_the_window_is_laid_out_anew(driver):
    choose(driver, ROPE)
    driver.app.ui.focus_on(entry(driver, "particle_mass"))
    driver.type("7")
    driver.app.rebuild()
    driver.frames(2)
    assert body(driver).particle_mass == 7.0 and entry(driver, "particle_mass").text == "7"


def test_the_page_stays_when_the_window_is_laid_out_anew(driver):
    open_tab(driver, "level")
    driver.app.rebuild()
    driver.frames(2)
    assert driver.editor.side.tab == "level"


def test_a_drag_of_a_slider_is_one_step(driver):
    page = open_tab(driver, "materials")
    assert page.chosen == "steel"
    slider = page.form.sliders["stiffness"]
    driver.press((slider.pixel_of(0.3), slider.rect.centery))
    for value in (0.1, 0.03, 0.01):
        driver.move((slider.pixel_of(value), slider.rect.centery))
    driver.release((slider.pixel_of(0.01), slider.rect.centery))
    assert level(driver).materials["steel"].stiffness == pytest.approx(0.01, rel=0.1)
    assert len(driver.editor.history.labels) == 2
    driver.app.ui.focus_on(slider)
    driver.key(pygame.K_LEFT)
    assert len(driver.editor.history.labels) == 3
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert level(driver).materials["steel"].stiffness == 0.3
    assert page.form.fields["stiffness"][0].text == "0.3"


def test_frequency_and_damping_ratio_can_be_typed(driver):
    page = open_tab(driver, "materials")
    driver.fill(page.form.fields["ratio"][0], "1")
    driver.fill(page.form.fields["frequency"][0], "2")
    assert page.form.fields["frequency"][0].typed == "2"
    assert float(page.form.fields["ratio"][0].typed) == pytest.approx(1.0, abs=1e-3)
    before = level(driver).materials["steel"]
    for wrong in ("-1", "fast"):
        driver.fill(page.form.fields["frequency"][0], wrong)
        assert page.form.fields["frequency"][0].typed == "2"
    assert level(driver).materials["steel"] == before and len(driver.notices) >= 2


def test_a_material_is_added_named_given_another_law_assigned_and_kept_while_used(driver):
    page = open_tab(driver, "materials")
    press(driver, page.buttons["Add"])
    driver.type("cord")
    driver.key(pygame.K_RETURN)
    assert list(level(driver).materials) == ["steel", "rubber", "cord"] and page.chosen == "cord"
    press(driver, page.form.choices["law"].buttons["hooke"])
    driver.fill(page.form.fields["k"][0], "750")
    assert level(driver).materials["cord"].k == 750.0
    choose(driver, ROPE)
    press(driver, page.buttons["Assign to selection"])
    assert body(driver).material == "cord"
    press(driver, page.buttons["Delete"])
    assert any('"cord" is used by "rope"' in notice for notice in driver.notices)
    choose(driver)
    press(driver, page.buttons["Select users"])
    assert driver.editor.document.selection == {ROPE}
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    press(driver, page.buttons["Delete"])
    assert list(level(driver).materials) == ["steel", "rubber"] and page.chosen in level(driver).materials | {
        "default": 0
    }


def test_the_material_that_needs_no_definition_can_be_changed_and_not_deleted(driver):
    page = open_tab(driver, "materials")
    click_row(driver, page.list, 0)
    assert page.chosen == "default" and "name" not in page.form.fields
    driver.fill(page.form.fields["damping"][0], "0.4")
    assert level(driver).materials["default"].damping == 0.4
    assert not page.buttons["Delete"].is_enabled


def test_settings_of_the_level_are_changed(driver):
    open_tab(driver, "level")
    driver.fill(entry(driver, "name"), "Two ropes")
    driver.fill(entry(driver, "tags"), "rope, small")
    reveal(driver, form(driver)._named["fold Time and solver"])
    driver.click_widget(form(driver)._named["fold Time and solver"])
    driver.frames(2)
    driver.fill(entry(driver, "gravity", 1), "-1.62")
    driver.fill(entry(driver, "description"), r"First line\nsecond")
    assert level(driver).name == "Two ropes" and level(driver).tags == ("rope", "small")
    assert level(driver).settings.gravity == (0.0, -1.62)
    assert level(driver).description == "First line\nsecond"
    reveal(driver, form(driver).pickers["substeps"])
    press(driver, form(driver).pickers["substeps"])
    driver.key(pygame.K_END)
    driver.key(pygame.K_RETURN)
    assert level(driver).settings.substeps == "auto"


def test_the_view_is_taken_from_the_camera_and_dropped(driver):
    page = open_tab(driver, "level")
    press(driver, page.from_camera)
    left, bottom, right, top = level(driver).view
    x, y, width, height = driver.editor.camera.viewport
    assert driver.editor.camera.to_pixels((left, top)) == pytest.approx((x, y), abs=0.2)
    assert driver.editor.camera.to_pixels((right, bottom)) == pytest.approx((x + width, y + height), abs=0.2)
    press(driver, page.no_view)
    assert level(driver).view is None


def test_checks_are_added_changed_run_and_deleted(driver):
    page = open_tab(driver, "checks")
    press(driver, page.buttons[0])
    assert [check.name for check in level(driver).checks] == ["still", "low", "check 1"] and page.chosen == 2
    driver.fill(entry(driver, "after"), "0.1")
    press(driver, page.buttons[2])
    page.trial.wait()
    driver.frames(2)
    assert [row.detail.split()[0] for row in page.list.rows] == ["holds", "fails", "holds"]
    assert page.list.rows[2].detail == "holds with 0: no spring breaks, after 0.1 s"
    press(driver, page.buttons[1])
    assert [check.name for check in level(driver).checks] == ["still", "low"]
    assert page.list.rows[0].detail.startswith("holds")
    driver.editor.select(frozenset({ROPE}))
    driver.key(pygame.K_RIGHT)
    driver.frames(2)
    assert not page.list.rows[0].detail.startswith("holds")


def test_results_are_those_of_the_level_that_ran(driver):
    page = open_tab(driver, "checks")
    press(driver, page.buttons[2])
    page.trial.wait()
    driver.frames(2)
    click_row(driver, page.list, 1)
    driver.fill(entry(driver, "at_most"), "5")
    assert page.list.rows[1].detail == "y of ball is at most 5 m, after 0.25 s"
    assert page.list.rows[0].detail.startswith("holds")


def test_results_go_with_every_part_of_the_level_that_runs():
    before = small_level(**LOOSE, walls={"box": [-9, -9, 9, 9]}, contacts={})
    trial = Trial(before)
    trial.is_stopped = True
    said = {
        "schema_link",
        "format",
        "name",
        "description",
        "goal",
        "author",
        "licence",
        "tags",
        "view",
        "checks",
        "look",
        "extras",
    }
    changed = {part: replaced(before, **{part: object()}) for part in Level.model_fields}
    assert {part for part, level in changed.items() if runs_alike(trial.level, level)} == said


def test_a_click_in_the_history_goes_there_and_undone_steps_stay(driver):
    choose(driver, ROPE)
    for mass in ("2", "3", "4"):
        driver.fill(entry(driver, "particle_mass"), mass)
    page = open_tab(driver, "history")
    assert len(page.list.rows) == 4 and page.list.chosen == 3
    click_row(driver, page.list, 1)
    assert body(driver).particle_mass == 2.0 and len(page.list.rows) == 4
    driver.app.ui.focus_on(page.list)
    driver.key(pygame.K_DOWN)
    assert body(driver).particle_mass == 3.0
    driver.key(pygame.K_HOME)
    assert body(driver).particle_mass == 1.0


def test_a_finding_is_selected_and_shown_by_a_click(edit):
    driver = edit(small_level(particles=[{"id": "one", "position": [0, 3]}, {"id": "two", "position": [0, 3]}]))
    driver.frames(60)
    page = open_tab(driver, "findings")
    assert page.findings
    index = next(index for index, found in enumerate(page.findings) if "two" in found.text)
    click_row(driver, page.list, index)
    assert driver.editor.document.selection <= {Item("particle", "one"), Item("particle", "two")}
    assert driver.editor.document.selection
    button = next(row.buttons["findings"] for row in driver.editor.side._rows if "findings" in row.buttons)
    assert button.text == f"Findings {len(page.findings)}"


def test_nothing_is_made_anew_while_nothing_changes(driver):
    choose(driver, ROPE)
    widgets = list(form(driver)._holder.children)
    driver.frames(5)
    assert form(driver)._holder.children == widgets
    driver.editor.select(frozenset({PAIR}))
    driver.frames(2)
    assert form(driver)._holder.children == widgets and entry(driver, "segments").text == "1"


def test_a_list_too_long_for_a_line_is_counted(edit):
    particles = [[k * 0.5, 0] for k in range(400)]
    driver = edit(small_level(bodies=[{"type": "mesh", "id": "dust", "particles": particles}]))
    driver.editor.folds["More"] = False
    choose(driver, Item("body", "dust"))
    button = next(widget for widget in form(driver)._holder.children if getattr(widget, "text", "") == "400 of them")
    press(driver, button)
    assert driver.app.ui.has_sheet
    driver.key(pygame.K_ESCAPE)
    assert "particles" not in form(driver).fields and "masses" in form(driver).fields


# A window hands no null character on, and its font cannot draw one.
TYPED = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=20)


def test_many_tags_are_not_lost_by_leaving_their_field(edit):
    driver = edit(small_level(tags=[f"a word of some length {k}" for k in range(60)]))
    open_tab(driver, "level")
    for _ in range(12):
        driver.key(pygame.K_TAB)
    assert len(level(driver).tags) == 60 and len(driver.editor.history.labels) == 1


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(["properties", "materials", "level", "checks"]), st.integers(0, 40), TYPED)
def test_no_text_whatever_breaks_a_field(driver, tab, number, text):
    choose(driver, ROPE)
    open_tab(driver, tab)
    fields = [each for pair in form(driver).fields.values() for each in pair]
    field = [*fields][number % len(fields)]
    field.typed = text
    field.finish()
    driver.frames(2)
    saved = level(driver)
    assert parse_level(level_text(saved).encode(), "saved") == saved
    driver.editor.step_to(0)


@pytest.mark.parametrize("name", ["\u202e", "\u200b\u200b"])
def test_names_without_a_width_can_be_opened_shown_and_typed_over(edit, tmp_path, name):
    names = {"name": name, "description": name, "materials": {name: {"stiffness": 0.3, "damping": 0.3}}}
    bodies = [{"type": "rope", "id": name, "start": [0, 0], "end": [4, 0], "segments": 4, "material": name}]
    path = tmp_path / f"{name}.json"
    path.write_text(level_text(small_level(**names, bodies=bodies)))
    driver = edit()
    driver.app.files.open_path(path)
    driver.frames(2)
    choose(driver, Item("body", name))
    for tab in PAGES:
        open_tab(driver, tab)
    driver.key(pygame.K_a)
    driver.click_at(3, 3)
    driver.app.quit()
    driver.choose("Cancel")
    driver.app.open_gallery("mine")
    driver.frames(3)
    assert [card.name for card in driver.app.gallery.cards] == [name]
    assert driver.app.title() == "My levels - Spring Sandbox"


def test_the_history_says_what_each_step_was_made_to(driver):
    choose(driver, ROPE)
    driver.fill(entry(driver, "segments"), "5")
    choose(driver, ROPE, Item("body", "pair"))
    driver.fill(entry(driver, "segments"), "6")
    choose(driver)
    open_tab(driver, "level")
    driver.fill(entry(driver, "name"), "Other")
    page = open_tab(driver, "history")
    assert [(row.text, row.aside) for row in page.list.rows[1:]] == [
        ("Segments", "rope"), ("Segments", "2 things"), ("Name", ""),
    ]  # fmt: skip


def test_a_finding_that_is_ignored_stays_away_until_all_are_asked_for(edit):
    driver = edit(small_level(particles=[{"id": "one", "position": [0, 3]}, {"id": "two", "position": [0, 3]}]))
    driver.frames(60)
    page = open_tab(driver, "findings")
    count, first = len(page.findings), page.findings[0].text
    click_row(driver, page.list, 0)
    press(driver, page.ignore)
    assert first not in [found.text for found in page.findings] and len(page.findings) == count - 1
    driver.key(pygame.K_RIGHT)
    driver.frames(60)
    assert first not in [found.text for found in page.findings]
    click_row(driver, page.list, len(page.findings))
    driver.frames(60)
    assert first in [found.text for found in page.findings]


def test_the_weight_of_a_body_is_typed_as_one_step_and_the_panel_says_that_it_floats(edit):
    box = JellyDef(type="jelly", id="raft", shape=BoxShape(box=(2.5, 0.5)), spacing=0.25, position=(0.0, 1.0))
    pool = ZoneDef(id="pool", box=(-3.0, -2.0, 3.0, 0.0), water={})
    driver = edit(replaced(empty_level(), bodies=(box,), zones=(pool,)))
    choose(driver, Item("body", "raft"))

    def shown():
        return {name: each.value for name, each in form(driver).properties.items() if name.startswith("weight")}

    assert shown()["weight.floats"] == "sinks: 38% is borne"
    driver.fill(entry(driver, "weight.density"), "6")
    assert shown() == {
        "weight.mass": 7.5, "weight.density": 6.0, "weight.floats": "floats, 0.30 m under",
    }  # fmt: skip
    assert driver.editor.history.labels[1:] == ["Density"]
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert shown()["weight.mass"] == 33.0
