"""Links that somebody forged: a page carries each out as by hand, and says which deed is not allowed; none hangs it."""

import pytest

from sandbox import load_level
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.session.replay.link import level_record
from tests.page.in_node import NODE
from tests.page.link_fuzz import fragment_of, in_node, on_the_desktop, tried
from tests.support.wholes import part_and_whole

pytestmark = pytest.mark.skipif(NODE is None, reason="node is not installed")

HASH = "0" * 32
BALL = {"type": "add_particle", "position": [0.0, 5.0]}
ROD = {
    "bodies": 1,
    "particles": {"x": [0.0, 1.0], "y": [5.0, 5.0], "body": [0, 0], "group": 2, "collides": 0},
    "springs": {"a": [0], "b": [1]},
    "materials": {"name": ["default"]},
}


def link(level, *commands, **changes):
    """The fragment of a link to a run of a level of 60 ticks, with commands at its start."""
    whole = {
        "v": 2, "physics": PHYSICS_VERSION, **level_record(level), "ticks": 60, "at": 0, "hash": HASH,
        "commands": [[0, number, record] for number, record in enumerate(commands, 1)],
    }  # fmt: skip
    return fragment_of(whole | changes)


def kit(part, column, value):
    return {"type": "add_body", "kit": ROD | {part: ROD.get(part, {}) | {column: value}}}


FORGED = {
    "a fourth ball": ("bridge_budget", [BALL] * 6, "not verified: not enough parts left"),
    "gravity": (
        "pinball_score", [{"type": "set_gravity", "gravity": [0.0, 5.0]}],
        "not verified: in this level hands may not change gravity",
    ),
    "a grab": (
        "egg_drop", [{"type": "grab", "grab": 0, "particle": "egg.0", "target": [0.0, 3.0]}],
        "not verified: in this level hands may not grab things",
    ),
    "a slot": ("rope", [kit("springs", "a", [10**9])], "not verified: springs.a.0: 1e+09 does not fit"),
    "corners": (
        "chain_of_events", [kit("constraints", "corners", [1_000_000_000])],
        "not verified: constraints.corners.0: 1e+09 does not fit",
    ),
    "a material": ("rope", [kit("springs", "material", [10**9])], "not verified: springs.material.0: 1e+09 "),
    "a name of prototypes": ("rope", [kit("toString", "a", [0])], "not verified: toString: kits have no such"),
    "places": ("rope", [kit("particles", "x", [1e300, 0.0])], "not verified: particles.x.0: 1e+300 is not"),
}  # fmt: skip


@pytest.mark.parametrize("name", FORGED)
def test_the_first_deed_of_a_forged_link_that_may_not_be_is_named(name, tmp_path):
    level_name, commands, words = FORGED[name]
    level = load_level(level_name)
    fragment = link(level, *commands)
    ((said, _),) = in_node(tmp_path, level, [fragment])
    assert said.startswith(words), said
    assert on_the_desktop(fragment) != "verified"


def test_what_a_kit_says_of_its_keys_and_numbers_is_right_in_a_page_where_it_is_on_the_desktop(tmp_path):
    level = load_level("rope")
    parts = {"parts": {"value": [0.0]}, "names": {"parts": [0]}}
    kits = [ROD | parts | {"keys": {"A": [[0, value]]}} for value in (1, -1.0, "1", True, 0, [1])]
    kits += [ROD | {"bodies": 1.0, "names": {"particles": [[0.0, 0, len(ROD["particles"]["x"])]]}}]
    links = [link(level, {"type": "add_body", "kit": each}) for each in kits]
    joined = ["keys" not in words for words, _ in in_node(tmp_path, level, links)]
    assert joined == ["refused" not in on_the_desktop(each) for each in links]
    assert joined == [True, True, False, False, False, False, True]


def test_a_link_that_says_what_came_out_or_of_before_is_refused_in_a_line(tmp_path):
    level = load_level("egg_drop")
    told = {"changes": {"state.gravity_scale": [[0, 1, 0.02]]}}
    soft = {"type": "set_firmness", "body": "egg", "sag": 0.2}
    links = [link(level, commands=[[0, 1, soft, told]]), link(level, v=1), link(level, at=61), link(level, ticks=10**9)]
    said = [words for words, _ in in_node(tmp_path, level, links)]
    assert said[1] == "refused: This link is of version 1; this page reads 2."
    assert [words.partition(":")[0] for words in said] == ["refused"] * 4
    assert all(on_the_desktop(fragment).startswith("refused") for fragment in links)


def test_a_run_whose_end_is_another_is_not_verified(tmp_path):
    level = load_level("rope")
    ((said, _),) = in_node(tmp_path, level, [link(level, BALL)])
    assert said == "not verified: other bits"


@pytest.mark.parametrize("count", part_and_whole(40, 150))
def test_no_link_that_was_changed_by_chance_verifies_that_the_desktop_refuses(tmp_path, count):
    kinds = set()
    for fragment, words, _ in tried(tmp_path, count, 5):
        kinds.add(words.partition(":")[0])
        assert not words.startswith("fault"), words
        assert words != "verified" or on_the_desktop(fragment) == "verified", fragment
    assert kinds == {"verified", "not verified", "refused"}
