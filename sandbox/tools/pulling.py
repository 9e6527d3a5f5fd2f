"""Pulling: a drag from a thing, or from the air, to another joins them by a rope, a spring or a rod."""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from sandbox.physics.analysis.query import particle_at
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import AddBody, AddParticle, AddSpring, Command
from sandbox.tools.tool import NOTHING, Loop, PlacedTool, PlayTool, Point, PointerEvent, Response

# Lengths of a rope between two particles, its mass for each metre [kg/m], and their radius [m] at most and as a share
# of such a length.
SEGMENTS, ROPE_MASS = 12, 2.0
THICKEST, SHARE = 0.05, 0.3
# Cs and Cd of a rope and of a rod: they keep their lengths.
FIRM = 1.0
# What hangs on a spring swings so fast [rad/s], with this damping ratio.
SWING, RATIO = 6.0, 0.1
# Radius [m] of a pin in the air, at most and as a share of the length.
PIN_RADIUS, PIN_SHARE = 0.05, 0.05
DECIMALS, DIGITS = 4, 6

TOO_SHORT = "Drag from one thing to another, or to the air: what you let go of in the air is pinned there."
SAME = "Both ends are at the same place of one thing. Drag to another."


class End(NamedTuple):
    """The place where something is tied [m], and the particle there; None: a pin in the air."""

    place: Point
    particle: int | None


def end_at(event: PointerEvent, snapshot: Snapshot) -> End:
    """The end at a press: a particle there, or of the body around the place, else a pin in the air."""
    particle = particle_at(snapshot, event.position, event.pick_radius)
    if particle is None:
        return End(event.position, None)
    x, y = snapshot.position[particle].tolist()
    return End((x, y), particle)


def rope(ends: tuple[End, End], snapshot: Snapshot) -> tuple[Command, ...]:
    """A chain between two ends. It touches the ground alone, so that it can be tied inside of a body."""
    (start, a), (end, b) = ends
    length = math.dist(start, end)
    # Ends that are particles of the world are none of its own.
    steps = [k for k in range(SEGMENTS + 1) if (k > 0 or a is None) and (k < SEGMENTS or b is None)]
    fraction = np.array(steps)[:, None] / SEGMENTS
    places = np.round((1.0 - fraction) * np.array(start) + fraction * np.array(end), DECIMALS)
    pinned = [number for number, k in enumerate(steps) if k in (0, SEGMENTS)]
    firm = {"stiffness": FIRM, "damping": FIRM}
    body = {
        "type": "mesh",
        "id": "rope",
        "particles": places.tolist(),
        "masses": [_rounded(ROPE_MASS * length / SEGMENTS)] * len(steps),
        "springs": [[k, k + 1] for k in range(len(steps) - 1)],
        "pinned": pinned,
        "particle_radius": _rounded(min(THICKEST, SHARE * length / SEGMENTS)),
        "collides": ["terrain"],
        "material": "drawn rope",
        "look": {"line": "rope"},
    }
    first = len(snapshot.mass)
    ties = [(a, first), (b, first + len(steps) - 1)]
    # As long as the others, to the last bit of what is rounded.
    rest = _rounded(length / SEGMENTS)
    return (
        AddBody(body, materials={"drawn rope": firm}),
        *(AddSpring(own, tied, rest, **firm) for tied, own in ties if tied is not None),
    )


def rod(ends: tuple[End, End], snapshot: Snapshot) -> tuple[Command, ...]:
    """A bar that keeps its length between two ends."""
    return _joined(ends, snapshot, FIRM, FIRM)


