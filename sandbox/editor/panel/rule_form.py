"""The form of a rule, that reads as a sentence: when what holds, for how long, then what is done."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.fields import set_level_field
from sandbox.editor.edits.rule_edits import (
    FIRST_KEY,
    LOST,
    WON,
    add_counter,
    change_counter,
    delete_counter,
    plain,
    read_rule,
    set_rules,
    subject_of,
)
from sandbox.editor.panel.field_info import FieldInfo, fields_of
from sandbox.editor.panel.property import Property, Section, with_axes
from sandbox.editor.rule_text import question_text, rule_text
from sandbox.level.checks import METRICS
from sandbox.level.document.model import Level
from sandbox.level.plan.actuators import actuators
from sandbox.level.rules.rule import BELONGS, UNASKED, WALLS, ActionDef, CounterDef, QuestionDef, RuleDef

# What a question asks, in words.
_ASKS = {
    "inside": "is inside", "crosses": "crosses", "touches": "touches", "breaks": "breaks", "counter": "counter is",
    "key": "key is held", "time": "time is over", "metric": "measures",
}  # fmt: skip
# What an action does, in words.
_DOES = {
    "win": "win", "fail": "lose", "say": "say", "sound": "sound", "count": "count", "checkpoint": "checkpoint",
    "cut": "cut", "pin": "pin", "unpin": "unpin", "drive": "drive", "sag": "make soft", "gravity": "gravity",
    "wind": "wind",
}  # fmt: skip
ANYTHING = "anything"
# How soft a body becomes at first: the part of its height by which it sags.
SOFT = 0.2
_Data = dict[str, Any]


def rule_properties(document: Document, index: int) -> tuple[Section, ...]:
    """Properties of a rule of the level, by its index, of the counters, and of the level's goal."""
    level = document.level
    sections = []
    if 0 <= index < len(level.rules):
        rule = level.rules[index]
        when, then = _question_properties(level, rule, index), _action_properties(level, rule, index)
        sections = [Section(rule_text(rule), when), Section("Then", then), Section("This rule", _own(rule, index))]
    about = replace(fields_of(Level)["goal"], title="Goal line")
    goal = Property("goal", about, level.goal, lambda document, value: set_level_field(document, "goal", value))
    return (*sections, Section("Counters", tuple(_counter_properties(level))), Section("For players", (goal,)))


# The question.


def _asked(question: QuestionDef) -> str:
    return "inside" if question.metric == "inside" else question.asked[0]


def _question_properties(level: Level, rule: RuleDef, index: int) -> tuple[Property, ...]:
    question = rule.when
    made: list[Property] = []
    if question.members:
        about = FieldInfo("text", "When", tooltip="It asks several questions. They are changed in the file.")
        made.append(Property("when", about, question_text(question)))
    else:
        made += _sentence(level, question, index)
    about = fields_of(RuleDef)["for_seconds"]
    made.append(_of_rule(index, "for_seconds", replace(about, title="For"), rule.for_seconds))
    return tuple(made)


def _own(rule: RuleDef, index: int) -> tuple[Property, ...]:
    about = fields_of(RuleDef)
    once = _of_rule(index, "once", replace(about["once"], title="Only once"), rule.once)
    return once, _of_rule(index, "id", about["id"], rule.id)


