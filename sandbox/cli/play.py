"""`sandbox play`, and `sandbox` alone."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.base.command import Subcommand, WindowOptions, flag, option, optional_argument
from sandbox.cli.base.inputs import EXIT_OK, is_scene, level_or_replay
from sandbox.cli.base.running import run_with_bar
from sandbox.terminal import seconds

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.session.replay.recording import Replay

# How long it plays where there is no display [s].
HEADLESS_SECONDS = 10.0


@dataclass(frozen=True, kw_only=True)
class PlayOptions(WindowOptions):
    """Options of `play`: the file to open, and the window's."""

    level: str | None = optional_argument(str, "LEVEL", "a level file, the name of a shipped one, a replay, or a scene")
    profile: bool = flag("print where a frame's time goes, at the end")
    seconds: float | None = option(seconds, help="close the app after this many seconds")


def play(options: PlayOptions) -> int:
    """Open the app; without a display, play without one."""
    from sandbox.app.base.display import has_display

    if not has_display():
        level, replay = level_or_replay(options.level or "rope_bridge_jelly")
        return _play_headless(level, replay)
    from sandbox.app.base.display import StartRequest
    from sandbox.app.window.opening import open_app

    def find() -> StartRequest:
        if options.level is None:
            return StartRequest()
        if is_scene(options.level):
            return StartRequest(scene=Path(options.level))
        level, replay = level_or_replay(options.level)
        source = Path(options.level) if not replay and Path(options.level).is_file() else None
        return StartRequest(None if replay else level, replay, source)

    return open_app(
        find, profile=options.profile, seconds=options.seconds, scale=options.scale, theme=options.theme,
        says_states=options.states,
    )  # fmt: skip


def _play_headless(level: "Level", replay: "Replay | None") -> int:
    from sandbox.app.draw.picture import save_picture
    from sandbox.session.session import Session

    picture = Path("sandbox.png")
    ticks = round(HEADLESS_SECONDS * level.settings.tick_rate)
    ticks = min(ticks, replay.ticks) if replay else ticks
    seconds = ticks / level.settings.tick_rate
    print(f"no display: playing {level.name!r} headless for {seconds:g} s, the last frame goes to {picture}")
    session = Session(level, replay.script if replay else ())
    summary = run_with_bar(session, ticks, replay.source if replay else level.name)
    save_picture(session, picture)
    print(summary.text(level.name))
    return EXIT_OK


COMMAND = Subcommand("play", "open the app: the gallery, a level, or a replay to watch", PlayOptions, play)
