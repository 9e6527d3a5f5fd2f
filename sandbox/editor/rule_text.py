"""Rules as sentences, and what they name."""

from sandbox.level.checks import METRICS
from sandbox.level.rules.action import ActionDef
from sandbox.level.rules.question import QuestionDef
from sandbox.level.rules.rule import RuleDef

_JOINED = {"all": " and ", "any": " or ", "none": " or "}


def rule_text(rule: RuleDef) -> str:
    """A rule as a sentence: 'When ball is inside basket for 0.5 s: win "In the basket!"'."""
    lasting = f" for {rule.for_seconds:g} s" if rule.for_seconds else ""
    once = " (once)" if rule.once else ""
    return f"When {question_text(rule.when)}{lasting}: {', '.join(map(action_text, rule.then))}{once}"


def question_text(question: QuestionDef) -> str:
    """What a question asks, without a full stop."""
    subject = question.particle or question.body or "everything"
    if question.members:
        each = _JOINED[question.asked[0]].join(map(_member_text, question.members))
        return f"none of this: {each}" if question.none else each
    if question.touches is not None:
        return f"{question.touches[0]} touches {question.touches[1] if len(question.touches) > 1 else 'anything'}"
    if question.crosses is not None:
        return f"{subject} crosses {question.crosses}"
    if question.breaks is not None:
        return f"{question.breaks} breaks"
    if question.key is not None:
        return f"key {question.key.upper()} is held"
    if question.time is not None:
        return f"{question.time:g} s are over"
    bounds = _bounds_text(question)
    if question.counter is not None:
        return f"{question.counter} is {bounds}"
    assert question.metric is not None
    if question.metric == "inside":
        deep = f" by {bounds}" if question.at_least or question.at_most is not None else ""
        return f"{subject} is inside {question.zone}{deep}"
    measured = METRICS[question.metric]
    of = f" of {subject}" if question.particle or question.body else ""
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
    """What an action does, without a full stop."""
    does = action.done[0]
    value = getattr(action, does)
    if does in ("win", "fail", "say"):
        verb = {"win": "win", "fail": "lose", "say": "say"}[does]
        return f"{verb} \N{LEFT DOUBLE QUOTATION MARK}{value}\N{RIGHT DOUBLE QUOTATION MARK}" if value else verb
    if does == "count":
        return f"{value} {action.by:+g}"
    if does == "drive":
        return f"drive {value} at {action.value:g}"
    if does == "sag":
        return f"let {action.body} sag by {100.0 * action.sag:g} %" if action.sag is not None else ""
    if does in ("gravity", "wind"):
        return f"{does} becomes {value[0]:g}, {value[1]:g}"
    return {"sound": f"sound {value}", "checkpoint": "checkpoint"}.get(does, f"{does} {value}")


def named_things(question: QuestionDef) -> list[str]:
    """Bodies, particles and terrain that a question names, its members too."""
    names = [question.particle, question.other, question.body, question.breaks, *(question.touches or ())]
    return [name for name in names if name] + [name for each in question.members for name in named_things(each)]


def named_zones(question: QuestionDef) -> list[str]:
    """Zones that a question names, its members too."""
    own = [name for name in (question.zone, question.crosses) if name]
    return own + [name for each in question.members for name in named_zones(each)]


def acted_on(rule: RuleDef) -> list[str]:
    """Bodies, springs and particles that a rule acts on."""
    names = [(each.cut or "").partition(":")[0] or each.pin or each.unpin or each.drive or each.body
             for each in rule.then]  # fmt: skip
    return [name for name in names if name and not name.startswith(":")]
