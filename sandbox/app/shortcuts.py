"""Shortcuts: the one table of what can be done and with which keys; feeds the dispatcher and the help page."""

from dataclasses import dataclass
from functools import cache

import pygame


@dataclass(frozen=True)
class Shortcut:
    """An action, the keys that start it, and what it does; an action of "" is a gesture that the help page explains."""

    action: str
    keys: tuple[str, ...]
    label: str
    group: str


SHORTCUTS = (
    Shortcut("tool_drag", ("D", "1"), "Drag tool: hold and move particles", "Tools"),
    Shortcut("tool_pin", ("P", "2"), "Pin tool: pin or unpin a particle", "Tools"),
    Shortcut("tool_cut", ("C", "3"), "Cut tool: a stroke cuts what it crosses", "Tools"),
    Shortcut("", ("Shift+click",), "Keep hold of a particle; a click lets go", "Tools"),
    Shortcut("let_go", ("Escape",), "Let go of everything", "Tools"),
    Shortcut("undo", ("Ctrl+Z",), "Undo a drag, cut, pin or slider move", "Tools"),
    Shortcut("redo", ("Ctrl+Y", "Ctrl+Shift+Z"), "Redo", "Tools"),
    Shortcut("pause", ("Space", "K"), "Pause or play", "Time"),
    Shortcut("step", (".",), "One tick", "Time"),
    Shortcut("slow", ("S",), "Slow motion: 1/2, 1/4, 1/8, real time", "Time"),
    Shortcut("reset", ("R",), "Back to the beginning", "Time"),
    Shortcut("", ("Wheel",), "Zoom about the pointer", "View"),
    Shortcut("", ("Middle drag", "Space+drag"), "Pan", "View"),
    Shortcut("zoom_in", ("+", "="), "Zoom in", "View"),
    Shortcut("zoom_out", ("-",), "Zoom out", "View"),
    Shortcut("fit", ("F", "Home"), "Fit to view; again: to all particles", "View"),
    Shortcut("fullscreen", ("F11",), "Full screen", "View"),
    Shortcut("panel", ("H",), "Hide or show the panel", "View"),
    Shortcut("larger", ("Ctrl++", "Ctrl+="), "Larger widgets", "View"),
    Shortcut("smaller", ("Ctrl+-",), "Smaller widgets", "View"),
    Shortcut("gallery", ("G",), "Levels", "Files"),
    Shortcut("open", ("Ctrl+O",), "Open a level or replay; or drop its file here", "Files"),
    Shortcut("record", ("Ctrl+R",), "Start or stop recording", "Files"),
    Shortcut("save", ("Ctrl+S",), "Save the run so far as a replay", "Files"),
    Shortcut("recordings", ("Ctrl+L",), "Saved replays", "Files"),
    Shortcut("help", ("F1",), "This page", "Files"),
    Shortcut("quit", ("Ctrl+Q",), "Quit", "Files"),
    Shortcut("", ("Arrows",), "Move the keyboard cursor; Shift: faster", "Keyboard"),
    Shortcut("press", ("Enter",), "Press or release the tool at the cursor", "Keyboard"),
    Shortcut("next_particle", ("N",), "Cursor to the next particle", "Keyboard"),
    Shortcut("previous_particle", ("Shift+N",), "Cursor to the previous particle", "Keyboard"),
    Shortcut("", ("Tab", "Shift+Tab"), "Next or previous widget", "Keyboard"),
    Shortcut("", ("Left", "Right"), "Move the slider; Shift: fine", "Keyboard"),
)
GROUPS = ("Tools", "Time", "View", "Files", "Keyboard")

_NAMES = {
    "Escape": pygame.K_ESCAPE, "Space": pygame.K_SPACE, "Enter": pygame.K_RETURN, "Home": pygame.K_HOME,
    "F1": pygame.K_F1, "F11": pygame.K_F11, ".": pygame.K_PERIOD, "+": pygame.K_PLUS, "-": pygame.K_MINUS,
    "=": pygame.K_EQUALS,
}  # fmt: skip
_TWINS = {
    pygame.K_KP_ENTER: pygame.K_RETURN, pygame.K_KP_PLUS: pygame.K_PLUS, pygame.K_KP_MINUS: pygame.K_MINUS,
    pygame.K_KP_PERIOD: pygame.K_PERIOD,
}  # fmt: skip


def _combination(text: str) -> tuple[int, bool, bool]:
    """Key, Ctrl and Shift of "Ctrl+Shift+Z"."""
    ctrl, rest = text.startswith("Ctrl+"), text.removeprefix("Ctrl+")
    shift, name = rest.startswith("Shift+"), rest.removeprefix("Shift+")
    return _NAMES.get(name) or ord(name.lower()), ctrl, shift


@cache
def _table() -> dict[tuple[int, bool, bool], str]:
    return {_combination(keys): entry.action for entry in SHORTCUTS if entry.action for keys in entry.keys}


def action_of(key: int, modifiers: int) -> str | None:
    """The action that a key press starts; Cmd counts as Ctrl, and Shift does not count where a key is typed with it."""
    if modifiers & pygame.KMOD_ALT:
        return None
    ctrl = bool(modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META))
    shift = bool(modifiers & pygame.KMOD_SHIFT)
    key = _TWINS.get(key, key)
    if key in (pygame.K_PLUS, pygame.K_EQUALS, pygame.K_MINUS, pygame.K_RETURN):
        shift = False
    return _table().get((key, ctrl, shift))


def keys_of(action: str) -> str:
    """The first keys of an action, for tooltips."""
    return next(entry.keys[0] for entry in SHORTCUTS if entry.action == action)
