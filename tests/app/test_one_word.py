"""One word for one softness: the row, the pad's knob, the thing menu and the editor say the same of the same body."""

import json
import struct

import pygame
import pytest

from sandbox.app.share.playing import playable
from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import load_level
from sandbox.level.reading.parse import parse_level
from sandbox.physics.jit import COMPILED
from sandbox.physics.softness.body_motion import read_body
from sandbox.physics.softness.firmness import WORDS, lowest_mode_of
from sandbox.session.commands import SetFirmness, apply
from sandbox.session.session import Session
from tests.support.wobbles import firm_level

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")
SLAB = {"shape": {"box": [2.5, 0.5]}, "position": [0, 0.32], "spacing": 0.125}


def pad_word(driver):
    driver.measure()
    driver.frames(20)
    return driver.panel.pad.state.word


@pytest.mark.parametrize(
    ("name", "body"), [("low_door", "bridge"), ("truck_bridge", "truck"), ("trampoline_basket", "bed")]
)
def test_the_knob_has_the_word_that_the_row_has_lit(open_app, name, body):
    # Hands of a level that asks something may not tune: there is no row then.
    driver = open_app(replaced(load_level(name), hands=None))
    driver.panel.choose_body(body)
    for word in ("soft", "firm", "hard", "rigid"):
        driver.click_widget(driver.panel.firmness.words.buttons[word])
        assert pad_word(driver) == driver.panel.firmness.words.chosen
        assert driver.panel.firmness.words.chosen in (word, "hard" if word == "rigid" else word)
    driver.fill(driver.panel.form.fields["stiffness"][0], "0.8")
    assert pad_word(driver) == driver.panel.firmness.words.chosen != ""


@pytest.mark.parametrize("word", ["jelly", "soft", "firm", "hard"])
def test_a_slab_that_the_editor_calls_by_a_word_is_called_so_in_play(open_app, word):
    driver = open_app(parse_level(firm_level({"sag": WORDS[word]}, floor=True, **SLAB), "slab"))
    assert pad_word(driver) == driver.panel.firmness.words.chosen == word
    assert float(driver.panel.firmness.sag.text) == pytest.approx(100 * WORDS[word], rel=0.05)


def test_the_menu_of_a_thing_makes_a_slab_what_it_says(open_app):
    driver = open_app(parse_level(firm_level({"sag": 0.02}, floor=True, **SLAB), "slab"))
    driver.measure()
    for index, word in enumerate(WORDS):
        driver.key(pygame.K_SPACE)
        driver.press(driver.pixel_of("body.50"), button=3)
        driver.release(driver.pixel_of("body.50"), button=3)
        for _ in range(index + 1):
            driver.key(pygame.K_DOWN)
        driver.key(pygame.K_RETURN)
        driver.key(pygame.K_SPACE)
        assert pad_word(driver) == driver.panel.firmness.words.chosen == word
        assert float(driver.panel.firmness.sag.text) == pytest.approx(100 * WORDS[word], rel=0.05)


def test_a_page_makes_the_level_s_slab_what_its_menu_says():
    level = parse_level(firm_level({"sag": 0.02}, floor=True, **SLAB), "slab")
    content = playable(level).content
    (length,) = struct.unpack_from("<I", content)
    made = json.loads(content[4 : 4 + length])["about"]["adding"]["made"]
    session = Session(level)
    for word, asked in made["firmness"][0].items():
        apply(session.world, SetFirmness(0, **asked))
        read = read_body(session.world, session.world.forms[0], lowest_mode_of(session.world.forms[0].shape))
        assert read.sag == pytest.approx(WORDS[word], rel=0.01, abs=1e-6)
    assert list(made["firmness"][0]) == list(made["sags"]) == list(WORDS)
