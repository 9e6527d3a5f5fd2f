"""Firefox plays pages to the desktop's bits, verifies what it is sent, and wins a puzzle by hand."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox import Session, load_level
from sandbox.app.share.runs_for_pages import link_to
from sandbox.cli import main
from sandbox.level.format.slices import at_once
from sandbox.physics.snapshot import state_hash
from sandbox.replay import read_replay
from tests.page.browser import page_address
from tests.page.firefox import Firefox, FirefoxTab
from tests.page.levels import level_page
from tests.page.opened import TICKED, VERDICT
from tests.page.site_server import served
from tests.support.wholes import some_and_whole

TICKS = 300
# Ropes, a car with motors, muscles, jellies, water, a belt.
LEVELS = ("rope", "suspension_car", "walker", "jelly_pile", "ferry", "sorting_belt")
PUZZLE = "chain_of_events"
# The pixel of a particle of the picture.
PIXEL = """(() => {
  const { toy } = page, slot = toy.world.names.particle.indexOf('NAME');
  return toy.camera.toPixels(...toy.world.view('state.position').subarray(2 * slot, 2 * slot + 2));
})()"""


def _opened(firefox: Firefox, folder: Path, name: str) -> FirefoxTab:
    file = folder / "page.html"
    file.write_text(level_page(name), encoding="utf-8")
    return firefox.tab().open(page_address(file))


@pytest.mark.parametrize("name", some_and_whole(("suspension_car", "ferry"), LEVELS))
def test_firefox_comes_to_the_bits_of_the_desktop(firefox: Firefox, tmp_path: Path, name: str) -> None:
    tab = _opened(firefox, tmp_path, name)
    tab.evaluate(TICKED)
    found = tab.evaluate(f"for (let k = 0; k < {TICKS}; k++) page.toy.tick(); page.toy.world.hash().whole")
    session = Session(load_level(name))
    for _ in range(TICKS):
        session.advance()
    assert found == state_hash(session.world)
    assert tab.faults == []


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("firefox")
    assert main(["site", "-o", str(folder), f"levels/{PUZZLE}.json"]) == 0
    with served(folder) as address:
        yield address


def test_firefox_verifies_a_run_that_comes_by_a_link(firefox: Firefox, site: str) -> None:
    replay = read_replay(f"levels/{PUZZLE}.solution.replay.gz")
    tab = firefox.tab().open(at_once(link_to(replay, site, 0)))
    assert tab.evaluate(VERDICT).startswith("Verified")
    assert tab.evaluate("page.toy.run.last") == replay.ticks
    assert tab.faults == []


def test_a_puzzle_is_won_in_firefox_by_the_mouse(firefox: Firefox, site: str) -> None:
    tab = firefox.tab().open(f"{site}levels/{PUZZLE}.html")
    # Time passes where the test lets it, however fast the machine is.
    tab.evaluate(TICKED)
    x, y = tab.evaluate(PIXEL.replace("NAME", "marble"))
    tab.mouse("mouseMoved", x, y)
    tab.mouse("mousePressed", x, y)
    assert tab.evaluate("page.toy.hands.isBusy")
    for step in range(1, 11):
        tab.mouse("mouseMoved", x + 8 * step, y)
        tab.evaluate("page.toy.tick(); page.toy.tick()")
    tab.mouse("mouseReleased", x + 80, y)
    tab.evaluate("for (let k = 0; k < 1500 && !page.toy.outcome; k++) page.toy.tick()")
    assert tab.evaluate("page.toy.outcome?.isWon") is True
    assert tab.evaluate("document.getElementById('end-title').textContent") == "Won"
    assert tab.evaluate("document.activeElement.id") == "end-again"
    assert tab.faults == []
