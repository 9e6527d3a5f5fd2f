"""Pages of the editor's panel in a low window: a list gives its room to what is chosen, and all scrolls as one."""

import pygame
import pytest

from tests.app.conftest import small_level

CHECKS = [
    {"name": name, "metric": "max_speed", "after": 0.1 * number, "at_most": 1.0}
    for number, name in enumerate(("still", "calm", "slow"), 1)
]


@pytest.fixture(params=[((1280, 720), 2.0), ((640, 480), 1.0), ((640, 480), 2.0)], ids=str)
def driver(edit, request):
    driver = edit(small_level(checks=CHECKS))
    size, scale = request.param
    driver.app.chosen.choose("scale", scale)
    driver.app.display.window.size = size
    driver.frames(2)
    if not driver.editor.show_side:
        driver.editor.toggle_side()
    return driver


def open_page(driver, name):
    driver.editor.side.choose(name)
    driver.frames(2)
    return driver.editor.side.page


def in_sight(area, widget):
    return area.view.rect.contains(widget.rect)


def scroll_to(driver, area, widget):
    """Scroll by the wheel until a widget is whole in sight."""
    turns = 0
    while not in_sight(area, widget):
        assert turns < 60
        driver._point_at(area.view.rect.center)
        driver.post(pygame.MOUSEWHEEL, y=-1, precise_y=-1.0, x=0, flipped=False)
        driver.frames()
        turns += 1


def test_materials_are_chosen_from_a_menu_and_their_fields_have_the_whole_page(driver):
    page = open_page(driver, "materials")
    assert page.chosen == "steel" and page.list.shown.detail.startswith("Cs 0.3")
    assert all(in_sight(page.area, button) for button in page.buttons.values())
    driver.click_widget(page.list)
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
    assert page.chosen == page.list.shown.text == "rubber"
    scroll_to(driver, page.area, page.form.fields["damping"][0])
    assert sum(in_sight(page.area, field) for (field, *_) in page.form.fields.values()) >= 2
    driver.fill(page.form.fields["damping"][0], "0.6")
    assert driver.editor.document.level.materials["rubber"].damping == 0.6
    scroll_to(driver, page.area, list(page.form.fields.values())[-1][0])


def test_checks_show_the_chosen_one_and_what_came_of_it(driver):
    page = open_page(driver, "checks")
    area = page.form.area
    assert page.list.shown.text == "still"
    driver.click_widget(page.list)
    driver.key(pygame.K_END)
    driver.key(pygame.K_RETURN)
    assert page.chosen == 2
    driver.click_widget(page.buttons[2])
    page.trial.wait()
    driver.frames(2)
    assert page.list.shown.detail.startswith("holds with 0")
    entry = page.form.fields["after"][0]
    scroll_to(driver, area, entry)
    driver.fill(page.form.fields["after"][0], "0.2")
    assert driver.editor.document.level.checks[2].after == 0.2
    area.scroll_to(0.0)
    driver.frames()
    for left in (2, 1, 0):
        driver.click_widget(page.buttons[1])
        assert len(driver.editor.document.level.checks) == left
    driver.click_widget(page.list)
    assert not driver.app.ui.has_sheet


def test_the_buttons_of_the_level_follow_its_last_row(driver):
    page = open_page(driver, "level")
    scroll_to(driver, page.form.area, page.no_view)
    driver.click_widget(page.from_camera)
    assert driver.editor.document.level.view is not None
    gap = page.pace.rect.top - end_of(page.form)
    assert gap > 0
    name = next(iter(page.form.buttons))
    page.form._press_object(name)
    driver.frames(2)
    assert page.pace.rect.top - end_of(page.form) == pytest.approx(gap, abs=2)


def end_of(form):
    return max(widget.rect.bottom for widget in form._holder.children)


def test_a_range_is_typed_tried_and_a_value_taken_on_a_low_page(driver):
    page = open_page(driver, "range")
    driver.app.ui.focus_on(page.list)
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
    title = page.form._sections[0].title
    scroll_to(driver, page.area, page.form.fields["How many"][0])
    driver.fill(page.form.fields["How many"][0], "3")
    driver.frames(60)
    assert len(page.list.rows) == 3
    page.area.scroll_to(0)
    driver.frames(2)
    assert all(in_sight(page.area, button) for button in page.buttons.values())
    driver.click_widget(page.list)
    driver.key(pygame.K_END)
    driver.key(pygame.K_RETURN)
    driver.click_widget(page.buttons["Take this value"])
    assert driver.editor.history.labels[-1].startswith(title)
