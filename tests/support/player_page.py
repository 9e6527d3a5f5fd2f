"""A page that plays two runs of a rope."""

from collections.abc import Sequence

from sandbox.session.commands import CutSprings
from sandbox.session.player.page import EventLine, PlaybackData, PlayerPage, gathered, shown_box, states_of
from sandbox.session.session import Session
from tests.support.rope_level import rope_level

TICKS = 30


def rope_page(title: str = "Rope", lines: Sequence[str] = ("first difference at tick 12",)) -> PlayerPage:
    """A page of a rope beside one of which a spring is cut at tick 12."""
    level = rope_level()
    runs = [Session(level), Session(level)]
    box = shown_box(level, runs[0].world)
    for _ in range(12):
        runs[1].advance()
    runs[1].submit(CutSprings((4,)))
    reels = [gathered(PlaybackData(name, level, box), states_of(run, 0, TICKS), 3, 13)
             for name, run in zip(("expected", "actual"), runs, strict=True)]  # fmt: skip
    return PlayerPage(title, box, 60, reels, marks=[(12, "cut_springs")], difference=(13, 5), lines=lines,
                      happened=[EventLine(0, "rope.3 was grabbed"), EventLine(12, "rope:4 was cut", 1)])  # fmt: skip
