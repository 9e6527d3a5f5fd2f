"""Editing: what the parts of the editor ask of the screen that they belong to."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.contracts.screen import Pixel, Pointer
from sandbox.app.draw.camera import Box, Camera, Point
from sandbox.app.widgets.ui import Ui
from sandbox.editor.document import Document
from sandbox.editor.firing import Firing
from sandbox.editor.history import History
from sandbox.editor.items import Selection
from sandbox.editor.lint.finding import Finding
from sandbox.editor.panel.field_info import Pick
from sandbox.editor.range_trial import RangeTrial
from sandbox.editor.scene import Scene
from sandbox.editor.storage.level_file import LevelFile
from sandbox.editor.tools.snap import Snap
from sandbox.editor.trail import Trail
from sandbox.editor.visibility import Visibility


class PointerTool(Protocol):
    """A tool under the pointer."""

    @property
    def hint(self) -> str:
        """What to do next, in one line."""
        ...

    @property
    def measure(self) -> str:
        """Size, length or angle of what is drawn or dragged, in words; empty where nothing is."""
        ...

    @property
    def transform(self) -> np.ndarray | None:
        """The map (2, 3) by which a drag moves the selection so far; None = no drag does."""
        ...

    def down(self, point: Point, modifiers: int, clicks: int) -> None:
        """React to a press of the pointer at a point [m]."""
        ...

    def move(self, point: Point, modifiers: int) -> None:
        """React to a move of the pressed pointer."""
        ...

    def up(self, point: Point, modifiers: int) -> None:
        """React to a release of the pointer."""
        ...

    def hover(self, point: Point | None, modifiers: int) -> None:
        """Take note of where the pointer is while nothing is pressed; None = elsewhere."""
        ...

    def cancel(self) -> bool:
        """Give up what is under way; whether there was anything."""
        ...

    def ghost(self) -> Document | None:
        """The document as it would be if the pointer were released now, drawn pale; None = nothing is added."""
        ...

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the tool's handles and marks over the level."""
        ...


class Watching(Protocol):
    """What is worked out beside the editing: findings, the forecast, trails, and values that are tried."""

    findings: list[Finding]
    # Whether it is shown where everything will hang, and where things will go.
    forecasts: bool
    trails: bool
    # When the rules would have fired in the run before; None = there was none, or it is not known yet.
    firing: Firing | None
    # Values of a number that are tried; None = none are.
    range_trial: RangeTrial | None

    @property
    def ignored(self) -> int:
        """How many findings are ignored."""
        ...

    def ignore(self, finding: Finding) -> None:
        """Show a finding no more while the level is open."""
        ...

    def show_ignored(self) -> None:
        """Show all findings again, also those that were ignored."""
        ...

    @property
    def hanging(self) -> NDArray[np.float64] | None:
        """Where everything will hang [m]; None while it is not asked for or not known."""
        ...

    @property
    def shown_trails(self) -> list[tuple[Trail, bool]]:
        """The trails that are shown, that of the last run (True) first."""
        ...

    def toggle_forecast(self) -> None:
        """Show where everything will hang, or no more."""
        ...

    def toggle_trail(self) -> None:
        """Show where what is selected will go, or no more."""
        ...

    def begin_at_rest(self) -> None:
        """Let everything begin where it will hang."""
        ...


