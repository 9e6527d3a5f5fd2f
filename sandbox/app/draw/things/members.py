"""What is drawn along springs: bars with bolts; coils, muscles and pistons; ropes, chains, cables and threads."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.colours import outline_of
from sandbox.app.draw.looks import Look
from sandbox.app.draw.raster.mark_kernels import DISC, STRIP, STROKE
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.textures import TILE
from sandbox.app.draw.things.level_slots import Actor, Frame, Join, chains_of

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

# Half widths of bars: as a part of their body's cells, from [pixels], to [pixels at scale 1].
TRUSS = (0.11, 1.6, 4.2)
MESH = (0.075, 1.0, 3.4)
LOOSE = (0.1, 1.2, 2.6)
BRACE = 0.62
# Cells narrower than this [pixels] are of plain lines; below the second, without bolts; and so are more members.
PLAIN_BELOW, BOLTS_FROM, MOST_STRIPS = 5.0, 9.0, 2_000
PLAIN_HALF = 0.8
LINE = 1.0
PLANKS_A_CELL = 3.0
_LINES = {"bone": 0x4A3A28, "wood": 0x3A2614, "deck": 0x2A1D12, "brass": 0x3A2A10, "rubber": 0x3A1418}
_BOLTS = {"bone": 0xFFF4DE, "brass": 0xF2CE7C, "wood": 0xD8A970}
_PLAIN = {"bone": 0xF0E4CC, "brass": 0xE2B04E, "wood": 0xC8935A, "rubber": 0xEB605C, "muscle": 0xDE5462}


@dataclass(eq=False)
class _Bars:
    """Bars alike: pairs (m, 2) of slots, springs (m,), cell [m], one or of each, size as above, fraction of it."""

    pairs: Slots
    springs: Slots
    cell: float | Floats
    size: tuple[float, float, float]
    thickness: float
    kind: str
    colour: int
    bolts: Slots
    deck: Slots


class Members:
    """Bars of a level whose springs are there."""

    def __init__(self) -> None:
        self._bars: list[_Bars] = []
        self._plan: _Plan | None = None
        self._key: tuple[object, ...] = ()
        self.count = 0

    def _add(self, bars: _Bars) -> None:
        self._bars.append(bars)
        self._plan = None
        self.count += len(bars.pairs)

    def add_actor(self, actor: Actor, there: NDArray[np.bool_]) -> None:
        """Add the springs of a body that are there (m,), as bars; what hangs from filled pieces has no bolts."""
        ends, springs, look = actor.ends[there], actor.springs[there], actor.look
        if not len(ends) or look.line == "hidden":
            return
        none = np.zeros(0, dtype=np.int64)
        bolts = none if actor.is_filled and look.skin != "lattice" else np.unique(ends)
        if actor.body.type not in ("bridge", "girder"):
            self._add(_Bars(ends, springs, actor.cell, MESH, look.width, look.line, look.colour, bolts, none))
            return
        # The first row has one particle more than there are cells, or as many as the second has.
        row = actor.pairs[there] > int(actor.body.__dict__["segments"])
        chord = row[:, 0] == row[:, 1]
        is_bridge = actor.body.type == "bridge"
        deck = np.flatnonzero(chord & ~row[:, 0]) if is_bridge else none
        for chosen, thickness, planks in (
            (~chord, BRACE, none),
            (chord, 1.0, np.searchsorted(np.flatnonzero(chord), deck)),
        ):
            self._add(
                _Bars(
                    ends[chosen], springs[chosen], actor.cell, TRUSS, thickness * look.width, look.line, look.colour,
                    bolts if thickness == 1.0 else none, planks,
                )
            )  # fmt: skip

    def add_joins(self, look: Look, pairs: Slots, springs: Slots, rest: Floats) -> None:
        """Loose springs of one look, of rest lengths (m,) [m]."""
        none = np.zeros(0, dtype=np.int64)
        self._add(_Bars(pairs, springs, rest, LOOSE, look.width, look.line, look.colour, none, none))

    def thrown(self, frame: Frame) -> Floats:
        """Lines (m, 5) [pixels] that throw shadows."""
        plan = self._plan_for(frame)
        return np.column_stack([frame.ends(plan.pairs), plan.half + LINE])

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw the bars."""
        plan = self._plan_for(frame)
        if not len(plan.slots):
            return
        ends = frame.ends(plan.slots)
        ends[:, 1::2] -= plan.raised[:, None]
        colour, alpha, along = plan.colour.copy(), plan.alpha.copy(), plan.along.copy()
        tint, by = frame.flush(plan.springs)
        apart = ends[plan.strips, 2:] - ends[plan.strips, :2]
        length = np.sqrt(apart[:, 0] ** 2 + apart[:, 1] ** 2)
        along[plan.strips, 1] = length / (8.0 * plan.width[plan.strips])
        own = plan.spring_of[plan.strips]
        colour[plan.strips], alpha[plan.strips] = tint[own], by[own]
        own = plan.spring_of[plan.plain]
        colour[plan.plain] = np.where(by[own] > 0.15, tint[own], colour[plan.plain])
        marks.rows(ends, plan.width, colour, alpha, plan.kind, plan.tile, along)

    def _plan_for(self, frame: Frame) -> "_Plan":
        # As long as a metre is as large, only places and strains are others.
        key = frame.zoom, frame.scale, frame.tiles
        if self._plan is None or self._key != key:
            sketch = _Sketch(self.count, frame)
            for bars in self._bars:
                sketch.add(bars)
            self._plan, self._key = sketch.plan(), key
        return self._plan


