import pytest

from sandbox.level.reading.files import load_level
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from sandbox.session.commands import (
    AddParticle,
    AddSpring,
    CommandError,
    CutSprings,
    Grab,
    MoveGrab,
    Pin,
    Redo,
    Release,
    SetCoefficients,
    SetDrive,
    SetGravity,
    SetSolver,
    Undo,
    Unpin,
)
from sandbox.session.log import ReachedStates
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from sandbox.session.transaction import Interrupted
from tests.session.test_breaks_and_drives import advance, busy_level
from tests.support.rope_level import rope_level


@pytest.fixture
def session() -> Session:
    return Session(rope_level())


def _advance(session: Session, ticks: int) -> None:
    for _ in range(ticks):
        session.advance()


def _drag(session: Session, particle: int, ticks: int = 20) -> None:
    gesture = session.new_gesture()
    session.submit(Grab(0, particle, (3.0, 1.0)), gesture)
    for tick in range(ticks):
        session.submit(MoveGrab(0, (3.0, 1.0 + 0.05 * tick)), gesture)
        session.advance()
    session.submit(Release(0), gesture)


def test_a_held_particle_follows_the_hand_and_falls_when_released(session):
    gesture = session.new_gesture()
    session.submit(Grab(0, 11, (4.0, 2.0)), gesture)
    _advance(session, 240)
    assert session.world.position[11] == pytest.approx((4.0, 2.0), abs=0.4)
    session.submit(Release(0), gesture)
    _advance(session, 60)
    assert session.world.position[11, 1] < 0.0


def test_several_particles_are_held_at_once(session):
    for hand, (particle, x) in enumerate(((4, 1.0), (8, 3.0), (11, 5.0))):
        session.submit(Grab(hand, particle, (x, 1.0)))
    _advance(session, 300)
    for particle, x in ((4, 1.0), (8, 3.0), (11, 5.0)):
        assert session.world.position[particle] == pytest.approx((x, 1.0), abs=0.5)


def test_commands_take_effect_while_paused(session):
    session.submit(CutSprings((3,)))
    session.apply_pending()
    assert session.tick == 0
    assert not session.world.spring_active[3]


def test_undo_of_a_drag_gives_the_run_without_it(session):
    untouched = Session(rope_level())
    _advance(session, 70)
    _drag(session, 6)
    _advance(session, 15)
    session.undo()
    session.apply_pending()
    _advance(untouched, session.tick)
    assert state_hash(session.world) == state_hash(untouched.world)


def test_redo_brings_back_the_run_with_the_gesture(session):
    twin = Session(rope_level())
    for run in (session, twin):
        _advance(run, 30)
        _drag(run, 6)
        run.submit(SetCoefficients(stiffness=0.1))
        _advance(run, 50)
    for _ in range(2):
        session.undo()
    for _ in range(2):
        session.redo()
    session.apply_pending()
    assert state_hash(session.world) == state_hash(twin.world)
    assert session.can_undo and not session.can_redo


def test_what_is_redone_where_it_was_done_is_there_after_going_back_and_forth(session):
    _drag(session, 6, ticks=1)
    session.submit(AddParticle((0.0, 1.0)))
    session.apply_pending()
    added = state_hash(session.world)
    session.undo()
    session.redo()
    session.apply_pending()
    session.seek(0)
    session.seek(1)
    assert state_hash(session.world) == added


def test_a_new_gesture_ends_the_chance_to_redo(session):
    session.submit(Pin(3))
    session.advance()
    session.undo()
    session.submit(Pin(4))
    session.apply_pending()
    assert not session.can_redo
    session.redo()
    session.apply_pending()
    assert session.refusals == ["nothing to redo"]
    assert session.world.inverse_mass[3] > 0.0


def test_undo_with_nothing_to_undo_says_so(session):
    session.undo()
    session.advance()
    assert session.refusals == ["nothing to undo"]


