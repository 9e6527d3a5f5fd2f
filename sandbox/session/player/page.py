"""A page of HTML that plays one run, or two side by side, all by itself: one file, no network."""

import html
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.export.policy import policy
from sandbox.level.format.look import PALETTE
from sandbox.level.format.writing import write_file
from sandbox.session.player.reel import STEPS, Reel

TEMPLATE = Path(__file__).with_name("player.html")


@dataclass(frozen=True)
class ToldLine:
    """What happened at a tick, in a line; side: the reel in which alone it did, None: in each."""

    tick: int
    text: str
    side: int | None = None


@dataclass(frozen=True)
class PlayerPage:
    """The content of a page. box [m]; rate: ticks a second; marks: ticks with a word to each; difference: the first
    tick that differs, and the particle; lines: the text about it; happened: what happened when, each goes to its tick.
    """

    title: str
    box: NDArray[np.float64]
    rate: int
    reels: Sequence[Reel]
    marks: Sequence[tuple[int, str]] = ()
    difference: tuple[int, int | None] | None = None
    lines: Sequence[str] = field(default=())
    happened: Sequence[ToldLine] = field(default=())

    def text(self) -> str:
        """The page. Both sides have the ticks that both have."""
        ticks = [tick for tick in self.reels[0].ticks if all(tick in set(reel.ticks) for reel in self.reels)]
        data: dict[str, Any] = {
            "rate": self.rate,
            "box": [float(value) for value in self.box],
            "steps": STEPS,
            "ticks": ticks,
            "sides": [{**reel.data(), "at": _places(reel.ticks, ticks)} for reel in self.reels],
            "marks": [[tick, words] for tick, words in self.marks],
            "first": None if self.difference is None else self.difference[0],
            "ring": None if self.difference is None else self.difference[1],
            "lines": list(self.lines),
            "happened": [[line.tick, line.text, line.side] for line in self.happened],
            "colours": [f"#{colour:06x}" for colour in PALETTE.values()],
        }
        # "<" could end the script that holds the data.
        packed = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
        text = TEMPLATE.read_text(encoding="utf-8")
        text = text.replace("@POLICY@", policy(text, img="data:"))
        before, after = text.replace("@TITLE@", html.escape(self.title)).rsplit("@DATA@", 1)
        return before + packed + after

    def write(self, path: Path) -> None:
        """Write the page, whole or not at all. Raises OSError."""
        try:
            write_file(path, self.text().encode())
        except OSError as error:
            raise OSError(error.errno or 0, error.strerror or str(error), str(path)) from None


def _places(ticks: Sequence[int], wanted: Sequence[int]) -> list[int]:
    places = {tick: place for place, tick in enumerate(ticks)}
    return [places[tick] for tick in wanted]
