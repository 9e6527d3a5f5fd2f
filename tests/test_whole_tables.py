"""Tables over what is closed are whole: each enum, kind and code has its entry, or gets what is listed below.

Dicts, `match` and chains of `if` are found by themselves, in all of the package: who adds a member is told here of
every place that has to know it.
"""

import ast
import functools
import importlib
import pkgutil
import re
from collections import defaultdict
from typing import get_args

import numpy as np
import pytest

import sandbox
from sandbox.app.draw import scene, textures
from sandbox.app.draw.colours import ThemeName
from sandbox.app.draw.looks import STRANDS
from sandbox.app.share.playing import NOT_MEASURED
from sandbox.app.sound import sound_events, waves
from sandbox.editor.items import Kind as ItemKind
from sandbox.editor.lint.finding import Severity
from sandbox.editor.panel import rule_form
from sandbox.editor.panel.field_info import Kind as FieldKind
from sandbox.editor.panel.field_info import Pick
from sandbox.editor.pick import Mode
from sandbox.editor.rule_text import rule_text
from sandbox.editor.tools.snap import Kind as SnapKind
from sandbox.level.checks import SUBJECTS, Metric
from sandbox.level.faults import reference_faults
from sandbox.level.format.look import BALLS, GROUNDS, LINES, SKINS
from sandbox.level.kinds.bodies import KINDS as BODY_KINDS
from sandbox.level.kinds.jelly import SHAPES
from sandbox.level.plan import rules
from sandbox.level.rules.player_limits import DEEDS
from sandbox.level.rules.rule import ASKS, DOES, GROUPS, UNASKED, Sound
from sandbox.page import start
from sandbox.page.bundle import WEB
from sandbox.physics import constraints, marks, settings, zones
from sandbox.physics import rules as rule_codes
from sandbox.physics.analysis.query import row_names, slot_name
from sandbox.physics.commands import command, command_table
from sandbox.physics.pipeline import block, tick
from sandbox.physics.settings import SOLVER_NAMES
from sandbox.physics.snapshot import hash_by_array, leave, restore, take
from sandbox.physics.softness.settling import Support
from sandbox.physics.state import COLUMNS, Family
from sandbox.session import event_log
from sandbox.session.commands import Grab
from sandbox.session.commands.command import COMMAND_TYPES
from sandbox.session.commands.records import ScriptLine
from sandbox.session.compare.divergence import differing_particle, first_difference
from sandbox.session.replay.recording import _place as place_of
from sandbox.session.session import Session
from tests.support.rules_level import answering, run
from tests.test_architecture import sources

# What is closed, by strings and enums ...
MEMBERS = {
    "families": Family, "supports": Support, "commands": COMMAND_TYPES, "kernels of commands": command_table.KINDS,
    "solvers": SOLVER_NAMES, "questions": ASKS, "groups of questions": GROUPS, "actions": DOES, "deeds": DEEDS,
    "sounds": get_args(Sound), "metrics": get_args(Metric), "kinds of bodies": BODY_KINDS, "shapes": SHAPES,
    "skins": SKINS, "lines": LINES, "balls": BALLS, "grounds": GROUNDS, "themes": get_args(ThemeName),
    "items": get_args(ItemKind), "severities": get_args(Severity), "fields": get_args(FieldKind),
    "picks": get_args(Pick), "modes of picking": get_args(Mode), "snaps": get_args(SnapKind),
}  # fmt: skip
CLOSED = {name: frozenset(members) for name, members in MEMBERS.items()}


def code_names(module, *firsts):
    """The names that a module gives to numbers in the same assignments as the first ones."""
    names = []
    for node in sources()[module.__name__].body:
        targets = node.targets[0] if isinstance(node, ast.Assign) else ast.Tuple([])
        together = [each.id for each in getattr(targets, "elts", [targets]) if isinstance(each, ast.Name)]
        names += together if set(together) & set(firsts) else []
    return frozenset(names)


