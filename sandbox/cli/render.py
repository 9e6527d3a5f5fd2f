"""`sandbox render`."""

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.base.command import Subcommand, argument, needed_option, option
from sandbox.cli.base.inputs import EXIT_OK, Refused, level_or_replay
from sandbox.cli.base.running import run_with_bar, write_run
from sandbox.terminal import Progress, rate, seconds, size

if TYPE_CHECKING:
    from sandbox.session.session import Session

# What is drawn unless told otherwise: length of a film [s], sizes [pixels].
FILM_SECONDS, FILM_SIZE, PNG_SIZE = 6.0, (640, 360), (1280, 720)


@dataclass(frozen=True, kw_only=True)
class RenderOptions:
    """Options of `render`: the run, the time, the size, and the file."""

    level: str = argument(str, "LEVEL|REPLAY")
    start: float | None = option(seconds, "--from", help="simulated time before a GIF or MP4; default 0")
    seconds: float | None = option(
        seconds,
        help="PNG: simulated time before the picture, default 0; GIF and MP4: how long they are, default 6",
    )
    fps: float | None = option(rate, help="pictures a second; default 20 for GIF, 30 for MP4")
    size: tuple[int, int] | None = option(
        size, metavar="WxH", help="in pixels; default 1280x720 for PNG, 640x360 for GIF and MP4"
    )
    output: Path = needed_option(Path, "-o", metavar="OUT.png|gif|mp4|html")


def render(options: RenderOptions) -> int:
    """Draw, and tell what was written. Raises Refused."""
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
    run_with_bar(session, ticks, options.level)
    what = _draw_still(session, options) if kind == "png" else _draw_film(session, options, kind, length)
    print(f"{options.output}: {what}, {options.output.stat().st_size / 1e6:.2f} MB")
    return EXIT_OK


def _render_page(options: RenderOptions) -> int:
    """Write a page that plays a level or a replay; nothing is drawn here."""
    from sandbox.session.session import Session

    for name, value in (("from", options.start), ("fps", options.fps), ("size", options.size)):
        if value is not None:
            raise Refused(f"--{name}: is for pictures and films; a page has every tick, from the beginning")
    level, replay = level_or_replay(options.level)
    per_second = level.settings.tick_rate
    ticks = FILM_SECONDS * per_second if options.seconds is None else options.seconds * per_second
    if replay and options.seconds is None:
        ticks = replay.ticks
    if replay and round(ticks) > replay.ticks:
        raise Refused(f"{options.level}: is {replay.ticks / per_second:g} s long")
    session = Session(level, replay.script if replay else ())
    what = write_run(session, round(ticks), options.output, level.name, replay)
    print(f"{options.output}: {what}, {options.output.stat().st_size / 1e6:.2f} MB")
    return EXIT_OK


def _check_render_options(options: RenderOptions, kind: str) -> None:
    from sandbox.app.film.kinds import KINDS, Missing, require

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


def _draw_still(session: "Session", options: RenderOptions) -> str:
    """Draw the present state of a run; what was drawn."""
    from sandbox.app.draw.picture import save_picture

    pixels = options.size or PNG_SIZE
    with Progress(1, "picture") as bar:
        save_picture(session, options.output, pixels)
        bar.update()
    return f"{pixels[0]}x{pixels[1]}"


def _draw_film(session: "Session", options: RenderOptions, kind: str, length: float) -> str:
    """Draw the last `length` [s] of a run; what was drawn."""
    from sandbox.app.film.film import film_of_view
    from sandbox.app.film.kinds import KINDS, possible_size
    from sandbox.app.share.export import Excerpt, Export

    pixels, fps = possible_size(options.size or FILM_SIZE, kind), options.fps or KINDS[kind].usual_fps
    film = film_of_view(session, pixels, length)
    export = Export(film, Excerpt(kind, 0.0, film.seconds, fps, pixels), options.output)
    with Progress(100, "%") as bar, closing(export.slices()) as slices:
        for done in slices:
            bar.update(int(100 * done) - bar.done)
    return f"{pixels[0]}x{pixels[1]}, {film.seconds:g} s of {fps:g} pictures a second"


COMMAND = Subcommand(
    "render", "draw a level or a replay into a PNG, GIF, MP4 or HTML, off screen", RenderOptions, render
)
