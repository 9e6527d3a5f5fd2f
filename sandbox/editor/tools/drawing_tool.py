"""Drawing: what a drawing tool does, a pointer gesture that adds something to a level, with a ghost of it before.

The app hands every pointer event on as a Snap, shows `ghost` and `hint`, and takes what `done` gives. A gesture of two
points is a drag, or a click at each; Enter takes the pointer for the second, Escape gives up.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, Literal, cast

from sandbox.editor.document import Document, EditError
from sandbox.editor.scene import Scene, make_scene
from sandbox.editor.tools.drawing_options import AnyOptions, Options, changed, described
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import ParticleDef
from sandbox.level.format.quantities import Point, replaced

# Where the page of all shortcuts has a tool.
Group = Literal["Draw", "Terrain"]


class Drawing(Generic[AnyOptions]):
    """One gesture at a time of a tool; `options` and what else is set stay for the next.

    reach [m]: a press that moves no farther is a click. The app sets it with the zoom. points: those of the gesture so
    far; pointer: where it goes next.
    """

    defaults: ClassVar[Options]
    needs: ClassVar[int] = 2  # points of a whole gesture
    start_hint: ClassVar[str] = ""
    end_hint: ClassVar[str] = ""
    # Whether what is drawn has a size of its own, not that of the gesture.
    is_ready_made: ClassVar[bool] = False
    # Whether the way of the gesture is shown, before what comes of it.
    has_outline: ClassVar[bool] = False
    # Whether it becomes one with the particles that its points are on.
    joins_particles: ClassVar[bool] = True
    # The option that `adjust` counts up and down.
    counted: ClassVar[str] = ""

    def __init__(self, options: AnyOptions | None = None, reach: float = 0.0) -> None:
        self.options: AnyOptions = cast(AnyOptions, self.defaults) if options is None else options
        self.reach = reach
        self.points: list[Snap] = []
        # Points that were taken back, each with those that were left.
        self._taken_back: list[tuple[list[Snap], Snap]] = []
        self.pointer: Snap | None = None
        self._pressed = False
        self._began = False
        self._complete = False
        self._scene: Scene | None = None
        # Why the gesture could not end, until the next press; and why there is no ghost at the pointer.
        self._fault = ""
        self._ghost_fault = ""

    # ---- what the app asks

    @property
    def step(self) -> str:
        """Name of the tool's step in the history; empty = by the tool's name."""
        return ""

    @property
    def under_way(self) -> bool:
        """Whether a gesture has begun."""
        return bool(self.points)

    @property
    def anchor(self) -> Point | None:
        """The point [m] that directions are measured from, for `snap`; None before the first."""
        return self.points[-1].point if self.points else None

    @property
    def outline(self) -> list[Point]:
        """Corners [m] of an outline so far and the pointer as the next, shown as they are; none of other gestures."""
        return [point.point for point in self._so_far()] if self.points and self.has_outline else []

    @property
    def hint(self) -> str:
        """One line for the person: why it cannot be done so, or what to do next and what it would join."""
        fault = self._fault or self._ghost_fault
        if fault:
            return fault
        hint = self.end_hint if self.points else self.start_hint
        joined = [point.name for index, point in enumerate(self._so_far()) if point.name and self.joins(index)]
        return f"{hint}; joins {' and '.join(joined)}" if joined else hint

    @property
    def measure(self) -> str:
        """Sizes and counts of what is drawn right now, in a few words; empty before the first point."""
        points = self._so_far()
        return self.sizes(points) if self.points and self._sound(points) else ""

    def ghost(self, document: Document) -> Document | None:
        """The document as if the gesture ended at the pointer, the new things selected; None where it cannot end there.

        It is alone in its document, but for stand-ins of the particles that it joins: large levels need no longer.
        """
        points = self._so_far()
        self._ghost_fault = ""
        if not self._sound(points):
            return None
        try:
            return self._shown(document, points)
        except EditError as error:
            self._ghost_fault = str(error)
            return None

    def done(self, document: Document) -> Document | None:
        """The document with what was drawn, once, when the gesture is complete; None before. Raises EditError."""
        if not self._complete:
            return None
        points = list(self.points)
        self.cancel()
        return self.placed(document, points)

    # ---- what the person does

    def down(self, snap: Snap) -> None:
        """React to a press of the pointer."""
        self.pointer, self._pressed, self._fault = snap, True, ""
        self._began = not self.points
        if self._began:
            self.points = [snap]

    def move(self, snap: Snap) -> None:
        """React to a move of the pointer, pressed or not."""
        self.pointer = snap

    def up(self, snap: Snap) -> None:
        """React to a release of the pointer."""
        self.pointer = snap
        if not self._pressed:
            return
        self._pressed = False
        is_click = self._began and math.dist(self.points[0].raw, snap.raw) <= self.reach
        if self.needs == 1:
            self.points, self._complete = [snap], True
        elif not is_click:
            self._end_at(snap)

    def finish(self) -> None:
        """End the gesture at the pointer, as Enter asks."""
        if self.pointer is not None and (self.points or self.needs == 1):
            self._end_at(self.pointer)

    def back(self) -> None:
        """Take the last point back, as Backspace and Ctrl+Z ask."""
        self._fault = ""
        if self.points:
            point = self.points.pop()
            self._taken_back.append((list(self.points), point))
        # The press that made it moves and ends nothing any more.
        self._pressed = False

    def again(self) -> bool:
        """Put the point that was taken back last in its place again; whether there is one."""
        if not self._taken_back or self._taken_back[-1][0] != self.points:
            return False
        self.points.append(self._taken_back.pop()[1])
        return True

    def cancel(self) -> None:
        """Give the drawing up, as Escape asks."""
        self._taken_back.clear()
        self.points, self._pressed, self._complete = [], False, False
        self._fault = self._ghost_fault = ""

    def set_option(self, name: str, value: Any) -> None:
        """Give an option another value. Raises EditError with a line for the person."""
        self.options = changed(self.options, name, value)

    def adjust(self, steps: int) -> None:
        """Count the number of parts up or down, within its limits; from the fitting one where none is set."""
        if self.counted:
            low, high = described(self.options)[self.counted].limits
            self.set_option(self.counted, int(min(max(self.count(self._so_far()) + steps, low), high)))

    def count(self, points: list[Snap]) -> int:
        """Number of parts: as set, or else what fits."""
        asked: int | None = getattr(self.options, self.counted)
        return self.fitting(points) if asked is None else asked

    # ---- what each kind of drawing says

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the body that the points describe. Raises EditError."""
        raise NotImplementedError

    def sizes(self, points: list[Snap]) -> str:
        """Sizes and counts of the drawing, in words."""
        return ""

    def fitting(self, points: list[Snap]) -> int:
        """The number of parts that fits the size drawn."""
        raise NotImplementedError

    def joins(self, index: int) -> bool:
        """Whether the particle that the point of that index is on becomes one with what is drawn."""
        return self.joins_particles

    def _shown(self, document: Document, points: list[Snap]) -> Document | None:
        """The ghost of a sound gesture. Raises EditError."""
        return self.placed(*staged(document, points))

    # ---- between them

    def fault_of_outline(self) -> str:
        """The fault of the outline so far, in a few words; empty if there is none."""
        return ""

    def _scene_of(self, document: Document) -> Scene:
        """Where things are in a document; found again where its level is another one."""
        if self._scene is None or self._scene.level is not document.level:
            self._scene = make_scene(document.level, self._scene)
        return self._scene

    def _so_far(self) -> list[Snap]:
        """The points of the gesture with the pointer for the one that is still missing."""
        missing = self.pointer is not None and not self._complete and len(self.points) < self.needs
        return [*self.points, self.pointer] if missing and self.pointer is not None else list(self.points)

    def _sound(self, points: list[Snap]) -> bool:
        return len(points) == self.needs and (self.needs == 1 or self._apart(*points) > 0.0)

    def _end_at(self, snap: Snap) -> None:
        points = [snap] if self.needs == 1 else [*self.points, snap]
        if self._sound(points):
            self.points, self._complete = points, True
        else:
            self._fault = "Start and end are in one place; move one away"

    @staticmethod
    def _apart(a: Snap, b: Snap) -> float:
        return math.dist(a.point, b.point)


