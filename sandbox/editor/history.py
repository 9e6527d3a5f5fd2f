"""History: every state of a document with the label of the step that led to it; undo goes back one."""

from typing import NamedTuple

from sandbox.editor.document import Document, select
from sandbox.editor.items import Selection
from sandbox.editor.objects import called_together


class _Step(NamedTuple):
    label: str
    document: Document
    merge: str | None
    subject: str = ""


class History:
    """States of a document, all kept, and which of them is the present one.

    A new step forgets those that were undone. Nothing is copied: states share what they have in common.
    """

    def __init__(self, document: Document, label: str = "Open") -> None:
        self._steps = [_Step(label, document, None)]
        self.index = 0
        self._saved = document.level

    @property
    def document(self) -> Document:
        """The present state."""
        return self._steps[self.index].document

    @property
    def labels(self) -> list[str]:
        """Labels of all steps, undone ones too; the first is that of the state the history began with."""
        return [step.label for step in self._steps]

    @property
    def subjects(self) -> list[str]:
        """The things that each step changed, in a few words; "" where nothing was selected after it."""
        return [step.subject for step in self._steps]

    @property
    def can_undo(self) -> bool:
        """Whether a step can be undone."""
        return self.index > 0

    @property
    def can_redo(self) -> bool:
        """Whether an undone step can be made again."""
        return self.index + 1 < len(self._steps)

    def apply(self, label: str, document: Document, merge: str | None = None) -> None:
        """Make a document the present state, as a new step unless its level is the present one's own object.

        merge: a step with the same key as the one before is part of it, as in a drag; None = a step of its own.
        """
        present = self._steps[self.index]
        if document.level is present.document.level:
            self.select(document.selection)
            return
        del self._steps[self.index + 1 :]
        if merge is not None and merge == present.merge:
            self._steps[self.index] = _Step(label, document, merge, called_together(document))
            return
        self.end_merge()
        self._steps.append(_Step(label, document, merge, called_together(document)))
        self.index += 1

    def end_merge(self) -> None:
        """End the run of edits that count as one step, as when a drag has ended."""
        self._steps[self.index] = self._steps[self.index]._replace(merge=None)

    def select(self, selection: Selection) -> None:
        """Select items; no step."""
        self._steps[self.index] = self._steps[self.index]._replace(document=select(self.document, selection))

    def undo(self) -> None:
        """Go back one step; nothing happens at the first."""
        self.go_to(max(0, self.index - 1))

    def redo(self) -> None:
        """Go forward one step that was undone; nothing happens at the last."""
        self.go_to(min(len(self._steps) - 1, self.index + 1))

    def go_to(self, index: int) -> None:
        """Make the state after step `index` the present one. Raises IndexError."""
        if not 0 <= index < len(self._steps):
            raise IndexError(f"there are the steps 0 to {len(self._steps) - 1}")
        self.end_merge()
        self.index = index
        self.end_merge()

    @property
    def is_saved(self) -> bool:
        """Whether the present level is the one that was opened or saved last."""
        return self.document.level is self._saved

    def mark_saved(self) -> None:
        """Remember the present level as the one that is on disk."""
        self._saved = self.document.level
        self.end_merge()
