"""Time in a page passes as it does outside, whatever the tick rate, while the machine can; else the page says so."""

import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from sandbox import load_level
from sandbox.app.share.playing import page_of
from sandbox.page.page import WEB
from tests.page.browser import Browser
from tests.page.opened import opened
from tests.page.site_server import served

# Frames of a machine whose clock is ours: it draws 60 pictures a second [ms], and a tick of part k takes costs[k] [ms].
FRAMES = """(async ({ rate, costs, seconds }) => {
  const { Pace } = await import('./pace.js');
  let now = 0, ticks = 0, longest = 0;
  const pace = new Pace(() => now), told = [], last = costs.length - 1;
  const part = () => Math.min(Math.floor(now / 1000 / seconds), last);
  while (now < 1000 * seconds * costs.length) {
    const began = now;
    pace.pass(now, rate, () => {
      now += costs[part()];
      ticks += 1;
      return true;
    });
    longest = Math.max(longest, now - began);
    if (pace.isBehind !== (told.length % 2 === 1)) told.push(now / 1000);
    now = Math.ceil((now + 2) / (1000 / 60)) * (1000 / 60);
  }
  return { ticks, told, longest, seconds: now / 1000 };
})(GIVEN)"""
SLOW_TICKS = """new Promise((done) => {
  const { toy } = page, tick = toy.tick.bind(toy);
  toy.tick = () => {
    for (const end = performance.now() + 60; performance.now() < end;);
    tick();
  };
  toy.addEventListener('pace', ({ detail }) => done(detail.isBehind), { once: true });
})"""
TICKS_OF_A_FRAME = """new Promise((done) => {
  const { toy } = page;
  let most = 0, ticks = 0, frames = 0;
  toy.addEventListener('tick', () => { ticks += 1; });
  toy.addEventListener('draw', () => {
    most = Math.max(most, ticks);
    ticks = 0;
    frames += 1;
    if (frames === 30) done(most);
  });
})"""
SAID = "[page.toy.isBehind, document.getElementById('pace').textContent]"


@dataclass
class Played:
    """What came of it: ticks, when it became slow and when no more [s], the longest ticks of a frame [ms], time [s]."""

    ticks: int
    told: list[float]
    longest: float
    seconds: float


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A page beside the module."""
    folder = tmp_path_factory.mktemp("pace")
    for name in ("pace.js", "shared.js"):
        shutil.copy(WEB / name, folder)
    (folder / "index.html").write_text("<!doctype html>", encoding="utf-8")
    with served(folder) as at:
        yield at


def _played(browser: Browser, address: str, rate: int, *costs: float, seconds: float = 6.0) -> Played:
    given = json.dumps({"rate": rate, "costs": costs, "seconds": seconds})
    return Played(**browser.tab().show(address).evaluate(FRAMES.replace("GIVEN", given)))


@pytest.mark.parametrize("rate", [30, 60, 240, 600, 1200, 10_000])
def test_as_much_time_passes_in_a_world_as_outside_whatever_the_tick_rate(
    browser: Browser, address: str, rate: int
) -> None:
    played = _played(browser, address, rate, 500.0 / rate)
    assert abs(played.ticks - rate * played.seconds) <= rate / 30 + 1
    assert played.told == []


@pytest.mark.parametrize("rate", [60, 1200, 10_000])
def test_what_a_machine_does_not_manage_is_lost_and_told_once(browser: Browser, address: str, rate: int) -> None:
    played = _played(browser, address, rate, 200.0 / rate, 2000.0 / rate, 200.0 / rate, seconds=10.0)
    # Ticks of a frame end in time for the page to answer, but for one that is under way.
    assert played.longest <= 50.0 + 2000.0 / rate + 1e-6
    began, ended = played.told
    assert 10.0 < began < 12.0 and 20.0 < ended < 29.0
    assert played.ticks < rate * (played.seconds - 4.0)


def test_a_tick_that_takes_longer_than_a_frame_is_alone_in_it(browser: Browser, address: str) -> None:
    played = _played(browser, address, 60, 200.0)
    assert played.longest == pytest.approx(200.0)
    assert played.ticks == pytest.approx(played.seconds / 0.2, rel=0.1)


def test_a_machine_that_is_just_too_slow_is_not_called_so_again_and_again(browser: Browser, address: str) -> None:
    played = _played(browser, address, 60, *(5.0, 30.0) * 20, seconds=0.4)
    assert len(played.told) <= 1


def test_a_window_that_was_away_is_not_slow(browser: Browser, address: str) -> None:
    away = """import('./pace.js').then(({ Pace }) => {
      const pace = new Pace(() => 0);
      let ticks = 0;
      pace.pass(3600000, 60, () => { ticks += 1; return true; });
      return [ticks, pace.isBehind];
    })"""
    assert browser.tab().show(address).evaluate(away) == [6, False]


def test_a_level_of_many_ticks_a_second_makes_them(browser: Browser, tmp_path: Path) -> None:
    level = load_level("rope")
    quick = level.model_copy(update={"settings": level.settings.model_copy(update={"tick_rate": 1200})})
    tab = opened(browser, tmp_path, page_of(quick))
    assert tab.evaluate(TICKS_OF_A_FRAME) > 10


def test_a_page_that_is_too_slow_says_so_and_still_answers(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(load_level("rope")))
    assert tab.evaluate(SAID) == [False, ""]
    assert tab.evaluate(SLOW_TICKS)
    assert tab.evaluate(SAID) == [True, "slower than real time"]
    tab.key(" ")
    gone = "new Promise((done) => page.toy.addEventListener('pace', ({ detail }) => done(detail.isBehind)))"
    assert not tab.evaluate(f"page.toy.isBehind && {gone}")
    assert tab.evaluate(f"[page.toy.isPaused, ...{SAID}]") == [True, False, ""]
    assert tab.faults == []
