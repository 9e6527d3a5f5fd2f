"""Camera: world metres, y up, to pixels, y down, and back."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Point = tuple[float, float]
Box = tuple[float, float, float, float]

# Pixels per metre. Below: a level of the largest extent is a dot. Above: float positions run out of digits.
ZOOM_RANGE = (1e-4, 1e6)
# Part of the view left free around what `fit` shows.
FIT_MARGIN = 0.08
# Smallest extent [m] that `fit` shows, for levels of a single point.
SMALLEST_EXTENT = 0.5
# Zoom of one notch of the wheel.
WHEEL_ZOOM = 1.15


@dataclass
class Camera:
    """centre [m] is shown at the middle of the viewport (left, top, width, height) [pixels]; zoom [pixels/m]."""

    centre: Point = (0.0, 0.0)
    zoom: float = 50.0
    viewport: tuple[int, int, int, int] = (0, 0, 1280, 720)

    @property
    def middle(self) -> Point:
        """The pixel in the middle of the viewport."""
        left, top, width, height = self.viewport
        return left + width / 2, top + height / 2

    @property
    def origin(self) -> Point:
        """Pixel position of the world's (0, 0)."""
        (middle_x, middle_y), (x, y) = self.middle, self.centre
        return middle_x - x * self.zoom, middle_y + y * self.zoom

    def to_pixels(self, point: Point) -> Point:
        """A point [m] in pixels."""
        x, y = self.origin
        return x + point[0] * self.zoom, y - point[1] * self.zoom

    def to_world(self, pixel: Point) -> Point:
        """A pixel position in metres."""
        x, y = self.origin
        return (pixel[0] - x) / self.zoom, (y - pixel[1]) / self.zoom

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points [m] (n, 2) in pixels (n, 2)."""
        return points * (self.zoom, -self.zoom) + self.origin

    def zoom_about(self, pixel: Point, factor: float) -> None:
        """Zoom by a factor, keeping the point under a pixel where it is."""
        held = self.to_world(pixel)
        self.zoom = min(max(self.zoom * factor, ZOOM_RANGE[0]), ZOOM_RANGE[1])
        now = self.to_world(pixel)
        self.centre = (self.centre[0] + held[0] - now[0], self.centre[1] + held[1] - now[1])

    def turn_wheel(self, pixel: Point, notches: float) -> None:
        """Zoom about a pixel by notches of the wheel."""
        self.zoom_about(pixel, WHEEL_ZOOM**notches)

    def zoom_at(self, cursor: Point | None, notches: float) -> None:
        """Zoom about a keyboard cursor [m], or the middle where there is none."""
        self.turn_wheel(self.middle if cursor is None else self.to_pixels(cursor), notches)

    def pan(self, dx: float, dy: float) -> None:
        """Move the picture by pixels."""
        self.centre = (self.centre[0] - dx / self.zoom, self.centre[1] + dy / self.zoom)

    def show_as(self, other: "Camera") -> None:
        """Show everything at the same pixels as another camera does, in whatever viewport."""
        self.zoom = other.zoom
        x, y = self.to_world(other.to_pixels(other.centre))
        self.centre = (self.centre[0] + other.centre[0] - x, self.centre[1] + other.centre[1] - y)

    def can_show(self, box: Box) -> bool:
        """Whether a box [m] is no larger than the widest view."""
        left, bottom, right, top = box
        width, height = self.viewport[2] / ZOOM_RANGE[0], self.viewport[3] / ZOOM_RANGE[0]
        return right - left <= width and top - bottom <= height

    def fit(self, box: Box, above: float = 0.5, margin: float = FIT_MARGIN) -> None:
        """Show a box (left, bottom, right, top) [m] as large as it goes.

        above: the part of the height to spare that is above the box; margin: the part of the view that stays free.
        """
        left, bottom, right, top = box
        width, height = max(right - left, SMALLEST_EXTENT), max(top - bottom, SMALLEST_EXTENT)
        free = 1.0 - 2.0 * margin
        zoom = min(self.viewport[2] * free / width, self.viewport[3] * free / height)
        self.zoom = min(max(zoom, ZOOM_RANGE[0]), ZOOM_RANGE[1])
        spare = max(self.viewport[3] * free / self.zoom - height, 0.0)
        self.centre = ((left + right) / 2, (bottom + top) / 2 + (above - 0.5) * spare)

    def _extent(self) -> Point:
        """The largest box [m] that can be shown with a margin."""
        free = 1.0 - 2.0 * FIT_MARGIN
        return self.viewport[2] * free / self.zoom, self.viewport[3] * free / self.zoom

    def make_room(self, box: Box) -> None:
        """Zoom out about the middle where something as large as a box [m] would not be seen whole."""
        left, bottom, right, top = box
        wide, tall = self._extent()
        times = min(wide / max(right - left, 1e-9), tall / max(top - bottom, 1e-9), 1.0)
        self.zoom = max(self.zoom * times, ZOOM_RANGE[0])

    @property
    def picture(self) -> Box:
        """The box [m] that is seen."""
        left, top, width, height = self.viewport
        x0, y1 = self.to_world((left, top))
        x1, y0 = self.to_world((left + width, top + height))
        return x0, y0, x1, y1

    def picture_of(self, box: Box) -> Box:
        """The box [m] that is seen once a box [m] is shown as large as it goes."""
        fitted = replace(self)
        fitted.fit(box)
        return fitted.picture

    def shows(self, box: Box) -> bool:
        """Whether all of a box [m] is seen."""
        x0, y0, x1, y1 = self.picture
        return x0 <= box[0] and y0 <= box[1] and box[2] <= x1 and box[3] <= y1

    def reveal(self, box: Box) -> None:
        """Show a box [m] whole: move no farther than that takes, and zoom out where it is too large."""
        if self.shows(box):
            return
        self.make_room(box)
        left, bottom, right, top = box
        (wide, tall), (x, y) = self._extent(), self.centre
        x = min(max(x, right - wide / 2), left + wide / 2)
        y = min(max(y, top - tall / 2), bottom + tall / 2)
        self.centre = (x, y)


def union(*boxes: Box) -> Box:
    """The box [m] around boxes."""
    left, bottom, right, top = zip(*boxes, strict=True)
    return min(left), min(bottom), max(right), max(top)


def bounds(points: NDArray[np.float64]) -> Box:
    """The box around the finite ones of the points [m] (n, 2); a small box around the origin where there are none."""
    finite = points[np.isfinite(points).all(axis=1)]
    if not len(finite):
        return -1.0, -1.0, 1.0, 1.0
    (left, bottom), (right, top) = finite.min(axis=0).tolist(), finite.max(axis=0).tolist()
    return left, bottom, right, top


# Distance of grid lines on a sheet and of a ruler's marks, at least [pixels at scale 1].
GRID_STEP = 64.0


def grid_spacing(zoom: float, least: float) -> float:
    """Distance [m] between grid lines, 1, 2 or 5 times a power of ten, at least `least` pixels apart."""
    metres = least / zoom
    power = 10.0 ** math.floor(math.log10(metres))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= metres * (1.0 - 1e-9))
