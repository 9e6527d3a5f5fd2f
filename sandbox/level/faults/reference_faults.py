"""References to nothing: materials and particles that the level does not have, and checks that say too little."""

from collections.abc import Iterator

from sandbox.level.build.layout import Layout
from sandbox.level.checks import PARTICLE_METRICS, CheckDef
from sandbox.level.faults.level_error import Fault, shown, suggestion
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.model import Level


def material_faults(level: Level, path: str, name: str) -> Iterator[Fault]:
    """Whether the level has the material that something at a place in the file names."""
    if name != DEFAULT_MATERIAL and name not in level.materials:
        yield f"{path}.material", f"there is no material {shown(name)}" + suggestion(name, level.materials)


def spring_faults(level: Level, layout: Layout) -> Iterator[Fault]:
    """Faults of the materials and ends of the loose springs."""
    for index, spring in enumerate(level.springs):
        path = f"springs.{index}"
        yield from material_faults(level, path, spring.material)
        yield from _pair_faults(path, layout, {"a": spring.a, "b": spring.b})


def weld_reference_faults(level: Level, layout: Layout) -> Iterator[Fault]:
    """Whether each weld is of two particles that exist."""
    for index, (a, b) in enumerate(level.welds):
        yield from _pair_faults(f"welds.{index}", layout, {"0": a, "1": b})


def check_faults(level: Level, layout: Layout) -> Iterator[Fault]:
    """Faults of the acceptance checks."""
    for index, check in enumerate(level.checks):
        yield from _check_faults(f"checks.{index}", check, layout)


def _pair_faults(path: str, layout: Layout, references: dict[str, str]) -> Iterator[Fault]:
    """Whether two references, by the last part of their places, are of two particles."""
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
    if check.at_most is None and check.at_least is None:
        yield path, "needs a bound: at_most, at_least or both"
    elif check.at_most is not None and check.at_least is not None and check.at_least > check.at_most:
        yield f"{path}.at_least", f"{shown(check.at_least)} is above at_most, {shown(check.at_most)}"
    if check.metric in PARTICLE_METRICS and check.particle is None:
        yield f"{path}.particle", f'is missing; "{check.metric}" is measured of a particle'
    elif check.particle is not None and check.metric not in PARTICLE_METRICS:
        yield f"{path}.particle", f'"{check.metric}" is measured of the whole level; take the particle out'
    elif check.particle is not None:
        try:
            layout.slot(check.particle)
        except LookupError as error:
            yield f"{path}.particle", str(error.args[0])
