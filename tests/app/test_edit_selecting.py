"""Selecting and changing what is selected, by mouse, handles, keys and numbers."""

import numpy as np
import pygame
import pytest

from sandbox.editor.document import Document, empty_level
from sandbox.editor.edits.copying import place_part
from sandbox.editor.items import Item
from sandbox.editor.storage.level_file import catalogue
from tests.app.conftest import small_level
from tests.support.zoo import zoo

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
ROPE, PAIR = Item("body", "rope"), Item("body", "pair")


@pytest.fixture
def driver(edit):
    return edit(small_level())


def selected(driver):
    return set(driver.editor.document.selection)


def body(driver, name="rope"):
    return next(body for body in driver.editor.document.level.bodies if body.id == name)


def test_a_click_selects_shift_adds_and_ctrl_takes_away(driver):
    driver.click_at(1, 0)
    assert selected(driver) == {ROPE}
    driver.click_at(1, 2, SHIFT)
    assert selected(driver) == {ROPE, PAIR}
    driver.click_at(1, 0, CTRL)
    assert selected(driver) == {PAIR}
    driver.click_at(2, -2)
    assert selected(driver) == set()


def test_a_box_selects_what_lies_in_it_whole(driver):
    driver.drag((-0.5, 1.5), (0, 1.8), (1.5, 2.5))
    assert selected(driver) == {PAIR}
    driver.drag((-0.5, -0.5), (3, 0.2), (4.4, 0.5), mods=SHIFT)
    assert selected(driver) == {ROPE, PAIR}
    driver.drag((-0.5, 1.5), (0, 1.8), (1.5, 2.5), mods=CTRL)
    assert selected(driver) == {ROPE}


def test_a_lasso_selects_what_lies_inside(driver):
    driver.key(pygame.K_l)
    driver.drag((-0.5, 1.5), (1.5, 1.4), (1.6, 2.5), (0.5, 2.9), (-0.6, 2.4))
    assert selected(driver) == {PAIR}


def grouped(driver):
    """Everything in one group, and nothing selected."""
    driver.key(pygame.K_a, CTRL)
    driver.key(pygame.K_g, CTRL)
    driver.key(pygame.K_ESCAPE)


def test_a_click_takes_the_whole_group_and_a_double_click_enters_it(driver):
    grouped(driver)
    driver.click_at(1, 0)
    assert selected(driver) == {ROPE, PAIR}
    driver.click(driver.at(1, 0))
    driver.click(driver.at(1, 0))
    assert selected(driver) == {ROPE}
    assert "In group" in driver.editor.pointer_tool.hint
    driver.rest()
    driver.click_at(0.5, 2.2)
    assert selected(driver) == {PAIR}
    driver.key(pygame.K_ESCAPE)
    assert selected(driver) == {ROPE, PAIR} and "In group" not in driver.editor.pointer_tool.hint
    driver.key(pygame.K_ESCAPE)
    assert selected(driver) == set()


def test_a_click_in_the_open_leaves_the_group(driver):
    grouped(driver)
    for _ in range(2):
        driver.click(driver.at(1, 0))
    assert selected(driver) == {ROPE}
    driver.rest()
    driver.click_at(-1, -1)
    driver.rest()
    driver.click_at(1, 0)
    assert selected(driver) == {ROPE, PAIR}


def test_a_box_around_a_member_takes_the_whole_group(driver):
    grouped(driver)
    driver.drag((-0.5, 1.5), (0, 1.8), (1.5, 2.5))
    assert selected(driver) == {ROPE, PAIR}


@pytest.mark.parametrize("name", [part.path.stem for part in catalogue()])
def test_a_ready_part_is_dragged_whole(edit, name):
    part = next(part for part in catalogue() if part.path.stem == name)
    driver = edit(place_part(Document(empty_level()), part.level, (0.0, 0.0)).level)
    before = driver.editor.scene.position.copy()
    x, y = before[np.argmax(before[:, 0])]
    driver.drag((x, y), (x + 0.7, y + 0.2), (x + 1.5, y + 0.5))
    moved = driver.editor.scene.position - before
    assert len(selected(driver)) == len(driver.editor.scene.items) and np.abs(moved).max() > 0.4
    assert moved == pytest.approx(np.broadcast_to(moved[0], moved.shape), abs=1e-9)


