"""Painter: draws layers on a surface by kernels, or plainly by pygame while these are not compiled."""

import gc
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from weakref import WeakValueDictionary

import numpy as np
import pygame
from numpy.typing import ArrayLike, NDArray

from sandbox.app.draw.colours import unpacked
from sandbox.app.draw.raster.bodies import (
    FLUSH_CELL,
    INSIDE,
    LIT,
    SOFTNESS,
    WIDEST,
    BodyRows,
    BodyScratch,
    Flush,
    Outlines,
    Skins,
    paint_bodies,
)
from sandbox.app.draw.raster.mark_kernels import (
    ACROSS,
    ALONG,
    DISC,
    GLOW,
    HAIR,
    STRIP,
    STROKE,
    CellArrays,
    MarkArrays,
    paint_cells,
    paint_marks,
)
from sandbox.app.draw.raster.pixels import FAR, Loops, Pixels, Sheets, trace_outlines
from sandbox.app.draw.raster.shadows import FACTOR, ShadowScratch, Thrown, paint_shadows
from sandbox.physics import jit
from sandbox.physics.arrays import Floats, Slots

# A body whose outline has no grain.
NO_GRAIN = -1


class MarkList:
    """Collects marks of a layer, in the order in which they are drawn."""

    def __init__(self) -> None:
        # Ends of marks, and of each further column as many values, or one for all.
        self._rows: list[tuple[Floats, ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike]] = []

    def rows(
        self, ends: Floats, half: ArrayLike, colour: ArrayLike, alpha: ArrayLike, kind: ArrayLike,
        extra: ArrayLike = 0, along: ArrayLike = 0.0,
    ) -> None:  # fmt: skip
        """Marks of any kind, column by column as MarkArrays has them, or one value for all."""
        if len(ends):
            self._rows.append((ends, half, colour, alpha, kind, extra, along))

    def strokes(self, ends: Floats, half: ArrayLike, colour: ArrayLike, alpha: ArrayLike = 1.0) -> None:
        """Lines (m, 4) [pixels] of a half width (m,), 0xRRGGBB (m,), 0..1 (m,)."""
        self.rows(ends, half, colour, alpha, STROKE)

    def hairs(self, ends: Floats, colour: ArrayLike) -> None:
        """Lines (m, 4) [pixels] a pixel wide, with steps."""
        self.rows(ends, 0.5, colour, 1.0, HAIR)

    def strips(
        self, ends: Floats, half: ArrayLike, tile: ArrayLike, along: ArrayLike, tint: ArrayLike = 0, by: ArrayLike = 0.0
    ) -> None:
        """Lines with a tile (m,), periods of it at their ends (m, 2), and a colour (m,) laid over it by 0..1 (m,)."""
        self.rows(ends, half, tint, by, STRIP, tile, along)

    def discs(
        self, at: Floats, radius: ArrayLike, colour: ArrayLike, alpha: ArrayLike = 1.0, glow: bool = False
    ) -> None:
        """Discs at (m, 2) [pixels]; glow: they fade to nothing at their rim."""
        self.rows(np.concatenate([at, at], axis=1), radius, colour, alpha, GLOW if glow else DISC)

    def balls(
        self, at: Floats, radius: ArrayLike, turn: Floats, colour: ArrayLike, mark: ArrayLike, style: ArrayLike
    ) -> None:
        """Lit balls; turn (m, 2): cosine and sine, as seen; mark: the colour of what turns; style: a kind of mark."""
        self.rows(np.concatenate([at, turn], axis=1), radius, colour, 1.0, style, mark)

    def arrays(self) -> MarkArrays | None:
        """The marks as arrays for the kernels, None where there are none."""
        if not self._rows:
            return None
        count, last = sum(len(row[0]) for row in self._rows), 0
        floats, numbers = np.empty((2, count)), np.empty((3, count), dtype=np.int64)
        made = MarkArrays(
            np.empty((count, 4)), floats[0], numbers[0], floats[1], np.empty((count, 2)), numbers[1], numbers[2]
        )
        for ends, half, colour, alpha, kind, extra, along in self._rows:
            own, last = slice(last, last + len(ends)), last + len(ends)
            made.ends[own], made.half[own], made.colour[own], made.alpha[own] = ends, half, colour, alpha
            made.along[own], made.extra[own], made.kind[own] = along, extra, kind
        return made


@dataclass
class BodyLayer:
    """Bodies to draw: outlines (c + 1 starts), rows, skins and flush; fill (b,): colours where there is no light."""

    outlines: Outlines
    rows: BodyRows
    skins: Skins
    flush: Flush
    fill: Slots


@dataclass
class _Scratch:
    bodies: BodyScratch
    shadows: ShadowScratch
    place: Slots


