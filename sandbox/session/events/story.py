"""Story: the list of what happened in a run, from its commands, its moments and, where one watched, its touches."""

from collections.abc import Callable, Iterator
from typing import assert_never

from sandbox.level.document.model import Level
from sandbox.level.rules.action import ActionDef
from sandbox.level.things.names import thing_of_spring
from sandbox.session.commands.records import script_of
from sandbox.session.events.deeds import deeds_in
from sandbox.session.events.happening import Happening, grouped, in_order
from sandbox.session.events.moments import KeptMoment
from sandbox.session.events.touch_watch import Meeting, TouchWatch
from sandbox.session.outcome import outcome
from sandbox.session.session import Session


def happenings(run: Session, watch: TouchWatch | None = None) -> list[Happening]:
    """What happened in a run until its present tick, one by one, in the order of time; what was undone never happened.

    watch: one that watched all its ticks; None: without who touched whom and who was in which zone.
    """
    entries = [entry for entry in run.history.timeline if entry.in_effect and entry.tick <= run.tick]
    found = [*deeds_in(script_of(entries, run.world)), *told_moments(run, run.tick)]
    if watch is not None:
        found += _of_watch(watch, run.tick)
    return in_order(found)


def story(run: Session, watch: TouchWatch | None = None) -> list[Happening]:
    """The same to be read: one line for many that are alike."""
    return grouped(happenings(run, watch), run.level.settings.tick_rate)


def watched_story(
    run: Session, ticks: int, on_tick: Callable[[], None] | None = None, watch: TouchWatch | None = None
) -> list[Happening]:
    """The story of a run that goes on until a tick; on_tick: called after each. Raises CommandError."""
    watch = watch or TouchWatch(run.level.zones)
    watch.watch(run.world)
    while run.tick < ticks:
        run.advance()
        watch.watch(run.world)
        if on_tick is not None:
            on_tick()
    run.apply_pending()
    return story(run, watch)


def told_moments(run: Session, last: int) -> Iterator[Happening]:
    """What a run itself keeps of its ticks until a tick, which may lie ahead of the present one, in order."""
    names, known = run.world.spring_names, outcome(run.level, run.world)
    end = None if known is None else known.tick
    for tick, moment in sorted(run.history.moments.items()):
        if tick > last:
            break
        for slot in moment.broken:
            yield Happening(tick, tick, "break", (thing_of_spring(names[slot]),), f"{names[slot]} broke")
        for name in moment.frozen:
            yield Happening(tick, tick, "freeze", (name,), f"{name} went out of bounds and was frozen")
        for each in _of_rules(run.level, tick, moment):
            if each.kind in ("win", "lose"):
                # What ended first counts, and of one tick what stands first.
                if end is not None and end != tick:
                    continue
                end = tick - 1
            yield each


def _of_rules(level: Level, tick: int, moment: KeptMoment) -> Iterator[Happening]:
    """What the rules that fired in a tick do."""
    values = dict(zip((counter.id for counter in level.counters), moment.counters, strict=False))
    for number in moment.rules:
        rule = level.rules[number]
        for action in rule.then:
            if action.count is not None:
                values[action.count] = values.get(action.count, 0.0) + action.by
                text = f"{action.count} is {values[action.count]:g}"
                yield Happening(tick, tick, "count", (action.count, rule.id), text)
            elif action.win is not None or action.fail is not None:
                kind, words = ("win", "won") if action.win is not None else ("lose", "lost")
                yield Happening(tick, tick, kind, (rule.id,), f"{words}: {action.win or action.fail or rule.id}")
            elif action.checkpoint:
                yield Happening(tick, tick, "checkpoint", (rule.id,), f"checkpoint ({rule.id})")
            else:
                yield Happening(tick, tick, "rule", (rule.id,), f"rule {rule.id}: {_told(action)}")


def _told(action: ActionDef) -> str:
    (does,) = action.done
    value = getattr(action, does)
    match does:
        case "say" | "sound" | "cut" | "pin" | "unpin":
            return f"{does} {value}"
        case "gravity" | "wind":
            return f"{does} {', '.join(f'{each:g}' for each in value)}"
        case "sag":
            return f"{action.body} sags by {value:.0%}"
        case "drive":
            return f"drive {value} {action.value:g}"
        case "count":
            return f"count {value}"
        case "win" | "fail" | "checkpoint":
            return does
        case _:
            assert_never(does)


def _of_watch(watch: TouchWatch, end: int) -> Iterator[Happening]:
    for (a, b), met in watch.touches.items():
        touched, parted = (f"{a} and {b} touched", f"{a} and {b} parted") if a != b else (
            f"{a} touched itself", f"{a} no longer touched itself"
        )  # fmt: skip
        yield Happening(met.first, met.first, "touch", (a, b), touched + _times(met))
        if met.is_over:
            yield Happening(met.last, met.last, "part", (a, b), parted)
    for (thing, zone), met in watch.insides.items():
        if met.times:
            yield Happening(met.first, met.first, "enter", (zone, thing), f"{thing} entered {zone}{_times(met)}")
        if met.is_over:
            yield Happening(met.last, met.last, "leave", (zone, thing), f"{thing} left {zone}")
    if watch.unlisted:
        yield Happening(end, end, "unlisted", (), f"{watch.unlisted:,} more times things touched that are not listed")


def _times(met: Meeting) -> str:
    return f" ({met.times} times in all)" if met.times > 1 else ""
