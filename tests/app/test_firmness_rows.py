"""The panel's rows of firmness: words, sag, frequency and ratio of one body or of all."""

import pytest

from sandbox.app.panel.softness_reading import MEASURING
from sandbox.editor.items import Item
from sandbox.level.kinds.body_def import FirmnessDef
from sandbox.level.reading.parse import parse_level
from sandbox.physics.ramps import SPRINGS, in_force
from sandbox.session.commands import AddBody, SetCoefficients, SetFirmness
from tests.support.wobbles import firm_level

AS_MADE = ["10", "2.28", "0.15"]
BOX = {"shape": {"box": [1, 1]}, "position": [0, 1], "spacing": 0.25}


@pytest.fixture
def jelly(open_app):
    """The app on a jelly box of 1 m that sags by a tenth."""
    driver = open_app(parse_level(firm_level({"sag": 0.1}, floor=True, **BOX), "jelly"))
    driver.measure()
    return driver


def texts(driver):
    rows = driver.panel.firmness
    return [field.text for field in (rows.sag, driver.entry("wobble"), driver.entry("wobble_ratio"))]


def test_the_rows_show_the_firmness_of_the_level_in_words_and_numbers(jelly):
    assert texts(jelly) == AS_MADE
    assert jelly.panel.firmness.words.chosen == "soft"
    assert jelly.panel.firmness.text.text.startswith("The body sags by 10 % of its height; swings")


def test_a_word_makes_the_body_so_and_is_undone(jelly):
    jelly.click_widget(jelly.panel.firmness.words.buttons["firm"])
    jelly.frames(2)
    assert texts(jelly)[0] == "2" and jelly.panel.firmness.words.chosen == "firm"
    jelly.playback.session.undo()
    jelly.frames(20)
    assert texts(jelly) == AS_MADE
    jelly.click_widget(jelly.panel.firmness.words.buttons["rigid"])
    jelly.frames(2)
    assert texts(jelly)[0] == "0" and jelly.panel.firmness.words.chosen == "rigid"


def test_what_is_chosen_is_read_at_once_and_comes_about_within_moments(jelly):
    session = jelly.playback.session
    before = jelly.world.stiffness[0]
    jelly.click_widget(jelly.panel.firmness.words.buttons["rigid"])
    jelly.frames(2)
    assert texts(jelly)[0] == "0" and jelly.world.stiffness[0] == 1.0
    assert before <= in_force(jelly.world, SPRINGS)[0][0] < 0.5
    command = session.history.log[-1].command
    assert command == SetFirmness(0, sag=0.0, duration=75)
    # A slider takes it over from there.
    jelly.fill(jelly.panel.form.fields["stiffness"][0], "0.5")
    jelly.frames(1)
    assert 0.0 < in_force(jelly.world, SPRINGS)[0][0] < 0.5 == jelly.world.stiffness[0]
    for _ in range(75):
        session.advance()
    assert not jelly.world.ramp_ticks.any() and in_force(jelly.world, SPRINGS)[0][0] == 0.5


def test_typed_numbers_are_taken_and_those_out_of_reach_become_the_nearest(jelly):
    rows = jelly.panel.firmness
    jelly.fill(rows.sag, "25 %")
    jelly.frames(2)
    assert texts(jelly)[0] == "25" and rows.words.chosen == "jelly"
    jelly.fill(jelly.entry("wobble"), "3")
    jelly.frames(2)
    assert texts(jelly)[1:] == ["3", "0.156"]
    jelly.fill(jelly.entry("wobble_ratio"), "0.1")
    jelly.frames(2)
    assert texts(jelly)[1:] == ["3", "0.156"]
    assert (
        "body: 3 Hz at ratio 0.1 is not possible here. It has the nearest value now: 3 Hz at ratio 0.156."
        in jelly.notices
    )
    jelly.fill(rows.sag, "90")
    jelly.frames(2)
    assert any(text.startswith("Sag: 90 is outside 0 to 40") for text in jelly.notices)


def test_cs_and_cd_end_the_firmness_and_the_rows_read_what_they_amount_to(jelly):
    panel = jelly.panel
    jelly.fill(panel.form.fields["stiffness"][0], "0.9")
    jelly.frames(2)
    assert not jelly.world.lowest_mode.any()
    assert texts(jelly)[0] not in ("10", "mixed")
    kinds = [type(entry.command) for entry in jelly.playback.session.history.log]
    assert kinds == [SetCoefficients]
    jelly.click_widget(panel.firmness.words.buttons["soft"])
    jelly.frames(2)
    assert [type(entry.command) for entry in jelly.playback.session.history.log] == [SetCoefficients, SetFirmness]
    assert texts(jelly) == ["10", "2.28", "0.15"]


