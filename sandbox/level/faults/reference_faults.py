"""Faults of references: names of materials and particles that do not exist, and incomplete checks."""

from collections.abc import Iterator
from typing import Any, Protocol

from sandbox.level.checks import METRICS, SUBJECTS, CheckDef
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import Fault, shown, suggestion
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.plan.actuators import driving_keys
from sandbox.level.plan.plan import Layout


def material_faults(level: Level, path: str, name: str) -> Iterator[Fault]:
    """The fault of a material that does not exist; path: the place that names it."""
    if name != DEFAULT_MATERIAL and name not in level.materials:
        yield f"{path}.material", f"there is no material {shown(name)}" + suggestion(name, level.materials)


def look_faults(level: Level) -> Iterator[Fault]:
    """Faults of names in the look of the level."""
    look = level.look
    if look is None:
        return
    if look.material is not None:
        yield from material_faults(level, "look", look.material)
    names = [*(body.id for body in level.bodies), *(particle.id for particle in level.particles)]
    if look.follow is not None and look.follow not in names:
        fault = f"there is no body or particle {shown(look.follow)}" + suggestion(look.follow, names)
        yield "look.follow", fault


def spring_faults(level: Level, layout: Layout) -> Iterator[Fault]:
    """Faults of the materials and ends of the loose springs."""
    for index, spring in enumerate(level.springs):
        path = f"springs.{index}"
        yield from material_faults(level, path, spring.material)
        yield from _pair_faults(path, layout, {"a": spring.a, "b": spring.b})


def weld_reference_faults(level: Level, layout: Layout) -> Iterator[Fault]:
    """Faults of welds: particles that do not exist, or the same one twice."""
    for index, (a, b) in enumerate(level.welds):
        yield from _pair_faults(f"welds.{index}", layout, {"0": a, "1": b})


def check_faults(level: Level, layout: Layout) -> Iterator[Fault]:
    """Faults of the acceptance checks."""
    keys = driving_keys(level) if any(check.hold for check in level.checks) else {}
    names: set[str] = set()
    for index, check in enumerate(level.checks):
        if check.name in names:
            yield f"checks.{index}.name", f"{shown(check.name)} is taken; every check needs a name of its own"
        names.add(check.name)
        yield from _check_faults(f"checks.{index}", check, layout)
        for number, hold in enumerate(check.hold):
            where = f"checks.{index}.hold.{number}"
            if hold.key not in keys:
                known = ", ".join(sorted(keys)) or "none"
                yield f"{where}.key", f"nothing in the level has the key {shown(hold.key)}; keys that drive: {known}"
            if hold.during[0] > hold.during[1]:
                yield f"{where}.during", "the earlier time comes first"


def _pair_faults(path: str, layout: Layout, references: dict[str, str]) -> Iterator[Fault]:
    """Faults of references, by the last keys of their places, that must name different particles."""
    slots = set()
    for end, reference in references.items():
        try:
            slots.add(layout.slot(reference))
        except LookupError as error:
            yield f"{path}.{end}", str(error.args[0])
            slots.add(-1 - len(slots))
    if len(slots) == 1:
        yield path, f"joins {shown(next(iter(references.values())))} to itself; name two particles"


def _check_faults(path: str, check: CheckDef, layout: Layout) -> Iterator[Fault]:
    box = check.box
    yield from metric_faults(path, check, SUBJECTS, layout)
    if box is not None and METRICS[check.metric].takes("box") and (box[0] >= box[2] or box[1] >= box[3]):
        yield f"{path}.box", "left and bottom come first: left, bottom, right, top"
    yield from _window_faults(path, check)


def bound_faults(path: str, least: float | None, most: float | None, is_needed: bool = True) -> Iterator[Fault]:
    """Faults of the bounds of what is asked for."""
    if least is None and most is None and is_needed:
        yield path, "needs a bound: at_most, at_least or both"
    elif least is not None and most is not None and least > most:
        yield f"{path}.at_least", f"{shown(least)} is above at_most, {shown(most)}"


class MetricAsked(Protocol):
    """A check or a question of a rule, which asks for a metric."""

    metric: Any
    at_most: float | None
    at_least: float | None


def metric_faults(path: str, asked: MetricAsked, subjects: tuple[str, ...], layout: Layout) -> Iterator[Fault]:
    """Faults of the bounds of a metric, and of what it is measured of: of the fields `subjects`."""
    measured = METRICS[asked.metric]
    yield from bound_faults(path, asked.at_least, asked.at_most, measured.at_least is None)
    for field in subjects:
        name, where = getattr(asked, field), f"{path}.{field}"
        as_in_check = "box" if field == "zone" else field
        if name is None and as_in_check in measured.needs:
            yield where, f'is missing; "{asked.metric}" is measured of a {_NOUNS[field]}'
        elif name is not None and not measured.takes(as_in_check):
            named = measured.needs_one or measured.needs[:1]
            owner = " or a ".join(["", *named])[4:] if named else "the whole level"
            yield where, f'"{asked.metric}" is measured of {owner}; take the {field} out'
        elif name is not None:
            yield from subject_faults(field, where, name, layout)
    if measured.needs_one and all(getattr(asked, field) is None for field in measured.needs_one):
        where = f"{path}.{measured.needs_one[0]}"
        yield where, f'is missing; "{asked.metric}" is measured of a particle or a body, name one'
    particle, body = (getattr(asked, field) for field in ("particle", "body"))
    if particle is not None and body is not None and measured.takes("body"):
        yield f"{path}.body", "name a particle or a body, not both"


_NOUNS = {"particle": "particle", "other": "second particle", "body": "body", "box": "box", "zone": "zone"}


def subject_faults(field: str, where: str, value: Any, layout: Layout) -> Iterator[Fault]:
    """The fault of a name in the field `body`, or in one of a particle, that does not exist."""
    if field == "body":
        owner = layout.owners.get(value)
        if owner is None or owner.loose:
            bodies = [name for name, each in layout.owners.items() if not each.loose]
            yield where, f"there is no body {shown(value)}" + suggestion(value, bodies)
    elif field in ("particle", "other"):
        try:
            layout.slot(value)
        except LookupError as error:
            yield where, str(error.args[0])


def _window_faults(path: str, check: CheckDef) -> Iterator[Fault]:
    """Faults of the times of a check."""
    if check.always is not None and check.eventually is not None:
        yield f"{path}.eventually", "a check holds always or eventually, not both; make two of it"
    for field in ("always", "eventually"):
        window = getattr(check, field)
        if window is not None and window[0] > window[1]:
            yield f"{path}.{field}", "the earlier time comes first"
        elif window is not None and not METRICS[check.metric].momentary:
            yield f"{path}.{field}", f'"{check.metric}" is of the last 2 s before one time; take "strain"'
