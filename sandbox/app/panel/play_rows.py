"""The rows of the panel that play comes to first: melting, what is taken home, gravity and wind."""

import math
from collections.abc import Callable, Sequence

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.draw.colours import TEXT
from sandbox.app.panel.panel_rows import GAP, INSIDE, MARGIN, ROW, PanelRows
from sandbox.app.panel.readings import number
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.slider import Dial, Vector
from sandbox.app.widgets.texts import TextBlock
from sandbox.session.commands import Command, SetAir, SetGravity
from sandbox.tools.push_wind import LEAST_DRAG

# Sizes in layout units: of a dial, of what is beside it, and of the buttons.
DIAL, WORDS = 62.0, 54.0
HEIGHT = 62.0
# The Earth's gravity [m/s^2]; at the rims, twice that, and a gale [m/s].
EARTH, MOST_GRAVITY, MOST_WIND = 9.81, 2 * 9.81, 20.0
GRAVITY_TIP = "Gravity: drag the arrow to where things fall. The ring is the Earth's; in the middle they float"
WIND_TIP = "Wind: drag the arrow to where it blows. In the middle the air is as the level has it"


class PlayRows:
    """What the rows show and do, as far as hands may; melt: what melts springs or makes them whole.

    take_home: what shows the springs' numbers.
    """

    def __init__(self, playback: Playback, melt: Callable[[], None], take_home: Callable[[], None]) -> None:
        self.playback, self._melt, self._take_home = playback, melt, take_home
        self._gesture: int | None = None
        hands = playback.level.hands
        self._has_air, self._has_springs = (hands is None or hands.allows(deed) for deed in ("air", "solver"))

    def build(self, rows: PanelRows) -> None:
        """Make the widgets."""
        if self._has_air:
            self._build_air(rows)
        if self._has_springs:
            self._build_springs(rows)

    def _build_air(self, rows: PanelRows) -> None:
        half = (INSIDE - GAP) / 2
        own = self.playback.level.settings
        pulls, blows = (0.0, EARTH, math.hypot(*own.gravity)), (0.0, math.hypot(*own.wind))
        self.gravity, self._gravity_words = self._dial(
            rows, MARGIN, "Gravity", MOST_GRAVITY, pulls, self._pull, GRAVITY_TIP
        )
        self.wind, self._wind_words = self._dial(
            rows, MARGIN + half + GAP, "Wind", MOST_WIND, blows, self._blow, WIND_TIP
        )
        rows.row(HEIGHT, 8)

    def _build_springs(self, rows: PanelRows) -> None:
        ui, back, half = rows.ui, rows.back, (INSIDE - GAP) / 2
        self.melt = ui.button(rows.place(MARGIN, 0, half, ROW), "Melt", self._melt, back, tip=tip_of("melt", "play"))
        tip = "What these springs are in your own loop or engine: numbers and code to copy"
        place = rows.row(ROW, 10, MARGIN + half + GAP, half)
        self.take_home = ui.button(place, "Take home", self._take_home, back, tip=tip)

    def _dial(
        self, rows: PanelRows, x: float, name: str, full: float, marks: Sequence[float],
        changed: Callable[[float, float], None], tip: str,
    ) -> tuple[Dial, TextBlock]:  # fmt: skip
        beside, ui = x + DIAL + 8, rows.ui
        ui.label(rows.place(beside, 12, WORDS, 18), name, rows.back, "muted")
        words = TextBlock(ui, rows.place(beside, 31, WORDS, 32), "", rows.back, 12.0, TEXT)
        dial = Dial(ui, rows.place(x, 0, DIAL, DIAL), full, marks, changed, self._end, rows.back)
        dial.tip = tip
        return dial, words

    def refresh(self) -> None:
        """Show the world's present values."""
        world = self.playback.session.world
        settings = world.settings
        if self._has_springs:
            has_springs = bool((world.spring_active & (world.material >= 0)).any())
            for button in (self.melt, self.take_home):
                button.is_enabled = has_springs
            self.melt.show_text("Make whole" if settings.solver == "single_pass" else "Melt")
        if not self._has_air:
            return
        for dial, block, value, unit in (
            (self.gravity, self._gravity_words, settings.gravity, "m/s\u00b2"),
            (self.wind, self._wind_words, settings.wind, "m/s"),
        ):
            dial.show_value(value)
            strength = math.hypot(*value)
            block.show_text(f"{number(strength)} {unit}" if strength else "none")

    def _pull(self, x: float, y: float) -> None:
        self._submit(SetGravity((x, y)))

    def _blow(self, x: float, y: float) -> None:
        self._submit(SetAir((x, y), self._drag_for((x, y))))

    def _drag_for(self, wind: Vector) -> float:
        """The drag [1/s] of an air with that wind: enough to move things, and without a wind the level's own."""
        own = self.playback.level.settings.drag
        return max(own, LEAST_DRAG) if any(wind) else own

    def _submit(self, command: Command) -> None:
        if self._gesture is None:
            self._gesture = self.playback.session.new_gesture()
        self.playback.submit(command, self._gesture)

    def _end(self) -> None:
        self._gesture = None
