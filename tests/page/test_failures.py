"""The page of all failures, in a real browser: each tells its cause and plays both runs, without a network."""

import re

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import write_level
from sandbox.session.level_edits import with_value
from sandbox.session.session import Session
from tests.page.browser import Browser, page_address
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

EDITS = [
    ("settings.gravity.1", -14.0),
    ("materials.steel.stiffness", 0.6),
    ("bodies.rope.segments", 9),
    ("settings.drag", 0.5),
    ("settings.solver", "single_pass"),
]
TICKS = 90
# How many heights each curve has.
HEIGHTS = """[...document.querySelectorAll('polyline')].map((each) =>
  new Set(each.getAttribute('points').match(/,[^ ]+/g)).size)"""
# What the frame of a failure comes to, once it is there: how many canvases are drawn, and the tick after Play.
PLAYED = """new Promise((done) => {
  const frame = document.querySelectorAll('iframe')[%d];
  frame.scrollIntoView();
  const look = () => {
    const page = frame.contentDocument;
    if (page?.documentElement?.dataset.tick === undefined) return setTimeout(look, 20);
    const drawn = [...page.querySelectorAll('canvas')].filter((each) =>
      each.getContext('2d').getImageData(0, 0, each.width, each.height).data.some((value) => value > 0)).length;
    const before = page.documentElement.dataset.tick;
    page.getElementById('next').click();
    done([drawn, before !== page.documentElement.dataset.tick || before === '%d']);
  };
  look();
})"""


@pytest.fixture
def failing(pytester):
    """A folder with five recordings, each of a level that was edited since."""
    for number, (field, value) in enumerate(EDITS):
        folder = pytester.path / f"{number}"
        (folder / "levels").mkdir(parents=True)
        write_level(with_value(rope_level(), field, value), folder / "levels" / "rope.json")
        session = Session(rope_level())
        session.record_to(folder / "run.replay.gz")
        while session.tick < TICKS:
            session.advance()
        session.stop_recording()
    return pytester.path


def told(text: str) -> tuple[list[str], list[str]]:
    """The causes and the commands of a page."""
    return re.findall(r"<pre><b>(.*?)</b>", text), re.findall(r'<pre class="accept">(.*?)</pre>', text)


def test_a_run_of_pytest_writes_a_page_of_five_failures_that_plays_each(failing, pytester, browser: Browser) -> None:
    report = failing / "out" / "report.html"
    result = pytester.runpytest_inprocess(*LOADED, "--replay-pictures=none", "--replay-report=out/report.html")
    result.assert_outcomes(failed=5, passed=5)
    assert f"{report}: 5 of 10 tests failed" in result.stdout.str()
    causes, commands = told(report.read_text(encoding="utf-8"))
    assert all(field.removesuffix(".1") in cause for cause, (field, _) in zip(causes, EDITS, strict=True))
    assert commands == [f"pytest --replay-update {number}/run.replay.gz" for number in range(5)]
    tab = browser.tab().show(page_address(report))
    curves = tab.evaluate(HEIGHTS)
    assert len(curves) == 5 and min(curves) > 10
    assert [tab.evaluate(PLAYED % (number, TICKS)) for number in range(5)] == [[2, True]] * 5
    assert tab.evaluate("performance.getEntriesByType('resource').length") == 0
    assert tab.faults == []


def test_a_command_that_is_accepted_leaves_a_page_without_failures(failing, pytester) -> None:
    pytester.runpytest_inprocess(*LOADED, "--replay-update")
    pytester.runpytest_inprocess(*LOADED, "--replay-report=report.html").assert_outcomes(passed=10)
    text = (failing / "report.html").read_text(encoding="utf-8")
    assert "<h1>All 10 tests passed</h1>" in text and told(text) == ([], [])


def test_the_command_line_writes_the_same_page_of_a_folder(failing, capsys) -> None:
    (failing / "damaged.replay.gz").write_bytes(b"no recording")
    for folder in range(5):
        (failing / f"{folder}/levels/rope.json").rename(failing / f"{folder}/levels/rope.edited.json")
    write_level(with_value(rope_level(), *EDITS[1]), failing / "rope.json")
    command = ["replay", ".", "--against", "rope.json", "--processes", "2", "--report", "report.html"]
    assert main(command) == 2
    assert capsys.readouterr().out.endswith("report.html: 6 of 6 tests failed\n")
    text = (failing / "report.html").read_text(encoding="utf-8")
    causes, commands = told(text)
    assert len(causes) == 6 and sum("materials.steel.stiffness: 0.8 -&gt; 0.6" in cause for cause in causes) == 5
    assert text.count("<iframe ") == 5
    assert commands[0] == "pytest --replay-update --replay-against rope.json 0/run.replay.gz"
