"""A real window on a virtual screen, driven by xdotool: drag, slide, pause, record, save; the replay verifies."""

import numpy as np
import pygame
import pytest

from sandbox.app.base.display import WINDOW_SIZE
from sandbox.level.reading.files import write_level
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.app.conftest import Driver, small_level
from tests.support.person import DEADLINE, Person, needs_a_screen

pytestmark = needs_a_screen


@pytest.mark.slow
def test_a_person_drags_slides_pauses_records_and_saves_and_the_replay_verifies(screen, tmp_path, open_app):
    level = small_level()
    write_level(level, tmp_path / "small.json")
    # The same app without a display says where things are on the screen.
    twin: Driver = open_app(level, more=False)
    twin.app.display.window.size = WINDOW_SIZE
    twin.frames(2)
    more = next(each for each in twin.panel.area.content.children if getattr(each, "text", "") == "More").rect.center
    twin.click(more)
    start = twin.pixel_of("rope.4")
    pad = twin.panel.pad
    places = [pygame.Vector2(pad.rect.topleft) + pad._at(value, 0.3) for value in (0.1, 0.05, 0.01)]

    person = Person(screen, ["play", str(tmp_path / "small.json")], tmp_path)
    try:
        person.wait_for("Small", "playing")
        person.click(more)
        person.do("key", "ctrl+r")
        person.wait_for("recording")
        person.drag([start, *((start[0] - 9 * k, start[1] - 15 * k) for k in range(8))], while_held="holding 1")
        person.wait_for("Small", without="holding")
        person.drag(places)
        person.do("key", "k")
        person.wait_for("paused")
        person.do("key", "ctrl+r")
        person.wait_for("dialog")
        person.do("type", "by hand")
        person.do("key", "Return")
        person.wait_for("paused", without="dialog")
        person.do("key", "ctrl+q")
        assert person.app.wait(DEADLINE) == 0
    finally:
        person.app.kill()

    replay = read_replay(tmp_path / "documents" / "Spring Sandbox" / "by hand.replay.jsonl")
    assert verify(replay) is None
    session = Session(replay.level, replay.script)
    while session.tick < replay.ticks:
        session.advance()
    session.apply_pending()
    moved = session.world.position[4] - (4.0, 0.0)
    assert np.abs(moved).max() > 0.2
    assert 0.005 < session.world.stiffness[0] < 0.02
