"""The form of a check: what is measured, of what, its bounds, when, and the keys that are held meanwhile."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.materials import set_checks
from sandbox.editor.items import chosen_bodies, chosen_particles
from sandbox.editor.panel.field_info import FieldInfo, Pick, fields_of
from sandbox.editor.panel.level_properties import FIRST_ROOM
from sandbox.editor.panel.property import Property, Section, named, with_axes
from sandbox.level.checks import METRICS, SUBJECTS, CheckDef, HoldDef, bounds_of, window_of
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.plan.actuators import driving_keys

# When a check is measured, by the field that says so.
_WHEN = {"after": "once, after", "eventually": "at some moment", "always": "all the time"}
_WINDOWS = ("always", "eventually")
# How long [s] a window is that nobody has set.
_WINDOW = 10.0
# How far [m] what a new check measures may at least go to the left: rounding and a settling body pass it.
LEEWAY = 0.1
_PICKS: dict[str, Pick] = {"particle": "particle", "other": "particle", "body": "body", "box": "box"}
_SUBJECT_TITLES = {"other": "To", "particle": "Of particle", "body": "Of body"}
_BOUNDS = {"at_least": "at_most", "at_most": "at_least"}


def check_properties(document: Document, index: int) -> tuple[Section, ...]:
    """Properties of a check of the level, by its index; () where there is none."""
    checks = document.level.checks
    if not 0 <= index < len(checks):
        return ()
    check, about = checks[index], fields_of(CheckDef)
    measured = METRICS[check.metric]
    labels = tuple(each.label for each in METRICS.values())
    metric = replace(about["metric"], title="What", choices=tuple(METRICS), labels=labels)
    made = [
        Property("name", about["name"], check.name, partial(_set, index, "name")),
        Property("metric", metric, check.metric, partial(_set_metric, index)),
    ]
    for name in SUBJECTS:
        if measured.takes(name):
            each = replace(about[name], pick=_PICKS[name], title=_SUBJECT_TITLES.get(name, about[name].title))
            if name == "body":
                each = replace(each, empty="" if measured.needs_one else "everything")
            made.append(Property(name, each, getattr(check, name), partial(_set_subject, index, name)))
    for name in _BOUNDS:
        # What holds where a check names no bound.
        usual = measured.at_least if name == "at_least" and check.at_most is None else None
        each = replace(about[name], unit=measured.unit, empty="no bound" if usual is None else f"{usual:g}")
        remark = partial(_bound_remark, index, name)
        made.append(Property(name, each, getattr(check, name), partial(_set_bound, index, name), remark=remark))
    made += [*_time_properties(check, index), *_hold_properties(document, check, index)]
    return (Section("Check", named(made, f"Check {check.name}")),)


def _time_properties(check: CheckDef, index: int) -> list[Property]:
    present = next((name for name in _WINDOWS if getattr(check, name) is not None), "after")
    momentary = METRICS[check.metric].momentary
    choices = tuple(_WHEN) if momentary else ("after",)
    tip = "When it must be true: at one time, at some moment of a span, or all the time."
    about = FieldInfo("choice", "When", choices=choices, labels=tuple(_WHEN[name] for name in choices), tooltip=tip)
    made = [Property("when", about, present, partial(_set_when, index))] if momentary else []
    if present == "after":
        return [*made, Property("after", fields_of(CheckDef)["after"], check.after, partial(_set, index, "after"))]
    tip = "The span of time, from the start of the level."
    span = FieldInfo("point", "From, to", "s", low=0.0, tooltip=tip)
    return [*made, Property("span", span, window_of(check), partial(_set_span, index), ("From", "To"))]


def _hold_properties(document: Document, check: CheckDef, index: int) -> list[Property]:
    keys = sorted(driving_keys(document.level))
    if not keys and not check.hold:
        return []
    tip = "Hold a key during the run, from one time to another. Otherwise no key is pressed."
    about = FieldInfo("part", "Hold a key", tooltip=tip)
    made = [Property("hold", about, False, lambda document, _: _add_hold(document, index))]
    for number, hold in enumerate(check.hold):
        key = replace(fields_of(HoldDef)["key"], title="Hold", optional=True)
        span = FieldInfo("point", "From, to", "s", low=0.0, tooltip="From when to when the key is held.")
        made.append(Property(f"hold.{number}.key", key, hold.key, partial(_set_held_key, index, number)))
        write = partial(_set_held_span, index, number)
        made.append(Property(f"hold.{number}.during", span, hold.during, write, ("From", "To")))
    return made


def add_check(document: Document) -> Document:
    """Add a check: of how far right what is selected comes, or else that nothing breaks. Raises EditError.

    It holds of a level in which nothing moves or breaks.
    """
    taken = {check.name for check in document.level.checks}
    number = next(k for k in range(1, len(taken) + 2) if f"check {k}" not in taken)
    name, level = f"check {number}", document.level
    bodies, loose = chosen_bodies(level, document.selection), chosen_particles(level, document.selection)
    if bodies:
        x = float(expansion(bodies[0]).position[:, 0].mean())
        check = CheckDef(name=name, metric="x", body=bodies[0].id, at_least=float(math.floor(x - LEEWAY)))
    elif loose:
        check = CheckDef(
            name=name, metric="x", particle=loose[0].id, at_least=float(math.floor(loose[0].position[0] - LEEWAY))
        )
    else:
        check = CheckDef(name=name, metric="broken_springs", at_most=0.0)
    return set_checks(document, [*level.checks, check])


def delete_check(document: Document, index: int) -> Document:
    """Delete a check by its index."""
    return set_checks(document, [check for k, check in enumerate(document.level.checks) if k != index])


def _changed(document: Document, index: int, **fields: Any) -> Document:
    checks = list(document.level.checks)
    checks[index] = replaced(checks[index], **fields)
    return set_checks(document, checks)


def _set(index: int, field: str, document: Document, value: Any) -> Document:
    return _changed(document, index, **{field: value})


def _set_metric(index: int, document: Document, value: Any) -> Document:
    """Give a check another metric, with bounds of its own and something that it can be measured of."""
    check, measured = document.level.checks[index], METRICS[value]
    kept = {name: getattr(check, name) if measured.takes(name) else None for name in SUBJECTS}
    for name in measured.needs:
        if kept[name] is None:
            kept[name] = FIRST_ROOM if name == "box" else _some_particle(document)
    if measured.needs_one and all(kept[name] is None for name in measured.needs_one):
        body = chosen_bodies(document.level, document.selection)
        kept |= {"body": body[0].id} if body else {"particle": _some_particle(document)}
    low, high = measured.usual
    windows: dict[str, Any] = {} if measured.momentary else dict.fromkeys(_WINDOWS)
    return _changed(document, index, metric=value, at_least=low, at_most=high, **kept, **windows)


def _some_particle(document: Document) -> str | None:
    """A particle that a new check measures: one of the selection, else of the level."""
    level, selection = document.level, document.selection
    loose = [*chosen_particles(level, selection), *(() if selection else level.particles)]
    bodies: Sequence[AnyBody] = [*chosen_bodies(level, selection), *(() if selection else level.bodies)]
    if loose:
        return loose[0].id
    return f"{bodies[0].id}.{expansion(bodies[0]).count[0] - 1}" if bodies else None


def _set_subject(index: int, field: str, document: Document, value: Any) -> Document:
    """Set what a check measures: a particle or a body, not both."""
    if field == "box":
        if value is None or len(value) != 4:
            raise EditError("a box has four numbers: left, bottom, right, top")
        (left, right), (bottom, top) = sorted((value[0], value[2])), sorted((value[1], value[3]))
        return _changed(document, index, box=(left, bottom, right, top))
    other = {"particle": "body", "body": "particle"}.get(field)
    return _changed(document, index, **{field: value}, **({other: None} if other and value is not None else {}))


def _contradicted(document: Document, index: int, field: str, value: Any) -> bool:
    """Whether a bound that is set so leaves nothing between it and the other one."""
    other = getattr(document.level.checks[index], _BOUNDS[field])
    return value is not None and other is not None and (value > other if field == "at_least" else value < other)


def _set_bound(index: int, field: str, document: Document, value: Any) -> Document:
    """Set a bound of a check; the other one is taken out where the two contradict each other."""
    goes = {_BOUNDS[field]: None} if _contradicted(document, index, field, value) else {}
    return _changed(document, index, **{field: value}, **goes)


def _bound_remark(index: int, field: str, document: Document, value: Any) -> str:
    if not _contradicted(document, index, field, value):
        return ""
    low, high = bounds_of(document.level.checks[index])
    return f"at most {high:g} is gone" if field == "at_least" else f"at least {low:g} is gone"


def _set_when(index: int, document: Document, value: Any) -> Document:
    check = document.level.checks[index]
    start, end = window_of(check)
    window = (0.0, end or _WINDOW) if start == end else (start, end)
    fields: dict[str, Any] = {name: window if name == value else None for name in _WINDOWS}
    return _changed(document, index, **fields, **({"after": end} if value == "after" else {}))


def _ordered(value: Any, old: tuple[float, float]) -> tuple[float, float]:
    """Two times, the earlier first: the one that was not typed goes along."""
    start, end = with_axes(value, old)
    if start <= end:
        return start, end
    return (start, start + old[1] - old[0]) if value[0] is not None else (max(0.0, end - old[1] + old[0]), end)


def _set_span(index: int, document: Document, value: Any) -> Document:
    check = document.level.checks[index]
    field = "always" if check.always is not None else "eventually"
    return _changed(document, index, **{field: _ordered(value, window_of(check))})


def _add_hold(document: Document, index: int) -> Document:
    check = document.level.checks[index]
    held = {hold.key for hold in check.hold}
    keys = sorted(driving_keys(document.level))
    if not keys:
        raise EditError("no key drives anything in this level")
    key = next((key for key in keys if key not in held), keys[0])
    return _changed(document, index, hold=(*check.hold, HoldDef(key=key, during=(0.0, window_of(check)[1]))))


def _set_held_key(index: int, number: int, document: Document, value: Any) -> Document:
    """Set the key that a check holds, or none."""
    holds = list(document.level.checks[index].hold)
    holds[number : number + 1] = [] if value is None else [replaced(holds[number], key=value)]
    return _changed(document, index, hold=tuple(holds))


def _set_held_span(index: int, number: int, document: Document, value: Any) -> Document:
    holds = list(document.level.checks[index].hold)
    holds[number] = replaced(holds[number], during=_ordered(value, holds[number].during))
    return _changed(document, index, hold=tuple(holds))
