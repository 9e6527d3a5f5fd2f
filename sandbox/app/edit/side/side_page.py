"""SidePage: a page of the editor's side panel."""

from typing import Any


class SidePage:
    """A page, which is made in a place of its own; that is taken away with all its widgets.

    chosen: the line of its list that is chosen, which the next page of its kind begins with; None: it has no such list.
    """

    chosen: Any = None
    # Whether what is chosen at first goes by the selection, where that is another one than before.
    follows_selection = False

    def refresh(self) -> None:
        """Show the document as it is now; costs nothing where it has not changed."""
        raise NotImplementedError

    def close(self) -> None:
        """End what the page shows outside of its place, such as a box on the sheet."""
