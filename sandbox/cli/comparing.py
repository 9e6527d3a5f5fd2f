"""`sandbox diff`, `sandbox bisect`, and the pages that they and `sandbox replay` write."""

import argparse
import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.inputs import EXIT_FAILED, EXIT_OK, Refused, is_replay, level_of, level_or_replay, recording_of
from sandbox.terminal import Progress, interrupted_between_ticks, seconds

if TYPE_CHECKING:
    from sandbox.level.format.model import Level
    from sandbox.physics.world import World
    from sandbox.session.player.report import Watched
    from sandbox.session.replay.difference import ComparedRun, RunDifference
    from sandbox.session.replay.recording import Replay
    from sandbox.session.replay.verify import Comparison
    from sandbox.session.session import Session

# How long two levels are compared where neither is a recording [s].
DIFF_SECONDS = 10.0
PAGE, PICTURE = ".html", ".png"


def add_diff_options(diff: argparse.ArgumentParser) -> None:
    """Options of `sandbox diff`."""
    diff.add_argument("first", metavar="A", help="a recording or a level")
    diff.add_argument("second", metavar="B", help="another; a level runs with the commands of the recording")
    diff.add_argument("--seconds", type=seconds, help="compare no more than this; of two levels default 10")
    diff.add_argument("--json", action="store_true", help="print one JSON object")
    text = "draw both where they part, or write a page that plays both"
    diff.add_argument("-o", "--output", type=Path, metavar="OUT.png|html", help=text)


def diff(options: argparse.Namespace) -> int:
    """Say where two runs part."""
    from sandbox.session.replay.difference import ComparedRun, difference
    from sandbox.session.replay.recording import ReplayError

    check_output(options.output)
    first, second = (ComparedRun(name, *level_or_replay(name)) for name in (options.first, options.second))
    rate = first.level.settings.tick_rate
    known = [side.replay.ticks for side in (first, second) if side.replay]
    length = None if options.seconds is None else round(options.seconds * rate)
    ticks = min([*known, *([length] if length else [])], default=round(DIFF_SECONDS * rate))
    try:
        with Progress(ticks) as bar, interrupted_between_ticks() as look_up:

            def after(done: int, total: int) -> None:
                bar.update(done - bar.done)
                look_up()

            found = difference(first, second, ticks, after)
    except ReplayError as error:
        raise Refused(*error.faults) from None
    if options.json:
        print(json.dumps(_json(options, found)))
    else:
        print(f"A  {options.first}\nB  {options.second}")
        print("\n".join(found.lines()))
    if options.output:
        _draw_difference((first, second), found, options.output)
    return EXIT_OK if found.is_equal else EXIT_FAILED


def check_output(path: Path | None) -> None:
    """Refuse a file that is neither a picture nor a page, before anything runs. Raises Refused."""
    if path is not None and path.suffix.lower() not in (PAGE, PICTURE):
        raise Refused(f"{path}: end the name in {PICTURE} or {PAGE}")


def _json(options: argparse.Namespace, found: "RunDifference") -> dict[str, Any]:
    from dataclasses import asdict

    from sandbox.session.probe import finite

    where = None if found.divergence is None else finite(asdict(found.divergence))
    return {"a": options.first, "b": options.second, "equal": found.is_equal, "level": list(found.level),
            "commands": list(found.commands), "divergence": where, "lines": found.lines()}  # fmt: skip


