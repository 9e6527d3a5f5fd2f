"""A win of an edited level is kept as its solution, turns grey by an edit, is run again, and is looked for."""

import json
from dataclasses import replace

import pygame
import pytest

from sandbox.app.draw.colours import ACCENT, DANGER, MUTED
from sandbox.level.document.canonical import level_text
from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import read_level
from sandbox.level.rules.player_limits import PlayerLimits
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.solution import recorded_win, solution_of
from tests.app.test_goals import RING, WIN, level, play_to_the_end

CTRL = pygame.KMOD_CTRL
SOLVED = "Solved in 0.6 s with 2 stars, by its author."


@pytest.fixture
def saved(documents):
    """The file of a level that wins by itself."""
    documents.mkdir(parents=True, exist_ok=True)
    path = documents / "falling.json"
    path.write_text(level_text(level(RING, WIN)), encoding="utf-8")
    return path


@pytest.fixture
def maker(edit, saved):
    """The editor on that file, its page of checks open."""
    driver = edit()
    driver.app.documents.open(saved)
    driver.frames(2)
    driver.editor.side.choose("checks")
    driver.frames(2)
    return driver


def strip(driver):
    return driver.editor.side.page.solution


def settle(driver, most=400):
    """Let frames pass until the editor has no more to find out of the solution."""
    driver.pass_unseen(20)
    for _ in range(most):
        if not driver.editor.watch.proving.is_at_work and not driver.app.best.moves:
            break
        driver.pass_unseen()
    driver.frames(20)


def win_and_keep(driver):
    driver.key(pygame.K_e)
    play_to_the_end(driver)
    driver.click_widget(driver.app.play.game.card.buttons["Keep as solution"])
    for _ in range(400):
        if not driver.app.best.moves:
            break
        driver.pass_unseen()
    driver.frames(2)


def test_a_win_of_the_document_is_kept_beside_its_file_and_said_in_the_editor(maker, saved):
    assert strip(maker).text.text.startswith("No solution yet") and strip(maker).text.colour == MUTED
    win_and_keep(maker)
    assert any(text.startswith("Kept as its solution: won at 0.6") for text in maker.notices)
    replay = read_replay(solution_of(saved))
    assert verify(replay) is None and recorded_win(read_level(saved), replay).stars == 2
    maker.key(pygame.K_e)
    settle(maker)
    maker.editor.side.choose("checks")
    maker.frames(2)
    assert (strip(maker).text.text, strip(maker).text.colour) == (SOLVED, ACCENT)
    assert (SOLVED, ACCENT) in maker.editor.status(None)
    maker.click_widget(strip(maker).buttons[0])
    maker.frames(60)
    assert maker.app.mode == "play" and maker.playback.replay is not None
    assert maker.playback.session.tick == maker.playback.length
    assert maker.playback.outcome.endswith("equal bit for bit, won at 0.62 s with 2 stars"), maker.playback.outcome


def test_an_edit_turns_the_proof_grey_and_it_is_run_again_and_recorded_once_saved(maker, saved):
    win_and_keep(maker)
    maker.key(pygame.K_e)
    settle(maker)
    before = solution_of(saved).read_bytes()
    maker.drag((0, 3), (0.3, 3.3), (0.5, 3.5))
    text, colour = maker.editor.watch.proving.text
    assert text.startswith("Running its solution again") and colour == MUTED
    settle(maker)
    text, colour = maker.editor.watch.proving.text
    assert text.startswith("Solved in 0.") and colour == ACCENT
    assert solution_of(saved).read_bytes() == before
    maker.key(pygame.K_s, CTRL)
    settle(maker)
    replay = read_replay(solution_of(saved))
    assert recorded_win(read_level(saved), replay) is not None and verify(replay) is None
    assert maker.editor.watch.proving.text == (text, colour)


