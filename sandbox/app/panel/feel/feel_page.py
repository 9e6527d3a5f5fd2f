"""The card of how a thing feels: its curve with two handles, its numbers, and what makes it feel as one wants."""

import math
from collections.abc import Callable

from sandbox.app.draw.colours import TEXT
from sandbox.app.panel.feel.curve_page import show_curves
from sandbox.app.panel.feel.feel_curve import MOST_OVERSHOOT, CurveState, FeelCurve
from sandbox.app.panel.feel.feel_work import WAYS, FeelWork
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.boxes import ProgressBar
from sandbox.app.widgets.dialogs import BUTTON, MARGIN, Dialog
from sandbox.app.widgets.field import DASH, Field, typed_number
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.export.engines import body_names
from sandbox.export.feel import Feel, sentence
from sandbox.export.numbers import percent, short

# Sizes in layout units.
WIDTH, HEIGHT = 800.0, 560.0
PICKER, WAY, ROW, GAP, SIDE = 180.0, 130.0, 30.0, 10.0, 148.0
SAID, TOP, LINE, LABEL = 56.0, 82.0, 16.0, 17.0
BAR, NOTE, CANCEL = 8.0, 34.0, 84.0
MOST_SECONDS = 60.0
NO_SPRINGS = "This level has no springs whose feel could be measured."
READINGS = ("Frequency", "Damping ratio", "Swings seen", "One spring is off by")


def show_feel(ui: Ui, playback: Playback, say: Callable[[str], None], body: str | None = None) -> None:
    """Cover the window by the card of how a body (None: the first) of a run feels."""
    if body_names(playback.session.world):
        FeelPage(ui, FeelWork(playback, body))
    else:
        say(NO_SPRINGS)


