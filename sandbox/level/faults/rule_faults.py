"""Faults of rules and counters: names that do not exist, and questions and actions that say too much or too little."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import assert_never

from sandbox.level.checks import SUBJECTS
from sandbox.level.document.model import Level
from sandbox.level.faults.reference_faults import bound_faults, metric_faults, subject_faults
from sandbox.level.format.level_error import Fault, shown, suggestion
from sandbox.level.format.limits import QUESTION_LIMIT, RULE_LIMIT
from sandbox.level.format.quantities import replaced
from sandbox.level.plan.actuators import actuators
from sandbox.level.plan.plan import Layout, Plan
from sandbox.level.plan.run_rules import ThingsByName, asked_of, each_in, members_of, several
from sandbox.level.rules.rule import ASKS, BELONGS, DOES, MANY, UNASKED, WALLS, ActionDef, Asks, QuestionDef

# The fields of a question beside those that say what it asks, by these.
_BOUNDS = ("at_most", "at_least")
_SUBJECTS = tuple("zone" if name == "box" else name for name in SUBJECTS)
_TAKES: dict[Asks, tuple[str, ...]] = {
    "metric": (*_SUBJECTS, *MANY, *_BOUNDS), "crosses": ("particle", "body", *MANY), "counter": _BOUNDS,
    "touches": MANY, "breaks": (), "key": (), "time": (), "all": (), "any": (), "none": (),
}  # fmt: skip


@dataclass(frozen=True)
class _RuleNames:
    """Names that rules may use, by kind."""

    layout: Layout
    zones: tuple[str, ...]
    things: tuple[str, ...]
    counters: tuple[str, ...]
    parts: tuple[str, ...]
    loose_springs: int
    members: ThingsByName

    def find(self, kind: str, where: str, name: str) -> Iterator[Fault]:
        """The fault of a name that nothing of the kind has."""
        known = {"zone": self.zones, "counter": self.counters, "driven part": self.parts}[kind]
        if name not in known:
            yield where, f"there is no {kind} {shown(name)}" + suggestion(name, known)


def rule_faults(level: Level, layout: Layout) -> Iterator[Fault]:
    """Faults of the counters and rules of a level."""
    if not level.counters and not level.rules:
        return
    things = [*layout.owners, *(piece.id for piece in level.terrain), *([WALLS] if level.walls else [])]
    names = _RuleNames(
        layout,
        tuple(zone.id for zone in level.zones),
        tuple(things),
        level.counter_names,
        tuple(part.name for part in actuators(level)),
        len(level.springs),
        members_of(level),
    )
    yield from _repeated("counters", "counter", [counter.id for counter in level.counters])
    yield from _repeated("rules", "rule", [rule.id for rule in level.rules])
    count = 0
    for index, rule in enumerate(level.rules):
        path, each = f"rules.{index}", each_in(rule.when)
        count += len(names.members.things(each[0])) if each else 1
        if _size(rule.when, names.members) > QUESTION_LIMIT:
            yield f"{path}.when", f"asks more than {QUESTION_LIMIT:,} questions; use fewer"
        elif len(each) > 1:
            yield f"{path}.when", "says each_of twice; a rule is of each of one list"
        else:
            yield from _question_faults(f"{path}.when", rule.when, names)
        for number, action in enumerate(rule.then):
            yield from _action_faults(f"{path}.then.{number}", action, names)
    if count > RULE_LIMIT:
        yield "rules", f"come to {count:,} with one for each of each_of; at most {RULE_LIMIT:,}"


def cut_spring_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    """Faults of springs of bodies that rules cut and that do not exist; of a level that is sound otherwise."""
    numbers = {body.id: made.numbers for body, made in zip(level.bodies, plan.bodies, strict=True)}
    for index, rule in enumerate(level.rules):
        for at, action in enumerate(rule.then):
            body, colon, number = (action.cut or "").partition(":")
            if colon and body and int(number) not in numbers[body]:
                yield f"rules.{index}.then.{at}.cut", f"there is no spring {shown(action.cut)}"


def _repeated(key: str, noun: str, ids: Iterable[str]) -> Iterator[Fault]:
    taken: set[str] = set()
    for index, name in enumerate(ids):
        if name in taken:
            yield f"{key}.{index}.id", f"{shown(name)} is taken; every {noun} needs an id of its own"
        taken.add(name)


def _size(question: QuestionDef, members: ThingsByName) -> int:
    field, named = several(question)
    own = len(members.things(named)) if field in ("any_of", "all_of") else 0
    return 1 + own + sum(_size(member, members) for member in question.members)


def _question_faults(path: str, question: QuestionDef, names: _RuleNames) -> Iterator[Fault]:
    if len(question.asked) != 1:
        said = f"not {' and '.join(question.asked)}" if question.asked else "this has none"
        yield path, f"asks one of {', '.join(ASKS)}; {said}"
        return
    asks = question.asked[0]
    for field in (*_SUBJECTS, *MANY, *_BOUNDS):
        if getattr(question, field) is not None and field not in _TAKES[asks]:
            is_several = asks == "breaks" and field in MANY
            remedy = "ask the metric broken_springs of several, at_least 1" if is_several else "take it out"
            yield f"{path}.{field}", f"belongs to another question than {asks}; {remedy}"
    field, named = several(question)
    if field and field in _TAKES[asks]:
        yield from _faults_of_several(path, field, named, question, names)
    else:
        yield from _ASKED[asks](path, question, names)


def _faults_of_several(
    path: str, field: str, named: tuple[str, ...], question: QuestionDef, names: _RuleNames
) -> Iterator[Fault]:
    """Faults of a question about several things, and of what it asks of each."""
    others = [each for each in ("particle", "body", *MANY) if each != field and getattr(question, each) is not None]
    for other in others:
        yield f"{path}.{other}", f"stands beside {field}; take one of them out"
    if len(question.touches or ()) > 1:
        yield f"{path}.touches", f"names at most one thing that those of {field} touch"
    unknown = [(k, name) for k, name in enumerate(named) if name not in names.members]
    for k, name in unknown:
        fault = f"there is no body, loose particle or group {shown(name)}" + suggestion(name, names.members)
        yield f"{path}.{field}.{k}", fault
    if others or unknown or len(question.touches or ()) > 1:
        return
    faults: dict[Fault, None] = {}
    for thing in names.members.things(named):
        asked = asked_of(replaced(question, **{field: None, "each_of": (thing,)}), names.members, thing)
        for where, fault in _ASKED[asked.asked[0]](path, asked, names):
            own = where.removeprefix(path) not in (".particle", ".body")
            faults[where if own else f"{path}.{field}", fault] = None
    yield from faults


def _member_faults(path: str, question: QuestionDef, names: _RuleNames) -> Iterator[Fault]:
    for index, member in enumerate(question.members):
        yield from _question_faults(f"{path}.{question.asked[0]}.{index}", member, names)


def _no_faults(path: str, question: QuestionDef, names: _RuleNames) -> Iterator[Fault]:
    """No faults: such a question or action names nothing."""
    yield from ()


def _metric_faults(path: str, question: QuestionDef, names: _RuleNames) -> Iterator[Fault]:
    if question.metric in UNASKED:
        yield f"{path}.metric", f'a rule does not ask for "{question.metric}"; a check does'
        return
    yield from metric_faults(path, question, _SUBJECTS, names.layout)
    if question.zone is not None and question.metric == "inside":
        yield from names.find("zone", f"{path}.zone", question.zone)


def _touches_faults(path: str, question: QuestionDef, names: _RuleNames) -> Iterator[Fault]:
    touching = question.touches or ()
    if not touching:
        yield f"{path}.touches", "names nothing; name what touches, or several things in any_of"
    for index, name in enumerate(touching):
        if name not in names.things:
            fault = f"there is no body, loose particle or piece of terrain {shown(name)}"
            yield f"{path}.touches.{index}", fault + suggestion(name, names.things)
    if len(touching) == 2 and touching[0] == touching[1]:
        yield f"{path}.touches", f"{shown(touching[0])} does not touch itself; name two things"


def _crosses_faults(path: str, question: QuestionDef, names: _RuleNames) -> Iterator[Fault]:
    yield from names.find("zone", f"{path}.crosses", question.crosses or "")
    named = [field for field in ("particle", "body") if getattr(question, field) is not None]
    if len(named) != 1:
        yield path, "name the particle or the body that crosses" + (", not both" if named else "")
    for field in named:
        yield from subject_faults(field, f"{path}.{field}", getattr(question, field), names.layout)


def _breaks_faults(path: str, question: QuestionDef, names: _RuleNames) -> Iterator[Fault]:
    yield from subject_faults("body", f"{path}.breaks", question.breaks, names.layout)


def _counter_faults(path: str, question: QuestionDef, names: _RuleNames) -> Iterator[Fault]:
    yield from names.find("counter", f"{path}.counter", question.counter or "")
    yield from bound_faults(path, question.at_least, question.at_most)


_ASKED: dict[Asks, Callable[[str, QuestionDef, _RuleNames], Iterator[Fault]]] = {
    "metric": _metric_faults,
    "touches": _touches_faults,
    "crosses": _crosses_faults,
    "breaks": _breaks_faults,
    "counter": _counter_faults,
    "key": _no_faults,
    "time": _no_faults,
    "all": _member_faults,
    "any": _member_faults,
    "none": _member_faults,
}


def _action_faults(path: str, action: ActionDef, names: _RuleNames) -> Iterator[Fault]:
    if len(action.done) != 1:
        said = f"not {' and '.join(action.done)}" if action.done else "this has none"
        yield path, f"does one of {', '.join(DOES)}; {said}"
        return
    does = action.done[0]
    for field, owners in BELONGS.items():
        if getattr(action, field) != ActionDef.model_fields[field].default and does not in owners:
            yield f"{path}.{field}", f"belongs to {' or '.join(owners)}, not to {does}; take it out"
    where, value = f"{path}.{does}", getattr(action, does)
    match does:
        case "count":
            yield from names.find("counter", where, value)
        case "drive":
            yield from names.find("driven part", where, value)
        case "sag":
            if action.body is None:
                yield f"{path}.body", "is missing; sag is of a body"
            else:
                yield from subject_faults("body", f"{path}.body", action.body, names.layout)
        case "win":
            if action.stars is not None and action.stars.counter is not None:
                yield from names.find("counter", f"{path}.stars.counter", action.stars.counter)
        case "cut":
            yield from _cut_faults(where, value, names)
        case "pin" | "unpin":
            yield from subject_faults("particle", where, value, names.layout)
        case "fail" | "say" | "sound" | "checkpoint" | "gravity" | "wind":
            pass
        case _:
            assert_never(does)


def _cut_faults(where: str, name: str, names: _RuleNames) -> Iterator[Fault]:
    """The fault of a body, or of a spring by name, that does not exist."""
    body, colon, number = name.partition(":")
    if colon and not number.isdecimal():
        yield where, f"a spring is named by its body and number, such as rope:3, not {shown(name)}"
    elif colon and not body:
        if int(number) >= names.loose_springs:
            yield where, f"there is no spring {shown(name)}"
    else:
        yield from subject_faults("body", where, body, names.layout)