def test_undo_during_a_drag_ends_it_and_redo_leaves_no_hand_behind(session):
    gesture = session.new_gesture()
    session.submit(Grab(0, 6, (3.0, 1.0)), gesture)
    _advance(session, 10)
    session.undo()
    session.submit(MoveGrab(0, (9.0, 9.0)), gesture)
    session.apply_pending()
    assert not session.world.is_held(0)
    session.redo()
    session.apply_pending()
    assert not session.world.is_held(0)
    assert not session.messages


def test_undo_takes_back_what_was_added_and_its_name_can_be_used_again(session):
    session.submit(AddParticle((1.0, 1.0), mass=2.0))
    session.advance()
    added = session.world.particle_slot("+.0")
    session.submit(AddSpring(3, added))
    session.advance()
    assert session.world.spring_names[-1] == "+:0"
    session.undo()
    session.undo()
    session.apply_pending()
    assert "+.0" not in session.world.particle_names
    session.submit(AddParticle((2.0, 1.0)))
    session.advance()
    assert session.world.particle_slot("+.0") == added


def test_every_kind_of_command_can_be_undone(session):
    start = None
    for command in (
        Pin(3), Unpin(0), CutSprings((2, 5)), SetCoefficients(0.2, 0.3, 1), SetGravity((1.0, 0.0)),
        SetSolver("single_pass", 5, 4, 0.1), AddParticle((0.0, 1.0)), AddSpring(1, 5, rest_length=2.0),
    ):  # fmt: skip
        session.apply_pending()
        start = state_hash(session.world)
        session.submit(command)
        session.apply_pending()
        assert state_hash(session.world) != start, command
        session.undo()
        session.apply_pending()
        assert state_hash(session.world) == start, command
    assert not session.messages


def test_seek_goes_back_and_forth_through_the_same_states(session):
    hashes = {}
    _advance(session, 5)
    hashes[5] = state_hash(session.world)
    _advance(session, 1)
    _drag(session, 6, 90)
    _advance(session, 100)
    last = session.tick
    hashes[last] = state_hash(session.world)
    for tick in (130, 17, last, 5, 60, 17, 0, 130):
        session.seek(tick)
        hashes.setdefault(tick, state_hash(session.world))
        assert state_hash(session.world) == hashes[tick]
        assert session.tick == tick
    session.seek(0)
    _advance(session, 17)
    assert state_hash(session.world) == hashes[17]
    _advance(session, last - 17)
    assert state_hash(session.world) == hashes[last]
    assert session.last_tick == last


def test_what_was_added_keeps_its_name_when_time_goes_back_and_forth(session):
    session.submit(AddParticle((1.0, 1.0)))
    session.submit(AddSpring(3, session.world.particle_count))
    _advance(session, 130)
    session.seek(0)
    session.seek(125)
    session.submit(Pin(session.world.particle_slot("+.0")))
    session.submit(CutSprings((session.world.spring_slot("+:0"),)))
    session.submit(AddParticle((2.0, 1.0)))
    session.apply_pending()
    assert not session.messages
    assert session.world.particle_names[-1] == "+.1"


def test_redo_belongs_to_the_end_of_the_run(session):
    _advance(session, 130)
    session.submit(Pin(3))
    _advance(session, 20)
    session.undo()
    session.apply_pending()
    session.seek(10)
    assert not session.can_redo
    session.redo()
    session.apply_pending()
    assert session.refusals == ["redo works at the end of the run: go to tick 150 first"]
    assert session.tick == 10
    session.seek(150)
    session.redo()
    session.apply_pending()
    assert session.world.inverse_mass[3] == 0.0


def test_undo_takes_the_gesture_that_began_last_whatever_its_number(session):
    session.submit(Pin(3), gesture=2**40)
    session.submit(Pin(4), gesture=7)
    session.undo()
    session.apply_pending()
    assert session.world.inverse_mass[3] == 0.0 < session.world.inverse_mass[4]


def test_seek_refuses_ticks_that_were_never_reached(session):
    _advance(session, 5)
    for tick in (-1, 6):
        with pytest.raises(ValueError, match=r"outside 0\.\.5"):
            session.seek(tick)


