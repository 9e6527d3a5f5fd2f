"""Settings: what is chosen holds at once and at the next start; keys can be given away, and nothing is lost."""

import json
from types import SimpleNamespace

import pygame
import pytest

from sandbox.app.base.shortcuts import action_of, combination_of, shortcuts, use_keys, with_keys
from sandbox.app.draw.colours import BACKGROUND, show_theme, shown_theme
from sandbox.app.draw.renderer import FULL, NO_EFFECTS
from sandbox.app.settings.chosen import SETTINGS, Address, Amount, Chosen, OneOf, theme_of
from sandbox.app.settings.settings_sheet import KeyRow
from sandbox.app.widgets.widget import Widget
from sandbox.editor.storage.preferences import (
    preference,
    preferences_file,
    set_aside_broken,
    set_preference,
)
from tests.app.conftest import small_level

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


@pytest.fixture(autouse=True)
def usual_afterwards():
    """Theme and keys are those of the whole process."""
    yield
    show_theme("dark")
    use_keys({})


@pytest.fixture
def page(driver):
    """The app on the small level, with the page of settings open."""
    driver.key(pygame.K_COMMA, CTRL)
    assert driver.app.ui.has_sheet
    return driver


def entry(action, mode="play"):
    return next(each for each in shortcuts(mode) if each.action == action)


def rows(driver):
    sprites = driver.app.ui.walk()
    return {sprite.entry.action: sprite for sprite in sprites if isinstance(sprite, KeyRow)}


# The file.


def test_names_that_a_later_version_wrote_are_kept(tmp_path):
    preferences_file(tmp_path).write_text(json.dumps({"version": 7, "later": [1]}))
    set_preference("theme", "light", tmp_path)
    kept = json.loads(preferences_file(tmp_path).read_text())
    assert kept == {"version": 7, "later": [1], "theme": "light"}
    set_preference("theme", None, tmp_path)
    assert "theme" not in json.loads(preferences_file(tmp_path).read_text())


@pytest.mark.parametrize("content", [b"{", b"[]", b"\xff", b"[" * 100_000])
def test_a_broken_file_is_set_aside_and_nothing_of_it_is_lost(tmp_path, content):
    preferences_file(tmp_path).write_bytes(content)
    assert preference("theme", tmp_path) is None
    aside = set_aside_broken(tmp_path)
    assert aside.read_bytes() == content and not preferences_file(tmp_path).exists()
    assert set_aside_broken(tmp_path) is None


def test_the_app_says_that_a_broken_file_was_set_aside(open_app, tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "preferences.json").write_text("{")
    # A panel that is opened first is remembered, in a file that is whole then.
    driver = open_app(small_level(), more=False)
    assert any("preferences.broken.json" in text for text in driver.notices)
    assert driver.app.chosen["theme"] == "system"


def test_values_that_cannot_be_used_are_named_and_the_usual_ones_hold(documents):
    set_preference("theme", "pink")
    set_preference("scale", "large")
    set_preference("keys", {"play.reset": "R"})
    chosen = Chosen()
    assert (chosen["theme"], chosen["scale"], chosen.keys) == ("system", None, {})
    assert len(chosen.faults) == 3 and all("\n" not in fault for fault in chosen.faults)


def test_what_is_given_for_one_start_is_not_remembered(documents):
    assert Chosen(theme="light")["theme"] == "light"
    assert Chosen()["theme"] == "system"


def test_every_setting_takes_its_values_and_no_others():
    for setting in SETTINGS:
        assert setting.fault_of(setting.default) is None
        assert setting.fault_of([]) is not None
        if isinstance(setting, Amount):
            assert setting.fault_of(setting.high) is None and setting.fault_of(setting.high + 1) is not None
        else:
            assert isinstance(setting, OneOf | Address) and setting.fault_of("?") is not None
    assert theme_of("light") == "light" and theme_of("dark") == "dark" and theme_of("system") in ("dark", "light")


@pytest.mark.parametrize(
    ("platform", "answer", "theme"),
    [("linux", "'prefer-dark'\n", "dark"), ("linux", "'default'\n", "light"), ("linux", "", "light"),
     ("darwin", "Dark\n", "dark"), ("darwin", "", "light"), ("plan9", "dark", "light")],
)  # fmt: skip
def test_the_theme_is_light_unless_the_system_says_dark(monkeypatch, platform, answer, theme):
    monkeypatch.setattr("sandbox.app.settings.chosen.sys.platform", platform)
    monkeypatch.setattr("sandbox.app.settings.chosen.shutil.which", lambda name: name)
    monkeypatch.setattr("sandbox.app.settings.chosen.subprocess.run", lambda *_, **__: SimpleNamespace(stdout=answer))
    assert theme_of("system") == theme


# The page.


def test_another_theme_holds_at_once_for_widgets_and_stage_and_at_the_next_start(page, open_app):
    dark = tuple(BACKGROUND)
    stage = page.stage.renderer.theme
    page.choose("Light")
    assert shown_theme() == "light" and tuple(BACKGROUND) != dark
    page.key(pygame.K_ESCAPE)
    page.frames(2)
    assert page.stage.renderer.theme is not stage
    at = page.app.display.surface.get_at((5, 5))
    assert min(at[:3]) > 200
    assert open_app(small_level()).app.chosen["theme"] == "light"


