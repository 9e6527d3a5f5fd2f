"""Pictures that bodies wear: triangles of a body that keep their places in the picture, drawn inside its outline."""

import contextlib
import io
from collections import OrderedDict
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.colours import unpacked
from sandbox.app.draw.raster.mark_kernels import SHEET, CellArrays
from sandbox.app.draw.things.level_slots import Actor, Frame, starts_of
from sandbox.app.draw.things.soft import FLAT, Shape, keep_of
from sandbox.app.draw.things.wheels import DrawnWheel
from sandbox.level.format.picture import Picture, size_of

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

# The layer of shapes that wear a picture.
WORN = 2
# Sheets begin so many texels apart, and no triangle that is drawn is wider: each lies in one sheet.
STRIDE = 32
WIDEST_CELL = SHEET - STRIDE - 2
# A picture is drawn from an edition of it of at most so many texels a side, and at least.
MOST_TEXELS, FEWEST_TEXELS = 1024, 32
# By what power of two it is finer than the pixels it is drawn on, at least; it shows no more than half of its texels
# could, so that it is smooth though each pixel takes one texel.
FINER = 0.3
# How far a picture goes on beyond the particles at its rim [pixels], beside so many of their radii.
BEYOND, ROOM = 3.0, 1.5
# Corners lie on so many places of a pixel; where one place ends and the next begins, few corners lie by themselves.
SNAP, SNAP_FROM = 1024.0, 0.37
# Particles that have moved less than this [m] have not.
UNMOVED = 1e-6
# Bytes of all sheets that are kept, those used last.
MOST_BYTES = 128 * 1024 * 1024


class Rim(NamedTuple):
    """The outline of a part of a body: slots (k,) and places (k, 2) of particles, and which comes before and after."""

    slots: Slots
    place: Floats
    before: Slots
    after: Slots

    @classmethod
    def of(cls, loops: list[Slots], slots: Slots, place: Floats) -> "Rim":
        """The outline of loops, whose slots (k,) these are, one after the other."""
        starts = starts_of([len(loop) for loop in loops])
        rows = [np.arange(first, last) for first, last in pairwise(starts.tolist())]
        before, after = (np.concatenate([np.roll(row, by) for row in rows]) for by in (1, -1))
        return cls(slots, place, before, after)

    def band(self, at: Floats, far: float) -> Floats:
        """Triangles (2 k, 3, 2) that lie around places (k, 2) of it, so far outwards; y points down."""
        along = at[self.after] - at[self.before]
        length = np.maximum(np.sqrt(np.sum(along * along, axis=1, keepdims=True)), 1e-9)
        outer = at + far * np.stack([-along[:, 1], along[:, 0]], axis=1) / length
        return np.concatenate(
            [
                np.stack([at, at[self.after], outer[self.after]], axis=1),
                np.stack([at, outer[self.after], outer], axis=1),
            ]
        )