def test_a_command_in_the_past_starts_a_new_future(session):
    _drag(session, 6, 30)
    _advance(session, 60)
    session.seek(10)
    session.submit(Pin(4))
    session.advance()
    assert session.last_tick == 11
    assert session.can_undo
    session.undo()
    session.apply_pending()
    assert session.world.inverse_mass[4] > 0.0


def test_names_stand_for_slots_in_every_command_that_has_some():
    named, slots = Session(rope_level()), Session(rope_level())
    for session, particle, springs in ((named, "rope.7", ("rope:2", 3)), (slots, 7, (2, 3))):
        session.submit(Pin(particle))
        session.submit(CutSprings(springs))
        advance(session, 5)
        session.do(Grab(0, "rope.end" if session is named else session.world.particle_slot("rope.end"), (1.0, 1.0)))
        advance(session, 5)
        assert not session.messages
    assert state_hash(named.world) == state_hash(slots.world)
    assert [entry.command for entry in named.history.log] == [entry.command for entry in slots.history.log]


def test_do_applies_at_once_by_command_record_or_type_and_returns_what_was_done():
    session = Session(rope_level())
    session.submit(Pin(5))
    assert session.do("pin", particle="rope.6") == Pin(6)
    assert session.do({"type": "unpin", "particle": "rope.5"}) == Unpin(5)
    assert session.do("grab", grab=0, particle="rope.7", target=session.world.position[7]).particle == 7
    assert session.do(Release(0), 9) == Release(0)
    assert session.world.inverse_mass[5] > 0.0 == session.world.inverse_mass[6]
    session.undo()
    session.apply_pending()
    assert not session.messages


@pytest.mark.parametrize(
    ("given", "fields", "message"),
    [
        (Pin("rpoe.3"), {}, 'there is no particle "rpoe.3"; did you mean "rope.3"?'),
        ("pin", {"particle": "rpoe.3"}, 'there is no particle "rpoe.3"; did you mean "rope.3"?'),
        ("pin", {"particle": "rope.3", "at": 1}, "pin: at: there is no such field"),
        ("grab", {"grab": 0, "particle": "rope.3", "target": object()}, "grab: object is no value of a command"),
        (SetDrive("nobody", 1.0), {}, 'there is no driven part "nobody"'),
        ({"type": 3}, {}, "a command is an object with its type in quotes"),
    ],
)
def test_do_raises_at_once_what_submit_leaves_as_a_refusal(given, fields, message):
    session = Session(rope_level())
    before = state_hash(session.world)
    with pytest.raises(CommandError) as refused:
        session.do(given, **fields)
    assert str(refused.value) == message and not session.messages
    assert state_hash(session.world) == before and not session.can_undo


def test_what_is_no_command_or_no_level_is_refused_where_it_is_given():
    session = Session(rope_level())
    with pytest.raises(TypeError, match=r"submit takes a command, such as Grab\(...\), not 'grab'"):
        session.submit("grab")
    with pytest.raises(TypeError, match="a Session is of a Level, not of 'rope'; load_level reads"):
        Session("rope")


