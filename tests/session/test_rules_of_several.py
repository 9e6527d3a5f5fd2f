"""Rules of several things: any, all and each of bodies, particles and groups, as they fire in a run."""

import json
import random

import pytest

from sandbox.editor.rule_text import rule_text
from sandbox.level.document.canonical import level_text
from sandbox.level.format.level_error import LevelError
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.reading.parse import parse_level
from sandbox.session.outcome import outcome
from sandbox.session.session import Session

COUNT = [{"count": "score"}]
IN_WATER = {"metric": "inside", "zone": "low"}


def level(*rules, heights=(1.0, 2.0, 4.0), **parts):
    """Balls that fall to the ground one after another, the first two of them a group, the third alone."""
    balls = [
        {"id": f"ball {k}", "position": [2.0 * k, height], "radius": 0.1, "restitution": 0.6}
        | ({"group": "pair"} if k < 2 else {})
        for k, height in enumerate(heights)
    ]
    data = {
        "format": "spring-sandbox/level", "version": 4, "name": "Several",
        "terrain": [{"id": "floor", "polyline": [[-9, 0], [30, 0]]}],
        "zones": [{"id": "low", "box": [-5, 0, 30, 0.6]}],
        "particles": balls, "counters": [{"id": "score"}], "rules": list(rules), **parts,
    }  # fmt: skip
    return parse_level(json.dumps(data).encode(), "several")


def run(made, seconds=3.0):
    """The session of a level after so long, and the times [s] at which its rules fired first, by name."""
    session = Session(made)
    for _ in range(round(seconds * 60)):
        session.advance()
    names = [rule.id for rule in run_rules(made)]
    return session, dict(zip(names, (session.world.rule_first / 60).tolist(), strict=True))


def rule(when, then=COUNT, **more):
    return {"id": "r", "when": when, "then": then, **more}


def test_a_bobbing_ball_counts_once_where_a_rule_is_once_for_each():
    again, _ = run(level(rule({"crosses": "low", "each_of": ["pair", "ball 2"]})))
    once, fired = run(level(rule({"crosses": "low", "each_of": ["pair", "ball 2"]}, once=True)))
    assert again.world.counter[0] > 3.0 == once.world.counter[0]
    assert sorted(fired, key=fired.get) == ["r: ball 0", "r: ball 1", "r: ball 2"]


@pytest.mark.parametrize("touch", [["floor"], []])
def test_any_of_fires_with_the_first_and_all_of_with_the_last(touch):
    names = ["ball 2", "pair"]
    when = [{"touches": touch, kind: names} for kind in ("any_of", "all_of")]
    _, single = run(level(*(rule({"touches": [f"ball {k}", "floor"]}) | {"id": f"ball {k}"} for k in range(3))))
    _, inside = run(level(rule(when[0]) | {"id": "any"}, rule(IN_WATER | {"all_of": names}) | {"id": "all"}))
    assert inside["any"] == min(single.values())
    _, alone = run(level(*(rule(IN_WATER | {"particle": f"ball {k}"}) | {"id": f"ball {k}"} for k in range(3))))
    assert inside["all"] >= max(alone.values())


def test_a_rule_of_several_is_the_questions_that_it_stands_for():
    """Of random names: what it asks written out by hand fires at the same ticks, with the same bits."""
    dice = random.Random(5)
    for _ in range(6):
        heights = tuple(dice.uniform(0.3, 5.0) for _ in range(5))
        names = dice.sample([f"ball {k}" for k in range(5)], dice.randint(1, 5))
        short = [rule(IN_WATER | {"any_of": names}) | {"id": "any"}, rule(IN_WATER | {"all_of": names}) | {"id": "all"}]
        long = [
            rule({kind: [IN_WATER | {"particle": name} for name in names]}) | {"id": kind} for kind in ("any", "all")
        ]
        found, wanted = (run(level(*rules, heights=heights)) for rules in (short, long))
        assert found[1] == wanted[1]
        assert found[0].world.counter.tolist() == wanted[0].world.counter.tolist()


def test_the_first_of_each_wins_and_the_rule_that_won_has_its_name():
    made = level(rule({"touches": ["floor"], "each_of": ["ball 2", "ball 0"]}, then=[{"win": "Down"}]))
    session, _ = run(made)
    found = outcome(made, session.world)
    assert found is not None and found.is_won and run_rules(made)[found.rule].id == "r: ball 0"


def test_a_file_keeps_what_names_several_and_reads_it_again():
    made = level(rule({"all": [{"key": "g"}, {"touches": ["floor"], "each_of": ["pair", "ball 2"]}]}, once=True))
    text = level_text(made)
    assert (
        parse_level(text.encode(), "again").rules == made.rules and level_text(parse_level(text.encode(), "a")) == text
    )
    assert rule_text(made.rules[0]).startswith("When key G is held and each of pair, ball 2 touches floor: score +1")


def test_more_rules_than_a_level_may_have_are_refused_and_so_are_more_questions():
    many = [{"id": f"n{k}", "position": [0.5 * k, 3.0], "radius": 0.1, "group": "all"} for k in range(501)]
    each = [rule({"touches": [], "each_of": ["all"]}) | {"id": name} for name in ("a", "b")]
    with pytest.raises(LevelError, match="rules: come to 1,002 with one for each of each_of; at most 1,000"):
        level(*each, particles=many)
    asked = {"touches": [], "any_of": ["all"]}
    with pytest.raises(LevelError, match="asks more than 1,000 questions"):
        level(rule({"all": [asked, asked]}), particles=many)
