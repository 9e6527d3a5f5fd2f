"""Boards in a browser: ranks with names as text, and a race by touch against a run that somebody sent."""

from pathlib import Path
from urllib.parse import quote

import pytest

from sandbox.app.site.board_pages import write_board
from sandbox.level.reading.files import level_path, load_level
from sandbox.session.board import Board, rank_text
from sandbox.session.checking import solution_of
from sandbox.session.replay.link import fragment_of
from sandbox.session.replay.reader import read_replay
from tests.page.browser import Browser, Tab
from tests.page.deeds import ByFinger, ByMouse, Player
from tests.page.opened import START_OVER, VERDICT, saved
from tests.page.pointing import click, text
from tests.page.site_server import served
from tests.page.test_winning import PHONE
from tests.solutions import SOLUTIONS

LEVEL, SHORT = "chain_of_events", "basket_throw"
# How much later somebody begins than the run that is raced [ticks].
LATE = 24
# Whose run is raced, once one is, and what was done by hand.
RACED = """new Promise((done) => {
  const { goals, toy } = page;
  const look = () => (goals.race ? done([goals.race.name, toy.run.commands.length]) : setTimeout(look));
  look();
})"""
EVIL = '<img src=x onerror="document.title=1"></bdi></table><script>document.title=1</script>@ROWS@{drag}&amp;\'"'


def solution(level: str = LEVEL) -> str:
    """A link to the run that wins a level."""
    return fragment_of(read_replay(solution_of(Path(level_path(level)))))


def judged(folder: Path) -> Board:
    board = Board(folder)
    for _ in board.judge(1, 60.0):
        pass
    return board


def race_of(name: str, link: str) -> str:
    return f"#beat={quote(name, safe='')}&{link.removeprefix('#')}"


def play(tab: Tab, by: type[Player], level: str, late: int) -> None:
    """Do what the solution does, so many ticks later."""
    player, rate = by(tab, []), tab.evaluate("page.toy.rate")
    ((lines),) = SOLUTIONS[level]
    for time, record in lines:
        player.until(round(time * rate) + late)
        player.do(record)
    assert player.until(60 * rate) is not None


@pytest.fixture(scope="module")
def address(site):
    with served(site) as at:
        yield at


@pytest.mark.slow
@pytest.mark.parametrize(
    ("late", "words"), [(LATE, "You lose to Ada by {}."), (-LATE, "You beat Ada by {}.")], ids=["slower", "faster"]
)
def test_a_race_by_touch_ends_on_a_card_that_says_who_wins_and_enters_the_board(
    browser: Browser, address: str, tmp_path: Path, late: int, words: str
) -> None:
    tab = browser.tab(**PHONE).open(f"{address}levels/{LEVEL}.html{race_of('Ada', solution())}")
    assert tab.evaluate(VERDICT) == "Race Ada: the shade is the run to beat."
    play(tab, ByFinger, LEVEL, late)
    assert text(tab, "#end-card h2") == "Won"
    card = text(tab, "#end-card p").splitlines()[0]
    # Played by pointer events, and sent back.
    made = tab.evaluate("page.toy.link()")
    (tmp_path / "all.txt").write_text(f"Ada {solution()}\nBen {made}\n", encoding="utf-8")
    board = judged(tmp_path)
    assert board.faults == []
    ranked, (ada, ben) = board.ranks(LEVEL), board.wins
    assert [win.entry.name for win in ranked] == (["Ada", "Ben"] if late > 0 else ["Ben", "Ada"])
    assert card == words.format(f"{abs(ada.ticks - ben.ticks) / load_level(LEVEL).settings.tick_rate:.2f} s")
    assert tab.faults == []


@pytest.mark.slow
def test_the_best_run_made_by_mouse_is_kept_and_raced_and_enters_the_board_as_a_recording(
    browser: Browser, address: str, tmp_path: Path
) -> None:
    page = f"{address}levels/{SHORT}.html"
    tab = browser.tab().open(page)
    assert tab.evaluate("localStorage.clear(); [page.best.kept, document.getElementById('best').hidden]") == [
        None,
        True,
    ]
    play(tab, ByMouse, SHORT, 0)
    best = tab.evaluate("page.toy.link()")
    assert saved(tab, tmp_path).exists()
    board = judged(tmp_path)
    assert [win.stem for win in board.wins] == [SHORT] and board.faults == []
    click(tab, "#end-best")
    assert tab.evaluate(VERDICT) == "Race your best: the shade is the run to beat."
    assert tab.evaluate("[page.goals.race.result.tick, page.best.kept.link]") == [board.wins[0].ticks, best]
    # Who watches a run plays by hand from then on.
    other = browser.tab().open(page + best)
    click(other, "#best")
    assert other.evaluate(RACED) == ["your best", 0]
    assert other.evaluate("localStorage.setItem(localStorage.key(0), '{'); page.best.kept") is None
    assert tab.faults + other.faults == []


