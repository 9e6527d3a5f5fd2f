"""The part tool: a click puts a part of the catalogue into the level, as one group."""

from dataclasses import dataclass, field, replace

from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.copying import place_part
from sandbox.editor.tools.drawing_options import Options, flag_option
from sandbox.editor.tools.drawing_tool import Drawing, EditorTool
from sandbox.editor.tools.snap import Snap
from sandbox.level.document.model import Level


@dataclass(frozen=True)
class PartOptions(Options):
    """Options of a part: which, None = none yet, and which way round."""

    part: Level | None = field(default=None)
    mirrored: bool = flag_option(False, "mirrored", "Mirrored, so that a car faces the other way.")


class PartDrawing(Drawing[PartOptions]):
    """A click puts the part where the pointer is, by its origin; it joins nothing."""

    defaults = PartOptions()
    needs = 1
    is_ready_made = True
    # It lies beside what it is put on.
    joins_particles = False

    @property
    def hint(self) -> str:
        """A line that says what a click would do, or why it cannot be done."""
        part = self.options.part
        fault = self._fault or self._ghost_fault
        return fault or ("Choose a part on the page Parts" if part is None else f"Click where it goes: {part.name}")

    @property
    def step(self) -> str:
        """Name of the step in the history."""
        return "Add a part" if self.options.part is None else f"Add {self.options.part.name}"

    def take(self, part: Level) -> None:
        """Take another part in hand."""
        self.cancel()
        self.options = replace(self.options, part=part)

    def ghost(self, document: Document) -> Document | None:
        """The part where a click would put it; None where none is chosen."""
        return None if self.options.part is None else super().ghost(document)

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the part. Raises EditError."""
        if self.options.part is None:
            raise EditError("choose a part first, on the page Parts")
        return place_part(document, self.options.part, points[0].point, self.options.mirrored)


PART = EditorTool("part", "Shift+P", "Part: car, crane, walker and others", PartDrawing)
