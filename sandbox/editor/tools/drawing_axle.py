"""The axle tool: one drag puts a wheel on a body, with a motor and keys where they are wanted."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sandbox.editor.document import Document, EditError, checked, select
from sandbox.editor.edits.additions import first_torque
from sandbox.editor.edits.names import owner_of
from sandbox.editor.edits.placing import add_spring
from sandbox.editor.kinds.wheel import RimDrawing, RimOptions
from sandbox.editor.tools.drawing_bodies import known_material, length
from sandbox.editor.tools.drawing_options import flag_option, number_option
from sandbox.editor.tools.drawing_tool import EditorTool, staged
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import Level, ParticleDef
from sandbox.level.format.actuator_defs import MotorDef
from sandbox.level.format.limits import TORQUE_LIMIT, TURN_LIMIT
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.kinds.wheel import WheelDef

# A wheel beside a body hangs on this many of its particles, none farther from the axle than this many radii.
STRUTS, STRUT_REACH = 3, 3.0
STRUT_MATERIAL = "steel"
# Two struts hold an axle where the sine of the angle between them is this large; smaller: it gives way across them.
APART = 0.35
FORWARD, BACKWARD = "d", "a"


@dataclass(frozen=True)
class AxleOptions(RimOptions):
    """A wheel on an axle; torque None: what the weight of the vehicle asks for."""

    motor: bool = flag_option(True, "motor", "A motor turns it.")
    keys: bool = flag_option(True, "keys D, A", "D drives to the right and A back; otherwise it runs from the start.")
    speed: float = number_option(8.0, "speed", "Turning rate; it drives to the right.", "rad/s", 0.0, TURN_LIMIT)
    torque: float | None = number_option(
        None, "torque", "Largest torque; empty = enough for the weight of the vehicle.", "N m", high=TORQUE_LIMIT,
        empty="auto",
    )  # fmt: skip
    touches: bool = flag_option(False, "touches body", "The wheel touches what it is mounted on, or passes through it.")


class AxleDrawing(RimDrawing[AxleOptions]):
    """A wheel whose hub is one with the particle that it is drawn on, or hangs on the nearest of a body beside it."""

    defaults = AxleOptions()
    start_hint = "Press on a body, where the axle goes, and drag to the rim; or click both"

    def _shown(self, document: Document, points: list[Snap]) -> Document:
        """The wheel and its struts, with stand-ins of the particles that they end at."""
        stage, stood = staged(document, [*points, *self._struts(document, points)])
        return self._mounted(stage, stood[:2], stood[2:])

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the wheel on its axle. Raises EditError."""
        return self._mounted(document, points, self._struts(document, points))

    def fields(self, points: list[Snap]) -> dict[str, Any]:
        """A wheel's own fields."""
        return {**super().fields(points), "touches_mount": self.options.touches}

    def joins(self, index: int) -> bool:
        """The axle; the rim rolls."""
        return index == 0

    def _mounted(self, document: Document, points: list[Snap], struts: list[Snap]) -> Document:
        """The document with the wheel, the springs that it hangs on, and its motor."""
        document = super().placed(document, points)
        wheel, chosen = document.level.bodies[-1], document.selection
        for strut in struts:
            assert strut.name is not None
            document = add_spring(document, f"{wheel.id}.hub", strut.name, known_material(document, STRUT_MATERIAL))
        # It is in the group of what it is on.
        mount = points[0].name or (struts[0].name if struts else None)
        owner = None if mount is None else owner_of(mount)
        parts: list[AnyBody | ParticleDef] = [*document.level.bodies, *document.level.particles]
        changes: dict[str, Any] = {"group": next((part.group for part in parts if part.id == owner), None)}
        if self.options.motor:
            changes["motor"] = self._motor(document.level)
        level = replaced(document.level, bodies=(*document.level.bodies[:-1], replaced(wheel, **changes)))
        document = replace(document, level=checked(level))
        return select(document, chosen)

    def _motor(self, level: Level) -> MotorDef:
        options = self.options
        torque = options.torque
        if torque is None:
            torque = first_torque(level, len(level.bodies) - 1)
        keys = {"key": FORWARD, "reverse_key": BACKWARD} if options.keys else {}
        # To the right is clockwise.
        return MotorDef(speed=-options.speed + 0.0, torque=torque, **keys)

    def _struts(self, document: Document, points: list[Snap]) -> list[Snap]:
        """Particles of the nearest body that an axle beside them hangs on. Raises EditError where there are too few."""
        axle = points[0]
        if axle.name is not None:
            return []
        scene, bodies = self._scene_of(document), document.level.bodies
        apart = scene.position - np.array(axle.point)
        distance = np.sqrt(apart[:, 0] * apart[:, 0] + apart[:, 1] * apart[:, 1])
        is_wheel = np.array([isinstance(body, WheelDef) for body in bodies], dtype=np.bool_)
        near = (distance > 0.0) & (distance <= STRUT_REACH * length(points)) & (scene.particle_item < len(bodies))
        slots = np.flatnonzero(near)
        slots = slots[~is_wheel[scene.particle_item[slots]]]
        slots = slots[np.argsort(distance[slots], kind="stable")]
        if not len(slots):
            raise EditError("start on a body: there is none near the axle")
        slots = slots[scene.particle_item[slots] == scene.particle_item[slots[0]]]
        way = apart[slots] / distance[slots, None]
        across = np.abs(way[:, 0] * way[0, 1] - way[:, 1] * way[0, 0])
        second = np.flatnonzero(across >= APART)
        if not len(second):
            raise EditError("start nearer to the body, so that it can hold the axle")
        chosen = list(dict.fromkeys([0, int(second[0]), *range(len(slots))]))[:STRUTS]
        return [Snap(scene.place(slot), "particle", scene.names(slot)) for slot in slots[chosen].tolist()]


AXLE = EditorTool("axle", "Shift+Q", "Axle: a wheel on a body, with a motor", AxleDrawing)
