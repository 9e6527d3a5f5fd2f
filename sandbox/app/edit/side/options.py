"""The row below the bar: what the tool can be told, or place and size of the selection as numbers."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Box, Point
from sandbox.app.edit.canvas.pointer import DrawTool, SelectTool
from sandbox.app.widgets.property_widgets import OwnValues, PropertyWidgets, title_of
from sandbox.app.widgets.styles import LABELS
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.moving import move, rotate, scale
from sandbox.editor.panel.field_info import FieldInfo
from sandbox.editor.panel.property import Property, Section
from sandbox.editor.panel.typed import number_text
from sandbox.editor.tools.drawing_options import described, stepped
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import PLACE_DECIMALS, SHOWN_DECIMALS
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.quantities import significant

# Sizes in layout units.
OPTIONS_HEIGHT = 38.0
ENTRY_WIDTH, NUMBER_WIDTH, MENU_WIDTH = 62.0, 76.0, 108.0
HEIGHT = 26.0
GAP = 12.0
LABEL_GAP = 6.0
MORE_WIDTH = 64.0
# What a flag's button has beside its words.
FLAG_ROOM = 22.0
# Digits of a place or size of the selection.
DIGITS = 8
NOTHING = "Nothing is selected. Draw with a tool at the left, or click something."
CORNER = FieldInfo("number", "corner", tooltip="Of the corner [m]")
# Of the selection, by what a change of it is called.
NUMBERS = {
    "Move": FieldInfo("number", "x", tooltip="Centre of the selection [m]"),
    "Scale": FieldInfo("number", "width", tooltip="Size of the selection [m]"),
    "Turn": FieldInfo(
        "number", "turn by", tooltip="Angle to turn the selection by [degrees], counter-clockwise"
    ),
}  # fmt: skip


class OptionsRow(PropertyWidgets):
    """Fields of the tool in use, in a rectangle of pixels; made again when the tool or the selection change kind.

    Where they do not fit side by side, a button turns to those that come next.
    """

    def __init__(self, screen: Editing, place: pygame.Rect) -> None:
        self._screen, self._own = screen, OwnValues(screen)
        self.back = screen.ui.panel(place)
        super().__init__(screen, self.back, HEIGHT)
        self._x, self._y = GAP, (OPTIONS_HEIGHT - HEIGHT) / 2
        self._page = 0
        self.more: Any = None
        self._shown: tuple[object, ...] = ()

    def refresh(self) -> None:
        """Show the options, or the selection's numbers, as they are now."""
        tool, screen = self._screen.pointer_tool, self._screen
        if isinstance(tool, DrawTool):
            fresh: tuple[object, ...] = (screen.tool, tool.drawing.options, screen.document.level.materials)
        else:
            fresh = (self._corner, screen.selection_box, bool(screen.document.selection))
        if fresh != self._shown:
            self._shown = fresh
            if isinstance(tool, DrawTool):
                self._owner = self._own
                section = Section(TOOLS[screen.tool].title.capitalize(), tuple(self._options(tool)))
            else:
                self._owner = screen
                section = Section("", tuple(self._numbers()))
            if [each.field for each in section.properties] != list(self.properties):
                self._page = 0
            self.show([section])
        super().refresh()

    def _options(self, tool: DrawTool) -> list[Property]:
        """The options of a tool."""
        found = []
        for name, info in described(tool.drawing.options).items():
            if info.kind == "material":
                # It draws with a material that the level has.
                materials = self._screen.scene.materials
                if getattr(tool.drawing.options, name) not in materials:
                    tool.drawing.set_option(name, materials[-1] if len(materials) > 1 else DEFAULT_MATERIAL)
            value = getattr(tool.drawing.options, name)
            found.append(Property(name, info, value, partial(_set_option, tool, name), scrubs=False))
        return found

    def _numbers(self) -> list[Property]:
        """Place and size of the selection, or the place of a corner of it."""
        corner, box = self._corner, self._screen.selection_box
        if corner is not None:
            return [
                Property(name, replace(CORNER, title=f"corner {name}"), significant(value, DIGITS),
                         partial(self._put_corner, axis), scrubs=False, label="Move a corner")
                for axis, (name, value) in enumerate(zip("xy", corner, strict=True))
            ]  # fmt: skip
        if box is None or not self._screen.document.selection:
            return []
        left, bottom, right, top = box
        shown = (left + right) / 2, (bottom + top) / 2, right - left, top - bottom
        decimals = (SHOWN_DECIMALS, SHOWN_DECIMALS, PLACE_DECIMALS, PLACE_DECIMALS)
        found = []
        for name, value, digits in zip(("x", "y", "width", "height"), shown, decimals, strict=True):
            write, label = (_move, "Move") if name in ("x", "y") else (self._scale, "Scale")
            about, value = replace(NUMBERS[label], title=name), significant(round(value, digits) + 0.0, DIGITS)
            found.append(Property(name, about, value, partial(write, name, box), scrubs=False, label=label))
        return [*found, Property("turn", NUMBERS["Turn"], None, partial(_turn, box), scrubs=False, label="Turn")]

    @property
    def _corner(self) -> Point | None:
        """Where the corner of terrain is that was clicked; None where none is."""
        tool = self._screen.pointer_tool
        return tool.corner_place if isinstance(tool, SelectTool) else None

    def focus(self) -> None:
        """Give the keyboard to the first field."""
        if self.fields:
            self._ui.focus_on(next(iter(self.fields.values()))[0])

    # Making widgets, from the left.

    def _lay_out(self, sections: Sequence[Section]) -> None:
        (section,), self.more, self._x = sections, None, GAP
        if section.title:
            self._add_words(section.title, "heading")
        elif not section.properties:
            self._add_words(NOTHING, "muted")
        widths = [self._width_of(each) for each in section.properties]
        pages = self._pages(widths)
        self._page %= len(pages)
        for index in pages[self._page]:
            self._add(section.properties[index])
        if len(pages) > 1:
            self._add_more(len(pages))

    def _text_width(self, text: str) -> float:
        return self._ui.font(LABELS["muted"].size).size(text)[0] / self._ui.scale

    def _width_of(self, each: Property) -> float:
        """Width of a property, with its title and the gaps after them."""
        if each.about.kind == "yes_no":
            return self._text_width(each.about.title) + FLAG_ROOM + LABEL_GAP
        return self._text_width(title_of(each)) + 4 + LABEL_GAP + self._entry_width(each) + self._gap_after(each)

    def _entry_width(self, each: Property) -> float:
        if each.about.kind == "material":
            return MENU_WIDTH
        return NUMBER_WIDTH if self._owner is self._screen else ENTRY_WIDTH

    def _gap_after(self, each: Property) -> float:
        return 2 * GAP if each.field in ("y", "height") else GAP

    def _add(self, each: Property) -> None:
        if each.about.kind == "yes_no":
            width = self._text_width(each.about.title) + FLAG_ROOM
            toggle, tip = partial(self._toggle, each.field), each.about.tooltip
            place = self._rect(self._x, width)
            button = self._ui.button(place, each.about.title, toggle, self._holder, style="segment", tip=tip)
            self.buttons[each.field] = self._keep(button, each.field)
            self._x += width + LABEL_GAP
            return
        label, entry = self._text_width(title_of(each)) + 4, self._entry_width(each)
        self._add_label(each, self._rect(self._x, label))
        self._make(each, self._x + label + LABEL_GAP, entry)
        if self._owner is self._own and each.field in self.fields:
            field = self.fields[each.field][0]
            field.step_value, field.hint = partial(self._step, each.field), each.about.empty
        self._x += label + LABEL_GAP + entry + self._gap_after(each)

    def _add_words(self, text: str, style: str) -> None:
        width = self._text_width(text) + 4
        self._ui.label(self._rect(self._x, width), text, self._holder, style)
        self._x += width + LABEL_GAP

    def _pages(self, widths: list[float]) -> list[list[int]]:
        """Which items stand side by side: all where they fit, else as many as fit beside the button for more."""
        available = self.back.rect.width / self._ui.scale - self._x + LABEL_GAP
        if sum(widths) <= available:
            return [list(range(len(widths)))]
        pages: list[list[int]] = [[]]
        for index, width in enumerate(widths):
            taken = sum(widths[other] for other in pages[-1])
            if pages[-1] and taken + width > available - MORE_WIDTH - GAP:
                pages.append([])
            pages[-1].append(index)
        return pages

    def _add_more(self, count: int) -> None:
        left = self.back.rect.width / self._ui.scale - MORE_WIDTH - GAP
        place = self._ui.rect(left, (OPTIONS_HEIGHT - HEIGHT) / 2, MORE_WIDTH, HEIGHT)
        tip = f"Shows more fields: part {self._page + 1} of {count} is shown"
        self.more = self._ui.button(place, "More", self._turn_page, self.back, style="segment", tip=tip)

    def _turn_page(self) -> None:
        has_keyboard = self._ui.focus is self.more
        self._page += 1
        self._remake(self._sections)
        for each in self.properties.values():
            self._show_value(each)
        if has_keyboard:
            self._ui.focus_on(self.more)

    # Showing and changing values.

    def _show_value(self, each: Property) -> None:
        super()._show_value(each)
        if each.about.kind == "yes_no" and each.field in self.buttons:
            self.buttons[each.field].is_selected = each.value

    def _toggle(self, name: str) -> None:
        self._set(name, not self.properties[name].value)

    def _step(self, name: str, by: int) -> None:
        """Step an option's value up or down; a number of parts that is open begins at the one that fits."""
        tool = self._screen.pointer_tool
        assert isinstance(tool, DrawTool)
        if name == tool.drawing.counted:
            tool.adjust(by)
        else:
            options = tool.drawing.options
            self._set(name, stepped(described(options)[name], getattr(options, name), by))
        value, field = getattr(tool.drawing.options, name), self.fields[name][0]
        field.text = field.typed = "" if value is None else number_text(value)

    def _put_corner(self, axis: int, document: Document, value: float) -> Document:
        """The document with the clicked corner where it is to be."""
        tool, corner = self._screen.pointer_tool, self._corner
        assert isinstance(tool, SelectTool) and corner is not None
        return tool.with_corner(document, (value, corner[1]) if axis == 0 else (corner[0], value))

    def _scale(self, name: str, box: Box, document: Document, value: float) -> Document:
        left, bottom, right, top = box
        extent = right - left if name == "width" else top - bottom
        if extent <= 0.0 or value <= 0.0:
            raise EditError(f"the {name} is {extent:g} m and cannot be made {value:g} m")
        factor, alone = value / extent, self._screen.scales_unevenly
        across, up = (1.0 if alone and name != each else factor for each in ("width", "height"))
        return scale(document, across, up, ((left + right) / 2, (bottom + top) / 2))


def _set_option(tool: DrawTool, name: str, document: Document, value: Any) -> None:
    tool.drawing.set_option(name, value)


def _move(name: str, box: Box, document: Document, value: float) -> Document:
    left, bottom, right, top = box
    by = value - ((left + right) / 2 if name == "x" else (bottom + top) / 2)
    return move(document, by, 0.0) if name == "x" else move(document, 0.0, by)


def _turn(box: Box, document: Document, value: float) -> Document:
    left, bottom, right, top = box
    return rotate(document, math.radians(value), ((left + right) / 2, (bottom + top) / 2))
