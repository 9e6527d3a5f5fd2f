"""Hints: a level's description names controls by what they do; here are the words for each place where it is read."""

import re
from collections.abc import Callable
from typing import Literal, NamedTuple

# Where a hint is read: in the window, or in a page by who has a mouse, or fingers alone.
Place = Literal["window", "mouse", "finger"]


class Control(NamedTuple):
    """A control that hints name: what it does, and its word in each place; None: it is not there.

    action: its name in the window's table of shortcuts, whose key takes the place of KEY; "": it has none there.
    element: the id of what a page has for it; "": a page has nothing for it.
    """

    does: str
    action: str
    element: str
    window: str
    mouse: str | None
    finger: str | None


KEY = "<key>"
CONTROLS = {
    "again": Control("begins again", "reset", "again", KEY, "R", "the round arrow"),
    "undo": Control("undoes", "undo", "undo", KEY, "Ctrl+Z", "the arrow back"),
    "pause": Control("pauses, and goes on", "pause", "play", KEY, "Space", "the pause button"),
    "step": Control("makes a single tick", "step", "step", KEY, ".", "the step button"),
    "pick": Control("chooses a thing, to set its firmness", "", "menu", "click", "right click", "rest a finger on"),
    "panel": Control("has Cs and Cd", "panel", "tune", "at the right", "in the panel (H)", "behind the sliders"),
    "cut": Control("cuts", "tool_cut", "cut", f"the cutting tool ({KEY})", "the scissors (C)", "the scissors"),
    "make": Control("has things to make", "palette", "make", f"the strip of parts ({KEY})", "the pencil (B)",
                    "the pencil"),
    "box": Control("drops a box", "tool_box", "", KEY, None, None),
    "resize": Control("makes a part larger before it falls", "", "", "the mouse wheel", None, None),
    "engineers": Control("has the solver and its settings", "", "tune", "under For engineers",
                         "under For engineers (H)", "behind the sliders, under For engineers"),
    "rate": Control("has ticks a second", "", "", "under For engineers", None, None),
    "toy": Control("takes the level to the desktop", "toy", "", KEY, None, None),
}  # fmt: skip
_NAMED = re.compile(r"\{(" + "|".join(f"{name}|{name.capitalize()}" for name in CONTROLS) + r")\}")
_BETWEEN_SENTENCES = re.compile(r"(?<=[.!?])(\s+)(?=[A-Z{])")


def worded(text: str, place: Place, key_of: Callable[[str], str] = str) -> str:
    """A hint with the word of a place for each control that it names: {again}, or {Again} where a sentence begins.

    A sentence about what the place does not have is left out. key_of: the window's key for an action.
    """
    if not _NAMED.search(text):
        return text
    # Sentences, and what lies between them.
    parts = _BETWEEN_SENTENCES.split(text)
    kept = ""
    for sentence, gap in zip(parts[::2], ["", *parts[1::2]], strict=True):
        if all(_word(name, place) is not None for name in _NAMED.findall(sentence)):
            said = _NAMED.sub(lambda found: _filled(found[1], place, key_of), sentence)
            kept += gap + said if kept else said
    return kept


def _word(name: str, place: Place) -> str | None:
    word: str | None = getattr(CONTROLS[name.lower()], place)
    return word


def _filled(name: str, place: Place, key_of: Callable[[str], str]) -> str:
    control = CONTROLS[name.lower()]
    word = (_word(name, place) or "").replace(KEY, key_of(control.action))
    return word[:1].upper() + word[1:] if name[0].isupper() else word
