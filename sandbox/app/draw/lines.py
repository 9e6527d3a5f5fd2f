"""Canvas: anti-aliased lines and discs by kernels, or by pygame while they are not compiled; and solid shapes."""

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.app.draw.colours import TERRAIN_FILL, Colour
from sandbox.app.draw.raster.mark_kernels import ACROSS, ALONG
from sandbox.app.draw.raster.painter import MarkList, Painter

# Coordinates beyond this [pixels] are not drawn: float rounding would bend the line, and no screen is that large.
FARTHEST = 1e7

_NO_TILES = np.zeros((1, ACROSS, ALONG), dtype=np.uint32)


class Canvas:
    """Draws many lines and discs on a surface, inside its clip; compiled: whether kernels do it, if they are."""

    def __init__(self, surface: pygame.Surface, compiled: bool = True) -> None:
        self.surface = surface
        self._painter = Painter(compiled)

    @property
    def compiled(self) -> bool:
        """Whether kernels draw."""
        return self._painter.begin(self.surface)

    def draw(self, layer: MarkList) -> None:
        """Draw marks."""
        # The clip may be another by now.
        self._painter.begin(self.surface)
        self._painter.marks(layer, _NO_TILES)

    def lines(self, ends: NDArray[np.float64], colours: NDArray[np.int64], width: float) -> None:
        """Draw segments (m, 4) = x1, y1, x2, y2 [pixels] in colours (m,) 0xRRGGBB, width [pixels]."""
        layer = MarkList()
        layer.strokes(ends, width / 2, colours)
        self.draw(layer)

    def plain_lines(self, ends: NDArray[np.float64], colours: NDArray[np.int64]) -> None:
        """Draw segments as `lines` does, a pixel wide and with steps, in a tenth of the time."""
        layer = MarkList()
        layer.hairs(ends, colours)
        self.draw(layer)

    def discs(self, centres: NDArray[np.float64], radii: NDArray[np.float64], colours: NDArray[np.int64]) -> None:
        """Draw filled circles of centres (n, 2) and radii (n,) [pixels] in colours (n,) 0xRRGGBB."""
        layer = MarkList()
        layer.discs(centres, radii, colours)
        self.draw(layer)


# Width of an edge of terrain [pixels at scale 1].
EDGE_WIDTH = 2.4


def fill_solid(surface: pygame.Surface, corners: NDArray[np.float64], colour: Colour = TERRAIN_FILL) -> None:
    """Fill a solid shape, by its corners [pixels] (n, 2)."""
    # pygame turns coordinates into 32 bit integers.
    pygame.draw.polygon(surface, colour, np.clip(corners, -FARTHEST, FARTHEST).tolist())
