"""Rules and counters: adding whole ones by a template, changing and deleting them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, checked, first_fault
from sandbox.editor.edits.fields import with_tuples
from sandbox.editor.edits.names import followed, free_ids
from sandbox.editor.items import chosen_bodies, chosen_particles, chosen_zones
from sandbox.editor.rule_text import listed
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import shown
from sandbox.level.format.quantities import replaced
from sandbox.level.plan.run_rules import members_of
from sandbox.level.rules.rule import CounterDef, RuleDef

# What a new rule says, and the key that a new one asks for.
WON, LOST = "Done!", "Lost."
FIRST_KEY = "g"
# How long [s] something must be in a goal.
STAY = 0.5


# A rule, or a part of one, as plain values.
RuleData = dict[str, Any]


class Template(NamedTuple):
    """A rule to begin with: a sentence with what the level has in it, and the edit; None: why it cannot be had."""

    text: str
    edit: Callable[[Document], Document] | None


def read_rule(data: Mapping[str, Any]) -> RuleDef:
    """A rule of plain values. Raises EditError."""
    try:
        return RuleDef.model_validate(with_tuples(dict(data)))
    except ValidationError as error:
        raise EditError(first_fault(error, shown(data["id"]), 0)) from None


def plain(rule: RuleDef) -> dict[str, Any]:
    """A rule as plain values, without defaults."""
    return rule.model_dump(exclude_defaults=True)


def set_rules(document: Document, rules: Sequence[RuleDef]) -> Document:
    """Replace the level's rules. Raises EditError."""
    return replace(document, level=checked(replaced(document.level, rules=tuple(rules))))


def add_rule(document: Document, data: Mapping[str, Any]) -> Document:
    """Add a rule of plain values, by a free name. Raises EditError."""
    (name,) = free_ids({rule.id for rule in document.level.rules}, [str(data["id"])])
    return set_rules(document, [*document.level.rules, read_rule({**data, "id": name})])


def change_rule(document: Document, index: int, change: Callable[[Level, RuleData], RuleData]) -> Document:
    """The document with a rule that is what `change` makes of its plain values. Raises EditError."""
    rules = list(document.level.rules)
    data = change(document.level, plain(rules[index]))
    others = [rule.id for k, rule in enumerate(rules) if k != index]
    if data["id"] in others:
        raise EditError(f'there is a rule "{data["id"]}" already')
    rules[index] = read_rule(data)
    return set_rules(document, rules)


def delete_rule(document: Document, index: int) -> Document:
    """Delete a rule by its index."""
    return set_rules(document, [rule for k, rule in enumerate(document.level.rules) if k != index])


def add_counter(document: Document, text: str = "Score") -> Document:
    """Add a counter that players see. Raises EditError."""
    taken = {counter.id for counter in document.level.counters}
    (name,) = free_ids(taken, [text.lower()])
    counters = (*document.level.counters, CounterDef(id=name, text=text))
    return replace(document, level=checked(replaced(document.level, counters=counters)))


def delete_counter(document: Document, index: int) -> Document:
    """Delete a counter by its index, and the rules that ask for it or count it."""
    level = document.level
    gone = level.counters[index].id
    rules = followed(level.rules, counter=lambda name: None if name == gone else name)
    counters = tuple(each for k, each in enumerate(level.counters) if k != index)
    return replace(document, level=checked(replaced(level, counters=counters, rules=rules)))


def change_counter(document: Document, index: int, field: str, value: Any) -> Document:
    """Give a counter another name, start or text; rules follow. Raises EditError."""
    level, old = document.level, document.level.counters[index]
    try:
        new = CounterDef.model_validate({**old.__dict__, field: value})
    except ValidationError as error:
        raise EditError(first_fault(error, shown(old.id), 0)) from None
    counters = tuple(new if k == index else each for k, each in enumerate(level.counters))
    rules = followed(level.rules, counter=lambda name: new.id if name == old.id else name)
    return replace(document, level=checked(replaced(level, counters=counters, rules=rules)))


def subject_of(level: Level, name: str) -> dict[str, str]:
    """The field of a question that names a body, or else a particle."""
    return {"body" if any(body.id == name for body in level.bodies) else "particle": name}


