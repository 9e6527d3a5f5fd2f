"""Race links: addresses at which a win is watched, and raced as a shade beside one's own run."""

from urllib.parse import quote

from sandbox.app.share.runs_for_pages import link_to
from sandbox.app.site.index_page import LEVELS
from sandbox.level.format.slices import at_once
from sandbox.session.judging import Win
from sandbox.session.replay.link import BEAT
from sandbox.session.replay.recording import ReplayError


class RaceLinks:
    """Links to wins on a site; site: its address, or where it lies from a page of it."""

    def __init__(self, site: str) -> None:
        self._site = site.rstrip("/")
        self._runs: dict[str, str | None] = {}

    def watch(self, win: Win) -> str | None:
        """Where a win is seen; None: it is too long for a link."""
        return self._link(win, "")

    def race(self, win: Win) -> str | None:
        """Where a win is raced."""
        return self._link(win, f"{BEAT}{quote(win.entry.name, safe='')}&")

    def _link(self, win: Win, before: str) -> str | None:
        place = win.entry.place
        if place not in self._runs:
            try:
                self._runs[place] = at_once(link_to(win.run, "", 0)).removeprefix("#")
            except ReplayError:
                self._runs[place] = None
        run = self._runs[place]
        return None if run is None else f"{self._site}/{LEVELS}/{quote(win.stem)}.html#{before}{run}"
