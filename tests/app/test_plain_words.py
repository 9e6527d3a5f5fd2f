"""What play says of itself: breaks in plain words, figures of the loop apart, one material at first."""

from functools import partial

import numpy as np
import pytest

from sandbox.app.contracts.screen import Figures
from sandbox.app.panel.panel import ALL_MATERIALS
from sandbox.app.run.followers import QUIET, Breaks
from sandbox.level.reading.files import load_level
from sandbox.session.session import Session
from tests.app.conftest import small_level

THREAD = {"stiffness": 0.9, "damping": 0.9, "tension_limit": 0.01}


def thread_level(**changes):
    """A rope that breaks under its weight, and a loose spring that does."""
    return small_level(
        settings={"solver": "direct"}, materials={"thread": THREAD},
        bodies=[{"type": "rope", "id": "swing", "start": [0, 0], "end": [2, 0], "segments": 4, "pin": ["start", "end"],
                 "material": "thread", "particle_mass": 50}],
        particles=[{"id": "a", "position": [0, 2], "pinned": True}, {"id": "b", "position": [0, 1], "mass": 500}],
        springs=[{"a": "a", "b": "b", "material": "thread"}],
        **changes,
    )  # fmt: skip


def told(level, *springs_by_tick):
    """What is said of springs that break tick by tick."""
    world, breaks, lines = Session(level).world, Breaks(level), []
    for springs in springs_by_tick:
        world.tick += 1
        world.broken = np.array([world.spring_names.index(name) for name in springs], dtype=np.int64)
        breaks.note(world)
        lines.append(breaks.text)
    return lines


def test_what_broke_is_said_by_the_name_of_the_thing_or_of_what_it_is_made_of():
    assert told(thread_level(), [":0"]) == ["The thread broke."]
    assert told(thread_level(), ["swing:1"]) == ["The swing broke."]


def test_several_breaks_make_one_line_that_grows_and_a_new_one_after_a_pause():
    lines = told(thread_level(), ["swing:1"], [], ["swing:2", "swing:3"], [":0"])
    assert lines == ["The swing broke."] * 2 + [
        "The swing broke in 3 places.", "The swing broke in 3 places; the thread broke."
    ]  # fmt: skip
    pause = [[] for _ in range(round(QUIET * 60) + 1)]
    assert told(thread_level(), ["swing:1"], *pause, [":0"])[-1] == "The thread broke."


def test_a_run_shows_one_notice_of_what_broke_without_ticks_or_numbers_of_springs(open_app):
    driver = open_app(thread_level())
    driver.frames(30)
    found = [text for text in driver.notices if "broke" in text]
    assert len(found) == 1 and "swing" in found[0] and "tick" not in found[0] and ":" not in found[0]


def test_the_status_line_shows_rates_and_the_work_of_a_frame_apart(driver):
    texts = [text for text, _ in driver.app.play.status(Figures(60.0, 58.4, 3.14))]
    assert {"60 ticks/s", "58 frames/s", "3.1 ms of work a frame"} <= set(texts)
    for _ in range(40):
        driver.app.frame(1 / 40)
    assert driver.app._figures.frames == pytest.approx(40.0, rel=0.1)


def test_sliders_begin_on_the_material_of_the_most_springs_and_all_is_a_choice_that_says_how_to_undo(driver):
    panel = driver.panel
    assert driver.world.material_names[panel.material] == "steel"
    assert panel.menu.chosen == "steel" and ALL_MATERIALS in panel.menu.words
    rubber = driver.world.material == list(driver.world.material_names).index("rubber")
    before = driver.world.stiffness.copy()
    panel.edit("Cs", partial(panel._set, "stiffness", value=0.2))
    driver.frames(1)
    assert (driver.world.stiffness[rubber] == before[rubber]).all() and not any("Ctrl+Z" in t for t in driver.notices)
    panel.choose_material(None)
    panel.edit("Cs", partial(panel._set, "stiffness", value=0.1))
    driver.frames(1)
    shown = driver.world.spring_active & (driver.world.material >= 0)
    assert (driver.world.stiffness[shown] == 0.1).all()
    assert any("all 2 materials" in text and "Ctrl+Z" in text for text in driver.notices)


def test_the_stub_of_the_balloons_rope_stays_on_the_ground():
    session = Session(load_level("balloons"))
    world = session.world
    for tick in range(300):
        if tick == 60:
            world.cut([world.spring_names.index("anchor rope:4")])
        session.advance()
    stub = [world.particle_slot(f"anchor rope.{k}") for k in range(5)]
    assert world.position[stub, 1].min() > -0.02 and world.position[stub, 1].max() < 0.3
