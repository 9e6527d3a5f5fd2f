"""`sandbox board`."""

from dataclasses import dataclass
from pathlib import Path

from sandbox.cli.base.command import Subcommand, argument, option, option_or
from sandbox.cli.base.inputs import EXIT_FAILED, EXIT_OK, Refused
from sandbox.terminal import Progress, tell


@dataclass(frozen=True, kw_only=True)
class BoardOptions:
    """Options of `board`: the folder of entries, and where the site goes."""

    folder: Path = argument(Path, "FOLDER", "of entries: recordings, text files with a link a line, and levels")
    output: Path | None = option(Path, "-o", metavar="SITE", help="write a site whose levels lead to their ranks")
    title: str = option_or("Board", str, help="what the site is called")


def board(options: BoardOptions) -> int:
    """Run all entries again, print who wins, and name all others with the reason. Raises Refused."""
    from sandbox.session.board import Board, board_lines

    for folder in (options.folder, options.output):
        if folder is not None and not folder.is_dir() and (folder.exists() or folder is options.folder):
            raise Refused(f"{folder}: is no folder")
    made = Board(options.folder)
    with Progress(len(made.entries), "entry") as bar:
        for entry in made.entries:
            made.judge(entry)
            bar.update()
    for line in board_lines(made):
        print(line)
    print(f"{len(made.wins)} of {len(made.entries)} entries win")
    tell(made.faults)
    if options.output is not None:
        from sandbox.app.site.board_pages import write_board

        with Progress(len(made.levels), "level") as bar:
            for _ in write_board(made, options.output, options.title):
                bar.update()
    return EXIT_FAILED if made.faults else EXIT_OK


COMMAND = Subcommand("board", "run the entries of a folder again, and rank those that win", BoardOptions, board)
