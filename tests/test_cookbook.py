"""The cookbook: its page is what its level files say, and each of them is sound, runs and keeps its checks."""

import numpy as np
import pytest
from PIL import Image

from sandbox.editor.lint.lint import findings
from sandbox.editor.scene import make_scene
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import read_level
from sandbox.level.reading.pictures import pictures_of
from sandbox.physics.analysis.query import shown_particles
from sandbox.session.check_run import HeldKeys, run_checks
from sandbox.session.session import Session
from tests.pictures import cookbook

NAMES = list(cookbook.RECIPES)


def test_the_page_is_what_the_level_files_say():
    assert cookbook.PAGE.read_text(encoding="utf-8") == cookbook.page(), "python -m tests.pictures cookbook"


def test_every_level_of_the_folder_is_a_recipe_with_a_picture():
    assert {path.stem for path in cookbook.FOLDER.glob("*.json")} == set(NAMES)
    assert {path.name for path in cookbook.FOLDER.iterdir()} == {
        path.name for name in NAMES for path in (cookbook.path_of(name), cookbook.picture_of(name))
    } | {picture for name in NAMES for picture in pictures_of(read_level(cookbook.path_of(name)))}
    assert len(NAMES) >= 20


@pytest.mark.parametrize("name", NAMES)
def test_a_recipe_is_canonical_short_and_has_a_view_of_the_picture_s_form(name):
    level, text = read_level(cookbook.path_of(name)), cookbook.path_of(name).read_text(encoding="utf-8")
    assert level_text(level) == text
    assert level.description and len(text.splitlines()) <= 100
    left, bottom, right, top = level.view
    assert (right - left) / (top - bottom) == pytest.approx(cookbook.SIZE[0] / cookbook.SIZE[1], abs=0.01)


@pytest.mark.parametrize("name", NAMES)
def test_the_editor_finds_nothing_wrong_with_a_recipe(name):
    level = read_level(cookbook.path_of(name))
    assert [finding.text for finding in findings(level, make_scene(level)) if finding is not None] == []


@pytest.mark.parametrize("name", NAMES)
def test_a_recipe_runs_for_two_seconds_without_a_fault(name):
    level = read_level(cookbook.path_of(name))
    session = Session(level)
    keys = HeldKeys(level, [hold for check in level.checks for hold in check.hold])
    for _ in range(2 * level.settings.tick_rate):
        keys.press(session)
        session.advance()
    assert np.isfinite(session.world.position).all() and np.isfinite(session.world.velocity).all()
    broken = [message for message in session.messages if not message.endswith(" broke")]
    assert broken == [] and bool(session.messages) == (name == "breaking_bridge")


@pytest.mark.parametrize("name", NAMES)
def test_a_recipe_keeps_its_checks(name):
    results = run_checks(read_level(cookbook.path_of(name)))
    assert [result.text for result in results if not result.passed] == []


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_outside_the_frame_of_a_picture(name):
    session, (left, bottom, right, top) = cookbook.at_best(name)
    world = session.world
    shown = shown_particles(world)
    low = (world.position - world.radius[:, None])[: len(shown)][shown]
    high = (world.position + world.radius[:, None])[: len(shown)][shown]
    assert np.all((low >= (left, bottom)) & (high <= (right, top)))


@pytest.mark.parametrize("name", NAMES)
def test_the_picture_of_a_recipe_is_small_and_shows_something(name):
    path = cookbook.picture_of(name)
    assert path.stat().st_size <= 20_000
    with Image.open(path) as picture:
        assert picture.size == cookbook.SIZE
        # The stage alone is a calm gradient.
        assert np.asarray(picture.convert("L")).std() > 8.0
