"""Sections of the panel that fold: what each has, and what the panel asks of it."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from sandbox.app.base.shortcuts import hint
from sandbox.app.panel.panel_rows import PanelRows
from sandbox.app.run.playback import Playback


class SectionRows(Protocol):
    """The rows of a section; playback: the run that they show and change."""

    playback: Playback

    def build(self, rows: PanelRows) -> None:
        """Make the widgets, one row below the other."""
        ...

    def refresh(self, is_look: bool) -> None:
        """Show what the world has now, once a frame. is_look: what takes long is looked at, too."""
        ...


class SectionOwner(Protocol):
    """What sections are made of: a panel, its run, and `say`, which shows a line to the person."""

    playback: Playback
    say: Callable[[str], None]

    @property
    def springs(self) -> SectionRows:
        """Rows that the panel itself makes, for springs."""
        ...

    @property
    def engineers(self) -> SectionRows:
        """Rows that the panel itself needs, for engineers."""
        ...

    @property
    def world(self) -> SectionRows:
        """Rows that the panel itself needs, for the world."""
        ...


@dataclass(frozen=True)
class PanelSection:
    """A section: its heading, and what makes its rows for a panel.

    words: what a level's hint asks for it by, beside its heading.
    """

    title: str
    make: Callable[[SectionOwner], SectionRows]
    words: tuple[str, ...] = ()

    def is_asked_for(self, description: str) -> bool:
        """Whether a level's description speaks of what is in it."""
        said = hint(description)
        return any(re.search(rf"\b{re.escape(word)}\b", said) for word in (self.title, *self.words))