# ... and by names of numbers.
CODES = {
    "codes of a tick": code_names(tick, "FINISHED"),
    "kinds of constraints": code_names(constraints, "AREA", "BEND"),
    "laws": code_names(marks, "LAW_NISSEN"),
    "edges": code_names(marks, "NO_EDGE"),
    "codes of solvers": code_names(settings, "SINGLE_PASS"),
    "kinds of zones": code_names(zones, "BOX"),
    "codes of commands": code_names(command, "GRAB", "SET_GRAVITY", "SET_SOLVER"),
    "kinds of terms": code_names(rule_codes, "TOUCHES", "SETTLED"),
}
RULES = CODES["kinds of terms"]
OF_CENTRE = {"CENTRE_X", "CENTRE_Y", "SPEED"}
OF_TERMS = {"ALL", "ANY", "NOT"}
# What a table or a chain does not name of its set, one by one: it was looked at what these get there.
REST = {
    # As many rows as there can be particles.
    "sandbox.session.replay.format.MOST_ROWS": {
        Family.ACTUATOR, Family.COUNTER, Family.DEED, Family.KEY, Family.PROBE, Family.RULE, Family.SETTING,
        Family.STILL,
    },
    # They go on: who steps has nothing to answer.
    "sandbox.physics.step.step: code": {"FINISHED"},
    # Kernels do not raise; what is set is in range (settings.py).
    "sandbox.physics.pipeline.derive.derive_hands: solver": {"ITERATIVE"},
    "sandbox.physics.pipeline.derive._lay_out_solver: solver": {"SINGLE_PASS"},
    "sandbox.physics.pipeline.tick._solve: solver": {"DIRECT"},
    "sandbox.physics.zones.depth_inside: kind": {"POLYGON"},
    "sandbox.physics.zones.span_inside: kind": {"POLYGON"},
    "sandbox.physics.rules.measure: kind": OF_CENTRE | OF_TERMS | {"TOUCHES"},
    "sandbox.physics.rules._of_centre: kind": RULES - OF_CENTRE,
    "sandbox.physics.pipeline.rule_evaluation._holds_of_members: terms.kind[t]": RULES - {"ALL", "ANY"},
    # They have kernels of their own.
    "sandbox.physics.commands.command._carry_out: kind": {"ADD_BODY", "ADD_PARTICLE", "ADD_SPRING", "REMOVE"},
    "sandbox.level.plan.rules._of_metric: kind": RULES - {"SETTLED", "DISTANCE", "INSIDE"},
    # No rim of a solid.
    "sandbox.export.flat._outlines_of: edges": {"LINE", "NO_EDGE"},
    "sandbox.level.kinds.expansion.outline_of: edges": {"LINE", "NO_EDGE"},
    "sandbox.physics.collision.pieces._find_soft: state.edge[s]": {"LINE", "NO_EDGE"},
    "sandbox.physics.commands.cutting._is_border: state.edge[s]": {"LINE", "NO_EDGE"},
    # Those that run from their first end to their second.
    "sandbox.app.draw.things.belt_marks.body_belts: state.edge[running]": {"SOLID_LEFT", "NO_EDGE"},
    # How far the lowest point is down.
    "sandbox.physics.softness.settling._drop: body.support": {
        Support.ARM, Support.HANGING, Support.HUB, Support.SPANNED
    },
    "sandbox.session.event_log._EACH": event_log._WORDS.keys() | event_log._PASSED_OVER | {"grab", "release"},
    "sandbox.session.event_log._WORDS": event_log._EACH.keys() | event_log._PASSED_OVER | {"grab", "release"},
    # Picked by other means: the particle that is nearest, a box that is drawn, nothing.
    "sandbox.app.edit.canvas.picking._HINTS": {""},
    "sandbox.app.edit.canvas.picking._KINDS": {"particle", "box", ""},
    # Have no tile: coils are drawn by wire.
    "sandbox.app.draw.textures._TILES": {"coil", "hidden"},
    "sandbox.app.draw.things.members.HALF": set(LINES) - set(STRANDS),
    # No tag, and no line of its own.
    "sandbox.app.edit.canvas.overlay.draw_snap: snapped.kind": {"grid"},
}  # fmt: skip
# Tables and chains of exceptions: whoever comes is usual there, and they say how.
EXCEPTIONS = {
    "sandbox.app.draw.colours.PAINTS", "sandbox.app.draw.looks._skin: body.type",
    "sandbox.app.draw.looks._line: body.type", "sandbox.app.draw.backdrop._draw_solids: kind",
    "sandbox.app.draw.scene._solid: kind",
    "sandbox.app.draw.scene._body: actor.body.type", "sandbox.app.draw.things.drawables._add: kind",
    "sandbox.app.draw.things.members._LINES", "sandbox.app.draw.things.members._BOLTS",
    "sandbox.app.draw.things.members._PLAIN", "sandbox.app.draw.things.soft.shape_of: look.skin",
    "sandbox.app.draw.things.members.PERIOD", "sandbox.app.draw.things.members._STRAND_LINES",
    # A field of text, or with a value in it.
    "sandbox.app.draw.things.worn.round_of: actor.body.type", "sandbox.app.widgets.property_widgets._make: about.kind",
    "sandbox.app.widgets.property_widgets._pick: each.about.kind",
    "sandbox.app.widgets.property_widgets._show_value: each.about.kind",
    "sandbox.app.widgets.property_widgets._rows: about.kind", "sandbox.editor.panel.properties._made: about.kind",
    "sandbox.editor.panel.property._text: about.kind", "sandbox.editor.range_trial._numbers: about.kind",
    # Places of what commands have, -1 where they have none; what may be amiss with some alone.
    *(f"sandbox.physics.commands.command.{name}: kind" for name in (
        "_first_bad", "_place_of_particle", "_place_of_duration", "_unfit", "_not_for_hands", "_soften",
    )),
    # What has slots of hands reserved, and what changes settings; other commands have nothing beside their kernel.
    "sandbox.physics.world.command: name",
    # What other kernels than that of commands call things.
    "sandbox.session.commands.command._THINGS",
    # Asks `_first_action`, which raises.
    "sandbox.editor.panel.action_form._set_does: value",
}  # fmt: skip