def test_only_a_better_run_takes_the_place_of_the_best(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}levels/{LEVEL}.html")
    tab.evaluate("localStorage.clear(); page.toy.link = async () => `#${page.best.kept?.link ?? ''}x`")
    note = "page.best.note({{ isWon: {}, stars: {}, tick: {} }}).then(() => page.best.kept?.link)"
    found = [
        tab.evaluate(note.format(*each))
        for each in (
            ("false", 0, 9),
            ("true", 2, 50),
            ("true", 1, 9),
            ("true", 2, 50),
            ("true", 2, 49),
            ("true", 3, 99),
        )
    ]
    assert found == [None, "#x", "#x", "#x", "##xx", "###xxx"]
    assert tab.evaluate("localStorage.clear(); page.best.kept") is None


def test_the_shade_goes_along_with_time_and_is_seen(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}levels/{LEVEL}.html{race_of('Ada', solution())}")
    tab.evaluate(VERDICT)
    tab.evaluate(START_OVER)
    tab.evaluate("for (let k = 0; k < 200; k++) page.toy.tick()")
    drawn = """(() => {
      const { toy } = page, { canvas } = toy, context = canvas.getContext('2d');
      const shot = () => {
        toy.picture.draw(toy.camera, toy.theme, toy.world.view('state.position'), 1, 0, () => toy.shade?.(1, 0));
        return context.getImageData(0, 0, canvas.width, canvas.height).data;
      };
      const { shade } = toy, seen = shot();
      toy.shade = null;
      const plain = shot();
      toy.shade = shade;
      return seen.reduce((count, value, k) => count + (value !== plain[k]), 0);
    })()"""
    moved = tab.evaluate(drawn)
    assert moved > 1000
    # Here, before anybody does anything, both are in one place: what is seen of it is a rim.
    tab.evaluate("page.toy.seek(20)")
    assert tab.evaluate(drawn) < moved
    tab.evaluate("page.toy.seek(200)")
    assert tab.evaluate(drawn) == moved


@pytest.mark.parametrize(
    ("link", "words"),
    [
        (solution("crane"), "This link is to another level. Open it there."),
        ("#scene=AAAA", "This link is broken: copy it again, whole."),
    ],
)
def test_a_race_that_cannot_be_is_said_and_the_level_plays(
    browser: Browser, address: str, link: str, words: str
) -> None:
    tab = browser.tab().open(f"{address}levels/{LEVEL}.html{race_of('Ada', link)}")
    assert tab.evaluate(VERDICT) == words
    assert tab.evaluate("page.toy.shade") is None


def test_who_sends_a_run_that_does_not_win_is_not_raced(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}levels/{LEVEL}.html")
    tab.evaluate("page.toy.pause(); for (let k = 0; k < 30; k++) page.toy.tick()")
    link = tab.evaluate("page.toy.link()")
    other = browser.tab().open(f"{address}levels/{LEVEL}.html{race_of('', link)}")
    assert other.evaluate(VERDICT) == "No race: the run of this link does not win."
    assert other.evaluate("page.toy.shade") is None and not other.evaluate("page.toy.isPaused")


def test_names_are_text_and_a_row_leads_to_its_run_and_its_race(browser: Browser, tmp_path: Path) -> None:
    entries, site = tmp_path / "entries", tmp_path / "site"
    entries.mkdir()
    (entries / "all.txt").write_text(
        f"{EVIL[:60]} {solution(SHORT)}\n{EVIL[60:]} {solution('catapult_practice')}\n", encoding="utf-8"
    )
    board = judged(entries)
    board.levels = {stem: level for stem, level in board.levels.items() if stem in (SHORT, "catapult_practice")}
    for _ in write_board(board, site, EVIL, None):
        pass
    with served(site) as at:
        index = browser.tab().show(f"{at}index.html")
        leads = index.evaluate("[...document.querySelectorAll('.leads')].map(({ textContent }) => textContent)")
        assert sorted(leads) == sorted(
            f"{win.entry.name} leads: {rank_text(board.levels[win.stem], win)}" for win in board.wins
        )
        assert index.evaluate("document.querySelectorAll('.cards bdi').length") == 2 and index.faults == []
        for level, name in ((SHORT, EVIL[:60]), ("catapult_practice", EVIL[60:])):
            tab = browser.tab().show(f"{at}ranks/{level}.html")
            assert text(tab, "#ranks bdi") == name.strip()
            assert tab.evaluate("document.images.length + document.scripts.length") == 1
            watched, raced = tab.evaluate("[...document.querySelectorAll('#ranks a')].map(({ href }) => href)")
            sent = tab.evaluate("new URL(document.querySelector('[data-race]').dataset.race, location.href).href")
            assert sent == raced
            assert tab.faults == []
            other = browser.tab().open(raced)
            assert other.evaluate(VERDICT) == f"Race {name.strip()}: the shade is the run to beat."
            assert str(browser.tab().open(watched).evaluate(VERDICT)).startswith("Verified: ")
