"""A toy on a page of one's own: the page of docs/how-to-embed.md, and what its handle gives."""

import json
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox import Session, load_level
from sandbox.cli import main
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import parse_level
from sandbox.page.page import WEB
from sandbox.replay import read_replay, verify
from sandbox.session.check_run import run_checks
from tests.page.browser import Browser, Tab
from tests.page.in_node import literal
from tests.page.opened import READY, saved
from tests.page.site_server import served
from tests.page.test_commands import BEFORE, names_in, tried_on_the_desktop, wrong_records

DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "how-to-embed.md"
HEARD = """(async () => {
  const heard = [];
  for (const name of ['break', 'check']) toy.addEventListener(name, ({ detail }) => heard.push([name, detail]));
  toy.pause();
  toy.restart();
  toy.pause();
  for (let k = 0; k < COUNT; k++) toy.tick();
  return heard;
})()"""


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A site of a few levels with the page of the document, and with checks of all kinds."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "checked.json").write_text(level_text(_checked()), encoding="utf-8")
    levels = ("rope", "breaking_bridge", "suspension_car")
    assert main(["site", *levels, str(folder / "checked.json"), "-o", str(folder)]) == 0
    shown, _ = re.findall(r"```html\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)
    for name in (*levels, "checked"):
        page = textwrap.dedent(shown).replace("levels/rope.toy", f"levels/{name}.toy")
        (folder / f"{name}.html").write_text(page, encoding="utf-8")
    (folder / "own.html").write_text(textwrap.dedent(shown), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def address(own: Path) -> Iterator[str]:
    with served(own) as at:
        yield at


def _checked():
    """The truck on a bridge that breaks, with a check of every metric that a page measures."""
    body, particle, other = "deck", "deck.0", "deck.3"
    checks = [
        {"metric": "x", "body": body, "after": 1.0, "at_most": 100.0},
        {"metric": "y", "particle": other, "after": 0.5, "at_least": 1000.0},
        {"metric": "speed", "body": body, "after": 1.0, "at_most": 50.0},
        {"metric": "distance", "particle": particle, "other": other, "after": 0.7, "at_most": 2.0},
        {"metric": "inside", "body": body, "box": [-50.0, -50.0, 50.0, 50.0], "always": [0.0, 1.5]},
        {"metric": "settled", "body": body, "after": 1.0, "at_least": 0.5},
        {"metric": "max_speed", "eventually": [0.0, 2.0], "at_least": 1.0},
        {"metric": "kinetic_energy", "after": 1.0, "at_most": 1.0},
        {"metric": "strain", "body": body, "after": 1.2, "at_most": 0.5},
        {"metric": "max_strain", "after": 2.0, "at_most": 0.5},
        {"metric": "rms_strain", "after": 2.0, "at_most": 0.5},
        {"metric": "broken_springs", "after": 2.5, "at_most": 0.0},
        {"metric": "non_finite", "always": [0.0, 2.0], "at_most": 0.0},
    ]
    level = json.loads(level_text(load_level("breaking_bridge")))
    level.setdefault("settings", {})["gravity"] = [0.0, -60.0]
    level["checks"] = [{"name": each["metric"], **each} for each in checks]
    return parse_level(json.dumps(level).encode(), "checked.json")


def _opened(browser: Browser, address: str, name: str) -> Tab:
    tab = browser.tab().show(f"{address}{name}.html")
    tab.evaluate(READY)
    return tab


def test_the_page_of_the_document_plays_tells_and_pauses(browser: Browser, address: str) -> None:
    tab = _opened(browser, address, "own")
    tab.evaluate("new Promise((done) => toy.addEventListener('tick', done, { once: true }))")
    assert re.fullmatch(r"The end is at -?[\d.]+, -?[\d.]+ m\.", tab.evaluate("end.textContent"))
    tab.evaluate("document.getElementById('pause').click()")
    assert tab.evaluate("toy.isPaused")
    assert tab.faults == []


def test_the_document_has_every_event_that_a_toy_tells() -> None:
    told = set(re.findall(r"#tell\('(\w+)'", (WEB / "toy.js").read_text(encoding="utf-8")))
    table = DOCUMENT.read_text(encoding="utf-8").partition("| event | when")[2]
    names = {name for row in table.splitlines() for name in re.findall(r"`(\w+)`", row.partition(" | ")[0])}
    assert told <= names and "pace" in told


def test_a_page_under_the_policy_of_the_document_plays_and_lets_nothing_else_in(browser: Browser, own: Path) -> None:
    page, policy = re.findall(r"```html\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)
    before, script, after = re.split(r'<script type="module">|</script>', textwrap.dedent(page))
    (own / "own.js").write_text(script, encoding="utf-8")
    head = f'<meta charset="utf-8">\n{policy}'
    text = before.replace('<meta charset="utf-8">', head).replace(' style="width: 100%; height: 400px"', "")
    (own / "under.html").write_text(f'{text}<script type="module" src="own.js"></script>{after}', encoding="utf-8")
    with served(own) as at:
        tab = _opened(browser, at, "under")
        tab.evaluate("new Promise((done) => toy.addEventListener('tick', done, { once: true }))")
        tab.mouse("mousePressed", 100, 60)
        tab.mouse("mouseMoved", 140, 90)
        tab.mouse("mouseReleased", 140, 90)
        tab.evaluate("toy.sound.toggle()")
        assert verify(read_replay(saved(tab, own, "toy"))) is None
        assert tab.faults == []
        tab.evaluate(
            "document.body.append(Object.assign(document.createElement('script'), { textContent: 'injected = 1' }))"
        )
        assert tab.evaluate("globalThis.injected ?? null") is None


def test_a_particle_is_where_the_desktop_has_it(browser: Browser, address: str) -> None:
    tab = _opened(browser, address, "rope")
    tab.evaluate("toy.restart(); toy.pause(); for (let k = 0; k < 60; k++) toy.step()")
    session = Session(load_level("rope"))
    for _ in range(60):
        session.advance()
    for name in ("rope.40", "rope.0", "garland.10"):
        slot = session.world.particle_slot(name)
        x, y, vx, vy, is_pinned = tab.evaluate(f"Object.values(toy.particle('{name}'))")
        assert [x, y] == session.world.position[slot].tolist()
        assert [vx, vy] == session.world.velocity[slot].tolist()
        assert is_pinned == (session.world.inverse_mass[slot] == 0.0)
    assert tab.evaluate("try { toy.particle('no.1') } catch (error) { error.message }") == 'there is no particle "no.1"'


def test_checks_and_breaks_are_told_as_the_desktop_finds_them(browser: Browser, address: str) -> None:
    tab = _opened(browser, address, "checked")
    heard = tab.evaluate(HEARD.replace("COUNT", "160"))
    found = {detail["name"]: detail for name, detail in heard if name == "check"}
    for result in run_checks(_checked()):
        told = found[result.check.name]
        assert told["holds"] == result.passed, result.text
        assert told["value"] == pytest.approx(result.value, rel=1e-9, abs=1e-12), result.text
    session, broken = Session(_checked()), []
    for _ in range(160):
        session.advance()
        if len(session.world.broken):
            broken.append([session.world.spring_names[slot] for slot in session.world.broken])
    assert [detail["springs"] for name, detail in heard if name == "break"] == broken


def test_commands_by_name_are_recorded_and_verified(browser: Browser, address: str, tmp_path: Path) -> None:
    tab = _opened(browser, address, "rope")
    tab.evaluate(
        """toy.restart();
        toy.pause();
        for (let k = 0; k < 10; k++) toy.tick();
        toy.command({ type: 'pin', particle: 'rope.20' });
        toy.command({ type: 'set_coefficients', stiffness: 0.3, material: 'hemp' });
        for (let k = 0; k < 30; k++) toy.tick();"""
    )
    replay = read_replay(saved(tab, tmp_path, "toy"))
    assert [line.record["type"] for line in replay.script] == ["pin", "set_coefficients"]
    assert verify(replay) is None


def test_what_a_page_takes_the_desktop_verifies_also_what_it_was_not_told(
    browser: Browser, address: str, tmp_path: Path
) -> None:
    tab = _opened(browser, address, "rope")
    tab.evaluate(
        """toy.restart();
        toy.pause();
        for (let k = 0; k < 3; k++) toy.tick();
        toy.command({ type: 'grab', grab: 0, particle: 'rope.end', target: [5, 7] });
        toy.command({ type: 'push', position: [-0, 5], radius: 100, outward: 2 });
        toy.command({ type: 'set_air', drag: 0.5, wind: null });
        toy.command({ type: 'cut_springs', springs: ['garland:3', 'garland:3'] });
        for (let k = 0; k < 5; k++) toy.tick();"""
    )
    replay = read_replay(saved(tab, tmp_path, "toy"))
    assert replay.script[0].record == {
        "type": "grab", "grab": 0, "particle": "rope.40", "target": [5, 7], "strength": 100, "radius": 0,
    }  # fmt: skip
    assert len(replay.script) == 4 and verify(replay) is None


def test_what_a_page_refuses_it_refuses_in_the_words_of_the_desktop(browser: Browser, address: str) -> None:
    tab = _opened(browser, address, "suspension_car")
    world = build_world(load_level("suspension_car"))
    before, tried = names_in(BEFORE, world), names_in(wrong_records(), world)
    tab.evaluate(f"toy.restart(); toy.pause(); {literal(before)}.forEach((record) => toy.command(record)); toy.tick()")
    trial = "try { toy.command(record); return 'taken' } catch (error) { return error.message }"
    hashed = tab.evaluate("toy.world.hash().whole")
    desktop = tried_on_the_desktop(world, before, tried)
    refused = [record for record, (words, _) in zip(tried, desktop, strict=True) if words != "taken"]
    said = tab.evaluate(f"{literal(refused)}.map((record) => {{ {trial} }})")
    assert [(words, hashed) for words in said] == [each for each in desktop if each[0] != "taken"]
    assert len(refused) > 200
    assert tab.evaluate("[toy.world.hash().whole, toy.run.commands.length]") == [hashed, len(before)]
    told = tab.evaluate("try { toy.command({ type: 'undo' }) } catch (error) { error.message }")
    assert told.startswith("a page cannot do undo; it can do ") and "set_solver" in told


def test_what_cannot_be_opened_is_one_line(browser: Browser, address: str) -> None:
    tab = _opened(browser, address, "rope")
    trial = "import('./sandbox/toy.js').then(({ open }) => open(document.createElement('canvas'), '%s'))"
    told = f"({trial}).catch((error) => error.message)"
    assert tab.evaluate(told % "levels/no.toy") == "There is no file levels/no.toy here."
    assert tab.evaluate(told % "index.html") == "index.html was cut off or damaged."


def test_a_closed_toy_stands_still_and_hears_nothing(browser: Browser, address: str) -> None:
    tab = _opened(browser, address, "rope")
    time = tab.evaluate("toy.close(); toy.run.time")
    tab.evaluate("new Promise((done) => setTimeout(done, 100))")
    tab.evaluate("toy.canvas.dispatchEvent(new KeyboardEvent('keydown', { key: '.' }))")
    assert tab.evaluate("toy.run.time") == time
