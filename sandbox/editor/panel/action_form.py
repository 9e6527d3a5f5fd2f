"""The part of a rule's form that says what is done: actions, what each is of, and what earns stars."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.rule_edits import LOST, WON, RuleData, add_counter, change_rule
from sandbox.editor.panel.field_info import FieldInfo, choice_of, fields_of
from sandbox.editor.panel.property import Property, with_axes
from sandbox.level.document.model import Level
from sandbox.level.plan.actuators import actuators
from sandbox.level.rules.rule import BELONGS, ActionDef, RuleDef, StarsDef

# What an action does, in words.
_DOES = {
    "win": "win", "fail": "lose", "say": "say", "sound": "sound", "count": "count", "checkpoint": "checkpoint",
    "cut": "cut", "pin": "pin", "unpin": "unpin", "drive": "drive", "sag": "make soft", "gravity": "gravity",
    "wind": "wind",
}  # fmt: skip
# Actions whose values are of one kind: words, a particle.
_ALIKE = (("win", "fail", "say"), ("pin", "unpin"))
SAID = "Well done."
# Bounds of two and three stars at first: of a time [s], of a counter.
FIRST_STARS = {True: (30.0, 15.0), False: (1.0, 2.0)}
# How soft a body becomes at first: the part of its height by which it sags.
SOFT = 0.2


def action_properties(level: Level, rule: RuleDef, index: int) -> tuple[Property, ...]:
    """Properties of what a rule of the level does, one action after another, and a button for more."""
    made = []
    for number, action in enumerate(rule.then):
        does = action.done[0]
        about = choice_of("Do" if number == 0 else "and", tuple(_DOES), "What is done.", tuple(_DOES.values()))
        remove = partial(_delete_action, index, number) if len(rule.then) > 1 else None
        name = f"then.{number}"
        remark = partial(_stars_remark, action)
        made.append(Property(name, about, does, partial(_set_does, index, number), remark=remark, remove=remove))
        made += _value_properties(level, action, does, partial(_set_value, index, number), name)
    add = FieldInfo("part", "Do more", tooltip="Another thing that is done then.")
    made.append(Property("more", add, False, lambda document, _: _add_action(document, index)))
    return tuple(made)


def _value_properties(
    level: Level, action: ActionDef, does: str, write: Callable[[str, Document, Any], Document], name: str
) -> list[Property]:
    about = fields_of(ActionDef)
    fields = [does, *(field for field, owners in BELONGS.items() if does in owners and field != "stars")]
    made = []
    for field in fields:
        if field == "checkpoint":
            continue
        each, value = replace(about[field], optional=False, title=_value_title(field)), getattr(action, field)
        names = _choices_of(level, field)
        if names is not None:
            each = choice_of(each.title, names, each.tooltip)
            each = replace(each, pick="body") if field in ("cut", "body") else each
        elif field in ("pin", "unpin"):
            each = replace(each, pick="particle")
        elif each.kind == "point":
            made.append(Property(f"{name}.{field}", each, value, partial(_set_axes, write, field, value)))
            continue
        made.append(Property(f"{name}.{field}", each, value, partial(write, field)))
    return made + (_star_properties(level, action.stars, partial(write, "stars"), name) if does == "win" else [])


def _star_properties(level: Level, stars: StarsDef | None, write: Callable[..., Document], name: str) -> list[Property]:
    """What earns the second and the third star, and from where on."""
    about, names = fields_of(StarsDef), ("", *level.counter_names)
    by = replace(choice_of("Stars", names, "What earns two and three stars.", ("by time", *names[1:])), optional=True,
                 empty=fields_of(ActionDef)["stars"].empty)  # fmt: skip

    def set_counter(document: Document, value: str | None) -> Document:
        if value is None:
            return write(document, None)
        is_same = stars is not None and (stars.counter is None) == (not value)
        second, third = (stars.second, stars.third) if stars and is_same else FIRST_STARS[not value]
        return write(document, {"counter": value or None, "second": second, "third": third})

    made = [Property(f"{name}.stars", by, None if stars is None else stars.counter or "", set_counter)]
    if stars is None:
        return made
    is_least, unit = stars.third > stars.second, "" if stars.counter else "s"
    for field, count in (("second", "2"), ("third", "3")):
        title = f"{count} stars {'from' if is_least else 'within' if unit else 'up to'}"
        bound = replace(about[field], title=title, unit=unit)
        made.append(
            Property(f"{name}.stars.{field}", bound, getattr(stars, field), partial(_set_star, write, stars, field))
        )
    return made


def _set_star(
    write: Callable[..., Document], stars: StarsDef, field: str, document: Document, value: float
) -> Document:
    return write(document, {**stars.__dict__, field: value})


def _stars_remark(action: ActionDef, document: Document, value: Any) -> str:
    return "the stars went with the win; undo brings them back" if action.stars and value != "win" else ""


def _set_axes(
    write: Callable[..., Document], field: str, old: tuple[float, float], document: Document, value: Any
) -> Document:
    return write(field, document, with_axes(value, old))


def _value_title(field: str) -> str:
    titles = {"win": "Words", "fail": "Words", "say": "Words", "count": "Counter", "by": "By", "during": "Within",
              "drive": "What", "value": "How", "sound": "Which", "sag": "Sag, of its height", "body": "Body",
              "cut": "What", "pin": "Particle", "unpin": "Particle", "gravity": "To", "wind": "To"}  # fmt: skip
    return titles[field]


def _choices_of(level: Level, field: str) -> tuple[str, ...] | None:
    if field in ("cut", "body"):
        return tuple(body.id for body in level.bodies)
    if field == "count":
        return level.counter_names
    return tuple(part.name for part in actuators(level)) if field == "drive" else None


def _acting(index: int, document: Document, change: Callable[[Level, list[RuleData]], list[RuleData]]) -> Document:
    return change_rule(document, index, lambda level, data: {**data, "then": tuple(change(level, list(data["then"])))})


def _set_value(index: int, number: int, field: str, document: Document, value: Any) -> Document:
    def change(_: Level, then: list[RuleData]) -> list[RuleData]:
        return [{**each, field: value} if k == number else each for k, each in enumerate(then)]

    return _acting(index, document, change)


def _set_does(index: int, number: int, document: Document, value: Any) -> Document:
    if value == "count" and not document.level.counters:
        document = add_counter(document)
    old = document.level.rules[index].then[number]
    if value == "sag":
        return _softened(document, index, number, old.cut)
    new = _first_action(document.level, value)
    for alike in _ALIKE:
        kept = getattr(old, old.done[0])
        if {value, old.done[0]} <= set(alike) and kept not in ("", WON, LOST, SAID):
            new = {value: kept}
    if value in BELONGS["during"] and old.during:
        new["during"] = old.during
    return _set_action(document, index, number, new)


def _set_action(document: Document, index: int, number: int, action: RuleData) -> Document:
    return _acting(index, document, lambda _, then: [action if k == number else each for k, each in enumerate(then)])


def _softened(document: Document, index: int, number: int, first: str | None) -> Document:
    """Set an action to soften the first body that can be, `first` before all others."""
    for body in sorted(document.level.bodies, key=lambda body: body.id != first):
        try:
            return _set_action(document, index, number, {"sag": SOFT, "body": body.id})
        except EditError:
            continue
    raise EditError("no body here can be made soft: draw a jelly first")


def _add_action(document: Document, index: int) -> Document:
    def change(level: Level, then: list[RuleData]) -> list[RuleData]:
        # What is not done yet, of what needs nothing else.
        free = (does for does in ("sound", "say", "checkpoint") if not any(does in each for each in then))
        return [*then, _first_action(level, next(free, "say"))]

    return _acting(index, document, change)


def _delete_action(index: int, number: int, document: Document) -> Document:
    return _acting(index, document, lambda _, then: [each for k, each in enumerate(then) if k != number])


def _first_action(level: Level, does: str) -> RuleData:
    """A new action of a kind, with something of the level in it. Raises EditError where there is nothing for it."""
    simple: dict[str, Any] = {
        "win": WON, "fail": LOST, "say": SAID, "sound": "bell", "checkpoint": True,
        "gravity": level.settings.gravity, "wind": (2.0, 0.0),
    }  # fmt: skip
    if does in simple:
        return {does: simple[does]}
    if does == "count":
        return {"count": level.counters[0].id}
    if does == "drive":
        parts = actuators(level)
        if not parts:
            raise EditError("nothing is driven here: give a wheel a motor, or a loose spring a hydraulic, first")
        return {"drive": parts[0].name}
    if does in ("pin", "unpin"):
        things = [*(part.id for part in level.particles), *(f"{body.id}.0" for body in level.bodies)]
        if not things:
            raise EditError("draw a particle first")
        return {does: things[0]}
    if does == "cut":
        if not level.bodies:
            raise EditError("draw a body first, for the rule to cut")
        return {"cut": level.bodies[0].id}
    raise ValueError(f"there is no first action {does!r}")