def _sentence(level: Level, question: QuestionDef, index: int) -> list[Property]:
    """Subject, verb and object, in the order of the sentence."""
    asks = _asked(question)
    asked = Property("asks", _choice("What", tuple(_ASKS), "What the rule asks.", tuple(_ASKS.values())), asks,
                     partial(_set_asked, index))  # fmt: skip
    things, zones = _things(level), tuple(zone.id for zone in level.zones)
    subject = question.particle or question.body
    made: list[Property] = []

    def word(
        field: str, about: FieldInfo, value: Any, write: Callable[[Document, Any], Document] | None = None
    ) -> None:
        made.append(Property(field, about, value, write or partial(_set_word, index, field)))

    def of_thing(title: str = "When", optional: bool = False) -> None:
        tip = "The body or loose particle that it asks for."
        about = replace(_choice(title, things, tip), pick="mover", optional=optional, empty=ANYTHING)
        word("subject", about, subject, partial(_set_subject, index))

    if asks in ("inside", "crosses"):
        of_thing()
        made.append(asked)
        about = replace(_choice("Zone", zones, "The zone."), pick="zone")
        word("zone" if asks == "inside" else "crosses", about, question.zone or question.crosses)
    elif asks == "touches":
        pieces = (*things, *(piece.id for piece in level.terrain), *((WALLS,) if level.walls is not None else ()))
        first, second = (*(question.touches or ()), None)[:2]
        about = replace(_choice("When", pieces, "What touches."), pick="thing")
        word("touches.0", about, first, partial(_set_touching, index, 0))
        made.append(asked)
        about = replace(
            _choice("What it meets", pieces, "What is touched."), pick="thing", optional=True, empty=ANYTHING
        )
        word("touches.1", about, second, partial(_set_touching, index, 1))
    elif asks == "breaks":
        about = replace(_choice("When", tuple(body.id for body in level.bodies), "The body."), pick="body")
        word("breaks", about, question.breaks)
        made.append(asked)
    elif asks == "counter":
        made.append(asked)
        word("counter", _choice("Counter", level.counter_names, "The counter."), question.counter)
        made += _bounds(question, index, "")
    elif asks == "key":
        made.append(asked)
        word("key", replace(fields_of(QuestionDef)["key"], title="Key", optional=False), question.key)
    elif asks == "time":
        made.append(asked)
        word("time", replace(fields_of(QuestionDef)["time"], title="After", optional=False), question.time)
    elif asks == "metric":
        made += [asked, *_metric(level, question, index)]
    else:
        raise ValueError(f"a form has no question {asks!r}")
    return made


def _metric(level: Level, question: QuestionDef, index: int) -> list[Property]:
    assert question.metric is not None
    measured = METRICS[question.metric]
    names = tuple(name for name in METRICS if name not in UNASKED and name != "inside")
    about = _choice("Measure", names, "What is measured.", tuple(METRICS[name].label for name in names))
    made = [Property("metric", about, question.metric, partial(_set_metric, index))]
    if measured.takes("particle") or measured.takes("body"):
        needed = bool(measured.needs_one or measured.needs)
        about = replace(_choice("Of", _things(level), "What it is of."), pick="mover", optional=not needed,
                        empty="everything")  # fmt: skip
        subject = question.particle or question.body
        made.append(Property("subject", about, subject, partial(_set_subject, index)))
    if measured.takes("other"):
        about = replace(fields_of(QuestionDef)["other"], title="To", pick="particle")
        made.append(Property("other", about, question.other, partial(_set_word, index, "other")))
    return made + _bounds(question, index, measured.unit)


def _bounds(question: QuestionDef, index: int, unit: str) -> list[Property]:
    about = fields_of(QuestionDef)
    return [
        Property(name, replace(about[name], unit=unit, empty="no bound"), getattr(question, name),
                 partial(_set_word, index, name))
        for name in ("at_least", "at_most")
    ]  # fmt: skip


def _things(level: Level) -> tuple[str, ...]:
    return (*(part.id for part in level.particles), *(body.id for body in level.bodies))


def _choice(title: str, names: tuple[str, ...], tip: str, labels: tuple[str, ...] = ()) -> FieldInfo:
    return FieldInfo("choice", title, choices=names, labels=labels, tooltip=tip)


def _of_rule(index: int, field: str, about: FieldInfo, value: Any) -> Property:
    return Property(
        field, about, value, lambda document, new: _changed(document, index, lambda _, data: {**data, field: new})
    )


def _changed(document: Document, index: int, change: Callable[[Level, _Data], _Data]) -> Document:
    """The document with a rule that is what `change` makes of its plain values. Raises EditError."""
    rules = list(document.level.rules)
    data = change(document.level, plain(rules[index]))
    others = [rule.id for k, rule in enumerate(rules) if k != index]
    if data["id"] in others:
        raise EditError(f'there is a rule "{data["id"]}" already')
    rules[index] = read_rule(data)
    return set_rules(document, rules)


