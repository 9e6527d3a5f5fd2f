"""run_rules(): the rules as a run has them: where one is of each of several things, a rule of each."""

from collections.abc import Iterator, Sequence
from itertools import chain

from sandbox.level.document.model import Level, ParticleDef
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.rules.rule import MANY, QuestionDef, RuleDef


def run_rules(level: Level) -> tuple[RuleDef, ...]:
    """The rules of a level in the order of a world, each of one thing; of each of several, they are `id: thing`."""
    kept: tuple[RuleDef, ...] | None = getattr(level, "_run_rules", None)
    if kept is None:
        kept = level.rules
        if any(many for rule in kept for many in _named_by(rule.when)):
            members = members_of(level)
            kept = tuple(chain.from_iterable(_of_each(rule, members) for rule in kept))
        object.__setattr__(level, "_run_rules", kept)
    return kept


class ThingsByName(dict[str, tuple[str, ...]]):
    """What a name of several things may be, and the things that it stands for; a thing's own name comes first.

    bodies: the names of those that are bodies.
    """

    bodies: frozenset[str]

    def things(self, names: Sequence[str]) -> tuple[str, ...]:
        """The things that names stand for, each once; what is not there is left out."""
        return tuple(dict.fromkeys(chain.from_iterable(self.get(name, ()) for name in names)))


def members_of(level: Level) -> ThingsByName:
    """Bodies, loose particles, and groups of them, by name."""
    movers: list[AnyBody | ParticleDef] = [*level.bodies, *level.particles]
    grouped: dict[str, list[str]] = {}
    for each in movers:
        if each.group is not None:
            grouped.setdefault(each.group, []).append(each.id)
    found = ThingsByName({name: tuple(things) for name, things in grouped.items()})
    found.update({each.id: (each.id,) for each in movers})
    found.bodies = frozenset(body.id for body in level.bodies)
    return found


def several(question: QuestionDef) -> tuple[str, tuple[str, ...]]:
    """How a question itself names several things, and their names; ("", ()) where it does not."""
    return next(((field, names) for field in MANY if (names := getattr(question, field)) is not None), ("", ()))


def _named_by(question: QuestionDef) -> Iterator[tuple[str, tuple[str, ...]]]:
    """How a question and those that it asks name several things."""
    yield from [several(question)] if several(question)[0] else []
    yield from chain.from_iterable(map(_named_by, question.members))


def each_in(question: QuestionDef) -> list[tuple[str, ...]]:
    """The names of what a rule is of each of, as its questions say them: one list, where it is sound."""
    return [names for field, names in _named_by(question) if field == "each_of"]


def _of_each(rule: RuleDef, members: ThingsByName) -> list[RuleDef]:
    named = each_in(rule.when)
    if not named:
        when = asked_of(rule.when, members)
        return [rule if when is rule.when else replaced(rule, when=when)]
    return [
        replaced(rule, id=f"{rule.id}: {thing}", when=asked_of(rule.when, members, thing))
        for thing in members.things(named[0])
    ]


def asked_of(question: QuestionDef, members: ThingsByName, each: str = "") -> QuestionDef:
    """A question that names no more than one thing; of any and all of them it asks one by one. each: of `each_of`."""
    if question.members:
        (kind,) = question.asked
        return replaced(question, **{kind: tuple(asked_of(member, members, each) for member in question.members)})
    field, names = several(question)
    if not field:
        return question
    if field == "each_of":
        return _of_thing(question, members, each)
    asked = tuple(_of_thing(question, members, thing) for thing in members.things(names))
    return QuestionDef(any=asked) if field == "any_of" else QuestionDef(all=asked)


def _of_thing(question: QuestionDef, members: ThingsByName, thing: str) -> QuestionDef:
    if question.touches is not None:
        subject: dict[str, object] = {"touches": (thing, *question.touches)}
    else:
        subject = {"body" if thing in members.bodies else "particle": thing}
    return replaced(question, **dict.fromkeys(MANY), **subject)
