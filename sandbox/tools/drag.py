"""DragTool: hold particles and move them; several at once with Shift."""

from collections.abc import Callable
from dataclasses import dataclass

from sandbox.physics.query import grip_radius, nearest_particle
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import GRAB_COUNT, HAND_STRENGTH
from sandbox.session.commands import Grab, MoveGrab, Release
from sandbox.tools.tool import NOTHING, Point, PointerEvent, Response, Submission

# A press that moves less than this part of the pick radius is a click. Larger: short drags turn into clicks.
CLICK_SHARE = 0.35
# How strong a hand can be: its largest force over the mass of the body that it holds [m/s^2]. Gentle carries three
# times a body's weight and spares what tears, strong moves what stands under a load.
STRENGTHS = {"gentle": 30.0, "normal": HAND_STRENGTH, "strong": 300.0}


@dataclass
class Hold:
    """A particle in a hand, and the gesture that the whole drag belongs to."""

    particle: int
    gesture: int


class DragTool:
    """Drag particles; a Shift+click keeps hold after the release, a click on a held particle or cancel lets go.

    holds: hand number (0..9) to what it holds. A drag from grab to release is one gesture. strength: of STRENGTHS, that
    of the next hold.
    """

    def __init__(self, new_gesture: Callable[[], int], strength: str = "normal") -> None:
        self.holds: dict[int, Hold] = {}
        self.strength = strength
        self._new_gesture = new_gesture
        self._dragged: int | None = None
        self._pressed_at: Point = (0.0, 0.0)
        self._moved = False
        self._held_before = False

    @property
    def dragging(self) -> bool:
        """Whether a pressed pointer moves a particle right now."""
        return self._dragged is not None

    def handle(self, event: PointerEvent, snapshot: Snapshot) -> Response:
        """Grab, move or release."""
        if event.kind == "down" and event.button == 1:
            return self._press(event, snapshot)
        if self._dragged is None:
            return NOTHING
        if event.kind == "move":
            return self._move(event)
        return self._release(event) if event.kind == "up" and event.button == 1 else NOTHING

    def cancel(self) -> Response:
        """Let go of every particle."""
        submissions = tuple(Submission(Release(hand), hold.gesture) for hand, hold in self.holds.items())
        self.holds.clear()
        self._dragged = None
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
        particle = nearest_particle(snapshot, event.position, event.pick_radius)
        if particle is None:
            return NOTHING
        self._pressed_at, self._moved = event.position, False
        held = next((hand for hand, hold in self.holds.items() if hold.particle == particle), None)
        self._held_before = held is not None
        if held is not None:
            self._dragged = held
            return NOTHING
        if snapshot.inverse_mass[particle] == 0.0:
            return Response(message="This particle is pinned. Unpin it with the pin tool (P) to drag it.")
        hand = next((number for number in range(GRAB_COUNT) if number not in self.holds), None)
        if hand is None:
            return Response(message=f"All {GRAB_COUNT} hands are full. Escape lets go of everything.")
        hold = Hold(particle, self._new_gesture())
        self.holds[hand] = hold
        self._dragged = hand
        grab = Grab(hand, particle, event.position, STRENGTHS[self.strength], grip_radius(snapshot, particle))
        return Response((Submission(grab, hold.gesture),))

    def _move(self, event: PointerEvent) -> Response:
        assert self._dragged is not None
        dx, dy = event.position[0] - self._pressed_at[0], event.position[1] - self._pressed_at[1]
        if dx * dx + dy * dy > (CLICK_SHARE * event.pick_radius) ** 2:
            self._moved = True
        hold = self.holds[self._dragged]
        return Response((Submission(MoveGrab(self._dragged, event.position), hold.gesture),))

    def _release(self, event: PointerEvent) -> Response:
        assert self._dragged is not None
        hand, self._dragged = self._dragged, None
        keeps_hold = self._moved if self._held_before else event.shift
        if keeps_hold:
            return NOTHING
        return Response((Submission(Release(hand), self.holds.pop(hand).gesture),))
