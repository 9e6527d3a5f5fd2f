"""Levels that run below a progress bar."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from sandbox.cli.base.inputs import Refused
from sandbox.terminal import Progress, interrupted_between_ticks

if TYPE_CHECKING:
    from sandbox.physics.world import World
    from sandbox.session.session import Session
    from sandbox.session.summary import Summary


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
