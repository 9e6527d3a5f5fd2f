"""EditScreen: a level that is edited: canvas and rulers, palette, bar, tool options, and the panel at the side."""

import math
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pygame

from sandbox.app.base.loop import Profile
from sandbox.app.base.sentences import sentence
from sandbox.app.base.shortcuts import Mode
from sandbox.app.contracts.application import Application
from sandbox.app.contracts.screen import ROOM_FOR_NOTICES, Figures, NoticesPlace, Pixel, Pointer
from sandbox.app.draw.camera import Box, Camera, Point, grid_spacing, union
from sandbox.app.draw.colours import ACCENT, DANGER, MUTED, SURFACE, TEXT, WARNING, Colour
from sandbox.app.edit.actions import edit_actions
from sandbox.app.edit.bar import Bar, Palette, open_context_menu, palette_width
from sandbox.app.edit.canvas.canvas import SNAP_STEP
from sandbox.app.edit.canvas.overlay import draw_snap
from sandbox.app.edit.canvas.picking import PickTool
from sandbox.app.edit.canvas.pointer import CLICK_REACH, DrawTool, SelectTool
from sandbox.app.edit.canvas.view import RULER, Rulers, View
from sandbox.app.edit.clipboard import Clipboard
from sandbox.app.edit.side.options import OPTIONS_HEIGHT, OptionsRow
from sandbox.app.edit.side.side import Side
from sandbox.app.edit.watch import Watch
from sandbox.app.panel.panel_rows import ROOM_FOR_PANEL
from sandbox.app.play.stage import PICK_RADIUS
from sandbox.app.play.status import STATUS_HEIGHT, counted_parts
from sandbox.app.play.toolbar import BAR_HEIGHT
from sandbox.app.widgets.ui import Ui
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.moving import can_scale_unevenly, move
from sandbox.editor.edits.names import lost_rules
from sandbox.editor.held_joins import with_joins_held
from sandbox.editor.history import History
from sandbox.editor.items import Selection, Visibility
from sandbox.editor.panel.field_info import Pick
from sandbox.editor.scene import Scene, make_scene
from sandbox.editor.storage.level_file import LevelFile
from sandbox.editor.tools.palette import LASSO, TOOLS
from sandbox.editor.tools.snap import Snap, snap

# Sizes in layout units.
SIDE_WIDTH = 292.0
# A nudge with Shift is this many steps of the grid.
NUDGE_LEAP = 10
# Of more items than this the panel at the side follows a frame later.
LARGE_SELECTION = 1_000
# Scenes of this many states are kept, for who goes back to them; one of 20,000 particles takes some megabytes.
SCENES_KEPT = 4
# Of a view: what makes it no wider and no higher than this many times is fitted in with it.
FARTHEST = 3.0
# View [m] of a level in which nothing is yet.
FIRST_VIEW: Box = (-6.0, -3.0, 6.0, 4.0)


