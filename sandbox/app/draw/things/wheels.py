"""What turns: wheels with tyre or steel ring, lugs, spokes and hub; balls with a mark; and pins, which hold."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.colours import SANDS, STEEL, packed
from sandbox.app.draw.raster.mark_kernels import MARBLED, PLAIN, STRIPED, STUDDED
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.textures import TILE
from sandbox.app.draw.things.level_slots import Actor, Ball, Frame, LevelSlots, Seen
from sandbox.app.draw.things.members import PIECES, curved
from sandbox.app.draw.things.soft import Shape
from sandbox.level.format.limits import BODY_RADIUS
from sandbox.level.format.look import colour_of, look_when_added

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
        """Draw the lugs under the tyre."""
        outer, hub = frame.at[self.outer], frame.at[self.hub]
        size = _size(outer - hub)
        if not self.is_tyre or size < LUGS_FROM:
            return
        middle = 0.5 * (outer + np.roll(outer, -1, axis=0))
        feet = np.concatenate([outer, middle])
        out = feet - hub
        out = out / np.maximum(np.sqrt(np.sum(out * out, axis=1)), 1e-9)[:, None]
        tips = hub + out * (size + self.radius * frame.zoom + LUG * size)
        half = max(1.5, min(0.055 * size, 1.2 * size / len(feet)))
        marks.strokes(np.concatenate([feet, tips], axis=1), half, packed(frame.theme.tyre))

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
        """Draw pins on balls that are pinned or held."""
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
