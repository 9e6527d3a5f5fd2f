"""`sandbox run`."""

import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.base.command import Subcommand, argument, flag, length_in_seconds, length_in_ticks, option, option_or
from sandbox.cli.base.inputs import EXIT_OK, EXIT_REFUSED, Refused, level_of
from sandbox.cli.base.running import run_with_bar
from sandbox.terminal import count, substeps, tell

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.physics.world import World
    from sandbox.session.session import Session


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Options of `run`: the level, for how long, and the files to write."""

    level: str = argument(str, "LEVEL")
    seconds: float | None = length_in_seconds("; default 10")
    ticks: int | None = length_in_ticks()
    solver: str | None = option(str, help="instead of the level's solver")
    substeps: int | str | None = option(substeps, help="instead of the level's: a power of two, 1 to 64, or auto")
    json: bool = flag("print the summary as one JSON object")
    record: Path | None = option(Path, metavar="FILE", help="write a replay; .gz compresses")
    commands: Path | None = option(Path, metavar="FILE.jsonl", help="commands to carry out, as lines of a replay")
    dump: Path | None = option(Path, metavar="FILE", help="write the last position and velocity of every particle")
    probe: str | None = option(
        str, metavar="ID.K,..", help="particles and motors to follow, by name, into the file of -o"
    )
    every: int = option_or(1, count, metavar="N", help="follow them every N ticks; default 1")
    output: Path | None = option(Path, "-o", metavar="FILE.csv", help="where the probe's table goes")


def run(options: RunOptions) -> int:
    """Run a level and tell what came of it. Raises Refused."""
    level = _with_overrides(level_of(options.level), options)
    rate = level.settings.tick_rate
    ticks = options.ticks or round((10.0 if options.seconds is None else options.seconds) * rate)
    from sandbox.session.probe import dump, finite

    _keep_apart(options)
    session = _scripted_session(level, options.commands, ticks)
    probe = _probe(options, session.world)
    with _recorded(session, options.record) as is_whole:
        summary = run_with_bar(session, ticks, options.commands, probe.take)
    if options.output:
        _write_text(options.output, probe.table())
    if options.dump:
        _write_text(options.dump, json.dumps(dump(session.world), indent=1) + "\n")
    tell(session.messages)
    if options.json:
        print(json.dumps({"level": level.name, **finite(asdict(summary))}))
    else:
        print(summary.text(level.name))
    return EXIT_OK if is_whole() else EXIT_REFUSED


@contextmanager
def _recorded(session: "Session", path: Path | None) -> "Iterator[Callable[[], bool]]":
    """Record what a session does in here; whether that was written whole is known after it.

    What is refused leaves no recording, and an older one of that name as it was; so does an interrupt, which leaves one
    that is cut off where there is no older one.
    """
    if path is None:
        yield lambda: True
        return
    from sandbox.level.format.writing import unfinished
    from sandbox.session.replay import RECORDINGS, is_recording

    # An older file is replaced in the end only; a device is written to.
    target = Path(os.path.realpath(path))
    fresh = unfinished(target, "".join(path.suffixes[-2:])) if target.is_file() else path
    written: Path | None = None
    try:
        session.record_to(fresh)
        yield lambda: written is not None
        written = session.stop_recording()
        if written and written != path:
            written.replace(target)
        if written and target.is_file() and not is_recording(path):
            tell([f"{path}: written; tests find recordings by names that end in {' or '.join(RECORDINGS[:2])}"])
    except OSError as error:
        session.abandon_recording()
        if error.filename == str(fresh):
            error.filename = str(path)
        raise
    except KeyboardInterrupt:
        if session.recording:
            cause = f"cut off at tick {session.tick}; `sandbox replay --partial` verifies it"
            if fresh != path:
                cause = f"interrupted at tick {session.tick}; the older recording of that name stays"
            tell([f"{path}: {cause}"])
            session.abandon_recording()
        raise
    except BaseException:
        session.abandon_recording()
        if fresh.is_file():
            fresh.unlink()
        raise
    finally:
        session.refusals[:] = [line.replace(str(fresh), str(path)) for line in session.refusals]
        if fresh != path:
            fresh.unlink(missing_ok=True)


def _keep_apart(options: RunOptions) -> None:
    """Refuse to write over what is read, or two outputs into one file."""
    taken = {Path(path).resolve() for path in (options.level, options.commands) if path}
    for path in filter(None, (options.record, options.dump, options.output)):
        if path.resolve() in taken and path.is_file():
            raise Refused(f"{path}: is used twice in this command; give every file a name of its own")
        taken.add(path.resolve())


def _with_overrides(level: "Level", options: RunOptions) -> "Level":
    from sandbox.level.format.level_error import LevelError
    from sandbox.session.level_edits import with_settings

    settings = {"solver": options.solver, "substeps": options.substeps}
    overrides = {name: value for name, value in settings.items() if value is not None}
    if not overrides:
        return level
    try:
        return with_settings(level, overrides, "command line")
    except LevelError as error:
        raise Refused(*error.faults) from None


def _scripted_session(level: "Level", commands: Path | None, ticks: int) -> "Session":
    from sandbox.session.session import Session

    if commands is None:
        return Session(level)
    from sandbox.session.replay.reader import read_script
    from sandbox.session.replay.recording import ReplayError

    try:
        script = read_script(commands)
    except ReplayError as error:
        raise Refused(*error.faults) from None
    late = [line.tick for line in script if line.tick > ticks]
    if late:
        number = "1 command is" if len(late) == 1 else f"{len(late):,} commands are"
        when = f"at tick {late[0]}" if late[0] == late[-1] else f"at ticks {late[0]} to {late[-1]}"
        raise Refused(f"{commands}: {number} {when}, but the run ends at tick {ticks}; run it for longer with --ticks")
    return Session(level, script)


def _probe(options: RunOptions, world: "World") -> Any:
    from sandbox.session.probe import Probe, near_names

    if bool(options.probe) != bool(options.output):
        raise Refused("--probe names the particles and -o the file: give both")
    names = [name.strip() for name in options.probe.split(",")] if options.probe else []
    try:
        return Probe(world, names, options.every)
    except KeyError as error:
        near = near_names(world, str(error.args[0]))
        hint = f"; near names: {', '.join(near)}" if near else ""
        raise Refused(f"--probe: there is no particle {error.args[0]!r}{hint}") from None


def _write_text(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise Refused(f"{path}: {error.strerror or error}") from None


COMMAND = Subcommand("run", "run a level headless and print what came of it", RunOptions, run)