@dataclass(eq=False)
class Worn:
    """A picture on triangles (t, 3) of slots, whose corners have places (t, 3, 2) in it, 0..1 to the right and down.

    around (k,): slots whose middle is the slot -1 of triangles. rim: places of particles at the outline, which runs
    anticlockwise, and around holes the other way. size (2,) [m] of what wears it; radius [m] of its particles.
    """

    picture: Picture
    colour: int
    corners: Slots
    around: Slots
    place: Floats
    rim: Rim
    size: Floats
    radius: float
    _laid: tuple[tuple[int, int], Slots, Floats, CellArrays] | None = field(default=None, init=False)

    @classmethod
    def on(
        cls, actor: Actor, triangles: Slots, loops: list[Slots], radius: float, origin: Floats | None = None
    ) -> "Worn":  # fmt: skip
        """The picture of a body on triangles (t, 3) of indices of its particles, inside loops of slots.

        -1 is the middle of all particles that they have. origin (n, 2): where particles were when the body was made
        [m], as cuts have moved them; None: none has.
        """
        form, low, size = _upright(actor, origin)
        place = (form - low) / size * np.array([1.0, -1.0]) + np.array([0.0, 1.0])
        picture, own = actor.look.picture, np.unique(triangles[triangles >= 0])
        assert picture is not None
        place = np.concatenate([place, place[own].mean(axis=0, keepdims=True)])
        corners = np.where(triangles < 0, -1, actor.slots[triangles])
        order = np.argsort(actor.slots, kind="stable")
        slots = np.concatenate(loops)
        rim = Rim.of(loops, slots, place[order[np.searchsorted(actor.slots[order], slots)]])
        return cls(picture, actor.look.colour, corners, actor.slots[own], place[triangles], rim, size, radius)

    def cells(self, frame: Frame) -> tuple[CellArrays, Slots]:
        """The triangles of a frame, and the sheets that they are of."""
        texels = _texels(self.picture, self.size * frame.zoom)
        sheets, columns = _sheets_of(self.picture, self.colour, texels)
        if self._laid is None or self._laid[0] != texels:
            self._laid = texels, *self._lay(texels, columns)
        _, whole, weight, cells = self._laid
        at = np.concatenate([frame.at, frame.at[self.around].mean(axis=0, keepdims=True)])
        corner = np.nan_to_num(at[self.corners], nan=1e9, posinf=1e9, neginf=-1e9)
        edge = np.nan_to_num(frame.at[self.rim.slots], nan=1e9, posinf=1e9, neginf=-1e9)
        rows = np.concatenate([corner, self.rim.band(edge, self._beyond(frame.zoom))])
        # Parts of two triangles that share a corner have it at the same place, or pixels would be left between them.
        corner = np.floor((weight @ rows[whole]) * SNAP + SNAP_FROM) / SNAP
        return cells._replace(corner=corner.reshape(-1, 6)), sheets

    def _beyond(self, scale: float) -> float:
        """How far the picture goes on beyond particles at the outline, of as many pixels or texels a metre."""
        return BEYOND + ROOM * self.radius * scale

    def _lay(self, texels: tuple[int, int], columns: int) -> tuple[Slots, Floats, CellArrays]:
        """Parts of triangles: of which (k,), as weights (k, 3, 3) of its corners, and where they lie in the sheets.

        Last comes a band around them, as what is drawn reaches as far as the outline.
        """
        place = self.place * np.array(texels)
        scale = np.array(texels) / self.size
        band = self.rim.band(self.rim.place * np.array(texels), self._beyond(float(np.max(scale))))
        (whole, weight), (beyond, narrow) = _parted(place), _parted(band)
        whole, weight = np.concatenate([whole, beyond + len(place)]), np.concatenate([weight, narrow])
        texel = weight @ np.concatenate([place, band])[whole]
        tile = np.clip(np.floor(texel.min(axis=1) / STRIDE).astype(np.int64) + 1, 0, _grid(texels)[::-1] - 1)
        # Beyond the sheets there is more of what is at the edge.
        texel = np.clip(texel - ((tile - 1) * STRIDE - 1)[:, None], 0.5, SHEET - 0.5)
        shade = np.zeros((len(texel), 3))
        return whole, weight, CellArrays(shade, texel.reshape(-1, 6), shade, tile[:, 1] * columns + tile[:, 0])


def worn_shape(actor: Actor, loops: list[Slots], radius: float) -> Shape:
    """What wears a picture inside loops of slots; radius [m] of its particles."""
    return Shape(loops, FLAT, actor.look.colour, WORN, radius, keep=keep_of(actor, loops), line=False)


def _upright(actor: Actor, origin: Floats | None) -> tuple[Floats, Floats, Floats]:
    """Places (n, 2) [m] of particles as the body was described before it was turned; its lower left, and its size.

    origin (n, 2): see `Worn.on`.
    """
    form, count, turn = (
        actor.local_form.copy(),
        len(actor.made.form),
        np.array([np.cos(actor.angle), np.sin(actor.angle)]),
    )
    whole = _turned_back(form[:count], turn)
    if origin is not None:
        moved = origin[:count] - actor.made.position
        moved -= np.median(moved, axis=0)
        form[:count] += np.where(np.abs(moved) > UNMOVED, moved, 0.0)
    low = whole.min(axis=0)
    return _turned_back(form, turn), low, np.maximum(whole.max(axis=0) - low, 1e-6)


def _turned_back(at: Floats, turn: Floats) -> Floats:
    return np.stack([at @ turn, at[:, 1] * turn[0] - at[:, 0] * turn[1]], axis=1)


