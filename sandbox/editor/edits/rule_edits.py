"""Rules and counters: adding whole ones by a template, changing and deleting them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from pydantic import ValidationError

from sandbox.editor.document import Document, EditError, checked, first_fault
from sandbox.editor.edits.fields import with_tuples
from sandbox.editor.edits.names import followed, free_ids
from sandbox.editor.items import chosen_bodies, chosen_particles, chosen_zones
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import shown
from sandbox.level.format.quantities import replaced
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


def templates(document: Document) -> list[Template]:
    """Rules to begin with, filled in with what is selected, or was drawn last."""
    level, selection = document.level, document.selection
    zones = chosen_zones(level, selection) or list(level.zones)
    zone = zones[-1].id if zones else None
    balls: list[Any] = [*chosen_particles(level, selection), *chosen_bodies(level, selection)]
    balls += [part for part in level.particles if not part.pinned]
    thing = next((part.id for part in [*balls, *level.bodies, *level.particles]), None)
    ground = [piece.id for piece in level.terrain] + [body.id for body in level.bodies if body.id != thing]
    other = ground[0] if ground else "walls" if level.walls is not None else None
    bodies = chosen_bodies(level, selection) or list(level.bodies)
    body = bodies[0].id if bodies else None

    def of(data: dict[str, Any]) -> Callable[[Document], Document]:
        return lambda document: add_rule(document, data)

    def of_thing(needs: str | None, data: Callable[[dict[str, str]], dict[str, Any]]) -> Any:
        return None if thing is None or needs is None else of(data(subject_of(level, thing)))

    what, where = thing or "a thing", zone or "a zone"
    inside = {"metric": "inside", "zone": zone}
    goal = of_thing(zone, lambda subject: {
        "id": "goal", "when": {**inside, **subject}, "for_seconds": STAY, "then": [{"win": WON}],
    })  # fmt: skip
    crossed = of_thing(zone, lambda subject: {
        "id": "lost", "when": {"crosses": zone, **subject}, "then": [{"fail": LOST}],
    })  # fmt: skip

    def counted(document: Document) -> Document:
        if not document.level.counters:
            document = add_counter(document)
        counter = document.level.counters[0].id
        then = [{"count": counter}, {"sound": "bell"}]
        return add_rule(document, {"id": "touch", "when": {"touches": [thing, other]}, "then": then})

    cut = {"id": "key", "when": {"key": FIRST_KEY}, "then": [{"cut": body}]}
    return [
        Template(f"Goal: {what} is inside {where}", goal),
        Template(f"Lost when {what} crosses {where}", crossed),
        Template(f"When {what} touches {other or 'another thing'}: count",
                 None if thing is None or other is None or thing == other else counted),
        Template(f"When key {FIRST_KEY.upper()}: cut {body or 'a body'}", None if body is None else of(cut)),
        Template("After 30 s: lost", of({"id": "time", "when": {"time": 30.0}, "then": [{"fail": "Time is up."}]})),
    ]  # fmt: skip


def why_not(document: Document) -> str:
    """A line about what the level lacks for the templates; empty where it has all."""
    level = document.level
    if not (level.bodies or level.particles):
        return "Draw something that moves first, such as a particle with a radius: a ball."
    return "" if level.zones else "Draw a zone first: the tool Zone, below the tools of the ground."
