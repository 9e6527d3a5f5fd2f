"""check_level: finds the faults that involve several fields, before anything is built."""

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from sandbox.level.document.model import HookeMaterial, Level, SpringDef, TerrainDef, ZoneDef
from sandbox.level.faults.reference_faults import (
    check_faults,
    look_faults,
    material_faults,
    spring_faults,
    weld_reference_faults,
)
from sandbox.level.faults.rule_faults import cut_spring_faults, rule_faults
from sandbox.level.format.actuator_defs import HydraulicDef
from sandbox.level.format.level_error import Fault, LevelError, json_path, shown, suggestion
from sandbox.level.format.limits import (
    COLLISION_GROUP_LIMIT,
    CORNER_LIMIT,
    MASS_RANGE,
    MOTOR_LIMIT,
    PARTICLE_LIMIT,
    POLYGON_WORK_LIMIT,
    SPRING_LIMIT,
    TEXT_LIMIT,
    most_limited,
)
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.geometry import is_simple
from sandbox.level.kinds.wheel import WheelDef
from sandbox.level.plan.actuators import actuators
from sandbox.level.plan.plan import Plan, kept_plan
from sandbox.level.plan.surfaces import TERRAIN_NAME, colliding_items, group_bits
from sandbox.level.rules.player_limits import hand_faults
from sandbox.physics.softness.firmness import Firmness, FirmnessRange, OutOfReach, lowest_mode_of


def check_level(level: Level, source: str) -> Plan:
    """The plan of a sound level: the one that the level keeps, or a new one.

    Raises LevelError with every fault that involves several fields; source names the level in it.
    """
    plan = kept_plan(level)
    if plan is None:
        plan = Plan(level)
        faults = level_faults(level, plan)
        first = next(faults, None)
        if first is not None:
            raise LevelError(source, itertools.chain([first], faults))
    return plan


def level_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    """Every fault that involves several fields, in the order of the file."""
    too_large = _size_fault(level, plan)
    if too_large is not None:
        yield too_large
        return
    # Welds and forms of bodies can be checked only if everything else is sound.
    sound = True
    for fault in _all_faults(level, plan):
        sound = False
        yield fault
    if sound:
        yield from _weld_faults(level, plan)
        yield from _firmness_faults(level, plan)
        yield from cut_spring_faults(level, plan)


def _all_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    layout = plan.layout
    if level.view is not None and not (level.view[0] < level.view[2] and level.view[1] < level.view[3]):
        yield "view", "left and bottom come first and must be below right and top"
    for path, name in layout.repeated:
        yield path, f"{shown(name)} is taken; every body and loose particle needs an id of its own"
    for index, body in enumerate(plan.bodies):
        path = f"bodies.{index}"
        yield from material_faults(level, path, body.body.material)
        yield from body.faults(path)
        if body.form_count[0]:
            yield from body.change_faults(path)
    yield from _collision_faults(level)
    yield from _zone_faults(level)
    yield from spring_faults(level, layout)
    yield from _actuator_faults(level)
    yield from weld_reference_faults(level, layout)
    yield from rule_faults(level, layout)
    yield from hand_faults(level.hands, layout.owners)
    yield from check_faults(level, layout)
    yield from look_faults(level)
    yield from _extras_faults(level)


def _size_fault(level: Level, plan: Plan) -> Fault | None:
    """The fault of a level that is too large. Counting stops at the limit, before anything of that size exists."""
    particles, springs, corners, work = len(level.particles), len(level.springs), 0, 0
    for index, body in enumerate(plan.bodies):
        body_corners, body_work = body.polygon_work
        corners, work = corners + body_corners, work + body_work
        fault = _beyond_polygon(corners, work)
        if fault is None:
            body_particles, body_springs = body.count
            particles, springs = particles + body_particles, springs + body_springs
            fault = _beyond_count(particles, springs)
        if fault is not None:
            return json_path(["bodies", index, *body.size_path]), fault
    fault = _beyond_count(particles, springs)
    return None if fault is None else ("", fault)


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


def _collision_faults(level: Level) -> Iterator[Fault]:
    """Faults of terrain, walls and collision groups."""
    taken: set[str] = {item.id for _, item in colliding_items(level)}
    yield from _outline_faults("terrain", level.terrain, "piece of terrain", taken, _terrain_shape_faults)
    walls = level.walls
    if walls is not None and not (walls.box[0] < walls.box[2] and walls.box[1] < walls.box[3]):
        yield "walls.box", "left and bottom come first and must be below right and top"
    groups = group_bits(level)
    for path, item in colliding_items(level):
        if item.collision_group == TERRAIN_NAME:
            yield f"{path}.collision_group", f'"{TERRAIN_NAME}" is the group of terrain and walls; take another name'
        for number, name in enumerate(item.collides if isinstance(item.collides, tuple) else ()):
            if name not in groups:
                yield f"{path}.collides.{number}", f"there is no group {shown(name)}" + suggestion(name, groups)
    free = sum(isinstance(body, WheelDef) and not body.touches_mount for body in level.bodies)
    if free and len(groups) + free > COLLISION_GROUP_LIMIT:
        most = max(COLLISION_GROUP_LIMIT - len(groups), 0)
        yield "bodies", f"have {free} wheels that do not touch their mounts; at most {most} may beside the groups"
    elif len(groups) > COLLISION_GROUP_LIMIT:
        yield "bodies", f"name {len(groups) - 2} collision groups; at most {COLLISION_GROUP_LIMIT - 2} are allowed"