def test_an_edit_that_no_run_can_tell_leaves_the_proof(maker):
    win_and_keep(maker)
    maker.key(pygame.K_e)
    settle(maker)
    maker.editor.side.choose("level")
    maker.frames(2)
    maker.fill(maker.editor.side.page.form.fields["author"][0], "Ann")
    assert maker.editor.document.level.author == "Ann"
    assert maker.editor.watch.proving.text == (SOLVED, ACCENT)


def test_what_wins_no_more_says_where_it_parts_and_stays_as_it_was(maker, saved):
    win_and_keep(maker)
    maker.key(pygame.K_e)
    settle(maker)
    before = solution_of(saved).read_bytes()
    maker.drag((0, 3), (1, 3), (2.2, 3))
    settle(maker)
    text, colour = maker.editor.watch.proving.text
    assert "it parts at 0.00 s: ball is" in text and colour == DANGER
    maker.key(pygame.K_s, CTRL)
    settle(maker)
    assert solution_of(saved).read_bytes() == before
    maker.key(pygame.K_z, CTRL)
    settle(maker)
    assert maker.editor.watch.proving.text == (SOLVED, ACCENT)


def test_a_way_is_looked_for_beside_frames_shown_as_a_ghost_and_kept(maker, saved):
    maker.drag((0, 3), (1, 3), (2.2, 3))
    maker.key(pygame.K_s, CTRL)
    maker.editor.side.choose("checks")
    settle(maker)
    assert strip(maker).buttons[0].text == "Look for a way"
    maker.click_widget(strip(maker).buttons[0])
    settle(maker, 20_000)
    assert strip(maker).text.text.startswith("A way was found: won at")
    maker.click_widget(strip(maker).buttons[0])
    maker.frames(30)
    assert maker.app.play.game.shows_ghost and maker.stage.earlier is not None
    maker.key(pygame.K_e)
    maker.editor.side.choose("checks")
    maker.frames(2)
    maker.click_widget(strip(maker).buttons[1])
    settle(maker)
    assert recorded_win(read_level(saved), read_replay(solution_of(saved))) is not None
    assert strip(maker).text.text.startswith("Solved in")


def test_a_search_has_a_bar_ends_by_cancel_and_by_an_edit(maker):
    limits = PlayerLimits(may=())
    maker.editor.edit("Limit", lambda document: replace(document, level=replaced(document.level, hands=limits)))
    maker.drag((0, 3), (1, 3), (2.2, 3))
    settle(maker)
    proving = maker.editor.watch.proving
    for end in (lambda: maker.click_widget(strip(maker).buttons[0]), lambda: maker.key(pygame.K_z, CTRL)):
        maker.click_widget(strip(maker).buttons[0])
        maker.frames(10)
        assert strip(maker).bar.visible and strip(maker).buttons[0].text == "Cancel"
        assert strip(maker).text.text.startswith("Looking for a way: ") and proving.looking.runs > 0
        end()
        maker.frames(2)
        assert proving.looking is None and not strip(maker).bar.visible
    assert strip(maker).buttons[0].text == "Look for a way"


def test_a_level_of_ones_own_is_told_to_be_solved_in_play_and_in_the_gallery(open_app, maker, saved):
    win_and_keep(maker)
    player = open_app(level(RING, WIN))
    player.app.files.open_level(saved)
    player.frames(20)
    assert player.app.play.game.solved == SOLVED
    play_to_the_end(player)
    assert "Keep as solution" in player.app.play.game.card.buttons
    player.key(pygame.K_w, pygame.KMOD_SHIFT)
    player.frames(60)
    assert player.playback.replay is not None and "equal" in player.playback.outcome
    player.app.open_gallery("mine")
    player.frames(60)
    assert [card.solved for card in player.app.gallery.cards if card.name == "Small"] == [SOLVED]
    data = json.loads(saved.read_text(encoding="utf-8"))
    data["particles"][0]["position"] = [2, 3]
    saved.write_text(json.dumps(data), encoding="utf-8")
    player.app.files.open_level(saved)
    player.frames(20)
    assert player.app.play.game.solved == ""
    player.key(pygame.K_w, pygame.KMOD_SHIFT)
    assert "There is no solution beside this level." in player.notices
