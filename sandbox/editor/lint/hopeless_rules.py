"""Rules that can never fire, counters that no rule changes, and goals that anything wins."""

from collections.abc import Iterator

from sandbox.editor.edits.fields import set_level_field
from sandbox.editor.items import Item, Selection
from sandbox.editor.lint.checks import NEVER_NEGATIVE
from sandbox.editor.lint.finding import Finding, Remedy, Rule
from sandbox.editor.rule_text import named_zones
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level
from sandbox.level.rules.rule import QuestionDef


def hopeless_rules(level: Level, scene: Scene) -> Rule:
    """Rules whose question can never hold."""
    counted = {action.count for rule in level.rules for action in rule.then if action.count is not None}
    for rule in level.rules:
        yield None
        fault = _fault(level, scene, rule.when, counted)
        if fault is None:
            continue
        zones: Selection = frozenset(Item("zone", name) for name in named_zones(rule.when))
        box = scene.bounds(zones) if zones else None
        place = None if box is None else ((box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0)
        yield Finding("warning", f'Rule "{rule.id}" never fires: {fault}', zones, place)


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


def _fault(level: Level, scene: Scene, question: QuestionDef, counted: set[str]) -> str | None:
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
    if question.counter is not None and question.counter not in counted:
        # What hands have left changes without rules.
        start = next((counter.start for counter in level.counters if counter.id == question.counter), None)
        low, high = _bounds(question)
        if start is not None and not low <= start <= high:
            return f'no rule counts "{question.counter}", and it starts at {start:g}'
    if question.metric in NEVER_NEGATIVE and question.at_most is not None and question.at_most < 0.0:
        return "what it measures is never below 0"
    low, high = _bounds(question)
    return "its bounds contradict each other" if low > high else _pinned(scene, question)


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
    x, y = scene.position[scene.slot(name)].tolist()
    box = scene.bounds(frozenset([Item("zone", zone)]))
    if box is None or (box[0] <= x <= box[2] and box[1] <= y <= box[3]):
        return None
    return f'"{name}" is pinned outside {zone}'
