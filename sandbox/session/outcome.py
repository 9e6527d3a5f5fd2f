"""The outcome of a run: whether its level is won or lost, which follows from the state alone."""

from dataclasses import asdict, dataclass
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.rules.rule import ActionDef, StarsDef
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World

MOST_STARS = 3


@dataclass(frozen=True)
class Outcome:
    """The end of a run for its player: won with stars, 1 to 3, or lost with none; at the end of a tick, by a rule."""

    is_won: bool
    text: str
    stars: int
    tick: int
    rule: int


def outcome(level: Level, state: World | Snapshot) -> Outcome | None:
    """The outcome of a level's run; None while it is neither won nor lost.

    The rule that won or lost first counts; of two in one tick, the one that stands first in the file.
    """
    first = state.rule_first.tolist()
    ended = [(tick, rule) for rule, tick in enumerate(first) if tick >= 0 and _ending(level, rule) is not None]
    if not ended:
        return None
    tick, rule = min(ended)
    action = _ending(level, rule)
    assert action is not None
    if action.win is None:
        return Outcome(False, action.fail or "", 0, tick, rule)
    kept = int(state.rule_stars[rule])
    return Outcome(True, action.win, kept or stars_of(action.stars, level, state, tick), tick, rule)


def vain_goal(level: Level) -> str:
    """What is said of a level whose goal is told and that no rule wins; "" of any other."""
    return f'No rule wins the level, and its goal says: "{level.goal}"' if level.goal and not level.has_goal else ""


def outcome_text(found: Outcome, rate: int) -> str:
    """An outcome in words: "won at 12.40 s with 3 stars"; rate: ticks in a second."""
    seconds = found.tick / rate
    if not found.is_won:
        return f"lost at {seconds:.2f} s"
    return f"won at {seconds:.2f} s with {found.stars} star{'s' * (found.stars > 1)}"


def outcome_data(found: Outcome | None, rate: int) -> dict[str, Any] | None:
    """An outcome for programs, ready for JSON; rate: ticks in a second."""
    return None if found is None else {**asdict(found), "seconds": found.tick / rate}


def _ending(level: Level, rule: int) -> ActionDef | None:
    """The first action of a rule that wins or loses."""
    return next((one for one in run_rules(level)[rule].then if one.win is not None or one.fail is not None), None)


def stars_of(stars: StarsDef | None, level: Level, state: World | Snapshot, tick: int) -> int:
    """How many stars a win at the end of a tick earns, with the counters as they are in this state."""
    if stars is None:
        return MOST_STARS
    value = tick / level.settings.tick_rate
    if stars.counter is not None:
        value = float(state.counter[level.counter_names.index(stars.counter)])
    is_least = stars.third > stars.second
    return 1 + sum(value >= bound if is_least else value <= bound for bound in (stars.second, stars.third))


@dataclass(frozen=True)
class StarMeasure:
    """What a level's stars are earned by: a counter with its text, None: the time; is_most: whether more is better."""

    counter: int | None
    text: str
    is_most: bool


def measure_of(level: Level) -> StarMeasure:
    """The measure of the first rule that wins with stars of its own; without any: the time, of which less is better."""
    wins = (action.stars for rule in level.rules for action in rule.then if action.win is not None and action.stars)
    stars = next(wins, None)
    if stars is None or stars.counter is None:
        return StarMeasure(None, "", stars is not None and stars.third > stars.second)
    named = {counter.id: counter.text or counter.id for counter in level.counters}
    row = level.counter_names.index(stars.counter)
    return StarMeasure(row, named.get(stars.counter, stars.counter), stars.third > stars.second)


def measured(measure: StarMeasure, state: World | Snapshot, tick: int) -> float:
    """The value of a measure for a win at the end of a tick, in the state then: of the counter, or the tick."""
    return float(tick if measure.counter is None else state.counter[measure.counter])


def star_words(level: Level, rule: int) -> tuple[str, ...]:
    """What the second and the third star of a rule that wins take, in words; () where every win has all."""
    action = _ending(level, rule)
    stars = None if action is None or action.win is None else action.stars
    if stars is None:
        return ()
    bound = "at least" if stars.third > stars.second else "at most"
    named = {counter.id: counter.text or counter.id for counter in level.counters}
    about, unit = ("", " s") if stars.counter is None else (f"{named.get(stars.counter, stars.counter)} ", "")
    values = (stars.second, stars.third)
    return tuple(f"{2 + number} stars: {about}{bound} {value:g}{unit}" for number, value in enumerate(values))


def last_checkpoint(level: Level, state: World | Snapshot) -> int | None:
    """The tick that a restart goes back to: at its end a checkpoint fired last; None: to the beginning.

    A run that is won begins anew, and so does one whose last checkpoint came after it was lost.
    """
    result = outcome(level, state)
    last = state.rule_last.tolist()
    ticks = [last[rule] for rule, each in enumerate(run_rules(level)) if any(action.checkpoint for action in each.then)]
    tick = max(ticks, default=-1)
    if tick < 0 or (result is not None and (result.is_won or tick >= result.tick)):
        return None
    return int(tick)