@dataclass(eq=False)
class _Plan:
    """Marks (r,) of all bars at one size of a metre.

    pairs (m, 2) of slots and half widths (m,) [pixels] of bars, and their springs (m,). Of marks: slots (r, 2),
    spring_of (r,) by index, how far they are raised [pixels], and the columns of a MarkList; strips, plain: those whose
    colour is that of strain.
    """

    pairs: Slots
    half: Floats
    springs: Slots
    slots: Slots
    spring_of: Slots
    raised: Floats
    width: Floats
    colour: Slots
    alpha: Floats
    kind: Slots
    tile: Slots
    along: Floats
    strips: Slots
    plain: Slots


# What a mark shows of its spring's strain.
_NOTHING, _AS_TINT, _AS_COLOUR = range(3)


class _Sketch:
    """Collects the marks of bars, in the order in which they are drawn."""

    def __init__(self, count: int, frame: Frame) -> None:
        self._count, self._frame = count, frame
        none = np.zeros(0, dtype=np.int64)
        self._bars: list[tuple[Slots, Floats, Slots]] = [(none.reshape(0, 2), np.zeros(0), none)]
        self._rows: list[tuple[NDArray[Any], ...]] = []
        self._first = 0
        self._mark(none.reshape(0, 2), 0.0, 0, 0.0, STROKE)

    def _mark(
        self, slots: Slots, width: Floats | float, colour: int, alpha: float, kind: int, tile: int = 0,
        planks: float = 0.0, raised: Floats | float = 0.0, shows: int = _NOTHING,
    ) -> None:  # fmt: skip
        count = len(slots)
        columns = (width, colour, alpha, kind, tile, planks, raised, shows)
        own = self._first + np.arange(count) if shows else np.zeros(count, dtype=np.int64)
        self._rows.append((slots, own, *(np.broadcast_to(column, count) for column in columns)))

    def add(self, bars: _Bars) -> None:
        """Add bars that share a look."""
        if not len(bars.pairs):
            return
        frame, pairs = self._frame, bars.pairs
        half = self._half(bars)
        spacing = float(np.median(bars.cell)) * frame.zoom
        if spacing < PLAIN_BELOW or self._count > MOST_STRIPS:
            colour = bars.colour if bars.kind == "paint" else _PLAIN.get(bars.kind, 0x96A3BA)
            thin = min(PLAIN_HALF * max(frame.scale, 1.0), max(0.4, 0.2 * spacing))
            self._mark(pairs, thin, colour, 1.0, STROKE, shows=_AS_COLOUR)
        else:
            line = outline_of(bars.colour) if bars.kind == "paint" else _LINES.get(bars.kind, 0x161B26)
            tile = frame.tiles.bar(bars.colour) if bars.kind == "paint" else TILE.get(bars.kind, TILE["steel"])
            self._mark(pairs, half + LINE * frame.scale, line, 0.75, STROKE)
            self._mark(pairs, half, 0, 0.0, STRIP, tile, shows=_AS_TINT)
            if len(bars.deck):
                self._add_deck(pairs[bars.deck], half[bars.deck])
            if len(bars.bolts) and spacing >= BOLTS_FROM:
                self._add_bolts(np.column_stack([bars.bolts, bars.bolts]), float(half[0]), line, bars)
        self._bars.append((pairs, half, bars.springs))
        self._first += len(pairs)

    def _half(self, bars: _Bars) -> Floats:
        """Half widths (m,) [pixels]."""
        part, least, most = bars.size
        scale, usual = self._frame.scale, bars.cell * (self._frame.zoom * part)
        half = np.minimum(most * scale, np.maximum(least * min(scale, 1.0), usual))
        return np.array(np.broadcast_to(half * bars.thickness, len(bars.pairs)))

    def _add_deck(self, pairs: Slots, half: Floats) -> None:
        up = 1.15 * half
        self._mark(pairs, half + LINE * self._frame.scale, _LINES["deck"], 0.8, STROKE, raised=up)
        self._mark(pairs, 0.95 * half, 0, 0.0, STRIP, TILE["deck"], PLANKS_A_CELL, up)

    def _add_bolts(self, slots: Slots, half: float, line: int, bars: _Bars) -> None:
        is_truss = bars.size is TRUSS
        sizes = (1.35, 1.05, 0.42) if is_truss else (1.7, 1.25, 0.5)
        bolt = _BOLTS.get(bars.kind, 0xB9C4D8)
        if bars.kind == "paint":
            # A gusset in a lighter shade of the paint.
            bolt = sum(min(255, int(((bars.colour >> s) & 255) * 0.8 + 62)) << s for s in (16, 8, 0))
        for size, colour, alpha in zip(sizes, (line, bolt, line), (0.85, 1.0, 0.8), strict=True):
            self._mark(slots, size * half, colour, alpha, DISC)

    def plan(self) -> _Plan:
        """The marks of all bars, in the order in which they are drawn."""
        pairs, half, springs = (np.concatenate(column) for column in zip(*self._bars, strict=True))
        slots, own, width, colour, alpha, kind, tile, planks, raised, shows = (
            np.concatenate(column) for column in zip(*self._rows, strict=True)
        )
        along = np.column_stack([np.zeros(len(planks)), planks])
        return _Plan(
            pairs, half, springs, slots, own, raised.astype(np.float64), width.astype(np.float64), colour,
            alpha.astype(np.float64), kind, tile, along, np.flatnonzero(shows == _AS_TINT),
            np.flatnonzero(shows == _AS_COLOUR),
        )  # fmt: skip


