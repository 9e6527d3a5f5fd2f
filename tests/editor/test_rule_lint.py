"""Findings about rules that never fire."""

import pytest

from sandbox.editor.lint.hopeless_rules import hopeless_rules, idle_counters
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
