"""What the editor shows: pictures, ghosts, rulers, findings, forecasts, and large levels."""

import itertools

import numpy as np
import pygame
import pytest

from sandbox.app.base.shortcuts import shortcuts
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import BACKGROUND
from sandbox.app.edit.actions import MENU
from sandbox.app.edit.canvas.canvas import PLAIN_FROM, ScenePainter, SelectionMasks
from sandbox.app.edit.canvas.gestures import Handles
from sandbox.editor.scene import make_scene
from tests.app.conftest import small_level

LARGE = [{"type": "jelly", "id": "big", "shape": {"box": [4.0, 3.0]}, "spacing": 0.07}]


def pixels(driver):
    return pygame.surfarray.array3d(driver.app.display.surface).astype(int)


@pytest.fixture
def driver(edit):
    return edit(small_level())


@pytest.mark.parametrize(("place", "is_seen"), [(8.0, True), (200.0, False)])
def test_a_thing_far_from_the_levels_view_does_not_make_it_tiny(edit, place, is_seen):
    ball = {"id": "ball", "position": [place, 0.0], "mass": 1.0, "radius": 0.1}
    driver = edit(small_level(particles=[ball], view=[-4.0, -2.0, 4.0, 3.0]))
    driver.frames()
    surface = driver.app.display.surface
    assert (0 < driver.at(place, 0.0)[0] < surface.get_width()) == is_seen
    assert driver.at(4.0, 0.0)[0] - driver.at(-4.0, 0.0)[0] > surface.get_width() / 4
    driver.app.screen.fit()
    assert 0 < driver.at(place, 0.0)[0] < surface.get_width()


def test_parts_the_selection_and_the_ghost_are_seen(driver):
    plain = pixels(driver)
    x, y = (round(value) for value in driver.at(2.5, 0))
    assert np.abs(plain[x - 4 : x + 4, y - 4 : y + 4] - BACKGROUND).max() > 60
    driver.click_at(1, 0)
    assert np.abs(pixels(driver)[x - 4 : x + 4, y - 6 : y + 6] - plain[x - 4 : x + 4, y - 6 : y + 6]).max() > 20
    driver.key(pygame.K_a)
    driver.move(driver.at(3, 1))
    x, y = (round(value) for value in driver.at(3, 1))
    assert np.abs(pixels(driver)[x - 4 : x + 4, y - 4 : y + 4] - plain[x - 4 : x + 4, y - 4 : y + 4]).max() > 20


def test_undo_brings_back_into_view_what_is_selected_then(driver):
    driver.key(pygame.K_a, pygame.KMOD_CTRL)
    for _ in range(3):
        driver.key(pygame.K_d, pygame.KMOD_CTRL)
    assert not driver.editor.contains(driver.at(*small_level().bodies[0].start))
    for _ in range(3):
        driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.editor.contains(driver.at(*small_level().bodies[0].start))


def test_the_rulers_mark_where_the_pointer_is(driver):
    driver.move(driver.at(2.35, 1.3))
    before = pixels(driver)
    driver.move(driver.at(3.35, 2.3))
    changed = np.abs(pixels(driver) - before).max(axis=2) > 60
    left, top = driver.editor.camera.viewport[:2]
    columns = np.flatnonzero(changed[left:, top - 10]) + left
    assert {round(driver.at(2.35, 1.3)[0]), round(driver.at(3.35, 2.3)[0])} <= set(columns.tolist())


def test_a_large_scene_is_drawn_plainly_at_once_and_smoothly_afterwards():
    scene = make_scene(small_level(bodies=LARGE))
    assert len(scene.particle_a) > PLAIN_FROM
    camera = Camera((0.0, 0.0), 100.0, (0, 0, 640, 480))
    painter, chosen = ScenePainter(1.0), SelectionMasks.of(scene, frozenset())
    surface = pygame.Surface((640, 480), 0, 32)

    def drawn():
        painter.draw(surface, camera, scene, chosen, False)
        return pygame.surfarray.array3d(surface)

    plain = drawn()
    # However slow the computer is, a slice is made in every frame.
    for _ in range(100):
        smooth = drawn()
    assert (smooth != plain).any() and (drawn() == smooth).all()
    painter = ScenePainter(1.0)
    drawn()
    for _ in range(100):
        again = drawn()
    assert (again == smooth).all()


def test_findings_come_after_a_moment_and_a_place_can_be_shown(edit):
    driver = edit(small_level(settings={"solver": "direct"}))
    driver.frames(60)
    texts = [finding.text for finding in driver.editor.watch.findings]
    assert texts
    driver.editor.show((40.0, 0.0))
    driver.frames()
    assert driver.editor.contains(driver.at(40.0, 0.0))


