"""Links: a run in an address, for the page of its level: its commands, with kits in place of definitions of bodies."""

from collections.abc import Generator
from dataclasses import replace

from sandbox.app.share.runs_for_pages import is_for_pages, run_for_pages
from sandbox.level.document.model import Level
from sandbox.session.commands.command import CommandError
from sandbox.session.replay.link import fragment_of, level_record
from sandbox.session.replay.recording import Replay, ReplayError


def link_to(replay: Replay, site: str, at: int) -> Generator[float, None, str]:
    """A link to a recorded run on a site, which its page shows from a tick on; each slice gives the part done, 0..1.

    site: the address of the folder that `write_site` wrote; "": the fragment alone. What was undone is left out.
    Raises ReplayError.
    """
    if not all(map(is_for_pages, replay.script)):
        try:
            run = yield from run_for_pages(replay.level, replay.script, replay.ticks, lambda _: "")
        except CommandError as error:
            raise ReplayError(f"{replay.source}: {error}") from None
        replay = replace(replay, script=run.script)
    return f"{page_address(replay.level, site)}#{fragment_of(replay, at)}"


def page_address(level: Level, site: str) -> str:
    """The address of a level's page on a site, where it is a shipped level; else that of the site."""
    site, name = site.partition("#")[0], level_record(level)["level"]
    return f"{site.rstrip('/')}/levels/{name}.html" if site and isinstance(name, str) else site
