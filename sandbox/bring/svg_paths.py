"""Points of SVG's basic shapes and paths, in the coordinates of their own element."""

import math
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.sketch import Ring, Unreadable
from sandbox.bring.xml_tree import local_name

# Points of a curve, and of a whole turn of an arc.
CURVE_POINTS, TURN_POINTS = 14, 48
# Characters of all paths of a drawing: reading a million of them takes five seconds.
PATH_LIMIT = 1_000_000
SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")

_T = np.linspace(0.0, 1.0, CURVE_POINTS + 1)[1:, None]
# Weights (points, controls) of a quadratic and a cubic curve.
_QUADRATIC = np.concatenate([(1 - _T) ** 2, 2 * _T * (1 - _T), _T**2], axis=1)
_CUBIC = np.concatenate([(1 - _T) ** 3, 3 * _T * (1 - _T) ** 2, 3 * _T**2 * (1 - _T), _T**3], axis=1)


class Paths:
    """Reads shapes, of a drawing of this page [px], as long as it has not more of them than can be read."""

    def __init__(self, page: tuple[float, float]) -> None:
        self._page = page
        self._read = 0

    def of(self, element: Element) -> list[tuple[Ring, bool]]:
        """Each way of a shape: its points (n, 2), and whether it is closed.

        Raises Unreadable for too much; ValueError and the like for what cannot be read.
        """
        kind = local_name(element)
        self._read += sum(len(element.get(key, "")) for key in ("d", "points"))
        if self._read > PATH_LIMIT:
            raise Unreadable(f"has more than {PATH_LIMIT:,} characters of paths; simplify it")
        if kind in ("polyline", "polygon"):
            numbers = np.array(element.get("points", "").replace(",", " ").split(), dtype=np.float64)
            return [(numbers[: len(numbers) // 2 * 2].reshape(-1, 2), kind == "polygon")]
        if kind == "line":
            ends = [[self.length(element, f"x{k}", 0), self.length(element, f"y{k}", 1)] for k in (1, 2)]
            return [(np.array(ends), False)]
        return self._ways(self._path(element, kind))

    def length(self, element: Element, key: str, axis: int, default: str = "0") -> float:
        """An attribute as pixels; axis: what a percentage is of, 0 = width, 1 = height, 2 = both."""
        from svgelements import Length

        width, height = self._page
        whole = (width, height, math.hypot(width, height) / math.sqrt(2.0))[axis]
        text = element.get(key) or default
        return float(Length("0" if text == "auto" else text).value(ppi=96.0, relative_length=whole, font_size=16.0))

    def _path(self, element: Element, kind: str) -> object:
        from svgelements import Circle, Ellipse, Path, Rect

        if kind == "path":
            return Path(element.get("d", ""))
        if kind == "rect":
            x, y, width, height = (
                self.length(element, key, k % 2) for k, key in enumerate(("x", "y", "width", "height"))
            )
            rx, ry = element.get("rx"), element.get("ry")
            across = self.length(element, "rx" if rx else "ry", 0)
            up = self.length(element, "ry" if ry else "rx", 1)
            if width <= 0.0 or height <= 0.0:
                return Path()
            return Path(Rect(x, y, width, height, min(across, width / 2), min(up, height / 2)))
        centre = self.length(element, "cx", 0), self.length(element, "cy", 1)
        if kind == "circle":
            return Path(Circle(*centre, self.length(element, "r", 2)))
        return Path(Ellipse(*centre, self.length(element, "rx", 0), self.length(element, "ry", 1)))

    def _ways(self, path: object) -> list[tuple[Ring, bool]]:
        from svgelements import Arc, Close, CubicBezier, Move, QuadraticBezier

        ways: list[tuple[list[NDArray[np.float64]], bool]] = []
        for segment in path:  # type: ignore[attr-defined]
            if isinstance(segment, Move) or not ways:
                ways.append(([_points(segment.end)], False))
            elif isinstance(segment, Close):
                ways[-1] = ways[-1][0], True
                # What follows without a move begins where the closed way began.
                ways.append(([ways[-1][0][0]], False))
            elif isinstance(segment, QuadraticBezier):
                ways[-1][0].append(_QUADRATIC @ _points(segment.start, segment.control, segment.end))
            elif isinstance(segment, CubicBezier):
                ways[-1][0].append(_CUBIC @ _points(segment.start, segment.control1, segment.control2, segment.end))
            elif isinstance(segment, Arc):
                count = min(TURN_POINTS, max(4, math.ceil(abs(float(segment.sweep)) / math.tau * TURN_POINTS)))
                ways[-1][0].append(np.array(segment.npoint(np.linspace(0.0, 1.0, count + 1)[1:]), dtype=np.float64))
            else:
                ways[-1][0].append(_points(segment.end))
        return [(np.concatenate(parts), closed) for parts, closed in ways if closed or len(parts) > 1]


def _points(*places: object) -> NDArray[np.float64]:
    return np.array([(place.x, place.y) for place in places], dtype=np.float64)  # type: ignore[attr-defined]
