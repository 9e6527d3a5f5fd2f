"""The pointer tools of the editor: one selects and moves, the other draws."""

import math
from typing import Any

import numpy as np
import pygame

from sandbox.app.base.sentences import capitalised, sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Point
from sandbox.app.edit.canvas.corners import BodyEnds, CornerMoving, Corners, EndMoving
from sandbox.app.edit.canvas.gestures import (
    Boxing,
    Copying,
    Gesture,
    Handles,
    Lassoing,
    Moving,
    Transforming,
    pick_mode,
)
from sandbox.app.edit.canvas.overlay import draw_outline
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.grouping import groups_of, taken_groups, with_groups
from sandbox.editor.edits.terrain import corners_of, delete_corner, move_corner, piece_of
from sandbox.editor.items import Item, Selection, chosen_bodies, keys
from sandbox.editor.pick import Mode, combined, edge_at, item_at
from sandbox.editor.tools.drawing_tool import Drawing
from sandbox.editor.tools.snap import PLACE_DECIMALS, Snap
from sandbox.level.document.model import Level
from sandbox.level.kinds.rope import RopeDef

# A drag shorter than this is a click [layout units].
CLICK_REACH = 4.0
CTRL = pygame.KMOD_CTRL | pygame.KMOD_META


class SelectTool:
    """Selects, and moves what is selected; lasso: a drag in the open draws a lasso and no box.

    A click takes the whole group; a double click enters it, and until a click elsewhere or Escape its members are taken
    one by one.
    """

    def __init__(self, screen: Editing, lasso: bool) -> None:
        self._screen, self._lasso = screen, lasso
        # The group that was entered, and the level in which it was last seen.
        self._entered: str | None = None
        self._entered_in: Level | None = None
        self._gesture: Gesture | None = None
        self._pressed: Point | None = None
        self._clicked: Item | None = None
        self._double = False
        # How a click that ends without a drag joins what was pressed to the selection.
        self._leaves: Mode | None = None
        self._chosen: tuple[Item, int] | None = None
        self.hovered: Item | None = None

    @property
    def hint(self) -> str:
        """A line about what keys and clicks do now: for the selection, corners of terrain, or the ends of a body."""
        if self.corner is not None:
            return "Drag the corner or use the arrow keys; Delete removes it; drag a dot between corners to add one"
        if self.piece is not None and self._gesture is None:
            return "Drag a corner, or a dot between corners to add one; drag the piece to move it"
        if self.entered is not None:
            return f"In group {self.entered}: click its members one by one; Escape closes it"
        if self._ends() is not None and self._gesture is None:
            return "Drag an end to move that end; drag the middle to move the whole body; Shift adds, Ctrl removes"
        around = "Drag around things" if self._lasso else "Click or drag a box"
        return f"{around} to select; Shift adds, Ctrl removes or drags a copy; double click opens a group"

    @property
    def entered(self) -> str | None:
        """The group whose members are taken one by one; None: groups are taken whole."""
        level = self._screen.document.level
        if self._entered is not None and self._entered_in is not level:
            self._entered_in = level
            self._entered = self._entered if self._entered in taken_groups(level) else None
        return self._entered

    def _taken(self, items: Selection) -> Selection:
        """The items that a pick takes: these alone inside the entered group, else with the whole of their groups.

        What is picked outside leaves the group.
        """
        level = self._screen.document.level
        if self.entered is not None and items:
            groups = groups_of(level)
            if all(groups.get(item) == self.entered for item in items):
                return items
        self._entered = None
        return with_groups(level, items) - self._screen.visibility.closed

    @property
    def measure(self) -> str:
        """Length, angle or factors of the drag, in words."""
        return self._gesture.measure if self._gesture is not None else ""

    @property
    def transform(self) -> np.ndarray | None:
        """The map (2, 3) by which the drag moves the selection so far; None = no drag does."""
        return self._gesture.transform if self._gesture is not None else None

    @property
    def piece(self) -> Item | None:
        """The piece of terrain, or the zone with corners of its own, that is selected, if nothing else is."""
        document = self._screen.document
        only = next(iter(document.selection)) if len(document.selection) == 1 else None
        if only is None or only.kind not in ("terrain", "zone"):
            return None
        return only if corners_of(piece_of(document.level, str(only.key))) else None

    @property
    def corner(self) -> int | None:
        """The corner that was clicked, of the piece that is selected."""
        if self._chosen is None or self._chosen[0] != self.piece:
            return None
        corners = self._corners()
        return self._chosen[1] if corners is not None and self._chosen[1] < len(corners.points) else None

    def _corners(self) -> Corners | None:
        piece, screen = self.piece, self._screen
        return None if piece is None else Corners(screen.document, piece, screen.camera, screen.scale)

    def delete_corner(self) -> bool:
        """Delete the clicked corner; whether there is one."""
        piece, corner = self.piece, self.corner
        if piece is None or corner is None:
            return False
        self._chosen = None
        self._screen.edit("Delete a corner", lambda document: delete_corner(document, str(piece.key), corner))
        return True

    @property
    def corner_place(self) -> Point | None:
        """Where the clicked corner is [m]; None where none is."""
        piece, corner = self.piece, self.corner
        if piece is None or corner is None:
            return None
        return corners_of(piece_of(self._screen.document.level, str(piece.key)))[corner]

    def with_corner(self, document: Document, place: Point) -> Document:
        """A document with the clicked corner, which there is, at a place [m]. Raises EditError."""
        assert self.piece is not None and self.corner is not None
        at = round(place[0], PLACE_DECIMALS) + 0.0, round(place[1], PLACE_DECIMALS) + 0.0
        return move_corner(document, str(self.piece.key), self.corner, at)

    def nudge_corner(self, dx: float, dy: float) -> bool:
        """Move the clicked corner by dx, dy [m]; whether there is one."""
        place = self.corner_place
        if place is None:
            return False
        to = place[0] + dx, place[1] + dy
        self._screen.edit("Nudge a corner", lambda document: self.with_corner(document, to), merge="nudge a corner")
        return True

    def handles(self) -> Handles | None:
        """The handles around the selection."""
        screen = self._screen
        selection = screen.document.selection
        box = screen.selection_box
        if box is None or len(keys(selection, "spring")) == len(selection):
            return None
        bodies = chosen_bodies(screen.document.level, selection) if len(selection) == 1 else []
        is_line = any(isinstance(body, RopeDef) and body.pose is None for body in bodies)
        return Handles(box, screen.camera, screen.scale, screen.scales_unevenly, is_line)

    def down(self, point: Point, modifiers: int, clicks: int) -> None:
        """Take a handle or an item at a point [m], or begin a box there."""
        screen = self._screen
        handles = self.handles()
        name = handles.at(screen.camera.to_pixels(point)) if handles is not None else None
        self._pressed, self._clicked, self._gesture, self._double = point, None, None, clicks == 2
        self._chosen, self._leaves = None, None
        pixel = screen.camera.to_pixels(point)
        if self._take_corner(pixel) or self._take_end(pixel):
            return
        if handles is not None and name is not None:
            self._gesture = Transforming(screen, handles, name, point, not screen.scales_unevenly)
            return
        item = item_at(screen.scene, point, screen.reach, screen.visibility.closed)
        self._clicked = item
        if item is None:
            return
        selection = screen.document.selection
        if clicks == 2:
            self._entered = groups_of(screen.document.level).get(item)
            screen.select(frozenset({item}))
            return
        joins = modifiers & (pygame.KMOD_SHIFT | CTRL)
        # With Ctrl what is selected is taken away by a click, and copied by a drag.
        if modifiers & CTRL and item in selection:
            self._leaves = pick_mode(modifiers, True)
            return
        if joins or (item not in selection and not self._inside_ground(item, point)):
            screen.select(combined(selection, self._taken(frozenset({item})), pick_mode(modifiers, True)))

    def _inside_ground(self, item: Item, point: Point) -> bool:
        """Whether a point is amid ground or a zone, where a click selects it, but a drag begins a box: it is large."""
        screen = self._screen
        on_edge = edge_at(screen.scene, point, screen.reach, screen.visibility.closed) is not None
        return item.kind in ("terrain", "zone") and not on_edge

    def _take_corner(self, pixel: Point) -> bool:
        """Begin to drag a corner of the piece that is selected, or a new one, where a press is on one."""
        corners = self._corners()
        if corners is None:
            return False
        number, middle = corners.corner_at(pixel), corners.middle_at(pixel)
        if number is not None:
            self._gesture = CornerMoving(self._screen, corners, number, is_new=False)
        elif middle is not None:
            self._gesture = CornerMoving(self._screen, corners, middle, is_new=True)
        return self._gesture is not None

    def _ends(self) -> BodyEnds | None:
        return BodyEnds.of(self._screen.document, self._screen.camera, self._screen.scale)

    def _take_end(self, pixel: Point) -> bool:
        """Begin to drag an end of the body that is selected, where a press is on one."""
        ends = self._ends()
        name = None if ends is None else ends.at(pixel)
        if ends is not None and name is not None:
            self._gesture = EndMoving(self._screen, ends, name)
        return self._gesture is not None

    def move(self, point: Point, modifiers: int) -> None:
        """Go on with the drag; a new one begins once it is more than a click."""
        if self._pressed is None:
            return
        screen = self._screen
        if self._gesture is None:
            if math.dist(point, self._pressed) * screen.camera.zoom <= CLICK_REACH * screen.scale:
                return
            self._gesture = self._begun(self._pressed, modifiers)
        self._gesture.to(point, modifiers)

    def _begun(self, start: Point, modifiers: int) -> Gesture:
        screen = self._screen
        if self._clicked is not None and self._clicked in screen.document.selection:
            return Copying(screen, start) if modifiers & CTRL else Moving(screen, start)
        return Lassoing(screen, start, self._taken) if self._lasso else Boxing(screen, start, self._taken)

    def up(self, point: Point, modifiers: int) -> None:
        """End the drag; a click selects the item under it alone, or nothing where none is."""
        gesture, pressed, self._gesture, self._pressed = self._gesture, self._pressed, None, None
        if gesture is not None:
            gesture.end()
            self._chosen = gesture.chosen if isinstance(gesture, CornerMoving) else None
        elif pressed is not None and self._leaves is not None and self._clicked is not None:
            taken = self._taken(frozenset({self._clicked}))
            self._screen.select(combined(self._screen.document.selection, taken, self._leaves))
        elif pressed is not None and not self._double and pick_mode(modifiers, True) == "replace":
            self._screen.select(self._taken(frozenset() if self._clicked is None else frozenset({self._clicked})))

    def hover(self, point: Point | None, modifiers: int) -> None:
        """Find the item under the pointer."""
        screen = self._screen
        closed = screen.visibility.closed
        self.hovered = None if point is None else item_at(screen.scene, point, screen.reach, closed)

    def cancel(self) -> bool:
        """Give the drag up, or else leave the group, or else give the selection up."""
        under_way, self._gesture, self._pressed = self._gesture is not None, None, None
        selection = self._screen.document.selection
        if under_way or not (selection or self.entered):
            return under_way
        entered, self._entered = self.entered, None
        self._screen.select(frozenset() if entered is None else with_groups(self._screen.document.level, selection))
        return True

    def ghost(self) -> Document | None:
        """The document as it would be if the drag ended now; None = the transform says it, or no drag goes on."""
        return self._gesture.ghost() if self._gesture is not None else None

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the handles, or during a drag what the gesture shows."""
        if self._gesture is not None:
            self._gesture.draw(surface)
            return
        handles, corners = self.handles(), self._corners()
        if handles is not None:
            handles.draw(surface)
        ends = self._ends()
        if corners is not None:
            corners.draw(surface, self.corner)
        if ends is not None:
            ends.draw(surface)


class DrawTool:
    """Draws with one of the editor's drawings; name: what a step of the history is called."""

    transform: np.ndarray | None = None

    def __init__(self, screen: Editing, drawing: Drawing[Any], name: str) -> None:
        self._screen, self.drawing, self._name = screen, drawing, name
        self._snap: Snap | None = None
        self._ghost: Document | None = None
        self._ghost_before: Document | None = None
        self._ghost_of: tuple[object, ...] = ()

    @property
    def hint(self) -> str:
        """A line that says what to do next, or why the drawing cannot be placed."""
        return capitalised(self.drawing.hint)

    @property
    def measure(self) -> str:
        """Sizes of the present drawing, in words."""
        return self.drawing.measure

    def _snapped(self, point: Point, modifiers: int) -> Snap:
        self.drawing.reach = CLICK_REACH * self._screen.scale / self._screen.camera.zoom
        self._snap = self._screen.snapped(point, modifiers, self.drawing.anchor)
        return self._snap

    def down(self, point: Point, modifiers: int, clicks: int) -> None:
        """Begin a drawing at a point [m], or set its next point there."""
        self.drawing.down(self._snapped(point, modifiers))

    def move(self, point: Point, modifiers: int) -> None:
        """Move the last point of the drawing."""
        self.drawing.move(self._snapped(point, modifiers))

    def up(self, point: Point, modifiers: int) -> None:
        """Add the drawing to the level, if it is complete."""
        self.drawing.up(self._snapped(point, modifiers))
        self._take()

    def finish(self) -> None:
        """End the drawing at the pointer, and add it to the level."""
        self.drawing.finish()
        self._take()

    def adjust(self, by: int) -> None:
        """Change the number of the drawing's parts by so many."""
        try:
            self.drawing.adjust(by)
        except EditError as error:
            self._screen.say(sentence(error))

    def _take(self) -> None:
        try:
            document = self.drawing.done(self._screen.document)
        except EditError as error:
            self._screen.say(sentence(error))
            return
        if document is not None:
            touched = self._screen.document.level.has_contacts
            step = self.drawing.step or self._name
            self._screen.apply(step, document)
            box = self._screen.selection_box
            if self.drawing.is_ready_made and box is not None:
                # It may be larger than what is seen.
                self._screen.camera.reveal(box)
            if document.level.has_contacts and not touched:
                self._screen.say(
                    "Things touch each other now. Set friction and bounce under Contacts on the page Level."
                )

    def hover(self, point: Point | None, modifiers: int) -> None:
        """Move the next point of the drawing to the pointer."""
        if point is None:
            self._snap = None
        else:
            self.drawing.move(self._snapped(point, modifiers))

    def put_away(self) -> None:
        """End an outline that is sound, as another tool is taken up; else give the drawing up, and say so."""
        drawing = self.drawing
        if drawing.outline:
            fault = drawing.fault_of_outline()
            if fault:
                self._screen.say(f"Not drawn: {fault}.")
            else:
                drawing.finish()
                self._take()
        drawing.cancel()

    def cancel(self) -> bool:
        """Drop the drawing; whether there was one."""
        under_way = self.drawing.under_way
        self.drawing.cancel()
        return under_way

    def ghost(self) -> Document | None:
        """The document with the drawing added, kept while nothing changes."""
        drawing, document = self.drawing, self._screen.document
        if self._snap is None and not drawing.under_way:
            return None
        of = (tuple(drawing.points), drawing.pointer, drawing.options)
        if document is not self._ghost_before or of != self._ghost_of:
            self._ghost_before, self._ghost_of, self._ghost = document, of, drawing.ghost(document)
        return self._ghost

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the corners so far, and mark the thing that the pointer snaps to."""
        outline = [self._screen.camera.to_pixels(point) for point in self.drawing.outline]
        draw_outline(surface, outline, self._screen.scale)
        if self._snap is not None:
            self._screen.draw_snap(surface, self._snap)