def _outline_faults(
    field: str, parts: Sequence[Any], noun: str, taken: set[str], faults_of: Callable[[str, Any], Iterator[Fault]]
) -> Iterator[Fault]:
    """Faults of the ids and shapes of terrain or zones; taken: the ids of other things."""
    corners = 0
    for index, part in enumerate(parts):
        path = f"{field}.{index}"
        if part.id in taken:
            yield f"{path}.id", f"{shown(part.id)} is taken; every {noun} needs an id of its own"
        taken.add(part.id)
        corners += len(getattr(part, "polyline", None) or part.polygon or ())
        if corners > CORNER_LIMIT:
            yield path, f"brings the corners of all {field} above {CORNER_LIMIT:,}; use fewer"
            break
        yield from faults_of(path, part)


def _terrain_shape_faults(path: str, piece: TerrainDef) -> Iterator[Fault]:
    if (piece.polyline is None) == (piece.polygon is None):
        yield path, "needs one of polyline and polygon"
    elif piece.polygon is not None:
        if len(piece.polygon) < 3:
            yield f"{path}.polygon", f"has {len(piece.polygon)} corners; a polygon has at least 3"
        elif not is_simple(piece.polygon):
            yield f"{path}.polygon", "its sides touch or cross, or a corner comes twice; draw it without"
    elif any(a == b for a, b in itertools.pairwise(piece.polyline or ())):
        yield f"{path}.polyline", "a corner comes twice in a row; take one out"


def _zone_faults(level: Level) -> Iterator[Fault]:
    """Faults of the ids, shapes and water of zones."""
    taken = {item.id for items in (level.bodies, level.particles, level.terrain) for item in items}
    yield from _outline_faults("zones", level.zones, "zone", taken, _zone_shape_faults)


def _zone_shape_faults(path: str, zone: ZoneDef) -> Iterator[Fault]:
    box, polygon = zone.box, zone.polygon
    if sum(shape is not None for shape in (box, zone.circle, polygon)) != 1:
        yield path, "needs one of box, circle and polygon"
    elif box is not None and not (box[0] < box[2] and box[1] < box[3]):
        yield f"{path}.box", "left and bottom come first and must be below right and top"
    elif polygon is not None and not is_simple(polygon):
        yield f"{path}.polygon", "its sides touch or cross, or a corner comes twice; draw it without"
    if zone.water is not None and box is None:
        yield f"{path}.water", "only a box holds water; give the zone a box, or take the water out"


def _actuator_faults(level: Level) -> Iterator[Fault]:
    """Every fault of muscles, hydraulics and motors that involves several fields."""
    for index, spring in enumerate(level.springs):
        if spring.hydraulic is not None:
            yield from _hydraulic_faults(f"springs.{index}", spring, spring.hydraulic)
    yield from _limited_force_faults(level)
    motors = 0
    for actuator in actuators(level):
        is_spring = isinstance(actuator.drive, HydraulicDef)
        path = f"springs.{actuator.owner}.hydraulic" if is_spring else f"bodies.{actuator.owner}.motor"
        if actuator.drive.key is not None and actuator.drive.key == actuator.drive.reverse_key:
            yield f"{path}.reverse_key", f"{shown(actuator.drive.key)} is the key as well; name another"
        motors += not is_spring
        if motors == MOTOR_LIMIT + 1 and not is_spring:
            yield path, f"brings the level above {MOTOR_LIMIT} motors; take some out"


def _hydraulic_faults(path: str, spring: SpringDef, hydraulic: HydraulicDef) -> Iterator[Fault]:
    if spring.drive is not None:
        yield f"{path}.drive", "is a muscle where a hydraulic is; keep one of them"
    if hydraulic.shortest > hydraulic.longest:
        yield f"{path}.hydraulic.shortest", f"{shown(hydraulic.shortest)} is above longest, {shown(hydraulic.longest)}"
    elif spring.rest_length is not None and not hydraulic.shortest <= spring.rest_length <= hydraulic.longest:
        yield (
            f"{path}.rest_length",
            f"{shown(spring.rest_length)} is not from {shown(hydraulic.shortest)} to {shown(hydraulic.longest)}, "
            "between which the hydraulic goes",
        )