TURNS = 6
PARTS = 8
DARK, MUSCLE_LINE, CYLINDER = 0x161B26, 0x4A1622, 0xF6B83E


class Working:
    """Loose springs of one kind each, that are there."""

    def __init__(self, joins: list[Join]) -> None:
        self._kinds = {}
        for kind in ("coil", "muscle", "piston"):
            own = [join for join in joins if join.look.line == kind]
            self._kinds[kind] = (
                np.array([join.ends for join in own], dtype=np.int64).reshape(-1, 2),
                np.array([join.spring for join in own], dtype=np.int64),
                np.array([join.look.width for join in own], dtype=np.float64),
            )

    def thrown(self, frame: Frame) -> Floats:
        """Lines (m, 5) [pixels] that throw shadows."""
        pairs = np.concatenate([pairs for pairs, _, _ in self._kinds.values()])
        return np.column_stack([frame.ends(pairs), np.full(len(pairs), 3.0 * frame.scale)])

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw the coils, muscles and pistons."""
        for kind, draw in (("coil", _coils), ("muscle", _muscles), ("piston", _pistons)):
            pairs, springs, width = self._kinds[kind]
            if len(pairs):
                draw(frame.ends(pairs), frame.state.rest_length[springs] * frame.zoom, width, marks, frame)


def _lengthwise(ends: Floats) -> tuple[Floats, Floats, Floats]:
    along = ends[:, 2:] - ends[:, :2]
    length = np.maximum(np.sqrt(np.sum(along * along, axis=1)), 1e-6)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) / length[:, None]
    return along, across, length


def _joined(points: Floats) -> Floats:
    """Lines (m (k - 1), 4) through points (m, k, 2)."""
    return np.concatenate([points[:, :-1], points[:, 1:]], axis=2).reshape(-1, 4)


def _coils(ends: Floats, rest: Floats, width: Floats, marks: MarkList, frame: Frame) -> None:
    along, across, _ = _lengthwise(ends)
    wide = np.clip(0.13 * rest, 2.5 * frame.scale, 8.0 * frame.scale) * width
    place = np.r_[0.0, np.linspace(0.12, 0.88, 2 * TURNS + 1), 1.0]
    side = np.where(np.arange(len(place)) % 2 == 0, 1.0, -1.0)
    side[[0, 1, -2, -1]] = 0.0
    points = ends[:, None, :2] + along[:, None] * place[:, None] + across[:, None] * (side * wide[:, None])[..., None]
    lines = _joined(points)
    marks.strokes(lines, 2.5 * frame.scale, DARK, 0.75)
    tone = np.where(np.arange(len(place) - 1) % 2 == 0, 0xE8EDF6, 0x8E9AB2)
    marks.strokes(lines, 1.5 * frame.scale, np.tile(tone, len(ends)))


def _muscles(ends: Floats, rest: Floats, width: Floats, marks: MarkList, frame: Frame) -> None:
    # Thick where short: what it holds stays the same.
    along, _, length = _lengthwise(ends)
    belly = np.clip(0.16 * rest * rest / length, 2.5 * frame.scale, 11.0 * frame.scale) * width
    place = np.linspace(0.0, 1.0, PARTS + 1)
    lines = _joined(ends[:, None, :2] + along[:, None] * place[:, None])
    middle = np.sin(0.5 * np.pi * (place[:-1] + place[1:])) ** 1.3
    half = (1.6 * frame.scale + belly[:, None] * middle).reshape(-1)
    marks.strokes(lines, half + 1.2 * frame.scale, MUSCLE_LINE)
    period = np.tile(np.column_stack([place[:-1], place[1:]]) * 2.0, (len(ends), 1))
    marks.strips(lines, half, TILE["muscle"], period)


def _pistons(ends: Floats, rest: Floats, width: Floats, marks: MarkList, frame: Frame) -> None:
    # A rod that slides in a cylinder of half its greatest length.
    along, _, length = _lengthwise(ends)
    half = np.clip(0.07 * rest, 2.0, 4.5 * frame.scale) * width
    period = np.column_stack([np.zeros(len(ends)), length / (8.0 * half)])
    case = np.concatenate([ends[:, :2], ends[:, :2] + 0.55 * along], axis=1)
    marks.strokes(ends, 0.5 * half + frame.scale, DARK, 0.8)
    marks.strips(ends, 0.5 * half, TILE["steel"], period)
    marks.strokes(case, half + frame.scale, DARK, 0.9)
    marks.strips(case, half, frame.tiles.bar(CYLINDER), period)


# Half widths [pixels at scale 1], at most this part of the length between particles, and at least so much.
HALF = {"rope": 3.4, "cable": 2.6, "chain": 4.6, "deck": 6.0, "thread": 1.2, "silk": 0.9}
MOST_OF_STEP, LEAST = 0.45, 0.55
# A rope of one spring hangs something up on others: it has this part of their width.
HANGER = 0.62
# Length of the pattern, in half widths.
PERIOD = {"chain": 5.6, "deck": 2.0}
USUAL_PERIOD = 6.5
_STRAND_LINES = {"rope": 0x5B3D20, "deck": 0x4A2E16, "cable": 0x3A4252}
# Pieces that a curve has between two particles, from a length [pixels] on.
PIECES, CURVED_FROM = 3, 6.0
# Corners of its way from which on a stretch is a curve [pixels]: it leaves the straight line by a twelfth of that.
LEAST_BEND = 2.5


class Strands:
    """All strands of a level that are there: stretches between two particles, with their neighbours on the way."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, float], list[tuple[Slots, Floats, Slots]]] = {}
        self._groups: list[tuple[str, float, Slots, Floats, Slots, float]] | None = None

    def add(self, look: Look, ends: Slots, springs: Slots, rest: Floats) -> None:
        """Springs (m,) between slots (m, 2), of rest lengths (m,) [m]."""
        self._groups = None
        for particles, order in chains_of(ends):
            before, after = np.r_[-1, particles[:-1]], np.r_[particles[2:], -1]
            if particles[0] == particles[-1] and len(particles) > 3:
                before[0], after[-1] = particles[-2], particles[1]
            rows = np.stack([before[:-1], particles[:-1], particles[1:], after], axis=1)
            width = look.width * (HANGER if look.line == "rope" and len(particles) == 2 else 1.0)
            self._found.setdefault((look.line, width), []).append((rows, rest[order], springs[order]))

    def groups(self) -> list[tuple[str, float, Slots, Floats, Slots, float]]:
        """Of each kind: kind, width, stretches (m, 4), metres at their ends (m, 2), springs (m,), a usual length."""
        if self._groups is None:
            self._groups = []
            for (kind, width), found in self._found.items():
                rows, rest, springs = (np.concatenate(part) for part in zip(*found, strict=True))
                # Each strand's pattern starts over.
                metres = np.concatenate([np.cumsum(own) for _, own, _ in found])
                along = np.column_stack([metres - rest, metres])
                self._groups.append((kind, width, rows, along, springs, float(np.median(rest)) if len(rest) else 1.0))
        return self._groups

    @staticmethod
    def half(kind: str, width: float, step: float, frame: Frame) -> float:
        """Half the width [pixels] of a kind with particles `step` [m] apart."""
        least = LEAST * max(frame.scale, 0.8)
        return max(min(HALF[kind] * width * frame.scale, MOST_OF_STEP * step * frame.zoom), least)

    def thrown(self, frame: Frame) -> Floats:
        """Lines (m, 5) [pixels] that throw shadows."""
        rows = [np.zeros((0, 5))]
        for kind, width, stretches, _, _, step in self.groups():
            half = np.full(len(stretches), self.half(kind, width, step, frame))
            rows.append(np.column_stack([frame.ends(stretches[:, 1:3]), half]))
        return np.concatenate(rows)

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw the strands."""
        for kind, width, stretches, metres, springs, step in self.groups():
            half = self.half(kind, width, step, frame)
            pieces = PIECES if step * frame.zoom > CURVED_FROM else 1
            along = metres * (frame.zoom / (PERIOD.get(kind, USUAL_PERIOD) * half))
            tint, by = frame.flush(springs)
            if pieces == 1:
                ends = frame.ends(stretches[:, 1:3])
            else:
                ends, whose, part = curved(frame.at, stretches, pieces)
                first = along[whose, :1]
                along, tint, by = first + (along[whose, 1:] - first) * part, tint[whose], by[whose]
            if kind in _STRAND_LINES:
                marks.strokes(ends, half + 0.9 * frame.scale, _STRAND_LINES[kind])
            marks.strips(ends, half, TILE[kind], along, tint, by)


def curved(at: Floats, stretches: Slots, pieces: int) -> tuple[Floats, Slots, Floats]:
    """Lines (k, 4) of Catmull-Rom curves through stretches (m, 4) of particles; -1 = goes straight on.

    And whose they are (k,), and which part (k, 2) of it. One that would not be seen to bend is one line.
    """
    points = at[stretches]
    a, b, c, d = (points[:, k] for k in range(4))
    for missing, end, near, far in ((stretches[:, 0] < 0, a, b, c), (stretches[:, 3] < 0, d, c, b)):
        end[missing] = 2.0 * near[missing] - far[missing]
    bends = np.maximum(np.abs(a - 2.0 * b + c), np.abs(b - 2.0 * c + d)).max(axis=1)
    bent = np.flatnonzero(bends > LEAST_BEND)
    straight = np.flatnonzero(~(bends > LEAST_BEND))
    t = np.arange(pieces + 1) / pieces
    weights = 0.5 * np.stack([
        -t + 2 * t**2 - t**3, 2 - 5 * t**2 + 3 * t**3, t + 4 * t**2 - 3 * t**3, t**3 - t**2
    ], axis=1)  # fmt: skip
    curve = (weights @ points[bent].transpose(1, 0, 2).reshape(4, -1)).reshape(pieces + 1, len(bent), 2)
    lines = np.concatenate([curve[:-1], curve[1:]], axis=2).reshape(-1, 4)
    ends = np.concatenate([np.concatenate([b[straight], c[straight]], axis=1), lines])
    part = np.repeat(np.column_stack([t[:-1], t[1:]]), len(bent), axis=0)
    whole = np.broadcast_to([0.0, 1.0], (len(straight), 2))
    return ends, np.concatenate([straight, np.tile(bent, pieces)]), np.concatenate([whole, part])
