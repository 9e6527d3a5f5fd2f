"""Links: a run with parts made in play goes from the window to a page, is taken over, and comes back, bit for bit."""

import json
import random
from pathlib import Path

import pytest

from sandbox import Session, load_level
from sandbox.app.share.runs_for_pages import link_to
from sandbox.commands import (
    AddBody,
    AddParticle,
    AddSpring,
    CutSprings,
    Grab,
    MoveGrab,
    Pin,
    Release,
    Remove,
    SetCoefficients,
    SetDrive,
    SetFirmness,
)
from sandbox.level.format.slices import at_once
from sandbox.level.kinds.jelly import Jelly, JellyDef
from sandbox.replay import Replay, read_replay
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.link import fragment_of, replay_of
from sandbox.tools.dropping import PARTS
from tests.page.browser import Browser, Tab
from tests.page.opened import FRAMES, VERDICT
from tests.page.site_server import served
from tests.support.parts import furnished
from tests.support.wholes import some_and_whole

LEVELS = ("jelly_pile", "rope", "pinball", "truck_bridge", "newtons_cradle")
SHAPES = ({"box": [0.8, 0.6]}, {"circle": 0.4}, {"polygon": [[0, 0], [0.9, 0.1], [0.7, 0.8], [0.3, 0.5], [0, 0.9]]})
TICKS = 240


def drawn(chance: random.Random) -> AddBody:
    """A body as the tool that draws adds it: each particle, spring and triangle said."""
    given = {"type": "jelly", "id": "drawn", "shape": chance.choice(SHAPES), "spacing": 0.2, "mesh": "fitted"}
    made = Jelly(JellyDef.model_validate_json(json.dumps(given)))
    x, y = chance.uniform(-3.0, 3.0), chance.uniform(1.0, 4.0)
    places = [[round(a + x, 3), round(b + y, 3)] for a, b in made.form.tolist()]
    body = {
        "type": "mesh", "particles": places, "masses": [chance.choice((0.1, 0.2))] * len(places),
        "springs": made.pairs.tolist(), "triangles": made.polygons().tolist(), "particle_radius": 0.03,
        "material": "drawn jelly", "look": {"skin": "jelly", "face": True, "colour": "grape"},
    }  # fmt: skip
    more = {"friction": 0.7, "velocity": [1.5, 0.25], "pinned": [0, 2], "collides": ["terrain"]}
    body |= {name: value for name, value in more.items() if chance.random() < 0.3}
    return AddBody(body, materials={"drawn jelly": {"stiffness": 0.75, "damping": 0.7}})


def played(folder: Path, level: str, seed: int) -> Replay:
    """A recorded run with parts made in play, drags, cuts, pins and other firmness."""
    chance, session = random.Random(seed), Session(load_level(level))
    session.record_to(folder / f"{level}.replay.gz")
    while session.tick < TICKS:
        world, tick = session.world, session.tick
        hands = range(world.grab_particle, world.grab_particle + 10)
        there = [slot for slot in world.particle_active.nonzero()[0].tolist() if slot not in hands]
        place = round(chance.uniform(-3.0, 3.0), 3), round(chance.uniform(1.0, 4.0), 3)
        gesture = 900 + tick // 40
        if tick in (5, 90) or chance.random() < 0.01:
            session.do(drawn(chance))
        if chance.random() < 0.02:
            session.do(AddParticle(place, radius=0.1, pinned=chance.random() < 0.3, restitution=0.5))
        if chance.random() < 0.02:
            session.do(AddSpring(*chance.sample(there, 2), stiffness=0.3))
        if chance.random() < 0.02:
            material = chance.randrange(len(world.material_names))
            session.submit(SetCoefficients(stiffness=0.4, damping=0.7, material=material, duration=20))
        if chance.random() < 0.02:
            session.submit(Pin(chance.choice(there)))
        if tick == 200 and world.spring_active[:20].any():
            session.submit(CutSprings((int(world.spring_active.nonzero()[0][0]),)))
        if tick in (120, 170):
            session.do(Remove(particle=chance.choice(there)))
            there = [slot for slot in there if world.particle_active[slot]]
        if tick % 40 == 10:
            session.submit(Grab(0, chance.choice(there), place), gesture)
        elif 10 < tick % 40 < 30:
            session.submit(MoveGrab(0, place), gesture)
        elif tick % 40 == 30:
            session.submit(Release(0), gesture)
        session.advance()
    session.stop_recording()
    return read_replay(folder / f"{level}.replay.gz")


@pytest.fixture(scope="module")
def address(site):
    """Where the site is."""
    with served(site) as at:
        yield at


def _link(tab: Tab) -> str:
    """The link to what was done on a page until now."""
    return str(tab.evaluate("page.toy.link().then((fragment) => location.href.split('#')[0] + fragment)"))


@pytest.mark.parametrize("level", some_and_whole(("jelly_pile", "pinball"), LEVELS))
def test_a_run_goes_to_a_page_is_taken_over_and_comes_back(
    browser: Browser, address: str, tmp_path: Path, level: str
) -> None:
    replay = played(tmp_path, level, seed=LEVELS.index(level) + 1)
    types = {line.record["type"] for line in replay.script}
    assert {"add_body", "grab", "move_grab"} <= types
    link = at_once(link_to(replay, address, 0))
    assert link.startswith(f"{address}levels/{level}.html#scene=")
    assert verify(replay_of(link)) is None
    tab = browser.tab().open(link)
    assert str(tab.evaluate(VERDICT)).startswith(f"Verified: {TICKS} ticks, the very state that the sender had.")
    # Somebody takes it over at a tick in its midst.
    tab.evaluate("page.toy.pause(); page.toy.seek(150); page.toy.command({ type: 'set_gravity', gravity: [1, -5] })")
    tab.evaluate("page.toy.play()")
    tab.evaluate(FRAMES)
    tab.evaluate("page.toy.pause()")
    back = replay_of(_link(tab))
    assert back.ticks > 150 and back.script[-1].record["type"] == "set_gravity"
    assert verify(back) is None


