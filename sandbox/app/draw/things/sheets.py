"""Sheets: cloth with its weave, and crates of planks, bricks or stones: textured triangles that go where they tear."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.raster.cells import CellArrays
from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.textures import laid, woven
from sandbox.app.draw.themes import CLOTH_STRIPE, dark_edge, outline_of
from sandbox.app.draw.things.frame import Frame
from sandbox.app.draw.things.level_slots import Actor

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

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
    """All sheets of a level that are there."""

    def __init__(self) -> None:
        self._sheets: list[_Sheet] = []
        self._pictures: list[NDArray[np.int64]] = []

    def add(self, actor: Actor, triangles: Slots, loops: list[Slots], there: NDArray[np.bool_]) -> None:
        """A body of which triangles (t, 3) of indices are left, inside loops of slots."""
        look, spacing = actor.look, float(actor.body.__dict__.get("spacing", actor.cell))
        is_cloth = look.skin == "cloth"
        form = actor.made.local_form[0]
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