class FeelPage:
    """The card in one window; work: what it shows, which outlives another layout."""

    def __init__(self, ui: Ui, work: FeelWork) -> None:
        self._ui, self.work = ui, work
        self._dialog = dialog = Dialog(ui, "Feel", WIDTH, HEIGHT, self._reopen, self._escape, is_page=True)
        self._box, wide = dialog.box, dialog.width
        menu = ui.rect(wide - MARGIN - PICKER, 16, PICKER, ROW)
        WordPicker(ui, menu, work.names, work.body, lambda name: self._choose(body=name), self._box)
        tips = ("Pulled as gravity pulls", "Pulled across that")
        ways = [(way, way.capitalize(), tip) for way, tip in zip(WAYS, tips, strict=True)]
        place = ui.rect(wide - MARGIN - PICKER - GAP - WAY, 16, WAY, ROW)
        self.ways = ui.choice(place, ways, lambda way: self._choose(way=way), self._box)
        self.said = TextBlock(ui, dialog.place(SAID, 22), "", self._box, 14.0, TEXT, is_bold=True)
        below = dialog.height - MARGIN - BUTTON - NOTE - BAR - 3 * GAP
        place = ui.rect(MARGIN - GAP, TOP, dialog.inside - SIDE, below - TOP)
        self.curve = FeelCurve(ui, place, self._want, self._seek, self._box)
        self._build_numbers(wide - MARGIN - SIDE)
        wide = dialog.inside - CANCEL - GAP
        self.bar = ProgressBar(ui, ui.rect(MARGIN, below + GAP, wide, BAR), self._box)
        self.note = TextBlock(ui, ui.rect(MARGIN, below + BAR + 2 * GAP, wide, NOTE), "", self._box, 12.0)
        place = ui.rect(MARGIN + wide + GAP, below + GAP, CANCEL, ROW)
        self.cancel = ui.button(place, "Cancel", self._cancel, self._box)
        self.use = dialog.add_buttons(("Use", self._use), ("Take it home", self._take_home), ("Close", dialog.end))
        self.use.tip = "Set this Cs and Cd in the run; Ctrl+Z takes it back"
        self._home = next(button for button in ui.buttons() if button.text == "Take it home")
        ui.work_on(dialog.sheet, self._go_on)
        ui.focus_on(self.curve)
        self.refresh()

    def _build_numbers(self, x: float) -> None:
        ui, y = self._ui, TOP
        self.fields: dict[str, Field] = {}
        for name, title, commit in (
            ("overshoot", "Overshoot [%]", self._type_overshoot), ("settling", "Still after [s]", self._type_settling),
        ):  # fmt: skip
            ui.label(ui.rect(x, y, SIDE, LABEL), title, self._box, "muted")
            self.fields[name] = ui.field(ui.rect(x, y + LABEL + 1, SIDE, ROW - 2), DASH, commit, self._box, 24)
            y += LABEL + ROW + 4
        self.readings: dict[str, TextBlock] = {}
        for name in READINGS:
            ui.label(ui.rect(x, y, SIDE, LINE), name, self._box, "muted")
            self.readings[name] = TextBlock(ui, ui.rect(x, y + LINE, SIDE, LINE + 2), DASH, self._box, 13.0, TEXT)
            y += 2 * LINE + 4

    def _reopen(self, ui: Ui) -> None:
        FeelPage(ui, self.work)

    # What the person does.

    def _escape(self) -> None:
        if self.work.done is not None and self.work.feel is not None:
            self._cancel()
        else:
            self._dialog.end()

    def _cancel(self) -> None:
        self.work.cancel()
        if self.work.feel is None:
            self._dialog.end()
        else:
            self.refresh()

    def _choose(self, body: str | None = None, way: str | None = None) -> None:
        self.work.choose(body, way)
        self._begin()

    def _want(self, overshoot: float, settling: float) -> None:
        self.work.want(overshoot, settling)
        self.refresh()

    def _seek(self) -> None:
        self.work.seek()
        self._begin()

    def _begin(self) -> None:
        self._ui.work_on(self._dialog.sheet, self._go_on)
        self.refresh()

    def _type_overshoot(self, text: str) -> bool:
        value = typed_number(self.note.show_text, text, "Overshoot", 0.0, 100.0 * MOST_OVERSHOOT, unit="%")
        if value is not None:
            self.work.want(overshoot=value / 100.0)
            self._seek()
        return value is not None

    def _type_settling(self, text: str) -> bool:
        least = math.ceil(2000.0 * self.work.tick) / 1000.0
        value = typed_number(self.note.show_text, text, "Still after", least, MOST_SECONDS, unit="s")
        if value is not None:
            self.work.want(settling=value)
            self._seek()
        return value is not None

    def _use(self) -> None:
        self.work.use()
        self.refresh()

    def _take_home(self) -> None:
        if self.work.shown is not None:
            show_curves(self._ui, self.work.shown)

    # Showing.

    def _go_on(self) -> bool:
        is_done = self.work.step()
        self.refresh()
        return is_done

    def refresh(self) -> None:
        """Show what is known by now."""
        work, shown = self.work, self.work.shown
        can_change = work.feel is not None and not work.refusal
        self.ways.show(work.way)
        self.said.show_text("" if shown is None else sentence(shown))
        found = None if work.found is None else work.found.feel
        self.curve.show_state(CurveState(work.feel, found, work.wanted, work.tick, can_change))
        self.curve.is_enabled = can_change
        for field, text in zip(self.fields.values(), self._wanted_texts(), strict=True):
            field.is_enabled = can_change
            field.show(text)
        for block, text in zip(self.readings.values(), _read(shown), strict=True):
            block.show_text(text)
        self.bar.visible = self.cancel.visible = work.done is not None
        self.bar.show_fraction(work.done or 0.0)
        self.note.show_text(work.note)
        self.use.is_enabled = work.found is not None
        self._home.is_enabled = shown is not None

    def _wanted_texts(self) -> tuple[str, str]:
        if self.work.wanted is None:
            return DASH, DASH
        overshoot, settling = self.work.wanted
        return short(100.0 * overshoot), short(settling)


def _read(feel: Feel | None) -> tuple[str, ...]:
    """The readings of a card, in the order of READINGS."""
    if feel is None:
        return (DASH,) * len(READINGS)
    is_seen = math.isfinite(feel.hz)
    frequency = f"{short(feel.hz)} Hz" if is_seen else "quicker than a tick"
    return frequency, short(feel.ratio) if is_seen else DASH, str(feel.numbers.swings), percent(feel.difference)
