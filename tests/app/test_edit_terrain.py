"""Terrain and walls by mouse and keyboard."""

import pygame
import pytest

from sandbox.editor.items import Item
from tests.app.conftest import small_level

CTRL = pygame.KMOD_CTRL
GROUND = {"id": "ground", "polygon": [[-2, -2], [4, -2], [4, -1], [-2, -1]]}
PIECE = Item("terrain", "ground")


@pytest.fixture
def driver(edit):
    return edit(small_level(terrain=[GROUND]))


def terrain(driver):
    return driver.editor.document.level.terrain


def labels(driver):
    return driver.editor.history.labels[1:]


def test_ctrl_z_takes_corners_back_one_by_one_before_it_undoes_an_edit(driver):
    driver.key(pygame.K_d)
    before = driver.editor.document.level
    for corner in ((-3, -2), (-1, -2), (-1, -3)):
        driver.click_at(*corner)
    drawing = driver.editor.pointer_tool.drawing
    assert len(drawing.points) == 3
    driver.key(pygame.K_z, CTRL)
    assert len(drawing.points) == 2
    driver.key(pygame.K_y, CTRL)
    assert len(drawing.points) == 3
    for left in (2, 1, 0):
        driver.key(pygame.K_z, CTRL)
        assert len(drawing.points) == left and driver.editor.document.level is before


def test_another_tool_ends_an_outline_that_is_sound_and_tells_of_one_that_is_not(driver):
    driver.key(pygame.K_d)
    pieces = len(driver.editor.document.level.terrain)
    for corner in ((-3, -2), (-1, -2), (-1, -3)):
        driver.click_at(*corner)
    driver.key(pygame.K_v)
    assert len(driver.editor.document.level.terrain) == pieces + 1 and driver.editor.tool == "select"
    driver.key(pygame.K_d)
    driver.click_at(-3, 1)
    driver.click_at(-2, 1)
    driver.key(pygame.K_v)
    assert len(driver.editor.document.level.terrain) == pieces + 1
    assert any("Not drawn" in notice and "three corners" in notice for notice in driver.notices)


@pytest.mark.parametrize("end", ["first corner", "enter", "double click"])
def test_ground_is_drawn_by_clicks(edit, end):
    driver = edit()
    driver.key(pygame.K_d)
    for point in ((0, 0), (2, 0), (2, 1)):
        driver.click_at(*point)
    assert driver.editor.pointer_tool.drawing.outline[:3] == [(0, 0), (2, 0), (2, 1)]
    if end == "first corner":
        driver.click_at(0, 0)
    elif end == "enter":
        driver.key(pygame.K_RETURN)
    else:
        driver.click(driver.at(2, 1))
    assert [piece.polygon for piece in terrain(driver)] == [((0, 0), (2, 0), (2, 1))]
    assert driver.editor.document.selection == {PIECE} and labels(driver) == ["Draw ground"]
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert terrain(driver) == ()


def test_backspace_takes_a_corner_of_a_line_back_and_escape_all_of_it(edit):
    driver = edit()
    driver.key(pygame.K_c)
    for point in ((0, 0), (2, 0), (2, 1)):
        driver.click_at(*point)
    driver.key(pygame.K_BACKSPACE)
    driver.click_at(3, 0)
    driver.key(pygame.K_RETURN)
    assert terrain(driver)[0].polyline == ((0, 0), (2, 0), (3, 0))
    driver.click_at(0, 2)
    driver.key(pygame.K_ESCAPE)
    assert not driver.editor.pointer_tool.drawing.under_way and len(terrain(driver)) == 1


def test_a_line_is_drawn_by_the_keyboard_alone(edit):
    driver = edit()
    driver.key(pygame.K_c)
    for keys in ((pygame.K_RIGHT,), (pygame.K_RIGHT, pygame.K_RIGHT), (pygame.K_UP,)):
        for key in keys:
            driver.key(key)
        driver.key(pygame.K_RETURN)
    driver.key(pygame.K_RETURN, pygame.KMOD_CTRL)
    assert len(terrain(driver)[0].polyline) == 3


