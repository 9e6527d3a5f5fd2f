"""PlayTool: all that the window knows of one tool in play; each stands with its tool, `play_tools` lists them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from sandbox.tools.tool import Tool

# Where the page of all shortcuts has a tool; those of "Parts" are buttons of the strip at the left, too.
Group = Literal["Tools", "Parts"]


@dataclass(frozen=True)
class PlayTool:
    """A tool: its name, the keys that take it up, its line on the help page and in its tip, and its group.

    make: the tool, for a function that gives the number of a new gesture. Its icon is the file of its name in
    assets/icons, unless the strip has a picture of its own for it.
    deed: what hands do with it, which a level may keep away.
    """

    name: str
    keys: tuple[str, ...]
    label: str
    group: Group
    make: Callable[[Callable[[], int]], Tool]
    deed: str = ""

    @property
    def action(self) -> str:
        """The action that takes it up."""
        return f"tool_{self.name}"
