"""Quality: what of a picture is left out while frames come late, or because the person wants it so."""

# A frame's work may take so long [s], on average over so many frames, before something is left out.
LATE, OVER = 0.02, 45


class Quality:
    """Which of shadows and effects (dust, sparks) a run is drawn with; shadows go first, and nothing comes back."""

    def __init__(self) -> None:
        self._spent = 0.0
        self._frames = self._left_out = 0

    def note(self, work: float) -> None:
        """Take into account how long a frame's work took [s]."""
        self._spent += work
        self._frames += 1
        if self._frames == OVER:
            self._left_out += self._spent > OVER * LATE
            self._spent, self._frames = 0.0, 0

    def shadows(self, chosen: str) -> bool:
        """Whether shadows are drawn; chosen: "auto", "on" or "off"."""
        return chosen == "on" or (chosen == "auto" and self._left_out < 1)

    def effects(self, chosen: str, motion: str) -> bool:
        """Whether dust and sparks are drawn; motion: "full" or "less"."""
        return motion == "full" and (chosen == "on" or (chosen == "auto" and self._left_out < 2))
