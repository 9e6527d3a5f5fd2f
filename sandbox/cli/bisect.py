"""`sandbox bisect`."""

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sandbox.cli.base.command import Subcommand, argument, option, optional_argument, repeated_option
from sandbox.cli.base.inputs import EXIT_OK, Refused, is_replay, level_of, recording_of

if TYPE_CHECKING:
    from sandbox.level.document.model import Level


@dataclass(frozen=True, kw_only=True)
class BisectOptions:
    """Options of `bisect`: what to search between, and the check or recording that tells."""

    level: str = argument(str, "LEVEL", "one that holds")
    bad: str | None = optional_argument(str, "BAD", "another that fails: which of its edits make it so?")
    set: str | None = option(
        str,
        metavar="FIELD=GOOD:BAD",
        help="a field of the level with a value that holds and one that fails: where between them does it begin?",
    )
    check: list[str] = repeated_option(str, metavar="NAME", help="of the level's checks only this")
    replay: str | None = option(str, metavar="FILE", help="not the checks: whether this recording runs bit for bit")


def bisect(options: BisectOptions) -> int:
    """Find what makes a level fail."""
    from sandbox.level.format.level_error import LevelError
    from sandbox.session.bisect import BisectError, Tried, checks_hold, deciding_edits, deciding_value, recording_holds
    from sandbox.session.level_edits import field_place

    if (options.bad is None) == (options.set is None):
        raise Refused("give a second level, BAD, or --set FIELD=GOOD:BAD")
    good = level_of(options.level)
    trial = recording_holds(recording_of(options.replay)) if options.replay else checks_hold(options.check)
    try:
        if options.bad is not None:
            work: Any = deciding_edits(good, _bad_level(options.bad), trial)
        elif options.set is not None:
            field, first, last = _range(options.set)
            work = deciding_value(good, field_place(good, field), first, last, trial)
        for found in work:
            if isinstance(found, Tried):
                verdict = {True: "holds", False: "fails", None: "no level"}[found.holds]
                print(f"  {verdict:<9}{found.what}", flush=True)
    except (BisectError, LevelError) as error:
        raise Refused(*getattr(error, "faults", [str(error)])) from None
    if options.set is None:
        print("it fails with these edits, and holds without any one of them:")
        print("\n".join(f"  {edit}" for edit in found))
    else:
        print(f"{field}: holds at {found[0]!r}, fails at {found[1]!r}")
    return EXIT_OK


def _bad_level(name: str) -> "Level":
    if is_replay(name):
        raise Refused(f"{name}: is a recording; give levels, and a recording by --replay")
    return level_of(name)


def _range(text: str) -> tuple[str, float, float]:
    """The field and both values of FIELD=GOOD:BAD. Raises Refused."""
    field, _, values = text.partition("=")
    try:
        first, last = (json.loads(value) for value in values.split(":"))
        if not all(type(value) in (int, float) for value in (first, last)):
            raise ValueError
    except ValueError:
        raise Refused(f"--set: {text!r}: write FIELD=GOOD:BAD with two numbers, as settings.substeps=8:1") from None
    return field, first, last


COMMAND = Subcommand("bisect", "find the edit or value that makes a level fail", BisectOptions, bisect)