def test_the_forecast_shows_where_a_rope_will_hang_and_changes_nothing(edit):
    driver = edit(small_level(settings={"solver": "direct"}))
    level = driver.editor.document.level
    driver.key(pygame.K_u)
    for _ in range(3000):
        driver.frames()
        if driver.editor.watch.hanging is not None:
            break
    hanging = driver.editor.watch.hanging
    assert hanging[driver.editor.scene.slot("rope.4")] == pytest.approx((0, -4), abs=0.3)
    assert driver.editor.document.level is level
    driver.key(pygame.K_u)
    assert driver.editor.watch.hanging is None


def test_the_window_can_be_resized_and_the_panel_hidden(driver):
    middle = driver.editor.camera.centre
    driver.app.display.window.size = (820, 480)
    driver.frames(2)
    assert driver.editor.camera.viewport[2] < 500 and driver.editor.camera.centre == middle
    driver.key(pygame.K_h)
    assert driver.editor.camera.viewport[0] + driver.editor.camera.viewport[2] == 820
    assert set(driver.editor.palette.tools) == set(driver.editor.pointer_tools)


def test_handles_lie_around_the_box_and_only_where_they_mean_something():
    camera = Camera((0.0, 0.0), 100.0, (0, 0, 640, 480))
    flat = Handles((-1.0, 0.0, 1.0, 0.0), camera, 1.0, uneven=True)
    assert set(flat.places) == {"left", "right"}
    even = Handles((-1.0, -1.0, 1.0, 1.0), camera, 1.0, uneven=False)
    assert set(even.places) == {"top left", "top right", "bottom left", "bottom right"}
    whole = Handles((-1.0, -1.0, 1.0, 1.0), camera, 1.0, uneven=True)
    assert whole.at(whole.knob) == "turn" and whole.at(whole.places["left"]) == "left" and whole.at((320, 240)) is None


@pytest.mark.parametrize(("even", "about_centre", "expected"), [
    (False, False, (1.5, 1.0, (-1.0, -1.0))), (True, False, (1.5, 1.5, (-1.0, -1.0))),
    (False, True, (2.0, 1.0, (0.0, 0.0))),
])  # fmt: skip
def test_a_corner_scales_about_the_opposite_one_or_the_middle(even, about_centre, expected):
    camera = Camera((0.0, 0.0), 100.0, (0, 0, 640, 480))
    handles = Handles((-1.0, -1.0, 1.0, 1.0), camera, 1.0, uneven=True)
    change = handles.scaling("top right", (1.0, 1.0), (2.0, 1.0), even, about_centre)
    assert (change.x, change.y, change.centre) == expected
    assert change.matrix @ (*expected[2], 1.0) == pytest.approx(expected[2])


def test_every_action_of_the_editor_is_in_the_table_and_the_other_way_round(driver):
    assert {entry.action for entry in shortcuts("edit") if entry.action} == set(driver.app.actions)


@pytest.mark.parametrize(("key", "mod", "said"), [
    (pygame.K_g, pygame.KMOD_CTRL | pygame.KMOD_SHIFT, "Nothing in the selection is in a group."),
    (pygame.K_u, pygame.KMOD_CTRL, "Nothing in the selection is joined to anything."),
    (pygame.K_PAGEDOWN, 0, "It is at the back already."),
])  # fmt: skip
def test_what_changes_nothing_says_why(driver, key, mod, said):
    driver.editor.select(frozenset([driver.editor.scene.items[0]]))
    driver.key(key, mod)
    assert said in driver.notices and driver.editor.history.index == 0


def test_no_action_fails_with_nothing_or_something_selected(driver):
    for chosen in (False, True):
        for name in sorted(driver.app.actions):
            if name in ("quit", "fullscreen"):
                continue
            driver.editor.select(frozenset(driver.editor.scene.items) if chosen else frozenset())
            driver.app.act(name)
            driver.frames(2)
            while driver.app.ui.has_sheet:
                driver.key(pygame.K_ESCAPE)
            if driver.app.mode == "play":
                driver.key(pygame.K_e)
                driver.rest()


def test_everything_that_is_done_by_key_is_done_by_a_button_too(driver):
    by_gesture = {"press", "finish", "cancel", "zoom_in", "zoom_out", "next_item", "previous_item", "numbers"}
    by_other_means = {
        "fullscreen",
        "larger",
        "smaller",
        "usual_size",
        "quit",
        "recordings",
        "next_page",
        "previous_page",
    }
    shown = set(driver.editor.bar.buttons) | {f"tool_{name}" for name in driver.editor.palette.tools} | set(MENU)
    in_boxes = {"group", "ungroup", "break_apart", "unjoin", "tour"}
    assert set(driver.app.actions) - shown - by_gesture - by_other_means - in_boxes == set()