def test_dragging_an_item_moves_it_by_the_grid_and_undo_brings_the_very_level_back(driver):
    before = driver.editor.document.level
    driver.drag((2, 0), (2, -0.5), (2, -1))
    assert body(driver).start == pytest.approx((0, -1)) and body(driver).end == pytest.approx((4, -1))
    assert driver.editor.history.labels[-1] == "Move"
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level is before


def test_a_drag_shows_the_selection_where_it_will_be_and_escape_gives_it_up(driver):
    before = driver.editor.document.level
    driver.press(driver.at(2, 0))
    driver.move(driver.at(2, 0.5))
    driver.move(driver.at(2, 1))
    assert driver.editor.pointer_tool.transform[1, 2] == pytest.approx(1.0)
    driver.key(pygame.K_ESCAPE)
    driver.release(driver.at(2, 1))
    assert driver.editor.document.level is before


def test_an_end_that_is_dropped_on_a_particle_joins_it_and_undo_parts_them(driver):
    driver.drag((0, 2), (0.5, 1.5), (1.5, 0.2), (2, 0))
    assert driver.editor.document.level.welds
    assert body(driver, "pair").start == pytest.approx((2, 0))
    driver.key(pygame.K_z, CTRL)
    assert not driver.editor.document.level.welds


def test_a_rope_alone_is_made_longer_by_its_ends_and_has_no_squares_beside_them(driver):
    driver.editor.select(frozenset([ROPE]))
    handles = driver.editor.pointer_tool.handles()
    assert handles.places == {} and handles.at(handles.knob) == "turn"
    driver.editor.select(frozenset([ROPE, PAIR]))
    assert "top right" in driver.editor.pointer_tool.handles().places


def test_handles_scale_about_the_other_side_and_the_knob_turns(driver):
    driver.click_at(1, 0)
    handles = driver.editor.pointer_tool.handles()
    assert "right" not in handles.places or "top" not in handles.places
    driver.key(pygame.K_a, CTRL)
    handles = driver.editor.pointer_tool.handles()
    corner = handles.places["top right"]
    driver.press(corner)
    driver.move((corner[0] + 10, corner[1] - 10))
    driver.move((corner[0] + 60, corner[1] - 30))
    driver.release((corner[0] + 60, corner[1] - 30))
    assert driver.editor.history.labels[-1] == "Scale"
    assert body(driver).start == pytest.approx((0, 0), abs=1e-9) and body(driver).end[0] > 4.1
    knob = driver.editor.pointer_tool.handles().knob
    driver.press(knob)
    driver.move((knob[0] + 20, knob[1] + 5))
    x, y = driver.at(*np.reshape(driver.editor.selection_box, (2, 2)).mean(axis=0))
    driver.move((x + 200, y))
    driver.release((x + 200, y))
    assert driver.editor.history.labels[-1] == "Turn"
    start, end = body(driver).start, body(driver).end
    assert start[0] == pytest.approx(end[0], abs=1e-9) and end[1] < start[1]


def test_arrow_keys_nudge_as_one_step_and_shift_ten_times_as_far(driver):
    driver.click_at(1, 0)
    grid = driver.editor.grid
    for _ in range(3):
        driver.key(pygame.K_UP)
    driver.key(pygame.K_RIGHT, SHIFT)
    assert body(driver).start == pytest.approx((10 * grid, 3 * grid))
    assert driver.editor.history.labels == ["Open", "Nudge"]


def test_typed_numbers_place_size_and_turn_the_selection(driver):
    driver.click_at(1, 0)
    driver.frames(2)
    fields = driver.editor.options.fields
    driver.fill(fields["x"][0], "10")
    assert body(driver).start == pytest.approx((8, 0))
    driver.fill(fields["width"][0], "2")
    assert (body(driver).start, body(driver).end) == (pytest.approx((9, 0)), pytest.approx((11, 0)))
    driver.fill(fields["turn"][0], "90")
    assert body(driver).end == pytest.approx((10, 1))
    driver.fill(fields["y"][0], "up")
    assert any("not a number" in text for text in driver.notices)


