"""Backdrop: what does not move, stage and ground, as a picture that is kept while the camera stands still."""

import functools

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import Theme, packed
from sandbox.app.draw.looks import ground_look
from sandbox.app.draw.raster.bodies import GRAIN, BodyRows, Flush, Outlines, Skins
from sandbox.app.draw.raster.painter import NO_GRAIN, BodyLayer, MarkList, Painter
from sandbox.app.draw.raster.shadows import Thrown
from sandbox.app.draw.textures import EARTH, GROUND, TILE, TIMBER, Tiles, grains, ground_tones, skin_table
from sandbox.app.draw.things.level_slots import starts_of
from sandbox.level.document.model import Level
from sandbox.physics.geometry.segment import signed_area
from sandbox.physics.terrain import Terrain

Floats = NDArray[np.float64]

# Corners farther away than this [pixels] are drawn there: kernels take no others.
FARTHEST = 5e5
# Terrain wider than this part of the view or of all terrain is soil, if nothing says otherwise.
WIDE = 0.45
# How ground is rounded, and the half width of its line [pixels at scale 1].
SOIL_DEPTH, BEVEL, LINE_HALF = 26.0, 9.0, 0.9
# Turf lies on what faces up, as far as this cosine; half width, length of its pattern, how far it sinks.
TURF_FROM, TURF_HALF, TURF_PERIOD, TURF_SINK = 0.8, 12.0, 46.0, 2.0
EDGE_HALF = 2.4
# The stage is made in bands of this many rows, a multiple of 4: what is computed on the way has to fit in a processor's
# cache.
BAND = 32
_GRAINS = {"soil": EARTH, "rock": EARTH, "wood": TIMBER, "metal": NO_GRAIN, "glass": NO_GRAIN}


class Backdrop:
    """The background of one view, drawn once and kept."""

    def __init__(self) -> None:
        self._painter = Painter()
        self._key: tuple[object, ...] = ()
        self._terrain: Terrain | None = None
        self._layer: pygame.Surface | None = None
        self._is_fine = False

    def draw(
        self, painter: Painter, camera: Camera, terrain: Terrain, level: Level | None, theme: Theme, tiles: Tiles,
        scale: float,
    ) -> None:  # fmt: skip
        """Draw stage and ground; while the camera moves, the ground is flat."""
        key = (camera.centre, camera.zoom, camera.viewport, scale, theme.name, painter.exact)
        is_same = key == self._key and terrain is self._terrain and self._layer is not None
        is_new = self._layer is None or terrain is not self._terrain or camera.viewport != self._key[2]
        if not is_same or not self._is_fine:
            self._key, self._terrain = key, terrain
            self._is_fine = is_same or is_new
            self._layer = self._make_layer(painter, camera, terrain, level, theme, tiles, scale)
        assert self._layer is not None
        self._layer.set_alpha(None)
        painter.surface.blit(self._layer, camera.viewport[:2])

    def veil(self, painter: Painter, camera: Camera, opacity: float) -> None:
        """Lay the backdrop, with an opacity (0..1), over all that was drawn on it."""
        if self._layer is not None:
            self._layer.set_alpha(round(255 * opacity))
            painter.surface.blit(self._layer, camera.viewport[:2])

    def _make_layer(
        self, painter: Painter, camera: Camera, terrain: Terrain, level: Level | None, theme: Theme, tiles: Tiles,
        scale: float,
    ) -> pygame.Surface:  # fmt: skip
        width, height = camera.viewport[2:]
        layer = pygame.Surface((width, height), 0, 32)
        own = Camera(camera.centre, camera.zoom, (0, 0, width, height))
        pixels = pygame.surfarray.pixels2d(layer).T
        pixels[:] = stage_picture((width, height), theme)
        del pixels
        self._painter.compiled = painter.exact
        self._painter.begin(layer)
        if len(terrain.edge_a):
            self._draw_ground(own, terrain, level, theme, tiles, scale)
        return layer

    def _draw_ground(
        self, camera: Camera, terrain: Terrain, level: Level | None, theme: Theme, tiles: Tiles, scale: float
    ) -> None:
        vertex = np.clip(np.nan_to_num(camera.project(terrain.vertex)), -FARTHEST, FARTHEST)
        ids = [piece.id for piece in level.terrain] if level is not None else []
        lines, solids = MarkList(), []
        extent = float(np.ptp(vertex[:, 0]))
        for chain in np.unique(terrain.chain).tolist():
            edges = np.flatnonzero(terrain.chain == chain)
            corners = vertex[terrain.edge_a[edges]]
            # Pixels count downwards: what is solid inside runs clockwise there.
            is_solid = terrain.solid[edges[0]] and signed_area(corners, np.roll(corners, -1, axis=0)) < 0.0
            if not is_solid:
                ends = np.concatenate([corners, vertex[terrain.edge_b[edges]]], axis=1)
                metal = theme.metal[0]
                lines.strokes(ends, (EDGE_HALF + 0.9) * scale, packed(theme.metal[1]))
                lines.strips(ends, EDGE_HALF * scale, TILE["steel"], 0.0, packed(metal), 0.7)
                continue
            wide = np.ptp(corners[:, 0]) > WIDE * max(extent, camera.viewport[2])
            name = ids[chain] if chain < len(ids) else ""
            kind = ground_look(level, name, bool(wide)) if level is not None else "soil" if wide else "metal"
            solids.append((kind, np.ascontiguousarray(corners)))
        if solids:
            self._draw_solids(camera, solids, theme, tiles, scale)
        self._painter.marks(lines, tiles.array)

    def _draw_solids(
        self, camera: Camera, solids: list[tuple[str, Floats]], theme: Theme, tiles: Tiles, scale: float
    ) -> None:
        small = [corners for kind, corners in solids if kind != "soil"]
        if small and self._is_fine:
            shapes = Outlines(np.concatenate(small), starts_of([len(corners) for corners in small]))
            nothing = Thrown(np.zeros((0, 5)), np.zeros((0, 3)))
            offset = (4.0 * scale, 8.0 * scale)
            self._painter.shadows(nothing, shapes, offset, packed(theme.shadow), 0.7 * theme.shadow_strength)
        kinds = [kind for kind, _ in solids]
        points = Outlines(np.concatenate([c for _, c in solids]), starts_of([len(c) for _, c in solids]))
        count = len(solids)
        look = np.zeros((count, 3), dtype=np.int64)
        look[:, 0] = np.arange(count)
        look[:, 1] = [_GRAINS[kind] if self._is_fine else NO_GRAIN for kind in kinds]
        look[:, 2] = [_line_of(kind, theme) for kind in kinds]
        size = np.zeros((count, 3))
        size[:, 0] = [(SOIL_DEPTH if kind in ("soil", "rock") else BEVEL) * scale for kind in kinds]
        size[:, 1], size[:, 2] = LINE_HALF * scale, [0.5 if kind == "glass" else 0.9 for kind in kinds]
        loops = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)
        tables = np.stack([skin_table(f"{GROUND}{kind}", 0, theme) for kind in kinds])
        x, y = camera.origin
        shift = (round(y) % GRAIN, round(x) % GRAIN)
        rolled = np.ascontiguousarray(np.roll(grains(), shift, axis=(1, 2)))
        fill = tables[:, 40, 128].astype(np.int64) & 0xFFFFFF
        self._painter.bodies(
            BodyLayer(
                points, BodyRows(loops, look, size, np.zeros((count, 2), dtype=np.int64)), Skins(tables, rolled),
                Flush(np.zeros((0, 4)), np.zeros(2, dtype=np.int64)), fill,
            )
        )  # fmt: skip
        turf = MarkList()
        for kind, corners in solids:
            if kind == "soil":
                _lay_turf(turf, corners, theme, scale)
        self._painter.marks(turf, tiles.array)