@dataclass
class Painter:
    """Draws on one surface; compiled: whether kernels may be used, if they are compiled."""

    compiled: bool = True
    surface: pygame.Surface = field(init=False, repr=False)
    exact: bool = field(default=False, init=False)
    # That of the surface's size, once it has been drawn on with it.
    _scratch: _Scratch | None = field(default=None, init=False, repr=False)

    def begin(self, surface: pygame.Surface) -> bool:
        """Draw on a surface from now on, inside its clip; whether kernels do it."""
        self.surface = surface
        left, top, right, bottom = (*surface.get_clip().topleft, *surface.get_clip().bottomright)
        self.clip = np.array([left, top, right, bottom], dtype=np.int64)
        self.exact = self.compiled and jit.COMPILED and _has_plain_pixels(surface)
        return self.exact

    def pixels(self) -> Pixels:
        """The surface's pixels (h, w); while the array lives, the surface is locked."""
        return pygame.surfarray.pixels2d(self.surface).T

    def _paint(self, kernel: Callable[..., object], *arguments: object) -> None:
        kernel(self.pixels(), *arguments, self.clip)
        if self.surface.get_locked():
            # What compiling at this call has left behind holds the pixels, and nothing could be blitted any more.
            gc.collect()

    def marks(self, layer: MarkList, tiles: Sheets) -> None:
        """Draw marks."""
        arrays = layer.arrays()
        if arrays is None:
            return
        if self.exact:
            self._paint(paint_marks, arrays, tiles)
        else:
            _plain_marks(self.surface, arrays, tiles)

    def bodies(self, layer: BodyLayer) -> None:
        """Draw lit bodies."""
        if not len(layer.rows.loops):
            return
        if self.exact:
            self._scratch = scratch = _scratch_for(self.surface.get_size())
            self._paint(
                paint_bodies, layer.outlines, layer.rows, layer.skins, layer.flush, scratch.bodies, scratch.place
            )
        else:
            _plain_bodies(self.surface, layer)

    def cells(self, arrays: CellArrays, sheets: Slots) -> None:
        """Draw textured triangles."""
        if not len(arrays.sheet):
            return
        if self.exact:
            self._paint(paint_cells, arrays, sheets, np.zeros(9))
            return
        tones = sheets.reshape(len(sheets), -1)[:, 0].tolist()
        seen = (np.abs(arrays.corner) < FAR).all(axis=1)
        for corner, sheet in zip(arrays.corner[seen].tolist(), arrays.sheet[seen].tolist(), strict=True):
            pygame.draw.polygon(self.surface, unpacked(tones[sheet]), (corner[:2], corner[2:4], corner[4:]))

    def cut_out(self, outlines: Outlines, fill: int, cells: CellArrays, sheets: Slots) -> None:
        """Draw textured triangles as far as they lie inside outlines, where 0xRRGGBB fills what they leave."""
        left, top, right, bottom = self.clip.tolist()
        if not (len(outlines.point) and (np.abs(outlines.point) < FAR).all()):
            return
        low, high = np.floor(outlines.point.min(axis=0)), np.ceil(outlines.point.max(axis=0))
        box = pygame.Rect(low.tolist(), (high - low).tolist()).inflate(2, 2)
        box = box.clip((left, top, right - left, bottom - top))
        if not box.size[0] * box.size[1]:
            return
        laid, cover = np.full(box.size[::-1], fill, dtype=np.uint32), np.zeros(box.size[::-1], dtype=np.uint32)
        clip, corner = np.array([0, 0, *box.size], dtype=np.int64), np.array(box.topleft, dtype=np.float64)
        paint_cells(laid, cells._replace(corner=cells.corner - np.tile(corner, 3)), sheets, np.zeros(9), clip)
        loops = np.array([[0, len(outlines.start) - 1]], dtype=np.int64)
        rows = BodyRows(loops, np.array([[0, NO_GRAIN, 0]]), np.zeros((1, 3)), np.zeros((1, 2), dtype=np.int64))
        self._scratch = scratch = _scratch_for(self.surface.get_size())
        paint_bodies(
            cover, Outlines(outlines.point - corner, outlines.start), rows, _WHITE, _UNSTRAINED, scratch.bodies,
            scratch.place, clip,
        )  # fmt: skip
        laid = laid & 0xFFFFFF | (cover & 0xFF) << 24
        self.surface.blit(pygame.image.frombuffer(laid.tobytes(), box.size, "BGRA"), box)

    def shadows(self, thrown: Thrown, shapes: Outlines, offset: Sequence[float], colour: int, strength: float) -> None:
        """Draw shadows; none where kernels are not compiled."""
        if self.exact and strength > 0.0:
            self._scratch = scratch = _scratch_for(self.surface.get_size())
            by = np.array(offset, dtype=np.float64)
            self._paint(paint_shadows, shapes, thrown, scratch.shadows, by, colour, strength)

    def trace(self, at: Floats, loops: Loops, grow: Floats) -> Outlines:
        """Outlines of loops of particles at (n, 2) [pixels], grown by (c,)."""
        point = np.zeros((int(loops.point_start[-1]), 2))
        if len(loops.rounds):
            if self.exact:
                spare = np.zeros((int(np.max(np.diff(loops.point_start))), 2))
                trace_outlines(at, loops, grow, point, spare)
                return Outlines(point, loops.point_start)
            return Outlines(at[loops.slot], loops.start)
        return Outlines(point, loops.point_start)


