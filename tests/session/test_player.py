"""Pages that play runs: what they hold."""

import base64
import json
import re

import numpy as np

from sandbox.level.reading.files import load_level
from sandbox.session.commands import AddParticle, CutSprings
from sandbox.session.compare.comparison import compare
from sandbox.session.player.page import (
    NOWHERE,
    STEPS,
    PlaybackData,
    PlayerPage,
    event_lines,
    report_page,
    shown_box,
    steps_between,
    watches_of,
)
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.player_page import TICKS, rope_page
from tests.support.rope_level import rope_level


def data_of(page: PlayerPage) -> dict:
    (data,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page.text(), re.DOTALL)
    return json.loads(data)


def test_a_page_holds_every_picture_of_both_runs_where_they_are():
    data = data_of(rope_page())
    assert data["ticks"] == [*range(0, 13, 3), 13, *range(15, TICKS + 1, 3)]
    expected, actual = data["sides"]
    assert [len(form["lines"]) for form in expected["forms"]] == [15]
    assert [(form["from"], len(form["lines"])) for form in actual["forms"]] == [(0, 15), (5, 14)]
    run = Session(rope_level())
    left, bottom, right, top = data["box"]
    span = max(right - left, top - bottom)
    places = np.frombuffer(base64.b64decode(expected["frames"]), dtype="<u2").reshape(len(data["ticks"]), -1, 2)
    for place, tick in enumerate(data["ticks"]):
        while run.tick < tick:
            run.advance()
        at = places[place] * (span / STEPS) + (left - span, bottom - span)
        shown = slice(0, run.world.grab_particle)
        assert np.abs(at[shown] - run.world.position[shown]).max() <= 0.51 * span / STEPS


def test_what_is_far_away_or_no_number_is_nowhere_and_what_joins_is_there():
    level = rope_level()
    run = Session(level)
    reel = PlaybackData("run", level, shown_box(level, run.world))
    reel.add(run.world)
    run.submit(AddParticle((1.0, 1.0)))
    run.advance()
    run.world.position[3] = np.nan
    run.world.position[4] = 1e9
    reel.add(run.world)
    places = np.frombuffer(base64.b64decode(reel.data()["frames"]), dtype="<u2").reshape(-1, 2)
    second = places[reel.data()["sizes"][0] :]
    assert (second[3:5] == NOWHERE).all() and (second[5] != NOWHERE).all()
    assert [disc[4] for disc in reel.data()["forms"][1]["discs"]].count(1) == 1


def test_a_page_of_a_long_run_has_fewer_pictures():
    assert steps_between(600, 100, 2) == 1
    assert steps_between(36_000, 1_000, 2) * 6_000_000 >= 36_000 * 1_000 * 8


def test_no_name_of_a_level_can_become_part_of_the_page():
    text = rope_page("</title><script>alert(1)</script>@DATA@", ["</script><script>alert(2)</script>"]).text()
    assert "<script>alert" not in text and text.count("@DATA@") == 2
    assert not re.search(r"https?://|<img|\bsrc=|<link(?! rel=\"icon\" href=\"data:,\")", text)


def test_a_report_lists_what_happened_when_and_says_what_did_in_one_run_alone(tmp_path):
    level = load_level("truck_bridge")
    run = Session(level)
    run.record_to(tmp_path / "run.replay.gz")
    for _ in range(180):
        run.advance()
    run.stop_recording()
    stronger = level.model_copy(update={"settings": level.settings.model_copy(update={"gravity": (0.0, -9.0)})})
    found = compare(read_replay(tmp_path / "run.replay.gz"), level=stronger)
    page = report_page(found)
    told = data_of(page)["happened"]
    assert [line[0] for line in told] == sorted(line[0] for line in told)
    broke = [line for line in told if "broke" in line[1]]
    assert broke and {line[2] for line in broke} <= {0, 1} and all("deck" in line[1] for line in broke)
    runs = [Session(level), Session(stronger)]
    for side, each in enumerate(runs):
        while each.tick < 180:
            each.advance()
        happened = bool(each.breaks)
        assert happened == any(line[2] in (side, None) for line in broke)


def test_lines_that_two_runs_share_are_said_once():
    level = rope_level()
    runs = [Session(level), Session(level)]
    watches = watches_of(runs)
    for run in runs:
        run.submit(CutSprings((3,)))
        run.advance()
    runs[1].submit(CutSprings((5,)))
    runs[1].advance()
    assert [(line.tick, line.side) for line in event_lines(runs, watches)] == [(0, None), (1, 1)]