def test_what_a_page_makes_itself_comes_back(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}levels/jelly_pile.html")
    tab.evaluate("""page.toy.pause(); {
      const { maker } = page.toy.hands, world = page.toy.world;
      maker.begin([-2, 3], null);
      for (const point of [[-1, 3], [-1, 4], [-2, 4]]) maker.go(point, 0.1);
      maker.end('jelly', [-2, 3.1], null, 0.1);
      maker.begin([-1.5, 5], null);
      maker.end('rope', [-1.5, 4], world.names.particle.length - 1, 0.1);
      maker.begin([0, 5], null);
      maker.end('spring', [0, 4], 3, 0.1);
    } page.toy.play()""")
    tab.evaluate(FRAMES)
    tab.evaluate("page.toy.pause()")
    back = replay_of(_link(tab))
    kinds = [line.record["type"] for line in back.script]
    assert kinds == ["add_body", "add_body", "add_spring", "add_particle", "add_spring"]
    assert verify(back) is None


def test_undo_takes_away_what_was_made_with_its_rows_and_names(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}levels/rope.html")
    add = "page.toy.command({ type: 'add_particle', position: [0, 3], radius: 0.1 })"
    tab.evaluate(f"page.toy.pause(); globalThis.before = page.toy.world.hash().whole; {add}; {add}")
    assert tab.evaluate("page.toy.particles.slice(-2)") == ["+.0", "+.1"]
    assert tab.evaluate("page.toy.undo() && page.toy.undo() && page.toy.world.hash().whole === before")
    assert tab.evaluate(f"{add}; page.toy.particles.at(-1)") == "+.0"


@pytest.mark.parametrize("fragment", ["#scene=", "#scene=AAAA", "#scene=" + "A" * 40_000, "#scene=%00"])
def test_a_broken_link_is_said_and_the_level_plays(browser: Browser, address: str, fragment: str) -> None:
    tab = browser.tab().open(f"{address}levels/rope.html{fragment}")
    assert "link" in tab.evaluate(VERDICT)
    assert tab.evaluate("page.toy.run.commands.length") == 0


@pytest.fixture
def with_a_cart(tmp_path: Path) -> Replay:
    """A run into which a cart was dropped: it has motors and keys."""
    session = Session(load_level("rope"))
    session.record_to(tmp_path / "cart.replay.gz")
    for tick in range(80):
        if tick == 20:
            session.do(PARTS["cart"].make(1.0, (0.0, 4.0), (0.0, 0.0), "sky"))
        if tick == 40:
            session.do(SetDrive(len(session.world.actuator_value) - 1, 1.0))
        session.advance()
    session.stop_recording()
    return read_replay(tmp_path / "cart.replay.gz")


def test_a_cart_drives_on_a_page_and_goes_and_comes_with_time(
    browser: Browser, address: str, with_a_cart: Replay
) -> None:
    tab = browser.tab().open(at_once(link_to(with_a_cart, address, 0)))
    assert str(tab.evaluate(VERDICT)).startswith("Verified: 80 ticks, the very state")
    tab.evaluate("page.toy.pause(); page.toy.seek(80)")
    assert tab.evaluate("Object.keys(page.toy.drives.keys)") == ["q", "w"]
    tab.evaluate(" globalThis.end = page.toy.world.hash().whole")
    assert tab.evaluate(
        "[10, 50, 19, 80].every((tick) => { page.toy.seek(tick); return page.toy.world.time === tick; })"
    )
    assert tab.evaluate("page.toy.world.hash().whole === end")
    tab.evaluate("page.toy.seek(60); page.toy.command({ type: 'set_gravity', gravity: [0, -5] }); page.toy.tick()")
    assert verify(replay_of(_link(tab))) is None


def test_a_definition_is_no_kit_and_the_page_says_when(browser: Browser, address: str, with_a_cart: Replay) -> None:
    said = browser.tab().open(f"{address}levels/rope.html#{fragment_of(with_a_cart)}").evaluate(VERDICT)
    assert said == "Not verified: at 0.3 s body: kits have no such thing."


def test_a_link_with_a_kit_in_place_of_a_definition_comes_to_the_same_state(tmp_path: Path) -> None:
    level = furnished()
    session = Session(level)
    session.record_to(tmp_path / "soft.replay.gz")
    session.do(SetFirmness(0, sag=0.1, duration=10))
    session.do(AddBody({"type": "rope", "start": [-1.0, 5.0], "end": [1.0, 5.0], "segments": 6}))
    for _ in range(60):
        session.advance()
    session.stop_recording()
    replay = read_replay(tmp_path / "soft.replay.gz")
    link = at_once(link_to(replay, "", 0))
    (kit,) = (line.record for line in replay_of(link).script if line.record["type"] == "add_body")
    assert set(kit) == {"type", "kit"} and verify(replay_of(link)) is None
