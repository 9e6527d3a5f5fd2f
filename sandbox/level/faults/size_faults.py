"""Faults of size: too many particles and springs after expansion, too many corners, too large polygons."""

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import Fault, json_path
from sandbox.level.format.limits import CORNER_LIMIT, PARTICLE_LIMIT, POLYGON_WORK_LIMIT, SPRING_LIMIT
from sandbox.level.plan.plan import Plan


def size_fault(level: Level, plan: Plan) -> Fault | None:
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
