"""The tools of loose particles and springs, and of pins."""

from dataclasses import dataclass, replace

from sandbox.editor.document import Document, EditError, select
from sandbox.editor.edits.placing import add_particle, add_spring, set_pinned, weld
from sandbox.editor.items import Selection
from sandbox.editor.tools.drawing_bodies import direction, known_material
from sandbox.editor.tools.drawing_options import Options, flag_option, mass_option, material_option, number_option
from sandbox.editor.tools.drawing_tool import Drawing, EditorTool, staged
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import ParticleDef
from sandbox.level.format.limits import BODY_RADIUS


@dataclass(frozen=True)
class ParticleOptions(Options):
    """A loose particle."""

    mass: float = mass_option(1.0, text="Mass.")
    radius: float = number_option(0.05, "radius", "Radius, as drawn and where it touches.", "m")
    pinned: bool = flag_option(False, "pinned", "Pin it where it is.")


class ParticleDrawing(Drawing[ParticleOptions]):
    """A click places a particle; on another one it becomes part of that, as a weight does."""

    defaults = ParticleOptions()
    needs = 1
    start_hint = "Click where the particle goes"

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the particle. Raises EditError."""
        document = new_particle(document, points[0], self.options.mass, self.options.radius, self.options.pinned)
        name = points[0].name
        if name is None:
            return document
        return select(weld(document, name, document.level.particles[-1].id), document.selection)


def new_particle(
    document: Document, at: Snap, mass: float, radius: float = BODY_RADIUS, pinned: bool = False
) -> Document:
    """The document with a loose particle."""
    particle = ParticleDef(id="particle", position=at.point, mass=mass, radius=radius, pinned=pinned)
    return add_particle(document, particle)


@dataclass(frozen=True)
class SpringOptions(Options):
    """A loose spring, and the particles that it gets where it ends at none."""

    material: str = material_option()
    mass: float = mass_option(1.0, text="Mass of the new particle at an end in empty space.")


class SpringDrawing(Drawing[SpringOptions]):
    """A spring from particle to particle; an end in empty space gets a particle of its own."""

    defaults = SpringOptions()
    start_hint = "Drag from one particle to another, or click both"
    end_hint = "Click the other particle, or where it goes"

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the spring. Raises EditError."""
        added: Selection = frozenset()
        names = []
        for point in points:
            if point.name is None:
                document = new_particle(document, point, self.options.mass)
                added |= document.selection
                names.append(document.level.particles[-1].id)
            else:
                names.append(point.name)
        document = add_spring(document, names[0], names[1], known_material(document, self.options.material))
        return select(document, document.selection | added)

    def sizes(self, points: list[Snap]) -> str:
        """Length and angle."""
        return direction(points)


@dataclass(frozen=True)
class PinOptions(Options):
    """A pin has none."""


PIN_HINT = "Click a particle to pin or unpin it"


class PinDrawing(Drawing[PinOptions]):
    """A click holds a particle of whatever body where it is, another lets it go."""

    defaults = PinOptions()
    needs = 1
    step = "Pin or unpin"

    def __init__(self, options: PinOptions | None = None, reach: float = 0.0) -> None:
        super().__init__(options, reach)
        self._offer = PIN_HINT

    @property
    def hint(self) -> str:
        """A line that says what a click would do."""
        return self._offer

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the particle pinned, or no longer. Raises EditError."""
        name = points[0].name
        if name is None:
            raise EditError("there is no particle here; click one to pin or unpin it")
        return set_pinned(document, [name], not self._is_pinned(document, name))

    def ghost(self, document: Document) -> Document | None:
        """A stand-in of the particle at the pointer, pinned or not as a click would make it, selected."""
        if self.pointer is None or self.pointer.name is None:
            self._offer = PIN_HINT
            return None
        pinned = self._is_pinned(document, self.pointer.name)
        self._offer = f"Click to {'unpin' if pinned else 'pin'} {self.pointer.name}"
        stage, points = staged(document, [replace(self.pointer, name=None)])
        return new_particle(stage, points[0], 1.0, pinned=not pinned)

    def _is_pinned(self, document: Document, name: str) -> bool:
        scene = self._scene_of(document)
        try:
            return bool(scene.pinned[scene.slot(name)])
        except LookupError as error:
            raise EditError(str(error.args[0])) from None


PARTICLE = EditorTool("particle", "A", "Particle", ParticleDrawing)
SPRING = EditorTool("spring", "S", "Spring", SpringDrawing)
PIN = EditorTool("pin", "P", "Pin or unpin a particle", PinDrawing)
