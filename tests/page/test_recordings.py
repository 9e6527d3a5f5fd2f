"""What was recorded on the desktop plays in a page bit for bit, also what no kernel of a page does."""

from collections.abc import Callable
from pathlib import Path

import pytest

from sandbox import Session, load_level
from sandbox.app.share.playing import page_of
from sandbox.commands import (
    AddBody,
    AddParticle,
    CutSprings,
    Free,
    Grab,
    MoveBody,
    MoveGrab,
    Pin,
    Push,
    Release,
    Remove,
    ScaleMass,
    SetAir,
    SetCoefficients,
    SetDrive,
    SetFirmness,
    SetGravity,
    SetInflation,
    SetSolver,
    Shake,
    Unpin,
)
from sandbox.editor.document import empty_level
from sandbox.replay import Replay, read_replay, verify
from tests.page.browser import Browser
from tests.page.opened import VERDICT, opened, saved
from tests.support.parts import BODIES, RandomPlayer, furnished, placed_cart
from tests.support.wholes import some_and_whole

TICKS = 150
# Ticks of a recording, without commands, between which a page goes back and forth.
SOUGHT = (TICKS, 35, 95, 0, 65)


def _drive(session: Session, tick: int) -> None:
    if tick == 10:
        session.submit(SetDrive(0, 1.0))
    if tick == 40:
        session.submit(SetCoefficients(stiffness=0.4, damping=0.7, material=1, duration=90))
    if tick == 60:
        session.submit(SetGravity((1.0, -5.0)))
    if tick == 80:
        session.submit(SetAir(wind=(3.0, 0.5), drag=0.4))


def _soften_and_shake(session: Session, tick: int) -> None:
    cube = [form.name for form in session.world.forms].index("cube 1")
    if tick in (10, 70):
        session.submit(SetFirmness(cube, sag=0.1 if tick == 10 else 0.0, duration=45))
    if tick == 30:
        session.submit(SetInflation(session.world.area_names.index("cube 1"), 1.4, 40))
    if 50 <= tick < 60:
        session.submit(Shake((30.0 * (-1) ** tick, 12.0)), 999)
    if tick == 100:
        session.submit(Push((0.0, 1.0), 2.0, impulse=(3.0, 9.0), outward=1.0))


def _move_free_and_remove(session: Session, tick: int) -> None:
    cube, plank = (session.world.particle_slot(name) for name in ("cube 1.0", "plank 2.0"))
    if tick == 5:
        session.submit(Grab(0, plank, (0.0, 2.0), radius=0.4), 77)
    if tick == 20:
        session.submit(MoveBody(cube, (0.5, 1.5), at_rest=True))
    if tick == 40:
        session.submit(ScaleMass(cube, 2.5))
    if tick == 60:
        session.submit(Free(cube))
    if tick == 90:
        session.submit(Remove(particle=plank))


def _change_the_solver(session: Session, tick: int) -> None:
    middle = session.world.particle_slot("rope.20")
    if tick == 5:
        session.submit(Grab(0, middle, (1.0, 2.0)), 50)
    if tick in (30, 60, 90):
        solver = {30: "iterative", 60: "single_pass", 90: "direct"}[tick]
        session.submit(SetSolver(solver, 12, "auto" if tick == 30 else 4, duration=20))
    if tick == 55:
        session.submit(SetCoefficients(stiffness=0.2, damping=0.2))
    if tick == 80:
        session.submit(MoveGrab(0, (2.0, 1.0)), 50)
    if tick == 100:
        session.submit(Release(0), 50)


def _cut_and_undo(session: Session, tick: int) -> None:
    if tick in (20, 50):
        session.submit(CutSprings(tuple(range(tick, tick + 12))))
    if tick in (40, 70):
        session.undo()
    if tick == 90:
        session.redo()


def _pin_and_tear(session: Session, tick: int) -> None:
    middle = session.world.particle_slot("deck.8")
    if tick == 5:
        session.submit(Pin(session.world.particle_slot("deck.5")))
    if tick == 10:
        x, y = session.world.position[middle].tolist()
        session.submit(Grab(0, middle, (x, y - 5.0), strength=300.0), 9)
    if tick == 100:
        session.submit(Release(0), 9)
        session.submit(Unpin(session.world.particle_slot("deck.5")))


