"""MeltLesson: jellies whose springs are solved one by one, and melt; and all at once, and are whole again."""

from typing import ClassVar

from sandbox.app.base.loop import Profile
from sandbox.app.contracts.screen import Pixel
from sandbox.app.play.play_screen import PlayScreen
from sandbox.app.play.run_actions import MELTED, WHOLE, is_melted
from sandbox.app.play.toolbar import BAR_HEIGHT
from sandbox.app.widgets.ui import Ui

# Size of the button, and how far it is below the bar [layout units].
SIZE, TOP = (190.0, 40.0), 16.0
LABELS = {False: "Melt them", True: "Make them whole"}


class MeltLesson(PlayScreen):
    """The lesson about melting springs: one button over the stage."""

    welcome: ClassVar[str] = (
        "Let the jellies settle, then melt them: the very same Cs and Cd, solved one spring after another."
    )
    # Below the button.
    again_top = 72.0

    def build(self, ui: Ui) -> None:
        """Lay everything out again, and the button in the middle of the stage's top."""
        super().build(ui)
        left = (self.viewport[0] + self.viewport[2] / 2) / ui.scale - SIZE[0] / 2
        self._is_melted = is_melted(self.playback)
        tip = f"{MELTED} {WHOLE}"
        place = ui.rect(left, BAR_HEIGHT + TOP, *SIZE)
        self.melt = ui.button(place, LABELS[self._is_melted], self.toggle_melt, style="primary", tip=tip)

    def update(self, frame_time: float, pointer: Pixel | None, profile: Profile) -> None:
        """Let time pass, and say on the button what it does now."""
        super().update(frame_time, pointer, profile)
        if is_melted(self.playback) != self._is_melted:
            self._is_melted = not self._is_melted
            self.melt.show_text(LABELS[self._is_melted])