def test_refusals_and_events_are_told_apart():
    session = Session(busy_level())
    session.submit(Pin(10**6))
    advance(session, 240)
    assert session.refusals == ["there is no particle 1000000"]
    assert session.events and all(line.endswith(" broke") for line in session.events)
    assert session.messages == (*session.refusals, *session.events)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (Grab(0, 99, (0.0, 0.0)), "there is no particle 99"),
        (Grab(0, 0, (0.0, 0.0)), "rope.0 is pinned: unpin it to drag it"),
        (Grab(10, 3, (0.0, 0.0)), "grab: must be less than 10"),
        (Grab(0, 3, (float("nan"), 0.0)), "target.0: must be a finite number"),
        (Grab(0, 3, (2e6, 0.0)), "target.0: must be less than or equal to 1000000"),
        (Grab(0, "rpoe.3", (0.0, 0.0)), 'there is no particle "rpoe.3"; did you mean "rope.3"?'),
        (Grab(0, 3.0, (0.0, 0.0)), "particle: must be a valid integer"),
        (Grab(0, 3, (0.0, 0.0), 0.0), "strength: must be greater than 0"),
        (Grab(0, 3, (0.0, 0.0), 1e7), "strength: must be less than or equal to 1000000"),
        (Grab(0, 3, (0.0, 0.0), 30.0, -1.0), "radius: must be greater than or equal to 0"),
        (MoveGrab(0, (0.0, 0.0)), "hand 0 holds nothing"),
        (Release(1), "hand 1 holds nothing"),
        (Pin(0), "rope.0 is pinned already"),
        (Unpin(3), "rope.3 is not pinned"),
        (CutSprings((0, 500)), "there is no spring 500"),
        (AddSpring(3, 3), "a spring joins two different particles, not rope.3 to itself"),
        (SetCoefficients(1.5), "stiffness: must be less than or equal to 1"),
        (SetCoefficients(0.5, None, 9), "there is no material 9"),
        (SetSolver("magic"), "solver: must be 'single_pass', 'iterative' or 'direct'"),
        (SetSolver(substeps=3), "substeps: must be 1, 2, 4, 8, 16, 32, 64 or 'auto'"),
        (SetGravity((float("inf"), 0.0)), "gravity.0: must be a finite number"),
    ],
)
def test_a_command_that_cannot_be_carried_out_is_dropped_with_one_line(session, command, message):
    before = state_hash(session.world)
    session.submit(command)
    session.apply_pending()
    assert len(session.messages) == 1
    assert message in session.messages[0]
    assert "\n" not in session.messages[0]
    assert state_hash(session.world) == before
    assert not session.can_undo


def test_hands_cannot_be_grabbed_pinned_or_cut(session):
    world = session.world
    session.submit(Grab(0, 6, (3.0, 1.0)))
    session.submit(Grab(1, world.grab_particle, (3.0, 1.0)))
    session.submit(Pin(world.grab_particle))
    session.submit(CutSprings((world.grab_spring,)))
    session.apply_pending()
    assert len(session.messages) == 3


def test_keyframes_are_thinned_within_their_budget_and_undo_still_works(session, monkeypatch):
    monkeypatch.setattr("sandbox.session.run_history.KEYFRAME_BUDGET", 40_000)
    session.submit(Pin(3))
    _advance(session, 1500)
    assert len(session.history.keyframes) < 15
    session.undo()
    session.apply_pending()
    plain = Session(rope_level())
    _advance(plain, 1500)
    assert state_hash(session.world) == state_hash(plain.world)


def test_long_re_stepping_reports_its_progress(session):
    seen = []
    session.submit(Pin(3))
    _advance(session, 30)
    session.progress = lambda done, total: seen.append((done, total))
    session.undo()
    session.apply_pending()
    # A few ticks may take seconds: they are reported too.
    assert len(seen) >= 5 and all(0 < done <= total == 30 for done, total in seen)


def _all_of(session):
    """All of a run that somebody can come across."""
    log = [(entry.tick, entry.gesture, entry.command, entry.in_effect, entry.implied) for entry in session.history.log]
    kept = [(kept.order, kept.tick) for kept in session.history.keyframes]
    ends = session.tick, session.last_tick, session.can_undo, session.can_redo, session.branches, session.breaks
    return state_hash(session.world), log, session.gestures, kept, ends


def _interrupt(done, total):
    raise Interrupted


def _played_to_and_fro():
    """A run with something cut that something later needed, an undone gesture, and a branch."""
    session = Session(rope_level())
    session.submit(Pin(3))
    _advance(session, 70)
    _drag(session, 6)
    session.submit(CutSprings((2,)))
    _advance(session, 70)
    session.seek(100)
    session.submit(Pin(5))
    _advance(session, 70)
    session.undo()
    _advance(session, 1)
    return session