def duplicate_rule(document: Document, index: int) -> Document:
    """Put a copy of a rule behind it, by a free name."""
    rules = list(document.level.rules)
    (name,) = free_ids({rule.id for rule in rules}, [rules[index].id])
    return set_rules(document, [*rules[: index + 1], replaced(rules[index], id=name), *rules[index + 1 :]])


def chosen_movers(document: Document) -> list[str]:
    """Names of the selected bodies and loose particles; of a group that is selected whole, the group's."""
    level, members = document.level, members_of(document.level)
    movers: list[Any] = [*chosen_particles(level, document.selection), *chosen_bodies(level, document.selection)]
    chosen = {part.id for part in movers}
    whole = {part.group for part in movers if part.group is not None and chosen.issuperset(members[part.group])}
    return list(dict.fromkeys(part.group if part.group in whole else part.id for part in movers))


def templates(document: Document) -> list[Template]:
    """Rules to begin with, filled in with all that is selected, or with what was drawn last."""
    level, selection, members = document.level, document.selection, members_of(document.level)
    zones = chosen_zones(level, selection) or list(level.zones)
    zone = zones[-1].id if zones else None
    there = [*(part.id for part in level.particles if not part.pinned), *(body.id for body in level.bodies)]
    names = chosen_movers(document) or [*there, *(part.id for part in level.particles)][:1]
    things = members.things(names)
    ground = [piece.id for piece in level.terrain] + [body.id for body in level.bodies if body.id not in things]
    other = ground[0] if ground else "walls" if level.walls is not None else None
    bodies = chosen_bodies(level, selection) or list(level.bodies)
    body, is_one = bodies[0].id if bodies else None, len(things) < 2

    def made(
        name: str, many: str, when: RuleData, then: list[RuleData] | None = None, **more: Any
    ) -> Callable[[Document], Document]:
        """Adds a rule of the thing, or of any, all or each of several; then: None = it counts."""

        def edit(document: Document) -> Document:
            if then is None and not document.level.counters:
                document = add_counter(document)
            subject: RuleData = {many: tuple(names)}
            if is_one and "touches" in when:
                subject = {"touches": (things[0], *when["touches"])}
            elif is_one:
                subject = subject_of(level, things[0])
            does = then or [{"count": document.level.counters[0].id}, {"sound": "bell"}]
            return add_rule(document, {"id": name, "when": {**when, **subject}, "then": does, **more})

        return edit

    def of(data: RuleData) -> Callable[[Document], Document]:
        return lambda document: add_rule(document, data)

    what, where, has_zone = listed(names) if names else "a thing", zone or "a zone", bool(things and zone)
    all_of, any_of, each_of = ("", "", "") if is_one else ("all of ", "any of ", "each of ")
    inside, crosses = {"metric": "inside", "zone": zone}, {"crosses": zone}
    found = [
        (f"Goal: {all_of}{what} {'is' if is_one else 'are'} inside {where}", has_zone,
         made("goal", "all_of", inside, [{"win": WON}], for_seconds=STAY)),
        (f"Lost when {any_of}{what} crosses {where}", has_zone, made("lost", "any_of", crosses, [{"fail": LOST}])),
        (f"Count {each_of}{what} once in {where}", has_zone, made("count", "each_of", crosses, once=True)),
        (f"Count {each_of}{what} once at a touch of {other or 'another thing'}", bool(things and other),
         made("count", "each_of", {"touches": (other,)}, once=True)),
        (f"When key {FIRST_KEY.upper()}: cut {body or 'a body'}", body is not None,
         of({"id": "key", "when": {"key": FIRST_KEY}, "then": [{"cut": body}]})),
        ("After 30 s: lost", True, of({"id": "time", "when": {"time": 30.0}, "then": [{"fail": "Time is up."}]})),
    ]  # fmt: skip
    return [Template(text, edit if is_there else None) for text, is_there, edit in found]


def why_not(document: Document) -> str:
    """A line about what the level lacks for the templates; empty where it has all."""
    level = document.level
    if not (level.bodies or level.particles):
        return "Draw something that moves first, such as a particle with a radius: a ball."
    return "" if level.zones else "Draw a zone first: the tool Zone, below the tools of the ground."
