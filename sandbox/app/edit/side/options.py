"""The row below the bar: what the tool can be told, or place and size of the selection as numbers."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import pygame

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.draw.camera import Point
from sandbox.app.draw.material_colours import material_colours
from sandbox.app.edit.canvas.pointer import DrawTool, SelectTool
from sandbox.app.widgets.field import Field
from sandbox.app.widgets.picker import Picker
from sandbox.app.widgets.rows import Row
from sandbox.editor.document import EditError
from sandbox.editor.edits.moving import move, rotate, scale
from sandbox.editor.panel.typed import read_number
from sandbox.editor.tools.drawing_options import OptionInfo, described, stepped
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import PLACE_DECIMALS, SHOWN_DECIMALS
from sandbox.level.format.limits import DEFAULT_MATERIAL

# Sizes in layout units.
OPTIONS_HEIGHT = 38.0
ENTRY_WIDTH = 62.0
MENU_WIDTH = 108.0
HEIGHT = 26.0
GAP = 12.0
LABEL_GAP = 6.0
NUMBER_WIDTH = 76.0
MORE_WIDTH = 64.0

# A label and what is beside it: the width that they take with the gaps after them, and what makes them.
Item = tuple[float, Callable[[], None]]


class OptionsRow:
    """Fields of the tool in use, in a rectangle of pixels; made again when the tool or the materials change.

    Where they do not fit side by side, a button turns to those that come next.
    """

    def __init__(self, screen: Editing, place: pygame.Rect) -> None:
        self._screen, self._ui = screen, screen.ui
        self.back = self._ui.panel(place)
        self._made_for: tuple[object, ...] = ()
        self._x = 0.0
        self._page = 0
        self.more: Any = None
        self.fields: dict[str, Field] = {}
        self.flags: dict[str, Any] = {}
        self.menus: dict[str, Picker] = {}

    def refresh(self) -> None:
        """Show the options, or the selection's numbers, as they are now."""
        screen = self._screen
        chosen = bool(screen.document.selection)
        materials = tuple(screen.scene.materials)
        tool = screen.pointer_tool
        made_for = (screen.tool, materials) if isinstance(tool, DrawTool) else ("select", chosen, self._corner is None)
        if made_for != self._made_for:
            self._made_for, self._page = made_for, 0
            self._remake()
        if isinstance(tool, DrawTool):
            self._show_options(tool)
        elif chosen:
            self._show_selection()

    @property
    def _corner(self) -> Point | None:
        """Where the corner of terrain is that was clicked; None where none is."""
        tool = self._screen.pointer_tool
        return tool.corner_place if isinstance(tool, SelectTool) else None

    def _remake(self) -> None:
        self.back.clear()
        self.fields, self.flags, self.menus, self.more, self._x = {}, {}, {}, None, GAP
        tool, chosen = self._screen.pointer_tool, bool(self._screen.document.selection)
        items: list[Item] = []
        if isinstance(tool, DrawTool):
            self._add_label(TOOLS[self._screen.tool].title.capitalize(), "heading")
            items = [self._option(tool, name, about) for name, about in described(tool.drawing.options).items()]
        elif chosen:
            items = self._numbers()
        else:
            self._add_label("Nothing is selected. Draw with a tool at the left, or click something.", "muted")
        pages = self._pages([width for width, _ in items])
        self._page %= len(pages)
        for index in pages[self._page]:
            items[index][1]()
        if len(pages) > 1:
            self._add_more(len(pages))

    def _pages(self, widths: list[float]) -> list[list[int]]:
        """Which items stand side by side: all where they fit, else as many as fit beside the button for more."""
        room = self.back.rect.width / self._ui.scale - self._x + LABEL_GAP
        if sum(widths) <= room:
            return [list(range(len(widths)))]
        pages: list[list[int]] = [[]]
        for index, width in enumerate(widths):
            taken = sum(widths[other] for other in pages[-1])
            if pages[-1] and taken + width > room - MORE_WIDTH - GAP:
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
        self._remake()
        if has_keyboard:
            self._ui.focus_on(self.more)

    def focus(self) -> None:
        """Give the keyboard to the first field."""
        if self.fields:
            self._ui.focus_on(next(iter(self.fields.values())))

    # Adding widgets from the left.

    def _rect(self, width: float) -> pygame.Rect:
        place = self._ui.rect(self._x, (OPTIONS_HEIGHT - HEIGHT) / 2, width, HEIGHT)
        self._x += width
        return place

    def _text_width(self, text: str) -> float:
        return self._ui.font(12).size(text)[0] / self._ui.scale

    def _add_label(self, text: str, style: str = "muted") -> None:
        self._ui.label(self._rect(self._text_width(text) + 4), text, self.back, style)
        self._x += LABEL_GAP

    def _labelled(self, label: str, width: float, add: Callable[[], None], gap: float = GAP) -> Item:
        def make() -> None:
            self._add_label(label)
            add()
            self._x += gap

        return self._text_width(label) + 4 + LABEL_GAP + width + gap, make

    def _add_field(self, name: str, commit: Callable[[str], bool], width: float, tip: str, empty: str = "") -> None:
        field = self._ui.field(self._rect(width), "", commit, self.back, 24, hint=empty)
        field.tip = tip
        self.fields[name] = field

    def _numbers(self) -> list[Item]:
        """Place and size of the selection, or the place of a corner of it."""
        items = []
        if self._corner is not None:
            for name in ("x", "y"):
                add = partial(
                    self._add_field, name, partial(self._type_corner, name), NUMBER_WIDTH, "Of the corner [m]"
                )
                items.append(self._labelled(f"corner {name}", NUMBER_WIDTH, add))
            return items
        for name, label, tip in (
            ("x", "x", "Centre of the selection [m]"),
            ("y", "y", "Centre of the selection [m]"),
            ("width", "width", "Width of the selection [m]"),
            ("height", "height", "Height of the selection [m]"),
            ("turn", "turn by", "Angle to turn the selection by [degrees], counter-clockwise"),
        ):
            add = partial(self._add_field, name, partial(self._type_number, name), NUMBER_WIDTH, tip)
            items.append(self._labelled(label, NUMBER_WIDTH, add, 2 * GAP if name in ("y", "height") else GAP))
        return items

    def _option(self, tool: DrawTool, name: str, about: OptionInfo) -> Item:
        if about.kind == "flag":
            width = self._text_width(about.label) + 22
            return width + LABEL_GAP, partial(self._add_flag, tool, name, about, width)
        label = about.label + (f" [{about.unit}]" if about.unit else "")
        if about.kind == "material":
            self._settle_material(tool, name)
            return self._labelled(label, MENU_WIDTH, partial(self._add_picker, tool, name, about))
        return self._labelled(label, ENTRY_WIDTH, partial(self._add_value, tool, name, about))

    def _add_flag(self, tool: DrawTool, name: str, about: OptionInfo, width: float) -> None:
        toggle = partial(self._toggle, tool, name)
        button = self._ui.button(self._rect(width), about.label, toggle, self.back, style="segment", tip=about.text)
        self.flags[name] = button
        self._x += LABEL_GAP

    def _add_value(self, tool: DrawTool, name: str, about: OptionInfo) -> None:
        tip = f"{about.text} The wheel or Up and Down change it."
        self._add_field(
            name, partial(self._type_option, tool, name, about), ENTRY_WIDTH, tip, about.empty if about.optional else ""
        )
        self.fields[name].step_value = partial(self._step_option, tool, name, about)

    def _settle_material(self, tool: DrawTool, name: str) -> None:
        """Draw with a material that the level has."""
        materials = self._screen.scene.materials
        if getattr(tool.drawing.options, name) not in materials:
            self._set(tool, name, materials[-1] if len(materials) > 1 else DEFAULT_MATERIAL)

    def _add_picker(self, tool: DrawTool, name: str, about: OptionInfo) -> None:
        picker = Picker(self._ui, self._rect(MENU_WIDTH), partial(self._choose, tool, name), self.back)
        picker.tip = about.text
        self.menus[name] = picker

    # Showing.

    def _show_options(self, tool: DrawTool) -> None:
        options = tool.drawing.options
        for name, field in self.fields.items():
            value = getattr(options, name)
            field.show("" if value is None else f"{value:g}")
        for name, button in self.flags.items():
            button.is_selected = getattr(options, name)
        for name, picker in self.menus.items():
            colours = material_colours(self._screen.scene.level.materials)
            rows = tuple(Row(material, swatch=colour) for material, colour in colours.items())
            picker.show_value(rows, Row(getattr(options, name), swatch=colours[getattr(options, name)]))

    def _show_selection(self) -> None:
        box, corner = self._screen.selection_box, self._corner
        if corner is not None:
            for name, value in zip(("x", "y"), corner, strict=True):
                self.fields[name].show(f"{value:.8g}")
            return
        if box is None:
            return
        left, bottom, right, top = box
        values = {"x": (left + right) / 2, "y": (bottom + top) / 2, "width": right - left, "height": top - bottom}
        for name, value in values.items():
            if name in self.fields:
                decimals = SHOWN_DECIMALS if name in ("x", "y") else PLACE_DECIMALS
                self.fields[name].show(f"{round(value, decimals) + 0.0:.8g}")

    # Changing.

    def _set(self, tool: DrawTool, name: str, value: Any) -> bool:
        try:
            tool.drawing.set_option(name, value)
        except EditError as error:
            self._screen.say(sentence(error))
            return False
        return True

    def _choose(self, tool: DrawTool, name: str, index: int) -> None:
        self._set(tool, name, self.menus[name].rows[index].text)

    def _toggle(self, tool: DrawTool, name: str) -> None:
        self._set(tool, name, not getattr(tool.drawing.options, name))

    def _type_option(self, tool: DrawTool, name: str, about: OptionInfo, text: str) -> bool:
        if not text.strip():
            return self._set(tool, name, None)
        value = self._number(about.label, text)
        if value is None:
            return False
        if about.kind == "count" and value == int(value):
            return self._set(tool, name, int(value))
        return self._set(tool, name, value)

    def _step_option(self, tool: DrawTool, name: str, about: OptionInfo, by: int) -> None:
        """Step an option's value up or down; a number of parts that is open begins at the one that fits."""
        if name == tool.drawing.counted:
            tool.adjust(by)
        else:
            self._set(tool, name, stepped(about, getattr(tool.drawing.options, name), by))
        self._show_option(name, getattr(tool.drawing.options, name))

    def _show_option(self, name: str, value: float | None) -> None:
        text = "" if value is None else f"{value:g}"
        self.fields[name].text = text
        self.fields[name].typed = text

    def _number(self, label: str, text: str) -> float | None:
        try:
            return read_number(label, text)
        except EditError as error:
            self._screen.say(sentence(error))
            return None

    def _type_corner(self, name: str, text: str) -> bool:
        """Move the corner that was clicked to what was typed."""
        value, tool = self._number(f"corner {name}", text), self._screen.pointer_tool
        corner = self._corner
        if value is None or corner is None or not isinstance(tool, SelectTool):
            return False
        return tool.put_corner((value, corner[1]) if name == "x" else (corner[0], value), "Move a corner")

    def _type_number(self, name: str, text: str) -> bool:
        """Move, scale or turn the selection to what was typed."""
        screen, value = self._screen, self._number(name, text)
        box = screen.selection_box
        if value is None or box is None:
            return False
        left, bottom, right, top = box
        x, y, width, height = (left + right) / 2, (bottom + top) / 2, right - left, top - bottom
        if name == "turn":
            done = screen.edit("Turn", lambda document: rotate(document, math.radians(value), (x, y)))
            self.fields["turn"].text = ""
            self.fields["turn"].typed = ""
            return done
        if name in ("x", "y"):
            dx, dy = (value - x, 0.0) if name == "x" else (0.0, value - y)
            return screen.edit("Move", lambda document: move(document, dx, dy))
        extent = width if name == "width" else height
        if extent <= 0.0 or value <= 0.0:
            screen.say(f"The {name} is {extent:g} m and cannot be made {value:g} m.")
            return False
        factor = value / extent
        apart = screen.scales_unevenly
        sx, sy = (factor if name == "width" or not apart else 1.0), (factor if name == "height" or not apart else 1.0)
        return screen.edit("Scale", lambda document: scale(document, sx, sy, (x, y)))
