"""`sandbox open`."""

from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand, WindowOptions, argument
from sandbox.cli.base.inputs import Refused
from sandbox.cli.play import PlayOptions, play


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


COMMAND = Subcommand("open", "open the app with the run of a link", OpenOptions, open_link)
