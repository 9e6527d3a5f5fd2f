"""The melt: the same Cs and Cd, solved one spring after another as in the article's loop, or all at once."""

from sandbox.app.run.playback import RAMP_TIME, Playback
from sandbox.session.commands import SetSolver

MELTED = "One spring after another, as in the article's loop: what is stiff melts or explodes."
WHOLE = "All springs at once: it is whole again."


def is_melted(playback: Playback) -> bool:
    """Whether springs are solved one by one."""
    return playback.session.world.settings.solver == "single_pass"


def toggle_melt(playback: Playback) -> str:
    """Solve springs one by one, which melts what is stiff, or all at once again; gives a line that says so."""
    before = is_melted(playback)
    duration = round(RAMP_TIME * playback.session.world.settings.tick_rate)
    playback.submit(SetSolver(solver="direct" if before else "single_pass", duration=duration))
    return WHOLE if before else MELTED
