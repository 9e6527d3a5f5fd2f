"""What a level promises of its own run: each metric at a time, always and eventually."""

import json
from typing import get_args

import pytest

from sandbox.level.checks import METRICS, CheckDef, HoldDef, Metric, judge, promise_text, value_text
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import parse_level
from sandbox.session.check_run import HeldKeys, checks_as_they_end, run_checks
from sandbox.session.checking import check_level
from sandbox.session.session import Session
from sandbox.session.sweep.grid import SweepRequest
from sandbox.session.sweep.running import run_case

# A ball falls 4 m onto the ground in 0.9 s; a rope of two springs hangs beside it, of which the lower one is slack.
LEVEL = {
    "format": "spring-sandbox/level", "version": 3, "name": "Drop", "settings": {"solver": "iterative"},
    "contacts": {"restitution": 0.0, "friction": 0.5},
    "terrain": [{"id": "ground", "polygon": [[-9, -2], [9, -2], [9, 0], [-9, 0]]}],
    "bodies": [
        {"type": "rope", "id": "rope", "start": [4, 6], "end": [4, 4], "segments": 4, "pin": ["start"],
         "material": "line"},
    ],
    "materials": {"line": {"stiffness": 0.4, "damping": 0.6}},
    "particles": [{"id": "ball", "position": [0, 4.1], "radius": 0.1, "mass": 2.0}],
}  # fmt: skip


def level(*checks, **changes):
    named = [{"name": f"c{k}", **each} for k, each in enumerate(checks)]
    return parse_level(json.dumps({**LEVEL, **changes, "checks": named}).encode(), "drop.json")


def results(*checks, **changes):
    return run_checks(level(*checks, **changes))


def test_always_fails_at_the_worst_tick_and_eventually_holds_at_the_first():
    always, eventually, never, once = results(
        {"metric": "y", "particle": "ball", "always": [0, 0.5], "at_least": 3.5},
        {"metric": "y", "particle": "ball", "eventually": [0, 2], "at_most": 2.0},
        {"metric": "y", "particle": "ball", "eventually": [0, 0.25], "at_most": 2.0},
        {"metric": "y", "particle": "ball", "after": 0.5, "at_least": 3.5},
    )
    assert (always.passed, always.at, eventually.passed, never.passed) == (False, 0.5, True, False)
    assert always.value == once.value == pytest.approx(4.1 - 0.5 * 9.81 * 0.25, abs=0.05)
    assert eventually.value <= 2.0 and eventually.at == pytest.approx((2 * 2.1 / 9.81) ** 0.5, abs=0.02)
    assert never.at == 0.25 and "eventually from 0 to 0.25 s is at best" in never.text
    assert always.text.startswith("c0: FAILS: y of ball always from 0 to 0.5 s is at worst")


def test_what_checks_promise_is_said_as_sentences():
    said = {
        "every place and speed is a number": {"metric": "non_finite", "at_most": 0},
        "at most 2 particles have no place or speed": {"metric": "non_finite", "at_most": 2},
        "no spring of rope breaks": {"metric": "broken_springs", "at_most": 0, "body": "rope"},
        "at least 3 springs break": {"metric": "broken_springs", "at_least": 3},
        "ball is inside the box": {"metric": "inside", "particle": "ball", "box": [0, 0, 1, 1]},
        "everything stands still for at least 1 s": {"metric": "settled"},
        "y of ball is at least -1 and at most 2.5 m":
            {"metric": "y", "particle": "ball", "at_least": -1, "at_most": 2.5},
        "the distance from ball to rope.end is at most 4 m":
            {"metric": "distance", "particle": "ball", "other": "rope.end", "at_most": 4},
        "the largest strain of the last 2 s is at most 0.5": {"metric": "max_strain", "at_most": 0.5},
    }  # fmt: skip
    assert [promise_text(check) for check in level(*said.values()).checks] == list(said)
    assert set(METRICS) == set(get_args(Metric))


