"""The chassis tool: a frame with two axles on springs, ready for wheels, in one drag from axle to axle."""

from dataclasses import dataclass, replace

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.grouping import taken_groups
from sandbox.editor.edits.names import free_ids, taken_ids
from sandbox.editor.items import Item
from sandbox.editor.tools.drawing_bodies import direction, rounded
from sandbox.editor.tools.drawing_options import Options, mass_option
from sandbox.editor.tools.drawing_tool import Drawing, EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import NissenMaterial, ParticleDef, SpringDef
from sandbox.level.format.quantities import Point, replaced
from sandbox.level.kinds.mesh import MeshDef

# Shortest distance of the axles [m].
SHORTEST = 0.1
# The frame, the axles at (0, 0) and (1, 0): four corners below and four above, from the rear axle to the front one.
ALONG, LOW, HIGH = (-0.2, 0.26, 0.74, 1.2), 0.16, 0.42
FRAME = tuple((x, y) for y in (LOW, HIGH) for x in ALONG)
CHORDS = ((0, 1), (1, 2), (2, 3), (4, 5), (5, 6), (6, 7))
POSTS = ((0, 4), (1, 5), (2, 6), (3, 7))
BRACES = ((0, 5), (4, 1), (1, 6), (5, 2), (2, 7), (6, 3))
# Of each axle the corner that its arm ends at, and those of its two shock absorbers.
AXLES = (((0.0, 0.0), 1, (4, 5)), ((1.0, 0.0), 2, (6, 7)))
# What the part is made of, where the level has no materials of these names. The softer the shock absorbers, the farther
# they give under a load; with these a frame of ten times its mass still rides above its axles.
MATERIALS = {
    "steel": NissenMaterial(stiffness=1.0, damping=1.0),
    "shock": NissenMaterial(stiffness=0.4, damping=0.6),
}


@dataclass(frozen=True)
class ChassisOptions(Options):
    """Options of a chassis: masses of the frame and of each axle [kg]."""

    mass: float = mass_option(24.0, text="Mass of the whole frame.")
    axle_mass: float = mass_option(2.0, "axle mass", "Mass of each of the two axles.")


class ChassisDrawing(Drawing[ChassisOptions]):
    """A frame of steel on two axles, each held by an arm and two shock absorbers; all of it is one group."""

    defaults = ChassisOptions()
    start_hint = "Drag from the rear axle to the front one, or click both; then put wheels on them"
    end_hint = "Click or release at the other axle"
    # It comes with axles of its own.
    joins_particles = False

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the frame, the axles and the springs between them. Raises EditError."""
        (ax, ay), (bx, by) = points[0].point, points[1].point
        # Up is up whichever way it is drawn.
        if (bx, by) < (ax, ay):
            ax, ay, bx, by = bx, by, ax, ay
        if max(bx - ax, abs(by - ay)) < SHORTEST:
            raise EditError(f"the axles are {SHORTEST:g} m apart or more; drag farther")

        def place(x: float, y: float) -> Point:
            return rounded(ax + x * (bx - ax) - y * (by - ay)), rounded(ay + x * (by - ay) + y * (bx - ax))

        level = document.level
        taken = taken_ids(level)
        frame, *axles = free_ids(taken, ["chassis", "rear axle", "front axle"])
        group = free_ids(taken_groups(level), ["vehicle"])[0]
        body = MeshDef(
            type="mesh", id=frame, particles=tuple(place(x, y) for x, y in FRAME), springs=(*CHORDS, *POSTS, *BRACES),
            masses=(self.options.mass / len(FRAME),) * len(FRAME), material="steel", group=group,
        )  # fmt: skip
        particles, springs = [], []
        for name, (at, arm, shocks) in zip(axles, AXLES, strict=True):
            particles.append(ParticleDef(id=name, position=place(*at), mass=self.options.axle_mass, group=group))
            for corner, material in ((arm, "steel"), *((shock, "shock") for shock in shocks)):
                springs.append(SpringDef(a=name, b=f"{frame}.{corner}", material=material, group=group))
        first = len(level.springs)
        level = replaced(
            level,
            materials={**level.materials, **{name: m for name, m in MATERIALS.items() if name not in level.materials}},
            bodies=(*level.bodies, body), particles=(*level.particles, *particles), springs=(*level.springs, *springs),
        )  # fmt: skip
        chosen = [Item("body", frame), *(Item("particle", name) for name in axles)]
        chosen += [Item("spring", first + index) for index in range(len(springs))]
        return replace(document, level=checked(level), selection=frozenset(chosen))

    def sizes(self, points: list[Snap]) -> str:
        """Length and angle."""
        return direction(points)


CHASSIS = EditorTool("chassis", "Shift+G", "Chassis: a frame with two axles on springs", ChassisDrawing)
