"""`sandbox page`."""

from dataclasses import dataclass
from pathlib import Path

from sandbox.cli.base.command import Subcommand, argument, needed_option
from sandbox.cli.base.inputs import EXIT_OK, Refused, level_or_replay
from sandbox.cli.base.running import PAGE


@dataclass(frozen=True, kw_only=True)
class PageOptions:
    """Options of `page`: the level or recording, and where the page goes."""

    level: str = argument(str, "LEVEL|REPLAY")
    output: Path = needed_option(Path, "-o", metavar="OUT.html")


def page(options: PageOptions) -> int:
    """Write the page, and tell how large it is. Raises Refused."""
    from sandbox.app.share.playing import page_of
    from sandbox.level.format.writing import write_file
    from sandbox.level.reading.files import level_path
    from sandbox.session.commands import CommandError

    if options.output.suffix.lower() != PAGE:
        raise Refused(f"{options.output}: end the name in {PAGE}")
    level, replay = level_or_replay(options.level)
    try:
        file = None if replay else Path(level_path(options.level))
        text = page_of(level, replay.script if replay else (), replay.ticks if replay else None, file)
    except CommandError as error:
        raise Refused(*(f"{options.level}: {fault}" for fault in error.faults)) from None
    write_file(options.output, text.encode())
    print(f"{options.output}: {len(text.encode()) / 1000:.0f} kB")
    return EXIT_OK


COMMAND = Subcommand(
    "page", "write a page that plays a level, or a recording that can be taken over, in any browser", PageOptions, page
)
