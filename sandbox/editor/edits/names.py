"""Names: free ids, and references wherever a level holds them; a rule that names what is gone goes whole."""

import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.limits import TEXT_LIMIT
from sandbox.level.format.quantities import replaced
from sandbox.level.plan.run_rules import members_of, several
from sandbox.level.rules.rule import ActionDef, QuestionDef, RuleDef

# What becomes of a reference or a name: another one, or None where what it names is gone.
Rewire = Callable[[str], str | None]

# What a number at the end of an id looks like; a copy of "rope 2" is "rope 3".
_NUMBERED = re.compile(r"(.*\S) ([1-9][0-9]{0,8})")

# Fields of questions and actions that hold the name of a body, a particle, a piece of terrain or a zone.
_OF_QUESTIONS = ("particle", "other", "body", "zone", "crosses", "breaks")
_OF_ACTIONS = ("pin", "unpin", "body")
# Those that name a spring by `body:number` or `:number`, or else a body.
_OF_SPRINGS = ("cut", "drive")
# Parts of a level that hold what rules name.
_NAMED = ("bodies", "particles", "springs", "terrain", "zones", "walls", "counters")


def taken_ids(level: Level) -> set[str]:
    """Ids of a level's bodies, loose particles, terrain and zones."""
    return {part.id for parts in (level.bodies, level.particles, level.terrain, level.zones) for part in parts}


def free_id(level: Level, base: str) -> str:
    """The id itself where it is free, else with the lowest free number from 2: "rope 2"."""
    return free_ids(taken_ids(level), [base])[0]


def free_ids(taken: set[str], names: Iterable[str]) -> list[str]:
    """A free id for each of those that are wanted, different from each other; `taken` grows by them."""
    numbers: dict[str, int] = {}
    found = []
    for name in names:
        if name in taken:
            match = _NUMBERED.fullmatch(name)
            base = match[1] if match else name
            number = numbers.get(base, 2)
            while (name := f"{base[: TEXT_LIMIT - 11]} {number}") in taken:
                number += 1
            numbers[base] = number + 1
        taken.add(name)
        found.append(name)
    return found


def owner_of(reference: str) -> str:
    """Id of the thing that a reference names: of a particle its body."""
    return reference.partition(".")[0]


def with_owner(reference: str, owner: str) -> str:
    """The reference as one to the same particle of another body, or to another loose particle."""
    _, dot, part = reference.partition(".")
    return owner + dot + part


def renamed(ids: dict[str, str]) -> Rewire:
    """References to bodies, loose particles, terrain and zones by their new ids."""
    return lambda reference: with_owner(reference, ids.get(owner_of(reference), owner_of(reference)))


def rewired(level: Level, change: Rewire) -> tuple[Level, list[int]]:
    """Change every reference of springs, welds, checks, rules and the camera; what refers to what is gone goes too.

    Also the old indices of the springs that stay.
    """
    springs, kept = [], []
    for index, spring in enumerate(level.springs):
        a, b = change(spring.a), change(spring.b)
        if a is not None and b is not None:
            springs.append(spring if (a, b) == (spring.a, spring.b) else replaced(spring, a=a, b=b))
            kept.append(index)
    welds = []
    for first, second in level.welds:
        a, b = change(first), change(second)
        if a is not None and b is not None:
            welds.append((a, b))
    checks = []
    for check in level.checks:
        old = {field: name for field in ("particle", "other", "body") if (name := getattr(check, field)) is not None}
        new = {field: change(name) for field, name in old.items()}
        if new == old:
            checks.append(check)
        elif None not in new.values():
            checks.append(replaced(check, **new))
    level = replaced(level, springs=tuple(springs), welds=tuple(welds), checks=tuple(checks))
    level = with_things_followed(with_springs_followed(level, level.rules, kept), change)
    return _with_companion(level, change), kept


def _with_companion(level: Level, change: Rewire) -> Level:
    """The level with what its camera goes along with: of a body that is gone its first particle, or nothing."""
    look = level.look
    if look is None or look.follow is None:
        return level
    there = {part.id for parts in (level.bodies, level.particles) for part in parts}
    target = next((name for name in (change(look.follow), change(f"{look.follow}.0")) if name in there), None)
    return level if target == look.follow else replaced(level, look=replaced(look, follow=target))


class _GoneError(Exception):
    """A rule names something that is gone."""


def _same(name: str) -> str:
    return name


def followed(
    rules: Sequence[RuleDef],
    thing: Rewire = _same,
    counter: Rewire = _same,
    spring: Rewire = _same,
    one_of: Rewire | None = None,
) -> tuple[RuleDef, ...]:
    """The rules with other names in them: of things, of counters, of loose springs (`:number`).

    one_of: of what stands among several, of which the rest stays; None: as of things.
    """
    found = []
    for rule in rules:
        try:
            when = _question(rule.when, thing, counter, one_of or thing)
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


def with_things_followed(level: Level, thing: Rewire) -> Level:
    """The level with rules and hands that name things as they are called now; hands let go what is gone."""
    there = members_of(level)

    def one_of(name: str) -> str | None:
        new = thing(name)
        return new if new in there else None

    level = _with(level, followed(level.rules, thing, one_of=one_of))
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


def _new(name: str, follow: Rewire) -> str:
    new = follow(name)
    if new is None:
        raise _GoneError
    return new


def _changed(part: Any, changes: dict[str, Any]) -> Any:
    changes = {field: new for field, new in changes.items() if new != getattr(part, field)}
    return replaced(part, **changes) if changes else part


def _question(question: QuestionDef, thing: Rewire, counter: Rewire, one_of: Rewire) -> QuestionDef:
    changes: dict[str, Any] = {
        field: _new(name, thing) for field in _OF_QUESTIONS if (name := getattr(question, field)) is not None
    }
    field, names = several(question)
    if field:
        changes[field] = tuple(new for new in map(one_of, names) if new is not None)
        if not changes[field]:
            raise _GoneError
    if question.touches is not None:
        changes["touches"] = tuple(_new(name, thing) for name in question.touches)
    if question.counter is not None:
        changes["counter"] = _new(question.counter, counter)
    for field in question.asked:
        if question.members and field in ("all", "any", "none"):
            members = tuple(_question(member, thing, counter, one_of) for member in question.members)
            is_same = all(new is old for new, old in zip(members, question.members, strict=True))
            changes[field] = question.members if is_same else members
    changed: QuestionDef = _changed(question, changes)
    return changed


def _action(action: ActionDef, thing: Rewire, counter: Rewire, spring: Rewire) -> ActionDef:
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
