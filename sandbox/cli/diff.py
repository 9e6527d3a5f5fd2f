"""`sandbox diff`."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.base.command import Subcommand, argument, flag, option
from sandbox.cli.base.inputs import EXIT_FAILED, EXIT_OK, Refused, level_or_replay
from sandbox.cli.base.running import PAGE, watching
from sandbox.terminal import Progress, interrupted_between_ticks, seconds, shortened

if TYPE_CHECKING:
    from sandbox.session.compare.comparison import ComparedRun, RunDifference

# How long two levels are compared where neither is a recording [s].
DIFF_SECONDS = 10.0
PICTURE = ".png"


@dataclass(frozen=True, kw_only=True)
class DiffOptions:
    """Options of `diff`: the two runs, for how long, and the form of the report."""

    first: str = argument(str, "A", "a recording or a level")
    second: str = argument(str, "B", "another; a level runs with the commands of the recording")
    seconds: float | None = option(seconds, help="compare no more than this; of two levels default 10")
    json: bool = flag("print one JSON object")
    output: Path | None = option(
        Path, "-o", metavar="OUT.png|html", help="draw both where they part, or write a page that plays both"
    )


def diff(options: DiffOptions) -> int:
    """Say where two runs part."""
    from sandbox.session.compare.comparison import ComparedRun, difference
    from sandbox.session.replay.recording import ReplayError

    _check_output(options.output)
    first, second = (
        ComparedRun(shortened(name), *level_or_replay(name, retold=True)) for name in (options.first, options.second)
    )
    if options.output and (first.is_old or second.is_old):
        raise Refused(f"{options.output}: a recording of another physics version cannot be played or drawn here")
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
        print(f"A  {first.name}\nB  {second.name}")
        print("\n".join(found.lines()))
    if options.output:
        _draw_difference((first, second), found, options.output)
    return EXIT_OK if found.is_equal else EXIT_FAILED


def _check_output(path: Path | None) -> None:
    """Refuse a file that is neither a picture nor a page, before anything runs. Raises Refused."""
    if path is not None and path.suffix.lower() not in (PAGE, PICTURE):
        raise Refused(f"{path}: end the name in {PICTURE} or {PAGE}")


def _json(options: DiffOptions, found: "RunDifference") -> dict[str, Any]:
    from dataclasses import asdict

    from sandbox.session.probe import finite

    where = None if found.divergence is None else finite(asdict(found.divergence))
    distance = {} if found.distance is None else {"apart": finite(found.distance.data())}
    return {"a": options.first, "b": options.second, "equal": found.is_equal, "level": list(found.level),
            "commands": list(found.commands), "divergence": where, "lines": found.lines(), **distance}  # fmt: skip


def _draw_difference(sides: "tuple[ComparedRun, ComparedRun]", found: "RunDifference", path: Path) -> None:
    from sandbox.session.player.page import PlayerPage, command_marks, first_difference_shown, played

    ticks = found.ticks
    tick = found.divergence.tick if found.divergence else ticks
    if path.suffix.lower() == PICTURE:
        _draw_both(sides, found, tick, path)
    else:
        runs = [side.begin(other) for side, other in (sides, sides[::-1])]
        names = [f"{letter}  {side.name}" for letter, side in zip("AB", sides, strict=True)]
        with watching(len(runs) * ticks) as watched:
            page = PlayerPage(
                f"{sides[0].name} and {sides[1].name}", *played(names, runs, ticks, tick, watched),
                marks=command_marks(sides[0].replay or sides[1].replay),
                difference=first_difference_shown(found.divergence, runs[0]), lines=found.lines(),
            )  # fmt: skip
        page.write(path)
    print(f"{path}: {path.stat().st_size / 1e6:.2f} MB")


def _draw_both(sides: "tuple[ComparedRun, ComparedRun]", found: "RunDifference", tick: int, path: Path) -> None:
    from sandbox.app.share.evidence import Shown, write_sides
    from sandbox.session.compare.divergence import differing_particle

    shown = []
    for letter, side, other, run in zip("AB", sides, sides[::-1], (found.expected, found.actual), strict=True):
        run = run or side.begin(other)
        while run.tick < tick:
            run.advance()
        state = run.snapshot()
        ring = differing_particle(found.divergence, state) if found.divergence else None
        shown.append(Shown(f"{letter}  {side.name}, tick {tick}", side.level, state, ring))
    write_sides(shown, path)


COMMAND = Subcommand("diff", "say where two recordings or levels part", DiffOptions, diff)