def test_the_size_of_widgets_goes_by_steps_and_back_to_automatic_by_the_keyboard_alone(page):
    plus = next(button for button in page.app.ui.buttons() if button.text == "+")
    page.app.ui.focus_on(plus)
    page.key(pygame.K_RETURN)
    page.key(pygame.K_SPACE)
    assert page.app.scale == page.app.chosen["scale"] == 1.25
    assert page.app.ui.focus.text == "+"
    page.choose("Automatic")
    page.choose("Defaults")
    assert page.app.scale == 1.0 and preference("scale") is None


def test_tab_reaches_every_button_of_the_page_and_the_ring_is_seen(page):
    seen = set()
    for _ in range(40):
        page.key(pygame.K_TAB)
        seen.add(page.app.ui.focus)
    assert set(page.app.ui.buttons()) <= seen
    focus = page.app.ui.focus.rect.inflate(6, 6).clamp(page.app.display.surface.get_rect())
    with_ring = page.app.display.surface.subsurface(focus).copy()
    page.app.ui.blur()
    page.frames()
    assert (
        pygame.surfarray.array3d(with_ring) != pygame.surfarray.array3d(page.app.display.surface.subsurface(focus))
    ).any()


def test_an_action_takes_another_key_from_the_one_that_had_it_and_it_is_said(page):
    page.choose("Keys in play")
    page.app.ui.focus_on(rows(page)["reset"])
    page.key(pygame.K_RETURN)
    page.key(pygame.K_s)
    assert action_of(pygame.K_s, 0) == "reset" and action_of(pygame.K_r, 0) is None
    assert entry("slow").keys == ()
    texts = [sprite.text for sprite in page.app.ui.walk() if hasattr(sprite, "show_text")]
    assert any("has none now" in text for text in texts)
    page.choose("Defaults")
    assert action_of(pygame.K_s, 0) == "slow" and action_of(pygame.K_r, 0) == "reset"


def test_escape_leaves_keys_as_they_are_delete_takes_them_away_and_the_page_stays(page):
    page.choose("Keys in play")
    page.app.ui.focus_on(rows(page)["fit"])
    page.frames(2)
    page.click_widget(rows(page)["fit"])
    assert isinstance(page.app.ui.focus, Widget) and page.app.ui.focus.takes_all_keys
    page.key(pygame.K_ESCAPE)
    assert action_of(pygame.K_f, 0) == "fit" and page.app.ui.has_sheet
    page.click_widget(rows(page)["fit"])
    page.key(pygame.K_DELETE)
    assert action_of(pygame.K_f, 0) is None and action_of(pygame.K_HOME, 0) is None


def test_keys_of_ones_own_hold_at_the_next_start_and_in_tips_and_unknown_ones_are_named(open_app, documents):
    set_preference("keys", {"play.reset": ["Ctrl+Shift+B"], "play.fit": ["Nonsense"]})
    driver = open_app(small_level())
    assert action_of(pygame.K_b, CTRL | SHIFT) == "reset"
    assert any("Nonsense" in text for text in driver.notices)


def test_every_key_of_the_table_has_the_name_that_a_press_of_it_gives():
    for mode in ("play", "edit"):
        for each in shortcuts(mode):
            for keys in each.keys if each.action else ():
                changed, _ = with_keys({}, each, (keys,))
                assert changed[each.name] == (keys,)
    assert combination_of(pygame.K_z, CTRL | SHIFT) == "Ctrl+Shift+Z"
    assert combination_of(pygame.K_LSHIFT, SHIFT) is None and combination_of(pygame.K_LEFT, 0) is None
    assert combination_of(pygame.K_KP_PLUS, 0) == "+"


def test_no_two_actions_of_a_mode_have_one_key():
    for mode in ("play", "edit"):
        keys = [key for each in shortcuts(mode) if each.action for key in each.keys]
        assert len(keys) == len(set(keys))


# What obeys it.


def test_hints_come_when_a_level_begins_unless_they_are_hidden_and_always_on_demand(open_app):
    level = small_level(description="Pull at the end.")
    driver = open_app(level)
    assert "Pull at the end." in driver.notices
    driver.app.chosen.choose("hints", "hide")
    quiet = open_app(level)
    assert "Pull at the end." not in quiet.notices
    quiet.key(pygame.K_F2)
    assert "Pull at the end." in quiet.notices


def test_shadows_and_effects_are_left_out_by_choice(driver):
    renderer = driver.stage.renderer
    driver.app.chosen.choose("effects", "on")
    driver.frames(2)
    assert renderer.detail == FULL and renderer.has_effects
    driver.app.chosen.choose("motion", "less")
    driver.frames(2)
    assert renderer.detail == FULL and not renderer.has_effects
    driver.app.chosen.choose("effects", "off")
    driver.frames()
    driver.frames()
    assert renderer.detail == NO_EFFECTS
