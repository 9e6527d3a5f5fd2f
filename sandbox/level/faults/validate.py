"""What no single field can tell: names, references, counts after expansion, outlines; all before anything is built."""

import itertools
import math
from collections.abc import Iterator
from typing import Any

from sandbox.level.build.layout import Layout
from sandbox.level.build.welds import weld_faults
from sandbox.level.checks import PARTICLE_METRICS, CheckDef
from sandbox.level.faults.actuator_faults import driven_faults
from sandbox.level.faults.level_error import Fault, LevelError, json_path, shown, suggestion
from sandbox.level.format.limits import (
    COORDINATE_LIMIT,
    CORNER_LIMIT,
    DEFAULT_MATERIAL,
    PARTICLE_LIMIT,
    POLYGON_WORK_LIMIT,
    SPACING_RANGE,
    SPEED_LIMIT,
    SPRING_LIMIT,
    TEXT_LIMIT,
)
from sandbox.level.format.model import Level
from sandbox.level.format.surfaces import surface_faults
from sandbox.level.kinds.bodies import (
    AnyBody,
    BoxShape,
    BridgeDef,
    CircleShape,
    GirderDef,
    JellyDef,
    MeshDef,
    PolygonShape,
    RingDef,
    WebDef,
    WheelDef,
)
from sandbox.level.kinds.polygon import grid_bounds, is_simple
from sandbox.level.kinds.shapes import form_count, girder_offset, turn


def check_level(level: Level, source: str) -> None:
    """Raise LevelError with every fault of a level, named by source, that its fields alone do not show."""
    faults = level_faults(level)
    first = next(faults, None)
    if first is not None:
        raise LevelError(source, itertools.chain([first], faults))


def level_faults(level: Level) -> Iterator[Fault]:
    """Every fault of a level that its fields alone do not show, in the order of the file; nothing is built for it."""
    counts, too_large = _counts(level)
    if too_large:
        yield from too_large
        return
    layout = Layout(level, [particles for particles, _ in counts])
    # What welds make can only be looked at where all else is sound.
    sound = True
    for fault in _all_faults(level, counts, layout):
        sound = False
        yield fault
    if sound:
        yield from weld_faults(level, layout)


def _counts(level: Level) -> tuple[list[tuple[int, int]], list[Fault]]:
    """Particles and springs of each body's form, and the fault of a level that is too large, at which it stops."""
    counts: list[tuple[int, int]] = []
    particles, springs, corners, work = len(level.particles), len(level.springs), 0, 0
    for index, body in enumerate(level.bodies):
        if isinstance(body, JellyDef) and isinstance(body.shape, PolygonShape):
            sides = len(body.shape.polygon)
            _, _, columns, rows = grid_bounds(body.shape.polygon, body.spacing)
            corners, work = corners + sides, work + rows * (columns + sides)
        fault = _beyond_polygon(corners, work)
        if fault is None:
            body_particles, body_springs = form_count(body)
            cut = len({number for number in body.cut if number < body_springs})
            particles, springs = particles + body_particles, springs + body_springs - cut
            fault = _beyond_count(particles, springs)
        if fault is not None:
            return counts, [(json_path(["bodies", index, *_SIZE.get(body.type, ["segments"])]), fault)]
        counts.append((body_particles, body_springs))
    fault = _beyond_count(particles, springs)
    return counts, [] if fault is None else [("", fault)]


# Where a body says how large it is, if not by its segments.
_SIZE = {"jelly": ["spacing"], "web": ["rings"], "mesh": []}


def _beyond_polygon(corners: int, work: int) -> str | None:
    if corners > CORNER_LIMIT:
        return f"brings the corners of all polygons above {CORNER_LIMIT:,}; use fewer"
    if work > POLYGON_WORK_LIMIT:
        return "is too fine for so large a polygon; make it larger"
    return None


def _beyond_count(particles: int, springs: int) -> str | None:
    for number, noun, limit in ((particles, "particles", PARTICLE_LIMIT), (springs, "springs", SPRING_LIMIT)):
        if number > limit:
            return f"brings the level above {limit:,} {noun}; make it smaller or coarser"
    return None


def _all_faults(level: Level, counts: list[tuple[int, int]], layout: Layout) -> Iterator[Fault]:
    if level.view is not None and not (level.view[0] < level.view[2] and level.view[1] < level.view[3]):
        yield "view", "left and bottom come first and must be below right and top"
    for path, name in layout.repeated:
        yield path, f"{shown(name)} is taken; every body and loose particle needs an id of its own"
    for index, body in enumerate(level.bodies):
        path = f"bodies.{index}"
        yield from _material(level, path, body.material)
        yield from _mesh(path, body) if isinstance(body, MeshDef) else outline_faults(path, body)
        if counts[index][0] == 0:
            yield f"{path}.spacing", "no point of the grid lies inside the polygon; make it smaller"
        else:
            yield from _changes(path, body, *counts[index])
    yield from surface_faults(level)
    yield from _springs(level, layout)
    yield from driven_faults(level)
    for index, (a, b) in enumerate(level.welds):
        yield from _pair(f"welds.{index}", layout, {"0": a, "1": b})
    for index, check in enumerate(level.checks):
        yield from _check(f"checks.{index}", check, layout)
    yield from _extras(level)


def _material(level: Level, path: str, name: str) -> Iterator[Fault]:
    if name != DEFAULT_MATERIAL and name not in level.materials:
        yield f"{path}.material", f"there is no material {shown(name)}" + suggestion(name, level.materials)


