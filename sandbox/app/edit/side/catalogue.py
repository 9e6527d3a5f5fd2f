"""CataloguePage: ready parts and a person's own, with pictures, to be put on the sheet by a click or a drag."""

from pathlib import Path
from typing import Any

import pygame

from sandbox.app.base.loop import SliceQueue
from sandbox.app.base.sentences import sentence
from sandbox.app.base.shortcuts import hint, tip_of
from sandbox.app.contracts.application import Editing
from sandbox.app.contracts.screen import Pixel
from sandbox.app.draw.colours import DANGER, MUTED, TEXT
from sandbox.app.edit.canvas.pointer import DrawTool
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.parts.part_page import PartCard, card_places, fill_card
from sandbox.app.widgets.dialogs import ask, choose
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.texts import TextBlock
from sandbox.editor.scene import make_scene
from sandbox.editor.storage.level_file import PartFile, StorageError, catalogue, delete_part, rename_part
from sandbox.editor.tools.drawing_part import PartDrawing

# Sizes in layout units.
BUTTON_HEIGHT = 28.0
SMALL_WIDTH = 62.0
GAP = 6.0
HEADING = 24.0
TEXT_HEIGHT = 64.0
# A lower page has its buttons below the parts, smaller cards, and what it says of a part in the tips of these.
ROOM_FOR_TEXT = 330.0
COLUMNS, COLUMNS_OF_LOW = 2, 3
# Wall time [s] of a frame that cards are filled in; and how many frames go by between two looks at the folders.
FILL_BUDGET = 0.008
LOOK_EVERY = 30
NOTHING_OWN = "Select something, and keep it as a part."