def spring(ends: tuple[End, End], snapshot: Snapshot) -> tuple[Command, ...]:
    """A spring between two ends that is as strong as what hangs on it is heavy."""
    tied = [end.particle for end in ends if end.particle is not None]
    free = [slot for slot in tied if snapshot.inverse_mass[slot] > 0.0]
    # How many times as much as the ends of the spring weigh the lighter thing that hangs on it.
    hanging = min((float(snapshot.mass[snapshot.owner == snapshot.owner[slot]].sum()) for slot in free), default=1.0)
    times = hanging * (sum(float(snapshot.inverse_mass[slot]) for slot in free) or 1.0)
    turn = SWING / snapshot.settings.tick_rate
    # K beta h^2 / m = Cs / (1 - Cd) and K h^2 / m = Cd / (1 - Cd), see physics/equation.py.
    restoring, resisting = turn * turn * times, 2.0 * RATIO * turn * times
    return _joined(ends, snapshot, _rounded(restoring / (1.0 + resisting)), _rounded(resisting / (1.0 + resisting)))


def _joined(ends: tuple[End, End], snapshot: Snapshot, stiffness: float, damping: float) -> tuple[Command, ...]:
    """A spring between two ends, and a pin for each end in the air."""
    radius = _rounded(min(PIN_RADIUS, PIN_SHARE * math.dist(ends[0].place, ends[1].place)))
    pins: list[Command] = []
    slots = []
    for end in ends:
        slots.append(len(snapshot.mass) + len(pins) if end.particle is None else end.particle)
        pins += [AddParticle(end.place, radius=radius, pinned=True)] if end.particle is None else []
    return *pins, AddSpring(slots[0], slots[1], stiffness=stiffness, damping=damping)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


MAKERS: dict[str, Callable[[tuple[End, End], Snapshot], tuple[Command, ...]]] = {
    "rope": rope, "spring": spring, "rod": rod
}  # fmt: skip


class PullTool(PlacedTool):
    """Pull a rope, a spring or a rod, by its name, from one end to the other. Each is a gesture."""

    def __init__(self, new_gesture: Callable[[], int], kind: str) -> None:
        super().__init__(new_gesture)
        self._make = MAKERS[kind]
        self._start: End | None = None

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Begin at a press, and join at the release."""
        self.place = event.position
        self.reconcile(snapshot)
        if event.kind == "down" and event.button == 1:
            self._start, self._refusal = end_at(event, snapshot), ""
        if self._start is None or event.kind != "up" or event.button != 1:
            return NOTHING
        start, self._start = self._start, None
        end = end_at(event, snapshot)
        if start.particle is not None and start.particle == end.particle:
            self._refusal = SAME
        elif math.dist(start.place, end.place) <= event.pick_radius:
            self._refusal = TOO_SHORT
        if self._refusal:
            return NOTHING
        return self._in_one_gesture(self._make((start, end), snapshot))

    def reconcile(self, snapshot: Snapshot) -> None:
        """Move the start with the thing it is tied to; nothing is pulled where that is gone."""
        particle = None if self._start is None else self._start.particle
        if particle is None:
            return
        is_there = particle < len(snapshot.mass) and snapshot.particle_active[particle]
        self._start = End(tuple(snapshot.position[particle].tolist()), particle) if is_there else None

    def target(self, place: Point, within: float, snapshot: Snapshot) -> int | None:
        """The end that a press would take, also while it is pulled: where it ends."""
        return end_at(PointerEvent("move", place, within), snapshot).particle

    @property
    def ghost(self) -> list[Loop]:
        """The way from the start to the pointer [m]."""
        return [] if self._start is None or self.place is None else [[self._start.place, self.place]]

    def cancel(self) -> Response:
        """Pull nothing."""
        self._start = self.place = None
        return super().cancel()


_LINES = {
    "rope": ("Shift+4", "Pull a rope: drag from end to end"),
    "spring": ("Shift+5", "Pull a spring"),
    "rod": ("Shift+6", "Pull a rod, which keeps its length"),
}
PULLED = tuple(
    PlayTool(f"pull_{kind}", (key,), label, "Parts", partial(PullTool, kind=kind), "add")
    for kind, (key, label) in _LINES.items()
)
