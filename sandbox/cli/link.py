"""`sandbox link`."""

from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand
from sandbox.cli.base.inputs import EXIT_OK, Refused, recording_of
from sandbox.cli.base.options import argument, option_or


@dataclass(frozen=True, kw_only=True)
class LinkOptions:
    """A link to which run, and on which site."""

    replay: str = argument(str, "REPLAY")
    site: str = option_or("", str, metavar="ADDRESS", help="what comes before the #: where `sandbox site` was put")


def link(options: LinkOptions) -> int:
    """Print a link that holds a recorded run. Raises Refused."""
    from sandbox.session.link.scene_link import fragment_of
    from sandbox.session.replay.recording import ReplayError

    replay = recording_of(options.replay)
    try:
        print(f"{options.site.partition('#')[0]}#{fragment_of(replay)}")
    except ReplayError as error:
        raise Refused(*error.faults) from None
    return EXIT_OK


COMMAND = Subcommand("link", "print a link that holds a recorded run, for replay and play", LinkOptions, link)
