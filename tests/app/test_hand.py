"""The hand in the window: how strong it is, what it says about its force, what of it a recording holds."""

import pygame
import pytest

from sandbox.app.draw.colours import ACCENT, WARNING, packed
from sandbox.app.play.hand_labels import newtons, text_of
from sandbox.app.play.stage import Stage
from sandbox.physics.analysis.applied_forces import Pull
from sandbox.session.commands import Grab
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.tools.drag import STRENGTHS
from tests.app.conftest import small_level

CTRL = pygame.KMOD_CTRL


def soft_level():
    """A box of jelly beside the rope."""
    rope = small_level().bodies[0].model_dump(mode="json", exclude_unset=True)
    box = {"type": "jelly", "id": "box", "shape": {"box": [1, 1]}, "position": [2, 2], "spacing": 0.25}
    return small_level(bodies=[rope, box])


def grabs(driver):
    return [entry.command for entry in driver.playback.session.history.log if isinstance(entry.command, Grab)]


def test_a_key_makes_the_hand_gentle_normal_or_strong_and_the_next_hold_is_so(driver):
    seen = []
    for _ in STRENGTHS:
        driver.key(pygame.K_t)
        driver.press(driver.pixel_of("rope.3"))
        driver.release(driver.pixel_of("rope.3"))
        seen.append((driver.stage.drag.strength, grabs(driver)[-1].strength))
    assert seen == [("strong", 300.0), ("gentle", 30.0), ("normal", 100.0)]
    assert any("gentle" in notice for notice in driver.notices)


def test_the_panel_shows_and_sets_the_strength_which_later_runs_and_starts_keep(driver, open_app):
    driver.take_sliders()
    driver.click_in_panel(driver.panel.world.form.choices["hand"].buttons["gentle"])
    assert driver.stage.drag.strength == "gentle"
    driver.key(pygame.K_r)
    assert driver.stage.drag.strength == "gentle"
    again = open_app(small_level())
    assert again.stage.drag.strength == "gentle"
    assert again.panel.world.form.choices["hand"].buttons["gentle"].is_selected


def test_what_is_held_keeps_its_hand_when_another_strength_is_chosen(driver):
    pygame.key.set_mods(pygame.KMOD_SHIFT)
    driver.click(driver.pixel_of("rope.4"))
    pygame.key.set_mods(0)
    driver.key(pygame.K_t)
    assert driver.world.is_held(0) and driver.world.hand_strength[0] == 100.0
    assert any("hold keeps its strength" in notice for notice in driver.notices)


@pytest.mark.parametrize("strength", list(STRENGTHS))
def test_recordings_with_every_strength_verify_and_undo_takes_them_back(documents, open_app, strength):
    driver = open_app(soft_level())
    driver.stage.drag.strength = strength
    driver.key(pygame.K_r, CTRL)
    for name in ("rope.3", "box.7"):
        start = driver.pixel_of(name)
        driver.press(start)
        for step in range(12):
            driver.move((start[0] + 5 * step, start[1] - 11 * step))
        driver.release((start[0] + 55, start[1] - 121))
    moved = driver.world.position.copy()
    driver.key(pygame.K_z, CTRL)
    driver.key(pygame.K_y, CTRL)
    driver.frames(3)
    driver.key(pygame.K_r, CTRL)
    driver.key(pygame.K_RETURN)
    replay = read_replay(next(documents.iterdir()))
    assert verify(replay) is None
    held = [line.record for line in replay.script if line.record["type"] == "grab"]
    assert [record["strength"] for record in held] == [STRENGTHS[strength]] * 2
    assert held[0]["radius"] == 0.0 and held[1]["radius"] > 1.0
    assert abs(moved - driver.world.origin).max() > 0.3


def test_the_line_says_what_it_pulls_and_changes_colour_at_its_limit(driver, monkeypatch):
    pixel = driver.pixel_of("rope.4")
    driver.press(pixel)
    driver.move((pixel[0], pixel[1] - 20))
    driver.frames(120)
    (pull,) = driver.stage.pulls()
    assert pull.force < 0.5 * pull.limit and text_of(pull) == [newtons(pull.force)]
    assert colour_at(driver, 0.0) == packed(ACCENT)
    # Farther than a rope of steel that is pinned lets itself be stretched.
    driver.stage.drag.strength = "gentle"
    driver.move((pixel[0] + 150, pixel[1]))
    driver.frames(200)
    strained = Pull(pull.cursor, pull.particle, pull.limit, pull.limit, True)
    monkeypatch.setattr(Stage, "pulls", lambda stage: [strained])
    driver.frames()
    assert text_of(strained) == ["400 N of 400 N", "pinned: the body can only bend"]
    assert colour_at(driver, 0.0) == packed(WARNING)


def colour_at(driver, share):
    """The colour of the middle of the disc at the particle that hand 0 holds."""
    spring = driver.world.grab_spring
    x, y = driver.stage.camera.to_pixels(tuple(driver.playback.current.position[driver.world.particle_b[spring]]))
    return driver.app.display.surface.get_at_mapped((round(x), round(y))) & 0xFFFFFF


@pytest.mark.parametrize(
    ("force", "text"),
    [
        (0.0, "0 N"), (0.0123, "12.3 mN"), (3.456, "3.46 N"), (412.3, "412 N"), (999.7, "1000 N"), (1000.0, "1 kN"),
        (75_000.0, "75 kN"), (2.925e6, "2.92 MN"),
    ],
)  # fmt: skip
def test_forces_are_written_in_three_digits(force, text):
    assert newtons(force) == text
