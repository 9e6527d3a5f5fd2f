"""A page takes and refuses the same commands as the desktop, in the same words, and to the same bits."""

import dataclasses
import json
import math
import random
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import pytest

from sandbox import load_level
from sandbox.commands import COMMAND_TYPES, CommandError, apply, from_record
from sandbox.level.assembly.build_world import build_world
from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.level.rules.player_limits import PlayerLimits
from sandbox.level.rules.rule import RuleDef
from sandbox.page.start import is_done_by_pages
from sandbox.physics.commands.command_table import KINDS
from sandbox.physics.snapshot import restore, state_hash, take
from sandbox.physics.step import step
from sandbox.physics.world import World
from tests.page.in_node import NODE, tried_in_node
from tests.support.wholes import some_and_whole

LEVEL = "tumble_drum"
NAN, INF = math.nan, math.inf
NUMBERS = [
    0, 1, -1, 0.5, 5, 10, 5000, 1e-300, 2**53, 10**20, 1e21, 1e300, -1e30, 1e6, -1e15, 1e15, 2e15, NAN, INF, -INF,
]  # fmt: skip
STRANGE = [
    *NUMBERS, None, True, False, "", "0", "x", "a" * 90, 'q"\\uote', "tab\t", "line\u2028", "\x7f", "Ω", "Ω\u200b",
    "𝄞" * 70, [], [1], [0, 0], [0, 0, 0], [NAN, 0], [0, INF], ["a", 1], [None, 1], [[0, 0]], [1e6, 1e7], {}, {"a": 1},
]  # fmt: skip
FIELDS = ["grab", "strength", "Strength", "type ", "weiß", "a.b", "", "x" * 100]
# What was done before: a hand holds, something is pinned, cut and driven.
BEFORE: list[dict[str, Any]] = [
    {"type": "grab", "grab": 1, "particle": "FREE.0", "target": [0.5, 2]},
    {"type": "pin", "particle": "FREE.1"},
    {"type": "cut_springs", "springs": ["SPRING.0"]},
    {"type": "set_drive", "part": "PART.0", "value": 0.5},
]
GOOD: dict[str, dict[str, Any]] = {
    "grab": {"grab": 2, "particle": "FREE.2", "target": [0.5, 1.5], "strength": 50, "radius": 0.25},
    "move_grab": {"grab": 1, "target": [0.25, 1]},
    "release": {"grab": 1},
    "pin": {"particle": "FREE.3"},
    "unpin": {"particle": "FREE.1"},
    "cut_springs": {"springs": ["SPRING.1", "SPRING.2", "SPRING.1"], "at": [0.25, 0.5, 0.25]},
    "set_coefficients": {"stiffness": 0.25, "damping": 0.75, "material": "MATERIAL.0", "duration": 7},
    "set_drive": {"part": "PART.1", "value": -1},
    "hold_key": {"key": "g", "down": True},
    "push": {"position": [0, 0], "radius": 500, "impulse": [1, 2], "outward": 3},
    "shake": {"acceleration": [1, -2]},
    "set_gravity": {"gravity": [0, -3], "duration": 5},
    "set_air": {"wind": [1, 0], "drag": 0.125, "duration": 4},
    "set_inflation": {"body": "AREA.0", "value": 1.25, "duration": 6},
    "scale_mass": {"particle": "FREE.4", "factor": 2.5},
    "move_body": {"particle": "FREE.5", "by": [0.5, 1], "at_rest": True},
    "free": {"particle": "FREE.2"},
    "set_firmness": {"body": "FORM.0", "sag": 0.05, "hz": None, "ratio": None, "duration": 9},
    "set_solver": {"solver": "iterative", "iterations": 12, "substeps": 4, "warm_start": 0.25, "duration": 8},
}
# Bad values of a field of each kind of command that kernels carry out: eight and more.
BAD: dict[str, list[dict[str, Any]]] = {
    "grab": [
        *({"grab": value} for value in (-1, 10, 5000, 1.5, NAN, None, "0", True)),
        *({"particle": value} for value in ("no", "+hand.0", 0, None, True, ["FREE.2"], "FREE.1", NAN)),
        *({"target": value} for value in ([NAN, 0], [0, INF], [0], [0, 0, 0], None, "ab", ["a", 1], 1e7, [0, 2e6])),
        *({"strength": value} for value in (0, -1, NAN, INF, None, "1", 2e6, True)),
        *({"radius": value} for value in (-1, NAN, INF, None, "1", 2e6, True, [])),
    ],
    "move_grab": [
        *({"grab": value} for value in (-1, 0, 9, 10, 1.5, NAN, None, "1")),
        *({"target": value} for value in ([NAN, 0], [0, INF], [0], [0, 0, 0], None, 5, ["a", 1], [0, -2e6])),
    ],
    "release": [{"grab": value} for value in (-1, 0, 9, 10, 1.5, NAN, None, "1", True)],
    "pin": [{"particle": value} for value in ("no", "+hand.1", 0, -1, None, "FREE.1", NAN, True, {})],
    "unpin": [{"particle": value} for value in ("no", "+hand.1", 0, -1, None, "FREE.2", NAN, True, [])],
    "cut_springs": [
        *(
            {"springs": value}
            for value in (["SPRING.1", "no"], ["SPRING.1", "SPRING.0"], ["+hand.1"], [0], "SPRING.1", None, [None], NAN)
        ),
        *({"at": value} for value in ([0.5, 1.5, 0.5], [-1e-9, 0, 0], [NAN, 0, 0], [None, 0, 0], "0.5", 1, None, {})),
    ],
    "break_springs": [{"springs": value} for value in (["SPRING.1"], ["no"], [0], "SPRING.1", None, [None], NAN, [])],
    "part_bodies": [{"springs": value} for value in (["SPRING.1"], ["no"], [0], "SPRING.1", None, [None], NAN, [])],
    "hold_key": [
        *({"key": value} for value in ("h", 0, -1, None, NAN, True, [], {})),
        *({"down": value} for value in (1, 0, NAN, None, "true", [], {}, 0.5)),
    ],
    "set_coefficients": [
        *({"stiffness": value} for value in (5, -1, NAN, INF, "1", True, [], 1.0000001)),
        *({"damping": value} for value in (5, -1, NAN, INF, "1", True, {}, -1e-300)),
        *({"material": value} for value in ("no", 0, -1, NAN, True, [], ["MATERIAL.0"], {})),
        *({"duration": value} for value in (-1, 1.5, NAN, INF, None, "1", True, 1_000_001)),
    ],
    "set_drive": [
        *({"part": value} for value in ("no", 0, -1, None, NAN, True, [], {})),
        *({"value": value} for value in (1.5, -2, NAN, INF, None, "1", True, [0])),
    ],
    "push": [
        *({"position": value} for value in ([NAN, 0], [0], [0, 0, 0], None, 5, ["a", 1], [2e6, 0], [1e6, 1e6])),
        *({"radius": value} for value in (0, -1, NAN, INF, None, "1", 2e6, True)),
        *({"impulse": value} for value in ([NAN, 0], [0], [0, 0, 0], None, 5, ["a", 1], [2e15, 0], "ab")),
        *({"outward": value} for value in (NAN, INF, None, "1", 2e15, True, [], {})),
    ],
    "set_gravity": [
        *({"gravity": value} for value in ([NAN, 0], [0, INF], [0], [0, 0, 0], None, 5, ["a", 1], [-1e30, 0])),
        *({"duration": value} for value in (-1, 1.5, NAN, INF, None, "1", True, 1_000_001)),
    ],
    "set_air": [
        *({"wind": value} for value in ([NAN, 0], [0, INF], [0], [0, 0, 0], 5, ["a", 1], [-1e30, 0], "ab")),
        *({"drag": value} for value in (-1, NAN, INF, "1", True, [], {}, 1e30)),
        *({"duration": value} for value in (-1, 1.5, NAN, INF, None, "1", True, 1_000_001)),
    ],
    "set_inflation": [
        *({"body": value} for value in ("no", 0, -1, None, NAN, True, [], {})),
        *({"value": value} for value in (-1, NAN, INF, None, "1", True, [], 101)),
        *({"duration": value} for value in (-1, 1.5, NAN, INF, None, "1", True, 1_000_001)),
    ],
    "scale_mass": [
        *({"particle": value} for value in ("no", "+hand.1", 0, -1, None, NAN, True, {})),
        *({"factor": value} for value in (0, -1, NAN, INF, None, "1", True, 1e6)),
    ],
    "move_body": [
        *({"particle": value} for value in ("no", "+hand.1", 0, -1, None, NAN, True, {})),
        *({"by": value} for value in ([NAN, 0], [0, INF], [0], [0, 0, 0], None, 5, ["a", 1], [1e6, 0])),
        *({"at_rest": value} for value in (1, 0, NAN, None, "true", [], {}, 0.5)),
    ],
    "free": [{"particle": value} for value in ("no", "+hand.1", 0, -1, None, NAN, True, {})],
    "set_firmness": [
        *({"body": value} for value in ("no", 0, -1, None, NAN, True, [], {})),
        *({"sag": value} for value in (-1, 0.5, NAN, INF, None, "1", True, [])),
        *({"hz": value} for value in (1, 5, 20, 1e9, NAN, "1", True, [])),
        *({"sag": None, "hz": value} for value in (0, -1, 1e9, NAN, INF, "1", True, [], 900)),
        *({"ratio": value} for value in (1, 0.5, -1, NAN, INF, "1", True, 11)),
        *({"sag": None, "hz": hz, "ratio": ratio} for hz, ratio in ((25, 0.01), (3.3333333, 0), (29, 10))),
        {"sag": 1e-9},
    ],
    "set_solver": [
        *({"solver": value} for value in ("magic", "", 0, 1, NAN, True, [], {})),
        *({"iterations": value} for value in (0, -1, 1001, 1.5, NAN, "1", True, [])),
        *({"substeps": value} for value in (0, 3, -1, 128, "automatic", NAN, [], 1.5)),
        *({"warm_start": value} for value in (-1, 1.5, NAN, INF, "1", True, [], {})),
        *({"duration": value} for value in (-1, 1.5, NAN, INF, None, "1", True, 1_000_001)),
    ],
    "soften": [{"body": value} for value in ("AREA.0", "no", 0, -1, None, [None], NAN, [])],
    "shake": [{"acceleration": value} for value in ([NAN, 0], [0, INF], [0], [0, 0, 0], None, 5, ["a", 1], [-1e30, 0])],
}  # fmt: skip
assert BAD.keys() == KINDS.keys()

needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")


RULE = {"id": "key", "when": {"key": "g"}, "then": [{"say": "pressed"}]}


def world_of() -> World:
    level = load_level(LEVEL)
    return build_world(level.model_copy(update={"rules": (RuleDef.model_validate_json(json.dumps(RULE)),)}))


def names_in(value: Any, world: World) -> Any:
    """A value with names of the world in place of FREE.k, SPRING.k, PART.k and MATERIAL.k."""
    if isinstance(value, dict):
        return {key: names_in(each, world) for key, each in value.items()}
    if isinstance(value, list):
        return [names_in(each, world) for each in value]
    kind, _, number = value.partition(".") if isinstance(value, str) else ("", "", "")
    free = [name for slot, name in enumerate(world.particle_names) if world.inverse_mass[slot] > 0.0]
    of = {
        "FREE": free, "SPRING": world.spring_names, "PART": world.actuators.names, "MATERIAL": world.material_names,
        "AREA": world.area_names, "FORM": [form.name for form in world.forms],
    }.get(kind)  # fmt: skip
    return of[int(number) % len(of)] if of else value


def plain(value: Any) -> Any:
    """A value as JSON of JavaScript has it: whole numbers without a point."""
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e21:
        return int(value)
    return value


def wrong_records() -> list[dict[str, Any]]:
    """Records of every kind, each with one bad value, to be refused once BEFORE is done."""
    return [{"type": kind, **GOOD.get(kind, {}), **bad} for kind in BAD for bad in BAD[kind]]