def test_a_ball_lands_inside_a_box_settles_and_its_energy_falls():
    landed, outside, settled, restless, least, most = results(
        {"metric": "inside", "particle": "ball", "box": [-1, 0, 1, 1], "eventually": [0, 2]},
        {"metric": "inside", "particle": "ball", "box": [-1, 0, 1, 1], "always": [0, 2]},
        {"metric": "settled", "eventually": [0, 3], "at_least": 0.5, "body": "rope"},
        {"metric": "settled", "after": 0.5},
        {"metric": "energy", "always": [1.5, 2.0], "at_most": 200.0},
        {"metric": "energy", "after": 0.0, "at_least": 2.0 * 9.81 * 4.1},
    )
    assert landed.passed and landed.value >= 0.0 and landed.at == pytest.approx((2 * 3.1 / 9.81) ** 0.5, abs=0.03)
    assert not outside.passed and outside.value == pytest.approx(-3.1)
    assert settled.passed and not restless.passed and "wanted at least 1" in restless.text
    assert least.passed and most.passed and most.value > least.value


def test_strain_and_breaks_are_measured_of_a_body_and_distance_between_two_particles():
    materials = {"line": {"stiffness": 0.4, "damping": 0.6, "tension_limit": 0.001}}
    whole, other, apart = results(
        {"metric": "strain", "body": "rope", "always": [0, 0.5], "at_most": 0.0},
        {"metric": "strain", "always": [0, 0.5], "at_most": 0.0},
        {"metric": "distance", "particle": "ball", "other": "rope.start", "after": 0.0, "at_most": 9.0},
    )
    assert whole.value == other.value > 0.0 and apart.value == pytest.approx((4.0**2 + 1.9**2) ** 0.5)
    broken, fine = results(
        {"metric": "broken_springs", "body": "rope", "eventually": [0, 2], "at_least": 1.0},
        {"metric": "broken_springs", "eventually": [0, 2], "at_least": 5.0},
        materials=materials,
    )
    assert broken.passed and not fine.passed


def test_results_come_as_soon_as_they_are_known_and_the_run_ends_with_the_last():
    found = list(
        checks_as_they_end(
            level(
                {"metric": "non_finite", "after": 1.0, "at_most": 0},
                {"metric": "y", "particle": "ball", "eventually": [0, 9], "at_most": 3.9},
            )
        )
    )
    assert [each[0] for each in found if each is not None] == [1, 0]
    assert sum(each is None for each in found) == 60


FAULTS = {
    "checks.0: needs a bound": {"metric": "energy"},
    '"distance" is measured of a second particle': {"metric": "distance", "particle": "ball", "at_most": 1},
    '"inside" is measured of a box': {"metric": "inside", "particle": "ball"},
    '"energy" is measured of the whole level; take the body out': {"metric": "energy", "body": "rope", "at_most": 1},
    '"speed" is measured of a particle or a body, name one': {"metric": "speed", "at_most": 1},
    '"distance" is measured of a particle; take the body out': {
        "metric": "distance", "particle": "ball", "other": "ball", "body": "rope", "at_most": 1},
    'nothing in the level has the key "d"': {
        "metric": "speed", "particle": "ball", "at_most": 1, "hold": [{"key": "d", "during": [0, 1]}]},
    'there is no body "ropes"; did you mean "rope"?': {"metric": "strain", "body": "ropes", "at_most": 1},
    'there is no body "ball"': {"metric": "strain", "body": "ball", "at_most": 1},
    "not both; make two": {"metric": "strain", "always": [0, 1], "eventually": [0, 1], "at_most": 1},
    "the earlier time comes first": {"metric": "strain", "always": [2, 1], "at_most": 1},
    'take "strain"': {"metric": "max_strain", "always": [0, 1], "at_most": 1},
    "left and bottom come first": {"metric": "inside", "particle": "ball", "box": [1, 0, -1, 1]},
    "a particle or a body, not both": {"metric": "inside", "particle": "ball", "body": "rope", "box": [0, 0, 1, 1]},
    "not a list": {"metric": "strain", "always": 5, "at_most": 1},
}  # fmt: skip


@pytest.mark.parametrize("words", FAULTS)
def test_a_check_that_makes_no_sense_is_refused_in_a_line(words):
    with pytest.raises(LevelError) as refused:
        level(FAULTS[words])
    assert len(refused.value.faults) == 1 and words in refused.value.faults[0], refused.value.faults


CAR = {
    "format": "spring-sandbox/level", "version": 3, "name": "Cart",
    "materials": {"steel": {"stiffness": 1.0, "damping": 1.0}}, "contacts": {"friction": 1.0},
    "terrain": [{"id": "ground", "polygon": [[-9, -2], [99, -2], [99, 0], [-9, 0]]}],
    "bodies": [
        {"type": "wheel", "id": side, "position": [x, 0.5], "radius": 0.5, "thickness": 0.2, "segments": 12,
         "material": "steel", "motor": {"speed": -6.0, "torque": 60.0, "key": "d", "reverse_key": "a"}}
        for side, x in (("rear", 0.0), ("front", 2.0))
    ],
    "springs": [{"a": "rear.hub", "b": "front.hub", "material": "steel"}],
}  # fmt: skip


