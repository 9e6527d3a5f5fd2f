"""Dropping: a click drops a part under the pointer, a drag throws it. Each part is a command."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.look import PALETTE
from sandbox.level.format.quantities import significant
from sandbox.physics.equation import at_other_step
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import AddBody, AddParticle, Command
from sandbox.tools.clearance import lift
from sandbox.tools.tool import (
    CLICK_SHARE,
    NOTHING,
    SMALLEST,
    DropPicture,
    Loop,
    PlacedTool,
    PlayTool,
    Point,
    PointerEvent,
    Response,
    Sized,
    resized,
)

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
# What the pointer did in this last part of a drag decides how fast the part flies [s]; longer makes throws sluggish.
THROW_SECONDS = 0.08
# The fastest throw [m/s]: beyond it a part passes through walls of other parts.
FASTEST_THROW = 25.0
# What is said where a part has no room.
NO_ROOM = "There is no room for it here. Click where it is free, or make it smaller with the wheel."
# Significant digits of how many times as large a part of the catalogue is: turned back, the wheel comes to 1 again.
TIMES_DIGITS = 4


@dataclass(frozen=True)
class Droppable:
    """A part: its name, the command that adds it, and its ghost, for a size of 1 m about the origin.

    solid: whether the ghost is of closed loops.
    """

    name: str
    make: Maker
    ghost: tuple[Loop, ...]
    solid: bool = True


def _ball(size: float, place: Point, velocity: Point, colour: str) -> Command:
    mass = DENSITY * math.pi * size * size / 4.0
    return AddParticle(place, mass=mass, radius=0.5 * size, velocity=velocity, restitution=0.5)


def _box(size: float, place: Point, velocity: Point, colour: str) -> Command:
    body = _block(size, velocity, place, 2, HARD)
    return AddBody(body | {"friction": 0.6, "look": {"skin": "wood"}})


def _jelly(size: float, place: Point, velocity: Point, colour: str) -> Command:
    body = _block(size, velocity, place, 5, SOFT)
    return AddBody(body | {"look": {"skin": "jelly", "colour": colour, "face": True}})


def _block(size: float, velocity: Point, place: Point, cells: int, sag: float) -> dict[str, Any]:
    return _body(
        "jelly", size, velocity, position=list(place), shape={"box": [size, size]}, spacing=size / cells,
        particle_mass=DENSITY * size * size / (cells + 1) ** 2, firmness={"sag": sag},
    )  # fmt: skip


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


def _body(kind: str, size: float, velocity: Point, **more: Any) -> dict[str, Any]:
    return {"type": kind, "velocity": list(velocity), "particle_radius": SKIN * size, **more}


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


def _circle(radius: float, x: float = 0.0, y: float = 0.0) -> Loop:
    turns = [2.0 * math.pi * k / ROUND for k in range(ROUND)]
    return [(x + radius * math.cos(turn), y + radius * math.sin(turn)) for turn in turns]


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


def in_own_groups(commands: Iterable[Command]) -> tuple[Command, ...]:
    """Commands whose bodies what is drawn later may pass, see AddBody."""
    return tuple(replace(each, passes=()) if isinstance(each, AddBody) else each for each in commands)


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


class ThrowTool(PlacedTool):
    """Drops or throws what subclasses make. Each drop is a gesture."""

    adds = True

    def __init__(self, new_gesture: Callable[[], int]) -> None:
        super().__init__(new_gesture)
        self._snapshot: Snapshot | None = None
        self._landing: tuple[object, Point | None] = (None, None)
        self._pressed_at: Point | None = None
        self._trail: list[tuple[float, Point]] = []

    def made(self, place: Point, velocity: Point, snapshot: Snapshot) -> tuple[Command, ...]:
        """The commands that add it at a place [m], with a velocity [m/s]. Raises ValueError, with one line."""
        raise NotImplementedError

    def outline(self, place: Point) -> list[Loop]:
        """Lines [m] around what is dropped at a place [m]; closed ones end where they begin."""
        raise NotImplementedError

    def reconcile(self, snapshot: Snapshot) -> None:
        """Find out what is in the way."""
        self._snapshot = snapshot

    @property
    def landing(self) -> Point | None:
        """Where a click drops: on what is below the pointer; None: there is no room, or no pointer."""
        return None if self.place is None else self._landing_at(self.place, self._snapshot)

    @property
    def fits(self) -> bool:
        """Whether a click drops something at the pointer."""
        return self.place is None or self.landing is not None

    def _landing_at(self, place: Point, snapshot: Snapshot | None) -> Point | None:
        if not self.touches or snapshot is None:
            return place
        outline = self.outline(place)
        key = outline, snapshot.tick, len(snapshot.mass)
        if self._landing[0] != key:
            by = lift(outline, snapshot)
            self._landing = key, None if by is None else (place[0], place[1] + by)
        return self._landing[1]

    @property
    def ghost(self) -> list[Loop]:
        """Lines [m] of what would be dropped; closed ones end where they begin."""
        place = self.landing or self.place
        return [] if place is None else self.outline(place)

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Follow the pointer; drop on the release."""
        self.place = event.position
        if event.kind == "down" and event.button == 1:
            self._pressed_at, self._trail = event.position, []
        if self._pressed_at is None:
            return NOTHING
        self._trail.append((event.seconds, event.position))
        if event.kind != "up" or event.button != 1:
            return NOTHING
        velocity = self._thrown(event)
        self._pressed_at = None
        landing = self._landing_at(event.position, snapshot)
        if landing is None:
            return Response(message=NO_ROOM)
        try:
            commands = self.made(landing, velocity, snapshot)
        except ValueError as error:
            return Response(message=f"{error}.")
        return self._in_one_gesture(commands)

    def _thrown(self, event: PointerEvent) -> Point:
        """The velocity [m/s] of the pointer in the last moment."""
        assert self._pressed_at is not None
        dx, dy = event.position[0] - self._pressed_at[0], event.position[1] - self._pressed_at[1]
        recent = [(when, at) for when, at in self._trail if when >= event.seconds - THROW_SECONDS]
        began, start = recent[0]
        if dx * dx + dy * dy <= (CLICK_SHARE * event.pick_radius) ** 2 or event.seconds <= began:
            return 0.0, 0.0
        vx, vy = ((event.position[axis] - start[axis]) / (event.seconds - began) for axis in range(2))
        scale = min(1.0, FASTEST_THROW / max((vx * vx + vy * vy) ** 0.5, 1e-9))
        return scale * vx, scale * vy

    def cancel(self) -> Response:
        """Drop nothing."""
        self._pressed_at = self.place = None
        return NOTHING