@dataclass(frozen=True)
class EditorTool:
    """A tool: its name, the key that takes it up ("Shift+O"), its line on the help page and in its tip.

    Its icon is the file of its name in assets/icons. drawing: what it draws with; None = it selects. word: what it is
    called in the window, where that is not its name.
    """

    name: str
    key: str
    label: str
    drawing: type[Drawing[Any]] | None = None
    group: Group = "Draw"
    word: str = ""

    @property
    def action(self) -> str:
        """The action that takes the tool up."""
        return f"tool_{self.name}"

    @property
    def title(self) -> str:
        """Name of the tool in the window."""
        return self.word or self.name


def staged(document: Document, points: list[Snap]) -> tuple[Document, list[Snap]]:
    """A document with nothing of the level but its materials, settings and stand-ins of the particles points are on."""
    names = list(dict.fromkeys(point.name for point in points if point.name is not None))
    stand_ins = {name: f"stand-in {index}" for index, name in enumerate(names)}
    places = {point.name: point.point for point in points}
    particles = tuple(ParticleDef(id=stand_in, position=places[name]) for name, stand_in in stand_ins.items())
    level = replaced(document.level, bodies=(), particles=particles, springs=(), welds=(), checks=())
    level = replaced(level, terrain=(), zones=(), counters=(), rules=(), hands=None, walls=None, extras={})
    return Document(level), [replace(point, name=stand_ins.get(point.name or "")) for point in points]
