"""Runs a flat level of the Spring Sandbox in pymunk 7, without a window, and prints where particles are.

python read_flat_pymunk.py LEVEL.json [SECONDS [PARTICLE ...]]

Made with: sandbox export LEVEL --to flat -o LEVEL.json
What differs: only discs touch, edges of bodies do not; restitutions are multiplied; areas, bends, motors, hydraulics
and breaking are not there, which is said.
"""

import json
import math
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pymunk

Level = dict[str, Any]

DATA = None  # a level that this program carries with it
# Left out of what pymunk does here, by their keys.
MISSING = ("areas", "bends", "motors", "hydraulics")


def particles(level: Level, space: pymunk.Space) -> list[pymunk.Body]:
    """A body for each particle, with its disc."""
    made = []
    held = {end for spring in level["springs"] for end in (spring["a"], spring["b"])} if "springs" in level else set()
    for number, part in enumerate(level.get("particles", [])):
        mass, radius = part["mass"], part["radius"]
        turns = number not in held
        moment = pymunk.moment_for_circle(mass, 0, radius) if turns and radius > 0 else math.inf
        pinned = part.get("pinned", False)
        body = pymunk.Body(body_type=pymunk.Body.STATIC) if pinned else pymunk.Body(mass, moment)
        body.position = part["position"]
        if not pinned:
            body.velocity = part.get("velocity", (0, 0))
            body.velocity_func = moved(level, part.get("gravity_scale", 1.0))
        space.add(body)
        made.append(body)
        surface = level["surfaces"][part["surface"]]
        if surface["touches"]:
            shape = pymunk.Circle(body, radius)
            shape.friction, shape.elasticity = math.sqrt(surface["friction"]), surface["restitution"]
            mask = sum(1 << group for group in surface["touches"])
            # Particles of one body have one group number here, and so never touch each other.
            group = 0 if part.get("body") is None else part["body"] + 1
            shape.filter = pymunk.ShapeFilter(group=group, categories=1 << surface["group"], mask=mask)
            space.add(shape)
    return made


def moved(level: Level, scale: float) -> Callable[..., None]:
    """How gravity and the air change a velocity."""
    gx, gy = level["gravity"]
    (wind_x, wind_y), drag = level.get("wind", (0, 0)), level.get("drag", 0)

    def velocity_of(body: pymunk.Body, gravity: Any, damping: float, h: float) -> None:
        x, y = body.velocity
        share = drag * h / (1 + drag * h)
        x, y = x + gx * scale * h, y + gy * scale * h
        body.velocity = x + share * (wind_x - x), y + share * (wind_y - y)

    return velocity_of


def springs(level: Level, space: pymunk.Space, bodies: list[pymunk.Body]) -> list[Any]:
    """A damped spring for each spring, a pin joint for each rod; None where both ends are pinned."""
    made = []
    for spring in level.get("springs", []):
        a, b = bodies[spring["a"]], bodies[spring["b"]]
        joint: Any = None
        if dynamic(a) or dynamic(b):
            if spring.get("rod", False):
                joint = pymunk.PinJoint(a, b)
                joint.distance = spring["rest_length"]
            else:
                joint = pymunk.DampedSpring(a, b, (0, 0), (0, 0), spring["rest_length"], spring["k"], spring["c"])
            space.add(joint)
        made.append(joint)
    return made


def dynamic(body: pymunk.Body) -> bool:
    return bool(body.body_type == pymunk.Body.DYNAMIC)


def terrain(level: Level, space: pymunk.Space) -> None:
    """Segments of lines and polygons."""
    for piece in level.get("terrain", []):
        corners = piece["corners"] + (piece["corners"][:1] if piece["kind"] != "line" else [])
        for start, end in pairwise(corners):
            shape = pymunk.Segment(space.static_body, start, end, 0)
            shape.friction, shape.elasticity = math.sqrt(piece["friction"]), piece["restitution"]
            shape.filter = pymunk.ShapeFilter(categories=1)
            space.add(shape)


def drive(level: Level, joints: list[Any], tick: int) -> None:
    """Rest lengths of muscles at a tick: two parabolas a period."""
    for muscle in level.get("muscles", []):
        u = (tick % muscle["period"]) / muscle["period"] + muscle["phase"]
        u -= u >= 1
        wave = 16 * u * (0.5 - u) if u < 0.5 else -16 * (u - 0.5) * (1 - u)
        length = level["springs"][muscle["spring"]]["rest_length"] * (1 + muscle["amplitude"] * wave)
        joint = joints[muscle["spring"]]
        setattr(joint, "distance" if isinstance(joint, pymunk.PinJoint) else "rest_length", length)


def run(level: Level, seconds: float) -> list[pymunk.Body]:
    """The bodies of the level's particles after some time."""
    space = pymunk.Space()
    space.damping = 1.0
    space.iterations = 30
    bodies = particles(level, space)
    joints = springs(level, space, bodies)
    terrain(level, space)
    for tick in range(round(seconds * level["rate"])):
        drive(level, joints, tick)
        for _ in range(level["steps"]):
            space.step(1 / (level["rate"] * level["steps"]))
    return bodies


def main(arguments: list[str]) -> None:
    level = DATA or json.loads(Path(arguments.pop(0)).read_text(encoding="utf-8"))
    missing = [f"{len(level[key])} {key}" for key in MISSING if level.get(key)]
    if missing:
        print(f"not here: {', '.join(missing)}", file=sys.stderr)
    bodies = run(level, float(arguments[0]) if arguments else 1.0)
    names = [part["name"] for part in level.get("particles", [])]
    for name in arguments[1:] or names:
        print(name, *bodies[names.index(name)].position)


if __name__ == "__main__":
    main(sys.argv[1:])
