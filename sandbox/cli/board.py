"""`sandbox board`."""

from dataclasses import dataclass
from pathlib import Path

from sandbox.cli.base.command import Subcommand, argument
from sandbox.cli.base.inputs import EXIT_FAILED, EXIT_OK, Refused
from sandbox.terminal import Progress, tell


@dataclass(frozen=True, kw_only=True)
class BoardOptions:
    """Options of `board`: the folder of entries, and where the site goes."""

    folder: Path = argument(Path, "FOLDER", "of entries: recordings, text files with a link a line, and levels")


def board(options: BoardOptions) -> int:
    """Run all entries again, print who wins, and name all others with the reason. Raises Refused."""
    from sandbox.session.board import Board, board_lines

    if not options.folder.is_dir():
        raise Refused(f"{options.folder}: is no folder")
    made = Board(options.folder)
    with Progress(len(made.entries), "entry") as bar:
        for entry in made.entries:
            made.judge(entry)
            bar.update()
    for line in board_lines(made):
        print(line)
    print(f"{len(made.wins)} of {len(made.entries)} entries win")
    tell(made.faults)
    return EXIT_FAILED if made.faults else EXIT_OK


COMMAND = Subcommand("board", "run the entries of a folder again, and rank those that win", BoardOptions, board)
