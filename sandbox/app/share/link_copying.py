"""LinkCopying: puts a link to the run so far on the clipboard; a person says on which site it is opened."""

import time
from collections.abc import Generator

from sandbox.app.base.desktop import copy_text
from sandbox.app.contracts.application import Application
from sandbox.app.draw.colours import ACCENT, Colour
from sandbox.app.share.links import link_to
from sandbox.app.widgets.dialogs import ask
from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands.records import script_of
from sandbox.session.replay.link import run_of
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session

# Under what the address of a site is remembered.
SITE = "link_site"
# Wall time [s] of a frame.
BUDGET = 0.02
HINT = (
    "The address of the site where the page of this level lies (sandbox site writes one). Empty: the run alone, "
    "for sandbox open."
)


class LinkCopying:
    """One link at a time; `update` goes on with it a slice a frame."""

    def __init__(self, app: Application) -> None:
        self._app = app
        self._slices: Generator[float, None, str] | None = None
        self._done = 0.0

    def ask(self) -> None:
        """Ask for the site, and begin."""
        if self._app.play is None:
            self._app.say("There is nothing to share yet: play a level first.")
            return
        site = preference(SITE)
        known = site if isinstance(site, str) else ""
        ask(self._app.ui, "Copy a link to this run", HINT, known, "Copy link", self._begin)

    def status(self) -> list[tuple[str, Colour]]:
        """What the status line says of the work."""
        return [] if self._slices is None else [(f"making the link: {100.0 * self._done:.0f} %", ACCENT)]

    def _begin(self, site: str) -> str | None:
        if site and not site.startswith(("https://", "http://")):
            return "An address begins with https://"
        play = self._app.play
        if play is not None:
            set_preference(SITE, site)
            self._slices = link_to(so_far(play.playback.session), site, 0)
        return None

    @property
    def moves(self) -> bool:
        """Whether it is at work."""
        return self._slices is not None

    def update(self) -> None:
        """Go on with the work for a part of a frame."""
        end = time.perf_counter() + BUDGET
        while self._slices is not None and time.perf_counter() < end:
            try:
                self._done = next(self._slices)
            except StopIteration as done:
                self._slices = None
                self._copy(done.value)
            except ReplayError as error:
                self._slices = None
                self._app.say(f"No link: {error.faults[0].removeprefix('the run: ')}.")

    def _copy(self, link: str) -> None:
        copied = copy_text(link)
        self._app.say(f"The link is copied, {len(link):,} characters." if copied else "No clipboard was found.")


def so_far(session: Session) -> Replay:
    """The run of a session until its present tick; what was undone is left out."""
    entries = [entry for entry in session.history.timeline if entry.in_effect and entry.tick <= session.tick]
    script = script_of(entries, session.world)
    return run_of("the run", session.level, script, session.tick, state_hash(session.world))
