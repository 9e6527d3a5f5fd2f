"""`sandbox replay`."""

import json
import os
import shlex
import sys
import time
from collections import deque
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.base.command import Subcommand, arguments, flag, option
from sandbox.cli.base.inputs import EXIT_FAILED, EXIT_OK, EXIT_REFUSED, Refused, level_of, recording_of
from sandbox.cli.base.running import PAGE, watching
from sandbox.processors import cores
from sandbox.terminal import Progress, count, processes, shortened, tell

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.physics.world import World
    from sandbox.session.compare.comparison import Comparison
    from sandbox.session.compare.divergence import Divergence
    from sandbox.session.player.report import ReportedFailure
    from sandbox.session.replay.recording import Replay

# A process that verifies recordings takes as long to start as some recordings take; fewer are not worth one.
FILES_PER_PROCESS = 8


@dataclass(frozen=True, kw_only=True)
class ReplayOptions:
    """Options of `replay`: recordings to verify, on what, and the form of the report."""

    files: list[str] = arguments(str, "FILE|FOLDER")
    json: bool = flag("print one JSON object a file")
    partial: bool = flag("verify what there is of a recording that is cut off")
    report: Path | None = option(
        Path, metavar="OUT.html", help="a page of all that fail, each with cause, distance and both runs"
    )
    github: bool = flag("annotate files on GitHub, and write the summary of the job")
    to_end: bool = flag("where it diverges, go on to the end: how far apart, and does it heal or grow?")
    against: str | None = option(
        str,
        metavar="LEVEL|FOLDER",
        help="run their commands on this level, or on the nearest of their level's name in a folder",
    )
    rollback: int | None = option(
        count, metavar="N", help="at every tick also go back N ticks, by a snapshot, and compare when there again"
    )
    processes: int | None = option(
        processes, metavar="N", help="verify this many at a time; default: by cores and recordings"
    )


@dataclass(frozen=True)
class Verified:
    """The result of a recording: the exit code, its report, and what the page of all failures has of it."""

    code: int
    report: dict[str, Any]
    failure: "ReportedFailure | None" = None


