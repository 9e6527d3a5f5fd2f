"""What rules name, when it is renamed, deleted, reordered, copied or taken apart."""

import json
from pathlib import Path

import pytest

from sandbox.editor.document import Document, EditError, select
from sandbox.editor.edits.copying import duplicate, paste
from sandbox.editor.edits.deleting import break_apart, delete
from sandbox.editor.edits.fields import rename, set_field, set_level_field
from sandbox.editor.edits.grouping import rename_group, reorder, ungroup
from sandbox.editor.edits.names import lost_rules
from sandbox.editor.edits.placing import without_springs
from sandbox.editor.items import Item
from sandbox.level.document.canonical import level_text
from sandbox.level.reading.files import read_level
from sandbox.level.reading.parse import parse_level


def document(rules, **changes):
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Rules",
        "walls": {"box": [-9.0, -9.0, 9.0, 9.0]},
        "terrain": [{"id": "floor", "polyline": [[-4.0, 0.0], [4.0, 0.0]]}],
        "zones": [{"id": "basket", "box": [1.0, 0.0, 2.0, 1.0]}],
        "bodies": [{"type": "rope", "id": "rope", "start": [0, 4], "end": [0, 2], "segments": 4, "pin": ["start"]}],
        "particles": [{"id": "ball", "position": [-2.0, 2.0]}, {"id": "peg", "position": [-3.0, 2.0]}],
        "springs": [{"a": "peg", "b": "ball"}, {"a": "rope.end", "b": "ball"}, {"a": "rope.end", "b": "peg"}],
        "counters": [{"id": "score"}],
        "rules": [{"id": f"rule {k}", "then": [{"say": "!"}], **rule} for k, rule in enumerate(rules)],
        **changes,
    }
    return Document(parse_level(json.dumps(data).encode(), "test"))


def only(items, *keys):
    return select(items, frozenset(Item(*key) for key in keys))


RULES = [
    {"when": {"metric": "inside", "particle": "ball", "zone": "basket"}},
    {"when": {"any": [{"touches": ["ball", "floor"]}, {"none": [{"body": "rope", "crosses": "basket"}]}]}},
    {"when": {"breaks": "rope"}, "then": [{"cut": "rope:2"}, {"unpin": "rope.start"}]},
    {"when": {"touches": ["walls"]}, "then": [{"cut": ":2"}]},
]


@pytest.mark.parametrize(
    ("item", "gone"),
    [
        (("zone", "basket"), {"rule 0", "rule 1"}),
        (("particle", "ball"), {"rule 0", "rule 1"}),
        (("terrain", "floor"), {"rule 1"}),
        # With the rope goes the loose spring :2, which the last one cuts.
        (("body", "rope"), {"rule 1", "rule 2", "rule 3"}),
        (("spring", 2), {"rule 3"}),
    ],
)
def test_a_rule_whose_thing_is_deleted_goes_whole(item, gone):
    before = document(RULES)
    after = delete(only(before, item)).level
    assert {rule.id for rule in before.level.rules} - {rule.id for rule in after.rules} == gone
    assert set(lost_rules(before.level, after)) == gone
    parse_level(level_text(after).encode(), "after")


@pytest.mark.parametrize(
    ("item", "old"), [(("zone", "basket"), "basket"), (("terrain", "floor"), "floor"), (("body", "rope"), "rope"),
                      (("particle", "ball"), "ball")],
)  # fmt: skip
def test_rules_follow_what_is_renamed(item, old):
    before = document(RULES)
    after = rename(before, Item(*item), "new name").level
    text = json.dumps(json.loads(level_text(after))["rules"])
    assert f'"{old}' not in text and '"new name' in text
    assert len(after.rules) == len(RULES) and lost_rules(before.level, after) == []


def test_rules_that_cut_a_loose_spring_still_mean_it_once_another_one_is_gone_or_before_it():
    before = document([{"when": {"key": "g"}, "then": [{"cut": ":2"}]}])
    assert delete(only(before, ("spring", 0))).level.rules[0].then[0].cut == ":1"
    assert without_springs(before, {}, {1}).level.rules[0].then[0].cut == ":1"
    assert reorder(only(before, ("spring", 2)), "back").level.rules[0].then[0].cut == ":0"
    assert delete(only(before, ("particle", "ball"))).level.rules[0].then[0].cut == ":0"