def _draw_difference(sides: "tuple[ComparedRun, ComparedRun]", found: "RunDifference", path: Path) -> None:
    from sandbox.session.player.page import PlayerPage
    from sandbox.session.player.report import command_marks, first_difference_shown, played

    ticks = found.ticks
    tick = found.divergence.tick if found.divergence else ticks
    if path.suffix.lower() == PICTURE:
        _draw_both(sides, found, tick, path)
    else:
        runs = [side.begin(other) for side, other in (sides, sides[::-1])]
        names = [f"{letter}  {side.name}" for letter, side in zip("AB", sides, strict=True)]
        with _watching(len(runs) * ticks) as watched:
            page = PlayerPage(
                f"{sides[0].name} and {sides[1].name}", *played(names, runs, ticks, tick, watched),
                marks=command_marks(sides[0].replay or sides[1].replay),
                difference=first_difference_shown(found.divergence, runs[0]), lines=found.lines(),
            )  # fmt: skip
        page.write(path)
    print(f"{path}: {path.stat().st_size / 1e6:.2f} MB")


def _draw_both(sides: "tuple[ComparedRun, ComparedRun]", found: "RunDifference", tick: int, path: Path) -> None:
    from sandbox.app.share.evidence import Shown, write_sides
    from sandbox.session.replay.divergence import differing_particle

    shown = []
    for letter, side, other, run in zip("AB", sides, sides[::-1], (found.left, found.right), strict=True):
        run = run or side.begin(other)
        while run.tick < tick:
            run.advance()
        state = run.snapshot()
        ring = differing_particle(found.divergence, state) if found.divergence else None
        shown.append(Shown(f"{letter}  {side.name}, tick {tick}", side.level, state, ring))
    write_sides(shown, path)


@contextmanager
def _watching(ticks: int) -> "Iterator[Watched]":
    """Show how far it is while so many ticks are played in all, and let Ctrl+C end it between two."""
    with Progress(ticks) as bar, interrupted_between_ticks() as look_up:

        def watched(states: "Iterable[World]") -> "Iterator[World]":
            for state in states:
                yield state
                bar.update()
                look_up()

        yield watched


def write_run(session: "Session", ticks: int, path: Path, name: str, replay: "Replay | None") -> str:
    """Write the page that plays one run, which has not begun; what was written."""
    from sandbox.session.player.page import PlayerPage
    from sandbox.session.player.report import command_marks, played

    with _watching(ticks) as watched:
        page = PlayerPage(name, *played([name], [session], ticks, watched=watched), marks=command_marks(replay))
    page.write(path)
    return f"{ticks / session.world.settings.tick_rate:g} s, {len(page.reels[0].ticks)} pictures"


def write_report(found: "Comparison", path: Path) -> None:
    """Write the page that plays the recorded run beside the one that diverged from it."""
    from sandbox.session.player.report import report_page

    with _watching(2 * found.replay.ticks) as watched:
        page = report_page(found, watched)
    page.write(path)


def add_bisect_options(bisect: argparse.ArgumentParser) -> None:
    """Options of `sandbox bisect`."""
    bisect.add_argument("level", metavar="LEVEL", help="one that holds")
    bisect.add_argument("bad", nargs="?", metavar="BAD", help="another that fails: which of its edits make it so?")
    text = "a field of the level with a value that holds and one that fails: where between them does it begin?"
    bisect.add_argument("--set", metavar="FIELD=GOOD:BAD", help=text)
    bisect.add_argument("--check", action="append", default=[], metavar="NAME", help="of the level's checks only this")
    bisect.add_argument("--replay", metavar="FILE", help="not the checks: whether this recording runs bit for bit")


def bisect(options: argparse.Namespace) -> int:
    """Find what makes a level fail."""
    from sandbox.level.faults.level_error import LevelError
    from sandbox.session.bisect import BisectError, Tried, checks_hold, deciding_edits, deciding_value, recording_holds

    if (options.bad is None) == (options.set is None):
        raise Refused("give a second level, BAD, or --set FIELD=GOOD:BAD")
    good = level_of(options.level)
    trial = recording_holds(recording_of(options.replay)) if options.replay else checks_hold(options.check)
    try:
        if options.set is None:
            work: Any = deciding_edits(good, _bad_level(options.bad), trial)
        else:
            field, first, last = _range(options.set)
            work = deciding_value(good, field, first, last, trial)
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
