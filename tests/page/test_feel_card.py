"""The card of how a thing feels in a page: the desktop's numbers, bit for bit; what it finds is set, undone, copied."""

from pathlib import Path

import pytest

from sandbox.app.panel.feel.feel_work import HINT, LOOKING
from sandbox.export.curves import curve_for
from sandbox.export.feel import Feel, feel_in_slices, feel_of, material_of, sentence, sought
from sandbox.export.numbers import percent, short
from sandbox.export.release import NoCurve
from sandbox.level.assembly.build_world import LevelWorld, build_world
from sandbox.level.reading.files import load_level
from sandbox.physics.step import step
from tests.page.axe import violations
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import TICKED, opened
from tests.page.pointing import drag

BEFORE = 600
# The menu of a particle, and the row of it that opens the card.
OPEN = """(() => {{
  const {{ menu, toy }} = page;
  menu.open({{ particle: toy.world.names.particle.indexOf('{particle}'), x: 100, y: 100 }});
  [...menu.box.querySelectorAll('button')].find((row) => row.textContent === 'how it feels').click();
}})()"""
# What the card says once no work is left: sentence, note, readings and fields.
CARD = """new Promise((done) => {
  const card = page.feel, look = () => (card.bar.style.visibility === 'hidden' ? done([card.said.textContent,
    card.note.textContent, card.readings.map(({ value }) => value.textContent),
    card.fields.map(({ field }) => field.value)]) : setTimeout(look, 20));
  look();
})"""


def at_rest(level: str) -> LevelWorld:
    world = build_world(load_level(level))
    for _ in range(BEFORE):
        step(world)
    return world


def card_in_page(browser: Browser, folder: Path, level: str, particle: str, **how: object) -> Tab:
    tab = opened(browser, folder, level_page(level), **how)
    tab.evaluate(f"{TICKED}; for (let k = 0; k < {BEFORE}; k++) page.toy.run.step()")
    tab.evaluate(OPEN.format(particle=particle))
    return tab


def typed(k: int, value: float) -> str:
    return f"""(() => {{
  const {{ field }} = page.feel.fields[{k}];
  field.value = '{value}';
  field.dispatchEvent(new Event('change'));
}})()"""


def numbers_of(card: Feel) -> list[float]:
    numbers = card.numbers
    return [
        card.released.tick, numbers.overshoot, numbers.settling, numbers.swings, card.stiffness, card.damping, card.hz,
        card.ratio, card.difference,
    ]  # fmt: skip


@pytest.mark.parametrize(("way", "number"), [("down", 0), ("aside", 1)])
def test_a_card_says_what_the_desktop_measures_bit_for_bit(browser, tmp_path, way, number):
    card = feel_of(at_rest("low_door"), "bridge", way=way)
    tab = card_in_page(browser, tmp_path, "low_door", "bridge.2")
    tab.evaluate(f"page.feel.ways[{number}].click()")
    said, note, readings, fields = tab.evaluate(CARD)
    assert tab.evaluate("[...page.feel.shown.numbers]") == numbers_of(card)
    assert tab.evaluate("[...page.feel.shown.errors]") == card.released.errors.tolist()
    assert (said, note) == (sentence(card), HINT)
    assert readings == [
        f"{short(card.hz)} Hz", short(card.ratio), str(card.numbers.swings), percent(card.difference)
    ]  # fmt: skip
    assert fields == [short(100.0 * card.numbers.overshoot), short(card.numbers.settling)]
    assert tab.faults == []


def test_what_is_typed_is_found_set_undone_and_copied_as_on_the_desktop(browser, tmp_path):
    world = at_rest("low_door")
    wanted = sought(world, 0.1, 0.6, lambda tried: feel_in_slices(tried, "bridge"), material_of(world, "bridge"))
    tab = card_in_page(browser, tmp_path, "low_door", "bridge.2")
    before = feel_of(world, "bridge").numbers
    tab.evaluate(CARD)
    first = "page.toy.world.view('state.stiffness')[0]"
    stiffness = tab.evaluate(first)
    # The first search is given up for the second one.
    tab.evaluate(typed(0, 10.0))
    assert tab.evaluate("page.feel.note.textContent") == LOOKING
    assert before.settling != 0.6
    tab.evaluate(typed(1, 0.6))
    said, note, _, _ = tab.evaluate(CARD)
    assert tab.evaluate("page.feel.shown.pair") == [wanted.stiffness, wanted.damping]
    assert (said, note) == (sentence(wanted.feel), f"{wanted.pair_text(world)}: {wanted.nearness}.")
    tab.evaluate("page.feel.take.click()")
    css = curve_for(wanted.feel, "css")[1]
    assert tab.evaluate("new Promise((done) => setTimeout(() => done(page.feel.note.textContent), 200))").endswith(css)
    tab.evaluate("page.feel.use.click(); for (let k = 0; k < 60; k++) page.toy.run.step()")
    assert tab.evaluate(first) == wanted.stiffness != stiffness
    tab.evaluate("page.toy.undo()")
    assert tab.evaluate(first) == stiffness
    assert tab.faults == []


def test_handles_are_dragged_and_escape_closes_the_card(browser, tmp_path):
    tab = card_in_page(browser, tmp_path, "low_door", "bridge.2", width=1280, height=800)
    tab.evaluate(CARD)
    x, y, width, height = tab.evaluate(
        "(({ x, y, width, height }) => [x, y, width, height])(page.feel.chart.getBoundingClientRect())"
    )
    fields = [float(text) for text in tab.evaluate(CARD)[3]]
    place = tab.evaluate("page.feel.handles()[1]")
    assert 0.5 * width < place[0] < 0.65 * width and 0.2 * height < place[1] < 0.5 * height
    drag(tab, (x + place[0], y + place[1]), (x + place[0] - 30.0, y + place[1]))
    assert float(tab.evaluate("page.feel.fields[1].field.value")) < 0.95 * fields[1]
    assert tab.evaluate(CARD)[1].split(" for the springs of ")[0].startswith("Cs ")
    tab.key("Escape")
    assert tab.evaluate("[page.feel.box.hidden, document.activeElement.id]") == [True, "picture"]


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_axe_finds_nothing_on_a_card(browser, tmp_path, scheme):
    tab = card_in_page(browser, tmp_path, "low_door", "bridge.2", scheme=scheme)
    tab.evaluate(CARD)
    assert violations(tab) == []


def test_what_has_no_curve_or_no_springs_says_so(browser, tmp_path):
    with pytest.raises(NoCurve) as told:
        feel_of(at_rest("rope"), "rope")
    tab = card_in_page(browser, tmp_path, "rope", "rope.5")
    said, note, readings, fields = tab.evaluate(CARD)
    line = str(told.value)
    assert (said, note) == ("", f"{line[0].upper()}{line[1:]}.")
    assert set(readings) == {"–"} and fields == ["", ""]
    assert tab.evaluate("page.feel.take.disabled && page.feel.use.disabled && page.feel.fields[0].field.disabled")
