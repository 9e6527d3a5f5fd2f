"""What hands may do in a level is what bar, strip and panel show, and a press that is refused says what is wanted."""

import pygame
import pytest

from sandbox.app.panel.panel import MORE
from sandbox.app.widgets.dialogs import ask
from sandbox.level.reading.files import load_level
from sandbox.session.commands import CutSprings
from tests.app.conftest import small_level


def puzzle(*may, **hands):
    """The small level, in which hands may do that alone."""
    return small_level(hands={"may": list(may), **hands})


def offered(driver):
    bar = driver.app.play.toolbar
    return {*bar.buttons, *bar.left_out}


def test_where_the_panel_could_do_nothing_the_scene_has_its_room_and_its_key_says_so(open_app):
    driver = open_app(puzzle())
    play = driver.app.play
    assert play.panel is None and play.viewport[2] == driver.app.ui.size[0]
    assert not {"panel", "palette", "tool_cut", "tool_drag", "tool_pin"} & offered(driver)
    for key in (pygame.K_h, pygame.K_b, pygame.K_p, pygame.K_u):
        driver.key(key)
        assert driver.notices[-1] == "Hands do nothing here."
    assert play.panel is None and play.palette is None and driver.stage.tool_name == "drag"


@pytest.mark.parametrize(
    ("may", "shown"),
    [(("firmness",), (True, False, False, False)), (("material",), (False, True, False, False)),
     (("air",), (False, False, True, False)), (("solver",), (False, False, False, True))],
)  # fmt: skip
def test_the_panel_has_the_rows_of_what_hands_may_do_alone(open_app, may, shown):
    cube = {"type": "jelly", "id": "cube", "shape": {"box": [1, 1]}, "spacing": 0.5, "material": "steel"}
    level = small_level(hands={"may": list(may)}, bodies=[cube])
    panel = open_app(level).panel
    found = panel.firmness.shown, panel.note.visible, hasattr(panel.play, "gravity"), hasattr(panel.play, "melt")
    assert found == shown


def test_a_body_that_hands_may_not_touch_is_not_offered(open_app):
    driver = open_app(load_level("egg_drop"), more=False)
    assert driver.panel.firmness.offered == ["cushion"] and driver.panel.firmness.body == "cushion"
    assert driver.panel.pad is None or not driver.panel.note.visible


def test_a_press_that_is_refused_says_what_hands_may_do_and_grabs_nothing(open_app):
    driver = open_app(load_level("egg_drop"))
    x, y = driver.world.position[driver.world.owner == 0].mean(axis=0).tolist()
    driver.click(driver.stage.camera.to_pixels((x, y)))
    assert "Here hands may make bodies softer or firmer; key D does the rest." in driver.notices
    assert not driver.playback.session.history.timeline
    driver.frames(2)
    assert not any("not grab" in line for line in driver.notices)


def test_after_all_springs_of_a_material_are_gone_the_panel_says_so(driver):
    driver.panel.choose_material(list(driver.world.material_names).index("rubber"))
    driver.playback.submit(CutSprings((4,)))
    driver.frames(20)
    assert driver.panel.note.text.startswith("Nothing of it is left here")


def test_who_has_not_opened_more_reads_no_theory(open_app):
    driver = open_app(load_level("jelly_pile"), more=False)
    driver.measure()
    panel = driver.panel
    assert panel.maps is None and panel.note.text == "" and panel.firmness.text.text.startswith("They sag by at most")
    assert not any(word in panel.firmness.text.text for word in ("swings", "creeps", "at rest"))
    driver.app.play.fold(MORE)
    driver.measure()
    assert driver.panel.maps is not None and driver.panel.note.text


def test_a_level_with_ground_shows_more_of_what_is_above_it(open_app):
    driver = open_app(load_level("low_door"))
    _, top, _, height = driver.stage.camera.viewport
    _, ground = driver.stage.camera.to_pixels((-12.0, 0.0))
    assert top + height - ground < 0.4 * height


def test_enter_answers_a_dialog_after_a_click_beside_its_field(driver):
    answers = []
    ask(driver.app.ui, "Name it", "", "rope", "Save", answers.append)
    driver.frames(2)
    driver.app.ui.blur()
    driver.key(pygame.K_RETURN)
    assert answers == ["rope"] and not driver.app.ui.has_sheet
