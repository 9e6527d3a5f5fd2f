"""Shortcuts: the one table of what can be done and with which keys; feeds the dispatcher, help and settings."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import pygame

from sandbox.editor.tools.palette import TOOLS
from sandbox.level.hints import worded
from sandbox.tools.play_tools import PLAY_TOOLS

Mode = Literal["play", "edit"]

# The key of context menus, for which pygame has no name: SDL calls it the application key.
_MENU_KEY = 0x40000065
_NAMES = {
    "Escape": pygame.K_ESCAPE, "Space": pygame.K_SPACE, "Enter": pygame.K_RETURN, "Home": pygame.K_HOME,
    **{f"F{number}": pygame.K_F1 + number - 1 for number in range(1, 13)},
    ".": pygame.K_PERIOD, "+": pygame.K_PLUS, "-": pygame.K_MINUS, "=": pygame.K_EQUALS,
    "Delete": pygame.K_DELETE, "Backspace": pygame.K_BACKSPACE,
    "Menu": _MENU_KEY, "PageUp": pygame.K_PAGEUP, "PageDown": pygame.K_PAGEDOWN, "Tab": pygame.K_TAB,
}  # fmt: skip
_TWINS = {
    pygame.K_KP_ENTER: pygame.K_RETURN, pygame.K_KP_PLUS: pygame.K_PLUS, pygame.K_KP_MINUS: pygame.K_MINUS,
    pygame.K_KP_PERIOD: pygame.K_PERIOD,
}  # fmt: skip
# Keys that mean the same with Shift or without: on some keyboards they are typed with it.
_WITHOUT_SHIFT = (pygame.K_PLUS, pygame.K_EQUALS, pygame.K_MINUS, pygame.K_RETURN)
# Keys that no action can have: they go from widget to widget, or move the cursor.
_FIXED = (pygame.K_TAB, pygame.K_LEFT, pygame.K_RIGHT, pygame.K_UP, pygame.K_DOWN)


def _combination(text: str) -> tuple[int, bool, bool]:
    """Key, Ctrl and Shift of "Ctrl+Shift+Z"."""
    ctrl, rest = text.startswith("Ctrl+"), text.removeprefix("Ctrl+")
    shift, name = rest.startswith("Shift+"), rest.removeprefix("Shift+")
    return _NAMES.get(name) or ord(name.lower() if len(name.lower()) == 1 else name), ctrl, shift


def _is_known(text: str) -> bool:
    try:
        _combination(text)
    except TypeError:  # no single letter
        return False
    return True


@dataclass(frozen=True)
class Shortcut:
    """An action, the keys that start it, what it does, and the mode that it belongs to, None = every one.

    An action of "" is a gesture that the help page explains. Raises ValueError where a key of an action is none.
    """

    action: str
    keys: tuple[str, ...]
    label: str
    group: str
    mode: Mode | None = None

    def __post_init__(self) -> None:
        wrong = [text for text in self.keys if self.action and not _is_known(text)]
        if wrong:
            raise ValueError(f"{self.action}: {', '.join(wrong)} is no key, alone or with Ctrl and Shift")

    @property
    def name(self) -> str:
        """The name under which a person's own keys are kept: actions of two modes may have one name."""
        return f"{self.mode or 'any'}.{self.action}"


def _tools(group: str) -> tuple[Shortcut, ...]:
    """The shortcuts that take up the editor's tools of a group."""
    tools = (tool for tool in TOOLS.values() if tool.group == group)
    return tuple(Shortcut(tool.action, (tool.key,), tool.label, group, "edit") for tool in tools)


def _play_tools(group: str) -> tuple[Shortcut, ...]:
    """The shortcuts that take up the tools in play of a group."""
    tools = (tool for tool in PLAY_TOOLS.values() if tool.group == group)
    return tuple(Shortcut(tool.action, tool.keys, tool.label, group, "play") for tool in tools)


