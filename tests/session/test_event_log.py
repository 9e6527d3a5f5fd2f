"""What happened when: every kind of event, by name and tick; bounded, and true after undo and time travel."""

import json

import pytest

from sandbox import Session, load_level
from sandbox.bodies import parse_level
from sandbox.cli import main
from sandbox.commands import CutSprings, Grab, Pin, Release, Unpin, from_record
from sandbox.session import event_log
from sandbox.session.event_log import (
    KINDS,
    Event,
    TouchWatch,
    event_log_of,
    events_of,
    grouped,
    shortened,
    watched_event_log,
)

GROUND = {"id": "ground", "polygon": [[-5, -1], [5, -1], [5, 0], [-5, 0]]}
BALL = {"id": "ball", "position": [0, 1.0], "radius": 0.2, "mass": 2.0}


def level_of(**parts):
    data = {"format": "spring-sandbox/level", "version": 3, "name": "Things", "terrain": [GROUND]} | parts
    return parse_level(json.dumps(data).encode(), "things")


def lines_of(found, kinds=None):
    return [(each.tick, each.text) for each in found if kinds is None or each.kind in kinds]


def test_who_touched_whom_is_told_once_with_how_often_and_when_they_parted():
    run = Session(level_of(particles=[BALL | {"restitution": 0.9}]))
    watched = TouchWatch(())
    (told,) = watched_event_log(run, 400, watch=watched)
    times = watched.touches["ball", "ground"].times
    assert times > 2 and told.text == f"ball and ground touched ({times} times in all)"
    assert told.tick == pytest.approx((2 * 0.8 / 9.81) ** 0.5 * 60, abs=2)
    run.world.change("velocity", [0.0, 9.0], 0)
    told = watched_event_log(run, 430, watch=watched)
    assert lines_of(told, ["part"]) == [(400, "ball and ground parted")] or told[-1].text == "ball and ground parted"


def test_hands_pins_and_cuts_are_told_by_name_and_what_was_undone_never_happened():
    rope = {"id": "rope", "type": "rope", "start": [-3, 4], "end": [3, 4], "segments": 10, "pinned": [0, 10]}
    run = Session(level_of(bodies=[rope]))
    slot, gesture = run.world.particle_slot("rope.5"), run.new_gesture()
    run.submit(Grab(0, slot, (0.0, 3.0)), gesture)
    for _ in range(30):
        run.advance()
    run.submit(Release(0), gesture)
    run.submit(Pin(slot))
    run.advance()
    run.submit(Unpin(slot))
    run.submit(CutSprings((2,)))
    run.submit(CutSprings((7, 8)))
    run.advance()
    assert lines_of(events_of(run)) == [
        (0, "rope.5 was grabbed"), (30, "rope.5 was let go"), (30, "rope.5 was pinned"), (31, "rope.5 was unpinned"),
        (31, "rope:2 was cut"), (31, "2 springs of rope were cut"),
    ]  # fmt: skip
    run.undo()
    run.advance()
    assert lines_of(events_of(run))[-1] == (31, "rope:2 was cut")
    run.seek(20)
    assert lines_of(events_of(run)) == [(0, "rope.5 was grabbed")]


def test_breaks_stay_known_after_time_travel_and_many_share_a_line():
    run = Session(load_level("truck_bridge"))
    while not run.breaks:
        run.advance()
    first = run.tick
    for _ in range(120):
        run.advance()
    told = events_of(run)
    assert told[0].tick == first and {each.kind for each in told} == {"break"} and len(told) > 10
    (line,) = event_log_of(run)
    assert line.text == f"{len(told)} springs of deck broke" and (line.tick, line.last) == (first, told[-1].tick)
    run.seek(first - 1)
    assert events_of(run) == []
    while run.tick < told[-1].tick:
        run.advance()
    assert events_of(run) == told


def test_counting_zones_checkpoints_and_winning_are_told():
    zone = {"id": "basket", "box": [-1, 0, 1, 0.7]}
    inside = {"metric": "inside", "particle": "ball", "zone": "basket"}
    level = level_of(
        particles=[BALL], zones=[zone], counters=[{"id": "score"}],
        rules=[
            {"id": "in", "when": inside, "then": [{"count": "score", "by": 2}, {"checkpoint": True}]},
            {"id": "done", "when": {"counter": "score", "at_least": 2}, "then": [{"win": "Well done"}]},
            {"id": "late", "when": {"time": 1.0}, "then": [{"fail": "Too late"}, {"say": "Over"}]},
        ],
    )  # fmt: skip
    run = Session(level)
    told = watched_event_log(run, 90)
    entered = run.world.rule_first[0]
    assert lines_of(told, ["enter", "count", "checkpoint", "win", "lose", "rule"]) == [
        (entered, "ball entered basket"), (entered, "score is 2"), (entered, "checkpoint (in)"),
        (entered + 1, "won: Well done"), (60, "rule late: say Over"),
    ]  # fmt: skip