def test_the_menu_offers_what_has_no_button(driver):
    driver.click_widget(driver.editor.bar.buttons["menu"])
    driver.choose("Select everything  [Ctrl+A]")
    assert len(driver.editor.document.selection) == 2


WHEEL = {"type": "wheel", "id": "w", "position": [1, 2], "radius": 1, "thickness": 0.3, "segments": 6}
ENDS = [{"id": "p", "position": [3, 0]}, {"id": "q", "position": [5, 0]}]


def seen(driver, x, y):
    """What the canvas shows around a point [m]."""
    driver.move((5, 5))
    left, top = (round(value) - 30 for value in driver.at(x, y))
    return pygame.surfarray.array3d(driver.app.display.surface.subsurface((left, top, 60, 60)))


def test_what_is_driven_is_marked_and_a_motor_by_the_way_it_turns(edit):
    driver = edit()

    def picture(x, y, **changes):
        driver.app.documents.edit_level(small_level(**changes))
        driver.frames(2)
        driver.rest()
        return seen(driver, x, y)

    def wheel(**more):
        return picture(1, 2, bodies=[{**WHEEL, **more}])

    def spring(**more):
        return picture(4, 0, particles=ENDS, springs=[{"a": "p", "b": "q", **more}])

    motor = {"torque": 5}
    wheels = [wheel(), *(wheel(motor={"speed": speed, **motor}) for speed in (3, -3, 0))]
    wheels.append(wheel(motor={"speed": 3, "key": "d", **motor}))
    springs = [
        spring(),
        spring(drive={"amplitude": 0.1, "period": 9}),
        spring(hydraulic={"shortest": 1, "longest": 2, "rate": 1}),
    ]
    for pictures in (wheels, springs):
        assert not any(np.array_equal(a, b) for a, b in itertools.combinations(pictures, 2))


def test_the_sheet_can_show_the_level_as_it_is_played_without_its_lattice(edit):
    box = {"type": "jelly", "id": "box", "position": [2, 1], "shape": {"box": [2, 2]}, "spacing": 0.5}
    driver = edit(small_level(bodies=[box]))
    driver.rest()
    with_lattice = seen(driver, 2, 1)
    driver.key(pygame.K_l, pygame.KMOD_SHIFT)
    driver.rest()
    without = seen(driver, 2, 1)
    # One skin in place of dots and lines: far fewer sudden steps from pixel to pixel.
    steps = [np.count_nonzero(np.abs(np.diff(picture.astype(int), axis=0)).sum(axis=2) > 90) for picture in
             (with_lattice, without)]  # fmt: skip
    assert steps[1] < steps[0] / 2
    driver.key(pygame.K_l, pygame.KMOD_SHIFT)
    driver.rest()
    assert np.array_equal(seen(driver, 2, 1), with_lattice)


BELT = {"id": "belt", "polygon": [[-2, -2.4], [3, -2.4], [3, -2], [-2, -2]]}


def test_a_belt_has_its_marks_on_the_sheet_also_while_it_is_chosen_and_dragged(edit):
    still, running = (edit(small_level(terrain=[{**BELT, "belt": speed}])) for speed in (0.0, 2.0))

    def strap(x, y):
        seen = []
        for driver in (still, running):
            driver.frames(2)
            at = tuple(round(value) for value in driver.at(x, y))
            seen.append(pixels(driver)[at[0] - 30 : at[0] + 30, at[1] - 3 : at[1] + 12])
        return np.count_nonzero(np.any(seen[0] != seen[1], axis=2))

    assert strap(0.0, -2.0) > 200
    for driver in (still, running):
        driver.click_at(0.5, -2.2)
    assert strap(0.0, -2.0) > 200
    for driver in (still, running):
        driver.press(driver.at(0.5, -2.2))
        driver.move(driver.at(0.5, -1.7))
        driver.move(driver.at(0.5, -1.2))
    assert strap(0.0, -1.0) > 200


def test_a_low_zone_has_its_name_above_it_and_hidden_things_are_counted_in_the_status(edit):
    zone = {"id": "gate", "box": [-2, 1.0, 1.0, 1.05]}
    named, other = (edit(small_level(zones=[{**zone, "id": name}])) for name in ("gate", "pool"))
    left, top = named.at(-2, 1.05)
    above = [pixels(each)[round(left) : round(left) + 40, round(top) - 14 : round(top) - 2] for each in (named, other)]
    assert np.any(above[0] != above[1])
    named.click_at(2.0, 0.0)
    named.key(pygame.K_h, pygame.KMOD_CTRL)
    assert ("1 hidden") in [text for text, _ in named.editor.status(None)]