# What covers all of an outline alike, with white.
_WHITE = Skins(np.full((1, INSIDE, LIT), 0xFFFFFFFF, dtype=np.uint32), np.zeros((1, 1, 1), dtype=np.int64))
_UNSTRAINED = Flush(np.zeros((0, 4)), np.zeros(2, dtype=np.int64))
# One for all painters of a size, which take turns, as it is as large as four pictures; it goes with the last of them.
_scratches: WeakValueDictionary[tuple[int, int], _Scratch] = WeakValueDictionary()


def _scratch_for(size: tuple[int, int]) -> _Scratch:
    scratch = _scratches.get(size)
    if scratch is None:
        scratch = _scratches[size] = _made_scratch(size)
    return scratch


def _made_scratch(size: tuple[int, int]) -> _Scratch:
    pad = 2 * int(WIDEST) + 16
    width, height = size[0] + pad, size[1] + pad
    edge = int(WIDEST * SOFTNESS) + 4
    half = (width // 2 + edge) * (height // 2 + edge)
    flush = (width // FLUSH_CELL + 5) * (height // FLUSH_CELL + 5)
    quarter = (size[0] // FACTOR + 8) * (size[1] // FACTOR + 8)
    return _Scratch(
        BodyScratch(
            _cells((width + 2) * (height + 2)), _cells(half), _cells(half), _cells(width), _cells(flush),
            _cells(flush), _cells(width), _cells(width), np.zeros(width + FLUSH_CELL, dtype=np.int32),
            np.zeros(width + 2 * FLUSH_CELL, dtype=np.int32), np.zeros(width, dtype=np.uint32), np.zeros(4),
        ),
        ShadowScratch(
            _cells(quarter), _cells(quarter), _cells(quarter), _cells(size[0]),
            np.zeros(size[0] + 8 * FACTOR, dtype=np.int32), np.zeros(4),
        ),
        np.zeros(10, dtype=np.int64),
    )  # fmt: skip


def _cells(count: int) -> NDArray[np.float32]:
    return np.zeros(count, dtype=np.float32)


def _has_plain_pixels(surface: pygame.Surface) -> bool:
    is_whole = surface.get_pitch() == 4 * surface.get_width()
    return is_whole and surface.get_bitsize() == 32 and surface.get_shifts()[:3] == (16, 8, 0)


def _plain_marks(surface: pygame.Surface, layer: MarkArrays, tiles: Sheets) -> None:
    # The middle of a tile stands for all of it.
    tones = tiles[:, ACROSS // 2, ALONG // 2].astype(np.int64)
    colour = np.where(layer.kind == STRIP, tones[np.where(layer.kind == STRIP, layer.extra, 0)], layer.colour)
    seen = (np.abs(layer.ends) < FAR).all(axis=1) & (layer.half < FAR) & (layer.kind != GLOW)
    rows = zip(
        layer.ends[seen].tolist(),
        layer.half[seen].tolist(),
        colour[seen].tolist(),
        layer.kind[seen].tolist(),
        strict=True,
    )
    for (ax, ay, bx, by), half, tone, kind in rows:
        if kind <= HAIR:
            pygame.draw.aaline(surface, unpacked(tone), (ax, ay), (bx, by), max(1, round(2 * half)))
        elif half < 1.0:
            surface.fill(unpacked(tone), (round(ax), round(ay), 1, 1))
        else:
            pygame.draw.aacircle(surface, unpacked(tone), (ax, ay), round(half))


def _plain_bodies(surface: pygame.Surface, layer: BodyLayer) -> None:
    start = layer.outlines.start.tolist()
    rows = zip(
        layer.rows.loops.tolist(), layer.fill.tolist(), layer.rows.look[:, 2].tolist(), layer.rows.size[:, 2].tolist(),
        strict=True,
    )  # fmt: skip
    for (first, last), fill, line, alpha in rows:
        for loop in range(first, last):
            points = layer.outlines.point[start[loop] : start[loop + 1]]
            if len(points) < 3 or not (np.abs(points) < FAR).all():
                continue
            corners = points.tolist()
            # An outline inside another is a hole: what is seen through it is lost, and only its rim is drawn.
            if loop == first:
                pygame.draw.polygon(surface, unpacked(fill), corners)
            if alpha > 0.0:
                pygame.draw.aalines(surface, unpacked(line), True, corners)