class CataloguePage(SidePage):
    """The cards of all parts; the one that is in hand is the part tool's."""

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, self._ui = screen, screen.ui
        ui, width = screen.ui, place.width - screen.ui.px(6)
        self._is_low = place.height < ui.px(ROOM_FOR_TEXT)
        self._columns = COLUMNS_OF_LOW if self._is_low else COLUMNS
        above = 0 if self._is_low else ui.px(BUTTON_HEIGHT + 2 * GAP)
        text_height = 0 if self._is_low else ui.px(TEXT_HEIGHT)
        height = place.height - above - (0 if self._is_low else text_height + ui.px(GAP))
        self.area = ScrollArea(ui, pygame.Rect(place.left, place.top + above, place.width, height), container)
        if self._is_low:
            self._add_buttons(ui.px(3), 0, width - ui.px(6), self.area.content)
        else:
            self._add_buttons(place.left, place.top, width, container)
        below = pygame.Rect(place.left, place.bottom - text_height, width, text_height)
        self._text = TextBlock(ui, below, "", container, 12.0)
        self.cards: list[PartCard] = []
        self._labels: list[TextBlock] = []
        self._files: list[PartFile] = []
        self._chosen: PartFile | None = None
        self._unfilled = SliceQueue()
        self._looked = 0

    def _add_buttons(self, left: int, top: int, width: int, container: Any) -> None:
        """Make the buttons for parts of one's own, side by side from a place [pixels] on."""
        ui = self._ui
        small, gap, height = ui.px(SMALL_WIDTH), ui.px(GAP), ui.px(BUTTON_HEIGHT)
        x = left + width - 2 * small - gap
        wide = pygame.Rect(left, top, x - gap - left, height)
        tip = tip_of("keep_part", "edit")
        self.keep = ui.button(wide, "Keep as a part …", self._keep, container, style="segment", tip=tip)
        self.rename = ui.button(
            pygame.Rect(x, top, small, height), "Rename", self._ask_name, container, style="segment",
            tip="Rename one of your parts",
        )  # fmt: skip
        self.delete = ui.button(
            pygame.Rect(x + small + gap, top, small, height), "Delete", self._ask_delete, container,
            style="segment", tip="Delete one of your parts; levels that use it keep their copy",
        )  # fmt: skip

    # What there is.

    @property
    def moves(self) -> bool:
        """Whether cards are still filled in."""
        return len(self._unfilled) > 0

    def refresh(self) -> None:
        """Show the parts found by now, and which one is in hand."""
        if self._looked <= 0:
            self._looked = LOOK_EVERY
            self._look()
        self._looked -= 1
        self._unfilled.go_on(FILL_BUDGET)
        drawing = self._drawing()
        for card in self.cards:
            card.mark(card.part == self._chosen and (drawing is not None or card.part.is_own))
        self._describe()
        is_own = self._chosen is not None and self._chosen.is_own
        self.keep.is_enabled = bool(self._screen.document.selection)
        self.rename.is_enabled = is_own and self._chosen is not None and self._chosen.level is not None
        self.delete.is_enabled = is_own

    def _drawing(self) -> PartDrawing | None:
        """The drawing that has a part in hand, where it is the tool in use."""
        tool = self._screen.pointer_tool
        return tool.drawing if isinstance(tool, DrawTool) and isinstance(tool.drawing, PartDrawing) else None

    def _look(self) -> None:
        files = catalogue()
        if files == self._files:
            return
        for widget in (*self.cards, *self._labels):
            widget.remove()
        self.cards, self._labels, self._unfilled, self._files = [], [], SliceQueue(), files
        if self._chosen not in files:
            # The file in hand may have another name or another content.
            same = (part for part in files if self._chosen is not None and part.path == self._chosen.path)
            self._chosen = next(same, None)
        drawing = self._drawing()
        if self._chosen is None and drawing is not None and drawing.options.part is not None:
            # The window is laid out again, and the tool still has it.
            self._chosen = next((part for part in files if part.level is drawing.options.part), None)
        own = [part for part in files if part.is_own]
        y = self._add_section("Ready", [part for part in files if not part.is_own], 0.0)
        y = self._add_section("Your own", own, y + GAP)
        if not own:
            self._add_label(NOTHING_OWN, y, 12.0, 34.0, is_bold=False)
            y += 34.0
        if self._is_low:
            for button in (self.keep, self.rename, self.delete):
                button.move_to((button.place.left, self._ui.px(y)))
            y += BUTTON_HEIGHT + GAP
        self.area.set_height(self._ui.px(y))

    def _add_label(self, text: str, y: float, size: float, height: float, *, is_bold: bool) -> None:
        ui = self._ui
        place = ui.rect(3, y, self.area.view.rect.width / ui.scale - 6, height)
        colour = TEXT if is_bold else MUTED
        self._labels.append(TextBlock(ui, place, text, self.area.content, size, colour, is_bold=is_bold))

    def _add_section(self, title: str, parts: list[PartFile], y: float) -> float:
        """Make cards from a place [layout units] on, under a heading but at the top of a low page; gives their end."""
        ui = self._ui
        if y > 0.0 or not self._is_low:
            self._add_label(title, y, 13.0, HEADING, is_bold=True)
            y += HEADING
        width = self.area.view.rect.width / ui.scale
        places, end = card_places(ui, len(parts), self._columns, width, y, GAP)
        for place, part in zip(places, parts, strict=True):
            card = PartCard(ui, place, part, self, self.area.content, self._columns)
            if self._is_low and part.level is not None:
                card.tip = f"{part.name}. {hint(part.level.description)}".strip()
            self.cards.append(card)
            self._unfilled.add(fill_card(card))
        return end

    def _describe(self) -> None:
        part = self._chosen
        text, colour = "Click a part, then the sheet, or drag it there. Escape cancels.", MUTED
        if part is not None and part.fault:
            text, colour = part.fault, DANGER
        elif part is not None and part.level is not None:
            text = f"{part.name}. {hint(part.level.description)}".strip()
        if (text, colour) != (self._text.text, self._text.colour):
            self._text.colour = colour
            self._text.show_text(text)

    # What the cards ask.

    def take(self, part: PartFile, by_key: bool) -> None:
        """Have a part in hand; by_key: it is shown in the middle of the sheet, where the arrows move it."""
        screen, level = self._screen, part.level
        self._chosen = part
        if level is None:
            screen.say(part.fault)
            return
        screen.choose_tool("part")
        drawing = self._drawing()
        assert drawing is not None
        drawing.take(level)
        screen.cursor = None
        box = make_scene(level).bounds() or (0.0, 0.0, 0.0, 0.0)
        screen.camera.make_room(box)
        if by_key:
            # All of it is seen, wherever in it its origin is.
            (x, y), (left, bottom, right, top) = screen.camera.centre, box
            screen.cursor = screen.snapped((x - (left + right) / 2, y - (bottom + top) / 2), 0).point
            self._ui.blur()

    def carry(self, pixel: Pixel) -> None:
        """Show the part on the canvas where a drag has it."""
        screen = self._screen
        over = self._drawing() is not None and screen.contains(pixel)
        screen.pointer = pixel if over else None
        screen.pointer_tool.hover(screen.camera.to_world(pixel) if over else None, pygame.key.get_mods())

    def drop(self, pixel: Pixel) -> None:
        """Put the part on the sheet, where the drag ends over it; then it is selected, and nothing is in hand."""
        screen = self._screen
        if self._drawing() is None or not screen.contains(pixel):
            return
        modifiers = pygame.key.get_mods()
        screen.point("down", pixel, modifiers)
        screen.point("up", pixel, modifiers)
        screen.choose_tool("select")

    def focus(self, path: Path | None = None) -> None:
        """Give the keyboard to the part of a file, None = that in hand, or the first."""
        self._looked = 0
        self.refresh()
        if path is not None:
            self._look_for(path)
        focused = next((card for card in self.cards if card.part == self._chosen), None) or next(iter(self.cards), None)
        if focused is not None:
            self._ui.focus_on(focused)

    # Own parts.

    def _keep(self) -> None:
        self._screen.actions["keep_part"]()

    def _ask_name(self) -> None:
        part = self._chosen
        if part is None:
            return

        def answer(typed: str) -> str | None:
            try:
                path = rename_part(part, typed)
            except (StorageError, ValueError) as error:
                return sentence(error)
            self._look_for(path)
            return None

        ask(self._ui, "Rename the part", "Its file gets the same name.", part.name, "Rename", answer)

    def _ask_delete(self) -> None:
        part = self._chosen
        if part is None:
            return

        def do() -> None:
            try:
                delete_part(part)
            except StorageError as error:
                self._screen.say(sentence(error))
                return
            self._chosen = None
            self._looked = 0
            self._screen.say(f"The part {part.name} is deleted.")

        choose(self._ui, f"Delete the part “{part.name}”?", "Levels that use it keep their copy.", [("Delete it", do)])

    def _look_for(self, path: Path) -> None:
        """Read the folder again and show its files, that of a path as chosen."""
        self._looked = 0
        self._chosen = next((part for part in catalogue() if part.path == path), None)
