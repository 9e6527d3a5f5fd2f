"""Limits: figures told beside what they are to be, and whether any of them was broken."""


class Limits:
    """Tells figures."""

    def __init__(self) -> None:
        self.broken = False

    def at_most(self, what: str, value: float, most: float) -> None:
        """Tell a figure that is to be no more than that."""
        self._tell(what, value, f"at most {most:g}", value <= most)

    def at_least(self, what: str, value: float, least: float) -> None:
        """Tell a figure that is to be no less than that."""
        self._tell(what, value, f"at least {least:g}", value >= least)

    def _tell(self, what: str, value: float, limit: str, kept: bool) -> None:
        self.broken = self.broken or not kept
        print(f"{what}: {value:.4g} ({limit}{'' if kept else ', BROKEN'})", flush=True)
