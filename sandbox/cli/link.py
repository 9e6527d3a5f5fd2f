"""`sandbox link` and `sandbox open`."""

from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand, WindowOptions, argument, option_or
from sandbox.cli.base.inputs import EXIT_OK, Refused, recording_of
from sandbox.cli.play import PlayOptions, play
from sandbox.terminal import seconds


@dataclass(frozen=True, kw_only=True)
class LinkOptions:
    """A link to which run, and on which site."""

    replay: str = argument(str, "REPLAY")
    site: str = option_or("", str, metavar="ADDRESS", help="where the folder of `sandbox site` lies on the web")
    at: float = option_or(0.0, seconds, help="from when on a page shows it")


def link(options: LinkOptions) -> int:
    """Print a link that holds a recorded run. Raises Refused."""
    from sandbox.app.share.runs_for_pages import link_to
    from sandbox.level.format.slices import at_once
    from sandbox.session.replay.recording import ReplayError

    replay = recording_of(options.replay)
    at = round(options.at * replay.level.settings.tick_rate)
    if at > replay.ticks:
        raise Refused(f"--at {options.at:g} s is behind the end of the run, {replay.ticks} ticks")
    try:
        print(at_once(link_to(replay, options.site, at)))
    except ReplayError as error:
        raise Refused(*error.faults) from None
    return EXIT_OK


COMMAND = Subcommand("link", "print a link that holds a recorded run, for replay and play", LinkOptions, link)


@dataclass(frozen=True, kw_only=True)
class OpenOptions(WindowOptions):
    """Options of `open-link`: the link, and how to open it."""

    link: str = argument(str, "LINK", "a link to a run, with or without the address before its #")


def open_link(options: OpenOptions) -> int:
    """Open the app with the run of a link. Raises Refused."""
    from sandbox.session.replay.link import is_link

    if not is_link(options.link):
        raise Refused(
            f"{options.link[:60]}: is no link to a run; it has no #scene=. sandbox play opens files and levels"
        )
    settings = {name: getattr(options, name) for name in WindowOptions.__dataclass_fields__}
    return play(PlayOptions(level=options.link, profile=False, seconds=None, **settings))


OPEN = Subcommand("open", "open the app with the run of a link", OpenOptions, open_link)
