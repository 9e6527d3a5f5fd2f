"""Effects: sparks of what tears, dust of what hits, drops of what splashes. The eye's memory, never part of a run."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import SPARK, SPARK_GLOW, Theme, packed
from sandbox.app.draw.raster.painter import MarkList
from sandbox.physics.analysis.query import shown_springs
from sandbox.physics.marks import NO_EDGE
from sandbox.physics.snapshot import Snapshot

Floats = NDArray[np.float64]

# At most this many at a time; of one moment at most this many places.
MOST_SPARKS, MOST_DUST, MOST_DROPS, PLACES = 240, 80, 200, 16
SPARKS_A_TEAR = 9
# Change of velocity [m/s] in a frame from which a contact raises dust.
HARD = 2.2
FALL = 9.8
LIVES = {"spark": (0.25, 0.6), "dust": (0.35, 0.9), "drop": (0.35, 0.8)}
# From what speed [m/s] on something that goes through a surface of water splashes; drops of it a m/s, and the fastest.
SPLASH, DROPS_A_SPEED, FASTEST_DROP = 0.9, 2.0, 5.0
# How long [s] the lattice shows where something broke, how many places of it, and how large [pixels at scale 1].
CROSS_LIFE, MOST_CROSSES, CROSS = 1.5, 64, 5.0
# Longest time [s] that passes for them in a frame.
LONGEST = 0.1
TAIL = 0.028

DRY: Floats = np.zeros((0, 4))


@dataclass
class _Motes:
    """Rows of place [m], velocity [m/s], age, life [s], size [m]."""

    most: int
    rows: Floats = field(default_factory=lambda: np.zeros((0, 7)))

    def add(self, at: Floats, velocity: Floats, life: Floats, size: Floats) -> None:
        new = np.column_stack([at, velocity, np.zeros(len(at)), life, size])
        self.rows = np.concatenate([self.rows, new])[-self.most :]

    def pass_time(self, seconds: float, fall: float, slow: float) -> None:
        rows = self.rows
        rows[:, 3] -= fall * seconds
        rows[:, 2:4] *= max(0.0, 1.0 - slow * seconds)
        rows[:, :2] += rows[:, 2:4] * seconds
        rows[:, 4] += seconds
        self.rows = rows[rows[:, 4] < rows[:, 5]]


class Effects:
    """Dust, drops, sparks and marks of breaks on one screen."""

    def __init__(self) -> None:
        self._forget()
        self._before: Snapshot | None = None
        self._seconds = 0.0

    def _forget(self) -> None:
        self._sparks, self._dust, self._crosses = _Motes(MOST_SPARKS), _Motes(MOST_DUST), _Motes(MOST_CROSSES)
        self._drops = _Motes(MOST_DROPS)

    @property
    def is_at_rest(self) -> bool:
        """Whether nothing flies about."""
        return not any(len(motes.rows) for motes in (self._sparks, self._dust, self._crosses, self._drops))

    def see(self, now: Snapshot, seconds: float, strikes: NDArray[np.bool_] | None, pools: Floats = DRY) -> None:
        """Take in a snapshot, shown at a time [s] of the run.

        strikes (m,): springs that spark when they tear; pools (k, 4): left, bottom, right and top of water [m].
        """
        before, passed = self._before, seconds - self._seconds
        self._before, self._seconds = now, seconds
        if before is None or now.tick < before.tick or len(now.mass) != len(before.mass) or passed < 0.0:
            self._forget()
            return
        self._sparks.pass_time(min(passed, LONGEST), FALL, 0.0)
        self._dust.pass_time(min(passed, LONGEST), 0.0, 3.0)
        self._crosses.pass_time(min(passed, LONGEST), 0.0, 0.0)
        self._drops.pass_time(min(passed, LONGEST), FALL, 0.0)
        if now.tick > before.tick:
            # By the tick, so that a run looks alike each time.
            rng = np.random.default_rng(now.tick)
            self._see_tears(before, now, rng, strikes)
            self._see_hits(before, now, rng)
            for left, _, right, top in pools.tolist():
                self._see_splashes(before, now, rng, (left, right, top))

    def _see_tears(
        self, before: Snapshot, now: Snapshot, rng: np.random.Generator, strikes: NDArray[np.bool_] | None
    ) -> None:
        if len(before.spring_active) != len(now.spring_active):
            return
        torn = np.flatnonzero(shown_springs(before) & ~now.spring_active)
        if not len(torn):
            return
        torn = torn[:: max(1, len(torn) // PLACES)]
        at = 0.5 * (before.position[before.particle_a[torn]] + before.position[before.particle_b[torn]])
        nothing = np.zeros(len(at))
        self._crosses.add(at, np.zeros_like(at), nothing + CROSS_LIFE, nothing)
        sparking = np.ones(len(torn), dtype=np.bool_) if strikes is None else np.append(strikes, False)[
            np.minimum(torn, len(strikes))
        ]  # fmt: skip
        where = np.repeat(at[sparking], SPARKS_A_TEAR, axis=0)
        angle, speed = rng.uniform(0.0, 2.0 * np.pi, len(where)), rng.uniform(1.5, 7.0, len(where))
        velocity = np.column_stack([speed * np.cos(angle), speed * np.sin(angle) + 1.5])
        self._sparks.add(where, velocity, rng.uniform(*LIVES["spark"], len(where)), np.zeros(len(where)))
        self._puff(at[~sparking], np.full(int(np.count_nonzero(~sparking)), 3), rng)

    def _see_hits(self, before: Snapshot, now: Snapshot, rng: np.random.Generator) -> None:
        touching = np.unique(now.contact_particle[now.contact_particle >= 0])
        touching = touching[touching < len(before.mass)]
        change = now.velocity[touching] - before.velocity[touching]
        jump = np.sqrt(np.sum(change * change, axis=1))
        hard = (jump > HARD) & np.isfinite(jump) & (now.inverse_mass[touching] > 0.0)
        hit = touching[hard][:: max(1, int(np.count_nonzero(hard)) // PLACES)]
        if len(hit):
            force = np.minimum(np.sqrt(np.sum((now.velocity[hit] - before.velocity[hit]) ** 2, axis=1)), 8.0)
            self._puff(now.position[hit], 1 + force.astype(np.int64) // 2, rng)

    def _see_splashes(
        self, before: Snapshot, now: Snapshot, rng: np.random.Generator, surface: tuple[float, float, float]
    ) -> None:
        left, right, top = surface
        (x, y), speed = now.position.T, np.abs(now.velocity[:, 1])
        passed = (before.position[:, 1] > top) != (y > top)
        with np.errstate(invalid="ignore"):
            splashing = np.flatnonzero(passed & (x > left) & (x < right) & (speed > SPLASH) & now.particle_active)
        splashing = splashing[_is_outside(now)[splashing]] if len(splashing) else splashing
        hit = splashing[np.argsort(-speed[splashing], kind="stable")[:PLACES]]
        count = (DROPS_A_SPEED * np.minimum(speed[hit], FASTEST_DROP)).astype(np.int64)
        fast, total = np.repeat(np.minimum(speed[hit], FASTEST_DROP), count), int(count.sum())
        if total:
            at = np.column_stack([np.repeat(x[hit], count) + rng.normal(0.0, 0.05, total), np.full(total, top)])
            way = np.column_stack([rng.normal(0.0, 0.3, total), rng.uniform(0.25, 0.75, total)])
            self._drops.add(
                at, fast[:, None] * way, rng.uniform(*LIVES["drop"], total), rng.uniform(0.012, 0.035, total)
            )

    def _puff(self, at: Floats, count: NDArray[np.int64], rng: np.random.Generator) -> None:
        where = np.repeat(at, count, axis=0)
        total = len(where)
        if total:
            velocity = np.column_stack([rng.normal(0.0, 0.8, total), np.abs(rng.normal(0.3, 0.4, total))])
            where = where + rng.normal(0.0, 0.08, (total, 2))
            self._dust.add(where, velocity, rng.uniform(*LIVES["dust"], total), rng.uniform(0.06, 0.2, total))

    def mark_dust(self, marks: MarkList, camera: Camera, theme: Theme, scale: float) -> None:
        """Draw dust, behind everything."""
        rows = self._dust.rows
        if len(rows):
            remaining = 1.0 - rows[:, 4] / rows[:, 5]
            size = np.clip(rows[:, 6] * camera.zoom * (1.6 + 1.8 * (1.0 - remaining)), 2.0, 48.0 * scale)
            marks.discs(camera.project(rows[:, :2]), size, packed(theme.dust), 0.4 * remaining, glow=True)

    def mark_drops(self, marks: MarkList, camera: Camera, theme: Theme, scale: float) -> None:
        """Draw drops, before everything."""
        rows = self._drops.rows
        if len(rows):
            remaining = 1.0 - rows[:, 4] / rows[:, 5]
            size = np.clip(rows[:, 6] * camera.zoom, 1.2 * scale, 5.0 * scale)
            marks.discs(camera.project(rows[:, :2]), size, packed(theme.foam), np.minimum(1.0, 2.0 * remaining))

    def mark_sparks(self, marks: MarkList, camera: Camera, scale: float) -> None:
        """Draw sparks, before everything."""
        rows = self._sparks.rows
        if len(rows):
            remaining = 1.0 - rows[:, 4] / rows[:, 5]
            at, tail = camera.project(rows[:, :2]), camera.project(rows[:, :2] - TAIL * rows[:, 2:4])
            marks.discs(at, 9.0 * scale * remaining + 1.0, SPARK_GLOW, 0.55 * remaining, glow=True)
            marks.strokes(np.concatenate([tail, at], axis=1), 1.2 * scale * remaining + 0.3, SPARK, remaining)

    def mark_breaks(self, marks: MarkList, camera: Camera, theme: Theme, scale: float) -> None:
        """Draw a cross where something broke a moment ago."""
        rows = self._crosses.rows
        if len(rows):
            at, remaining, arm = camera.project(rows[:, :2]), 1.0 - rows[:, 4] / rows[:, 5], CROSS * scale
            for side in (-1.0, 1.0):
                way = np.array([arm, side * arm])
                ends = np.concatenate([at - way, at + way], axis=1)
                for half, colour in ((2.4 * scale, theme.card), (1.1 * scale, theme.past)):
                    marks.strokes(ends, half, packed(colour), np.minimum(1.0, 3.0 * remaining))


def _is_outside(state: Snapshot) -> NDArray[np.bool_]:
    """Which particles (n,) are not inside a body: an edge ends there, or no spring."""
    inside, springs = np.zeros(len(state.mass), dtype=np.bool_), shown_springs(state)
    ends = np.stack([state.particle_a, state.particle_b], axis=1)
    inside[ends[springs & (state.edge == NO_EDGE)]] = True
    inside[ends[springs & (state.edge != NO_EDGE)]] = False
    return ~inside
