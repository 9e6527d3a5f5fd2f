"""`sandbox replay`."""

import json
import os
import sys
import time
from collections import deque
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.command import Subcommand
from sandbox.cli.inputs import EXIT_FAILED, EXIT_OK, EXIT_REFUSED, Refused, level_of, recording_of
from sandbox.cli.options import arguments, flag, option
from sandbox.cli.pages import PAGE, write_report
from sandbox.terminal import Progress, cores, processes, tell

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.physics.world import World

# A process that verifies recordings takes as long to start as some recordings take; fewer are not worth one.
FILES_PER_PROCESS = 8


@dataclass(frozen=True, kw_only=True)
class ReplayOptions:
    """Which recordings to verify, on what, and how to tell it."""

    files: list[str] = arguments(str, "FILE|FOLDER")
    json: bool = flag("print one JSON object a file")
    partial: bool = flag("verify what there is of a recording that is cut off")
    report: Path | None = option(Path, metavar="OUT.html", help="where it diverges, play both side by side")
    against: str | None = option(str, metavar="LEVEL", help="run their commands on this level, not on the recorded one")
    processes: int | None = option(
        processes, metavar="N", help="verify this many at a time; default: by cores and recordings"
    )


@dataclass(frozen=True)
class Verified:
    """What came of a recording: the exit code, and what is told of it."""

    code: int
    told: dict[str, Any]


def verify_files(options: ReplayOptions) -> int:
    """Verify recordings, one after another as they were named. Raises Refused."""
    names = _recordings(options.files)
    if options.against:
        level_of(options.against)
    if options.report and (len(names) > 1 or options.report.suffix.lower() != PAGE):
        raise Refused("--report: is of one recording, into a file whose name ends in .html")
    at_once = min(options.processes or max(1, min(cores(), len(names) // FILES_PER_PROCESS)), len(names))
    worst = EXIT_OK
    bar = Progress(len(names) if len(names) > 1 else 0, "recording")
    with bar, closing(_all_verified(names, at_once, options)) as results:
        for name, found in zip(names, results, strict=True):
            with bar.aside():
                if options.json:
                    print(json.dumps(found.told))
                elif found.code != EXIT_REFUSED:
                    print(f"{name}: {found.told['text']}")
                sys.stdout.flush()
                if not options.json:
                    tell(found.told.get("faults", ()))
            worst = max(worst, found.code)
            bar.update()
    return worst


def _recordings(names: Sequence[str]) -> list[str]:
    """The files that are named, and those in the folders that are. Raises Refused."""
    from sandbox.session.replay.names import RECORDINGS, recordings_in

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
    given = options.partial, options.against, options.report
    if at_once == 1:
        yield from (_verified(name, *given, shows=len(names) == 1) for name in names)
        return
    from sandbox.session.worker_pool import interrupts_ignored, worker_pool

    with worker_pool(at_once) as workers:
        with interrupts_ignored():
            waiting = [workers.submit(_verified, name, *given) for name in names]
        yield from (each.result() for each in waiting)


def _verified(name: str, partial: bool, against: str | None, report: Path | None, shows: bool = False) -> Verified:
    """Verify a recording; shows: with a bar of its own."""
    start = time.perf_counter()
    try:
        found = _compared(name, partial, level_of(against) if against else None, report, shows)
    except Refused as refusal:
        found = Verified(EXIT_REFUSED, {"file": name, "result": "refused", "faults": list(refusal.faults)})
    return Verified(found.code, {**found.told, "wall_seconds": time.perf_counter() - start})


def _compared(name: str, partial: bool, level: "Level | None", report: Path | None, shows: bool) -> Verified:
    """Verify a recording. Raises Refused."""
    from sandbox.session.outcome import outcome, outcome_data, outcome_text
    from sandbox.session.probe import finite
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.replay.verify import compare

    replay = recording_of(name, partial)
    worlds: deque[World] = deque(maxlen=1)
    try:
        with Progress(replay.ticks if shows else 0) as bar:
            found = compare(
                replay, level=level, on_tick=worlds.append, progress=lambda done, total: bar.update(done - bar.done)
            )
    except ReplayError as error:
        raise Refused(*error.faults) from None
    if found is None:
        cut = " (cut off: verified as far as it goes)" if replay.end_hash is None else ""
        played = level or replay.level
        ended, rate = outcome(played, worlds[0]) if worlds else None, played.settings.tick_rate
        said = "" if ended is None else f", {outcome_text(ended, rate)}"
        data = {"outcome": outcome_data(ended, rate)} if played.rules else {}
        at_end = "" if replay.compared == "every tick" else " at its end"
        text = f"equal{at_end}, {replay.ticks} ticks{cut}{said}"
        return Verified(EXIT_OK, {"file": name, "result": "equal", "ticks": replay.ticks, "text": text, **data})
    if report is not None:
        write_report(found, report)
    details = finite({**asdict(found.divergence), "text": f"diverged at {found.divergence}"})
    return Verified(EXIT_FAILED, {"file": name, "result": "diverged", **details})


COMMAND = Subcommand("replay", "run recordings again and compare every bit", ReplayOptions, verify_files)
