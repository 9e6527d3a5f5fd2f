"""The row below the bar: what the tool can be told, or place and size of the selection as numbers."""

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import pygame

from sandbox.app.colours import material_colours
from sandbox.app.edit.hands import DrawHand
from sandbox.app.edit.rows import Picker, Row
from sandbox.app.fields import Field
from sandbox.editor.document import EditError
from sandbox.editor.drawing_options import About, described, stepped
from sandbox.editor.moving import move, rotate, scale
from sandbox.editor.snap import PLACE_DECIMALS
from sandbox.level.limits import DEFAULT_MATERIAL

if TYPE_CHECKING:
    from sandbox.app.edit.screen import EditScreen

# Sizes in layout units.
OPTIONS_HEIGHT = 38.0
ENTRY_WIDTH = 62.0
MENU_WIDTH = 108.0
HEIGHT = 26.0
GAP = 12.0


class OptionsRow:
    """Fields of the tool in use, in a rectangle of pixels; made anew when the tool or the materials change."""

    def __init__(self, screen: "EditScreen", place: pygame.Rect) -> None:
        self._screen, self._ui = screen, screen.ui
        self.back = self._ui.panel(place)
        self._made_for: tuple[object, ...] = ()
        self._x = 0.0
        self._made: list[Any] = []
        self.fields: dict[str, Field] = {}
        self.flags: dict[str, Any] = {}
        self.menus: dict[str, Picker] = {}

    def refresh(self) -> None:
        """Show the options, or the selection's numbers, as they are now."""
        screen = self._screen
        chosen = bool(screen.document.selection)
        materials = tuple(screen.scene.materials)
        hand = screen.hand
        made_for = (screen.tool, materials) if isinstance(hand, DrawHand) else ("select", chosen)
        if made_for != self._made_for:
            self._made_for = made_for
            self._remake(hand, materials)
        if isinstance(hand, DrawHand):
            self._show_options(hand)
        elif chosen:
            self._show_selection()

    def _remake(self, hand: object, materials: tuple[str, ...]) -> None:
        for widget in self._made:
            self._ui.remove(widget)
        self._made, self.fields, self.flags, self.menus, self._x = [], {}, {}, {}, GAP
        if isinstance(hand, DrawHand):
            self._add_label(self._screen.tool.capitalize() if self._screen.tool != "box" else "Jelly", "@heading")
            for name, about in described(hand.drawing.options).items():
                self._add_option(hand, name, about, materials)
        elif self._screen.document.selection:
            for name, label, tip in (
                ("x", "x", "Middle of the selection [m]"),
                ("y", "y", "Middle of the selection [m]"),
                ("width", "width", "Width of the selection [m]"),
                ("height", "height", "Height of the selection [m]"),
                ("turn", "turn by", "Angle to turn the selection by [degrees], counter-clockwise"),
            ):
                self._add_label(label, "@muted")
                self._add_field(name, partial(self._type_number, name), 76.0, tip)
                if name in ("y", "height"):
                    self._x += GAP
        else:
            self._add_label("Nothing is selected. Draw with the tools at the left, or click a part.", "@muted")

    def focus(self) -> None:
        """Give the keyboard to the first field."""
        if self.fields:
            self._ui.focus_on(next(iter(self.fields.values())).entry)

    # Adding widgets from the left.

    def _room(self, width: float) -> bool:
        return self._ui.px(self._x + width) <= self.back.rect.width

    def _rect(self, width: float) -> pygame.Rect:
        place = self._ui.rect(self._x, (OPTIONS_HEIGHT - HEIGHT) / 2, width, HEIGHT)
        self._x += width
        return place

    def _add_label(self, text: str, style: str) -> None:
        width = self._ui.font(12).size(text)[0] / self._ui.scale + 4
        if self._room(width):
            self._made.append(self._ui.label(self._rect(width), text, self.back, style))
            self._x += 6

    def _add_field(self, name: str, commit: Any, width: float, tip: str) -> None:
        if not self._room(width):
            return
        field = self._ui.field(self._rect(width), "", commit, self.back, 24)
        field.entry.set_tooltip(tip)
        self.fields[name] = field
        self._made.append(field.entry)
        self._x += GAP

    def _add_option(self, hand: DrawHand, name: str, about: About, materials: tuple[str, ...]) -> None:
        unit = f" [{about.unit}]" if about.unit else ""
        if about.kind == "flag":
            width = self._ui.font(12).size(about.label)[0] / self._ui.scale + 22
            if self._room(width):
                toggle = partial(self._toggle, hand, name)
                button = self._ui.button(
                    self._rect(width), about.label, toggle, self.back, style="@segment", tip=about.text
                )
                self.flags[name] = button
                self._made.append(button)
                self._x += 6
            return
        self._add_label(about.label + unit, "@muted")
        if about.kind != "material":
            tip = f"{about.text} The wheel or Up and Down change it."
            self._add_field(name, partial(self._type_option, hand, name, about), ENTRY_WIDTH, tip)
            if name in self.fields:
                self.fields[name].turn = partial(self._turn_option, hand, name, about)
        elif self._room(MENU_WIDTH):
            chosen = getattr(hand.drawing.options, name)
            if chosen not in materials:
                chosen = materials[-1] if len(materials) > 1 else DEFAULT_MATERIAL
                self._set(hand, name, chosen)
            picker = Picker(self._ui, self._rect(MENU_WIDTH), partial(self._choose, hand, name), self.back)
            picker.set_tooltip(about.text)
            self.menus[name] = picker
            self._made.append(picker)
            self._x += GAP

    # Showing.

    def _show_options(self, hand: DrawHand) -> None:
        options = hand.drawing.options
        for name, field in self.fields.items():
            value = getattr(options, name)
            field.show("" if value is None else f"{value:g}")
        for name, button in self.flags.items():
            if getattr(options, name) != button.is_selected:
                (button.select if getattr(options, name) else button.unselect)()

        for name, picker in self.menus.items():
            colours = material_colours(self._screen.scene.materials)
            rows = tuple(Row(material, swatch=colour) for material, colour in colours.items())
            picker.show_value(rows, Row(getattr(options, name), swatch=colours[getattr(options, name)]))

    def _show_selection(self) -> None:
        box = self._screen.selection_box
        if box is None:
            return
        left, bottom, right, top = box
        values = {"x": (left + right) / 2, "y": (bottom + top) / 2, "width": right - left, "height": top - bottom}
        for name, value in values.items():
            if name in self.fields:
                self.fields[name].show(f"{round(value, PLACE_DECIMALS) + 0.0:.6g}")

    # Changing.

    def _set(self, hand: DrawHand, name: str, value: Any) -> bool:
        try:
            hand.drawing.set_option(name, value)
        except EditError as error:
            self._screen.say(f"{str(error)[:1].upper()}{str(error)[1:]}.")
            return False
        return True

    def _choose(self, hand: DrawHand, name: str, index: int) -> None:
        self._set(hand, name, self.menus[name].rows[index].text)

    def _toggle(self, hand: DrawHand, name: str) -> None:
        self._set(hand, name, not getattr(hand.drawing.options, name))

    def _type_option(self, hand: DrawHand, name: str, about: About, text: str) -> bool:
        if not text.strip():
            return self._set(hand, name, None)
        value = self._number(about.label, text)
        if value is None:
            return False
        if about.kind == "count" and value == int(value):
            return self._set(hand, name, int(value))
        return self._set(hand, name, value)

    def _turn_option(self, hand: DrawHand, name: str, about: About, by: int) -> None:
        """Step a value up or down; a number of parts from the one that fits."""
        if name == hand.drawing.counted:
            hand.adjust(by)
        else:
            self._set(hand, name, stepped(about, getattr(hand.drawing.options, name), by))
        self._show_option(name, getattr(hand.drawing.options, name))

    def _show_option(self, name: str, value: float | None) -> None:
        text = "" if value is None else f"{value:g}"
        self.fields[name].text = text
        self.fields[name].entry.set_text(text)

    def _number(self, label: str, text: str) -> float | None:
        try:
            value = float(text.strip().replace(",", "."))
        except ValueError:
            value = math.nan
        if math.isfinite(value):
            return value
        self._screen.say(f"{label}: {text.strip() or 'nothing'!r} is not a number.")
        return None

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
            self.fields["turn"].entry.set_text("")
            return done
        if name in ("x", "y"):
            dx, dy = (value - x, 0.0) if name == "x" else (0.0, value - y)
            return screen.edit("Move", lambda document: move(document, dx, dy))
        extent = width if name == "width" else height
        if extent <= 0.0 or value <= 0.0:
            screen.say(f"The {name} is {extent:g} m and cannot be made {value:g} m.")
            return False
        factor = value / extent
        apart = screen.scales_apart
        sx, sy = (factor if name == "width" or not apart else 1.0), (factor if name == "height" or not apart else 1.0)
        return screen.edit("Scale", lambda document: scale(document, sx, sy, (x, y)))
