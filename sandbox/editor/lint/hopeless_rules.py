"""Rules that can never fire or come too late, counters that no rule changes, and goals that anything wins."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from sandbox.editor.edits.fields import set_level_field
from sandbox.editor.items import Item, Selection
from sandbox.editor.lint.checks import NEVER_NEGATIVE
from sandbox.editor.lint.finding import Finding, Remedy, Rule
from sandbox.editor.rule_text import named_zones
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level
from sandbox.level.kinds.bodies import expansion
from sandbox.level.plan.actuators import driving_keys
from sandbox.level.plan.rules import rule_keys
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.rules.player_limits import DEEDS
from sandbox.level.rules.rule import QuestionDef, RuleDef
from sandbox.session.outcome import vain_goal

# Directions in which it is looked how long a body is.
DIRECTIONS = 36
# What hands do to a body.
_ON_BODIES = {"grab", "pin", "cut", "remove", "move", "push", "firmness", "mass", "material", "inflation"}


def hopeless_rules(level: Level, scene: Scene) -> Rule:
    """Rules whose question can never hold, and wins that come after a loss."""
    counted, rules = _reach(level), run_rules(level)
    for rule in rules:
        yield None
        fault = _fault(level, scene, rule.when, counted)
        if fault is None:
            continue
        zones: Selection = frozenset(Item("zone", name) for name in named_zones(rule.when))
        box = scene.bounds(zones) if zones else None
        place = None if box is None else ((box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0)
        yield Finding("warning", f'Rule "{rule.id}" never fires: {fault}', zones, place)
    wins = [(_time_of(rule, 0.0), rule.id) for rule in rules for action in rule.then if action.win is not None]
    losses = [(_time_of(rule, math.inf), rule.id) for rule in rules for action in rule.then if action.fail is not None]
    if wins and losses and min(losses)[0] < min(wins)[0]:
        (lost, loses), (won, wins_by) = min(losses), min(wins)
        text = f'No run is won: "{loses}" loses it by {lost:g} s, and "{wins_by}" wins at {won:g} s at the earliest'
        yield Finding("warning", text, frozenset(), None)


def _time_of(rule: RuleDef, otherwise: float) -> float:
    """When a rule fires [s], if all that it asks but the time is answered at that time."""

    def of(question: QuestionDef) -> float:
        if question.time is not None:
            return question.time
        times = [of(member) for member in (question.all or question.any or ())]
        return otherwise if not times else max(times) if question.all else min(times)

    return of(rule.when) + rule.for_seconds


def _reach(level: Level) -> dict[str, tuple[float, float]]:
    """The least and the most that rules can count each counter to; what fires again and again has no end."""
    reach = {counter.id: (counter.start, counter.start) for counter in level.counters}
    for rule in run_rules(level):
        times = 1.0 if rule.once or rule.when.time is not None else math.inf
        for action in rule.then:
            if action.count in reach and action.by:
                low, high = reach[action.count]
                by = times * action.by
                reach[action.count] = low + min(by, 0.0), high + max(by, 0.0)
    return reach


def idle_counters(level: Level) -> Rule:
    """Counters that no rule counts."""
    counted = {action.count for rule in level.rules for action in rule.then}
    for counter in level.counters:
        if counter.id not in counted:
            text = f'No rule changes the counter "{counter.id}": let one count it, or delete it'
            yield Finding("hint", text, frozenset(), None)
    yield None


def open_goals(level: Level) -> Rule:
    """A goal that is won by whatever hands do, as they may do everything."""
    if level.leaves_all_open:
        text = "Whoever pauses puts things where they win: say in Hands, on the page Level, what hands may do"
        pulling = {"may": ("grab",), "bodies": level.hands and level.hands.bodies}
        remedy = Remedy("Let hands only pull", lambda document: set_level_field(document, "hands", pulling))
        yield Finding("warning", text, frozenset(), None, remedy)
    yield None


def vain_goals(level: Level) -> Rule:
    """A goal that is told and no rule wins, and one for which nobody can do anything."""
    if vain := vain_goal(level):
        yield Finding("warning", f"{vain}. Add one on the page Rules", frozenset(), None)
    hands = level.hands
    if level.has_goal and hands is not None and not (driving_keys(level) or rule_keys(level)):
        may = set(hands.may or ()) if hands.may is not None else set(DEEDS)
        if not (may - _ON_BODIES if hands.bodies == () else may):
            text = "Hands may do nothing, and there is no key: the level wins by itself or never"
            yield Finding("hint", text, frozenset(), None)
    yield None


def _fault(level: Level, scene: Scene, question: QuestionDef, counted: Mapping[str, tuple[float, float]]) -> str | None:
    """Why a question never holds; None where nothing says so."""
    if question.none:
        return None
    if question.members:
        faults = [_fault(level, scene, member, counted) for member in question.members]
        if question.any:
            return faults[0] if None not in faults else None
        return next((fault for fault in (*faults, *_contradictions(question.members)) if fault is not None), None)
    if question.touches is not None and not level.has_contacts:
        return "nothing touches in this level; turn Contacts on, on the page Level"
    low, high = _bounds(question)
    # What hands have left changes without rules.
    least, most = counted.get(question.counter or "", (-math.inf, math.inf))
    if least == most and not low <= least <= high:
        return f'no rule counts "{question.counter}", and it starts at {least:g}'
    if most < low or least > high:
        return f'rules count "{question.counter}" {f"up to {most:g}" if most < low else f"down to {least:g}"} at most'
    if question.metric in NEVER_NEGATIVE and question.at_most is not None and question.at_most < 0.0:
        return "what it measures is never below 0"
    if low > high:
        return "its bounds contradict each other"
    return _pinned(scene, question) or _too_large(scene, question)


def _bounds(question: QuestionDef) -> tuple[float, float]:
    low, high = question.at_least, question.at_most
    return -float("inf") if low is None else low, float("inf") if high is None else high


def _contradictions(members: tuple[QuestionDef, ...]) -> Iterator[str]:
    """Bounds of the same thing, all of which must hold, that leave nothing between them."""
    kept: dict[tuple[object, ...], tuple[float, float]] = {}
    for member in members:
        if member.metric is None and member.counter is None:
            continue
        key = (member.metric, member.counter, member.particle, member.other, member.body, member.zone)
        low, high = _bounds(member)
        least, most = kept.get(key, (low, high))
        kept[key] = max(low, least), min(high, most)
        if kept[key][0] > kept[key][1]:
            yield "its bounds contradict each other"


def _pinned(scene: Scene, question: QuestionDef) -> str | None:
    """Why a pinned particle never enters a zone that it is not in."""
    zone, name = question.zone or question.crosses, question.particle
    if zone is None or name is None or not scene.pinned[scene.slot(name)]:
        return None
    x, y = scene.place(scene.slot(name))
    box = scene.bounds(frozenset([Item("zone", zone)]))
    if box is None or (box[0] <= x <= box[2] and box[1] <= y <= box[3]):
        return None
    return f'"{name}" is pinned outside {zone}'


def _too_large(scene: Scene, question: QuestionDef) -> str | None:
    """Why a body that keeps its form is never inside a zone, however it turns."""
    body = next((body for body in scene.level.bodies if body.id == question.body), None)
    if question.metric != "inside" or question.zone is None or body is None or not expansion(body).may_be_stiff:
        return None
    box = scene.bounds(frozenset([Item("zone", question.zone)]))
    turns = np.linspace(0.0, np.pi, DIRECTIONS, endpoint=False)
    across = expansion(body).form @ np.stack([np.cos(turns), np.sin(turns)])
    long = float(np.ptp(across, axis=0).max())
    if box is None or long <= math.dist(box[:2], box[2:]):
        return None
    return f'"{body.id}" is {long:.2g} m long, and {question.zone} is {math.dist(box[:2], box[2:]):.2g} m across'
