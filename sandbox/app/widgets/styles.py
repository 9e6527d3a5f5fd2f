"""Styles: colours, letters and corners of buttons, labels, panels and lines of text, by the names of their looks."""

from typing import Literal, NamedTuple

from sandbox.app.draw.colours import ACCENT, BACKGROUND, CHOSEN, FIELD, MENU, MUTED, SURFACE, TEXT, Colour, tone

State = Literal["normal", "hovered", "active", "selected", "disabled"]
CLEAR = tone("00000000", "00000000")
WHITE = tone("ffffff", "ffffff")
# Letters and rims of what is lit, and rims of lines to type into.
BRIGHT, CHOSEN_TEXT = tone("ffffff", "101620"), tone("8ff0d8", "075c4d")
RIM, HOVERED_RIM = tone("2f3745", "ddd5c6"), tone("435064", "b9ae97")
FIELD_RIM = tone("2f3745", "cfc6b4")
SELECTION = tone("2b6257", "bfe5da")
TIP_BACK = tone("2d3543", "fffdf8")
_PLAIN = tone("232934", "f1ebdd")
_HEADING = tone("ffffff", "1c2430")


class BoxLook(NamedTuple):
    """Colours of a box, and of what is written on it."""

    back: Colour
    rim: Colour
    text: Colour


class ButtonStyle(NamedTuple):
    """How a button looks in each state; size of its letters and radius of its corners [layout units]."""

    looks: dict[State, BoxLook]
    size: float = 13.0
    radius: float = 6.0


class LabelStyle(NamedTuple):
    """How a line of text looks; size [layout units]; side: 0 left, 0.5 middle, 1 right."""

    text: Colour
    size: float = 13.0
    is_bold: bool = False
    side: float = 0.0


class PanelStyle(NamedTuple):
    """Colours of a panel, and the radius of its corners [layout units]."""

    back: Colour
    rim: Colour | None = None
    radius: float = 0.0


_BUTTON: dict[State, BoxLook] = {
    "normal": BoxLook(_PLAIN, RIM, TEXT),
    "hovered": BoxLook(tone("2d3543", "e7dfcd"), HOVERED_RIM, BRIGHT),
    "active": BoxLook(tone("35404f", "ddd3bd"), ACCENT, BRIGHT),
    "selected": BoxLook(CHOSEN, ACCENT, CHOSEN_TEXT),
    "disabled": BoxLook(tone("1b2028", "f6f2e8"), tone("232934", "ebe5d8"), tone("5a6474", "a5a79f")),
}
_QUIET: dict[State, BoxLook] = {
    "normal": BoxLook(SURFACE, SURFACE, TEXT),
    "disabled": BoxLook(SURFACE, SURFACE, _BUTTON["disabled"].text),
}
_PRIMARY: dict[State, BoxLook] = {
    "normal": BoxLook(tone("2f8f7b", "0e7c69"), tone("38a78f", "0a6a59"), WHITE),
    "hovered": BoxLook(tone("38a78f", "0a6a59"), tone("5ed0b2", "075c4d"), WHITE),
    "active": BoxLook(tone("27786a", "075c4d"), ACCENT, WHITE),
}
_CHIP: dict[State, BoxLook] = {
    "normal": BoxLook(CLEAR, CLEAR, TEXT),
    "hovered": BoxLook(tone("2d354380", "e7dfcd80"), HOVERED_RIM, BRIGHT),
}
BUTTONS = {
    "": ButtonStyle(_BUTTON),
    "segment": ButtonStyle(_BUTTON, 12.0),
    "quiet": ButtonStyle(_BUTTON | _QUIET),
    "tool": ButtonStyle(_BUTTON | _QUIET, 12.0),
    "primary": ButtonStyle(_BUTTON | _PRIMARY),
    "chip": ButtonStyle(_BUTTON | _CHIP, 12.0, 13.0),
}
LABELS = {
    "": LabelStyle(tone("c3cbd8", "3b4554")),
    "heading": LabelStyle(MUTED, 11.0, True),
    "title": LabelStyle(_HEADING, 15.0, True),
    "display": LabelStyle(_HEADING, 24.0, True),
    "muted": LabelStyle(MUTED, 12.0),
    "middle": LabelStyle(TEXT, side=0.5),
    "right": LabelStyle(MUTED, 12.0, side=1.0),
    "key": LabelStyle(tone("8ff0d8", "0e7c69"), 12.0, True, 1.0),
}
PANELS: dict[str, PanelStyle] = {
    "": PanelStyle(SURFACE),
    "shade": PanelStyle(tone("0b0d11d8", "3b3a34a8")),
    "cover": PanelStyle(BACKGROUND),
    "clear": PanelStyle(CLEAR),
    "card": PanelStyle(SURFACE, RIM, 8.0),
    "dialog": PanelStyle(MENU, tone("343d4c", "ddd5c6"), 12.0),
}
FIELD_LOOK, FOCUSED_FIELD = BoxLook(FIELD, FIELD_RIM, TEXT), BoxLook(FIELD, ACCENT, TEXT)
HOVERED_FIELD = BoxLook(FIELD, HOVERED_RIM, TEXT)
TIP = BoxLook(TIP_BACK, HOVERED_RIM, TEXT)