def _asking(index: int, document: Document, change: Callable[[Level, _Data], _Data]) -> Document:
    """Change the question of a rule, as `_changed`; fields that are None go."""

    def new(level: Level, data: _Data) -> _Data:
        when = change(level, data["when"])
        return {**data, "when": {field: value for field, value in when.items() if value is not None}}

    return _changed(document, index, new)


def _set_word(index: int, field: str, document: Document, value: Any) -> Document:
    return _asking(index, document, lambda _, when: {**when, field: value})


def _set_subject(index: int, document: Document, value: Any) -> Document:
    def change(level: Level, when: _Data) -> _Data:
        chosen = {} if value is None else _subject_for(level, when, value)
        return {**when, "particle": None, "body": None, **chosen}

    return _asking(index, document, change)


def _subject_for(level: Level, when: Mapping[str, Any], name: str) -> dict[str, str]:
    """How a question names a thing: of a body, where it wants a particle, its first one."""
    named = subject_of(level, name)
    metric = when.get("metric")
    if "body" in named and metric is not None and not METRICS[metric].takes("body"):
        return {"particle": f"{name}.0"}
    return named


def _set_touching(index: int, place: int, document: Document, value: Any) -> Document:
    def change(_: Level, when: _Data) -> _Data:
        names: list[Any] = list(when["touches"])[:2]
        names[place : place + 1] = [] if value is None else [value]
        return {**when, "touches": tuple(names)}

    return _asking(index, document, change)


def _set_metric(index: int, document: Document, value: Any) -> Document:
    return _asking(index, document, lambda level, when: _question(level, "metric", when, value))


def _set_asked(index: int, document: Document, value: Any) -> Document:
    """Set the question of a rule, of the same things where it can be."""
    return _asking(index, document, lambda level, when: _question(level, value, when, "y"))


def _question(level: Level, asks: str, old: _Data, metric: str) -> _Data:
    """A question of a kind, with what another one named where that fits."""
    things, zones = _things(level), [zone.id for zone in level.zones]
    named = old.get("body") or old.get("particle") or (old.get("touches") or (None,))[0] or old.get("breaks")
    thing = named if named in things else old.get("particle") or (things[0] if things else None)
    if thing is None and asks in ("inside", "crosses", "touches"):
        raise EditError("draw a particle or a body first, for the rule to ask for")
    zone = old.get("zone") or old.get("crosses") or (zones[-1] if zones else None)
    if asks in ("inside", "crosses"):
        if zone is None:
            raise EditError("draw a zone first, with the tool Zone")
        subject = subject_of(level, str(thing))
        return {"metric": "inside", "zone": zone, **subject} if asks == "inside" else {"crosses": zone, **subject}
    if asks == "touches":
        return {"touches": (thing,)}
    if asks == "breaks":
        bodies = [body.id for body in level.bodies]
        if not bodies:
            raise EditError("draw a body first: only bodies break")
        return {"breaks": thing if thing in bodies else bodies[0]}
    if asks == "counter":
        if not level.counters:
            raise EditError("add a counter first, below")
        return {"counter": level.counters[0].id, "at_least": 10.0}
    if asks in ("key", "time"):
        return {"key": FIRST_KEY} if asks == "key" else {"time": 10.0}
    if asks == "metric":
        return _measuring(level, metric, thing)
    raise ValueError(f"a form has no question {asks!r}")


def _measuring(level: Level, metric: str, thing: str | None) -> _Data:
    measured = METRICS[metric]
    low, high = measured.usual
    made: _Data = {"metric": metric, "at_least": low, "at_most": high}
    if measured.needs_one or "particle" in measured.needs:
        if thing is None:
            raise EditError("draw a particle or a body first, for the rule to measure")
        made |= _subject_for(level, made, thing)
    if "other" in measured.needs:
        others = [part.id for part in level.particles if part.id != thing]
        others += [f"{body.id}.0" for body in level.bodies if body.id != thing]
        if not others:
            raise EditError("a distance needs two things; draw another one")
        made["other"] = others[0]
    return made