def modules():
    """All modules of the package, by their names."""
    found = pkgutil.walk_packages(sandbox.__path__, "sandbox.")
    return [importlib.import_module(each.name) for each in found if not each.name.endswith("__main__")]


def missing(keys, sets):
    """Of each set that has all keys and two of them at least: its members without one. Nothing: of no set."""
    return {name: members - keys for name, members in sets.items() if len(keys) > 1 and keys <= members}


def dict_tables():
    """Every dict of a module of which all keys are members of a closed set: its place, and what each set misses."""
    seen = set()
    for module in modules():
        for name, value in vars(module).items():
            if type(value) is dict and id(value) not in seen:
                seen.add(id(value))
                if found := missing(frozenset(value), CLOSED):
                    yield f"{module.__name__}.{name}", found


def _compared(node):
    """The subject of a comparison, or of a match; what it is compared with; whether that is its turn, no exception."""
    if isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.Eq | ast.Is | ast.In | ast.NotEq | ast.IsNot):
        yield ast.unparse(node.left), node.comparators[0], isinstance(node.ops[0], ast.Eq | ast.Is | ast.In)
    elif isinstance(node, ast.Match):
        for case in node.cases:
            for each in ast.walk(case.pattern):
                if isinstance(each, ast.MatchValue):
                    yield ast.unparse(node.subject), each.value, True


def _values(node):
    """Strings, and names of codes or of members of an enum, in what is compared with."""
    parts = node.elts if isinstance(node, ast.Tuple | ast.Set) else [node]
    for part in parts:
        if isinstance(part, ast.Constant) and isinstance(part.value, str):
            yield part.value
        elif isinstance(part, ast.Name):
            yield part.id
        elif isinstance(part, ast.Attribute):
            owner, enums = ast.unparse(part.value), {"Family": Family, "Support": Support}
            yield getattr(enums[owner], part.attr) if owner in enums else part.attr


def _raises(function):
    """Whether what no branch of a function has raises."""
    calls = [each.func for each in ast.walk(function) if isinstance(each, ast.Call)]
    ends = [each.orelse[-1] for each in ast.walk(function) if isinstance(each, ast.If) and each.orelse]
    return (
        any(isinstance(each, ast.Name) and each.id == "assert_never" for each in calls)
        or any(isinstance(each, ast.Raise) for each in [*ends, *function.body])
    )  # fmt: skip