def records_with_one_fault() -> list[dict[str, Any]]:
    """Every command that pages carry out, with each of its fields, and each number of one, left out, too large, not
    finite, below all bounds, and of each wrong type; and with a field too many."""
    values = [1e300, -1e300, NAN, INF, None, True, "x", [], {}, [[]], 0.5, 10**9, -1, -0.0]
    found = []
    for name, fields in GOOD.items():
        found.append({"type": name, **fields, "another": 1})
        for field, good in fields.items():
            rest = {other: value for other, value in fields.items() if other != field}
            found.append({"type": name, **rest})
            tried = list(values)
            if isinstance(good, list):
                tried += [[*good[:k], value, *good[k + 1 :]] for k in range(len(good)) for value in values]
                tried += [good[:-1], [*good, good[-1]], good * 2]
            found += [{"type": name, **fields, field: plain(value)} for value in tried]
    return found


def any_records(count: int) -> list[Any]:
    """Records of all types: right ones, ones with fields left out, changed or added, and what is no record."""
    chance, found = random.Random(5), []
    inner = ("break_springs", "part_bodies")
    types = [*GOOD, *GOOD, *COMMAND_TYPES, *inner, "nothing", "Grab", "constructor", "toString"]
    found += [None, [], {}, 5, NAN, "grab", True, {"type": None}, {"type": 5}, {"type": ["grab"]}, {"kind": "grab"}]
    while len(found) < count:
        name = chance.choice(types)
        fields = dict(GOOD.get(name, {}))
        for _ in range(chance.choice((0, 1, 1, 1, 2))):
            field = chance.choice(list(fields) if fields and chance.random() < 0.9 else FIELDS)
            if chance.random() < 0.25:
                fields.pop(field, None)
            elif isinstance(fields.get(field), list) and fields[field] and chance.random() < 0.5:
                value = list(fields[field])
                value[chance.randrange(len(value))] = plain(chance.choice(STRANGE))
                fields[field] = value
            else:
                fields[field] = plain(chance.choice(STRANGE))
        found.append({"type": name, **fields})
    return found


