"""What rules name, followed as it gets other names, or goes: a rule that names what is gone goes whole."""

from collections.abc import Callable, Sequence
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.quantities import replaced
from sandbox.level.rules.rule import ActionDef, QuestionDef, RuleDef

# What becomes of a name: another one, or None where what it names is gone.
Follow = Callable[[str], str | None]

# Fields of questions and actions that hold the name of a body, a particle, a piece of terrain or a zone.
_OF_QUESTIONS = ("particle", "other", "body", "zone", "crosses", "breaks")
_OF_ACTIONS = ("pin", "unpin", "body")
# Those that name a spring by `body:number` or `:number`, or else a body.
_OF_SPRINGS = ("cut", "drive")
# Parts of a level that hold what rules name.
_NAMED = ("bodies", "particles", "springs", "terrain", "zones", "walls", "counters")


class _GoneError(Exception):
    """Something that a rule names is gone."""


def _same(name: str) -> str:
    return name


def followed(
    rules: Sequence[RuleDef], thing: Follow = _same, counter: Follow = _same, spring: Follow = _same
) -> tuple[RuleDef, ...]:
    """The rules with other names in them: of things, of counters, of loose springs (`:number`)."""
    found = []
    for rule in rules:
        try:
            when = _question(rule.when, thing, counter)
            then = tuple(_action(action, thing, counter, spring) for action in rule.then)
        except _GoneError:
            continue
        is_same = when is rule.when and all(new is old for new, old in zip(then, rule.then, strict=True))
        found.append(rule if is_same else replaced(rule, when=when, then=then))
    return tuple(found)


def with_springs_followed(level: Level, rules: Sequence[RuleDef], kept: Sequence[int]) -> Level:
    """The level with rules whose loose springs are named as they are now; kept: the old index of each, in order."""
    places = {f":{old}": f":{new}" for new, old in enumerate(kept)}
    return _with(level, followed(rules, spring=places.get))


def with_things_followed(level: Level, thing: Follow) -> Level:
    """The level with rules and hands that name things as they are called now; hands let go what is gone."""
    level = _with(level, followed(level.rules, thing))
    if level.hands is None or level.hands.bodies is None:
        return level
    bodies = tuple(name for name in map(thing, level.hands.bodies) if name is not None)
    if bodies == level.hands.bodies:
        return level
    return replaced(level, hands=replaced(level.hands, bodies=bodies))


def lost_rules(before: Level, after: Level) -> list[str]:
    """Names of the rules that are gone from a level as something that they named went."""
    if all(getattr(before, part) is getattr(after, part) for part in _NAMED):
        return []
    there = {rule.id for rule in after.rules}
    return [rule.id for rule in before.rules if rule.id not in there]


def _with(level: Level, rules: tuple[RuleDef, ...]) -> Level:
    is_same = len(rules) == len(level.rules) and all(new is old for new, old in zip(rules, level.rules, strict=True))
    return level if is_same else replaced(level, rules=rules)


def _new(name: str, follow: Follow) -> str:
    new = follow(name)
    if new is None:
        raise _GoneError
    return new


def _changed(part: Any, changes: dict[str, Any]) -> Any:
    changes = {field: new for field, new in changes.items() if new != getattr(part, field)}
    return replaced(part, **changes) if changes else part


def _question(question: QuestionDef, thing: Follow, counter: Follow) -> QuestionDef:
    changes: dict[str, Any] = {
        field: _new(name, thing) for field in _OF_QUESTIONS if (name := getattr(question, field)) is not None
    }
    if question.touches is not None:
        changes["touches"] = tuple(_new(name, thing) for name in question.touches)
    if question.counter is not None:
        changes["counter"] = _new(question.counter, counter)
    for field in question.asked:
        if question.members and field in ("all", "any", "none"):
            members = tuple(_question(member, thing, counter) for member in question.members)
            is_same = all(new is old for new, old in zip(members, question.members, strict=True))
            changes[field] = question.members if is_same else members
    changed: QuestionDef = _changed(question, changes)
    return changed


def _action(action: ActionDef, thing: Follow, counter: Follow, spring: Follow) -> ActionDef:
    changes: dict[str, Any] = {
        field: _new(name, thing) for field in _OF_ACTIONS if (name := getattr(action, field)) is not None
    }
    for field in _OF_SPRINGS:
        name = getattr(action, field)
        if name is not None:
            body, colon, number = name.partition(":")
            changes[field] = _new(body, thing) + colon + number if body else _new(name, spring)
    if action.count is not None:
        changes["count"] = _new(action.count, counter)
    if action.stars is not None and action.stars.counter is not None:
        changes["stars"] = _changed(action.stars, {"counter": _new(action.stars.counter, counter)})
    changed: ActionDef = _changed(action, changes)
    return changed