def round_of(actor: Actor, there: NDArray[np.bool_]) -> tuple[Slots, list[Slots]] | None:
    """Triangles (t, 3) about the middle that fill a ring or a wheel, as `Worn.on` takes them, and the loop around them.

    None of any other body, and of one that is torn, of whose springs some are there (m,).
    """
    count = len(actor.slots)
    if actor.body.type == "wheel" and DrawnWheel.is_whole(actor, there):
        loop = np.arange((count + 1) // 2, count)
    elif actor.body.type == "ring" and there.all() and len(there) == count:
        loop = np.arange(count)
    else:
        return None
    return np.stack([np.full_like(loop, -1), loop, np.roll(loop, -1)], axis=1), [actor.slots[loop]]


def _parted(at: Floats) -> tuple[Slots, Floats]:
    """Even parts of triangles (t, 3, 2) [texels], so many that each fits into a sheet: of which triangle (k,) they are,
    and as weights (k, 3, 3) of its corners."""
    wide = float(np.max(np.ptp(at, axis=1), initial=1.0))
    parts = _parts_of(int(np.ceil(wide / WIDEST_CELL)))
    return np.repeat(np.arange(len(at)), len(parts)), np.tile(parts, (len(at), 1, 1))


def _parts_of(count: int) -> Floats:
    """The even parts of a triangle, so many along each side: the weights (count^2, 3, 3) of its corners in theirs."""
    found = []
    for row in range(count):
        for k in range(count - row):
            a, b, c, d = (k, row), (k + 1, row), (k, row + 1), (k + 1, row + 1)
            found += [(a, b, c), (b, d, c)][: 1 if k == count - row - 1 else 2]
    at = np.array(found, dtype=np.float64) / count
    return np.stack([1.0 - at[..., 0] - at[..., 1], at[..., 0], at[..., 1]], axis=-1)


def _texels(picture: Picture, pixels: Floats) -> tuple[int, int]:
    """The size of the drawn edition of a picture: each way its own by a power of two, finer than pixels (2,)."""
    assert picture.data is not None
    own = np.array(size_of(picture.data), dtype=np.float64)
    finer = np.ceil(np.log2(np.clip(pixels, FEWEST_TEXELS, MOST_TEXELS / 2.0) / own) + FINER)
    wide, high = np.maximum(np.round(own * 2.0**finer), 1.0).astype(int).tolist()
    return wide, high


def _grid(texels: tuple[int, int]) -> Slots:
    """Rows and columns of the sheets of an edition: they reach beyond it by one all around."""
    return np.array([-(-texels[1] // STRIDE) + 2, -(-texels[0] // STRIDE) + 2])


_kept: OrderedDict[tuple[bytes, int, tuple[int, int]], Slots] = OrderedDict()


def _sheets_of(picture: Picture, colour: int, texels: tuple[int, int]) -> tuple[Slots, int]:
    """The sheets (s, SHEET, SHEET) of an edition of a picture over a colour, row by row, and how many a row has."""
    assert picture.data is not None
    key = picture.data, colour, texels
    rows, columns = _grid(texels).tolist()
    if key not in _kept:
        image = _flat(picture.data, colour, texels)
        y, x = (
            np.clip(np.arange(count)[:, None] * STRIDE - STRIDE - 1 + np.arange(SHEET), 0, most - 1)
            for count, most in ((rows, texels[1]), (columns, texels[0]))
        )
        _kept[key] = image[y[:, None, :, None], x[None, :, None, :]].reshape(-1, SHEET, SHEET)
        while len(_kept) > 1 and sum(sheets.nbytes for sheets in _kept.values()) > MOST_BYTES:
            _kept.popitem(last=False)
    _kept.move_to_end(key)
    return _kept[key], columns


def _flat(data: bytes, colour: int, texels: tuple[int, int]) -> Slots:
    """The pixels (h, w) 0xRRGGBB of a PNG over a colour, in another size; of one that cannot be unpacked the colour."""
    flat = pygame.Surface(size_of(data), 0, 32)
    flat.fill(unpacked(colour))
    with contextlib.suppress(pygame.error):
        flat.blit(pygame.image.load(io.BytesIO(data), "picture.png"), (0, 0))
    half = pygame.transform.smoothscale(flat, (max(texels[0] // 2, 1), max(texels[1] // 2, 1)))
    scaled = pygame.transform.smoothscale(half, texels)
    red, green, blue = (pygame.surfarray.pixels3d(scaled)[:, :, k].T.astype(np.int64) for k in range(3))
    return np.asarray(red << 16 | green << 8 | blue)
