"""`sandbox shrink`."""

import json
import time
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.base.command import Subcommand, argument, flag, option
from sandbox.cli.base.inputs import EXIT_INTERRUPTED, EXIT_OK, Refused, level_of, recording_of
from sandbox.processors import cores
from sandbox.session.replay import smallest_test, stem_of
from sandbox.terminal import Progress, processes

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.session.replay.recording import Replay
    from sandbox.session.shrink.failures import Failure
    from sandbox.session.shrink.shrinker import Shrinker

RECORDING = ".replay.gz"
# Commands that are printed, at most.
MOST_SHOWN = 12


@dataclass(frozen=True, kw_only=True)
class ShrinkOptions:
    """Options of `shrink`: the recording, what fails in it, and where the smallest goes."""

    file: str = argument(str, "FILE", "a recording, also one that is cut off")
    check: str | None = option(str, metavar="NAME", help="this check of the level fails")
    crash: bool = flag("a tick ends in an exception")
    frozen: bool = flag("particles get impossible values and are frozen")
    lost: bool = flag("the goal of the level is lost")
    leaves: str | None = option(
        str, metavar="BOX", help="something leaves the level's `view`, or a box: left,bottom,right,top"
    )
    energy: float | None = option(float, metavar="J", help="the energy grows by more than this while nothing works")
    against: str | None = option(
        str,
        metavar="LEVEL",
        help="the run on this level differs from the recorded one; with another failure: run on this level",
    )
    apart: float | None = option(
        float, metavar="M", help="with --against: differs by this far; default: by 1 mm, or else in a bit"
    )
    output: Path | None = option(
        Path, "-o", metavar="OUT.replay.gz", help="default: the recording's name with .smallest, beside it"
    )
    processes: int | None = option(processes, metavar="N", help="try this many at a time; default: one for each core")
    json: bool = flag("print one JSON object")


def shrink(options: ShrinkOptions) -> int:
    """Make a failing recording as small as it gets."""
    from sandbox.session.shrink.failures import Diverges, FailureError
    from sandbox.session.shrink.shrinker import shrinker_against, shrinker_of

    replay = recording_of(options.file, partial=True)
    failure, level = _failure(options, replay)
    output = options.output or Path(stem_of(options.file) + ".smallest" + RECORDING)
    if not output.name.endswith(RECORDING):
        raise Refused(f"-o: {str(output)!r}: the name of a recording ends in {RECORDING}")
    try:
        if isinstance(failure, Diverges) and failure.apart is None:
            shrinker = shrinker_against(replay, failure.level)
        else:
            shrinker = shrinker_of(replay, failure, level)
    except FailureError as error:
        raise Refused(str(error)) from None
    if shrinker.seen is None:
        raise Refused(*_nothing(options.file, replay, failure, level or replay.level))
    started = time.monotonic()
    stopped = _work(shrinker, options)
    took = time.monotonic() - started
    written, place = _write(shrinker, options, level, output)
    if options.json:
        print(json.dumps(_data(shrinker, options, written, stopped)))
    else:
        print("\n".join(_lines(shrinker, options, took, stopped)))
        print(f"{written[0]}\n{written[1]}: the test runs on {place}")
    return EXIT_INTERRUPTED if stopped else EXIT_OK


def _failure(options: ShrinkOptions, replay: "Replay") -> "tuple[Failure, Level | None]":
    """The failure to look for, and the level to run on in place of the recorded one. Raises Refused."""
    from sandbox.session.shrink.failures import (
        AnyOf,
        CheckFails,
        Crashes,
        Diverges,
        EnergyGrows,
        Freezes,
        IsLost,
        usual_failures,
    )

    level = level_of(options.against) if options.against else None
    chosen: list[Failure] = []
    if options.check is not None:
        chosen.append(CheckFails(options.check))
    if options.crash:
        chosen.append(Crashes())
    if options.frozen:
        chosen.append(Freezes())
    if options.lost:
        chosen.append(IsLost())
    if options.leaves is not None:
        chosen.append(_leaving(options.leaves))
    if options.energy is not None:
        chosen.append(EnergyGrows(options.energy))
    if len(chosen) > 1:
        raise Refused("one failure at a time: of --check, --crash, --frozen, --lost, --leaves, --energy give one")
    if options.apart is not None and (level is None or chosen):
        raise Refused("--apart: is of two levels: give --against LEVEL and no other failure")
    if chosen:
        return chosen[0], level
    if level is not None:
        return Diverges(level, apart=options.apart), None
    return AnyOf(usual_failures(replay.level)), None


def _leaving(text: str) -> "Failure":
    from sandbox.session.shrink.failures import Leaves

    if text == "view":
        return Leaves()
    try:
        left, bottom, right, top = map(float, text.split(","))
    except ValueError:
        raise Refused(f"--leaves: {text!r}: write view, or left,bottom,right,top in metres") from None
    return Leaves((left, bottom, right, top))