def tried_on_the_desktop(world: World, before: list[Any], tried: list[Any]) -> list[tuple[str, str]]:
    """What comes of each record in a world, after others and a tick: words and hash."""
    said = []
    for record in before:
        apply(world, from_record(record, world))
    step(world)
    start = take(world)
    for record in tried:
        try:
            apply(world, from_record(record, world))
            words = "taken"
        except CommandError as error:
            # A page makes no guesses.
            words = str(error).partition("; did you mean ")[0].partition("; it only looks like ")[0]
        said.append((words, state_hash(world)))
        restore(world, start)
    return said


def those_that_may_be(world: World, records: list[Any]) -> Iterator[Any]:
    """Those of the records that hands may give, one after another."""
    for record in records:
        with suppress(CommandError):
            apply(world, from_record(record, world))
            yield record


@needs_node
@pytest.mark.parametrize("records", some_and_whole(("bad", "one fault"), ("any", "bad", "one fault")))
def test_a_page_takes_and_refuses_what_the_desktop_does_in_its_words(records, tmp_path):
    world = world_of()
    before = names_in(BEFORE, world)
    made = {"any": lambda: any_records(3_000), "bad": wrong_records, "one fault": records_with_one_fault}
    tried = names_in(made[records](), world)
    outcomes = Counter()
    pages, desktop = tried_in_node(tmp_path, world, before, tried), tried_on_the_desktop(world_of(), before, tried)
    for record, page, (words, hashed) in zip(tried, pages, desktop, strict=True):
        name = record.get("type") if isinstance(record, dict) else None
        if name == "add_body":
            # A page takes kits, and no definitions.
            assert page["words"] != "taken" or (page["words"], page["hash"]) == (words, hashed), record
        elif isinstance(name, str) and name in COMMAND_TYPES and not is_done_by_pages(name):
            assert page["words"].startswith(f"a page cannot do {name}; it can do "), record
        else:
            assert (page["words"], page["hash"]) == (words, hashed), record
        assert not page["isChanged"], record
        outcomes[words == "taken"] += 1
    assert outcomes[False] > 100
    assert outcomes[True] > {"any": 500, "one fault": 30, "bad": -1}[records]
    assert records != "bad" or outcomes[True] == 0


@needs_node
@pytest.mark.parametrize(
    "hands",
    [
        {"may": ["pin", "cut"]},
        {"at_most": {"grab": 1, "pin": 1, "cut": 2}},
        {"may": ["grab"], "at_most": {"grab": 2}},
        {"bodies": ["sock"]},
    ],
)
def test_a_page_refuses_what_the_level_does_not_let_hands_do(hands, tmp_path):
    def limited():
        level = world_of().level
        return build_world(replaced(level, hands=PlayerLimits.model_validate_json(json.dumps(hands))))

    world = limited()
    # Before, of all that counts something is done, where it may be.
    before = [] if "bodies" in hands else list(those_that_may_be(limited(), names_in(BEFORE, world)))
    tried = names_in([{"type": kind, **fields} for kind, fields in GOOD.items()], world)
    pages, desktop = tried_in_node(tmp_path, world, before, tried), tried_on_the_desktop(limited(), before, tried)
    assert [(page["words"], page["hash"]) for page in pages] == desktop
    assert any(words.startswith(("in this level hands may not", "not enough")) for words, _ in desktop)


# Every shipped level that says what hands may do, and two that say more.
LIMITED = [path.stem for path in shipped_levels() if read_level(path).hands is not None]
MORE_LIMITED = {
    "tumble_drum": {"bodies": ["sock", "cap"], "at_most": {"grab": 3, "pin": 2}},
    "catapult": {"may": ["cut", "remove", "firmness", "move", "mass", "inflation"], "at_most": {"cut": 4}},
}