SHORTCUTS = (
    *_play_tools("Tools"),
    Shortcut("palette", ("B",), "Show or hide the parts to play with", "Parts", "play"),
    *_play_tools("Parts"),
    Shortcut("catalogue", ("U",), "Ready parts and your own parts", "Parts", "play"),
    Shortcut("", ("Wheel", "+/-"), "Make a part or a push larger or smaller", "Parts", "play"),
    Shortcut("", ("Shift+click",), "Keep holding a particle; a click lets go", "Tools", "play"),
    Shortcut("lattice", ("L",), "Lattice: springs, coloured by their strain", "View", "play"),
    Shortcut("particles", ("F3",), "Particles", "View", "play"),
    Shortcut("contacts", ("F4",), "Contact points and their normals", "View", "play"),
    Shortcut("forces", ("F5",), "Forces of springs and contacts", "View", "play"),
    Shortcut("velocities", ("F6",), "Velocities", "View", "play"),
    Shortcut("stability", ("F7",), "Stability: how near springs are to the limit", "View", "play"),
    Shortcut("zones", ("F10",), "Zones of a level that has some", "View", "play"),
    Shortcut("graphs", ("F8",), "Graphs: energy, strain, speeds, torque, time", "View", "play"),
    Shortcut("pick", ("O",), "Start or stop the graph of a particle", "View", "play"),
    Shortcut("compare", ("F9",), "Compare two settings, or go back to one", "View", "play"),
    Shortcut("let_go", ("Escape",), "Let go of everything; back to the hand", "Tools", "play"),
    Shortcut("hand", ("T",), "Hand: gentle, normal or strong", "Tools", "play"),
    Shortcut("melt", ("Z",), "Melt, or make whole again", "Tools", "play"),
    Shortcut("feel", ("Shift+Q",), "Feel: how the thing at the cursor comes back", "Tools", "play"),
    Shortcut("free", ("J",), "Free what is stuck in something", "Tools", "play"),
    Shortcut("bring_back", ("Shift+J",), "Bring back what left the picture", "Tools", "play"),
    Shortcut("details", ("Shift+D",), "Details of what went out of bounds", "Tools", "play"),
    Shortcut("touching", ("Shift+T",), "Contacts on or off; the run starts over", "Tools", "play"),
    Shortcut("edit", ("E",), "Edit this level, or go back to the editor", "Files", "play"),
    Shortcut("keep", ("Ctrl+K",), "Take what the run did to the sheet of the editor", "Files", "play"),
    Shortcut("undo", ("Ctrl+Z",), "Undo a drag, cut, pin, slider move or restart", "Tools", "play"),
    Shortcut("redo", ("Ctrl+Y", "Ctrl+Shift+Z"), "Redo", "Tools", "play"),
    *_tools("Draw"),
    Shortcut("", ("+", "-"), "While drawing: more or fewer segments", "Draw", "edit"),
    Shortcut("finish", ("Ctrl+Enter",), "Finish the drawing at the pointer", "Draw", "edit"),
    Shortcut("cancel", ("Escape",), "Cancel; then select nothing", "Draw", "edit"),
    *_tools("Terrain"),
    Shortcut("play", ("E",), "Play the level; E comes back here", "Edit", "edit"),
    Shortcut("undo", ("Ctrl+Z",), "Undo", "Edit", "edit"),
    Shortcut("redo", ("Ctrl+Y", "Ctrl+Shift+Z"), "Redo", "Edit", "edit"),
    Shortcut("copy", ("Ctrl+C",), "Copy", "Edit", "edit"),
    Shortcut("cut", ("Ctrl+X",), "Cut", "Edit", "edit"),
    Shortcut("paste", ("Ctrl+V",), "Paste at the pointer", "Edit", "edit"),
    Shortcut("copy_level", ("Ctrl+Shift+C",), "Copy the whole level as JSON", "Edit", "edit"),
    Shortcut("duplicate", ("Ctrl+D",), "Duplicate; Ctrl+drag: drag a copy", "Edit", "edit"),
    Shortcut("keep_part", ("Ctrl+K",), "Keep the selection as a part", "Edit", "edit"),
    Shortcut("array", ("Ctrl+Shift+D",), "Several copies, along a line or a circle", "Arrange", "edit"),
    Shortcut("delete", ("Delete", "Backspace"), "Delete, or the corner that you clicked", "Edit", "edit"),
    Shortcut("mirror", ("M",), "Mirror", "Arrange", "edit"),
    Shortcut("align", ("I",), "Align or distribute", "Arrange", "edit"),
    Shortcut("order", ("Z",), "Order: what is drawn in front", "Arrange", "edit"),
    Shortcut("forward", ("PageUp",), "One forward", "Arrange", "edit"),
    Shortcut("backward", ("PageDown",), "One backward", "Arrange", "edit"),
    Shortcut("parts", ("K",), "Group, break apart, or take joints apart", "Arrange", "edit"),
    Shortcut("group", ("Ctrl+G",), "Group", "Arrange", "edit"),
    Shortcut("ungroup", ("Ctrl+Shift+G",), "Ungroup", "Arrange", "edit"),
    Shortcut("break_apart", ("Ctrl+B",), "Break bodies into particles and springs", "Arrange", "edit"),
    Shortcut("unjoin", ("Ctrl+U",), "Take joints apart", "Arrange", "edit"),
    Shortcut("rename", ("F2",), "Rename", "Select", "edit"),
    Shortcut("menu", ("F10",), "More commands, without a button", "Edit", "edit"),
    Shortcut("", ("Shift+click",), "Add to the selection; Ctrl+click: remove", "Select", "edit"),
    Shortcut("", ("Double click",), "Open a group and select one member", "Select", "edit"),
    Shortcut("select_all", ("Ctrl+A",), "Select everything", "Select", "edit"),
    Shortcut("select_material", ("Ctrl+M",), "Select all of a material", "Select", "edit"),
    Shortcut("next_item", ("N",), "Select the next thing", "Select", "edit"),
    Shortcut("previous_item", ("Shift+N",), "Select the previous thing", "Select", "edit"),
    Shortcut("find", ("Ctrl+F",), "Find in the list of objects", "Select", "edit"),
    Shortcut("hide", ("Ctrl+H",), "Hide; with nothing selected: show all", "Select", "edit"),
    Shortcut("lock", ("Ctrl+Shift+L",), "Lock; with nothing selected: unlock all", "Select", "edit"),
    Shortcut("thing_menu", ("Menu", "Shift+F10"), "Menu of it; right click: of what is there", "Select", "edit"),
    Shortcut("numbers", ("T",), "Type numbers: place, size, options", "Select", "edit"),
    Shortcut("", ("Wheel", "Up/Down"), "Change a number in steps", "Select", "edit"),
    Shortcut("", ("Arrows",), "Nudge by the grid; Shift: ten", "Select", "edit"),
    Shortcut("", ("Alt",), "Hold it to switch snapping off", "Select", "edit"),
    Shortcut("snap", ("X",), "Snapping on or off", "Select", "edit"),
    Shortcut("grid", ("Shift+X",), "Step of the grid", "Select", "edit"),
    Shortcut("forecast", ("U",), "Show where everything will hang", "View", "edit"),
    Shortcut("lattice", ("Shift+L",), "Lattice on or off: springs and particles", "View", "edit"),
    Shortcut("trail", ("Shift+T",), "Trail: where the selected things will go", "View", "edit"),
    Shortcut("try_range", ("Ctrl+R",), "Try a range: one number, several values", "View", "edit"),
    Shortcut("rest", ("Shift+U",), "Begin at rest, as the forecast shows", "Edit", "edit"),
    Shortcut("wave_in_order", ("Ctrl+Shift+W",), "Phase wave through muscles, in order", "Arrange", "edit"),
    Shortcut("new", ("Ctrl+N",), "New level", "Files", "edit"),
    Shortcut("open", ("Ctrl+O",), "Levels to edit", "Files", "edit"),
    Shortcut("recent", ("Ctrl+L",), "My levels", "Files", "edit"),
    Shortcut("open_file", ("Ctrl+Shift+O",), "Open a file; or drop it here", "Files", "edit"),
    Shortcut("save", ("Ctrl+S",), "Save", "Files", "edit"),
    Shortcut("save_as", ("Ctrl+Shift+S",), "Save under another name", "Files", "edit"),
    Shortcut("revert", ("Ctrl+Shift+R",), "Read the file again", "Files", "edit"),
    Shortcut("press", ("Enter",), "Click at the cursor; end a drawing", "Keyboard", "edit"),
    Shortcut("", ("Arrows",), "Move the cursor while drawing", "Keyboard", "edit"),
    Shortcut("pause", ("Space", "K"), "Pause or play", "Time", "play"),
    Shortcut("step", (".",), "One tick", "Time", "play"),
    Shortcut("back", (",",), "One tick back", "Time", "play"),
    Shortcut("slow", ("S",), "Slow motion: 1/2, 1/4, 1/8, real time", "Time", "play"),
    Shortcut("fast", ("Shift+S",), "Fast: 2, 4, 8 times", "Time", "play"),
    Shortcut("backwards", ("A",), "Play backwards: once, twice, four times", "Time", "play"),
    Shortcut("timeline", ("Y",), "Timeline of the run", "Time", "play"),
    Shortcut("next_mark", ("Shift+.",), "Go to the next command, break or bookmark", "Time", "play"),
    Shortcut("previous_mark", ("Shift+,",), "Go to the one before", "Time", "play"),
    Shortcut("bookmark", ("Shift+B",), "Set or remove a bookmark at this tick", "Time", "play"),
    Shortcut("loop", ("Shift+L",), "Loop the range, or stop looping", "Time", "play"),
    Shortcut("loop_start", ("[",), "The range begins here", "Time", "play"),
    Shortcut("loop_end", ("]",), "The range ends here", "Time", "play"),
    Shortcut("branches", ("Shift+Y",), "Go back to an earlier version of the run", "Time", "play"),
    Shortcut("", ("Shift+drag",), "Choose the range on the timeline", "Time", "play"),
    Shortcut("reset", ("R",), "Back to the last checkpoint, or the beginning", "Time", "play"),
    Shortcut("restart", ("Shift+R",), "Back to the beginning", "Time", "play"),
    Shortcut("as_it_was", ("Ctrl+Shift+R",), "Back to the beginning, as the level was", "Time", "play"),
    Shortcut("card", ("Shift+E",), "How it ended: the card of a win or a loss", "View", "play"),
    Shortcut("ghost", ("Shift+G",), "Ghost of your best run, in levels with a goal", "View", "play"),
    Shortcut("solution", ("Shift+W",), "Watch how its author solved it", "View", "play"),
    Shortcut("", ("Wheel",), "Zoom about the pointer", "View"),
    Shortcut("", ("Middle drag", "Space+drag"), "Pan", "View"),
    Shortcut("zoom_in", ("+", "="), "Zoom in", "View"),
    Shortcut("zoom_out", ("-",), "Zoom out", "View"),
    Shortcut("fit", ("F", "Home"), "Fit to the view; press again to see everything", "View"),
    Shortcut("follow", ("Shift+F",), "Camera follows, or stands still", "View", "play"),
    Shortcut("fullscreen", ("F11",), "Full screen", "View"),
    Shortcut("panel", ("H",), "Hide or show the panel", "View"),
    Shortcut("next_page", ("Ctrl+Tab",), "Next page of the panel", "View", "edit"),
    Shortcut("previous_page", ("Ctrl+Shift+Tab",), "Previous page of the panel", "View", "edit"),
    Shortcut("larger", ("Ctrl++", "Ctrl+="), "Larger widgets", "View"),
    Shortcut("smaller", ("Ctrl+-",), "Smaller widgets", "View"),
    Shortcut("usual_size", ("Ctrl+0",), "Widgets as large as the system asks for", "View"),
    Shortcut("gallery", ("G",), "Levels", "Files", "play"),
    Shortcut("open", ("Ctrl+O",), "Open a level or a recording, or drop its file here", "Files", "play"),
    Shortcut("share", ("F12",), "Share the last minute: GIF, MP4, PNG, page", "Files", "play"),
    Shortcut("copy_link", ("Ctrl+Shift+L",), "Copy a link to this run", "Files", "play"),
    Shortcut("toy", ("Ctrl+T",), "Desk toy: this level in a small window that stays on top", "Files", "play"),
    Shortcut("save", ("Ctrl+S",), "Save the scene as it stands, in My levels", "Files", "play"),
    Shortcut("record", ("Ctrl+R",), "Start or stop recording", "Files", "play"),
    Shortcut("save_recording", ("Ctrl+Shift+S",), "Save the run so far as a recording", "Files", "play"),
    Shortcut("recordings", ("Ctrl+L",), "Saved recordings", "Files", "play"),
    Shortcut("sound", ("M",), "Sound on or off", "View", "play"),
    Shortcut("settings", ("Ctrl+,",), "Settings: theme, sizes, sound, keys", "Files"),
    Shortcut("help", ("F1",), "Shortcuts", "Files"),
    Shortcut("hint", ("F2",), "Show the level's description again", "Files", "play"),
    Shortcut("tour", ("Shift+F1",), "The tour: a first level in six steps", "Files"),
    Shortcut("quit", ("Ctrl+Q",), "Quit", "Files"),
    Shortcut("", ("Arrows",), "Move the keyboard cursor; Shift: faster", "Keyboard", "play"),
    Shortcut("press", ("Enter",), "Press or release the tool at the cursor", "Keyboard", "play"),
    Shortcut("thing_menu", ("Q", "Menu", "Shift+F10"), "Menu of the thing at the cursor", "Keyboard", "play"),
    Shortcut("next_thing", ("N",), "Cursor to the next thing", "Keyboard", "play"),
    Shortcut("previous_thing", ("Shift+N",), "Cursor to the previous thing", "Keyboard", "play"),
    Shortcut("next_particle", ("PageDown",), "Cursor to the next particle of the thing", "Keyboard", "play"),
    Shortcut("previous_particle", ("PageUp",), "Cursor to the previous particle of it", "Keyboard", "play"),
    Shortcut("", ("Tab", "Shift+Tab"), "Next or previous widget", "Keyboard"),
    Shortcut("", ("Left", "Right"), "Move the slider; Shift: fine", "Keyboard"),
)

