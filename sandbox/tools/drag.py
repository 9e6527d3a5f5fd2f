"""DragTool: hold particles and move them, several at once with Shift; while time stands, put things elsewhere."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from sandbox.physics.analysis.query import free_particle_at, grip_radius, nearest_particle
from sandbox.physics.commands.command_table import lets_hands
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import HAND_STRENGTH
from sandbox.session.commands import Grab, MoveBody, MoveGrab, Release
from sandbox.tools.tool import CLICK_SHARE, NOTHING, PlayTool, Point, PointerEvent, Response, Submission, Tool

# How strong a hand can be: its largest force over the mass of the body that it holds [m/s^2]. Gentle carries three
# times a body's weight and spares what tears, strong moves what stands under a load.
STRENGTHS = {"gentle": 30.0, "normal": HAND_STRENGTH, "strong": 300.0}

# Said of a drag while time stands, where the level lets no hand move things at once.
TIME_STANDS = "Time stands: here a hand only pulls, once time goes on (Space)."
# Decimals of a place [m] that a hand moves to, more where this part of a pick radius is finer.
DECIMALS, FINEST = 3, 1 / 28


@dataclass
class Hold:
    """A particle in a hand, and the gesture that the whole drag belongs to.

    beside: how far [m] what the hand pulls it to is from the pointer, which may be well inside a body.
    """

    particle: int
    gesture: int
    beside: Point = (0.0, 0.0)


@dataclass
class Carried:
    """A particle whose body is being put elsewhere, the gesture that this belongs to, and where the pointer was."""

    particle: int
    gesture: int
    at: Point


class DragTool(Tool):
    """Drag particles; a Shift+click keeps hold after the release, a click on a held particle or cancel lets go.

    holds: hand number (0..9) to what it holds. A drag from grab to release is one gesture. strength: of STRENGTHS, that
    of the next hold.
    """

    def __init__(self, new_gesture: Callable[[], int], strength: str = "normal") -> None:
        super().__init__(new_gesture)
        self.holds: dict[int, Hold] = {}
        self.strength = strength
        self._dragged: int | None = None
        self._carried: Carried | None = None
        self._pressed_at: Point = (0.0, 0.0)
        self._moved = False
        self._held_before = False
        # The particle of the last press, if it was a click: `take_click`.
        self._clicked: int | None = None

    @property
    def dragging(self) -> bool:
        """Whether a pressed pointer moves a particle right now."""
        return self._dragged is not None or self._carried is not None

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Grab, move or release."""
        if event.kind == "down" and event.button == 1:
            return self._press(event, snapshot)
        if self._carried is not None:
            return self._carry(event, self._carried)
        if self._dragged is None:
            return NOTHING
        if event.kind == "move":
            return self._move(event)
        return self._release(event) if event.kind == "up" and event.button == 1 else NOTHING

    def target(self, place: Point, within: float, snapshot: Snapshot) -> int | None:
        """The particle that a press would take; none during a drag."""
        return None if self.dragging else free_particle_at(snapshot, place, within)

    def take_click(self) -> int | None:
        """The particle that was clicked since this was asked last; None: none was."""
        clicked, self._clicked = self._clicked, None
        return clicked

    def cancel(self) -> Response:
        """Release every particle."""
        submissions = tuple(Submission(Release(hand), hold.gesture) for hand, hold in self.holds.items())
        self.holds.clear()
        self._dragged = self._carried = None
        return Response(submissions)

    def reconcile(self, snapshot: Snapshot) -> None:
        """Forget the hands that the world says are empty: undo, a reset or a refused grab took them."""
        for hand in list(self.holds):
            spring = snapshot.grab_spring + hand
            if snapshot.grab_spring < 0 or not snapshot.spring_active[spring]:
                del self.holds[hand]
                if self._dragged == hand:
                    self._dragged = None

    def _press(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        particle = free_particle_at(snapshot, event.position, event.pick_radius)
        stands = event.paused and not event.shift
        if stands and lets_hands(snapshot, "move_body"):
            # What is pinned can be put elsewhere too.
            carried = nearest_particle(snapshot, event.position, event.pick_radius)
            carried = particle if carried is None else carried
            if carried is not None:
                self._carried = Carried(carried, self._new_gesture(), event.position)
                self._clicked = carried
            return NOTHING
        if particle is None:
            pinned = nearest_particle(snapshot, event.position, event.pick_radius) is not None
            said = "This particle is pinned. Unpin it with the pin tool (P) to drag it."
            return Response(message=said) if pinned else NOTHING
        self._pressed_at, self._moved = event.position, False
        held = next((hand for hand, hold in self.holds.items() if hold.particle == particle), None)
        self._held_before = held is not None
        if held is not None:
            self._dragged = held
            return NOTHING
        hand = next((number for number in range(GRAB_COUNT) if number not in self.holds), None)
        if hand is None:
            return Response(message=f"All {GRAB_COUNT} hands are full. Escape lets go of everything.")
        hold = Hold(particle, self._new_gesture(), _beside(snapshot, particle, event))
        self.holds[hand] = hold
        self._dragged = hand
        target, strength = _shifted(event, hold.beside), STRENGTHS[self.strength]
        grab = Grab(hand, particle, target, strength, grip_radius(snapshot, particle))
        return Response((Submission(grab, hold.gesture),), TIME_STANDS if stands else None)

    def _move(self, event: PointerEvent) -> Response:
        assert self._dragged is not None
        dx, dy = event.position[0] - self._pressed_at[0], event.position[1] - self._pressed_at[1]
        if dx * dx + dy * dy > (CLICK_SHARE * event.pick_radius) ** 2:
            self._moved = True
        hold = self.holds[self._dragged]
        return Response((Submission(MoveGrab(self._dragged, _shifted(event, hold.beside)), hold.gesture),))

    def _carry(self, event: PointerEvent, carried: Carried) -> Response:
        if event.kind == "up" and event.button == 1:
            self._carried = None
        by = event.position[0] - carried.at[0], event.position[1] - carried.at[1]
        if event.kind == "down" or by == (0.0, 0.0):
            return NOTHING
        carried.at, self._clicked = event.position, None
        return Response((Submission(MoveBody(carried.particle, by), carried.gesture),))

    def _release(self, event: PointerEvent) -> Response:
        assert self._dragged is not None
        hand, self._dragged = self._dragged, None
        self._clicked = None if self._moved else self.holds[hand].particle
        keeps_hold = self._moved if self._held_before else event.shift
        if keeps_hold:
            return NOTHING
        return Response((Submission(Release(hand), self.holds.pop(hand).gesture),))


def _shifted(event: PointerEvent, by: Point) -> Point:
    # To millimetres, or to what nobody sees where that is finer: links to runs are short for it.
    decimals = max(DECIMALS, math.ceil(-math.log10(FINEST * event.pick_radius)))
    return round(event.position[0] + by[0], decimals), round(event.position[1] + by[1], decimals)


def _beside(snapshot: Snapshot, particle: int, event: PointerEvent) -> Point:
    # A particle at the pointer goes to it; one that is farther off keeps its distance, so that nothing jumps.
    x, y = snapshot.position[particle].tolist()
    dx, dy = x - event.position[0], y - event.position[1]
    near = event.pick_radius + float(snapshot.radius[particle])
    return (0.0, 0.0) if dx * dx + dy * dy <= near * near else (dx, dy)


DRAG = PlayTool("drag", ("D", "1"), "Drag tool: hold and move particles", "Tools", DragTool, "grab")