def _nothing(name: str, replay: "Replay", failure: "Failure", level: "Level") -> list[str]:
    """The line that says why there is nothing to shrink."""
    from sandbox.level.checks import window_of
    from sandbox.session.compare.comparison import verify
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.shrink.failures import AnyOf, CheckFails

    looked = failure.failures if isinstance(failure, AnyOf) else (failure,)
    lines = [f"{name}: nothing to shrink: in {replay.ticks} ticks this does not come: {failure}"]
    names = {each.name for each in looked if isinstance(each, CheckFails)}
    rate = level.settings.tick_rate
    lines += [
        f'{name}: it ends after {replay.ticks / rate:g} s, and the check "{check.name}" measures until '
        f"{window_of(check)[1]:g} s"
        for check in level.checks
        if check.name in names and window_of(check)[1] * rate > replay.ticks
    ]
    if isinstance(failure, AnyOf):
        try:
            found = verify(replay)
        except ReplayError as error:
            return [*lines, *error.faults]
        if found is not None:
            lines.append(
                f"{name}: it diverges from its own bits at {found}; of other commands only the build that recorded it "
                "knows the bits. --against LEVEL compares two levels"
            )
        else:
            lines.append(f"{name}: name another failure: --against LEVEL, --leaves, --energy, --lost; see --help")
    return lines


def _work(shrinker: "Shrinker", options: ShrinkOptions) -> bool:
    """Shrink the recording as far as it goes; whether that was interrupted."""
    try:
        with Progress(None, " run") as bar, closing(shrinker.steps(options.processes or cores())) as steps:
            reported = None
            for _ in steps:
                bar.update()
                if shrinker.smallest is not reported:
                    reported = shrinker.smallest
                    bar.note(reported.counts())
    except KeyboardInterrupt:
        return True
    return False


def _write(shrinker: "Shrinker", options: ShrinkOptions, level: "Level | None", output: Path) -> tuple[list[Path], str]:
    """Write the recording and its test; these, and which level the test runs on."""
    from sandbox.session.shrink.failures import Diverges
    from sandbox.session.shrink.shrinker import seen_from, test_text, write_recording

    assert shrinker.seen is not None
    failure = shrinker.seen.failure
    write_recording(shrinker.smallest, shrinker.level, output)
    test = smallest_test(output)
    against = options.against
    present = None if against else _present_level(shrinker)
    found = Path(against) if against and Path(against).exists() else present
    place = seen_from(found, output.parent) if found else against
    levels: dict[str, str | None] = {"other" if isinstance(failure, Diverges) else "own": place}
    source = Path(options.file).name
    test.write_text(test_text(shrinker.smallest, failure, source, output, levels), encoding="utf-8")
    return [output, test], place or "the recorded level"


def _present_level(shrinker: "Shrinker") -> Path | None:
    """The level file in `levels` that has the title of the recorded one, and in which it still fails."""
    from sandbox.level.reading.files import LevelError, read_level
    from sandbox.session.shrink.failures import FailureError
    from sandbox.session.shrink.shrinker import Shrinker

    assert shrinker.seen is not None
    for path in sorted(Path("levels").glob("*.json")):
        try:
            level = read_level(path)
            if level.name == shrinker.level.name and Shrinker(level, shrinker.smallest, shrinker.seen.failure).seen:
                return path
        except (LevelError, FailureError):
            continue
    return None


def _lines(shrinker: "Shrinker", options: ShrinkOptions, took: float, stopped: bool) -> list[str]:
    from sandbox.session.shrink.passes import counted, short_json

    assert shrinker.seen is not None and shrinker.found is not None
    more = len(shrinker.smallest.lines) - MOST_SHOWN
    return [
        f"{options.file}: {shrinker.seen.failure}",
        f"  in the recording: {shrinker.found}",
        f"  from  {shrinker.original.counts()}",
        f"  to    {shrinker.smallest.counts()}, by {shrinker.tries:,} runs in {took:.1f} s"
        + (", interrupted: more may go" if stopped else ""),
        f"  {shrinker.seen}",
        *(f"  tick {line.tick:<5} {short_json(line.record)}" for line in shrinker.smallest.lines[:MOST_SHOWN]),
        *([f"  and {counted(more, 'command')} more"] if more > 0 else []),
        *([] if shrinker.smallest.lines else ["  it fails by itself, without any command"]),
    ]


def _data(shrinker: "Shrinker", options: ShrinkOptions, written: list[Path], stopped: bool) -> dict[str, Any]:
    assert shrinker.seen is not None and shrinker.found is not None
    names = ("gestures", "commands", "ticks")
    sizes = {
        when: dict(zip(names, (play.size[0], play.size[1], play.ticks), strict=True))
        for when, play in (("from", shrinker.original), ("to", shrinker.smallest))
    }
    return {
        "file": options.file, "failure": str(shrinker.seen.failure), "text": shrinker.seen.text,
        "in_recording": shrinker.found.text, **sizes,
        "runs": shrinker.tries, "interrupted": stopped, "written": [str(path) for path in written],
    }  # fmt: skip


COMMAND = Subcommand("shrink", "make a failing recording as small as it gets, and a test of it", ShrinkOptions, shrink)