def _lay_turf(marks: MarkList, corners: Floats, theme: Theme, scale: float) -> None:
    """Turf on the sides of a solid shape, clockwise as seen, that face up."""
    after = np.roll(corners, -1, axis=0)
    along = after - corners
    length = np.maximum(np.sqrt(np.sum(along * along, axis=1)), 1e-9)
    metres = np.cumsum(length)
    # With what is solid on the right as seen, what faces up runs to the left.
    chosen = -along[:, 0] / length > TURF_FROM
    # A stroke is round at its ends: at a cliff it ends before the edge, else it would stand in the air.
    inset = np.minimum(TURF_HALF * scale, 0.45 * length)
    before, beyond = inset * ~np.roll(chosen, 1), inset * ~np.roll(chosen, -1)
    way = along / length[:, None]
    ends = np.concatenate([corners + before[:, None] * way, after - beyond[:, None] * way], axis=1)[chosen]
    ends = ends + TURF_SINK * scale * np.array([0.0, 1.0, 0.0, 1.0])
    period = (np.column_stack([metres - length + before, metres - beyond]) / (TURF_PERIOD * scale))[chosen]
    sod = tuple(round(0.45 * a + 0.55 * b) for a, b in zip(*theme.turf, strict=True))
    marks.strokes(ends + scale * np.array([0.0, 1.0, 0.0, 1.0]), 3.2 * scale, packed(sod))
    marks.strips(ends, TURF_HALF * scale, TILE["turf"], period)


def _line_of(kind: str, theme: Theme) -> int:
    red, green, blue = (int(0.65 * channel) for channel in ground_tones(kind, theme).line)
    return packed((red, green, blue))


@functools.lru_cache(maxsize=1)
def stage_picture(size: tuple[int, int], theme: Theme) -> NDArray[np.uint32]:
    """The stage (h, w): the next run has mostly the same."""
    width, height = size
    picture = np.full((height, width), 0xFF, dtype=np.uint32)
    for first in range(0, height, BAND):
        rows = slice(first, min(first + BAND, height))
        _fill_band(rows, size, theme, picture[rows])
    return picture


def _fill_band(rows: slice, size: tuple[int, int], theme: Theme, picture: NDArray[np.uint32]) -> None:
    """Draw these rows of the stage, of which the first is a multiple of 4."""
    width, height = size
    y, x = np.arange(rows.start, rows.stop, dtype=np.float32)[:, None], np.arange(width, dtype=np.float32)
    fraction = y / np.float32(max(height, 1))
    away = np.sqrt(((x - width / 2) / (0.62 * width)) ** 2 + ((y - 0.46 * height) / (0.72 * height)) ** 2)
    # A lamp behind the stage, which is darker towards the corners.
    lit = np.clip(1 - 1.25 * away, 0, 1) ** 2
    dark = 1 - np.float32(theme.vignette) * np.clip(away - 0.55, 0, 1.2) ** np.float32(1.6)
    # An ordered dither, or the gradient shows as bands.
    bayer = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]], dtype=np.float32) / 16 + 0.03
    dither = np.tile(bayer, (len(y) // 4 + 1, width // 4 + 1))[: len(y), :width]
    for top, bottom, lamp in zip(*theme.stage, theme.lamp, strict=True):
        colour = top * (1 - fraction) + bottom * fraction + lit * lamp
        picture <<= 8
        picture |= np.clip(colour * dark + dither, 0, 255).astype(np.uint8)