def test_mirror_order_align_and_array_are_asked_for_in_boxes(driver):
    driver.click_at(1, 0)
    driver.key(pygame.K_m)
    driver.choose("Left and right")
    assert body(driver).start == pytest.approx((4, 0))
    driver.key(pygame.K_z)
    driver.choose("To the front")
    assert [each.id for each in driver.editor.document.level.bodies] == ["pair", "rope"]
    driver.key(pygame.K_a, CTRL)
    driver.key(pygame.K_i)
    driver.choose("Left edges")
    assert min(body(driver, "pair").start[0], body(driver, "pair").end[0]) == pytest.approx(0.0)
    driver.click_at(0.5, 2)
    driver.key(pygame.K_d, CTRL | SHIFT)
    driver.choose("Along a line")
    driver.key(pygame.K_RETURN)
    assert len(driver.editor.document.level.bodies) == 6
    assert not driver.app.ui.has_sheet


def test_a_wrong_number_in_a_box_is_said_there_and_nothing_is_made(driver):
    driver.click_at(1, 0)
    driver.key(pygame.K_d, CTRL | SHIFT)
    driver.choose("Along a line")
    driver.type("many")
    driver.key(pygame.K_RETURN)
    assert driver.app.ui.has_sheet and len(driver.editor.document.level.bodies) == 2
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.ui.has_sheet


def test_delete_duplicate_and_next_item_work_by_key(driver):
    driver.key(pygame.K_n)
    assert selected(driver) == {ROPE}
    driver.key(pygame.K_n)
    assert selected(driver) == {PAIR}
    driver.key(pygame.K_d, CTRL)
    assert len(driver.editor.document.level.bodies) == 3
    driver.key(pygame.K_DELETE)
    assert len(driver.editor.document.level.bodies) == 2
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_DELETE)
    assert any("Nothing is selected" in text for text in driver.notices)


def test_a_copy_lies_beside_what_it_is_of(driver):
    driver.editor.select(frozenset([ROPE]))
    driver.key(pygame.K_d, CTRL)
    rope, copy = driver.editor.document.level.bodies[0], driver.editor.document.level.bodies[-1]
    assert rope.end[0] < copy.start[0] <= rope.end[0] + 3 * driver.editor.grid and copy.start[1] == rope.start[1]


def test_all_of_a_material_is_selected(driver):
    driver.key(pygame.K_m, CTRL)
    driver.key(pygame.K_END)
    driver.key(pygame.K_RETURN)
    assert selected(driver) == {PAIR}


def test_what_cannot_be_done_is_said_and_changes_nothing(driver):
    before = driver.editor.document.level
    driver.click_at(1, 0)
    driver.frames(2)
    driver.fill(driver.editor.options.fields["x"][0], "1e7")
    assert driver.editor.document.level is before
    assert driver.notices


def test_undo_and_redo_keep_the_selection(driver):
    driver.key(pygame.K_a, CTRL)
    driver.drag((2, 0), (2, -0.5), (2, -1))
    assert driver.editor.history.labels[-1] == "Move"
    for key in (pygame.K_z, pygame.K_y):
        driver.key(key, CTRL)
        assert selected(driver) == {ROPE, PAIR}


def test_a_body_that_is_taken_anywhere_moves_by_whole_steps_of_the_grid(edit):
    driver = edit()
    driver.key(pygame.K_q)
    driver.drag((-1, 0), (0, 0), (0.5, 0))
    driver.key(pygame.K_v)
    rim = driver.editor.scene.position[5].tolist()
    grid = driver.editor.grid
    driver.click_at(*rim)
    driver.drag(rim, (rim[0], rim[1] + grid), (rim[0] + 1.9 * grid, rim[1] + 1.1 * grid))
    (wheel,) = driver.editor.document.level.bodies
    assert wheel.position == pytest.approx((-1 + 2 * grid, grid), abs=1e-9)


def test_all_of_many_materials_can_be_chosen_to_select_by(edit):
    materials = {f"material {number}": {"stiffness": 0.3, "damping": 0.3} for number in range(30)}
    bodies = [
        {"type": "rope", "id": f"rope {number}", "start": [0, number], "end": [4, number], "segments": 4,
         "material": f"material {number}"}
        for number in range(30)
    ]  # fmt: skip
    driver = edit(small_level(materials=materials, bodies=bodies))
    driver.app.act("select_material")
    driver.key(pygame.K_END)
    driver.app.rebuild()
    driver.key(pygame.K_END)
    driver.key(pygame.K_RETURN)
    assert driver.editor.document.selection == {Item("body", "rope 29")}
    assert not driver.app.ui.has_sheet


