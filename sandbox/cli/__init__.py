"""The command line. A sub-command imports what it needs when it runs, so that --help answers at once."""

import argparse
import gc
import json
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox import __version__
from sandbox.cli import comparing, sweeping, toys
from sandbox.cli.inputs import (
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_REFUSED,
    Refused,
    level_of,
    level_or_replay,
    recording_of,
)
from sandbox.terminal import (
    Progress,
    cores,
    count,
    give_up_output,
    interrupted_between_ticks,
    missing_folder,
    prepare_streams,
    processes,
    rate,
    refusal_of,
    scale,
    seconds,
    size,
    substeps,
    tell,
)

if TYPE_CHECKING:
    from sandbox.level.format.model import Level
    from sandbox.physics.world import World
    from sandbox.session.replay.recording import Replay
    from sandbox.session.session import Session

# What `play` does where there is no display [s].
HEADLESS_SECONDS = 10.0
# Python searches for garbage after so many new objects, in place of 700: what is imported stays, and looking through it
# again and again was a sixth of a start. Objects that hold each other, as those do, are few in a run.
SEARCH_AFTER = 200_000
# What `render` draws unless told otherwise: length of a film [s], sizes [pixels].
FILM_SECONDS, FILM_SIZE, PNG_SIZE = 6.0, (640, 360), (1280, 720)
# A process that checks levels takes as long to start as a few levels take; fewer for each are not worth one.
LEVELS_PER_PROCESS = 4


