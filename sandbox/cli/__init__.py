"""The command line, a file a command. A command imports what it needs when it runs, so that --help answers at once."""

import argparse
import gc
import os
import re
import sys
from collections.abc import Iterable, Sequence
from typing import Any

from sandbox.cli import (
    bisect,
    board,
    bring,
    check,
    diff,
    edit,
    export,
    feel,
    format,
    info,
    link,
    page,
    play,
    render,
    replay,
    resume,
    run,
    schema,
    show,
    shrink,
    site,
    sweep,
    take_home,
    toy,
)
from sandbox.cli.base.command import Subcommand
from sandbox.cli.base.inputs import EXIT_INTERRUPTED, EXIT_REFUSED, EXIT_UNREAD, Refused
from sandbox.terminal import give_up_output, missing_folder, prepare_streams, refusal_of, tell
from sandbox.version import __version__

# In the order in which --help lists them.
COMMANDS: tuple[Subcommand[Any], ...] = (
    *(module.COMMAND for module in (play, toy, run, replay, info, resume, show, check, diff, bisect, shrink, sweep)),
    *(module.COMMAND for module in (render, page, site, board, link)), link.OPEN,
    *(module.COMMAND for module in (take_home, feel, export, bring, format, edit, schema)),
)  # fmt: skip
# Values of options that begin as numbers below zero do, such as -1,-1,1,1.
_BELOW_ZERO = re.compile(r"-(\d|\.\d|inf)")
# What the program does where no command is named.
USUAL = ("play",)
# Python searches for garbage after this many new objects, in place of 700: what is imported stays, and looking through
# it again and again was a sixth of a start. Objects that hold each other, as those do, are few in a run.
SEARCH_AFTER = 200_000


def program() -> int:
    """Run the command line as a process of its own, which ends after it; returns as `main`."""
    gc.set_threshold(SEARCH_AFTER, 5, 5)
    try:
        return main()
    finally:
        # What is left goes with the process.
        gc.freeze()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0, 1 a check failed or a replay diverged, 2 refused.

    130 interrupted, 141 what is printed is read no further.
    """
    prepare_streams()
    # No linear algebra of numpy's is used: its threads would only cost time, a tenth of a start.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    named = sys.argv[1:] if arguments is None else arguments
    try:
        try:
            code = _run(named or USUAL)
        finally:
            # Here, where it can still be told, and not as the process ends.
            sys.stdout.flush()
            sys.stderr.flush()
        return code
    except BrokenPipeError:
        give_up_output()
        return EXIT_UNREAD
    except OSError as error:
        give_up_output()
        return _refuse([refusal_of(error)])
    except KeyboardInterrupt:
        give_up_output()
        return EXIT_INTERRUPTED


def _run(arguments: Sequence[str]) -> int:
    parsed = _parser().parse_args(_joined(arguments))
    gone = missing_folder()
    if gone:
        return _refuse([gone])
    try:
        code: int = parsed.command.run(parsed)
        return code
    except Refused as refusal:
        return _refuse(refusal.faults)


def _joined(arguments: Sequence[str]) -> list[str]:
    """Arguments, a value that begins with a minus in one with its option: it would be taken for another option."""
    joined: list[str] = []
    for word in arguments:
        if _BELOW_ZERO.match(word) and joined and joined[-1].startswith("--") and "=" not in joined[-1]:
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _refuse(faults: Iterable[str]) -> int:
    tell(faults)
    return EXIT_REFUSED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="sandbox", description="A 2D physics sandbox of damped springs.")
    parser.add_argument("--version", action="version", version=f"sandbox {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in COMMANDS:
        command.add_to(commands)
    return parser
