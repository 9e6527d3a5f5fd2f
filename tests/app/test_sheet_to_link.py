"""From an empty sheet to a link with its proof: drawn, won, kept, edited, proved again and sent, by mouse and keys."""

from dataclasses import replace
from pathlib import Path

import pygame

from sandbox.app.share.playing import page_of
from sandbox.app.share.runs_for_pages import link_to
from sandbox.level.format.quantities import replaced
from sandbox.level.format.slices import at_once
from sandbox.level.reading.files import read_level
from sandbox.level.rules.player_limits import BudgetDef, PlayerLimits
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from sandbox.session.solution import recorded_win, solution_of
from tests.app.test_solutions_kept import settle
from tests.page.conftest import browser  # noqa: F401
from tests.page.opened import VERDICT
from tests.support.machines import draw_ground

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
NAME = "crossing"


def draw(driver):
    """Ground with a basin, a pool in it with a raft, two balls on the left bank and a goal on the right one."""
    draw_ground(driver, (-5.5, -3), (5.5, -3), (5.5, 0), (2, 0), (2, -2), (-2, -2), (-2, 0), (-5.5, 0))
    driver.key(pygame.K_z, SHIFT)
    driver.drag((-2, -2), (0, -1), (2, -0.5))
    driver.key(pygame.K_ESCAPE)
    driver.editor.side.choose("properties")
    driver.frames(2)
    form = driver.editor.side.page.form
    form.area.show_widget(form.buttons["water"])
    driver.frames(2)
    driver.click_widget(form.buttons["water"])
    driver.frames(2)
    driver.key(pygame.K_j)
    driver.fill(driver.editor.options.fields["mass"][0], "0.01")
    driver.drag((-1, -0.5), (0, -0.3), (1, 0))
    driver.key(pygame.K_a)
    driver.fill(driver.editor.options.fields["radius"][0], "0.2")
    for x in (-4, -3):
        driver.click_at(x, 0.5)
    driver.key(pygame.K_z, SHIFT)
    driver.drag((3, 0), (4, 1), (5, 1.5))
    driver.key(pygame.K_ESCAPE)


def add_rule(driver):
    """A rule that wins once a ball is in the goal, by a template, and a limit of three grabs."""
    driver.editor.side.choose("rules")
    driver.frames(2)
    driver.click_widget(driver.editor.side.page.buttons["Add"])
    driver.frames(2)
    driver.key(pygame.K_RETURN)
    driver.frames(2)
    limits = PlayerLimits(may=("grab",), at_most=BudgetDef(grab=3))
    driver.editor.edit("Limit", lambda document: replace(document, level=replaced(document.level, hands=limits)))


def win(driver):
    """Carry the first ball over the pool and let it down in the goal."""
    driver.key(pygame.K_e)
    driver.frames(60)
    (ball,) = [each.when.particle for each in driver.playback.level.rules]
    x, y = driver.world.position[driver.world.particle_slot(ball)].tolist()
    path = [(x, y + 0.1 * k) for k in range(15)]
    path += [(x + (4 - x) * k / 40, y + 1.5) for k in range(41)]
    path += [(4.0, y + 1.5 - 0.1 * k) for k in range(10)]
    driver.stroke(*path)
    for _ in range(600):
        if driver.app.play.game.card is not None:
            break
        driver.pass_unseen()
    driver.frames(2)


def test_a_level_goes_from_an_empty_sheet_to_a_link_that_says_it_is_solved(edit, browser, documents, tmp_path: Path):  # noqa: F811
    driver = edit()
    draw(driver)
    add_rule(driver)
    level = driver.editor.document.level
    assert (
        level.has_water
        and [body.type for body in level.bodies] == ["jelly"]
        and len(level.particles) == 2
        and level.has_goal
    )
    win(driver)
    # It has no file yet: keeping the solution asks for its name.
    driver.click_widget(driver.app.play.game.card.buttons["Keep as solution"])
    driver.frames(2)
    driver.key(pygame.K_a, CTRL)
    driver.type(NAME)
    driver.key(pygame.K_RETURN)
    settle(driver)
    path = documents / f"{NAME}.json"
    assert any(text.startswith("Kept as its solution: won at") for text in driver.notices), driver.notices
    driver.key(pygame.K_e)
    settle(driver)
    proving = driver.editor.watch.proving
    assert proving.text[0].startswith("Solved in")
    # The other ball goes elsewhere: grey, run again, and won by other bits.
    x, y = next(each.position for each in level.particles if each.id != level.rules[0].when.particle)
    driver.key(pygame.K_v)
    driver.drag((x, y), (x - 0.5, y + 0.5), (x - 1, y + 1))
    assert proving.text[0].startswith("Running its solution again")
    settle(driver)
    assert proving.text[0].startswith("Solved in")
    driver.key(pygame.K_s, CTRL)
    settle(driver)
    file, replay = read_level(path), read_replay(solution_of(path))
    assert file.particles != level.particles and recorded_win(file, replay) is not None and verify(replay) is None
    page = tmp_path / "page.html"
    page.write_text(page_of(file, file=path), encoding="utf-8")
    link = at_once(link_to(replay, page.as_uri(), 0))
    tab = browser.tab().open(link)
    solved = proving.text[0]
    assert tab.evaluate("document.getElementById('solved').textContent") == solved
    assert str(tab.evaluate(VERDICT)).endswith(f"the very state that the sender had. {solved}")
    # Who opens the page alone is told too, and may watch it.
    tab = browser.tab().open(page.as_uri())
    assert tab.evaluate("document.getElementById('solved').textContent") == solved
    assert tab.evaluate("document.getElementById('solved').hash") == f"#{link.partition('#')[2]}"