def test_walls_are_dragged_and_drawn_anew(edit):
    driver = edit()
    driver.key(pygame.K_d, pygame.KMOD_SHIFT)
    driver.drag((-2, -1), (0, 0), (2, 1))
    driver.drag((-3, -1), (0, 0), (3, 2))
    assert driver.editor.document.level.walls.box == (-3, -1, 3, 2)
    assert labels(driver) == ["Draw walls", "Draw walls"]


def test_a_corner_is_dragged_one_is_put_in_and_one_is_taken_out_with_undo(driver):
    driver.click_at(1, -1.6)
    assert driver.editor.document.selection == {PIECE}
    driver.drag((4, -1), (4.3, -0.7), (4.5, -0.5))
    assert terrain(driver)[0].polygon[2] == (4.5, -0.5)
    driver.drag((1, -2), (1, -2.3), (1, -2.5))
    assert terrain(driver)[0].polygon[1] == (1, -2.5) and len(terrain(driver)[0].polygon) == 5
    driver.click_at(-2, -1)
    assert driver.editor.pointer_tool.corner == 4 and "Delete" in driver.editor.pointer_tool.hint
    driver.key(pygame.K_DELETE)
    assert terrain(driver)[0].polygon == ((-2, -2), (1, -2.5), (4, -2), (4.5, -0.5))
    assert driver.editor.document.selection == {PIECE}
    assert labels(driver) == ["Move a corner", "Add a corner", "Delete a corner"]
    for _ in range(3):
        driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert terrain(driver)[0].polygon == ((-2, -2), (4, -2), (4, -1), (-2, -1))


def test_a_clicked_corner_is_nudged_by_the_arrows_in_one_step_and_a_new_one_can_be_taken_out_again(driver):
    driver.click_at(1, -1.6)
    driver.click_at(4, -1)
    step = driver.editor.grid
    for key in (pygame.K_RIGHT, pygame.K_RIGHT, pygame.K_UP):
        driver.key(key)
    assert terrain(driver)[0].polygon[2] == pytest.approx((4 + 2 * step, -1 + step))
    driver.drag((1, -2), (1, -2.3), (1, -2.5))
    driver.key(pygame.K_DELETE)
    assert len(terrain(driver)[0].polygon) == 4
    assert labels(driver) == ["Nudge a corner", "Add a corner", "Delete a corner"]
    driver.key(pygame.K_DELETE)
    assert terrain(driver) == ()


def test_a_corner_that_would_cross_a_side_stays_where_it_was(driver):
    driver.click_at(1, -1.6)
    driver.press(driver.at(-2, -1))
    driver.move(driver.at(1, -3))
    assert driver.editor.pointer_tool.ghost() is None
    driver.release(driver.at(1, -3))
    assert len(terrain(driver)[0].polygon) == 4 and labels(driver) == []
    assert any("touch or cross" in notice for notice in driver.notices)


def test_the_whole_piece_is_dragged_scaled_and_deleted(driver):
    driver.click_at(1, -1.6)
    driver.drag((1, -1.6), (1, -1), (1, -0.6))
    assert terrain(driver)[0].polygon[0] == (-2, -1)
    driver.key(pygame.K_ESCAPE)
    driver.editor.select(frozenset({PIECE}))
    driver.frames(2)
    driver.fill(driver.editor.options.fields["width"][0], "3")
    assert terrain(driver)[0].polygon[1] == (2.5, -1)
    driver.key(pygame.K_DELETE)
    assert terrain(driver) == ()


