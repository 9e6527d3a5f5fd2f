"""SidePage: a page of the editor's side panel."""


class SidePage:
    """A page, which is made in a place of its own; that is taken away with all its widgets."""

    def refresh(self) -> None:
        """Show the document as it is now; costs nothing where it has not changed."""
        raise NotImplementedError

    def close(self) -> None:
        """End what the page shows outside of its place, such as a box on the sheet."""
