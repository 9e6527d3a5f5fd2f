"""Parts of the widgets that hold a state of their own: lines to type into, rows of buttons."""

from collections.abc import Callable
from dataclasses import dataclass

from pygame_gui.elements import UITextEntryLine

from sandbox.app.widgets.button import Button

# What stands in the place of a number where there is none, and where things differ in it.
DASH, MIXED = "\u2013", "mixed"


@dataclass
class Field:
    """A line to type into; commit gets the text and says whether it is taken, else the old text comes back.

    turn: what a notch of the wheel over it does, and an arrow key in it, +1 or -1; None = nothing. is_begun: it has
    just been entered.
    """

    entry: UITextEntryLine
    commit: Callable[[str], bool]
    text: str
    focused: bool = False
    enter: Callable[[str], object] | None = None
    turn: Callable[[int], object] | None = None
    is_begun: bool = False

    @property
    def is_number(self) -> bool:
        """Whether it shows a number, or a word in the place of one."""
        try:
            float(self.text)
        except ValueError:
            return self.text in (DASH, MIXED)
        return True

    def show(self, text: str) -> None:
        """Show a value, unless the person is typing one."""
        if text != self.text and not self.entry.is_focused:
            self.text = text
            self.entry.set_text(text)

    def finish(self) -> None:
        """Take what was typed, or bring the old text back; Enter goes to `enter` instead where there is one."""
        typed = self.entry.get_text()
        if typed == self.text:
            return
        before = self.text
        self.text = typed
        if not self.commit(typed):
            self.text = before
            self.entry.set_text(before)

    def step(self, by: int) -> bool:
        """Take what was typed, and change the value by a step; whether it has steps."""
        if self.turn is None:
            return False
        self.finish()
        self.turn(by)
        return True

    def revert(self) -> None:
        """Forget what was typed."""
        self.entry.set_text(self.text)


@dataclass
class Choice:
    """A row of buttons of which one is chosen."""

    buttons: dict[str, Button]
    chosen: str = ""

    def show(self, chosen: str) -> None:
        """Mark the chosen one."""
        if chosen == self.chosen:
            return
        self.chosen = chosen
        for value, button in self.buttons.items():
            (button.select if value == chosen else button.unselect)()


def typed_number(
    say: Callable[[str], object], text: str, what: str, low: float, high: float, unit: str = ""
) -> float | None:
    """A typed number in low..high, its unit behind it or not; or None, and what is wrong said in one line."""
    try:
        value = float(text.strip().removesuffix(unit).replace(",", "."))
    except ValueError:
        say(f"{what}: {text.strip() or 'nothing'!r} is not a number.")
        return None
    if not low <= value <= high:
        say(f"{what}: {value:g} is outside {low:g} to {high:g}. The old value stays.")
        return None
    return value
