"""Rows of the panel for engineers: how ticks are solved, how bodies and springs swing, how a spring comes to rest."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pygame

from sandbox.app.draw.colours import ACCENT, DECADE, FIELD, MUTED, TEXT
from sandbox.app.panel.firmness_rows import FirmnessRows
from sandbox.app.panel.panel_rows import PanelRows
from sandbox.app.panel.readings import motion_words
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.property_widgets import PropertyOwner
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.editor.panel.field_info import FieldInfo, fields_of
from sandbox.editor.panel.material_properties import Swing, coefficients_for, swing_properties
from sandbox.editor.panel.property import MIXED, Property, Section, in_range
from sandbox.level.document.model import Settings
from sandbox.level.format.limits import SUBSTEPS
from sandbox.physics.arrays import Floats
from sandbox.physics.equation import frequency_from_coefficients
from sandbox.physics.settings import AUTO
from sandbox.physics.softness.body_motion import SpringMotion, errors_of, motion_of
from sandbox.physics.solvers import SOLVERS
from sandbox.session.commands import Command, SetSolver

SOLVER_TIPS = {
    "single_pass": "The article's loop: solves each spring once a tick; stiff things may explode",
    "iterative": "Solves each spring several times a tick; more iterations make things firmer",
    "direct": "Solves all springs at once; stiff things stay stiff and nothing explodes",
}
SOLVER_LABELS = {"single_pass": "Single pass", "iterative": "Iterative", "direct": "Direct"}
SEVERAL = "things stay as stiff and hold better"
_SOLVER = FieldInfo(
    "choice", "Solver", choices=tuple(SOLVERS), labels=tuple(SOLVER_LABELS.get(name, name) for name in SOLVERS),
    tips=tuple(SOLVER_TIPS.get(name, name) for name in SOLVERS),
)  # fmt: skip
_SUBSTEPS = FieldInfo(
    "choice", "Substeps", choices=(AUTO, *map(str, SUBSTEPS)), labels=("Auto", *map(str, SUBSTEPS)),
    tips=("Each tick uses as many as it needs, 1 to 8",
          *(f"A tick in {count}: {SEVERAL}" if count > 1 else "A tick in one" for count in SUBSTEPS)),
)  # fmt: skip
_RATE = replace(
    fields_of(Settings)["tick_rate"], title="Ticks/s", unit="",
    tooltip="Ticks a second; the run starts over when you change it.",
)  # fmt: skip
# Longest time that is looked at, and those that the curve may show [ticks].
LONGEST = 960
LENGTHS = (12, 30, 60, 120, 240, 480, LONGEST)
# Up to this many ticks each has a dot.
MOST_DOTS = 60
# Sizes in layout units.
TEXT_SIZE, CURVE_TOP, CURVE_BOTTOM, SIDE = 10.5, 17.0, 15.0, 4.0
CURVE_HEIGHT = 78.0


class EngineersRows:
    """What the rows show and do; change: the command that sets Cs and Cd of the chosen springs, an EditError if none.

    ask_rate: what is done with another tick rate that was typed.
    """

    def __init__(
        self, playback: Playback, owner: PropertyOwner, ask_rate: Callable[[str], None], firmness: FirmnessRows,
        change: Callable[[float, float], Command],
    ) -> None:  # fmt: skip
        self.playback, self._owner, self._ask_rate = playback, owner, ask_rate
        self._firmness, self._change = firmness, change
        self._swing: Swing = (None, None)
        self._shown: tuple[object, ...] = ()

    def build(self, rows: PanelRows) -> None:
        """Make the widgets."""
        self.form = rows.form(self._owner, self._sections())
        self.curve = ResponseCurve(rows.ui, rows.row(CURVE_HEIGHT, 8), rows.back)

    def refresh(self, is_look: bool) -> None:
        """Show how ticks are solved now, and how things swing."""
        fresh = (self.playback.session.world.settings, self._swing, self._firmness.swing)
        if fresh != self._shown:
            self._shown = fresh
            self.form.show(self._sections())
        self.form.refresh()

    def show_spring(self, coefficients: tuple[Floats, Floats] | None) -> None:
        """Show what Cs and Cd of the chosen springs mean for one of them; None: no spring is chosen."""
        if coefficients is None:
            self._swing = None, None
            self.curve.show_none("There is no spring here.")
        elif any(values.min() != values.max() for values in coefficients):
            self._swing = MIXED, MIXED
            self.curve.show_none("The springs differ in Cs or Cd.")
        else:
            stiffness, damping = (float(values[0]) for values in coefficients)
            rate = self.playback.session.world.settings.tick_rate
            self._swing = frequency_from_coefficients(stiffness, damping, 1.0 / rate)
            self.curve.show_spring((stiffness, damping), rate)
        self.refresh(False)

    def _sections(self) -> list[Section]:
        settings = self.playback.session.world.settings
        solving = [
            Property("solver", _SOLVER, settings.solver, lambda _, name: SetSolver(solver=name)),
            Property("substeps", _SUBSTEPS, str(settings.substeps), _set_substeps),
            *(Property(name, fields_of(Settings)[name], getattr(settings, name), partial(_set_iterative, name),
                       remark=_remark) for name in ("iterations", "warm_start")),
            Property("tick_rate", _RATE, settings.tick_rate, self._set_rate, scrubs=False),
        ]  # fmt: skip
        of_spring = swing_properties(self._swing, self._put)
        of_body = Section("Of the body", tuple(self._firmness.swing_properties()))
        found = [Section("", tuple(solving)), of_body, Section("Of one spring, alone", tuple(of_spring))]
        return found if self._firmness.shown else [found[0], found[2]]

    def _put(self, playback: Playback, hz: float, ratio: float) -> Command:
        return self._change(*coefficients_for(hz, ratio, 1.0 / playback.session.world.settings.tick_rate))

    def _set_rate(self, playback: Playback, rate: int) -> None:
        """Ask how to go on at another tick rate; the run has the old one until it starts over."""
        if in_range(_RATE, rate) != playback.session.world.settings.tick_rate:
            self._ask_rate(str(rate))


def _set_substeps(playback: Playback, count: str) -> Command:
    return SetSolver(substeps=AUTO if count == AUTO else int(count))


def _set_iterative(name: str, playback: Playback, value: float) -> Command:
    return SetSolver(**{name: in_range(fields_of(Settings)[name], value)})  # type: ignore[arg-type]


def _remark(playback: Playback, value: Any) -> str:
    return "" if playback.session.world.settings.solver == "iterative" else "only the iterative solver uses it"


class ResponseCurve(Widget):
    """The curve of one spring; it is worked out again where Cs, Cd or the tick rate change."""

    def __init__(self, ui: Ui, rect: pygame.Rect, container: Any = None) -> None:
        super().__init__(ui, rect, container)
        self._of: tuple[float, float, int] | None = None
        self.words = ""
        self.motion: SpringMotion | None = None
        self.errors = errors_of(0.0, 0.0, 1)

    def show_spring(self, pair: tuple[float, float], tick_rate: int) -> None:
        """Show the spring of Cs and Cd."""
        of = (*pair, tick_rate)
        if of != self._of:
            self._of, self.words, self.errors = of, "", errors_of(*pair, LONGEST)
            self.motion = motion_of(*pair, 1.0 / tick_rate)
            self.repaint()

    def show_none(self, words: str) -> None:
        """Write in the curve's place why there is no one spring to be shown."""
        if words != self.words:
            self._of, self.words = None, words
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The curve, the line of rest, and when it comes there."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        px, font = self.ui.px, self.ui.font(TEXT_SIZE)
        inside = pygame.Rect(px(SIDE), px(CURVE_TOP), size[0] - 2 * px(SIDE), size[1] - px(CURVE_TOP + CURVE_BOTTOM))
        pygame.draw.rect(surface, FIELD, inside, border_radius=px(4))
        if self._of is None or self.motion is None:
            text = font.render(self.words, True, MUTED)
            surface.blit(text, text.get_rect(center=inside.center))
            return surface
        rate, rest = self._of[2], self.motion.rest * self._of[2]
        shown = next((length for length in LENGTHS if rest <= 0.8 * length), LONGEST)
        title = font.render("One spring, let go", True, MUTED)
        surface.blit(title, (inside.left, 0))
        verdict = font.render(motion_words(self.motion), True, TEXT)
        surface.blit(verdict, verdict.get_rect(topright=(inside.right, 0)))
        for tick, label in ((0, "0"), (shown // 2, ""), (shown, f"{shown} ticks = {shown / rate:.3g} s")):
            x = inside.left + tick / shown * (inside.width - 1)
            pygame.draw.line(surface, DECADE, (x, inside.bottom - px(3)), (x, inside.bottom - 1))
            picture = font.render(label, True, MUTED)
            place = picture.get_rect(midtop=(x, inside.bottom))
            surface.blit(picture, place.clamp(pygame.Rect(inside.left, place.top, inside.width, place.height)))
        errors = self.errors[: shown + 1]
        lowest = min(-0.15, float(errors.min()) * 1.15)
        across = inside.left + np.arange(len(errors)) / shown * (inside.width - 1)
        down = inside.bottom - 1 - (errors - lowest) / (1.1 - lowest) * (inside.height - 2)
        zero = inside.bottom - 1 + lowest / (1.1 - lowest) * (inside.height - 2)
        pygame.draw.line(surface, DECADE, (inside.left, zero), (inside.right - 1, zero))
        points = np.stack([across, down], axis=1)
        pygame.draw.aalines(surface, ACCENT, False, points.tolist())
        if self.ui.scale >= 1.5:
            pygame.draw.aalines(surface, ACCENT, False, np.add(points, (0.0, 1.0)).tolist())
        if shown <= MOST_DOTS:
            for point in points.tolist():
                pygame.draw.aacircle(surface, ACCENT, point, max(1.5, 1.7 * self.ui.scale))
        return surface
