"""Members: straight bars of bridges, girders, meshes and loose springs, with bolts where they meet."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.looks import Look
from sandbox.app.draw.raster.mark_kernels import DISC, STRIP, STROKE
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.textures import TILE
from sandbox.app.draw.themes import outline_of
from sandbox.app.draw.things.frame import Frame
from sandbox.app.draw.things.level_slots import Actor

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
    """Bars alike: pairs (m, 2) of slots, springs (m,), cell [m], one or of each, size as above, share of it."""

    pairs: Slots
    springs: Slots
    cell: float | Floats
    size: tuple[float, float, float]
    share: float
    kind: str
    colour: int
    bolts: Slots
    deck: Slots


class Members:
    """All bars of a level that are there."""

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
        """The springs of a body that are there (m,), as bars; what hangs from filled pieces has no bolts."""
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
        for chosen, share, planks in (
            (~chord, BRACE, none),
            (chord, 1.0, np.searchsorted(np.flatnonzero(chord), deck)),
        ):
            self._add(
                _Bars(
                    ends[chosen], springs[chosen], actor.cell, TRUSS, share * look.width, look.line, look.colour,
                    bolts if share == 1.0 else none, planks,
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
        """Add bars of one look."""
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
        return np.array(np.broadcast_to(half * bars.share, len(bars.pairs)))

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