def test_a_drag_that_begins_amid_ground_draws_a_box_and_on_its_edge_moves_it(driver):
    driver.drag((-1, -1.5), (0, 0), (5, 3))
    assert terrain(driver)[0].polygon[0] == (-2, -2)
    assert driver.editor.document.selection == {Item("body", "pair"), Item("body", "rope")}
    driver.drag((0, -1), (0, -1.2), (0, -1.5))
    assert terrain(driver)[0].polygon[0] == (-2, -2.5) and labels(driver) == ["Move"]


def test_a_box_selects_terrain_and_the_first_view_shows_all_of_it(edit):
    far = {"id": "far", "polyline": [[20, 10], [30, 12]]}
    driver = edit(small_level(terrain=[GROUND, far], walls={"box": [-40, -5, 40, 15]}, view=None))
    for place in ((30, 12), (-40, -5), (40, 15)):
        assert driver.editor.contains(driver.at(*place))
    driver.drag((-3, -3), (4, 0), (5, -0.5))
    assert driver.editor.document.selection == {PIECE}


def test_of_a_level_with_a_view_that_is_shown_first_and_its_ground_after_another_fit(edit):
    far = {"id": "far", "polygon": [[-90, -60], [90, -60], [90, -2]]}
    driver = edit(small_level(terrain=[far]))
    zoom = driver.editor.camera.zoom
    assert not driver.editor.contains(driver.at(90, -60))
    driver.key(pygame.K_f)
    assert driver.editor.contains(driver.at(89, -59)) and driver.editor.camera.zoom < zoom
    driver.key(pygame.K_f)
    assert driver.editor.camera.zoom == zoom


def test_contacts_and_walls_are_switched_on_the_page_of_the_level(edit):
    driver = edit()
    driver.editor.side.choose("level")
    driver.frames(2)
    form = driver.editor.side.page.form
    for name in ("contacts", "walls"):
        form.area.scroll_to(10_000)
        driver.frames(2)
        driver.click_widget(form.buttons[name])
        driver.frames(2)
    level = driver.editor.document.level
    assert level.contacts.friction == 0.5 and level.walls.box == (-6, 0, 6, 6)
    driver.fill(form.fields["contacts.friction"][0], "0.2")
    assert driver.editor.document.level.contacts.friction == 0.2
    driver.fill(form.fields["walls.box"][0], "-9, 0, 9, 5")
    assert driver.editor.document.level.walls.box == (-9, 0, 9, 5)
    driver.fill(form.fields["walls.box"][0], "9, 0, -9, 5")
    assert driver.editor.document.level.walls.box == (-9, 0, 9, 5)
    assert any("left and bottom" in notice for notice in driver.notices)


def test_a_finding_is_mended_by_its_button(edit):
    ball = {"id": "ball", "position": [1, -1.5], "radius": 0.2}
    driver = edit(small_level(terrain=[GROUND], particles=[ball]))
    driver.frames(30)
    driver.editor.side.choose("findings")
    driver.frames(2)
    page = driver.editor.side.page
    index = next(k for k, finding in enumerate(page.findings) if finding.remedy)
    page._show(index)
    driver.frames(2)
    driver.click_widget(page.mend)
    driver.frames(30)
    assert labels(driver) == ["Move it out"]
    assert not any(finding.remedy for finding in driver.editor.watch.findings)
    assert not page.mend.is_enabled


def test_the_place_of_a_clicked_corner_is_typed(driver):
    driver.click_at(1, -1.6)
    driver.frames(2)
    assert set(driver.editor.options.fields) == {"x", "y", "width", "height", "turn"}
    driver.click_at(4, -1)
    driver.frames(2)
    assert {name: field.text for name, (field,) in driver.editor.options.fields.items()} == {"x": "4", "y": "-1"}
    driver.fill(driver.editor.options.fields["x"][0], "3.75")
    driver.frames(2)
    assert terrain(driver)[0].polygon[2] == (3.75, -1) and labels(driver) == ["Move a corner"]
    assert driver.editor.options.fields["x"][0].text == "3.75"
