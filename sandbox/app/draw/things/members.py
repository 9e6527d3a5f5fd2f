"""Members: straight bars of bridges, girders, meshes and loose springs, with bolts where they meet."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.looks import Look
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.textures import TILE
from sandbox.app.draw.themes import outline_of
from sandbox.app.draw.things.cast import Actor
from sandbox.app.draw.things.frame import Frame

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
        self.count = 0

    def _add(self, bars: _Bars) -> None:
        self._bars.append(bars)
        self.count += len(bars.pairs)

    def add_actor(self, actor: Actor, there: NDArray[np.bool_]) -> None:
        """The springs of a body that are there (m,), as bars."""
        ends, springs, look = actor.ends[there], actor.springs[there], actor.look
        if not len(ends) or look.line == "hidden":
            return
        none = np.zeros(0, dtype=np.int64)
        bolts = np.unique(ends)
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

    def add_strangers(self, pairs: Slots, springs: Slots, rest: Floats) -> None:
        """Springs that joined the world while it ran."""
        if len(springs):
            none = np.zeros(0, dtype=np.int64)
            self._add(_Bars(pairs, springs, rest[springs], LOOSE, 1.0, "steel", 0, none, none))

    @staticmethod
    def _half(bars: _Bars, frame: Frame) -> Floats:
        """Half widths (m,) [pixels]."""
        part, least, most = bars.size
        half = np.minimum(
            most * frame.scale, np.maximum(least * min(frame.scale, 1.0), bars.cell * (frame.zoom * part))
        )
        return np.asarray(np.broadcast_to(half * bars.share, len(bars.pairs)))

    def thrown(self, frame: Frame) -> Floats:
        """Lines (m, 5) [pixels] that throw shadows."""
        rows = [np.column_stack([frame.ends(bars.pairs), self._half(bars, frame) + LINE]) for bars in self._bars]
        return np.concatenate([np.zeros((0, 5)), *rows])

    def mark(self, marks: MarkList, frame: Frame) -> None:
        """Draw them."""
        for bars in self._bars:
            self._mark(bars, marks, frame)

    def _mark(self, bars: _Bars, marks: MarkList, frame: Frame) -> None:
        if not len(bars.pairs):
            return
        ends, half = frame.ends(bars.pairs), self._half(bars, frame)
        tint, by = frame.flush(bars.springs)
        spacing = float(np.median(bars.cell)) * frame.zoom
        if spacing < PLAIN_BELOW or self.count > MOST_STRIPS:
            colour = bars.colour if bars.kind == "paint" else _PLAIN.get(bars.kind, 0x96A3BA)
            shown = np.where(by > 0.15, tint, colour)
            marks.strokes(ends, min(PLAIN_HALF * max(frame.scale, 1.0), max(0.4, 0.2 * spacing)), shown)
            return
        line = outline_of(bars.colour) if bars.kind == "paint" else _LINES.get(bars.kind, 0x161B26)
        marks.strokes(ends, half + LINE * frame.scale, line, 0.75)
        apart = ends[:, 2:] - ends[:, :2]
        length = np.sqrt(apart[:, 0] ** 2 + apart[:, 1] ** 2)
        along = np.column_stack([np.zeros(len(ends)), length / (8.0 * half)])
        tile = frame.tiles.bar(bars.colour) if bars.kind == "paint" else TILE.get(bars.kind, TILE["steel"])
        marks.strips(ends, half, tile, along, tint, by)
        if len(bars.deck):
            self._mark_deck(ends[bars.deck], half[bars.deck], marks, frame)
        if len(bars.bolts) and spacing >= BOLTS_FROM:
            self._mark_bolts(frame.at[bars.bolts], float(half[0]), line, bars, marks)

    @staticmethod
    def _mark_deck(ends: Floats, half: Floats, marks: MarkList, frame: Frame) -> None:
        up = ends - 1.15 * half[:, None] * np.array([0.0, 1.0, 0.0, 1.0])
        marks.strokes(up, half + LINE * frame.scale, _LINES["deck"], 0.8)
        marks.strips(up, 0.95 * half, TILE["deck"], np.array([0.0, PLANKS_A_CELL]))

    @staticmethod
    def _mark_bolts(at: Floats, half: float, line: int, bars: _Bars, marks: MarkList) -> None:
        is_truss = bars.size is TRUSS
        sizes = (1.35, 1.05, 0.42) if is_truss else (1.7, 1.25, 0.5)
        bolt = _BOLTS.get(bars.kind, 0xB9C4D8)
        if bars.kind == "paint":
            # A gusset in a lighter shade of the paint.
            bolt = sum(min(255, int(((bars.colour >> s) & 255) * 0.8 + 62)) << s for s in (16, 8, 0))
        for size, colour, alpha in zip(sizes, (line, bolt, line), (0.85, 1.0, 0.8), strict=True):
            marks.discs(at, size * half, colour, alpha)