def _mesh(path: str, body: MeshDef) -> Iterator[Fault]:
    size = len(body.particles)
    for name, values in (("masses", body.masses), ("velocities", body.velocities)):
        if values is not None and len(values) != size:
            yield f"{path}.{name}", f"has {len(values)} items for {size} particles; give one each"
    for axis, base in enumerate(body.velocity):
        if any(abs(base + velocity[axis]) > SPEED_LIMIT for velocity in body.velocities or ()):
            yield f"{path}.velocities", f"with the body's velocity one goes beyond the limit {SPEED_LIMIT:.15g}"
    for index, (a, b) in enumerate(body.springs):
        if max(a, b) >= size:
            yield f"{path}.springs.{index}", f"{shown(max(a, b))} is beyond the last particle, {size - 1}"
        elif a == b:
            yield f"{path}.springs.{index}", f"joins particle {a} to itself; name two particles"


def _changes(path: str, body: AnyBody, particles: int, springs: int) -> Iterator[Fault]:
    """Whether pins, cuts and pose of a body speak of particles and springs that its form has."""
    for index, particle in enumerate(body.pinned):
        if particle >= particles:
            yield f"{path}.pinned.{index}", f"{shown(particle)} is beyond the last particle, {particles - 1}"
    for index, spring in enumerate(body.cut):
        if spring >= springs:
            last = f"is beyond the last spring, {springs - 1}" if springs else "does not exist; the body has no springs"
            yield f"{path}.cut.{index}", f"{shown(spring)} {last}"
    if body.pose is not None and len(body.pose) != particles:
        yield f"{path}.pose", f"has {len(body.pose)} items for {particles} particles; give one each"


def outline_faults(path: str, body: AnyBody) -> Iterator[Fault]:
    """Whether what a body expands to stays inside the world."""
    if isinstance(body, BridgeDef):
        if min(body.start[1], body.end[1]) - body.height < -COORDINATE_LIMIT:
            yield f"{path}.height", f"takes the bottom row beyond the limit {-COORDINATE_LIMIT:.15g}"
    elif isinstance(body, GirderDef):
        yield from _girder(path, body)
    elif isinstance(body, WebDef | WheelDef | RingDef):
        if isinstance(body, WheelDef) and body.thickness >= body.radius:
            yield f"{path}.thickness", f"{shown(body.thickness)} is not below the radius, {shown(body.radius)}"
        if max(map(abs, body.position)) + body.radius > COORDINATE_LIMIT:
            yield f"{path}.radius", f"takes the {body.type} beyond the limit {COORDINATE_LIMIT:.15g}"
    elif isinstance(body, JellyDef):
        if isinstance(body.shape, PolygonShape) and not is_simple(body.shape.polygon):
            yield f"{path}.shape.polygon", "its sides touch or cross, or a corner comes twice; draw it without"
        if _farthest(body) > COORDINATE_LIMIT:
            yield f"{path}.position", f"takes the shape beyond the limit {COORDINATE_LIMIT:.15g}"


def _girder(path: str, body: GirderDef) -> Iterator[Fault]:
    apart = [end - start for start, end in zip(body.start, body.end, strict=True)]
    if max(map(abs, apart)) < SPACING_RANGE[0]:
        yield f"{path}.end", f"is where start is; a girder is at least {SPACING_RANGE[0]:.15g} long"
        return
    half = 0.5 / body.segments
    for axis, offset in enumerate(girder_offset(body)):
        inner = (body.start[axis] + half * apart[axis], body.end[axis] - half * apart[axis])
        if max(abs(place + offset) for place in inner) > COORDINATE_LIMIT:
            yield f"{path}.height", f"takes the second row beyond the limit {COORDINATE_LIMIT:.15g}"
            return


def _farthest(body: JellyDef) -> float:
    """Largest absolute coordinate [m] of a jelly's outline."""
    if isinstance(body.shape, CircleShape):
        return max(map(abs, body.position)) + body.shape.circle
    if isinstance(body.shape, BoxShape):
        x, y = body.shape.box[0] / 2, body.shape.box[1] / 2
        corners: tuple[tuple[float, float], ...] = ((x, y), (-x, y), (-x, -y), (x, -y))
    else:
        corners = body.shape.polygon
    cosine, sine = turn(body.angle)
    across, up = body.position
    return max(max(abs(across + x * cosine - y * sine), abs(up + x * sine + y * cosine)) for x, y in corners)


def _springs(level: Level, layout: Layout) -> Iterator[Fault]:
    for index, spring in enumerate(level.springs):
        path = f"springs.{index}"
        yield from _material(level, path, spring.material)
        yield from _pair(path, layout, {"a": spring.a, "b": spring.b})


def _pair(path: str, layout: Layout, references: dict[str, str]) -> Iterator[Fault]:
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


def _check(path: str, check: CheckDef, layout: Layout) -> Iterator[Fault]:
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


def _extras(level: Level) -> Iterator[Fault]:
    yield from _kept(["extras"], level.extras)
    for name, items in (
        ("terrain", level.terrain),
        ("bodies", level.bodies),
        ("particles", level.particles),
        ("springs", level.springs),
    ):
        for index, item in enumerate(items):
            if item.extras:
                yield from _kept([name, index, "extras"], item.extras)


def _is_finite(value: Any) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    return not isinstance(value, int) or value.bit_length() <= 1024


def _kept(path: list[Any], value: Any) -> Iterator[Fault]:
    """Limits of what is kept for other tools: finite numbers, short texts."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _kept([*path, key], key)
            yield from _kept([*path, key], item)
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _kept([*path, index], item)
    elif isinstance(value, str):
        if len(value) > TEXT_LIMIT:
            yield json_path(path), f"has {len(value)} characters; at most {TEXT_LIMIT} are allowed"
    elif not _is_finite(value):
        yield json_path(path), f"{shown(value)} is not a finite number"