@pytest.mark.parametrize("kind", ["rope", "bridge", "girder"])
def test_an_end_of_a_rope_a_bridge_or_a_girder_is_dragged_alone(edit, kind):
    level = small_level()
    zoo_body = next(body for body in zoo().bodies if body.type == kind)
    moved = zoo_body.model_copy(update={"id": "span", "start": (0.0, 0.0), "end": (4.0, 0.0), "pose": None, "cut": ()})
    driver = edit(
        level.model_copy(update={"bodies": (moved,), "checks": (), "materials": zoo().materials, "welds": ()})
    )
    driver.editor.select(frozenset([Item("body", "span")]))
    driver.frames(1)
    driver.drag((4, 0), (4.5, 0.5), (5, 1))
    span = driver.editor.document.level.bodies[0]
    assert span.end == pytest.approx((5.0, 1.0), abs=0.01) and span.start == (0.0, 0.0)
    driver.key(pygame.K_z, CTRL)
    assert driver.editor.document.level.bodies[0].end == (4.0, 0.0)


def test_an_end_that_is_dragged_leaves_its_joint_and_joins_what_it_comes_onto(driver):
    driver.click_at(1, 0)
    rope = body(driver)
    driver.drag(rope.end, (2.0, 1.0), (1.0, 2.0))
    level = driver.editor.document.level
    assert level.welds and body(driver).start == rope.start
    driver.drag((1.0, 2.0), (3.0, -1.0), (4.0, -1.0))
    assert driver.editor.document.level.welds == () and body(driver).end == pytest.approx((4.0, -1.0), abs=0.01)


def test_a_drag_with_ctrl_leaves_what_is_selected_and_puts_a_copy_elsewhere(driver):
    driver.click_at(0.5, 2)
    before = body(driver, "pair")
    driver.drag((0.5, 2), (1, 2.5), (2.5, 3), mods=CTRL)
    copy = driver.editor.document.level.bodies[-1]
    assert body(driver, "pair") == before and copy.id == "pair 2"
    assert np.allclose(np.subtract(copy.start, before.start), (2, 1)) and selected(driver) == {Item("body", "pair 2")}
    assert driver.editor.history.labels[-1] == "Duplicate"


def test_a_mirrored_copy_leaves_the_first_and_stands_beside_it(driver):
    driver.click_at(0.5, 2)
    driver.key(pygame.K_m)
    driver.choose("A copy to the right")
    first, copy = body(driver, "pair"), driver.editor.document.level.bodies[-1]
    assert first.start == (0.0, 2.0) and copy.start == (2.0, 2.0) and copy.end == (1.0, 2.0)
    assert driver.editor.history.labels[-1] == "Mirrored copy"


def test_an_array_fills_rows_and_columns_in_one_step(driver):
    driver.click_at(0.5, 2)
    driver.key(pygame.K_d, CTRL | SHIFT)
    driver.choose("In rows and columns")
    for text in ("3", "2", "2", "1.5"):
        driver.app.ui.focus.typed = ""
        driver.type(text)
        driver.key(pygame.K_TAB)
    driver.choose("Make")
    starts = {body.start for body in driver.editor.document.level.bodies if body.id.startswith("pair")}
    assert starts == {(2.0 * x, 2.0 + 1.5 * y) for x in range(3) for y in range(2)}
    driver.key(pygame.K_z, CTRL)
    assert len(driver.editor.document.level.bodies) == 2


def test_a_step_of_the_grid_that_was_set_holds_at_every_zoom(driver):
    driver.key(pygame.K_x, SHIFT)
    driver.type("0.3")
    driver.key(pygame.K_RETURN)
    driver.editor.camera.zoom_at(None, 5)
    driver.click_at(0.5, 2)
    driver.key(pygame.K_RIGHT)
    assert np.allclose(body(driver, "pair").start, (0.3, 2.0))
    driver.key(pygame.K_x, SHIFT)
    driver.type("-1")
    driver.key(pygame.K_RETURN)
    assert driver.app.ui.has_sheet and driver.editor.grid == 0.3