# Keys of a person's own, by the names of entries.
_own: dict[str, tuple[str, ...]] = {}


def use_keys(own: Mapping[str, tuple[str, ...]]) -> list[str]:
    """Replace the keys of entries by a person's own, by their names; the keys among them that do not exist."""
    unknown = [text for keys in own.values() for text in keys if not _is_known(text)]
    _own.clear()
    _own.update({name: tuple(text for text in keys if _is_known(text)) for name, keys in own.items()})
    _table.cache_clear()
    shortcuts.cache_clear()
    return unknown


@cache
def shortcuts(mode: Mode) -> tuple[Shortcut, ...]:
    """The entries of the table that hold in a mode, with the keys that they have now."""
    entries = (entry for entry in SHORTCUTS if entry.mode in (None, mode))
    return tuple(replace(entry, keys=_own[entry.name]) if entry.name in _own else entry for entry in entries)


def with_keys(
    own: Mapping[str, tuple[str, ...]], entry: Shortcut, keys: tuple[str, ...]
) -> tuple[dict[str, tuple[str, ...]], list[Shortcut]]:
    """A person's own keys once an entry has others, and the entries that these are taken from, as they are then."""
    taken = {_combination(text) for text in keys}
    modes: tuple[Mode, ...] = ("play", "edit") if entry.mode is None else (entry.mode,)
    others = {other.name: other for mode in modes for other in shortcuts(mode) if other.action}
    result, losers = {**own, entry.name: keys}, []
    for name, other in others.items():
        remaining = tuple(text for text in other.keys if _combination(text) not in taken)
        if name != entry.name and remaining != other.keys:
            result[name] = remaining
            losers.append(replace(other, keys=remaining))
    return result, losers