class Editing(Protocol):
    """A level that is edited; `edit` alone changes it, so that every change can be undone."""

    ui: Ui
    history: History
    camera: Camera
    snapping: bool
    # The keyboard cursor [m], and the mouse [pixels], where they are over the level.
    cursor: Point | None
    pointer: Pixel | None
    # Whether sections of the panel are folded away, by their titles, where the person said so.
    folds: dict[str, bool]
    # What was chosen on each page of the panel, and with what selected.
    chosen_on_pages: dict[str, tuple[Selection, Any]]
    # Whether springs and particles are drawn over what they look like.
    shows_lattice: bool

    @property
    def actions(self) -> dict[str, Callable[[], object]]:
        """What can be done, by the names of the table of shortcuts."""
        ...

    @property
    def show_side(self) -> bool:
        """Whether the panel at the side is shown."""
        ...

    @property
    def watch(self) -> Watching:
        """What is worked out beside the editing."""
        ...

    # The document.

    @property
    def document(self) -> Document:
        """The level in work, and what of it is selected."""
        ...

    @property
    def scene(self) -> Scene:
        """The level as arrays."""
        ...

    @property
    def visibility(self) -> Visibility:
        """What of the level is hidden or locked."""
        ...

    def set_visibility(self, visibility: Visibility) -> None:
        """Hide or lock other items; what is hidden is not selected."""
        ...

    @property
    def level_file(self) -> LevelFile:
        """Where the level is saved."""
        ...

    @property
    def selection_box(self) -> Box | None:
        """The box [m] around the selection; None where nothing is selected."""
        ...

    @property
    def scales_unevenly(self) -> bool:
        """Whether width and height of the selection can be changed one without the other."""
        ...

    def edit(self, label: str, function: Callable[[Document], Document], merge: str | None = None) -> bool:
        """Make an edit a step of the history; False, and a line for the person, where it cannot be made."""
        ...

    def apply(self, label: str, document: Document, merge: str | None = None) -> None:
        """Take a document over as a step of the history."""
        ...

    def step_to(self, index: int) -> None:
        """Show the state after a step of the history."""
        ...

    def select(self, selection: Selection) -> None:
        """Select items."""
        ...

    # Tools and the pointer.

    @property
    def tool(self) -> str:
        """The name of the tool in use."""
        ...

    @property
    def pointer_tool(self) -> PointerTool:
        """The tool in use, as the pointer works it."""
        ...

    @property
    def reach(self) -> float:
        """How far [m] from a particle the pointer still takes it."""
        ...

    def contains(self, pixel: Pixel) -> bool:
        """Whether a pixel shows the level."""
        ...

    def point(self, kind: Pointer, pixel: Pixel, modifiers: int, clicks: int = 1) -> None:
        """Hand a pointer event to the tool."""
        ...

    @property
    def grid(self) -> float:
        """Distance [m] of the points that the pointer snaps to."""
        ...

    def set_grid(self, step: float | None) -> None:
        """Give the grid a distance [m]; None = as fine as the zoom lets one see."""
        ...

    @property
    def grid_step(self) -> float | None:
        """The distance of the grid [m] that the person has set; None: it goes by the zoom."""
        ...

    def choose_tool(self, name: str) -> None:
        """Take another tool up."""
        ...

    def pick(self, kind: Pick, then: Callable[[Any], object]) -> None:
        """Let a particle, a body or a box be picked on the sheet, and hand it on."""
        ...

    def show_box(self, box: Box | None) -> None:
        """Draw the box [m] of what a panel shows on the sheet; None = none."""
        ...

    def show_rule(self, index: int | None) -> None:
        """Draw what a rule of the level is about on the sheet; None = of no rule that a panel shows."""
        ...

    def light_up(self, items: Selection) -> None:
        """Draw items brighter on the sheet, as a panel points at them."""
        ...

    def reveal(self, items: Selection) -> None:
        """Bring items into view where they are not."""
        ...

    def cancel(self) -> None:
        """Give up what is under way, then the tool, then the selection."""
        ...

    def press_cursor(self) -> None:
        """Click at the keyboard cursor; without one, end what is drawn."""
        ...

    def snaps_pointer(self, modifiers: int) -> bool:
        """Whether the grid or another part snaps the pointer."""
        ...

    def snapped(self, point: Point, modifiers: int, anchor: Point | None = None, skip: Selection = frozenset()) -> Snap:
        """The point that the pointer snaps to, or its own."""
        ...

    # What is shown.

    @property
    def without_button(self) -> tuple[str, ...]:
        """Names of the actions whose buttons have no room."""
        ...

    @property
    def scale(self) -> float:
        """Pixels per layout unit."""
        ...

    def say(self, text: str) -> None:
        """Show a line to the person."""
        ...

    def show(self, place: Point) -> None:
        """Bring a place [m] into view, and mark it for a moment."""
        ...

    def fit(self) -> None:
        """Show the level's view and all particles."""
        ...

    def draw_snap(self, surface: pygame.Surface, snapped: Snap) -> None:
        """Mark what the pointer snaps to, with a word."""
        ...

    def focus_numbers(self) -> None:
        """Give the keyboard to the row of numbers."""
        ...

    def toggle_side(self) -> None:
        """Hide or show the panel at the side."""
        ...

    def show_parts(self, path: Path | None = None) -> None:
        """Show the catalogue of parts at the side, and give the part of a file the keyboard; None = that in hand."""
        ...

    def turn_to(self, page: str) -> None:
        """Show a page of the panel at the side, and give it the keyboard."""
        ...

    def turn_page(self, by: int) -> None:
        """Show the page of the panel at the side that many tabs further."""
        ...

    def show_attempt(self, index: int | None) -> None:
        """Draw the path of one of the values that are tried in full colour, the others pale."""
        ...
