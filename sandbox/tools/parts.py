"""Parts that a person drops into a running world: each is a command, for a size, a place and a velocity."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from sandbox.level.format.look import PALETTE
from sandbox.level.format.quantities import significant
from sandbox.physics.equation import at_other_step
from sandbox.session.commands import AddBody, AddParticle, Command
from sandbox.tools.tool import Loop, Point

Maker = Callable[[float, Point, Point, str], Command]

# Mass of a square metre of a part [kg/m^2], so that what is larger is heavier, as all things are.
DENSITY = 8.0
# Radius of particles, as a share of a part's size.
SKIN = 0.03
# Corners of a round ghost.
ROUND = 24
# Sags of a jelly and of a box.
SOFT, HARD = 0.1, 0.0
# Ticks a second that Cs and Cd of the parts' materials are given for.
USUAL_RATE = 60
# Significant digits of the Cs and Cd that they have at another.
DIGITS = 6
# Keys of the cart's motors: back and ahead.
CART_KEYS = ("q", "w")
COLOURS = tuple(PALETTE)


@dataclass(frozen=True)
class Droppable:
    """A part: its name, the command that adds it, and its ghost, for a size of 1 m about the origin.

    solid: whether the ghost is of closed loops.
    """

    name: str
    make: Maker
    ghost: tuple[Loop, ...]
    solid: bool = True


def _circle(radius: float, x: float = 0.0, y: float = 0.0) -> Loop:
    turns = [2.0 * math.pi * k / ROUND for k in range(ROUND)]
    return [(x + radius * math.cos(turn), y + radius * math.sin(turn)) for turn in turns]


def _body(kind: str, size: float, velocity: Point, **more: Any) -> dict[str, Any]:
    return {"type": kind, "velocity": list(velocity), "particle_radius": SKIN * size, **more}


def _ball(size: float, place: Point, velocity: Point, colour: str) -> Command:
    mass = DENSITY * math.pi * size * size / 4.0
    return AddParticle(place, mass=mass, radius=0.5 * size, velocity=velocity, restitution=0.5)


def _block(size: float, velocity: Point, place: Point, cells: int, sag: float) -> dict[str, Any]:
    return _body(
        "jelly", size, velocity, position=list(place), shape={"box": [size, size]}, spacing=size / cells,
        particle_mass=DENSITY * size * size / (cells + 1) ** 2, firmness={"sag": sag},
    )  # fmt: skip


def _box(size: float, place: Point, velocity: Point, colour: str) -> Command:
    body = _block(size, velocity, place, 2, HARD)
    return AddBody(body | {"friction": 0.6, "look": {"skin": "wood"}})


def _jelly(size: float, place: Point, velocity: Point, colour: str) -> Command:
    body = _block(size, velocity, place, 5, SOFT)
    return AddBody(body | {"look": {"skin": "jelly", "colour": colour, "face": True}})


def _rope(size: float, place: Point, velocity: Point, colour: str) -> Command:
    x, y = place
    body = _body(
        "rope", size, velocity, start=[x - size, y], end=[x + size, y], segments=12,
        particle_mass=DENSITY * size * size / 60.0, material="dropped rope", look={"line": "rope"},
    )  # fmt: skip
    return AddBody(body, materials={"dropped rope": {"stiffness": 0.9, "damping": 0.95}})


def _balloon(size: float, place: Point, velocity: Point, colour: str) -> Command:
    body = _body(
        "ring", size, velocity, position=list(place), radius=0.45 * size, segments=18, inflation=1.25,
        particle_mass=DENSITY * size * size / 300.0, gravity_scale=-0.25, friction=0.1, material="dropped skin",
        look={"skin": "balloon", "colour": colour},
    )  # fmt: skip
    return AddBody(body, materials={"dropped skin": {"stiffness": 0.85, "damping": 0.93}})


# A cart of 1 m: its frame, and where its wheels are.
_FRAME = ((-0.5, -0.1), (0.0, -0.12), (0.5, -0.1), (0.52, 0.1), (0.2, 0.14), (0.08, 0.34), (-0.25, 0.34), (-0.5, 0.14))
_BARS = (
    (0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7), (7, 0), (0, 6), (1, 7), (1, 6), (1, 5), (1, 4), (2, 4),
    (1, 3), (4, 6), (4, 7), (0, 4),
)  # fmt: skip
_AXLES, _WHEEL = (0, 2), 0.2


def _cart(size: float, place: Point, velocity: Point, colour: str) -> Command:
    mass = DENSITY * size * size
    at = [[place[0] + size * x, place[1] + size * y] for x, y in _FRAME]
    frame = _body(
        "mesh", size, velocity, id="frame", particles=at, masses=[0.08 * mass] * len(at),
        springs=[list(bar) for bar in _BARS], material="dropped steel",
        look={"panel": colour, "window": [4, 5, 6, 7]},
    )  # fmt: skip
    back, ahead = CART_KEYS
    motor = {"key": ahead, "reverse_key": back, "speed": -12.0, "torque": 4.0 * mass * size}
    wheels = tuple(
        _body(
            "wheel", size, velocity, id=name, position=at[corner], radius=_WHEEL * size, thickness=0.07 * size,
            segments=10, particle_mass=0.008 * mass, hub_mass=0.05 * mass, motor=motor, friction=1.2,
            touches_mount=False, material="dropped tyre",
        )
        for name, corner in zip(("rear", "front"), _AXLES, strict=True)
    )  # fmt: skip
    welds = tuple((f"frame.{corner}", f"{name}.hub") for name, corner in zip(("rear", "front"), _AXLES, strict=True))
    steel, tyre = {"stiffness": 1.0, "damping": 1.0}, {"stiffness": 0.8, "damping": 0.9}
    return AddBody(frame, wheels, welds=welds, materials={"dropped steel": steel, "dropped tyre": tyre})


_SQUARE = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
PARTS: dict[str, Droppable] = {
    part.name: part
    for part in (
        Droppable("ball", _ball, (_circle(0.5),)),
        Droppable("box", _box, (_SQUARE,)),
        Droppable("jelly", _jelly, (_SQUARE,)),
        Droppable("rope", _rope, ([(-1.0, 0.0), (1.0, 0.0)],), solid=False),
        Droppable("balloon", _balloon, (_circle(0.5),)),
        Droppable("cart", _cart, (list(_FRAME), *(_circle(_WHEEL, *_FRAME[corner]) for corner in _AXLES))),
    )
}


def in_pace(command: Command, tick_rate: int) -> Command:
    """The command that adds a part which moves per second, at this tick rate, as it does at the usual one.

    A material that swings too fast for the rate keeps its Cs and Cd, and is softer there. Firmness, motors and places
    are given per second already.
    """
    if not isinstance(command, AddBody) or command.materials is None or tick_rate == USUAL_RATE:
        return command
    materials = {name: at_rate(material, tick_rate) for name, material in command.materials.items()}
    return replace(command, materials=materials)


def at_rate(material: dict[str, float], tick_rate: int) -> dict[str, float]:
    """A material of the usual tick rate at another one; as it is where it swings too fast for that."""
    try:
        pair = at_other_step(material["stiffness"], material["damping"], USUAL_RATE / tick_rate)
    except ValueError:
        return material
    stiffness, damping = (significant(value, DIGITS) for value in pair)
    return material | {"stiffness": stiffness, "damping": damping}