def test_all_bodies_are_set_in_one_gesture_and_one_alone_where_it_is_chosen(open_app):
    import json

    data = json.loads(firm_level({"sag": 0.1}, floor=True, **BOX))
    data["bodies"].append({**data["bodies"][0], "id": "other", "position": [3, 1], "firmness": {"sag": 0.02}})
    data["bodies"].append({"type": "rope", "id": "rope", "start": [5, 3], "end": [7, 3], "segments": 4})
    driver = open_app(parse_level(json.dumps(data).encode(), "two"))
    rows = driver.panel.firmness
    driver.measure()
    assert rows.bodies == ["body", "other"] and texts(driver) == ["mixed"] * 3
    driver.click_widget(rows.words.buttons["hard"])
    driver.measure()
    assert texts(driver)[0] == "0.3"
    entries = driver.playback.session.history.log
    assert len(entries) == 2 and len({entry.gesture for entry in entries}) == 1
    driver.panel.choose_body("other")
    driver.click_widget(rows.words.buttons["jelly"])
    driver.measure()
    assert (
        texts(driver)[0] == "25"
        and driver.world.stiffness[0] != driver.world.stiffness[rows.playback.session.world.forms[1].springs[0]]
    )


def test_a_level_of_ropes_has_no_such_rows(driver):
    assert driver.panel.firmness.bodies == []


def test_the_editor_s_panel_takes_the_nearest_and_says_so(edit):
    driver = edit(parse_level(firm_level({"hz": 3.0, "ratio": 0.3}, floor=True, **BOX), "jelly"))
    driver.editor.select(frozenset([Item("body", "body")]))
    driver.frames(2)
    form = driver.editor.side.page.form
    driver.fill(form.fields["firmness.hz"][0], "10")
    driver.frames(2)
    assert driver.editor.document.level.bodies[0].firmness == FirmnessDef(hz=10.0, ratio=0.479)
    assert any("It has the nearest value now: 10 Hz at ratio 0.479" in notice for notice in driver.notices)


def test_the_menus_follow_bodies_that_join_a_run_and_are_taken_back(jelly):
    panel, session = jelly.panel, jelly.playback.session
    bodies, materials = panel.firmness.menu.words, panel.menu.words
    definition = {"type": "jelly", "position": [0, 4], "shape": {"box": [1, 1]}, "spacing": 0.25, "material": "dough"}
    session.submit(AddBody(definition, materials={"dough": {"stiffness": 0.4, "damping": 0.9}}))
    jelly.frames(10)
    assert panel.firmness.menu.words == [*bodies, "+1"] and len(panel.menu.words) == len(materials) + 1
    panel.choose_body("+1")
    panel.choose_material(len(materials) - 1)
    jelly.playback.session.undo()
    jelly.frames(20)
    assert (panel.firmness.menu.words, panel.menu.words) == (bodies, materials)
    assert panel.firmness.menu.chosen == bodies[0] and panel.menu.chosen == materials[0]
    assert texts(jelly) == AS_MADE


def test_the_editor_says_of_a_flat_box_the_word_and_the_sag_that_play_shows(edit, open_app):
    flat = {"shape": {"box": [2.5, 0.5]}, "position": [0, 0.5], "spacing": 0.25}
    level = parse_level(firm_level({"sag": 0.1}, floor=True, **flat), "flat")
    driver = edit(level)
    driver.editor.select(frozenset([Item("body", "body")]))
    shown = "firmness.measured"
    for _ in range(3_000):
        driver.pass_unseen()
        found = driver.editor.side.page.form.properties
        if shown in found and found[shown].value != MEASURING:
            break
    assert found["firmness"].value == "soft" and found["firmness.sag"].value == 10.0
    played = open_app(level)
    played.measure()
    rows = played.panel.firmness
    assert found[shown].value == f"{rows.words.chosen}, {rows.sag.text} %" == "soft, 10 %"
    driver.editor.select(frozenset())
    driver.frames(2)
    assert shown not in driver.editor.side.page.form.properties
