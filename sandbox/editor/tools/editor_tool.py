"""EditorTool: all that the editor knows of one of its tools; each stands with its drawing, the palette lists them."""

from dataclasses import dataclass
from typing import Any, Literal

from sandbox.editor.tools.drawing_tool import Drawing

# Where the page of all shortcuts has a tool.
Group = Literal["Draw", "Terrain"]


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
        """The action that takes it up."""
        return f"tool_{self.name}"

    @property
    def title(self) -> str:
        """What it is called in the window."""
        return self.word or self.name