def _limited_force_faults(level: Level) -> Iterator[Fault]:
    """The fault of too many springs with a limited force."""
    drives = [
        (f"bodies.{index}.drive", expansion(body).form_count[1])
        for index, body in enumerate(level.bodies)
        if body.drive is not None and body.drive.force is not None
    ]
    for index, spring in enumerate(level.springs):
        limited = [
            name
            for name, drive in (("drive", spring.drive), ("hydraulic", spring.hydraulic))
            if drive is not None and drive.force is not None
        ]
        drives += [(f"springs.{index}.{name}", 1) for name in limited]
    if not drives:
        return
    most = most_limited(len(level.particles) + sum(expansion(body).form_count[0] for body in level.bodies))
    total = 0
    for path, count in drives:
        total += count
        if total > most:
            yield f"{path}.force", f"brings the level above {most:,} springs of limited force; take some out"
            return


def _extras_faults(level: Level) -> Iterator[Fault]:
    """Faults of the extras of a level and of everything in it."""
    yield from _extra_faults(["extras"], level.extras)
    for name in ("terrain", "zones", "bodies", "particles", "springs"):
        for index, item in enumerate(getattr(level, name)):
            if item.extras:
                yield from _extra_faults([name, index, "extras"], item.extras)


def _is_finite(value: Any) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    return not isinstance(value, int) or value.bit_length() <= 1024


def _extra_faults(path: list[Any], value: Any) -> Iterator[Fault]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _extra_faults([*path, key], key)
            yield from _extra_faults([*path, key], item)
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _extra_faults([*path, index], item)
    elif isinstance(value, str):
        if len(value) > TEXT_LIMIT:
            yield json_path(path), f"has {len(value)} characters; at most {TEXT_LIMIT} are allowed"
    elif not _is_finite(value):
        yield json_path(path), f"{shown(value)} is not a finite number"


def _weld_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    """Faults of welds; the level has no other faults."""
    if not level.welds:
        return
    layout, firsts = plan.layout, plan.first_of_weld
    is_welded = firsts != np.arange(len(firsts))
    is_welded[firsts[is_welded]] = True
    weight = np.zeros(len(firsts))
    for index, (body, made) in enumerate(zip(level.bodies, plan.bodies, strict=True)):
        owner = layout.owners[body.id]
        mine = slice(owner.first, owner.first + owner.size)
        if not np.any(is_welded[mine]):
            continue
        weight[mine] = made.mass
        # A spring loses its length only where two particles of its own body are one.
        if len(np.unique(firsts[mine])) == owner.size:
            continue
        ends = firsts[owner.first + made.pairs]
        for number in made.numbers[ends[:, 0] == ends[:, 1]].tolist():
            fault = f'the welds make one particle of both ends of "{body.id}:{number}"; take a weld out or cut {number}'
            yield f"bodies.{index}", fault
    for particle in level.particles:
        weight[layout.slot(particle.id)] = particle.mass
    ends = firsts[plan.spring_ends]
    for index in np.flatnonzero(ends[:, 0] == ends[:, 1]).tolist():
        yield f"springs.{index}", "the welds make one particle of both its ends; take a weld or the spring out"
    sums = np.bincount(firsts, weights=weight, minlength=len(firsts))
    for index, (a, _) in enumerate(level.welds):
        if sums[firsts[layout.slot(a)]] > MASS_RANGE[1]:
            yield (
                f"welds.{index}",
                f"makes a particle heavier than the limit {MASS_RANGE[1]:.15g}; make its parts lighter",
            )


def _firmness_faults(level: Level, plan: Plan) -> Iterator[Fault]:
    """Faults of the firmness of bodies, and of that which rules give them; the level has no other faults."""
    made = dict(zip((body.id for body in level.bodies), zip(level.bodies, plan.bodies, strict=True), strict=True))
    for index, body in enumerate(level.bodies):
        if body.firmness is not None:
            yield from _asked_faults(level, *made[body.id], body.firmness.asked, f"bodies.{index}.firmness")
    for number, rule in enumerate(level.rules):
        for at, action in enumerate(rule.then):
            if action.sag is not None:
                asked, path = Firmness(sag=action.sag), f"rules.{number}.then.{at}.sag"
                yield from _asked_faults(level, *made[str(action.body)], asked, path)


def _asked_faults(level: Level, body: AnyBody, made: Expansion[Any], asked: Firmness, path: str) -> Iterator[Fault]:
    if isinstance(level.materials.get(body.material), HookeMaterial):
        yield path, f"is not for springs of Hooke's law, which {shown(body.material)} is; take another material"
    elif lowest_mode_of(made.stiff_form) == 0.0:
        yield (
            path,
            f"is for forms that are stiff without pins, and this {body.type} is not: it gives way without any "
            "spring being stretched; brace it, or take firmness out",
        )
    else:
        try:
            FirmnessRange.of(made.stiff_form, level.settings.gravity, level.settings.tick_rate).coefficients(asked)
        except OutOfReach as error:
            yield path, str(error)
