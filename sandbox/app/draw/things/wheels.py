"""Wheels: tyres or steel rings as lit rings, with lugs, a rim, spokes and a hub that shows its turning."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.raster.mark_kernels import STUDDED
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.textures import TILE
from sandbox.app.draw.themes import STEEL
from sandbox.app.draw.things.frame import Frame
from sandbox.app.draw.things.level_slots import Actor
from sandbox.app.draw.things.soft import Shape
from sandbox.app.draw.things.strands import PIECES, curved

Slots = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Wheels smaller than this [pixels] have neither rim nor lugs; how far lugs stand out, as a part of the wheel's radius.
RIM_FROM, LUGS_FROM = 14.0, 22.0
LUG = 0.075
MANY_SPOKES = 10
TYRE = 0x565E70


class DrawnWheel:
    """A wheel whose rings are whole."""

    def __init__(self, actor: Actor, there: Mask, radius: float) -> None:
        count = int(actor.body.__dict__["segments"])
        self.is_tyre = actor.look.skin != "steel wheel"
        self.hub, self.inner = actor.slots[0], actor.slots[1 : count + 1]
        self.outer = actor.slots[count + 1 : 2 * count + 1]
        self.radius = radius
        self._stretches = np.column_stack([np.roll(self.inner, by) for by in (1, 0, -1, -2)])
        self.spokes = np.flatnonzero(there[:count])[:: 2 if count >= MANY_SPOKES else 1]
        own = actor.look.colour if actor.look.skin in ("rubber", "jelly", "plain") else TYRE
        loops = [self.outer, self.inner[::-1]]
        self.shape = Shape(
            loops, "tyre" if self.is_tyre else "rubber", own if self.is_tyre else STEEL, 0, radius, rounds=2
        )

    @staticmethod
    def is_whole(actor: Actor, there: Mask) -> bool:
        """Whether both rings of a wheel are closed, of whose springs some are there (m,)."""
        count = int(actor.body.__dict__["segments"])
        numbers = actor.made.numbers[there]
        return bool(np.isin(np.arange(count, 3 * count), numbers).all())

    def mark_lugs(self, marks: MarkList, frame: Frame) -> None:
        """Draw what lies under the tyre."""
        outer, hub = frame.at[self.outer], frame.at[self.hub]
        size = _size(outer - hub)
        if not self.is_tyre or size < LUGS_FROM:
            return
        middle = 0.5 * (outer + np.roll(outer, -1, axis=0))
        feet = np.concatenate([outer, middle])
        out = feet - hub
        out = out / np.maximum(np.sqrt(np.sum(out * out, axis=1)), 1e-9)[:, None]
        tips = hub + out * (size + self.radius * frame.zoom + LUG * size)
        red, green, blue = frame.theme.tyre
        half = max(1.5, min(0.055 * size, 1.2 * size / len(feet)))
        marks.strokes(np.concatenate([feet, tips], axis=1), half, red << 16 | green << 8 | blue)

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw rim, spokes and hub."""
        hub, inner = frame.at[self.hub], frame.at[self.inner]
        size = _size(frame.at[self.outer] - hub)
        if not np.isfinite(size):
            return
        spokes = inner[self.spokes]
        centre = np.broadcast_to(hub, spokes.shape)
        ends = np.concatenate([centre, spokes], axis=1)
        if self.is_tyre and size > RIM_FROM:
            around, *_ = curved(frame.at, self._stretches, PIECES)
            half = max(1.6, 0.045 * size)
            marks.strokes(around, half + 0.8 * frame.scale, 0x161B26, 0.8)
            marks.strips(around, half, TILE["steel"], 0.0)
        half = max(1.2, min(0.034 * size, 4.0 * frame.scale))
        marks.strokes(ends, half + 0.8 * frame.scale, 0x161B26, 0.6)
        marks.strips(ends, half, TILE["steel"], 0.0)
        first = frame.at[self.outer[0]] - hub
        length = max(float(np.hypot(*first)), 1e-9)
        ball = max(2.5, min(0.15 * size, 22.0 * frame.scale))
        marks.discs(hub[None], ball + 0.8 * frame.scale, 0x161B26, 0.8)
        marks.balls(hub[None], ball, (first / length)[None], 0xAEB9CC, 0x4A5468, STUDDED)


def _size(out: NDArray[np.float64]) -> float:
    return float(np.mean(np.sqrt(np.sum(out * out, axis=1))))
