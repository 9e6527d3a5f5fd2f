"""Faults of rules: every one at once, in a line that says where and what to do."""

import json

import pytest

from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.parse import parse_level

LEVEL = {
    "format": "spring-sandbox/level",
    "version": 3,
    "name": "faults",
    "zones": [{"id": "basket", "box": [0, 0, 1, 1]}],
    "bodies": [{"id": "rope", "type": "rope", "start": [0, 0], "end": [1, 0], "segments": 3}],
    "particles": [{"id": "ball", "position": [0, 0]}],
    "counters": [{"id": "score"}],
}
SAY = {"say": "x"}
INSIDE = {"metric": "inside", "particle": "ball", "zone": "basket"}


def faults_of(*rules, **parts):
    with pytest.raises(LevelError) as caught:
        parse_level(json.dumps(LEVEL | {"rules": list(rules)} | parts).encode(), "faults")
    return str(caught.value).replace("faults: ", "").splitlines()


QUESTIONS = {
    "nothing": ({}, "rules.0.when: asks one of metric, touches, crosses, breaks, counter, key, time, all, any, none; "
                "this has none"),
    "two": ({"time": 1, "key": "a"}, "rules.0.when: asks one of metric, touches, crosses, breaks, counter, key, time, "
            "all, any, none; not key and time"),
    "no zone of that name": (INSIDE | {"zone": "baskte"}, 'rules.0.when.zone: there is no zone "baskte"; did you mean '
                             '"basket"?'),
    "no zone": ({"metric": "inside", "particle": "ball"}, 'rules.0.when.zone: is missing; "inside" is measured of a '
                "zone"),
    "no bound": ({"metric": "x", "particle": "ball"}, "rules.0.when: needs a bound: at_most, at_least or both"),
    "bounds the wrong way": ({"counter": "score", "at_least": 3, "at_most": 2}, "rules.0.when.at_least: 3.0 is above "
                             "at_most, 2.0"),
    "a metric of checks": ({"metric": "energy", "at_most": 1}, 'rules.0.when.metric: a rule does not ask for "energy"; '
                           "a check does"),
    "a thing that is not there": ({"touches": ["ball", "flor"]}, "rules.0.when.touches.1: there is no body, loose "
                                  'particle or piece of terrain "flor"'),
    "a thing and itself": ({"touches": ["ball", "ball"]}, 'rules.0.when.touches: "ball" does not touch itself; name '
                           "two things"),
    "nothing that crosses": ({"crosses": "basket"}, "rules.0.when: name the particle or the body that crosses"),
    "a counter that is not there": ({"counter": "scor", "at_least": 1}, 'rules.0.when.counter: there is no counter '
                                    '"scor"; did you mean "score"?'),
    "inside others": ({"all": [{"any": [{"breaks": "ball"}]}]}, 'rules.0.when.all.0.any.0.breaks: there is no body '
                      '"ball"'),
    "several, one not there": ({"crosses": "basket", "any_of": ["ball", "bal"]}, "rules.0.when.any_of.1: there is no "
                               'body, loose particle or group "bal"; did you mean "ball"?'),
    "one thing beside several": (INSIDE | {"all_of": ["rope"]}, "rules.0.when.particle: stands beside all_of; take one "
                                 "of them out"),
    "several things of a key": ({"key": "a", "any_of": ["ball"]}, "rules.0.when.any_of: belongs to another question "
                                "than key; take it out"),
    "two that several touch": ({"touches": ["ball", "rope"], "any_of": ["ball"]}, "rules.0.when.touches: names at most "
                               "one thing that those of any_of touch"),
    "one of several and itself": ({"touches": ["ball"], "any_of": ["ball", "rope"]}, 'rules.0.when.touches: "ball" '
                                  "does not touch itself; name two things"),
    "nothing that touches": ({"touches": []}, "rules.0.when.touches: names nothing; name what touches, or several "
                             "things in any_of"),
    "each of two lists": ({"all": [{"touches": [], "each_of": ["ball"]}, {"touches": [], "each_of": ["rope"]}]},
                          "rules.0.when: says each_of twice; a rule is of each of one list"),
    "a metric of the whole": ({"metric": "settled", "any_of": ["rope", "ball"]}, 'rules.0.when.any_of: "settled" is '
                              "measured of the whole level; take the particle out"),
    "several that break": ({"breaks": "rope", "any_of": ["rope"]}, "rules.0.when.any_of: belongs to another question "
                           "than breaks; ask the metric broken_springs of several, at_least 1"),
    "a field of another question": ({"time": 1, "at_most": 2}, "rules.0.when.at_most: belongs to another question than "
                                    "time; take it out"),
}  # fmt: skip