def cart(*checks):
    named = [{"name": f"c{k}", **each} for k, each in enumerate(checks)]
    return parse_level(json.dumps({**CAR, "checks": named}).encode(), "cart.json")


def test_a_check_holds_keys_and_others_of_the_level_run_without():
    x = {"metric": "x", "body": "rear", "after": 3}
    drives, stays = run_checks(
        cart(
            {**x, "at_least": 0.9, "hold": [{"key": "d", "during": [0, 3]}]},
            {**x, "at_least": -0.1, "at_most": 0.1},
        )
    )
    assert drives.passed and stays.passed


def test_a_key_that_is_let_go_drives_no_more_and_the_one_pressed_last_counts():
    def driven(*hold):
        session, keys = Session(cart()), HeldKeys(cart(), [HoldDef(key=key, during=span) for key, span in hold])
        values = []
        for _ in range(180):
            keys.press(session)
            session.advance()
            values.append(float(session.world.actuator_value[0]))
        return values

    assert driven(("d", (1.0, 2.0))) == [0.0] * 60 + [1.0] * 60 + [0.0] * 60
    assert driven(("d", (0.0, 3.0)), ("a", (1.0, 2.0))) == [1.0] * 60 + [-1.0] * 60 + [1.0] * 60


def test_the_centre_of_a_body_is_measured():
    now = {"body": "front", "after": 0}
    measured = run_checks(
        cart(*({**now, "metric": metric, "at_least": 0, "at_most": 9} for metric in ("x", "y", "speed")))
    )
    assert [each.value for each in measured] == [pytest.approx(2.0), pytest.approx(0.5), 0.0]


def test_a_sweep_measures_checks_that_hold_keys_as_they_are_measured_by_themselves():
    x = {"metric": "x", "body": "rear", "after": 3}
    level = cart({**x, "at_least": 0.9, "hold": [{"key": "d", "during": [0, 3]}]}, {**x, "at_most": 0.1})
    *_, drives, stays = run_case(SweepRequest(level_text(level), ("cs",), 60, None), (1.0,))
    assert (drives, stays) == (1, 1)


def test_the_check_of_a_file_says_what_overlaps_and_what_sinks(tmp_path):
    def box(name, x, y):
        return {"type": "jelly", "id": name, "shape": {"box": [1, 1]}, "position": [x, y], "spacing": 0.25}

    zone = {"id": "pool", "box": [-9, -2, -4, 0], "water": {}}
    file = tmp_path / "stack.json"
    written = {**LEVEL, "format": "spring-sandbox/level", "version": 4, "terrain": [], "zones": [zone]}
    file.write_text(json.dumps(written | {"bodies": [*(box(f"b{k}", 0, k) for k in range(3)), box("slab", -6, 1)]}))
    said = check_level(str(file))
    sinks, overlap = [line.split(maxsplit=1)[1] for line in said.lines if line.startswith("  start")]
    assert sinks == '"slab" would sink in "pool": its water bears 40% of the weight'
    assert overlap.startswith("2 pairs of bodies overlap at the start, by up to 0.1 m (")
    assert said.data["start"] == [sinks, overlap] and said.passed


def test_the_check_of_a_file_says_that_no_rule_wins_the_goal_it_tells(tmp_path):
    file = tmp_path / "goal.json"
    file.write_text(json.dumps({**LEVEL, "format": "spring-sandbox/level", "version": 4, "goal": "Bring it home"}))
    said = check_level(str(file))
    text = 'No rule wins the level, and its goal says: "Bring it home"'
    assert f"  goal       {text}" in said.lines and said.data["goal"]["text"] == text and said.passed


def test_the_digits_of_what_was_measured_show_on_which_side_of_its_bound_it_is():
    check = CheckDef(name="far", metric="x", body="slab", at_least=-3.0)
    assert [value_text(check, value, 4) for value in (-3.00001, -2.99999, -3.0, -2.5, float("nan"))] == [
        "-3.00001", "-3", "-3", "-2.5", "nan",
    ]  # fmt: skip
    assert judge(check, -3.0000000001).text.endswith("is -3.0000000001, wanted at least -3")