# Actions.


def _action_properties(level: Level, rule: RuleDef, index: int) -> tuple[Property, ...]:
    made = []
    for number, action in enumerate(rule.then):
        does = action.done[0]
        about = _choice("Do" if number == 0 else "and", tuple(_DOES), "What is done.", tuple(_DOES.values()))
        remove = partial(_delete_action, index, number) if len(rule.then) > 1 else None
        name = f"then.{number}"
        made.append(Property(name, about, does, partial(_set_does, index, number), remove=remove))
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
            each = _choice(each.title, names, each.tooltip)
            each = replace(each, pick="body") if field in ("cut", "body") else each
        elif field in ("pin", "unpin"):
            each = replace(each, pick="particle")
        elif each.kind == "point":
            made.append(Property(f"{name}.{field}", each, value, partial(_set_axes, write, field, value)))
            continue
        made.append(Property(f"{name}.{field}", each, value, partial(write, field)))
    if action.stars is not None:
        text = f"{action.stars.second:g}, {action.stars.third:g} {action.stars.counter or 's'}"
        made.append(
            Property(f"{name}.stars", FieldInfo("text", "Stars", tooltip="Bounds of two and three stars."), text)
        )
    return made


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


def _acting(index: int, document: Document, change: Callable[[Level, list[_Data]], list[_Data]]) -> Document:
    return _changed(document, index, lambda level, data: {**data, "then": tuple(change(level, list(data["then"])))})


def _set_value(index: int, number: int, field: str, document: Document, value: Any) -> Document:
    def change(_: Level, then: list[_Data]) -> list[_Data]:
        return [{**each, field: value} if k == number else each for k, each in enumerate(then)]

    return _acting(index, document, change)


def _set_does(index: int, number: int, document: Document, value: Any) -> Document:
    if value == "count" and not document.level.counters:
        document = add_counter(document)
    if value == "sag":
        return _softened(document, index, number)
    return _set_action(document, index, number, _first_action(document.level, value))


def _set_action(document: Document, index: int, number: int, action: _Data) -> Document:
    return _acting(index, document, lambda _, then: [action if k == number else each for k, each in enumerate(then)])


def _softened(document: Document, index: int, number: int) -> Document:
    """Set an action to soften the first body that can be."""
    for body in document.level.bodies:
        try:
            return _set_action(document, index, number, {"sag": SOFT, "body": body.id})
        except EditError:
            continue
    raise EditError("no body here can be made soft: draw a jelly first")


def _add_action(document: Document, index: int) -> Document:
    return _acting(index, document, lambda _, then: [*then, {"sound": "bell"}])


def _delete_action(index: int, number: int, document: Document) -> Document:
    return _acting(index, document, lambda _, then: [each for k, each in enumerate(then) if k != number])


def _first_action(level: Level, does: str) -> _Data:
    """A new action of a kind, with something of the level in it. Raises EditError where there is nothing for it."""
    simple: dict[str, Any] = {
        "win": WON, "fail": LOST, "say": "Well done.", "sound": "bell", "checkpoint": True,
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


# Counters.


def _counter_properties(level: Level) -> list[Property]:
    about = fields_of(CounterDef)
    titles = {"id": "Name", "start": "Start", "text": "Shown as"}
    made = []
    for index in range(len(level.counters)):
        for field, title in titles.items():
            remove = partial(_delete_counter, index) if field == "id" else None
            each = replace(about[field], title=title, empty="hidden" if field == "text" else "")
            value = getattr(level.counters[index], field)
            made.append(
                Property(f"counter.{index}.{field}", each, value, partial(_set_counter, index, field), remove=remove)
            )
    add = FieldInfo("part", "Counter", tooltip="A number that rules change and ask for, such as a score.")
    return [*made, Property("counter", add, False, lambda document, _: add_counter(document))]


def _set_counter(index: int, field: str, document: Document, value: Any) -> Document:
    return change_counter(document, index, field, value)


def _delete_counter(index: int, document: Document) -> Document:
    return delete_counter(document, index)