def chains():
    """Every function that compares something with members of a closed set in turn, and that does not raise."""
    sets = CLOSED | CODES
    for module, tree in sources().items():
        for function in ast.walk(tree):
            if not isinstance(function, ast.FunctionDef) or _raises(function):
                continue
            named, turns = defaultdict(set), defaultdict(set)
            for node in ast.walk(function):
                for subject, value, is_turn in _compared(node):
                    values = frozenset(_values(value))
                    named[subject] |= values
                    turns[subject] |= {values} if is_turn else set()
            for subject, values in named.items():
                # In one comparison alone something is asked of a member: that is no table.
                if len(turns[subject]) > 1 and (found := missing(values, sets)):
                    yield f"{module}.{function.name}: {subject}", found


def not_whole(tables):
    """Tables without all members of any set that has all of theirs, by place, with what each set has more."""
    return {place: found for place, found in tables if all(found.values())}


@functools.cache
def found():
    """All tables and chains that are not whole."""
    return not_whole([*dict_tables(), *chains()])


def test_every_table_over_what_is_closed_is_whole_or_was_looked_at():
    told = []
    for place, sets in found().items():
        if place in EXCEPTIONS:
            continue
        left = {name: sorted(map(str, more - REST.get(place, frozenset()))) for name, more in sets.items()}
        if all(left.values()):
            told.append(f"{place}: of {' or '.join(f'{name}: {members}' for name, members in left.items())}")
    assert not told, "give them an entry, or an else that raises, or say in REST what they get:\n" + "\n".join(told)


def test_what_is_said_of_tables_is_of_tables_that_there_are_and_no_more_than_they_leave_out():
    assert (EXCEPTIONS | REST.keys()) <= found().keys()
    for place, rest in REST.items():
        assert any(rest <= more for more in found()[place].values()), place


SHAPE_SKINS, WHEEL_SKINS = {"window", "flat"}, {"tyre", "steel wheel"}
# Strands that are heard as strings, and lines that a page draws in other ways.
STRINGS = set(STRANDS) - {"deck", "chain"}
OTHERWISE = {"paint", "coil", "muscle", "hidden"}
METRICS = CLOSED["metrics"]


def keys_in_page(module, name):
    """The keys of an object that a module of pages has at its top."""
    text = (WEB / f"{module}.js").read_text(encoding="utf-8")
    inside = re.search(rf"^const {name} = {{(.*?)}};$", text, re.DOTALL | re.MULTILINE)[1]
    depth, flat = 0, ""
    for letter in re.sub(r"`[^`]*`|'[^']*'", "", inside):
        depth += (letter in "([{") - (letter in ")]}")
        flat += letter if depth == 0 else ""
    return set(re.findall(r"(?:^|,)\s*(\w+):", flat))


@pytest.mark.parametrize(
    ("keys", "members"),
    [
        (rules._KINDS, METRICS - set(UNASKED) | set(GROUPS)),
        (rule_form._ASKS, set(ASKS) | set(GROUPS) | {"inside"}),
        (reference_faults._NOUNS, {*SUBJECTS, "zone"}),
        (textures._SKINS, {*SKINS} | SHAPE_SKINS | WHEEL_SKINS),
        (sound_events._SKINS, {*SKINS} - {"lattice"} | WHEEL_SKINS),
        (sound_events._LINES, {*LINES} - STRINGS | {"piston"}),
        (waves.MAKERS, waves.LEVELS.keys() | waves.SIGNAL_LEVELS),
        (waves.SIGNAL_LEVELS, {*get_args(Sound), "won", "lost", "star"}),
        (
            waves.STUFFS,
            {*sound_events._SKINS.values(), *sound_events._LINES.values(), *sound_events._BALLS.values(), "cloth"},
        ),
        (start.CODES, CODES["codes of a tick"]),
        (start.PROGRESS, code_names(block, "TICK") - {"PROGRESS"}),
        (constraints.CONSTRAINT_NAMES, range(len(CODES["kinds of constraints"]))),
        (settings.NUMBER_NAMES, [name.lower().replace("_", " ") for name in code_names(settings, "DRAG")]),
        (command_table.CODES.values(), range(len(CODES["codes of commands"]))),
        (keys_in_page("checks", "METRICS"), METRICS - set(NOT_MEASURED)),
        (keys_in_page("paint", "LINES"), {*LINES} - OTHERWISE),
        (keys_in_page("paint", "MARKS"), {*BALLS} - {"bumper", "plain"}),
        (keys_in_page("paint", "GRAINS"), {grain for kind in GROUNDS if (grain := scene._solid(kind)["grain"])}),
    ],
)  # fmt: skip
def test_a_table_that_has_other_entries_too_has_one_of_each_member(keys, members):
    assert set(keys) == set(members)