class DropTool(Sized, ThrowTool):
    """Drop the part of that name; size [m]. Parts take the toys' colours in turn."""

    def __init__(self, new_gesture: Callable[[], int], part: str) -> None:
        super().__init__(new_gesture)
        self.part, self.count = PARTS[part], 0

    def made(self, place: Point, velocity: Point, snapshot: Snapshot) -> tuple[Command, ...]:
        """The part in its present size."""
        made = self.part.make(self.size, place, velocity, self.colour)
        self.count += 1
        return in_own_groups([in_pace(made, snapshot.settings.tick_rate)])

    @property
    def colour(self) -> str:
        """Colour of the next part."""
        return COLOURS[self.count % len(COLOURS)]

    @property
    def preview(self) -> DropPicture | None:
        """The part in its present size and colour."""
        return DropPicture(self.part.name, self.size, self.colour)

    def outline(self, place: Point) -> list[Loop]:
        """Lines [m] of the part in its present size."""
        x, y = place
        loops = [[(x + self.size * px, y + self.size * py) for px, py in loop] for loop in self.part.ghost]
        return [[*loop, loop[0]] if self.part.solid else loop for loop in loops]


class CatalogueTool(ThrowTool):
    """Drop a part of the catalogue; make: see `made`, with how many times as large; box: width and height [m] as kept.

    times: how many times as large as it was kept the part is.
    """

    def __init__(
        self, new_gesture: Callable[[], int], part: Level,
        make: Callable[[Point, Point, float], tuple[Command, ...]], box: Point,
    ) -> None:  # fmt: skip
        super().__init__(new_gesture)
        self.part, self._make, self._box = part, make, box
        self._size = max(*box, SMALLEST)
        self.times = 1.0

    def made(self, place: Point, velocity: Point, snapshot: Snapshot) -> tuple[Command, ...]:
        """The part in its present size."""
        return self._make(place, velocity, self.times)

    def resize(self, steps: float) -> bool:
        """Make the part larger."""
        kept = max(*self._box, SMALLEST)
        self._size = resized(self._size, steps)
        self.times = significant(self._size / kept, TIMES_DIGITS)
        return True

    @property
    def preview(self) -> DropPicture | None:
        """The part in its present size."""
        return DropPicture(self.part, self.times, replaces_ghost=True)

    def outline(self, place: Point) -> list[Loop]:
        """The box [m] around the part in its present size."""
        (x, y), (width, height) = place, (self.times * side for side in self._box)
        corners = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5))
        return [[(x + dx * width, y + dy * height) for dx, dy in corners]]


# Keys and lines of the parts.
_LINES = {
    "ball": ("4", "Ball: click drops it, drag throws it"), "box": ("5", "Box"), "jelly": ("6", "Jelly"),
    "rope": ("7", "Rope"), "balloon": ("8", "Balloon"), "cart": ("9", "Cart: Q and W drive it"),
}  # fmt: skip

DROPS = tuple(
    PlayTool(part, (_LINES[part][0],), _LINES[part][1], "Parts", partial(DropTool, part=part), "add") for part in PARTS
)