def spoken(keys: tuple[str, ...]) -> str:
    """Keys as a part of a sentence."""
    return " or ".join(keys) or "no key"


def combination_of(key: int, modifiers: int) -> str | None:
    """The name of a key press in the table; None for one that no action can have."""
    key = _TWINS.get(key, key)
    name = next((name for name, code in _NAMES.items() if code == key), None)
    if name is None and 32 < key < 0x3000 and chr(key).isprintable():
        # A letter that its capital does not lead back to stays as it is.
        upper = chr(key).upper()
        name = upper if len(upper) == 1 and upper.lower() == chr(key) else chr(key)
    if name is None or key in _FIXED or modifiers & pygame.KMOD_ALT:
        return None
    shift = bool(modifiers & pygame.KMOD_SHIFT) and key not in _WITHOUT_SHIFT
    ctrl = bool(modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META))
    return ("Ctrl+" if ctrl else "") + ("Shift+" if shift else "") + name


@cache
def _table(mode: Mode) -> dict[tuple[int, bool, bool], str]:
    return {_combination(keys): entry.action for entry in shortcuts(mode) if entry.action for keys in entry.keys}


def action_of(key: int, modifiers: int, mode: Mode = "play") -> str | None:
    """The action that a key press starts; Cmd counts as Ctrl, and Shift does not count where a key is typed with it."""
    if modifiers & pygame.KMOD_ALT:
        return None
    ctrl = bool(modifiers & (pygame.KMOD_CTRL | pygame.KMOD_META))
    shift = bool(modifiers & pygame.KMOD_SHIFT)
    key = _TWINS.get(key, key)
    if key in _WITHOUT_SHIFT:
        shift = False
    return _table(mode).get((key, ctrl, shift))


def tip_of(action: str, mode: Mode) -> str:
    """What an action does and its first keys, for tooltips."""
    entry = _entry_of(action, mode)
    return f"{entry.label}  [{entry.keys[0]}]" if entry.keys else entry.label


def label_of(action: str, mode: Mode) -> str:
    """What an action does."""
    return _entry_of(action, mode).label


def keys_of(action: str) -> str:
    """The first keys of an action of play, "" where it has none."""
    return "".join(_entry_of(action, "play").keys[:1])


def _entry_of(action: str, mode: Mode) -> Shortcut:
    return next(entry for entry in shortcuts(mode) if entry.action == action)


def hint(description: str) -> str:
    """A level's description in the words of the window, with the keys that it has now."""
    return worded(description, "window", lambda action: spoken(_entry_of(action, "play").keys[:1]))
