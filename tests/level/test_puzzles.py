"""Shipped levels that ask something: what each teaches, what it says of what went wrong, and what it waits for."""

import json

import numpy as np
import pytest

from sandbox.level.reading.files import level_path, load_level
from sandbox.level.reading.parse import parse_level
from sandbox.physics.jit import COMPILED
from sandbox.session.outcome import outcome
from sandbox.session.session import Session
from tests.solutions import ahead, drag, drive, firmness, material, play, press

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")


def played(level, *gestures, seconds=30.0):
    """The run of a level by gestures."""
    session = Session(load_level(level) if isinstance(level, str) else level)
    play(session, list(gestures), seconds)
    return session


def ended(session):
    """Whether a run is won, and its words; None: neither won nor lost."""
    found = outcome(session.level, session.world)
    return None if found is None else (found.is_won, found.text)


def place(session, name):
    return session.world.position[session.world.particle_slot(name)].tolist()


@pytest.mark.parametrize(("level", "middle"), [("low_door", -9.5), ("truck_course", -12.0)])
def test_a_truck_on_its_back_is_lost_in_words_that_say_what_to_do(level, middle):
    data = json.loads(level_path(level).read_bytes())
    data["bodies"] = [body for body in data["bodies"] if not body["id"].startswith("crate")]
    data["rules"] = [rule for rule in data["rules"] if rule["id"] == "on its back"]
    data["checks"] = []
    for body in data["bodies"]:
        if body["id"] == "truck":
            body["particles"] = [[2 * middle - x, 2.8 - y] for x, y in body["particles"]]
        elif body["id"].endswith("wheel"):
            body["position"] = [2 * middle - body["position"][0], 2.8 - body["position"][1]]
    session = played(parse_level(json.dumps(data).encode(), level), *ahead((0.5, 4.0)), seconds=5.0)
    is_won, text = ended(session)
    assert not is_won and text.startswith("The truck is on its back. Undo")


def test_under_the_low_door_the_bridge_is_to_give_way_and_not_the_truck():
    for name in ("shock", "steel"):
        session = played("low_door", material(1.0, name, stiffness=0.1, damping=0.0), *ahead((3.0, 14.0)), seconds=15.0)
        assert ended(session) is None or not ended(session)[0]
    won = [ended(played("low_door", material(1.0, "deck", stiffness=cs), *ahead((3.0, 14.0)))) for cs in (0.15, 0.25)]
    assert all(found is not None and found[0] for found in won)


def test_a_soft_ball_stays_below_the_gap_and_whatever_is_firm_rolls_into_the_cup():
    soft = [(3.0, {"type": "set_firmness", "body": "ball", "sag": 0.25, "duration": 75})]
    assert ended(played("squeeze", soft, seconds=40.0)) is None
    for sag in (0.02, 0.003, 0.0):
        again = [(15.0, {"type": "set_firmness", "body": "ball", "sag": sag, "duration": 75})]
        assert ended(played("squeeze", soft, again, seconds=40.0))[0], sag
    assert ended(played("squeeze", firmness(3.0, "ball", 5.69), seconds=20.0)) is None


def test_the_winch_stops_at_both_ends_and_its_hook_does_not_crumple_the_load():
    up, down = (played("crane", drive(":1", value, 1.0, 12.0), seconds=12.0) for value in (-1.0, 1.0))
    for session in (up, down):
        names = session.world.particle_names
        load = session.world.position[[slot for slot, name in enumerate(names) if name.startswith("load.")]]
        assert np.ptp(load, axis=0) == pytest.approx([1.2, 1.2], abs=0.15)
        assert place(session, "hook")[1] > load[:, 1].max()
    assert place(up, "boom.end")[1] - place(up, "hook")[1] == pytest.approx(3.0, abs=0.1)


def test_the_first_crate_and_the_first_ball_wait_for_the_first_key():
    for level, name, key in (("sorting_belt", "red 1.4", "d"), ("pinball_score", "ball", "a")):
        waiting, begun = played(level, seconds=20.0), played(level, press(key, 1.0, 1.2), seconds=2.5)
        before = place(Session(load_level(level)), name)
        assert place(waiting, name) == pytest.approx(before, abs=0.05)
        assert place(begun, name) != pytest.approx(before, abs=0.5)


def test_a_game_of_pinball_has_three_balls_and_says_how_many_points_are_missing():
    session = played("pinball_score", press("a", 0.5, 0.6), seconds=60.0)
    score, balls = session.world.counter.tolist()
    is_won, text = ended(session)
    assert balls == 0.0 and score < 1200.0
    assert not is_won and "points were missing" in text


def test_the_bed_throws_the_ball_into_the_basket_for_a_wide_range_of_stiffness():
    won = 0
    for stiffness in np.arange(0.05, 1.0, 0.05).tolist():
        session = played(
            "trampoline_basket", material(1.0, "bed", stiffness=stiffness), press("d", 3.0, 3.2), seconds=12.0
        )
        won += ended(session) is not None
    assert won >= 6


def test_what_a_hand_carries_over_the_wall_does_not_count_until_it_is_thrown():
    carried = drag("ball", (1.0, -5.0, 0.4), (2.0, -1.0, 7.0), (2.3, 4.0, 7.0), (3.0, 6.2, 5.0), (5.0, 6.2, 2.6))
    session = played("basket_throw", carried, seconds=12.0)
    x, y = place(session, "ball")
    assert ended(session) is None and 5.1 < x < 7.4 and y < 3.1
    assert session.world.rule_first[[rule.id for rule in session.level.rules].index("carried")] > 0


def test_a_crate_that_a_hand_carries_over_the_river_is_lost_however_low():
    low = drag("crate 3.4", (1.0, -6.6, 1.05), (2.0, -6.6, 2.4), (5.0, 8.0, 2.4), (6.0, 8.0, 1.2))
    assert ended(played("ferry", low)) == (False, "Crates do not fly over the river: each lies in the boat.")


def test_a_marble_that_a_hand_brings_to_the_dominoes_is_lost():
    brought = drag("marble", (1.0, -8.85, 6.15), (2.0, -8.0, 7.0), (4.0, -2.0, 7.0), (5.0, -2.2, 5.0))
    is_won, text = ended(played("chain_of_events", brought))
    assert not is_won and text.startswith("The hand brought the marble.")
