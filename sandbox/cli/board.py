"""`sandbox board`."""

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.base.command import Subcommand, argument, option, option_or
from sandbox.cli.base.inputs import EXIT_FAILED, EXIT_OK, Refused, require_address
from sandbox.processors import cores
from sandbox.terminal import Progress, plain, processes, seconds, tell

if TYPE_CHECKING:
    from sandbox.app.site.board_pages import RaceLinks
    from sandbox.session.board import Board

# How much time of the processor an entry has [s]. Solutions of shipped levels take up to three.
LIMIT = 60.0


@dataclass(frozen=True, kw_only=True)
class BoardOptions:
    """Options of `board`: the folder of entries, how they are run, and where the site goes."""

    folder: Path = argument(Path, "FOLDER", "of entries: recordings, text files with a link a line, and levels")
    output: Path | None = option(Path, "-o", metavar="SITE", help="write a site whose levels lead to their ranks")
    title: str = option_or("Board", str, help="what the site is called")
    address: str | None = option(
        str, metavar="ADDRESS", help="where the site will be, https://...; all links to races are whole then"
    )
    comment: Path | None = option(Path, metavar="FILE.md", help="write what is said as Markdown too, for a comment")
    processes: int | None = option(processes, metavar="N", help="at a time; default: one a processor")
    limit: float = option_or(LIMIT, seconds, metavar="SECONDS", help="of the processor that an entry has; default 60")


def board(options: BoardOptions) -> int:
    """Run all entries again, print who wins, and name all others with the reason. Raises Refused."""
    from sandbox.session.board import Board

    for folder in (options.folder, options.output):
        if folder is not None and not folder.is_dir() and (folder.exists() or folder is options.folder):
            raise Refused(f"{folder}: is no folder")
    links = None if options.address is None else _links(options.address)
    made = Board(options.folder)
    at_once = max(1, min(options.processes or cores(), len(made.entries)))
    with Progress(len(made.entries), "entry") as bar, closing(made.judge(at_once, options.limit)) as judging:
        for _ in judging:
            bar.update()
    for line in _lines(made, links):
        print(line)
    print(f"{len(made.wins)} of {len(made.entries)} entries win")
    tell(made.faults)
    if options.comment is not None:
        from sandbox.app.site.board_pages import comment_text
        from sandbox.level.format.writing import write_file

        write_file(options.comment, comment_text(made, list(map(plain, made.faults)), links).encode())
    if options.output is not None:
        from sandbox.app.site.board_pages import write_board

        with Progress(len(made.levels), "level") as bar:
            for _ in write_board(made, options.output, options.title, options.address):
                bar.update()
    return EXIT_FAILED if made.faults else EXIT_OK


def _links(address: str) -> "RaceLinks":
    """Links on a site that will be there. Raises Refused."""
    from sandbox.app.site.board_pages import RaceLinks

    require_address(address)
    return RaceLinks(address)


def _lines(board: "Board", links: "RaceLinks | None") -> Iterator[str]:
    """The ranks of each level that anybody has won, with links to race them."""
    from sandbox.session.board import rank_text

    for stem, level in board.levels.items():
        wins = board.ranks(stem)
        if wins:
            yield level.name
        for number, win in enumerate(wins, 1):
            yield f"  {number}. {win.entry.name}: {rank_text(level, win)} ({win.entry.place})"
            if links is not None:
                yield f"     {links.race(win) or 'too long for a link'}"


COMMAND = Subcommand("board", "run the entries of a folder again, and rank those that win", BoardOptions, board)