@needs_node
@pytest.mark.parametrize(
    "name", some_and_whole(("tumble_drum", "low_door", "pinball_score"), [*LIMITED, *MORE_LIMITED])
)
def test_page_and_desktop_answer_500_random_deeds_of_hands_in_the_same_words(name, tmp_path):
    def limited():
        level = read_level(next(path for path in shipped_levels() if path.stem == name))
        hands = MORE_LIMITED.get(name)
        return build_world(
            replaced(level, hands=PlayerLimits.model_validate_json(json.dumps(hands))) if hands else level
        )

    world, chance = limited(), random.Random(name)
    kinds = [kind for kind in GOOD if kind != "hold_key"]
    tried = []
    for _ in range(500):
        kind = chance.choice(kinds)
        text = re.sub(r"(FREE|SPRING|FORM|AREA|PART)\.\d+", lambda at: f"{at[1]}.{chance.randrange(500)}",
                      json.dumps({"type": kind, **GOOD[kind]}))  # fmt: skip
        tried.append(names_in(json.loads(text), world))
    before = list(those_that_may_be(limited(), names_in(BEFORE, world)))
    pages, desktop = tried_in_node(tmp_path, world, before, tried), tried_on_the_desktop(limited(), before, tried)
    for record, page, said in zip(tried, pages, desktop, strict=True):
        assert (page["words"], page["hash"]) == said, record
    assert len({words for words, _ in desktop}) > 3


@needs_node
def test_the_kernel_itself_refuses_slots_that_are_not_there_in_pages(tmp_path):
    world, point = world_of(), [0, 0]
    beyond = [-1, world.particle_count, 10**6, world.grab_particle, 2**31]
    hands = [-1, 10, 11, 10**6, 2**31]
    tried = [
        *({"type": kind, "particle": slot} for kind in ("pin", "unpin") for slot in beyond),
        *(
            {"type": "grab", "grab": 3, "particle": slot, "target": point, "strength": 1, "radius": 0}
            for slot in beyond
        ),
        *({"type": "grab", "grab": hand, "particle": 0, "target": point, "strength": 1, "radius": 0} for hand in hands),
        *({"type": "move_grab", "grab": hand, "target": point} for hand in hands),
        *({"type": "release", "grab": hand} for hand in hands),
        *({"type": "set_drive", "part": part, "value": 1} for part in (-1, len(world.actuators.names), 10**6)),
        *(
            {"type": kind, "springs": [1, 2, slot]}
            for kind in ("cut_springs", "break_springs", "part_bodies")
            for slot in (-1, world.grab_spring, world.spring_count, 10**6)
        ),
        *(
            {
                "type": kind,
                "body": body,
                "sag": 0.1,
                "whole": 1,
                "way": 0,
                "value": 0.1,
                "second": 0,
                "gravity": [0, -9],
            }
            for kind in ("soften", "set_firmness")
            for body in (-1, 10**6)
        ),
        *({"type": "set_inflation", "body": body, "value": 1} for body in (-1, 10**6)),
        *({"type": "scale_mass", "particle": slot, "factor": 1} for slot in beyond),
        *({"type": "move_body", "particle": slot, "by": point} for slot in beyond),
        *({"type": "free", "particle": slot} for slot in beyond),
        *({"type": "set_solver", "substeps": substeps} for substeps in (3, -1, 128)),
        *({"type": "hold_key", "key": key, "down": 1} for key in (-1, 1, 10**6)),
        {"type": "shake", "acceleration": [NAN, 0]},
        {"type": "push", "position": [0, 0], "radius": INF, "impulse": [0, 0], "outward": 0},
        {"type": "set_coefficients", "stiffness": NAN},
        {"type": "set_gravity", "gravity": [NAN, 0]},
        {"type": "set_air", "drag": NAN},
    ]
    told = tried_in_node(tmp_path, world, names_in(BEFORE, world), tried, are_slots=True)
    for record, page in zip(tried, told, strict=True):
        is_said = page["words"].startswith((f"{record['type']}: ", "there is no "))
        assert is_said and not page["isChanged"], (record, page)
    assert {record["type"] for record in tried} == set(KINDS)


def test_each_command_that_pages_carry_out_is_tried_with_each_of_its_fields():
    made = {"add_particle", "add_spring", "add_body", "remove"}
    assert set(GOOD) == set(filter(is_done_by_pages, COMMAND_TYPES)) - made
    for name, fields in GOOD.items():
        assert set(fields) == {each.name for each in dataclasses.fields(COMMAND_TYPES[name])}, name


def test_there_are_eight_bad_values_and_more_of_every_kind():
    assert all(len(each) >= 8 for each in BAD.values())
    assert {kind for kind in BAD if kind not in COMMAND_TYPES} == {
        "break_springs", "part_bodies", "soften",
    }  # fmt: skip