RUNS: dict[str, tuple[str, Callable[[Session, int], None]]] = {
    "driven": ("suspension_car", _drive),
    "softened and shaken": ("jelly_pile", _soften_and_shake),
    "moved, freed and removed": ("jelly_pile", _move_free_and_remove),
    "with other solvers": ("rope", _change_the_solver),
    "cut and undone": ("curtain", _cut_and_undo),
    "pinned and torn": ("breaking_bridge", _pin_and_tear),
}


def _record(folder: Path, session: Session, act: Callable[[int], None], ticks: int = TICKS) -> Replay:
    file = folder / "run.replay.gz"
    session.record_to(file)
    for tick in range(ticks):
        act(tick)
        session.advance()
    session.stop_recording()
    return read_replay(file)


def _recorded(folder: Path, run: str) -> Replay:
    level, act = RUNS[run]
    session = Session(load_level(level))
    replay = _record(folder, session, lambda tick: act(session, tick))
    assert not session.messages or run == "pinned and torn"
    return replay


@pytest.mark.parametrize("run", some_and_whole(("softened and shaken", "cut and undone"), RUNS))
def test_a_recording_is_verified_scrubbed_and_taken_over(browser: Browser, tmp_path: Path, run: str) -> None:
    replay = _recorded(tmp_path, run)
    tab = opened(browser, tmp_path, page_of(replay.level, replay.script, replay.ticks))
    tab.evaluate("page.toy.pause()")
    assert tab.evaluate(VERDICT) == f"Verified: every bit of {TICKS} ticks is that of the recording."
    # What was undone is no part of what a page plays: until then it goes another way.
    for tick in SOUGHT if run != "cut and undone" else (TICKS, 19, 120):
        hashed = tab.evaluate(f"page.toy.seek({tick}); page.toy.world.hash().whole")
        assert replay.hashes[tick].fits(hashed), tick
    tab.evaluate("page.toy.seek(120); page.toy.command({ type: 'set_gravity', gravity: [0, -3] })")
    assert tab.evaluate("[page.toy.run.last, page.toy.run.isFollowing]") == [120, False]
    tab.evaluate("for (let k = 0; k < 30; k++) page.toy.tick()")
    taken = read_replay(saved(tab, tmp_path))
    assert (taken.ticks, verify(taken)) == (TICKS, None)
    assert tab.faults == []


@pytest.mark.parametrize(
    ("solver", "seed"),
    some_and_whole([("iterative", 2)], [("direct", 1), ("iterative", 2), ("single_pass", 3), ("direct", 4)]),
)
def test_whatever_is_added_moved_and_removed_is_verified(
    browser: Browser, tmp_path: Path, solver: str, seed: int
) -> None:
    session = Session(furnished(solver))
    player = RandomPlayer(session, seed)
    replay = _record(tmp_path, session, lambda tick: player.act(), 240)
    assert {line.record["type"] for line in replay.script} >= {"add_body", "undo", "shake"}
    tab = opened(browser, tmp_path, page_of(replay.level, replay.script, replay.ticks))
    tab.evaluate("page.toy.pause()")
    assert tab.evaluate(VERDICT) == "Verified: every bit of 240 ticks is that of the recording."
    tab.evaluate("[240, 100, 170, 10, 200].forEach((tick) => page.toy.seek(tick))")
    tab.evaluate("page.toy.command({ type: 'set_gravity', gravity: [0, -3] })")
    tab.evaluate("for (let k = 0; k < 30; k++) page.toy.tick()")
    taken = read_replay(saved(tab, tmp_path))
    assert (taken.ticks, verify(taken), tab.faults) == (230, None, [])


def test_who_takes_over_holds_nothing_that_the_recording_held(browser: Browser, tmp_path: Path) -> None:
    replay = _recorded(tmp_path, "with other solvers")
    tab = opened(browser, tmp_path, page_of(replay.level, replay.script, 95))
    assert tab.evaluate(VERDICT).startswith("Verified")
    grab = "{ type: 'grab', grab: 0, particle: 'rope.9', target: [0, 1], strength: 100, radius: 0 }"
    tab.evaluate("page.toy.pause()")
    for act in (f"page.toy.seek(70); page.toy.command({grab})", "page.toy.undo()", "page.toy.tick()"):
        tab.evaluate(act)
    assert tab.evaluate("[page.toy.run.time, page.toy.world.isHeld(0)]") == [71, False]
    taken = read_replay(saved(tab, tmp_path))
    assert (taken.ticks, verify(taken)) == (71, None)
    tab = opened(browser, tmp_path, page_of(replay.level, replay.script, 95))
    assert tab.evaluate(VERDICT).startswith("Verified")
    # At the end nobody holds on either, once time passes again.
    tab.evaluate("page.toy.pause(); page.toy.seek(95)")
    assert tab.evaluate("[page.toy.world.isHeld(0), page.toy.tick(), page.toy.world.isHeld(0)]") == [True, None, False]
    assert verify(read_replay(saved(tab, tmp_path))) is None


