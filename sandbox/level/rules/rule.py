"""Counters, and rules: a question, and the actions that follow when it holds."""

from typing import Annotated

from pydantic import Field

from sandbox.level.format.limits import ACTION_LIMIT
from sandbox.level.format.quantities import Description, Extras, Id, Line, Seconds
from sandbox.level.rules.action import ActionDef
from sandbox.level.rules.question import QuestionDef


class CounterDef(Description):
    """A number that rules change and ask for, such as a score."""

    id: Id = Field(description="Name of the counter. No other counter has it.")
    start: float = Field(default=0.0, description="Its value at the start.")
    text: Line = Field(default="", description="Its name for players, who see it then.")


class RuleDef(Description):
    """When something holds, something is done. A rule that wins is a goal of the level."""

    id: Id = Field(description="Name of the rule. No other rule has it.")
    when: QuestionDef = Field(description="What it asks at the end of each tick.")
    for_seconds: Seconds = Field(default=0.0, description="For how long that must have held.")
    once: bool = Field(
        default=False, description="Whether it acts once in a run, not each time that its question begins to hold."
    )
    then: Annotated[tuple[ActionDef, ...], Field(min_length=1, max_length=ACTION_LIMIT)] = Field(
        description="What it does, in this order, before the next tick."
    )
    extras: Extras = Field(default_factory=dict)


def has_clock(rules: tuple[RuleDef, ...]) -> bool:
    """Whether time counts for players: a rule asks for it, or stars are earned by it."""
    stars = [action.stars for rule in rules for action in rule.then if action.stars is not None]
    return any(each.counter is None for each in stars) or any(_asks_time(rule.when) for rule in rules)


def _asks_time(question: QuestionDef) -> bool:
    return question.time is not None or any(map(_asks_time, question.members))
