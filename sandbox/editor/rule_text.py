"""Rules as sentences, and what they name."""

from collections.abc import Sequence
from typing import assert_never

from sandbox.level.checks import METRICS, Metric
from sandbox.level.plan.run_rules import several
from sandbox.level.rules.rule import ActionDef, QuestionDef, RuleDef

# Of more things than this a sentence says how many they are.
MOST_NAMED = 3


def rule_text(rule: RuleDef) -> str:
    """A rule as a sentence: 'When ball is inside basket for 0.5 s: win "In the basket!"'."""
    lasting = f" for {rule.for_seconds:g} s" if rule.for_seconds else ""
    once = " (once)" if rule.once else ""
    return f"When {question_text(rule.when)}{lasting}: {', '.join(map(action_text, rule.then))}{once}"


def question_text(question: QuestionDef) -> str:
    """A question of a rule in words, without a full stop."""
    asks = question.asked[0]
    value = getattr(question, asks)
    match asks:
        case "all" | "any" | "none":
            each = {"all": " and ", "any": " or ", "none": " or "}[asks].join(map(_member_text, value))
            return f"none of this: {each}" if asks == "none" else each
        case "touches":
            one, *others = value if several(question)[0] == "" else (_subject(question), *value)
            return f"{one} touches {others[0] if others else 'anything'}"
        case "crosses":
            return f"{_subject(question)} crosses {value}"
        case "breaks":
            return f"{value} breaks"
        case "key":
            return f"key {value.upper()} is held"
        case "time":
            return f"{value:g} s are over"
        case "counter":
            return f"{value} is {_bounds_text(question)}"
        case "metric":
            return _metric_text(question, value)
        case _:
            assert_never(asks)


def listed(names: Sequence[str]) -> str:
    """Several things in words: their names, or how many they are."""
    return ", ".join(names) if len(names) <= MOST_NAMED else f"{len(names)} things"


def _subject(question: QuestionDef) -> str:
    field, names = several(question)
    if field:
        return f"{field.replace('_', ' ')} {listed(names)}"
    return question.particle or question.body or "everything"


def _metric_text(question: QuestionDef, metric: Metric) -> str:
    bounds, subject = _bounds_text(question), _subject(question)
    if metric == "inside":
        deep = f" by {bounds}" if question.at_least or question.at_most is not None else ""
        return f"{subject} is inside {question.zone}{deep}"
    measured = METRICS[metric]
    of = f" of {subject}" if question.particle or question.body or several(question)[0] else ""
    to = f" to {question.other}" if question.other else ""
    return f"{measured.label}{of}{to}" + (f" is {bounds} {measured.unit}".rstrip() if bounds else "")


def _member_text(question: QuestionDef) -> str:
    return f"({question_text(question)})" if question.members else question_text(question)


def _bounds_text(question: QuestionDef) -> str:
    low, high = question.at_least, question.at_most
    if low is not None and high is not None:
        return f"{low:g}" if low == high else f"from {low:g} to {high:g}"
    if low is not None:
        return f"at least {low:g}"
    return f"at most {high:g}" if high is not None else ""


def action_text(action: ActionDef) -> str:
    """An action of a rule in words, without a full stop."""
    does = action.done[0]
    value = getattr(action, does)
    match does:
        case "win" | "fail" | "say":
            verb = "lose" if does == "fail" else does
            return f"{verb} \N{LEFT DOUBLE QUOTATION MARK}{value}\N{RIGHT DOUBLE QUOTATION MARK}" if value else verb
        case "count":
            return f"{value} {action.by:+g}"
        case "drive":
            return f"drive {value} at {action.value:g}"
        case "sag":
            return f"let {action.body} sag by {100.0 * value:g} %"
        case "gravity" | "wind":
            return f"{does} becomes {value[0]:g}, {value[1]:g}"
        case "checkpoint":
            return "checkpoint"
        case "sound" | "cut" | "pin" | "unpin":
            return f"{does} {value}"
        case _:
            assert_never(does)


def named_things(question: QuestionDef) -> list[str]:
    """Bodies, particles and terrain that a question names, its members too."""
    names = [question.particle, question.other, question.body, question.breaks, *(question.touches or ())]
    names += several(question)[1]
    return [name for name in names if name] + [name for each in question.members for name in named_things(each)]


def named_zones(question: QuestionDef) -> list[str]:
    """Zones that a question or its members name."""
    own = [name for name in (question.zone, question.crosses) if name]
    return own + [name for each in question.members for name in named_zones(each)]


def acted_on(rule: RuleDef) -> list[str]:
    """Bodies, springs and particles that a rule acts on."""
    names = [(each.cut or "").partition(":")[0] or each.pin or each.unpin or each.drive or each.body
             for each in rule.then]  # fmt: skip
    return [name for name in names if name and not name.startswith(":")]
