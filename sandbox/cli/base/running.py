"""Levels that run below a progress bar."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.base.inputs import Refused
from sandbox.terminal import Progress, interrupted_between_ticks

if TYPE_CHECKING:
    from sandbox.level.assembly.build_world import LevelWorld
    from sandbox.physics.world import World
    from sandbox.session.player.page import Watched
    from sandbox.session.replay.recording import Replay
    from sandbox.session.session import Session
    from sandbox.session.summary import Summary

PAGE = ".html"


def run_with_bar(
    session: "Session", ticks: int, source: object, on_tick: "Callable[[World], None] | None" = None
) -> "Summary":
    """Run a session with a progress bar; source: the file that its commands come from. Raises Refused."""
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


@contextmanager
def watching(ticks: int) -> "Iterator[Watched]":
    """Show how far it is while this many ticks are played in all, and let Ctrl+C end it between two."""
    with Progress(ticks) as bar, interrupted_between_ticks() as look_up:

        def watched(states: "Iterable[LevelWorld]") -> "Iterator[LevelWorld]":
            for state in states:
                yield state
                bar.update()
                look_up()

        yield watched


def write_run(session: "Session", ticks: int, path: Path, name: str, replay: "Replay | None") -> str:
    """Write the page that plays one run, which has not begun; what was written."""
    from sandbox.session.player.page import PlayerPage, command_marks, event_lines, played, watches_of

    runs = [session]
    watches = watches_of(runs)
    with watching(ticks) as watched:
        content = played([name], runs, ticks, watched=watched, watches=watches)
        page = PlayerPage(name, *content, marks=command_marks(replay), happened=event_lines(runs, watches))
    page.write(path)
    return f"{ticks / session.world.settings.tick_rate:g} s, {len(page.sides[0].ticks)} pictures"