def program() -> int:
    """Run the command line as a process of its own, which ends after it; returns as `main`."""
    gc.set_threshold(SEARCH_AFTER, 5, 5)
    try:
        return main()
    finally:
        # What is left goes with the process.
        gc.freeze()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0, 1 a check failed or a replay diverged, 2 refused."""
    prepare_streams()
    # No linear algebra of numpy's is used: its threads would only cost time, a tenth of a start.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    options = _parser().parse_args(arguments)
    gone = missing_folder()
    if gone:
        return _refuse([gone])
    try:
        code: int = options.action(options)
        sys.stdout.flush()
        return code
    except Refused as refusal:
        return _refuse(refusal.faults)
    except BrokenPipeError:
        give_up_output()
        return EXIT_FAILED
    except OSError as error:
        give_up_output()
        return _refuse([refusal_of(error)])
    except KeyboardInterrupt:
        give_up_output()
        return EXIT_INTERRUPTED


def _refuse(faults: Iterable[str]) -> int:
    tell(faults)
    return EXIT_REFUSED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="sandbox", description="A 2D physics sandbox of damped springs.")
    parser.add_argument("--version", action="version", version=f"sandbox {__version__}")
    parser.set_defaults(action=_play, level=None, profile=False, seconds=None, scale=None, theme=None)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")

    def command(name: str, action: Callable[[argparse.Namespace], int], text: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        sub.set_defaults(action=action)
        return sub

    play = command("play", _play, "open the app: the gallery, a level, or a replay to watch")
    play.add_argument(
        "level", nargs="?", metavar="LEVEL", help="a level file, a shipped level's name, or a replay file"
    )
    play.add_argument("--profile", action="store_true", help="print where a frame's time goes, at the end")
    play.add_argument("--seconds", type=seconds, help="close the app after so many seconds")
    _add_look_options(play)

    toy = command("toy", toys.play_toy, "play a level in a small window that stays on top and feels how it is moved")
    toys.add_toy_options(toy)
    _add_look_options(toy)

    run = command("run", _run, "run a level headless and print what came of it")
    run.add_argument("level", metavar="LEVEL")
    length = run.add_mutually_exclusive_group()
    length.add_argument("--seconds", type=seconds, help="simulated time; default 10")
    length.add_argument("--ticks", type=count, help="the same, in ticks")
    run.add_argument("--solver", help="instead of the level's solver")
    run.add_argument("--substeps", type=substeps, help="instead of the level's: a power of two, 1 to 64, or auto")
    run.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    run.add_argument("--record", type=Path, metavar="FILE", help="write a replay; .gz compresses")
    run.add_argument("--commands", type=Path, metavar="FILE.jsonl", help="commands to carry out, as lines of a replay")
    run.add_argument("--dump", type=Path, metavar="FILE", help="write the last position and velocity of every particle")
    run.add_argument("--probe", metavar="ID.K,..", help="particles and motors to follow, by name, into the file of -o")
    run.add_argument("--every", type=count, default=1, metavar="N", help="follow them every N ticks; default 1")
    run.add_argument("-o", "--output", type=Path, metavar="FILE.csv", help="where the probe's table goes")

    _add_replay_options(command("replay", _replay, "run recordings again and compare every bit"))
    _add_resume_options(command("resume", _resume, "go on with a recording that was cut off, and make it whole"))

    check = command("check", _check, "validate levels, report their stability, run the checks they carry")
    check.add_argument("levels", nargs="+", metavar="LEVEL")
    check.add_argument(
        "--processes", type=processes, metavar="N", help="check so many at a time; default: by cores and levels"
    )

    comparing.add_diff_options(command("diff", comparing.diff, "say where two recordings or levels part"))
    comparing.add_bisect_options(command("bisect", comparing.bisect, "find the edit or value that makes a level fail"))
    sweeping.add_options(command("sweep", sweeping.sweep, "run a level over a grid of settings into a table"))
    _add_render_options(command("render", _render, "draw a level or a replay into a PNG, GIF, MP4 or HTML, off screen"))

    layout = command("format", _format, "rewrite a level file in its canonical form")
    layout.add_argument("file", type=Path, metavar="FILE")
    edit = command("edit", _edit, "open the level editor: a level, or an empty sheet")
    edit.add_argument("level", nargs="?", metavar="LEVEL")
    _add_look_options(edit)
    _add_prepare_options(command("prepare", _prepare, "compile the physics, as the first start would"))
    command("schema", _schema, "print the JSON Schema of level files")
    return parser


def _add_look_options(app: argparse.ArgumentParser) -> None:
    app.add_argument("--scale", type=scale, help="size of the widgets, 0.5 to 4; default: as in the settings")
    app.add_argument("--theme", choices=("dark", "light", "system"), help="for this time; default: as in the settings")


def _add_replay_options(replay: argparse.ArgumentParser) -> None:
    replay.add_argument("files", nargs="+", metavar="FILE")
    replay.add_argument("--json", action="store_true", help="print one JSON object a file")
    replay.add_argument("--partial", action="store_true", help="verify what there is of a recording that is cut off")
    replay.add_argument("--report", type=Path, metavar="OUT.html", help="where it diverges, play both side by side")
    replay.add_argument("--against", metavar="LEVEL", help="run their commands on this level, not on the recorded one")


def _add_resume_options(again: argparse.ArgumentParser) -> None:
    again.add_argument("file", metavar="FILE")
    length = again.add_mutually_exclusive_group()
    length.add_argument("--seconds", type=seconds, help="simulated time in all; default: up to where it was cut off")
    length.add_argument("--ticks", type=count, help="the same, in ticks")


def _add_render_options(render: argparse.ArgumentParser) -> None:
    render.add_argument("level", metavar="LEVEL|REPLAY")
    text = "PNG: simulated time before the picture, default 0; GIF and MP4: how long they are, default 6"
    render.add_argument("--seconds", type=seconds, help=text)
    render.add_argument("--from", type=seconds, dest="start", help="simulated time before a GIF or MP4; default 0")
    render.add_argument("--fps", type=rate, help="pictures a second; default 20 for GIF, 30 for MP4")
    text = "in pixels; default 1280x720 for PNG, 640x360 for GIF and MP4"
    render.add_argument("--size", type=size, metavar="WxH", help=text)
    render.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.png|gif|mp4|html")


def _add_prepare_options(prepare: argparse.ArgumentParser) -> None:
    prepare.add_argument("level", nargs="?", metavar="LEVEL", help="only what this level needs")
    prepare.add_argument("--processes", type=count, metavar="N", help="at a time; default: one a processor, at most 4")


def _play(options: argparse.Namespace) -> int:
    from sandbox.app.display import has_display

    if not has_display():
        level, replay = level_or_replay(options.level or "rope_bridge_jelly")
        return _play_headless(level, replay)
    from sandbox.app.opening import open_app
    from sandbox.app.start_request import StartRequest

    def find() -> StartRequest:
        if options.level is None:
            return StartRequest()
        level, replay = level_or_replay(options.level)
        source = Path(options.level) if not replay and Path(options.level).is_file() else None
        return StartRequest(None if replay else level, replay, source)

    return open_app(find, profile=options.profile, seconds=options.seconds, scale=options.scale, theme=options.theme)


def _play_headless(level: "Level", replay: "Replay | None") -> int:
    from sandbox.app.draw.picture import save_picture
    from sandbox.session.session import Session

    picture = Path("sandbox.png")
    ticks = round(HEADLESS_SECONDS * level.settings.tick_rate)
    ticks = min(ticks, replay.ticks) if replay else ticks
    seconds = ticks / level.settings.tick_rate
    print(f"no display: playing {level.name!r} headless for {seconds:g} s, the last frame goes to {picture}")
    session = Session(level, replay.script if replay else ())
    summary = _run_with_bar(session, ticks, replay.source if replay else level.name)
    save_picture(session, picture)
    print(summary.text(level.name))
    return EXIT_OK


def _run(options: argparse.Namespace) -> int:
    level = _with_overrides(level_of(options.level), options)
    rate = level.settings.tick_rate
    ticks = options.ticks or round((10.0 if options.seconds is None else options.seconds) * rate)
    from sandbox.session.probe import dump, finite

    _keep_apart(options)
    session = _scripted_session(level, options.commands)
    probe = _probe(options, session.world)
    if options.record:
        session.record_to(options.record)
    try:
        summary = _run_with_bar(session, ticks, options.commands, probe.take)
    except KeyboardInterrupt:
        if session.recording:
            tell([f"{session.recording}: cut off at tick {session.tick}; `sandbox replay --partial` verifies it"])
        session.abandon_recording()
        raise
    finally:
        recorded = session.stop_recording()
    if options.output:
        _write_text(options.output, probe.table())
    if options.dump:
        _write_text(options.dump, json.dumps(dump(session.world), indent=1) + "\n")
    tell(session.messages)
    if options.json:
        print(json.dumps({"level": level.name, **finite(asdict(summary))}))
    else:
        print(summary.text(level.name))
    return EXIT_OK if recorded == options.record else EXIT_REFUSED


def _keep_apart(options: argparse.Namespace) -> None:
    """Refuse to write over what is read, or two outputs into one file."""
    taken = {Path(path).resolve() for path in (options.level, options.commands) if path}
    for path in filter(None, (options.record, options.dump, options.output)):
        if path.resolve() in taken and path.is_file():
            raise Refused(f"{path}: is used twice in this command; give every file a name of its own")
        taken.add(path.resolve())


def _with_overrides(level: "Level", options: argparse.Namespace) -> "Level":
    from sandbox.level.faults.level_error import LevelError
    from sandbox.session.replay.again import with_settings

    given = {name: getattr(options, name) for name in ("solver", "substeps") if getattr(options, name) is not None}
    if not given:
        return level
    try:
        return with_settings(level, given, "command line")
    except LevelError as error:
        raise Refused(*error.faults) from None


def _scripted_session(level: "Level", commands: Path | None) -> "Session":
    from sandbox.session.session import Session

    if commands is None:
        return Session(level)
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.replay.script import read_script

    try:
        return Session(level, read_script(commands))
    except ReplayError as error:
        raise Refused(*error.faults) from None


def _run_with_bar(
    session: "Session", ticks: int, source: object, on_tick: "Callable[[World], None] | None" = None
) -> Any:
    """Run a session with a progress bar; source: the file that its commands come from."""
    from sandbox.session.commands import CommandError
    from sandbox.session.summary import run

    with interrupted_between_ticks() as look_up, Progress(ticks) as bar:

        def after(world: "World") -> None:
            bar.update()
            if on_tick is not None:
                on_tick(world)
            look_up()

        try:
            return run(session, ticks, after)
        except CommandError as error:
            raise Refused(*(f"{source}: tick {session.tick}: {fault}" for fault in error.faults)) from None


def _probe(options: argparse.Namespace, world: "World") -> Any:
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


def _replay(options: argparse.Namespace) -> int:
    worst = EXIT_OK
    level = level_of(options.against) if options.against else None
    if options.report and (len(options.files) > 1 or options.report.suffix.lower() != comparing.PAGE):
        raise Refused("--report: is of one recording, into a file whose name ends in .html")
    for name in options.files:
        code, outcome = _verify(name, options.partial, level, options.report)
        worst = max(worst, code)
        if options.json:
            print(json.dumps(outcome))
        elif code == EXIT_REFUSED:
            _refuse(outcome["faults"])
        else:
            print(f"{name}: {outcome['text']}")
    return worst


def _verify(name: str, partial: bool, level: "Level | None", report: Path | None) -> tuple[int, dict[str, Any]]:
    from sandbox.session.probe import finite
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.replay.verify import compare

    try:
        replay = recording_of(name, partial)
        with Progress(replay.ticks) as bar:
            found = compare(replay, level=level, progress=lambda done, total: bar.update(done - bar.done))
    except (Refused, ReplayError) as error:
        return EXIT_REFUSED, {"file": name, "result": "refused", "faults": list(error.faults)}
    if found is None:
        cut = " (cut off: verified as far as it goes)" if replay.end_hash is None else ""
        text = f"equal, {replay.ticks} ticks{cut}"
        return EXIT_OK, {"file": name, "result": "equal", "ticks": replay.ticks, "text": text}
    if report is not None:
        comparing.write_report(found, report)
    details = finite({**asdict(found.divergence), "text": f"diverged at {found.divergence}"})
    return EXIT_FAILED, {"file": name, "result": "diverged", **details}


def _resume(options: argparse.Namespace) -> int:
    from sandbox.session.commands import CommandError
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.replay.resume import resume

    try:
        whole = recording_of(options.file)
    except Refused:
        replay = recording_of(options.file, partial=True)
    else:
        raise Refused(f"{options.file}: is whole, {whole.ticks} ticks: there is nothing to resume")
    rate = replay.level.settings.tick_rate
    ticks = options.ticks or (replay.ticks if options.seconds is None else round(options.seconds * rate))
    if ticks < replay.ticks:
        raise Refused(f"{options.file}: has {replay.ticks} ticks already; --seconds and --ticks are of the whole run")
    try:
        with interrupted_between_ticks() as look_up, Progress(ticks) as bar:

            def show(tick: int) -> None:
                bar.update(tick - bar.done)
                look_up()

            resume(replay, ticks, show)
    except (CommandError, ReplayError) as error:
        raise Refused(*error.faults) from None
    print(f"{options.file}: whole, {ticks} ticks, {ticks - replay.ticks} of them new")
    return EXIT_OK


def _check(options: argparse.Namespace) -> int:
    from sandbox.session.checking import check_levels

    worst = EXIT_OK
    names = options.levels
    processes = min(options.processes or max(1, min(cores(), len(names) // LEVELS_PER_PROCESS)), len(names))
    with Progress(len(names), "level") as bar, closing(check_levels(names, processes)) as reports:
        for found in reports:
            with bar.aside():
                for line in found.lines:
                    print(line)
                sys.stdout.flush()
                tell(found.faults)
            worst = max(worst, EXIT_REFUSED if found.faults else EXIT_OK if found.passed else EXIT_FAILED)
            bar.update()
    return worst


def _render(options: argparse.Namespace) -> int:
    from sandbox.session.session import Session

    kind = options.output.suffix.lower().removeprefix(".")
    if kind == "html":
        return _render_page(options)
    if kind not in ("png", "gif", "mp4"):
        raise Refused(f"{options.output}: end the name in .png, .gif, .mp4 or .html, for a page that plays it")
    _check_render_options(options, kind)
    level, replay = level_or_replay(options.level)
    length = (0.0 if kind == "png" else FILM_SECONDS) if options.seconds is None else options.seconds
    ticks = round(((options.start or 0.0) + length) * level.settings.tick_rate)
    if replay and ticks > replay.ticks:
        raise Refused(f"{options.level}: is {replay.ticks / level.settings.tick_rate:g} s long")
    session = Session(level, replay.script if replay else ())
    _run_with_bar(session, ticks, options.level)
    what = _draw_still(session, options) if kind == "png" else _draw_film(session, options, kind, length)
    print(f"{options.output}: {what}, {options.output.stat().st_size / 1e6:.2f} MB")
    return EXIT_OK


def _render_page(options: argparse.Namespace) -> int:
    """Write a page that plays a level or a replay; nothing is drawn here."""
    from sandbox.session.session import Session

    for name, value in (("from", options.start), ("fps", options.fps), ("size", options.size)):
        if value is not None:
            raise Refused(f"--{name}: is for pictures and films; a page has every tick, from the beginning")
    level, replay = level_or_replay(options.level)
    rate = level.settings.tick_rate
    wanted = FILM_SECONDS * rate if options.seconds is None else options.seconds * rate
    if replay and options.seconds is None:
        wanted = replay.ticks
    if replay and round(wanted) > replay.ticks:
        raise Refused(f"{options.level}: is {replay.ticks / rate:g} s long")
    session = Session(level, replay.script if replay else ())
    what = comparing.write_run(session, round(wanted), options.output, level.name, replay)
    print(f"{options.output}: {what}, {options.output.stat().st_size / 1e6:.2f} MB")
    return EXIT_OK


def _check_render_options(options: argparse.Namespace, kind: str) -> None:
    from sandbox.app.share.kinds import KINDS, Missing, require

    most = KINDS[kind].most_fps
    if kind == "png":
        for name, value in (("from", options.start), ("fps", options.fps)):
            if value is not None:
                raise Refused(f"--{name}: is for GIF and MP4; a PNG is drawn after --seconds")
    elif (options.fps or 0.0) > most:
        raise Refused(f"--fps: a {kind.upper()} shows at most {most:g} pictures a second")
    elif options.seconds == 0.0:
        raise Refused(f"--seconds: a {kind.upper()} of no length has no pictures")
    try:
        require(kind)
    except Missing as missing:
        raise Refused(f"{options.output}: {missing}") from None


def _draw_still(session: "Session", options: argparse.Namespace) -> str:
    """Draw the present state of a run; what was drawn."""
    from sandbox.app.draw.picture import save_picture

    size = options.size or PNG_SIZE
    with Progress(1, "picture") as bar:
        save_picture(session, options.output, size)
        bar.update()
    return f"{size[0]}x{size[1]}"


def _draw_film(session: "Session", options: argparse.Namespace, kind: str, length: float) -> str:
    """Draw the last `length` [s] of a run; what was drawn."""
    from sandbox.app.share.export import Excerpt, Export
    from sandbox.app.share.film import film_of_view
    from sandbox.app.share.kinds import KINDS, possible_size

    size, fps = possible_size(options.size or FILM_SIZE, kind), options.fps or KINDS[kind].usual_fps
    film = film_of_view(session, size, length)
    export = Export(film, Excerpt(kind, 0.0, film.seconds, fps, size), options.output)
    with Progress(100, "%") as bar, closing(export.slices()) as slices:
        for done in slices:
            bar.update(int(100 * done) - bar.done)
    return f"{size[0]}x{size[1]}, {film.seconds:g} s of {fps:g} pictures a second"


def _edit(options: argparse.Namespace) -> int:
    from sandbox.app.display import has_display

    if not has_display():
        raise Refused("the editor needs a display; without one, edit the level's JSON and try `sandbox check`")
    from sandbox.app.opening import open_app
    from sandbox.app.start_request import StartRequest

    return open_app(lambda: StartRequest(edit=options.level or ""), scale=options.scale, theme=options.theme)


def _format(options: argparse.Namespace) -> int:
    from sandbox.level.format.files import LevelError, read_level, write_level

    try:
        warning = write_level(read_level(options.file), options.file)
    except LevelError as error:
        raise Refused(*error.faults) from None
    if warning:
        print(warning, file=sys.stderr)
    return EXIT_OK


def _schema(options: argparse.Namespace) -> int:
    from sandbox.level.format.schema import schema

    print(json.dumps(schema(), indent=2))
    return EXIT_OK


def _prepare(options: argparse.Namespace) -> int:
    level = level_of(options.level) if options.level else None
    from sandbox.app.compiling import GROUPS, compile_all, note_prepared, usual_processes

    groups = GROUPS if level is None or level.has_contacts else GROUPS[:1]
    solvers = None if level is None else (level.settings.solver,)
    with Progress(0, "kernel") as bar:
        succeeded = compile_all(options.processes or usual_processes(), groups, solvers, bar.show)
    if not succeeded:
        raise Refused("numba cannot compile everything here; `sandbox play` tries again and says why")
    if level is None:
        note_prepared()
    print("the physics is compiled" if level is None else f"all that {level.name} needs is compiled")
    return EXIT_OK
