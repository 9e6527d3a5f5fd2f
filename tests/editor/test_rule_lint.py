"""Findings about rules that never fire."""

import pytest

from sandbox.editor.lint.hopeless_rules import hopeless_rules, idle_counters, vain_goals
from sandbox.editor.scene import make_scene
from tests.editor.test_rule_names import document

FAR = {"counter": "score", "at_least": 5.0}
LOW, HIGH = {"metric": "x", "particle": "ball", "at_most": 1.0}, {"metric": "x", "particle": "ball", "at_least": 2.0}


def found(rules, **changes):
    level = document(rules, **changes).level
    return [each.text for each in hopeless_rules(level, make_scene(level)) if each]


@pytest.mark.parametrize(
    ("when", "said"),
    [
        (FAR, 'no rule counts "score"'),
        ({"all": [LOW, HIGH]}, "contradict"),
        ({"any": [FAR, {"all": [LOW, HIGH]}]}, "no rule counts"),
        ({"metric": "speed", "particle": "ball", "at_most": -1.0}, "never below 0"),
        ({"particle": "rope.start", "crosses": "basket"}, "pinned outside basket"),
    ],
)
def test_a_rule_that_never_fires_is_found_with_why(when, said):
    (text,) = found([{"when": when}])
    assert said in text and 'Rule "rule 0"' in text


@pytest.mark.parametrize(
    "when",
    [
        {"counter": "score", "at_most": 5.0}, {"any": [FAR, LOW]}, {"none": [FAR]}, {"all": [LOW, {"key": "g"}]},
        {"metric": "inside", "particle": "ball", "zone": "basket"}, {"time": 900.0},
    ],
)  # fmt: skip
def test_a_rule_that_may_fire_is_no_finding(when):
    assert found([{"when": when, "then": [{"win": "!"}]}]) == []


def test_touches_are_never_met_where_nothing_touches_and_a_counter_that_is_counted_is_sound():
    alone = {"terrain": [], "walls": None, "zones": []}
    (text,) = found([{"when": {"touches": ["ball"]}}], **alone)
    assert "Contacts" in text
    counting = {"when": {"key": "g"}, "then": [{"count": "score"}]}
    assert found([{"when": FAR}, counting]) == []
    assert [each.text for each in idle_counters(document([]).level) if each] != []
    assert [each for each in idle_counters(document([counting]).level) if each] == []


@pytest.mark.parametrize(
    ("by", "once", "when", "said"),
    [
        (1.0, True, {"counter": "score", "at_least": 5.0}, 'rules count "score" up to 2 at most'),
        (-1.0, True, {"counter": "score", "at_most": -5.0}, 'rules count "score" down to -2 at most'),
        (-1.0, False, {"counter": "score", "at_least": 5.0}, 'rules count "score" up to 0 at most'),
        (1.0, False, {"counter": "score", "at_least": 5.0}, None),
        (3.0, True, {"counter": "score", "at_least": 5.0}, None),
    ],
)
def test_a_counter_that_is_asked_for_more_than_rules_can_count_is_found(by, once, when, said):
    counting = {"when": {"key": "g"}, "once": once, "then": [{"count": "score", "by": by}]}
    texts = found([{"when": when}, counting, counting])
    assert len(texts) == (said is not None) and all(said in text for text in texts)


def test_a_body_that_is_larger_than_the_zone_that_it_is_to_be_inside_is_found():
    def asking(size):
        block = {"type": "jelly", "id": "block", "shape": {"box": [size, 0.3]}, "spacing": 0.15, "position": [0, 3]}
        when = {"metric": "inside", "body": "block", "zone": "slot"}
        zone = {"id": "slot", "box": [0, 0, 0.4, 0.4]}
        return found([{"when": when}], bodies=[block], zones=[zone], springs=[])

    (text,) = asking(2.0)
    assert '"block" is 2 m long, and slot is 0.57 m across' in text
    assert asking(0.45) == []


@pytest.mark.parametrize(
    ("win", "lose", "is_late"),
    [
        ({"time": 20.0}, {"time": 10.0}, True),
        ({"all": [{"time": 20.0}, LOW]}, {"any": [{"time": 10.0}, LOW]}, True),
        ({"any": [{"time": 20.0}, LOW]}, {"time": 10.0}, False),
        ({"time": 20.0}, {"all": [{"time": 10.0}, LOW]}, False),
        ({"none": [{"time": 20.0}]}, {"time": 10.0}, False),
        ({"time": 10.0}, {"time": 10.0}, False),
    ],
)
def test_a_loss_that_comes_before_any_win_is_found(win, lose, is_late):
    texts = found([{"when": win, "then": [{"win": "Done"}]}, {"when": lose, "then": [{"fail": "Late"}]}])
    late = 'No run is won: "rule 1" loses it by 10 s, and "rule 0" wins at 20 s at the earliest'
    assert texts == ([late] if is_late else [])


WIN = {"when": {"time": 5.0}, "then": [{"win": "Won"}]}


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ({"goal": "Bring it home"}, 'No rule wins the level, and its goal says: "Bring it home"'),
        ({"rules": [WIN], "goal": "Bring it home", "hands": {"may": ["grab"]}}, None),
        ({"rules": [WIN], "hands": {"may": []}}, "Hands may do nothing"),
        ({"rules": [WIN], "hands": {"may": ["grab", "push"], "bodies": []}}, "Hands may do nothing"),
        ({"rules": [WIN], "hands": {"may": ["grab", "add"], "bodies": []}}, None),
        ({"rules": [{**WIN, "when": {"key": "g"}}], "hands": {"may": []}}, None),
    ],
)
def test_goals_are_found_that_nobody_wins_or_nobody_can_do_anything_for(parts, said):
    level = document(**{"rules": [], **parts}).level
    found = [each.text for each in vain_goals(level) if each is not None]
    assert (said is None and not found) or (len(found) == 1 and found[0].startswith(said)), found
