"""Balls and pins: loose particles, lit, with a mark that turns; and what is held."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.raster.mark_kernels import MARBLED, PLAIN, STRIPED, STUDDED
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.themes import SANDS
from sandbox.app.draw.things.frame import Frame, Seen
from sandbox.app.draw.things.level_slots import Ball, LevelSlots
from sandbox.level.format.limits import BODY_RADIUS
from sandbox.level.format.look import colour_of, look_when_added

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

_STYLES = {"marble": MARBLED, "stripe": STRIPED, "steel": STUDDED, "sand": STRIPED, "bumper": PLAIN, "plain": PLAIN}
STEEL_BALL, STUD, WHITE, SAND_MARK = 0x8D99B0, 0x39435A, 0xFFFFFF, 0xB97F3A
# Smallest ball, and pins [pixels at scale 1].
LEAST, PIN, PIN_RIM, PIN_SLOT = 2.5, 3.5, 4.4, 2.5
# A pin is a screw: its head, its rim, and the slot in it.
SCREW, SCREW_RIM, SCREW_SLOT = 0xB4BCC9, 0x141924, 0x4A5363


def added_balls(slots: Slots, state: Seen) -> list[Ball]:
    """Particles that joined the world while it ran."""
    looks = [(slot, look_when_added(k, float(state.radius[slot]))) for k, slot in enumerate(slots.tolist())]
    return [Ball(slot, look.ball or "", colour_of(look.colour or "")) for slot, look in looks]


class Balls:
    """Loose particles of a level, and those that joined the world while it ran, that are there."""

    def __init__(self, level_slots: LevelSlots, state: Seen, strangers: Slots) -> None:
        there = [ball for ball in level_slots.balls if state.particle_active[ball.slot]]
        # A small one that is held is a pin.
        shown = [
            ball for ball in there
            if state.inverse_mass[ball.slot] > 0.0 or state.radius[ball.slot] > 2.0 * BODY_RADIUS
        ]  # fmt: skip
        shown += added_balls(strangers, state)
        self.slots = np.array([ball.slot for ball in shown], dtype=np.int64)
        self._style = np.array([_STYLES[ball.kind] for ball in shown], dtype=np.int64)
        own = [_colour(k, ball) for k, ball in enumerate(shown)]
        self._colour = np.array(own, dtype=np.int64)
        marks = {"steel": STUD, "sand": SAND_MARK}
        self._mark = np.array([marks.get(ball.kind, WHITE) for ball in shown], dtype=np.int64)
        balls = set(self.slots.tolist())
        bumpers = {ball.slot for ball in shown if ball.kind == "bumper"}
        held = np.flatnonzero(state.particle_active & (state.inverse_mass == 0.0))
        self.pins = np.array([slot for slot in held.tolist() if slot not in balls], dtype=np.int64)
        self.pins = self.pins[np.isin(self.pins, level_slots.particles)]
        self._held = np.array([slot for slot in held.tolist() if slot in balls - bumpers], dtype=np.int64)

    def radii(self, frame: Frame) -> Floats:
        """Radii (n,) [pixels] of the balls."""
        return np.maximum(frame.state.radius[self.slots] * frame.zoom, LEAST * min(frame.scale, 1.0))

    def thrown(self, frame: Frame) -> Floats:
        """Discs (k, 3) [pixels] that throw shadows."""
        return np.column_stack([frame.at[self.slots], self.radii(frame)])

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw the balls."""
        if len(self.slots):
            angle = frame.angle[self.slots]
            # Pixels count downwards.
            turn = np.column_stack([np.cos(angle), -np.sin(angle)])
            marks.balls(frame.at[self.slots], self.radii(frame), turn, self._colour, self._mark, self._style)

    def mark_pins(self, marks: MarkList, frame: Frame) -> None:
        """Draw what is held."""
        for slots, size in ((self.pins, 1.0), (self._held, 0.55)):
            at, k = frame.at[slots], frame.scale * size
            marks.discs(at, PIN_RIM * k, SCREW_RIM, 0.9)
            marks.discs(at, PIN * k, SCREW)
            half = np.array([PIN_SLOT, -PIN_SLOT]) * k
            marks.strokes(np.column_stack([at - half, at + half]), 0.6 * k, SCREW_SLOT)


def _colour(k: int, ball: Ball) -> int:
    if ball.colour is not None:
        return ball.colour
    return SANDS[k % len(SANDS)] if ball.kind == "sand" else STEEL_BALL
