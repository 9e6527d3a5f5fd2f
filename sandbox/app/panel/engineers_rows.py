"""Rows of the panel for engineers: frequencies and damping ratios, and how ticks are solved."""

import math
from collections.abc import Callable

from sandbox.app.base.sentences import sentence
from sandbox.app.panel.firmness_rows import FirmnessRows
from sandbox.app.panel.panel_rows import PanelRows
from sandbox.app.panel.readings import number
from sandbox.app.panel.response_curve import ResponseCurve
from sandbox.app.panel.solver_rows import SolverRows
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.field import DASH, MIXED, typed_number
from sandbox.physics.arrays import Floats
from sandbox.physics.equation import coefficients_from_frequency, frequency_from_coefficients

# Layout units.
CURVE_HEIGHT = 78.0


class EngineersRows:
    """What the rows show and do; change: sets Cs and Cd of the chosen springs, and says whether there are any."""

    def __init__(
        self, playback: Playback, say: Callable[[str], None], ask_rate: Callable[[str], None],
        firmness: FirmnessRows, change: Callable[[float, float], bool],
    ) -> None:  # fmt: skip
        self.solving = SolverRows(playback, say, ask_rate)
        self._say, self._firmness, self._change = say, firmness, change

    @property
    def playback(self) -> Playback:
        """The run that the rows show and change."""
        return self.solving.playback

    @playback.setter
    def playback(self, playback: Playback) -> None:
        self.solving.playback = playback

    def build(self, rows: PanelRows) -> None:
        """Make the widgets."""
        ui, firmness = rows.ui, self._firmness
        self.solving.build(rows)
        if firmness.shown:
            ui.label(rows.row(16, 2), "Of the body", rows.back)
            firmness.frequency, firmness.ratio = rows.beside(
                ("Wobble [Hz]", "Swings a second of the body's slowest wobble, undamped", firmness.type_frequency),
                ("Damping ratio", "Below 1 the body swings, above 1 it creeps back", firmness.type_ratio),
            )
        ui.label(rows.row(16, 2), "Of one spring, alone", rows.back)
        self.frequency, self.ratio = rows.beside(
            ("Frequency [Hz]", "Swings a second of one spring, undamped", self._type_frequency),
            ("Damping ratio", "Below 1 one spring swings, above 1 it creeps back", self._type_ratio),
        )
        self.curve = ResponseCurve(ui, rows.row(CURVE_HEIGHT, 8), rows.back)

    def refresh(self, is_look: bool) -> None:
        """Show how ticks are solved now."""
        self.solving.refresh()

    def show_spring(self, coefficients: tuple[Floats, Floats] | None) -> None:
        """Show what Cs and Cd of the chosen springs mean for one of them; None: no spring is chosen."""
        if coefficients is None:
            texts = DASH, DASH
            self.curve.show_none("There is no spring here.")
        elif any(values.min() != values.max() for values in coefficients):
            texts = MIXED, MIXED
            self.curve.show_none("The springs differ in Cs or Cd.")
        else:
            stiffness, damping = (float(values[0]) for values in coefficients)
            self.curve.show_spring((stiffness, damping), self.playback.session.world.settings.tick_rate)
            frequency, ratio = frequency_from_coefficients(stiffness, damping, self._tick_time())
            texts = number(frequency), number(ratio)
        self.frequency.show(texts[0])
        self.ratio.show(texts[1])

    def _tick_time(self) -> float:
        return 1.0 / self.playback.session.world.settings.tick_rate

    def _type_frequency(self, text: str) -> bool:
        frequency = typed_number(self._say, text, "Frequency", 0.0, math.inf)
        if frequency is None:
            return False
        ratio = _typed_or_none(self.ratio.text)
        if ratio is None:
            self._say("The springs had different damping ratios. All of them are 1 now.")
        return self._set_frequency(frequency, 1.0 if ratio is None else ratio)

    def _type_ratio(self, text: str) -> bool:
        ratio = typed_number(self._say, text, "Damping ratio", 0.0, math.inf)
        if ratio is None:
            return False
        frequency = _typed_or_none(self.frequency.text)
        if frequency is None:
            self._say("These springs differ in frequency. Set the frequency first.")
            return False
        return self._set_frequency(frequency, ratio)

    def _set_frequency(self, frequency: float, ratio: float) -> bool:
        try:
            stiffness, damping = coefficients_from_frequency(frequency, ratio, self._tick_time())
        except ValueError as error:
            self._say(sentence(error))
            return False
        return self._change(stiffness, damping)


def _typed_or_none(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