class EditScreen:
    """Edits a level; panels and tools change it by `edit` alone, so that every change can be undone."""

    mode: Mode = "edit"

    def __init__(self, app: Application, history: History, level_file: LevelFile) -> None:
        self.app, self.history, self.level_file = app, history, level_file
        self.ui: Ui = app.ui
        # Whether the person wants the panel at the side; None: it is shown where there is room.
        self._wants_side: bool | None = None
        self.side: Side | None = None
        # The page of the panel that was shown last.
        self._tab = "properties"
        self.camera = Camera(viewport=self._viewport())
        self.view = View(self)
        self.tool, self.snapping = "select", True
        self.folds: dict[str, bool] = {}
        self.chosen_on_pages: dict[str, tuple[Selection, Any]] = {}
        self.shows_lattice = True
        self.grid_step: float | None = None
        # What is picked on the sheet now, in place of what the tool does.
        self._picking: PickTool | None = None
        self.cursor: Point | None = None
        self.pointer: Pixel | None = None
        # Where the mouse was pressed last.
        self._pressed: Pixel = (0.0, 0.0)
        self._scenes: deque[Scene] = deque(maxlen=SCENES_KEPT)
        # What is hidden and locked, of items that were deleted too: they may come back.
        self._visibility = self._visible_now = Visibility()
        self._visible_in: object = None
        self._box: tuple[Scene, Selection, Box | None] | None = None
        self._scales_unevenly: tuple[Document, bool] | None = None
        self._seen: Document | None = None
        self._is_side_late = False
        self.watch: Watch = Watch(self)
        self.clipboard = Clipboard(self, app.documents.edit_level)
        self.pointer_tools: dict[str, DrawTool | SelectTool] = {
            name: DrawTool(self, tool.drawing(), f"Draw {name}") if tool.drawing else SelectTool(self, tool is LASSO)
            for name, tool in TOOLS.items()
        }
        self.actions: dict[str, Callable[[], object]] = edit_actions(self, app, self.clipboard)
        self.fit()

    # The document.

    @property
    def document(self) -> Document:
        """The edited level with its selection."""
        return self.history.document

    @property
    def scene(self) -> Scene:
        """The level as arrays."""
        level, scenes = self.document.level, self._scenes
        if not scenes or scenes[-1].level is not level:
            known = next((scene for scene in scenes if scene.level is level), None)
            scenes.append(known or make_scene(level, scenes[-1] if scenes else None))
        return scenes[-1]

    @property
    def visibility(self) -> Visibility:
        """Which items are hidden or locked."""
        level = self.document.level
        if self._visible_in is not level:
            self._visible_in = level
            has_any = bool(self._visibility.closed)
            self._visible_now = self._visibility.among(frozenset(self.scene.items)) if has_any else self._visibility
        return self._visible_now

    def set_visibility(self, visibility: Visibility) -> None:
        """Hide or lock items; hidden ones are not selected."""
        self._visibility, self._visible_in = visibility, None
        if self.document.selection & visibility.hidden:
            self.select(self.document.selection - visibility.hidden)

    @property
    def selection_box(self) -> Box | None:
        """The box [m] around the selection; None where nothing is selected."""
        scene, selection = self.scene, self.document.selection
        if self._box is None or self._box[0] is not scene or self._box[1] is not selection:
            self._box = (scene, selection, scene.bounds(selection) if selection else None)
        return self._box[2]

    @property
    def folder(self) -> Path | None:
        """The folder of the level's file, None: it has none yet."""
        return None if self.level_file.path is None else self.level_file.path.parent

    def edit(self, label: str, function: Callable[[Document], Document], merge: str | None = None) -> bool:
        """Make an edit a step of the history; False, and a line for the person, where it cannot be made.

        What is joined to what it moves stays joined.
        """
        try:
            made = function(self.document)
            held = with_joins_held(self.document.level, made)
        except EditError as error:
            self.say(sentence(error))
            return False
        self.apply(label, held.document, merge)
        if held.notice:
            self.say(held.notice)
        return True

    def apply(self, label: str, document: Document, merge: str | None = None) -> None:
        """Take an edited document over as a step of the history; rules that go with what they named are told of."""
        lost = lost_rules(self.document.level, document.level)
        self.take_over(label, document, merge)
        if lost:
            one = len(lost) == 1
            names = f"{'Rule' if one else 'Rules'} {', '.join(lost)}"
            self.say(f"{names} went too: what {'it names' if one else 'they name'} is gone. Undo brings it back.")

    def take_over(self, label: str, document: Document, merge: str | None = None) -> None:
        """Take a document over as a step of the history, another level too."""
        before = self.document.level
        self.history.apply(label, document, merge)
        self.level_changed(label, before)

    def level_changed(self, label: str, before: object) -> None:
        """Note the level in the autosave, where it has changed."""
        if self.document.level is not before:
            self.app.documents.note(self.document.level, self.level_file.path, label)

    def step_to(self, index: int) -> None:
        """Show the state after a step of the history."""
        before = self.document.level
        self._give_up()
        self.history.go_to(index)
        self.level_changed(self.history.labels[index], before)

    def select(self, selection: Selection) -> None:
        """Select items; the history has no step for it, but what is nudged next is a step of its own."""
        self.history.end_merge()
        self.history.select(selection)

    def end_merge(self) -> None:
        """End the run of edits that count as one step."""
        self.history.end_merge()

    def say(self, text: str) -> None:
        """Show a line about the sheet, which ends with it."""
        self.app.say(text, self)

    # What the panels ask.

    def show_attempt(self, index: int | None) -> None:
        """Draw the path of one of the values that are tried in full colour, the others pale."""
        self.view.chosen_attempt = index

    def show(self, place: Point) -> None:
        """Bring a place [m] into view, and mark it for a moment."""
        left, top, width, height = self.camera.viewport
        pixel = self.camera.to_pixels(place)
        if not pygame.Rect(left, top, width, height).inflate(-width // 5, -height // 5).collidepoint(pixel):
            self.camera.centre = place
        self.view.point_out(place)

    def show_box(self, box: Box | None) -> None:
        """Draw the box [m] of what a panel shows on the sheet; None = none."""
        self.view.shown_box = box

    def show_rule(self, index: int | None) -> None:
        """Draw what a rule of the level is about on the sheet; None = of no rule that a panel shows."""
        self.view.shown_rule = index

    def light_up(self, items: Selection) -> None:
        """Draw items brighter on the sheet, as a panel points at them."""
        self.view.pointed = items

    def reveal(self, items: Selection) -> None:
        """Bring items into view where they are not."""
        box = self.scene.bounds(items)
        if box is not None:
            self.camera.reveal(box)

    # Layout.

    @property
    def scale(self) -> float:
        """Pixels per layout unit."""
        return self.ui.scale

    @property
    def _palette_width(self) -> float:
        width, height = self.ui.units
        return palette_width(width, height - BAR_HEIGHT - STATUS_HEIGHT)

    @property
    def notices_place(self) -> NoticesPlace | None:
        """Where notices begin, from the lower left corner, and how far right they may reach [layout units]."""
        left, _, width, height = self.camera.viewport
        if min(width, height) < ROOM_FOR_NOTICES * self.scale:
            return None
        over = SIDE_WIDTH if self.show_side and self._side_lies_over else 0.0
        return self._palette_width + RULER + 12.0, 0.0, (left + width) / self.scale - over

    @property
    def without_button(self) -> tuple[str, ...]:
        """Names of the actions whose buttons have no room."""
        return self.bar.left_out

    def _viewport(self) -> tuple[int, int, int, int]:
        ui, (width, height) = self.ui, self.ui.size
        left, top = ui.px(self._palette_width) + ui.px(RULER), ui.px(BAR_HEIGHT + OPTIONS_HEIGHT) + ui.px(RULER)
        right = ui.px(SIDE_WIDTH) if self.show_side and not self._side_lies_over else 0
        return left, top, max(width - left - right, 1), max(height - top - ui.px(STATUS_HEIGHT), 1)

    def build(self, ui: Ui) -> None:
        """Lay the widgets out again."""
        self.ui = ui
        before = self.camera.viewport
        self.camera.viewport = self._viewport()
        self.camera.zoom *= math.sqrt(self.camera.viewport[2] * self.camera.viewport[3] / max(before[2] * before[3], 1))
        width, height = ui.units
        self.bar = Bar(ui, self.app.act)
        self.palette = Palette(ui, self.app.act, BAR_HEIGHT, height - BAR_HEIGHT - STATUS_HEIGHT)
        left = self._palette_width
        self.options = OptionsRow(self, ui.rect(left, BAR_HEIGHT, width - left, OPTIONS_HEIGHT))
        self.rulers = Rulers(ui)
        # What is being typed in the old panel is not lost.
        self._close_side()
        if self.show_side:
            self.side = Side(ui, self, self._side_place(), self._tab)

    def _close_side(self) -> None:
        if self.side is not None:
            self._tab = self.side.tab
            self.side.close()
            self.side = None

    def _side_place(self) -> pygame.Rect:
        ui, (width, height), top = self.ui, self.ui.units, BAR_HEIGHT + OPTIONS_HEIGHT
        return ui.rect(width - SIDE_WIDTH, top, SIDE_WIDTH, height - top - STATUS_HEIGHT)

    @property
    def show_side(self) -> bool:
        """Whether the panel at the side is shown."""
        return self.ui.units[0] >= ROOM_FOR_PANEL if self._wants_side is None else self._wants_side

    @property
    def _side_lies_over(self) -> bool:
        """Whether the panel at the side lies over the sheet: beside it, a narrow window has no room for both."""
        return self.ui.units[0] < ROOM_FOR_PANEL

    def toggle_side(self) -> None:
        """Hide or show the panel at the side."""
        self._wants_side = not self.show_side
        self.app.rebuild()

    def show_parts(self, path: Path | None = None) -> None:
        """Show the catalogue of parts at the side, and give the part of a file the keyboard; None = that in hand."""
        self.turn_to("parts", path)

    def turn_to(self, page: str, path: Path | None = None) -> None:
        """Show a page of the panel at the side, and give it the keyboard; path: of a part."""
        if self.side is None:
            self.toggle_side()
        assert self.side is not None
        self.side.choose(page)
        self.side.focus(path)

    def turn_page(self, by: int) -> None:
        """Show the page of the panel at the side that many tabs further."""
        if self.side is not None:
            self.side.turn_page(by)

    def fit(self) -> None:
        """Show the level's view and the particles about it; again, or without a view: all, terrain and walls too."""
        level, before = self.document.level, (self.camera.centre, self.camera.zoom)
        self.show_view()
        if level.view is None or before == (self.camera.centre, self.camera.zoom):
            self._fit_to(level.view, self.whole_box)

    def show_view(self) -> None:
        """Show the level's view and the particles about it, where it has one."""
        level, scene = self.document.level, self.scene
        if level.view is not None:
            about = scene.bounds(frozenset(item for item in scene.items if item.kind not in ("terrain", "zone")))
            self._fit_to(level.view, about if about is not None and _is_about(about, level.view) else None)

    @property
    def whole_box(self) -> Box | None:
        """The box [m] around all that there is, walls and zones too; None where there is nothing."""
        walls = self.document.level.walls
        boxes = [box for box in (self.scene.bounds(), None if walls is None else walls.box) if box is not None]
        return union(*boxes) if boxes else None

    def _fit_to(self, *boxes: Box | None) -> None:
        """Show boxes [m], or a first view where there are none."""
        known = [box for box in boxes if box is not None] or [FIRST_VIEW]
        self.camera.fit(union(*known))

    @property
    def scales_unevenly(self) -> bool:
        """Whether width and height of the selection can be changed one without the other."""
        document = self.document
        if self._scales_unevenly is None or self._scales_unevenly[0] is not document:
            self._scales_unevenly = (document, can_scale_unevenly(document))
        return self._scales_unevenly[1]

    # Tools.

    @property
    def pointer_tool(self) -> DrawTool | SelectTool | PickTool:
        """The tool in use, as the pointer works it."""
        return self._picking or self.pointer_tools[self.tool]

    def pick(self, kind: Pick, then: Callable[[Any], object]) -> None:
        """Start picking a particle, a body or a box on the sheet; the picked one is handed on."""
        self.settle()
        self._picking = PickTool(self, kind, then)

    def choose_tool(self, name: str) -> None:
        """Take another tool up."""
        if name != self.tool and isinstance(self.pointer_tool, DrawTool):
            self.pointer_tool.put_away()
        self._picking = None
        self.tool = name

    def cancel(self) -> None:
        """Cancel the present gesture, or else put the tool away; picking ends."""
        self.cursor = None
        if not self.pointer_tool.cancel() and self.tool != "select":
            self.choose_tool("select")
        self._end_picking()

    @property
    def reach(self) -> float:
        """How far [m] from a particle the pointer still takes it."""
        return PICK_RADIUS * self.scale / self.camera.zoom

    @property
    def grid(self) -> float:
        """Distance [m] of the points that the pointer snaps to."""
        return self.grid_step or grid_spacing(self.camera.zoom, SNAP_STEP * self.scale)

    def set_grid(self, step: float | None) -> None:
        """Give the grid a distance [m]; None = as fine as the zoom lets one see."""
        self.grid_step = step
        self.say(f"The grid has a step of {step:g} m." if step else "The grid follows the zoom.")

    def snaps_pointer(self, modifiers: int) -> bool:
        """Whether the grid or another part snaps the pointer: not while Alt is held."""
        return self.snapping and not modifiers & pygame.KMOD_ALT

    def snapped(self, point: Point, modifiers: int, anchor: Point | None = None, skip: Selection = frozenset()) -> Snap:
        """The point that the pointer snaps to, or its own."""
        if not self.snaps_pointer(modifiers):
            return snap(self.scene, point, 0.0)
        return snap(self.scene, point, self.reach, self.grid, anchor, skip | self.visibility.hidden)

    # Pointer and keys.

    def contains(self, pixel: Pixel) -> bool:
        """Whether a pixel shows the level."""
        is_covered = self.side is not None and self.side.back.rect.collidepoint(pixel)
        return not is_covered and pygame.Rect(self.camera.viewport).collidepoint(pixel)

    def point(self, kind: Pointer, pixel: Pixel, modifiers: int, clicks: int = 1) -> None:
        """Hand a pointer event to the tool."""
        point = self.camera.to_world(pixel)
        self.pointer = pixel
        if kind == "down":
            self.cursor = None
            self.history.end_merge()
            self._pressed = pixel
            self.pointer_tool.down(point, modifiers, clicks)
        elif kind == "move":
            self._make_room(pixel)
            self.pointer_tool.move(point, modifiers)
        else:
            self.pointer_tool.up(point, modifiers)
        self._end_picking()

    def _make_room(self, pixel: Pixel) -> None:
        """Close a panel that lies over the sheet, once something is dragged there."""
        if (
            self.side is not None
            and self._side_lies_over
            and math.dist(pixel, self._pressed) > CLICK_REACH * self.scale
        ):
            self._wants_side = False
            self._close_side()

    def _end_picking(self) -> None:
        if self._picking is not None and self._picking.is_over:
            self._picking = None

    def press_key(self, key: int, modifiers: int) -> bool:
        """Ignore keys: keys of a level work only while it is played."""
        return False

    def release_key(self, key: int) -> None:
        """Do nothing: no key of a level is held."""

    def open_menu(self, pixel: Pixel) -> None:
        """Open the menu of the thing at a pixel."""
        self.settle()
        open_context_menu(self, pixel)

    @property
    def takes_rest(self) -> bool:
        """False: a press selects or draws at once."""
        return False

    def turn_wheel(self, pixel: Pixel, steps: float) -> None:
        """Zoom about the pointer."""
        self.camera.turn_wheel(pixel, steps)

    def press_arrow(self, dx: int, dy: int, modifiers: int) -> None:
        """Nudge the selection by a step of the grid, ten with Shift; without one, move the keyboard cursor."""
        step = self.grid * (NUDGE_LEAP if modifiers & pygame.KMOD_SHIFT else 1)
        if isinstance(self.pointer_tool, SelectTool) and self.pointer_tool.nudge_corner(dx * step, dy * step):
            return
        if self.tool in ("select", "lasso") and self.document.selection:
            self.edit("Nudge", lambda document: move(document, dx * step, dy * step), merge="nudge")
            return
        left, top, width, height = self.camera.viewport
        x, y = self.cursor or self.snapped(self.camera.to_world(self.camera.middle), 0).point
        (low_x, high_y), (high_x, low_y) = (
            self.camera.to_world(corner) for corner in ((left, top), (left + width, top + height))
        )
        self.cursor = (min(max(x + dx * step, low_x), high_x), min(max(y + dy * step, low_y), high_y))
        if isinstance(self.pointer_tool, DrawTool):
            self.pointer_tool.move(self.cursor, modifiers)

    def press_cursor(self) -> None:
        """Click at the keyboard cursor; without one, end what is drawn."""
        tool = self.pointer_tool
        if self.cursor is not None:
            tool.down(self.cursor, 0, 1)
            tool.up(self.cursor, 0)
            self._end_picking()
        elif isinstance(tool, DrawTool) and not tool.drawing.under_way:
            # It is shown first.
            self.press_arrow(0, 0, 0)
        elif isinstance(tool, DrawTool):
            tool.finish()

    # A frame.

    @property
    def moves(self) -> bool:
        """Whether one of its parts is still working out what it will show."""
        has_new = self._is_side_late or (self.side is not None and self.side.moves)
        return has_new or self.view.moves or self.watch.moves

    def update(self, frame_time: float, pointer: Pixel | None, profile: Profile) -> None:
        """Follow the pointer, look for faults a little, and show the state in the widgets."""
        self.view.update(frame_time)
        if not pygame.mouse.get_pressed()[0] or pointer is None:
            self.pointer = pointer
            at = self.cursor if self.cursor is not None else None if pointer is None else self.camera.to_world(pointer)
            self.pointer_tool.hover(at, pygame.key.get_mods())
        with profile.part("lint"):
            self.watch.update(frame_time)
        self.bar.show(self)
        self.palette.show(self.tool)
        self.options.refresh()
        self._refresh_side()

    def _refresh_side(self) -> None:
        """Refresh the panel; where much is selected, which takes it long, a frame after the canvas has answered."""
        is_large = len(self.document.selection) > LARGE_SELECTION
        is_new = is_large and self.document is not self._seen and not self._is_side_late
        self._seen, self._is_side_late = self.document, is_new
        if self.side is not None and not is_new:
            self.side.refresh()

    def draw(self, surface: pygame.Surface, profile: Profile) -> None:
        """Draw canvas and rulers."""
        surface.fill(SURFACE)
        surface.set_clip(self.camera.viewport)
        with profile.part("canvas"):
            self.view.draw(surface)
        surface.set_clip(None)
        self.rulers.draw(surface, self.camera, self.pointer)

    def draw_snap(self, surface: pygame.Surface, snapped: Snap) -> None:
        """Mark the thing that the pointer snaps to, with a word."""
        draw_snap(surface, self.ui, self.camera.to_pixels(snapped.point), snapped)

    def status(self, figures: Figures) -> list[tuple[str, Colour]]:
        """A line about what to do next, where the pointer is, and how large the level is."""
        scene, selection = self.scene, self.document.selection
        parts: list[tuple[str, Colour]] = [(TOOLS[self.tool].title, ACCENT), (self.pointer_tool.hint, TEXT)]
        for severity, colour in (("error", DANGER), ("warning", WARNING)):
            count = sum(finding.severity == severity for finding in self.watch.findings)
            if count:
                parts.append((f"{count} {severity}{'s' * (count != 1)}", colour))
        if self.watch.proving.text[0]:
            parts.append(self.watch.proving.text)
        if selection:
            parts.append((f"{len(selection):,} selected", MUTED))
        if self.visibility.hidden:
            parts.append((f"{len(self.visibility.hidden):,} hidden", MUTED))
        if self.pointer is not None:
            x, y = self.camera.to_world(self.pointer)
            parts.append((f"{x:.3f}, {y:.3f} m", MUTED))
        return [*parts, *counted_parts(len(scene.position), len(scene.particle_a))]

    def title(self) -> str:
        """Title of the window: the level, * where it is not saved, and its file where that is called otherwise."""
        name = self.document.level.name
        return name + ("" if self.history.is_saved else "*") + " - Level editor" + self.level_file.named_beside(name)

    def states(self) -> list[str]:
        """State words for the window's title: the tool, and how many things are selected."""
        words = ["editing", self.tool]
        if self.document.selection:
            words.append(f"{len(self.document.selection)} selected")
        return words

    def leave(self) -> None:
        """Give up what is under way, and let go of pictures as large as some windows; the document stays as it is."""
        self.settle()
        self._close_side()
        self.watch.let_go()
        self.view = View(self)

    def settle(self) -> None:
        """Finish the drawing, and drop a drag."""
        if isinstance(self.pointer_tool, DrawTool):
            self.pointer_tool.put_away()
        self._give_up()
        self.history.end_merge()

    def _give_up(self) -> None:
        """Drop the drawing or the drag."""
        if self.pointer_tool.transform is not None or isinstance(self.pointer_tool, DrawTool):
            self.pointer_tool.cancel()


def _is_about(box: Box, view: Box) -> bool:
    """Whether a box is so near a view [m] that both are seen well together."""
    wide, high = view[2] - view[0], view[3] - view[1]
    return (
        max(box[2], view[2]) - min(box[0], view[0]) <= FARTHEST * wide
        and max(box[3], view[3]) - min(box[1], view[1]) <= FARTHEST * high
    )
