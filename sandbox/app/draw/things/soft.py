"""What is filled: jellies, balloons, crates, panels and tyres by their outlines; sheets by their triangles."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.colours import CLOTH_STRIPE, SQUEEZED_FLUSH, STRETCHED_FLUSH, dark_edge, outline_of, packed
from sandbox.app.draw.raster.bodies import WIDEST, BodyRows, Flush, Outlines, Skins
from sandbox.app.draw.raster.mark_kernels import CellArrays
from sandbox.app.draw.raster.painter import NO_GRAIN, BodyLayer, MarkList, Painter
from sandbox.app.draw.raster.pixels import Loops
from sandbox.app.draw.textures import grains, laid, skin_table, woven
from sandbox.app.draw.things.faces import clearance_in, spot_of
from sandbox.app.draw.things.level_slots import FLUSH_FROM, FLUSH_RANGE, Actor, Frame, Piece, starts_of
from sandbox.level.kinds.jelly import CircleShape
from sandbox.physics.geometry.segment import lengths, signed_area

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

# How skins are rounded: as a part of the body's size, and at most [pixels at scale 1]; and half width of the line.
ROUNDING = {"balloon": 0.30, "tyre": 0.16, "wood": 0.05, "stone": 0.07, "brick": 0.07, "window": 0.2}
USUAL_ROUNDING, LEAST_ROUNDING, MOST_ROUNDING = 0.17, 6.0, 34.0
LINE_HALF = 0.75
# A corner is cut by this part of a side at each end, or by that of the body's breadth where that is less.
CUT_OF_SIDE, CUT_OF_BREADTH = 0.25, 1.0 / 12.0
# A piece into which no circle of this part of that of the whole fits is a crumb.
CRUMB, FLAT = 0.2, "flat"
# Widest that a skin stands out beyond the particles [pixels].
MOST_GROWN = 40.0
# Particles with less of a flush than this are not drawn with one.
LEAST_FLUSH = 0.02


@dataclass(eq=False)
class Shape:
    """Something filled: loops of slots, its skin and colour; grows: by a particle's radius [m] and pixels at scale 1.

    layer: what is drawn together. flushed: springs whose strain shows, and slots of their ends (m, 2), if any.
    """

    loops: list[Slots]
    skin: str
    colour: int
    layer: int
    grown: float = 0.0
    extra: float = 0.0
    rounds: int = 2
    keep: float = CUT_OF_SIDE
    line: bool = True
    flushed: tuple[Slots, Slots, float] | None = None

    @cached_property
    def flushed_slots(self) -> Slots:
        """Slots (k,) whose strain shows."""
        return np.unique(self.flushed[1]) if self.flushed is not None else np.zeros(0, dtype=np.int64)


@dataclass(eq=False)
class _Layer:
    numbers: list[int]
    rows: BodyRows
    skins: Skins
    fill: Slots


@dataclass(eq=False)
class _Flushed:
    """Bodies that show strain: slot (k,) of particles, body row by row; springs (m,), ends (m, 2), degree (n,)."""

    slot: Slots
    start: Slots
    springs: Slots
    ends: Slots
    degree: Floats
    reach: Floats
    shape: Slots


def shape_of(actor: Actor, loops: list[Slots], springs: NDArray[np.bool_], radius: float) -> Shape:
    """A soft body inside loops of slots; springs (m,): which are there; radius [m] of its particles."""
    look = actor.look
    is_laid = look.skin in ("wood", "stone", "brick")
    flushed = (actor.springs[springs], actor.ends[springs], actor.cell) if look.skin in ("jelly", "rubber") else None
    if is_laid:
        return Shape(loops, look.skin, look.colour, 0, radius, rounds=1, keep=0.12, line=False)
    return Shape(loops, look.skin, look.colour, 1, radius, keep=keep_of(actor, loops), flushed=flushed)


def shapes_of(actor: Actor, pieces: list[Piece], radius: float) -> list[Shape]:
    """The pieces of a soft body; crumbs, too small for a skin, have its colour alone."""
    whole = actor.spot(spot_of)[1] if len(pieces) > 1 else 0.0
    found = []
    for piece in pieces:
        shape = shape_of(actor, piece.loops, piece.inside, radius)
        if clearance_in(actor, piece) < CRUMB * whole:
            shape.skin, shape.flushed = FLAT, None
        found.append(shape)
    return found


def keep_of(actor: Actor, loops: list[Slots]) -> float:
    """By which part of its sides the corners of loops of slots of a soft body are cut."""
    if not _has_corners(actor):
        return CUT_OF_SIDE
    return min((_cut_of(actor, loop) for loop in loops), default=CUT_OF_SIDE)


def _has_corners(actor: Actor) -> bool:
    """Whether a body was drawn with corners: what is round is so by few particles as well."""
    return actor.is_filled and not isinstance(getattr(actor.body, "shape", None), CircleShape)


def _cut_of(actor: Actor, loop: Slots) -> float:
    """Which part of its sides a cut of the corners of a loop takes, so that a body of few cells keeps its form."""
    order = np.argsort(actor.slots, kind="stable")
    corners = actor.form[order[np.searchsorted(actor.slots[order], loop)]]
    after = np.roll(corners, -1, axis=0)
    length, area = lengths(after - corners), abs(signed_area(corners, after))
    around, longest = float(np.sum(length)), float(np.max(length, initial=0.0))
    # A square is as broad as its sides are long.
    breadth = 4.0 * area / around if around > 0.0 else 0.0
    return min(CUT_OF_SIDE, CUT_OF_BREADTH * breadth / longest) if longest > 0.0 else CUT_OF_SIDE


@dataclass(eq=False)
class Soft:
    """All shapes of a level; `outlines` are those of the frame that was last traced."""

    shapes: list[Shape]
    outlines: Outlines = field(init=False)

    def __post_init__(self) -> None:
        loops = [loop for shape in self.shapes for loop in shape.loops]
        rounds = [shape.rounds for shape in self.shapes for _ in shape.loops]
        starts = starts_of([len(loop) for loop in loops])
        points = starts_of([len(loop) << cut for loop, cut in zip(loops, rounds, strict=True)])
        self._loops = Loops(
            np.concatenate(loops).astype(np.int64) if loops else np.zeros(0, dtype=np.int64),
            starts,
            np.array(rounds, dtype=np.int64),
            np.array([shape.keep for shape in self.shapes for _ in shape.loops]),
            points,
        )
        self._grown = np.array([shape.grown for shape in self.shapes for _ in shape.loops])
        self._extra = np.array([shape.extra for shape in self.shapes for _ in shape.loops])
        self._first = starts_of([len(shape.loops) for shape in self.shapes])
        self._flushed = self._find_flushed()
        self._layers: dict[tuple[int, str, int], _Layer] = {}

    def _find_flushed(self) -> _Flushed | None:
        chosen = [k for k, shape in enumerate(self.shapes) if shape.flushed is not None and len(shape.flushed[0])]
        if not chosen:
            return None
        parts = [self.shapes[k].flushed for k in chosen]
        slots = [self.shapes[k].flushed_slots for k in chosen]
        ends = np.concatenate([part[1] for part in parts if part is not None])
        degree = np.maximum(np.bincount(ends.reshape(-1)), 1)
        return _Flushed(
            np.concatenate(slots), starts_of([len(own) for own in slots]),
            np.concatenate([part[0] for part in parts if part is not None]), ends, degree.astype(np.float64),
            np.repeat([part[2] for part in parts if part is not None], [len(own) for own in slots]),
            np.array(chosen, dtype=np.int64),
        )  # fmt: skip

    def trace(self, painter: Painter, frame: Frame) -> None:
        """Find the outlines of a frame."""
        grow = np.minimum(self._grown * frame.zoom, MOST_GROWN * frame.scale) + self._extra * frame.scale
        at = np.ascontiguousarray(np.nan_to_num(frame.at, nan=1e9, posinf=1e9, neginf=-1e9))
        self.outlines = painter.trace(at, self._loops, grow)
        self._sizes = self._size_of_each()

    def _size_of_each(self) -> Floats:
        """About how wide [pixels] each shape is."""
        if not len(self.outlines.point):
            return np.zeros(len(self.shapes))
        begins = self.outlines.start[self._first[:-1]]
        low = np.minimum.reduceat(self.outlines.point, begins, axis=0)
        high = np.maximum.reduceat(self.outlines.point, begins, axis=0)
        return np.asarray(np.sqrt(np.prod(high - low, axis=1)))

    def lines_of(self, k: int) -> Floats:
        """Lines (m, 4) [pixels] of the outlines of a shape."""
        start = self.outlines.start
        rows = []
        for loop in range(self._first[k], self._first[k + 1]):
            points = self.outlines.point[start[loop] : start[loop + 1]]
            rows.append(np.concatenate([points, np.roll(points, -1, axis=0)], axis=1))
        return np.concatenate(rows)

    def outlines_of(self, k: int) -> Outlines:
        """The outlines of a shape."""
        start = self.outlines.start[self._first[k] : self._first[k + 1] + 1]
        return Outlines(self.outlines.point[start[0] : start[-1]], start - start[0])

    def size_of(self, k: int) -> float:
        """About how wide [pixels] a shape is."""
        return float(self._sizes[k])

    def layer(self, number: int, frame: Frame, is_lattice: bool) -> BodyLayer | None:
        """What of a layer there is to draw; is_lattice: bodies step back behind their springs."""
        kept = self._layer_of(number, frame, is_lattice)
        if kept is None:
            return None
        k = np.array(kept.numbers)
        rows = kept.rows
        rows.size[:, 0] = self._rounding(k, frame)
        rows.size[:, 1] = LINE_HALF * frame.scale
        flush = self._flush(kept, frame) if not is_lattice else None
        if flush is None:
            rows.flush[:] = 0
            flush = np.zeros((0, 4))
        colours = np.array([SQUEEZED_FLUSH, STRETCHED_FLUSH])
        return BodyLayer(self.outlines, rows, kept.skins, Flush(flush, colours), kept.fill)

    def _rounding(self, k: Slots, frame: Frame) -> Floats:
        part = np.array([ROUNDING.get(self.shapes[i].skin, USUAL_ROUNDING) for i in k.tolist()])
        most = np.minimum(MOST_ROUNDING * frame.scale, WIDEST)
        return np.clip(self._sizes[k] * part, min(LEAST_ROUNDING, most) * min(frame.scale, 1.0), most)

    def _layer_of(self, number: int, frame: Frame, is_lattice: bool) -> _Layer | None:
        key = (number, frame.theme.name, int(is_lattice))
        if key not in self._layers:
            chosen = [k for k, shape in enumerate(self.shapes) if shape.layer == number and shape.loops]
            if not chosen:
                return None
            tables: list[NDArray[np.uint32]] = []
            index: dict[tuple[str, int], int] = {}
            look = np.zeros((len(chosen), 3), dtype=np.int64)
            for row, k in enumerate(chosen):
                shape = self.shapes[k]
                skin = "lattice" if is_lattice and shape.skin != "tyre" else shape.skin
                colour = frame.theme.strain[1] if skin == "lattice" else shape.colour
                tone = colour if isinstance(colour, int) else packed(colour)
                if (skin, tone) not in index:
                    index[skin, tone] = len(tables)
                    tables.append(skin_table(skin, tone, frame.theme))
                look[row] = index[skin, tone], NO_GRAIN, outline_of(tone)
            size = np.zeros((len(chosen), 3))
            size[:, 2] = [float(self.shapes[k].line) for k in chosen]
            loops = np.stack([self._first[chosen], self._first[np.array(chosen) + 1]], axis=1)
            rows = BodyRows(loops, look, size, np.zeros((len(chosen), 2), dtype=np.int64))
            fill = np.array([self.shapes[k].colour for k in chosen], dtype=np.int64)
            self._layers[key] = _Layer(chosen, rows, Skins(np.stack(tables), grains()), fill)
        return self._layers[key]

    def _flush(self, kept: _Layer, frame: Frame) -> Floats | None:
        """Splats (k, 4) of the bodies of a layer that are strained, whose rows they write."""
        own = self._flushed
        if own is None:
            return None
        strain = np.clip(np.nan_to_num(frame.strain[own.springs], nan=0.0), -9.0, 9.0)
        count = len(own.degree)
        total = np.bincount(own.ends[:, 0], strain, count) + np.bincount(own.ends[:, 1], strain, count)
        mean = (total / own.degree)[own.slot]
        amount = np.sign(mean) * np.clip((np.abs(mean) - FLUSH_FROM) / FLUSH_RANGE, 0.0, 1.0)
        most = np.maximum.reduceat(np.abs(amount), own.start[:-1])
        row_of = {k: row for row, k in enumerate(kept.numbers)}
        kept.rows.flush[:] = 0
        for shape, first, last, peak in zip(
            own.shape.tolist(), own.start[:-1].tolist(), own.start[1:].tolist(), most.tolist(), strict=True
        ):
            if peak > LEAST_FLUSH and shape in row_of:
                kept.rows.flush[row_of[shape]] = first, last
        return np.column_stack([frame.at[own.slot], own.reach * frame.zoom, amount])


# Texels of a cell of cloth, and of one of planks; columns of cloth to a fold, and how deep folds are shaded.
CLOTH_TEXELS, LAID_TEXELS = 16.0, 14.0
FOLD, FOLD_DEPTH = 4.0, 0.2
HEM_HALF = 1.5
# Cloth that is gathered is darker, cloth that is stretched lighter.
GATHER, DARKEST, LIGHTEST = 1.2, -0.3, 0.2


@dataclass(eq=False)
class _Sheet:
    corners: Slots
    texels: Floats
    folds: Floats
    loops: list[Slots]
    slots: Slots
    springs: Slots
    ends: Slots
    is_cloth: bool
    colour: int


class Sheets:
    """The sheets of a level that are there."""

    def __init__(self) -> None:
        self._sheets: list[_Sheet] = []
        self._pictures: list[NDArray[np.int64]] = []

    def add(self, actor: Actor, triangles: Slots, loops: list[Slots], there: NDArray[np.bool_]) -> None:
        """Add a body of which triangles (t, 3) of indices are left, inside loops of slots."""
        look, spacing = actor.look, float(actor.body.__dict__.get("spacing", actor.cell))
        is_cloth = look.skin == "cloth"
        form = actor.local_form
        angle = float(actor.body.__dict__.get("angle", 0.0))
        cosine, sine = np.cos(angle), np.sin(angle)
        local = np.stack([form[:, 0] * cosine + form[:, 1] * sine, form[:, 1] * cosine - form[:, 0] * sine], axis=1)
        local = (local - local.min(axis=0)) / spacing
        texel = local * (CLOTH_TEXELS if is_cloth else LAID_TEXELS) * np.array([1.0, -1.0])
        folds = FOLD_DEPTH * np.sin(local[:, 0] * 2.0 * np.pi / FOLD + 0.05 * local[:, 1]) * is_cloth
        self._sheets.append(
            _Sheet(
                actor.slots[triangles], texel[triangles].reshape(-1, 6), folds[triangles], loops, actor.slots,
                actor.springs[there], actor.ends[there], is_cloth, look.colour,
            )
        )  # fmt: skip
        self._pictures.append(woven(look.colour, CLOTH_STRIPE) if is_cloth else laid(look.skin, look.colour))

    @property
    def pictures(self) -> NDArray[np.int64]:
        """Pictures (s, SHEET, SHEET) that the triangles are of."""
        return np.stack(self._pictures)

    def __bool__(self) -> bool:
        return bool(self._sheets)

    def arrays(self, frame: Frame) -> CellArrays:
        """The triangles of a frame."""
        parts = [self._arrays(k, sheet, frame) for k, sheet in enumerate(self._sheets)]
        corner, texel, shade, number = (np.concatenate(column) for column in zip(*parts, strict=True))
        return CellArrays(corner, texel, shade, number.astype(np.int64))

    @staticmethod
    def _arrays(k: int, sheet: _Sheet, frame: Frame) -> tuple[Floats, Floats, Floats, Slots]:
        shade = sheet.folds
        if sheet.is_cloth and len(sheet.springs):
            strain = np.clip(np.nan_to_num(frame.strain[sheet.springs]), -1.0, 1.0)
            count = len(frame.at)
            total = np.bincount(sheet.ends[:, 0], strain, count) + np.bincount(sheet.ends[:, 1], strain, count)
            mean = total / np.maximum(np.bincount(sheet.ends.reshape(-1), minlength=count), 1)
            usual = float(np.median(mean[sheet.slots]))
            shade = shade + np.clip((mean[sheet.corners] - usual) * GATHER, DARKEST, LIGHTEST)
        corner = np.nan_to_num(frame.at[sheet.corners].reshape(-1, 6), nan=1e9, posinf=1e9, neginf=-1e9)
        return corner, sheet.texels, shade, np.full(len(sheet.corners), k)

    def mark_hems(self, marks: MarkList, frame: Frame) -> None:
        """Draw the lines around the sheets."""
        for sheet in self._sheets:
            for loop in sheet.loops:
                ends = np.concatenate([frame.at[loop], np.roll(frame.at[loop], -1, axis=0)], axis=1)
                tone = outline_of(sheet.colour) if sheet.is_cloth else dark_edge(sheet.colour)
                marks.strokes(ends, HEM_HALF * frame.scale, tone)

    def outlines(self) -> list[Slots]:
        """Loops of slots that throw shadows."""
        return [loop for sheet in self._sheets for loop in sheet.loops if sheet.is_cloth]
