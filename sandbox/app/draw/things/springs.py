"""Springs that show what they do: coils, muscles and pistons."""

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.raster.painter import MarkList
from sandbox.app.draw.textures import TILE
from sandbox.app.draw.things.frame import Frame
from sandbox.app.draw.things.level_slots import Join

Slots = NDArray[np.int64]
Floats = NDArray[np.float64]

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
    share = np.r_[0.0, np.linspace(0.12, 0.88, 2 * TURNS + 1), 1.0]
    side = np.where(np.arange(len(share)) % 2 == 0, 1.0, -1.0)
    side[[0, 1, -2, -1]] = 0.0
    points = ends[:, None, :2] + along[:, None] * share[:, None] + across[:, None] * (side * wide[:, None])[..., None]
    lines = _joined(points)
    marks.strokes(lines, 2.5 * frame.scale, DARK, 0.75)
    tone = np.where(np.arange(len(share) - 1) % 2 == 0, 0xE8EDF6, 0x8E9AB2)
    marks.strokes(lines, 1.5 * frame.scale, np.tile(tone, len(ends)))


def _muscles(ends: Floats, rest: Floats, width: Floats, marks: MarkList, frame: Frame) -> None:
    # Thick where short: what it holds stays the same.
    along, _, length = _lengthwise(ends)
    belly = np.clip(0.16 * rest * rest / length, 2.5 * frame.scale, 11.0 * frame.scale) * width
    share = np.linspace(0.0, 1.0, PARTS + 1)
    lines = _joined(ends[:, None, :2] + along[:, None] * share[:, None])
    middle = np.sin(0.5 * np.pi * (share[:-1] + share[1:])) ** 1.3
    half = (1.6 * frame.scale + belly[:, None] * middle).reshape(-1)
    marks.strokes(lines, half + 1.2 * frame.scale, MUSCLE_LINE)
    period = np.tile(np.column_stack([share[:-1], share[1:]]) * 2.0, (len(ends), 1))
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