def test_what_the_quarantine_froze_is_told_by_name():
    run = Session(level_of(particles=[BALL]))
    run.world.velocity[0] = float("nan")
    run.advance()
    assert lines_of(events_of(run)) == [(1, "ball went out of bounds and was frozen")]


@pytest.mark.parametrize(
    "record",
    [
        {"type": "set_gravity", "gravity": [0.0, -3.0]},
        {"type": "set_firmness", "body": "cube 1", "sag": 0.2},
        {"type": "push", "position": [0, 1], "radius": 2, "impulse": [0, 30]},
        {"type": "remove", "body": "cube 1"},
        {"type": "add_particle", "position": [0, 9]},
        {"type": "move_body", "particle": "cube 1.0", "by": [0, 0.5]},
        {"type": "set_solver", "iterations": 5},
    ],
)
def test_every_other_command_is_a_line_of_plain_words(record):
    run = Session(load_level("jelly_pile"))
    run.submit(from_record(record, run.world))
    run.advance()
    (told,) = events_of(run)
    assert "_" not in told.text and told.kind == record["type"]


def test_many_alike_are_joined_and_other_lines_are_never_dropped():
    touches = [Event(tick, tick, "touch", (f"ball {tick}", "pit"), f"ball {tick} and pit touched") for tick in range(9)]
    far = Event(600, 600, "touch", ("ball 1", "wall"), "ball 1 and wall touched")
    broke = [Event(5, 5, "break", ("deck",), "deck:1 broke")]
    told = grouped([*touches, far, *broke], 60)
    assert [each.text for each in told] == [
        "pit began to touch 9 things: ball 0, ball 1, ball 2 and 6 more", "deck:1 broke", "ball 1 and wall touched"
    ]  # fmt: skip
    assert (
        told[0].line(60) == "    0.00 s  pit began to touch 9 things: ball 0, ball 1, ball 2 and 6 more, until 0.13 s"
    )
    short, dropped = shortened([*touches, *broke], 4)
    assert (len(short), dropped) == (4, 6) and broke[0] in short
    assert shortened(broke * 3, 1) == (broke * 3, 0)


def test_memory_is_bounded_by_pairs(monkeypatch):
    monkeypatch.setattr(event_log, "MOST_PAIRS", 5)
    run = Session(load_level("jelly_pile"))
    watch = TouchWatch(())
    told = watched_event_log(run, 240, watch=watch)
    assert len(watch.touches) == 5 and watch.unlisted > 0
    assert told[-1].kind == "unlisted" and "not listed" in told[-1].text


def test_info_tells_of_a_recording_its_header_and_what_happened(tmp_path, capsys):
    path, run = tmp_path / "run.replay.gz", Session(level_of(particles=[BALL]))
    run.record_to(path)
    run.submit(Grab(0, 0, (0.0, 2.0)))
    for _ in range(120):
        run.advance()
    run.submit(Release(0))
    for _ in range(120):
        run.advance()
    run.stop_recording()
    assert main(["info", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[:5] == [
        str(path), "level       Things", "solver      direct, 60 ticks a second, 1 substep",
        "length      240 ticks, 4.00 s", "commands    1 grab, 1 release",
    ]  # fmt: skip
    assert [line[12:].partition(" (")[0] for line in lines[6:]] == [
        "ball was grabbed", "ball was let go", "ball and ground touched"
    ]  # fmt: skip
    assert main(["info", "--json", "--seconds", "1", str(path)]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["equal"] is True and data["ticks"] == 60 and data["commands"] == {"grab": 1, "release": 1}
    assert [(each["kind"], each["names"], each["seconds"]) for each in data["happened"]] == [("grab", ["ball"], 0.0)]


def test_info_tells_of_a_recording_that_is_cut_off_or_steps_differently_and_says_so(tmp_path, capsys):
    path, run = tmp_path / "run.replay.jsonl", Session(level_of(particles=[BALL]))
    run.record_to(path)
    for _ in range(60):
        run.advance()
    run.abandon_recording()
    assert main(["info", str(path)]) == 0
    assert "length      60 ticks, 1.00 s, where the file is cut off\n" in capsys.readouterr().out
    run.record_to(path)
    run.world.velocity[0] += 1.0
    for _ in range(60):
        run.advance()
    run.stop_recording()
    assert main(["info", str(path)]) == 0
    assert "steps it differently" in capsys.readouterr().out


def test_info_of_a_level_runs_it_and_of_what_is_neither_says_so(tmp_path, capsys):
    assert main(["info", "truck_bridge", "--seconds", "4"]) == 0
    told = capsys.readouterr().out
    assert "springs of deck broke, until" in told and "commands" not in told
    assert main(["info", str(tmp_path / "nothing.replay.gz")]) == 2
    assert "nothing.replay.gz" in capsys.readouterr().err


def test_every_kind_is_named():
    run = Session(load_level("truck_bridge"))
    assert {each.kind for each in watched_event_log(run, 300)} <= set(KINDS)