@pytest.mark.parametrize("case", QUESTIONS)
def test_a_question_that_says_too_much_or_too_little_is_refused(case):
    when, line = QUESTIONS[case]
    found = faults_of({"id": "r", "when": when, "then": [SAY]})
    assert len(found) == 1 and found[0].startswith(line), found


ACTIONS = {
    "nothing": ({}, "rules.0.then.0: does one of win, fail, say, sound, count, checkpoint, cut, pin, unpin, drive, "
                "sag, gravity, wind; this has none"),
    "two": ({"win": "a", "fail": "b"}, "rules.0.then.0: does one of win, fail, say, sound, count, checkpoint, cut, "
            "pin, unpin, drive, sag, gravity, wind; not win and fail"),
    "a field of another action": ({"say": "a", "by": 2}, "rules.0.then.0.by: belongs to count, not to say; take it "
                                  "out"),
    "no spring of that number": ({"cut": "rope:3"}, 'rules.0.then.0.cut: there is no spring "rope:3"'),
    "no such spring": ({"cut": ":0"}, 'rules.0.then.0.cut: there is no spring ":0"'),
    "no such body": ({"cut": "rop"}, 'rules.0.then.0.cut: there is no body "rop"; did you mean "rope"?'),
    "no such part": ({"drive": "wheel"}, 'rules.0.then.0.drive: there is no driven part "wheel"'),
    "a sag of nothing": ({"sag": 0.1}, "rules.0.then.0.body: is missing; sag is of a body"),
    "a counter of stars": ({"win": "", "stars": {"counter": "x", "second": 1, "third": 2}},
                           'rules.0.then.0.stars.counter: there is no counter "x"'),
    "no such particle": ({"pin": "rope.9"}, "rules.0.then.0.pin: "),
}  # fmt: skip


@pytest.mark.parametrize("case", ACTIONS)
def test_an_action_that_says_too_much_or_too_little_is_refused(case):
    then, line = ACTIONS[case]
    found = faults_of({"id": "r", "when": {"time": 1}, "then": [then]})
    assert len(found) == 1 and found[0].startswith(line), found


def test_all_faults_are_told_at_once():
    rules = [
        {"id": "r", "when": when, "then": [then]}
        for (when, _), (then, _) in zip(QUESTIONS.values(), ACTIONS.values(), strict=False)
    ]
    found = faults_of(*rules)
    # Springs of bodies are looked for once all else is sound; ids are the same.
    assert len(found) == 2 * len(rules) - 1 + len(rules) - 1


def test_ids_of_counters_and_rules_are_their_own():
    rule = {"id": "r", "when": {"time": 1}, "then": [SAY]}
    found = faults_of(rule, rule, counters=[{"id": "a"}, {"id": "a"}])
    assert found == [
        'counters.1.id: "a" is taken; every counter needs an id of its own',
        'rules.1.id: "r" is taken; every rule needs an id of its own',
    ]


@pytest.mark.parametrize("sag", [0, 0.0, 0.4])
def test_a_body_may_become_as_stiff_as_can_be(sag):
    body = {"type": "jelly", "id": "j", "shape": {"box": [0.8, 0.8]}, "spacing": 0.2, "position": [0, 30],
            "firmness": {"sag": 0.1}}  # fmt: skip
    rule = {"id": "a", "when": {"time": 0.1}, "then": [{"sag": sag, "body": "j"}]}
    level = parse_level(json.dumps(LEVEL | {"bodies": [body], "rules": [rule]}).encode(), "rigid")
    assert level.rules[0].then[0].done == ("sag",)