def test_what_is_added_later_cannot_be_used_before(browser: Browser, tmp_path: Path) -> None:
    session = Session(furnished())
    body = BODIES["jelly"] | {"material": "soft"}

    def act(tick: int) -> None:
        if tick == 30:
            session.submit(AddBody(body, materials={"soft": {"stiffness": 0.2, "damping": 0.5}}))
        if tick == 40:
            session.submit(SetGravity((0.0, -2.0)))

    replay = _record(tmp_path, session, act, 60)
    tab = opened(browser, tmp_path, page_of(replay.level, replay.script, replay.ticks))
    assert tab.evaluate(VERDICT).startswith("Verified")
    tab.evaluate("page.toy.pause(); document.getElementById('tune').click()")
    offered = "[...document.querySelectorAll('#material option')].filter((one) => !one.disabled).map((one) => one.text)"
    gravity = "new Promise((done) => setTimeout(() => done(document.querySelectorAll('.fields input')[1].value), 100))"
    tab.evaluate("page.toy.seek(35); document.getElementById('material').value = 2; page.panel.show()")
    assert "soft" in tab.evaluate(offered) and tab.evaluate(gravity) == "-9.81"
    tab.evaluate("for (let k = 0; k < 10; k++) page.toy.tick()")
    assert tab.evaluate(gravity) == "-2"
    # Marked while it is there.
    tab.evaluate(
        "page.toy.hands.cursor.marked = page.toy.level.about.names.particle.indexOf('+1.0'); page.toy.seek(10)"
    )
    assert "soft" not in tab.evaluate(offered)
    tab.evaluate("document.getElementById('picture').focus()")
    tab.key("Enter")
    tab.evaluate("document.querySelector('.words button').click()")
    for use in ("page.toy.particle('+1.0')", "page.toy.command({ type: 'pin', particle: '+1.0' })"):
        assert tab.evaluate(f"try {{ {use} }} catch (error) {{ error.message }}") == 'there is no particle "+1.0"'
    tab.evaluate("for (let k = 0; k < 10; k++) page.toy.tick()")
    taken = read_replay(saved(tab, tmp_path))
    assert [line.record["type"] for line in taken.script] == ["set_coefficients"]
    assert (verify(taken), tab.faults) == (None, [])


def test_an_excerpt_has_no_commands_of_what_follows(browser: Browser, tmp_path: Path) -> None:
    replay = _recorded(tmp_path, "driven")
    tab = opened(browser, tmp_path, page_of(replay.level, replay.script, 50))
    assert tab.evaluate(VERDICT).startswith("Verified: every bit of 50 ticks")
    assert tab.evaluate("page.toy.run.commands.map(({ tick }) => tick)") == [10, 40]


def test_a_recording_that_begins_with_nothing_plays_and_hands_get_their_slots(browser: Browser, tmp_path: Path) -> None:
    session = Session(empty_level())

    def act(tick: int) -> None:
        if tick == 1:
            session.submit(AddParticle((0.0, 1.0)))
            session.submit(AddBody(**placed_cart(0.0, 4.0)))
        if tick == 5:
            session.submit(Grab(0, session.world.particle_slot("+.0"), (1.0, 2.0)))

    replay = _record(tmp_path, session, act, 30)
    assert {line.record["type"] for line in replay.script} == {"add_particle", "add_body", "grab"}
    tab = opened(browser, tmp_path, page_of(replay.level, replay.script, replay.ticks))
    assert tab.evaluate(VERDICT).startswith("Verified: every bit of 30 ticks")
    tab.evaluate("page.toy.seek(2); page.toy.seek(30)")
    assert tab.evaluate("page.toy.world.names.particle.includes('+hand.3') && page.toy.world.hands.particle > 0")