def verify_files(options: ReplayOptions) -> int:
    """Verify recordings, one after another as they were named. Raises Refused."""
    names = _recordings(options.files)
    if options.against and not os.path.isdir(options.against):
        level_of(options.against)
    if options.report and options.report.suffix.lower() != PAGE:
        raise Refused(f"--report: {options.report}: end the name in {PAGE}")
    at_once = min(options.processes or max(1, min(cores(), len(names) // FILES_PER_PROCESS)), len(names))
    worst, failures = EXIT_OK, []
    bar = Progress(len(names) if len(names) > 1 else 0, "recording")
    with bar, closing(_all_verified(names, at_once, options)) as results:
        for name, found in zip(names, results, strict=True):
            with bar.aside():
                if options.json:
                    print(json.dumps(found.report))
                elif found.code != EXIT_REFUSED:
                    print(f"{shortened(name)}: {found.report['text']}")
                sys.stdout.flush()
                if not options.json:
                    tell(found.report.get("faults", ()))
            worst = max(worst, found.code)
            failures += [found.failure] if found.failure else []
            bar.update()
    if options.report:
        from sandbox.session.player.report import write_report

        line = write_report(failures, len(names), options.report)
        # What is printed beside it may be read by programs.
        tell([line]) if options.json else print(line)
    if options.github:
        from sandbox.session.player.github import tell_github

        print("\n".join(tell_github(failures, len(names), Path.cwd())))
    return worst


def _tells_failures(options: ReplayOptions) -> bool:
    """Whether more is asked for of what fails than its lines."""
    return options.report is not None or options.github


def _recordings(names: Sequence[str]) -> list[str]:
    """The files that are named, and those in the folders that are. Raises Refused."""
    from sandbox.session.replay import RECORDINGS, recordings_in

    found: list[str] = []
    for name in names:
        if not os.path.isdir(name):
            found.append(name)
            continue
        inside = recordings_in(Path(name))
        if not inside:
            raise Refused(f"{name}: there is no recording in this folder; their names end in {', '.join(RECORDINGS)}")
        found += map(str, inside)
    return found


def _all_verified(names: Sequence[str], at_once: int, options: ReplayOptions) -> Generator[Verified, None, None]:
    from sandbox.session.worker_pool import done_in_order

    return done_in_order(_verified, [(name, options, len(names) == 1) for name in names], at_once)


def _verified(name: str, options: ReplayOptions, shows: bool) -> Verified:
    """Verify a recording; shows: with bars of its own."""
    from sandbox.session.replay.recording import ReplayError

    start = time.perf_counter()
    try:
        found = _compared(name, options, shows)
    except (Refused, ReplayError) as error:
        found = Verified(EXIT_REFUSED, {"file": name, "result": "refused", "faults": list(error.faults)})
    failure = found.failure
    if _tells_failures(options) and failure is None and found.code != EXIT_OK:
        from sandbox.session.player.report import ReportedFailure

        failure = ReportedFailure(name, tuple(found.report.get("faults") or found.report["text"].splitlines()))
    return Verified(found.code, {**found.report, "wall_seconds": time.perf_counter() - start}, failure)


def _compared(name: str, options: ReplayOptions, shows: bool) -> Verified:
    """Verify a recording. Raises Refused and ReplayError."""
    from sandbox.session.compare.comparison import compare
    from sandbox.session.compare.rollback import roll_back

    replay = recording_of(name, options.partial)
    level = _level_against(options.against, replay) if options.against else None
    worlds: deque[World] = deque(maxlen=1)
    with _progress(replay, shows) as bar:
        found = compare(replay, level=level, on_tick=worlds.append, progress=_onward(bar))
    if found is not None:
        return _diverged(name, found, options, shows)
    if options.rollback:
        with _progress(replay, shows) as bar:
            again = roll_back(replay, options.rollback, level, _onward(bar)).found
        if again is not None:
            return _failed(name, again, f"rolled back {options.rollback} ticks, diverged at {again}")
    return _equal(name, replay, replay.on(level), worlds[0] if worlds else None, options.rollback)


def _level_against(name: str, replay: "Replay") -> "Level":
    """The level that --against names, a recording's own of a folder. Raises Refused."""
    from sandbox.level.reading.files import LevelError
    from sandbox.session.replay.nearest_level import level_in

    try:
        return level_in(Path(name), replay) if os.path.isdir(name) else level_of(name)
    except LevelError as error:
        raise Refused(*error.faults) from None


def _progress(replay: "Replay", shows: bool) -> Progress:
    return Progress(replay.ticks if shows else 0)


def _onward(bar: Progress) -> Callable[[int, int], None]:
    return lambda done, total: bar.update(done - bar.done)


def _equal(name: str, replay: "Replay", level: "Level", end: "World | None", rollback: int | None) -> Verified:
    from sandbox.session.outcome import outcome, outcome_data, outcome_text

    cut = " (cut off: verified as far as it goes)" if replay.end_hash is None else ""
    ended, rate = outcome(level, end) if end is not None else None, level.settings.tick_rate
    said = "" if ended is None else f", {outcome_text(ended, rate)}"
    data = {"outcome": outcome_data(ended, rate)} if level.rules else {}
    at_end = "" if replay.compared == "every tick" else " at its end"
    back = f", and again from {rollback} ticks before each" if rollback else ""
    text = f"equal{at_end}, {replay.ticks} ticks{back}{cut}{said}"
    return Verified(EXIT_OK, {"file": name, "result": "equal", "ticks": replay.ticks, "text": text, **data})


def _diverged(name: str, found: "Comparison", options: ReplayOptions, shows: bool) -> Verified:
    from sandbox.session.compare.comparison import to_the_end

    text, more, failure = "\n  ".join([f"diverged at {found.divergence}", *found.edits]), {}, None
    if options.to_end or _tells_failures(options):
        with _progress(found.replay, shows) as bar:
            found = to_the_end(found, _onward(bar))
    if options.to_end:
        distance = [*found.distance.lines_of_all(), found.distance.verdict()] if found.distance else []
        text = "\n  ".join([text, *distance])
    if _tells_failures(options):
        from sandbox.session.player.report import ReportedFailure

        against = ["--replay-against", options.against or "own"]
        accept = f"to accept: {shlex.join(['pytest', '--replay-update', *against, name])}"
        with watching(2 * found.replay.ticks if shows else 0) as watched:
            failure = ReportedFailure.of(name, [found.cause(), *found.lines(), accept], found, watched)
    if found.distance:
        more = {"apart": found.distance.data()}
    return replace(_failed(name, found.divergence, text, **more), failure=failure)


def _failed(name: str, found: "Divergence", text: str, **more: Any) -> Verified:
    """A difference, with a text that tells it."""
    from sandbox.session.probe import finite

    details: dict[str, Any] = finite({**asdict(found), "text": text, **more})
    return Verified(EXIT_FAILED, {"file": name, "result": "diverged", **details})


COMMAND = Subcommand("replay", "run recordings again and compare every bit", ReplayOptions, verify_files)