@pytest.mark.parametrize("deed", ["undo", "redo", "seek", "return", "save"])
def test_what_is_given_up_while_ticks_are_stepped_again_changes_nothing(deed, tmp_path):
    session = _played_to_and_fro()
    session.history.reached = ReachedStates()

    def do():
        if deed in ("undo", "redo"):
            session.submit(Undo() if deed == "undo" else Redo())
            session.apply_pending()
        elif deed == "seek":
            session.seek(30)
        elif deed == "return":
            session.return_to(session.branches[0])
        else:
            session.save_to(tmp_path / "run.replay.jsonl")

    before = _all_of(session)
    session.progress = _interrupt
    with pytest.raises(Interrupted):
        do()
    assert _all_of(session) == before and not list(tmp_path.iterdir())
    session.progress = None
    do()
    assert (_all_of(session) != before) is (deed != "save")


def test_a_script_ends_with_an_undoing_that_is_given_up(tmp_path):
    recorded = Session(rope_level())
    recorded.record_to(tmp_path / "run.replay.jsonl")
    recorded.submit(Pin(3))
    _advance(recorded, 30)
    recorded.undo()
    _advance(recorded, 30)
    recorded.stop_recording()
    session = Session(rope_level(), script=read_replay(tmp_path / "run.replay.jsonl").script)
    session.progress = _interrupt
    with pytest.raises(Interrupted):
        _advance(session, 60)
    assert session.tick == 30 and session.can_undo and session.history.scripted is None
    _advance(session, 5)
    assert session.tick == 35


def test_undo_steps_from_where_the_gesture_began_and_undoing_to_and_fro_steps_nothing(session, monkeypatch):
    steps = []
    monkeypatch.setattr("sandbox.session.session.step", lambda world: steps.append(world.tick) or step(world))
    _advance(session, 50)
    _drag(session, 6)
    session.advance()
    hashes = [state_hash(session.world)]
    steps.clear()
    session.undo()
    session.apply_pending()
    assert steps == list(range(50, 71))
    hashes.append(state_hash(session.world))
    for turn in range(6):
        (session.undo if turn % 2 else session.redo)()
        session.apply_pending()
        assert state_hash(session.world) == hashes[turn % 2]
    assert len(steps) == 21


def test_what_redo_comes_back_to_has_the_breaks_and_the_effects_that_it_had(session):
    session.submit(AddParticle((1.0, 1.0)))
    session.advance()
    session.submit(Pin(session.world.particle_slot("+.0")), gesture=99)
    session.submit(Pin(3), gesture=99)
    _advance(session, 3)
    for _ in range(2):
        session.undo()
    for _ in range(2):
        session.redo()
    session.apply_pending()
    assert session.world.particle_names[-1] == "+.0"
    assert session.world.inverse_mass[[3, -1]].tolist() == [0.0, 0.0]
    session.undo()
    session.apply_pending()
    assert (session.world.inverse_mass[[3, -1]] > 0.0).all()
    session.redo()
    _advance(session, 2)
    session.redo()
    session.apply_pending()
    assert session.refusals == ["nothing to redo"]
    assert session.world.inverse_mass[[3, -1]].tolist() == [0.0, 0.0]


def test_a_session_its_world_and_a_snapshot_say_what_they_are_in_a_line(tmp_path):
    session = Session(rope_level())
    hand, sizes = (
        Grab(0, 3, (1.0, 1.0)),
        f"{session.world.grab_particle} particles, {session.world.grab_spring} springs",
    )
    assert repr(session) == "<Session of 'A rope' at tick 0: 0 gestures>".replace("A rope", session.level.name)
    session.submit(hand)
    session.advance()
    assert repr(session.world) == f"<LevelWorld at tick 1: {sizes}>"
    assert repr(session.snapshot()) == f"<Snapshot at tick 1: {sizes}>"
    session.seek(0)
    assert "at tick 0 of 1: 1 gesture>" in repr(session)
    session.record_to(tmp_path / "run.replay.gz")
    assert repr(session).endswith("run.replay.gz>")
    session.abandon_recording()


def test_a_snapshot_of_another_level_is_refused():
    other = Session(load_level("newtons_cradle")).snapshot()
    with pytest.raises(ValueError, match="start: the snapshot is of another level than 'Test rope'"):
        Session(rope_level(), start=other)
