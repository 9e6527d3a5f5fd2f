"""The form of a rule, that reads as a sentence: when what holds, for how long, then what is done."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.rule_edits import (
    FIRST_KEY,
    RuleData,
    add_counter,
    change_counter,
    change_rule,
    chosen_movers,
    delete_counter,
    subject_of,
)
from sandbox.editor.panel.action_form import action_properties
from sandbox.editor.panel.field_info import FieldInfo, choice_of, fields_of
from sandbox.editor.panel.property import Property, Section, changing, named, toggled
from sandbox.level.checks import METRICS
from sandbox.level.document.model import Level
from sandbox.level.plan.run_rules import each_in, members_of, several
from sandbox.level.rules.rule import GROUPS, MANY, UNASKED, WALLS, CounterDef, QuestionDef, RuleDef

# What a question asks, in words.
_ASKS = {
    "inside": "is inside", "crosses": "crosses", "touches": "touches", "breaks": "breaks", "counter": "counter is",
    "key": "key is held", "time": "time is over", "metric": "measures", "all": "all of these hold",
    "any": "one of these holds", "none": "none of these holds",
}  # fmt: skip
ANYTHING = "anything"
# After how long [s] a question asks at first.
FIRST_TIME = 10.0
# Questions that are of one thing, or of several.
_OF_THINGS = ("inside", "crosses", "touches", "metric")
ONE = "one"
_HOW_MANY = FieldInfo(
    "choice", "When", choices=(ONE, *MANY), labels=(ONE, "any", "all", "each"), tooltip="How many things it is of.",
    tips=("One thing", "Any of several: one is enough", "All of several",
          "Each of several, as by a rule of its own: it acts for each"),
)  # fmt: skip
SEVERAL = FieldInfo(
    "words", "Of these", pick="mover",
    tooltip="Bodies, loose particles and groups, set apart by commas. Pick adds one, or takes it out.",
)  # fmt: skip
# A question of the level: the index of its rule, and the way to it through questions that ask others.
_At = tuple[int, ...]


def rule_properties(level: Level, index: int) -> tuple[Section, ...]:
    """Properties of a rule of the level, by its index; () where there is none."""
    if not 0 <= index < len(level.rules):
        return ()
    rule = level.rules[index]
    when, then = _question_properties(level, rule, index), action_properties(level, rule, index)
    parts = {"": when, "Then": then, "This rule": _own(rule, index)}
    return tuple(Section(title, named(part, f"Rule {rule.id}")) for title, part in parts.items())


def counter_properties(level: Level) -> tuple[Section, ...]:
    """Properties of the counters of a level."""
    return (Section("Counters", tuple(_counter_properties(level))),)


# The question.


def _asked(question: QuestionDef) -> str:
    return "inside" if question.metric == "inside" else question.asked[0]


def _question_properties(level: Level, rule: RuleDef, index: int) -> tuple[Property, ...]:
    made = _sentence(level, rule.when, (index,))
    about = FieldInfo("part", "Ask more", tooltip="Another question beside what the rule asks.")
    for_seconds = replace(fields_of(RuleDef)["for_seconds"], title="For")
    return (
        *made,
        Property("ask", about, False, lambda document, _: _ask_more(index, document)),
        _of_rule(index, "for_seconds", for_seconds, rule.for_seconds),
    )


def _own(rule: RuleDef, index: int) -> tuple[Property, ...]:
    about = fields_of(RuleDef)
    once = _of_rule(
        index, "once", replace(about["once"], title="Once for each" if each_in(rule.when) else "Only once"), rule.once
    )
    return once, _of_rule(index, "id", about["id"], rule.id)


def _sentence(level: Level, question: QuestionDef, at: _At) -> list[Property]:
    """Subject, verb and object, in the order of the sentence; of several questions, one after another."""
    asks, into = _asked(question), "".join(f"{place}." for place in at[1:])
    title = "When" if question.members else "What"
    asked = Property(f"{into}asks", choice_of(title, tuple(_ASKS), "What the rule asks.", tuple(_ASKS.values())), asks,
                     partial(_set_asked, at))  # fmt: skip
    things, zones = _things(level), tuple(zone.id for zone in level.zones)
    subject = question.particle or question.body
    made: list[Property] = []

    def word(
        field: str, about: FieldInfo, value: Any, write: Callable[[Document, Any], Document] | None = None
    ) -> None:
        made.append(Property(into + field, about, value, write or partial(_set_word, at, field)))

    field, names = several(question)
    if asks in _OF_THINGS and (asks in ("crosses", "touches") or _is_of_things(question)):
        made.append(Property(f"{into}many", _HOW_MANY, field or ONE, partial(_set_many, at)))
    if field:
        word("several", SEVERAL, names, partial(_set_several, at, field))
    elif asks in ("inside", "crosses"):
        about = replace(choice_of("Of", things, "The body or loose particle that it asks for."), pick="mover")
        word("subject", about, subject, partial(_set_subject, at))
    if asks in ("inside", "crosses"):
        made.append(asked)
        about = replace(choice_of("Zone", zones, "The zone."), pick="zone")
        word("zone" if asks == "inside" else "crosses", about, question.zone or question.crosses)
    elif asks == "touches":
        pieces = (*things, *(piece.id for piece in level.terrain), *((WALLS,) if level.walls is not None else ()))
        touching, met = question.touches or (), 0 if field else 1
        if not field:
            about = replace(choice_of("Of", pieces, "What touches."), pick="thing")
            word("touches.0", about, touching[0], partial(_set_touching, at, 0))
        made.append(asked)
        about = replace(
            choice_of("What it meets", pieces, "What is touched."), pick="thing", optional=True, empty=ANYTHING
        )
        word("touches.1", about, (*touching, None, None)[met], partial(_set_touching, at, met))
    elif asks == "breaks":
        about = replace(choice_of("When", tuple(body.id for body in level.bodies), "The body."), pick="body")
        word("breaks", about, question.breaks)
        made.append(asked)
    elif asks == "counter":
        made.append(asked)
        word("counter", choice_of("Counter", level.counter_names, "The counter."), question.counter)
        made += _bounds(question, at, "")
    elif asks == "key":
        made.append(asked)
        word("key", replace(fields_of(QuestionDef)["key"], title="Key", optional=False), question.key)
    elif asks == "time":
        made.append(asked)
        word("time", replace(fields_of(QuestionDef)["time"], title="After", optional=False), question.time)
    elif asks == "metric":
        made += [asked, *_metric(level, question, at)]
    elif question.members:
        made += [asked, *_member_sentences(level, question, at)]
    else:
        raise ValueError(f"a form has no question {asks!r}")
    return made


def _member_sentences(level: Level, question: QuestionDef, at: _At) -> Iterator[Property]:
    """The sentences of what a question asks, each of which can be taken away where there are several."""
    for place, member in enumerate(question.members):
        remove = partial(_stop_asking, at, place) if len(question.members) > 1 else None
        opening, *rest = _sentence(level, member, (*at, place))
        yield from (_indented(each) for each in (replace(opening, remove=remove), *rest))


def _indented(each: Property) -> Property:
    return replace(each, label=each.step, about=replace(each.about, title=f"\N{MIDDLE DOT} {each.about.title}"))


def _is_of_things(question: QuestionDef) -> bool:
    """Whether a metric is of a body or a particle."""
    return question.metric is not None and any(map(METRICS[question.metric].takes, ("particle", "body")))


def _metric(level: Level, question: QuestionDef, at: _At) -> list[Property]:
    assert question.metric is not None
    into = "".join(f"{place}." for place in at[1:])
    measured = METRICS[question.metric]
    names = tuple(name for name in METRICS if name not in UNASKED and name != "inside")
    about = choice_of("Measure", names, "What is measured.", tuple(METRICS[name].label for name in names))
    made = [Property(f"{into}metric", about, question.metric, partial(_set_metric, at))]
    if _is_of_things(question) and not several(question)[0]:
        needed = bool(measured.needs_one or measured.needs)
        about = replace(choice_of("Of", _things(level), "What it is of."), pick="mover", optional=not needed,
                        empty="everything")  # fmt: skip
        subject = question.particle or question.body
        made.append(Property(f"{into}subject", about, subject, partial(_set_subject, at)))
    if measured.takes("other"):
        about = replace(fields_of(QuestionDef)["other"], title="To", pick="particle")
        made.append(Property(f"{into}other", about, question.other, partial(_set_word, at, "other")))
    return made + _bounds(question, at, measured.unit)


def _bounds(question: QuestionDef, at: _At, unit: str) -> list[Property]:
    about, into = fields_of(QuestionDef), "".join(f"{place}." for place in at[1:])
    return [
        Property(into + name, replace(about[name], unit=unit, empty="no bound"), getattr(question, name),
                 partial(_set_word, at, name))
        for name in ("at_least", "at_most")
    ]  # fmt: skip


def _things(level: Level) -> tuple[str, ...]:
    return (*(part.id for part in level.particles), *(body.id for body in level.bodies))


def _of_rule(index: int, field: str, about: FieldInfo, value: Any) -> Property:
    return Property(
        field, about, value, lambda document, new: change_rule(document, index, lambda _, data: {**data, field: new})
    )


def _asking(at: _At, document: Document, change: Callable[[Level, RuleData], RuleData]) -> Document:
    """Change a question of a rule, as `_changed`; fields that are None go."""

    def inside(level: Level, when: RuleData, way: _At) -> RuleData:
        if not way:
            return {field: value for field, value in change(level, when).items() if value is not None}
        kind, members = _members(when)
        members[way[0]] = inside(level, members[way[0]], way[1:])
        return {kind: tuple(members)}

    return change_rule(document, at[0], lambda level, data: {**data, "when": inside(level, data["when"], at[1:])})


def _members(when: RuleData) -> tuple[str, list[RuleData]]:
    """What holds of the questions that one asks, and these; of one that asks none, itself alone of which all holds."""
    return next(((kind, list(when[kind])) for kind in GROUPS if kind in when), ("all", [when]))


def _ask_more(index: int, document: Document) -> Document:
    def change(_: Level, when: RuleData) -> RuleData:
        kind, members = _members(when)
        return {kind: (*members, {"time": FIRST_TIME})}

    return _asking((index,), document, change)


def _stop_asking(at: _At, place: int, document: Document) -> Document:
    """Take one of several questions out; what is left of two stands by itself, unless it must not hold."""

    def change(_: Level, when: RuleData) -> RuleData:
        kind, members = _members(when)
        del members[place]
        return members[0] if len(members) == 1 and kind != "none" else {kind: tuple(members)}

    return _asking(at, document, change)


def _set_word(at: _At, field: str, document: Document, value: Any) -> Document:
    return _asking(at, document, lambda _, when: {**when, field: value})


def _set_subject(at: _At, document: Document, value: Any) -> Document:
    def change(level: Level, when: RuleData) -> RuleData:
        chosen = {} if value is None else _subject_for(level, when, value)
        return {**when, "particle": None, "body": None, **chosen}

    return _asking(at, document, change)


def _subject_for(level: Level, when: Mapping[str, Any], name: str) -> dict[str, str]:
    """How a question names a thing: of a body, where it wants a particle, its first one."""
    named = subject_of(level, name)
    metric = when.get("metric")
    if "body" in named and metric is not None and not METRICS[metric].takes("body"):
        return {"particle": f"{name}.0"}
    return named


def _set_many(at: _At, document: Document, value: Any) -> Document:
    """Let a question be of one thing, or of any, all or each of those that it names or that are selected."""

    def change(level: Level, when: RuleData) -> RuleData:
        names = _names_of(when)
        return _of_things(level, when, value, names if len(names) > 1 else chosen_movers(document) or names)

    made = _asking(at, document, change)
    if value != "each_of":
        return made
    # What counts them counts each once, unless told otherwise.
    return change_rule(made, at[0], lambda _, data: {**data, "once": True})


def _names_of(when: RuleData) -> tuple[str, ...]:
    """What a question is of."""
    one = [*(when.get("touches") or ())][:1] or [when.get("body") or when.get("particle")]
    return next((when[field] for field in MANY if field in when), tuple(name for name in one if name))


def _of_things(level: Level, when: RuleData, how: str, names: Sequence[str]) -> RuleData:
    """A question of the first of some things, or of any, all or each of them."""
    touches = tuple(when.get("touches", ()))
    bare = {name: value for name, value in when.items() if name not in ("particle", "body", "touches", *MANY)}
    if "touches" in when:
        bare["touches"] = touches if when.keys() & set(MANY) else touches[1:]
    if how != ONE:
        return {**bare, how: tuple(names)}
    first = members_of(level).things(names)[:1]
    if "touches" in when:
        return {**bare, "touches": (*(first or names[:1]), *bare["touches"])}
    return {**bare, **(_subject_for(level, when, first[0]) if first else {})}


def _set_several(at: _At, field: str, document: Document, value: Any) -> Document:
    """Set the things that a question names; one that is picked joins them, or leaves them."""
    return _asking(at, document, lambda _, when: {**when, field: toggled(when[field], value)})


def _set_touching(at: _At, place: int, document: Document, value: Any) -> Document:
    def change(_: Level, when: RuleData) -> RuleData:
        names: list[Any] = list(when["touches"])[:2]
        names[place : place + 1] = [] if value is None else [value]
        return {**when, "touches": tuple(names)}

    return _asking(at, document, change)


def _set_metric(at: _At, document: Document, value: Any) -> Document:
    return _asking(at, document, lambda level, when: _question(level, "metric", when, value))


def _set_asked(at: _At, document: Document, value: Any) -> Document:
    """Set the question of a rule, of the same things where it can be."""
    return _asking(at, document, lambda level, when: _question(level, value, when, "y"))


def _question(level: Level, asks: str, old: RuleData, metric: str) -> RuleData:
    """A question of a kind, with what another one named where that fits."""
    if asks in GROUPS:
        return {asks: tuple(_members(old)[1])}
    if old.keys() & set(GROUPS):
        first: RuleData = _members(old)[1][0]
        is_same = _asked(QuestionDef.model_validate(first)) == asks
        return first if is_same else _question(level, asks, first, metric)
    many = next((field for field in MANY if field in old), "")
    if many:
        new = _question(level, asks, _of_things(level, old, ONE, old[many]), metric)
        is_of_things = asks != "metric" or _is_of_things(QuestionDef.model_validate(new))
        return _of_things(level, new, many, old[many]) if asks in _OF_THINGS and is_of_things else new
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
        return {"key": FIRST_KEY} if asks == "key" else {"time": FIRST_TIME}
    if asks == "metric":
        return _measuring(level, metric, thing)
    raise ValueError(f"a form has no question {asks!r}")


def _measuring(level: Level, metric: str, thing: str | None) -> RuleData:
    measured = METRICS[metric]
    low, high = measured.usual
    made: RuleData = {"metric": metric, "at_least": low, "at_most": high}
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


# Counters.


def _counter_properties(level: Level) -> list[Property]:
    about = fields_of(CounterDef)
    titles = {"id": "Name", "start": "Start", "text": "Shown as"}
    made = []
    for index in range(len(level.counters)):
        for field, title in titles.items():
            remove = changing(delete_counter, index) if field == "id" else None
            each = replace(about[field], title=title, empty="hidden" if field == "text" else "")
            value = getattr(level.counters[index], field)
            made.append(
                Property(f"counter.{index}.{field}", each, value, changing(change_counter, index, field), remove=remove)
            )
    add = FieldInfo("part", "Counter", tooltip="A number that rules change and ask for, such as a score.")
    return [*made, Property("counter", add, False, lambda document, _: add_counter(document))]
