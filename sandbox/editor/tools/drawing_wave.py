"""The wave tool: a drag along muscles lets them swing one after another, the way it goes."""

from dataclasses import dataclass, replace

from sandbox.editor.document import Document
from sandbox.editor.edits.additions import muscles, wave_along
from sandbox.editor.tools.drawing_options import Options, number_option
from sandbox.editor.tools.drawing_tool import Drawing, EditorTool
from sandbox.editor.tools.snap import Snap


@dataclass(frozen=True)
class WaveOptions(Options):
    """How often muscles swing alike along the drag."""

    waves: float = number_option(1.0, "waves", "Waves along the drag.", high=1000.0)


class WaveDrawing(Drawing[WaveOptions]):
    """Phases from places along a drag, of the selected muscles or of all."""

    defaults = WaveOptions()
    step = "Phase wave"
    start_hint = "Drag along the muscles in the direction of the wave; it takes the selected ones, or all"
    end_hint = "Release where the wave ends"
    has_outline = True
    joins_particles = False

    def __init__(self, options: WaveOptions | None = None, reach: float = 0.0) -> None:
        super().__init__(options, reach)
        self._count = 0

    def _shown(self, document: Document, points: list[Snap]) -> None:
        """None: nothing is added; `hint` says why it cannot be done."""
        self._count = len(muscles(document))
        self.placed(document, points)

    def placed(self, document: Document, points: list[Snap]) -> Document:
        """The document with the phases; the selection stays. Raises EditError."""
        start, end = points[0].point, points[1].point
        return replace(wave_along(document, start, end, self.options.waves), selection=document.selection)

    def sizes(self, points: list[Snap]) -> str:
        """Number of muscles and of waves, in words."""
        muscles = f"{self._count} {'muscle' if self._count == 1 else 'muscles'}"
        return "" if self._ghost_fault else f"{muscles}, waves: {self.options.waves:g}"


WAVE = EditorTool("wave", "Shift+W", "Phase wave through muscles, along a drag", WaveDrawing, word="wave")