@pytest.fixture(scope="module")
def world():
    """A world with rows of every family, some ticks after its start."""
    session = Session(answering())
    run(session, 90)
    session.submit(Grab(0, session.world.particle_slot("ball"), (0.0, 2.0)))
    session.advance()
    assert not [family for family in Family if not row_names(session.world, family)]
    return session.world


@pytest.mark.parametrize("column", COLUMNS, ids=[column.stored for column in COLUMNS])
def test_a_difference_in_any_array_is_told_by_the_name_of_its_row(world, column):
    present = getattr(world, column.name)
    row = len(present) - 1
    wanted = present.copy()
    wanted[row] = ~wanted[row] if wanted.dtype == np.bool_ else wanted[row] + 1
    found = first_difference(world.tick, column.stored, wanted, world, world)
    name = slot_name(world, column.stored, row)
    assert name and found.name == name and f"({name})" in str(found)
    assert f"of {found.owner()}" in found.lines()
    assert found.owner()
    particle = differing_particle(found, take(world))
    assert particle is None or 0 <= particle < world.particle_count
    shorter = first_difference(world.tick, column.stored, present[:-1], world, world)
    assert str(shorter).endswith(f"expected {row} values, got {row + 1} values")


@pytest.mark.parametrize("column", COLUMNS, ids=[column.stored for column in COLUMNS])
def test_what_a_program_wrote_into_any_array_is_told_by_the_name_of_its_row(world, column):
    before, left = take(world), leave(world, hash_by_array(world))
    present = getattr(world, column.name)
    present[-1] = ~present[-1] if present.dtype == np.bool_ else present[-1] + 1
    row = len(present) - 1
    wanted = f"{column.stored}[{row}] ({slot_name(world, column.stored, row)})"
    told = place_of(column.stored, left, world)
    restore(world, before)
    assert told == wanted


def test_rows_of_rules_go_by_the_names_that_the_level_gives_them(world):
    assert row_names(world, Family.RULE)[:2] == ['rule "goal"', 'rule "through"']
    assert row_names(world, Family.COUNTER) == ['counter "score"']
    assert row_names(world, Family.PROBE) == ['way of ball for rule "through"']
    assert row_names(world, Family.STILL) == ['settling for rule "still"']
    assert row_names(world, Family.KEY) == ['key "g"']


def test_every_action_and_question_of_rules_is_told_and_given_to_pages(world):
    level = answering()
    actions = [action for rule in level.rules for action in rule.then]
    assert {action.done[0] for action in actions} == set(DOES)
    assert set(ASKS) <= {name for rule in level.rules for name in asked_in(rule.when)}
    assert all(map(rule_text, level.rules)) and all(map(event_log._action_text, actions))
    assert len(start.about(world, 1)["rules"]) == len(level.rules)


def asked_in(question):
    """The fields of ASKS that a question and its members have."""
    return [*question.asked, *(name for member in question.members for name in asked_in(member))]


@pytest.mark.parametrize("kind", COMMAND_TYPES)
def test_what_a_person_does_by_any_command_is_told_in_words_or_passed_over(kind):
    record = {"type": kind, "particle": "red.1", "grab": 0, "springs": ["red:1"], "part": "cart", "value": 1.0}
    before = [ScriptLine(1, 1, record | {"type": "grab"}, 1)] if kind == "release" else []
    told = list(event_log.user_actions([*before, ScriptLine(2, 2, record, 2)]))[len(before) :]
    assert bool(told) == (kind not in event_log._PASSED_OVER)
    assert not any("_" in each.text for each in told)
