"""`sandbox info`."""

import json
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sandbox.cli.base.command import Subcommand, arguments, flag, length_in_seconds, length_in_ticks
from sandbox.cli.base.inputs import EXIT_OK, Refused, is_replay, level_of, recording_of
from sandbox.terminal import Progress, interrupted_between_ticks, shortened

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.session.event_log import Event
    from sandbox.session.replay.recording import Replay
    from sandbox.session.session import Session

# How long a level runs, of which there is no recording [s].
LEVEL_SECONDS = 10.0


@dataclass(frozen=True, kw_only=True)
class InfoOptions:
    """Options of `info`: what to tell, and how."""

    files: list[str] = arguments(str, "FILE", "a recording, or a level, which runs by itself")
    seconds: float | None = length_in_seconds("; default: all of a recording, 10 s of a level")
    ticks: int | None = length_in_ticks()
    all: bool = flag("list all that touched, however many")
    json: bool = flag("print one JSON object a file, with all there is")


def info(options: InfoOptions) -> int:
    """Print what recordings hold, and what happened in them when. Raises Refused."""
    for number, name in enumerate(options.files):
        replay = recording_of(name, partial=True, retold=True) if is_replay(name) else None
        level = level_of(name) if replay is None else replay.level
        run, ticks, found = _events(options, name, level, replay)
        if options.json:
            print(json.dumps(_data(name, run, replay, found)))
            continue
        if number:
            print()
        print("\n".join([*_header(name, run, replay, ticks), *_list(options, run, found)]))
    return EXIT_OK


def _events(
    options: InfoOptions, name: str, level: "Level", replay: "Replay | None"
) -> "tuple[Session, int, list[Event]]":
    """The run at its end, the tick of that, and what happened in it, one by one where a program asks."""
    from sandbox.session.commands import CommandError
    from sandbox.session.event_log import TouchWatch, events_of, watched_event_log
    from sandbox.session.session import Session

    rate = level.settings.tick_rate
    asked = options.ticks if options.seconds is None else round(options.seconds * rate)
    usual = round(LEVEL_SECONDS * rate) if replay is None else replay.ticks
    ticks = usual if asked is None else asked if replay is None else min(asked, replay.ticks)
    run, watch = Session(level, replay.script if replay else ()), TouchWatch(level.zones)
    with Progress(ticks) as bar, interrupted_between_ticks() as look_up:

        def on_tick() -> None:
            bar.update()
            look_up()

        try:
            found = watched_event_log(run, ticks, on_tick, watch)
        except CommandError as error:
            raise Refused(*(f"{name}: tick {run.tick}: {fault}" for fault in error.faults)) from None
    return run, ticks, events_of(run, watch) if options.json else found


def _header(name: str, run: "Session", replay: "Replay | None", ticks: int) -> list[str]:
    level, rate = run.level, run.level.settings.tick_rate
    steps = level.settings.substeps
    lines = [
        shortened(name),
        f"level       {level.name}",
        f"solver      {level.settings.solver}, {rate} ticks a second, "
        + ('substeps "auto"' if steps == "auto" else f"{steps} substeps" if steps != 1 else "1 substep"),
        f"length      {ticks:,} ticks, {ticks / rate:.2f} s"
        + ("" if replay is None or ticks == replay.ticks else f" of {replay.ticks / rate:.2f} s")
        + ("" if replay is None or replay.end_hash is not None else ", where the file is cut off"),
    ]
    if replay is not None:
        counts = _commands(replay)
        said = ", ".join(f"{count} {kind}" for kind, count in counts.most_common()) or "none"
        lines.append(f"commands    {said}")
        if not _is_equal(run, replay):
            lines.append("            this build steps it differently; `sandbox replay` says where")
    return lines


def _list(options: InfoOptions, run: "Session", found: "list[Event]") -> list[str]:
    from sandbox.session.event_log import shortened

    shown, dropped = (found, 0) if options.all else shortened(found)
    rate = run.level.settings.tick_rate
    lines = [each.line(rate) for each in shown] or ["  nothing: nobody did anything, nothing touched or broke"]
    if dropped:
        lines.append(f"            {dropped} more lines of who touched whom; --all lists them")
    return ["happened", *lines]


def _data(name: str, run: "Session", replay: "Replay | None", found: "list[Event]") -> dict[str, Any]:
    from sandbox.session.outcome import outcome, outcome_data

    settings, rate = run.level.settings, run.level.settings.tick_rate
    return {
        "file": name,
        "level": run.level.name,
        "solver": settings.solver,
        "tick_rate": rate,
        "substeps": settings.substeps,
        "ticks": run.tick,
        "commands": dict(_commands(replay)) if replay else {},
        "equal": None if replay is None else _is_equal(run, replay),
        "outcome": outcome_data(outcome(run.level, run.world), rate),
        "happened": [each.data(rate) for each in found],
    }


def _commands(replay: "Replay") -> Counter[str]:
    """How many commands of each kind a recording has."""
    return Counter(str(line.record.get("type")) for line in replay.script)


def _is_equal(run: "Session", replay: "Replay") -> bool:
    """Whether the run's last state is the recorded one."""
    from sandbox.physics.snapshot import state_hash

    if run.tick == replay.ticks:
        return replay.end_hash is None or replay.end_hash == state_hash(run.world)
    return replay.hashes[run.tick].fits(state_hash(run.world))


COMMAND = Subcommand("info", "tell what a recording holds, and what happened in it when", InfoOptions, info)