def test_without_walls_no_rule_asks_for_their_touch():
    after = set_level_field(document(RULES), "walls", None).level
    assert [rule.id for rule in after.rules] == ["rule 0", "rule 1", "rule 2"]


def test_rules_stay_with_the_particles_of_a_body_of_another_form():
    after = set_field(document(RULES), [Item("body", "rope")], "segments", 8).level
    assert len(after.rules) == len(RULES) and after.rules[2].then[1].unpin == "rope.start"


def test_rules_of_a_body_go_as_it_is_broken_apart_and_those_of_its_particles_follow():
    before = document([{"when": {"breaks": "rope"}}, {"when": {"key": "g"}, "then": [{"unpin": "rope.start"}]}])
    after = break_apart(only(before, ("body", "rope"))).level
    assert [rule.then[0].unpin for rule in after.rules] == ["rope 0"]


def test_a_copy_brings_no_rules_and_leaves_those_that_are_there():
    before = document(RULES)
    after = duplicate(only(before, ("particle", "ball"), ("zone", "basket")), 1.0, 0.0)
    assert after.level.rules == before.level.rules and len(after.level.zones) == 2
    assert {item.key for item in after.selection} == {"ball 2", "basket 2"}
    assert paste(document([]), level_text(before.level)).level.rules == ()


@pytest.mark.parametrize("name", ["basket", "bumpers", "chain"])
def test_everything_in_the_levels_of_the_manual_can_be_deleted_one_by_one(name):
    level = read_level(Path("docs/rules") / f"{name}.json")
    for kind, parts in (("zone", level.zones), ("particle", level.particles), ("terrain", level.terrain),
                        ("body", level.bodies)):  # fmt: skip
        for part in parts:
            after = delete(Document(level, frozenset([Item(kind, part.id)]))).level
            parse_level(level_text(after).encode(), "after")


def test_a_zone_cannot_have_the_name_of_another_thing():
    with pytest.raises(EditError, match="taken"):
        rename(document([]), Item("zone", "basket"), "ball")


def test_what_hands_may_touch_follows_what_is_renamed_deleted_and_copied():
    start = document([], hands={"may": ["grab", "pin"], "bodies": ["rope", "ball"]})
    renamed = rename(start, Item("body", "rope"), "string")
    assert renamed.level.hands.bodies == ("string", "ball")
    assert delete(only(renamed, ("particle", "ball"))).level.hands.bodies == ("string",)
    assert duplicate(only(start, ("body", "rope")), 1.0, 0.0).level.hands == start.level.hands


SEVERAL = [{"when": {"crosses": "basket", "each_of": ["pair", "rope"]}}, {"when": {"touches": [], "any_of": ["ball"]}}]
PAIR = [
    {"id": "ball", "position": [-2.0, 2.0], "group": "pair"},
    {"id": "peg", "position": [-3.0, 2.0], "group": "pair"},
]


def several(made):
    return [rule.when.each_of or rule.when.any_of for rule in made.level.rules]


def test_what_stands_among_several_follows_and_goes_alone_and_with_the_last_goes_the_rule():
    made = document(SEVERAL, particles=PAIR)
    assert several(rename(made, Item("body", "rope"), "cord")) == [("pair", "cord"), ("ball",)]
    without = delete(only(made, ("particle", "ball")))
    assert several(without) == [("pair", "rope")]
    assert several(delete(only(without, ("body", "rope")))) == [("pair",)]
    assert lost_rules(made.level, without.level) == ["rule 1"]


def test_rules_follow_a_group_that_gets_another_name_and_let_go_of_one_that_is_dissolved():
    made = document(SEVERAL, particles=PAIR)
    assert several(rename_group(made, "pair", "twins")) == [("twins", "rope"), ("ball",)]
    both = only(made, ("particle", "ball"), ("particle", "peg"))
    assert several(ungroup(both)) == [("rope",), ("ball",)]
    assert several(ungroup(only(made, ("particle", "peg")))) == several(made)
    for each in (ungroup(both), rename_group(made, "pair", "twins")):
        assert parse_level(level_text(each.level).encode(), "again").rules == each.level.rules
