"""Reads an SVG drawing: shapes, paths, transforms, groups and copies; all else is counted."""

import re
from collections.abc import Iterator
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.sketch import FilledShape, OpenLine, Ring, Rule, Sketch, Unreadable, bounds
from sandbox.bring.svg_paths import SHAPES, Paths
from sandbox.bring.svg_style import (
    UNFOLLOWED,
    Sheet,
    Style,
    colour,
    inherited,
    is_painted,
    is_seen,
    own_properties,
    paint_server,
    style_sheet,
)
from sandbox.bring.xml_tree import local_name, xml_tree

# Elements that are drawn, copies of copies among them.
DRAWN_LIMIT = 20_000
DEPTH_LIMIT = 40
# A first outline that covers this share of the page, or more, is its background.
BACKGROUND = 0.98

CONTAINERS = ("svg", "g", "a", "switch", "symbol")
# Elements that say nothing of an outline, and are no loss.
QUIET = ("defs", "style", "metadata", "title", "desc", "namedview", "linearGradient", "radialGradient", "pattern",
         "clipPath", "mask", "filter", "marker", "symbol", "view", "")  # fmt: skip
NAMES = {"text": "text element", "image": "image", "foreignObject": "foreign object", "script": "script"}
ANIMATED = ("animate", "animateTransform", "animateMotion", "set", "animateColor")
SERVERS = {"linearGradient": "gradient", "radialGradient": "gradient", "pattern": "pattern"}
SVG = "http://www.w3.org/2000/svg"

_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_LINK = "{http://www.w3.org/1999/xlink}href"
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?")
# Where svgelements stumbles over what is no drawing.
STUMBLES = (ValueError, TypeError, IndexError, KeyError, AttributeError, ArithmeticError)


def read_svg(data: bytes) -> Sketch:
    """The outlines and open lines of an SVG, in its pixels. Raises Unreadable."""
    root = xml_tree(data)
    if local_name(root) != "svg":
        raise Unreadable("is XML, but no SVG drawing")
    reader = _Reader(root)
    reader.read(root, np.eye(3), Style(), 0, "")
    reader.take_background()
    return reader.drawing


class _Reader:
    def __init__(self, root: Element) -> None:
        self.drawing = Sketch("jelly")
        self._box = _page(root)
        self._paths = Paths((self._box[2], self._box[3]))
        self._sheet: Sheet = style_sheet(root, self.drawing.left_out)
        self._by_id: dict[str, Element] = {}
        for element in root.iter():
            self._by_id.setdefault(element.get("id", ""), element)
        self._drawn = 0
        self._told_servers: set[str] = set()
        self._copied: list[Element] = []

    def read(self, element: Element, matrix: NDArray[np.float64], style: Style, depth: int, name: str) -> None:
        """Take in an element and all in it; matrix: from its parent's coordinates to those of the page."""
        own = own_properties(element, self._sheet)
        style = inherited(style, own)
        if own.get("display") == "none":
            self.drawing.left_out.add("hidden element")
            return
        self._drawn += 1
        if self._drawn > DRAWN_LIMIT:
            raise Unreadable(f"draws more than {DRAWN_LIMIT:,} elements, copies among them; simplify it")
        if depth > DEPTH_LIMIT:
            raise Unreadable(f"nests copies and groups more than {DEPTH_LIMIT} deep; make it flatter")
        for key, word in UNFOLLOWED.items():
            if own.get(key, "none") != "none":
                self.drawing.left_out.add(word)
        kind = local_name(element)
        try:
            matrix = matrix @ _matrix(element.get("transform", ""))
        except STUMBLES:
            self.drawing.left_out.add("transform that cannot be read")
        name = element.get(_LABEL) or (element.get("id", "") if kind in SHAPES else "") or name
        if kind == "use":
            self._copy(element, matrix, style, depth, name)
        elif kind in CONTAINERS:
            for child in self._children(element):
                self.read(child, matrix, style, depth + 1, name)
        elif is_seen(style, own):
            self._take(element, matrix, style, name)

    def _children(self, element: Element) -> Iterator[Element]:
        for child in element:
            kind, space = local_name(child), str(child.tag).rpartition("}")[0].removeprefix("{")
            if kind in SHAPES or kind == "use" or (kind in CONTAINERS and kind != "symbol"):
                yield child
            elif kind in ANIMATED:
                self.drawing.left_out.add("animation")
            elif kind not in QUIET and space in (SVG, ""):
                self.drawing.left_out.add(NAMES.get(kind, f"{kind[:40]} element"))

    def _copy(self, element: Element, matrix: NDArray[np.float64], style: Style, depth: int, name: str) -> None:
        link = (element.get("href") or element.get(_LINK) or "").strip()
        wanted = self._by_id.get(link[1:]) if link.startswith("#") and len(link) > 1 else None
        if wanted is None or wanted in self._copied:
            self.drawing.left_out.add("copy of what is not in the file" if wanted is None else "copy of itself")
            return
        moved = np.eye(3)
        try:
            moved[:2, 2] = self._paths.length(element, "x", 0), self._paths.length(element, "y", 1)
        except STUMBLES:
            self.drawing.left_out.add("place that cannot be read")
        self._copied.append(wanted)
        self.read(wanted, matrix @ moved, style, depth + 1, name)
        self._copied.pop()

    def _take(self, element: Element, matrix: NDArray[np.float64], style: Style, name: str) -> None:
        kind = local_name(element)
        if kind not in SHAPES:
            self.drawing.left_out.add(NAMES.get(kind, f"{kind[:40]} element"))
            return
        for word in (local_name(child) for child in element):
            if word in ANIMATED:
                self.drawing.left_out.add("animation")
        try:
            ways = [(_placed(points, matrix), closed) for points, closed in self._paths.of(element)]
        except Unreadable:
            raise
        except STUMBLES:
            self.drawing.left_out.add(f"{kind} that cannot be read")
            return
        rings = tuple(points for points, _ in ways if len(points) > 2)
        if rings and is_painted(style.fill, style.fill_opacity):
            rule: Rule = "evenodd" if style.fill_rule == "evenodd" else "nonzero"
            self.drawing.outlines.append(FilledShape(rings, rule, self._colour(style.fill, style), name))
        elif is_painted(style.stroke, "1"):
            self._take_stroke(ways, matrix, style, name)

    def _take_stroke(self, ways: list[tuple[Ring, bool]], matrix: NDArray[np.float64], style: Style, name: str) -> None:
        """A stroke without a filling: what it goes around is inside, an open one is a line."""
        tint = self._colour(style.stroke, style)
        found = _NUMBER.match(style.stroke_width)
        width = float(found[0]) * float(np.sqrt(abs(np.linalg.det(matrix[:2, :2])))) if found else 1.0
        for points, closed in ways:
            if len(points) > 3 and not closed:
                closed = bool(np.all(np.abs(points[0] - points[-1]) <= 1e-6 * (np.abs(points[0]) + 1.0)))
            if closed and len(points) > 2:
                self.drawing.outlines.append(FilledShape((points,), "nonzero", tint, name))
            elif len(points) > 1:
                self.drawing.lines.append(OpenLine(points, width, tint, name))

    def _colour(self, paint: str, style: Style) -> str | None:
        server = paint_server(paint)
        if server is None:
            return colour(paint, style)
        found = self._by_id.get(server)
        kind = SERVERS.get(local_name(found), "paint") if found is not None else "paint that is not in the file"
        if server not in self._told_servers:
            self._told_servers.add(server)
            self.drawing.left_out.add(f"{kind} (its first colour came in)" if kind == "gradient" else kind)
        for _ in range(5):
            if found is None:
                return None
            stops = [child for child in found if local_name(child) == "stop"]
            if stops:
                own = {"stop-color": stops[0].get("stop-color", "black")}
                for part in stops[0].get("style", "").split(";"):
                    key, _, value = part.partition(":")
                    own[key.strip()] = value.strip()
                return colour(own["stop-color"], style)
            found = self._by_id.get((found.get("href") or found.get(_LINK) or "").removeprefix("#"))
        return None

    def take_background(self) -> None:
        """Leave out a first outline that covers the whole page, where others lie on it."""
        outlines = self.drawing.outlines
        if len(outlines) < 2:
            return
        found = bounds(outlines[0].rings)
        left, bottom, right, top = found or (0.0, 0.0, 0.0, 0.0)
        x, y, width, height = self._box
        if width <= 0.0 or height <= 0.0:
            return
        across = min(right, x + width) - max(left, x)
        up = min(top, -y) - max(bottom, -y - height)
        ring = outlines[0].rings[0]
        area = abs(float(np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - np.roll(ring[:, 0], -1) * ring[:, 1]))) / 2.0
        box = (right - left) * (top - bottom)
        if min(across / width, up / height) >= BACKGROUND and area >= BACKGROUND * box:
            del outlines[0]
            self.drawing.left_out.add("background")


def _placed(points: Ring, matrix: NDArray[np.float64]) -> Ring:
    """Points on the page, with y upward. Raises ValueError for what is no number."""
    placed = points @ matrix[:2, :2].T + matrix[:2, 2]
    if not np.all(np.isfinite(placed)):
        raise ValueError("no number")
    return placed * np.array([1.0, -1.0])


def _matrix(text: str) -> NDArray[np.float64]:
    from svgelements import Matrix

    if not text.strip():
        return np.eye(3)
    if len(text) > 10_000:
        raise ValueError("too long")
    m = Matrix(text)
    made = np.array([[m.a, m.c, m.e], [m.b, m.d, m.f], [0.0, 0.0, 1.0]], dtype=np.float64)
    if not np.all(np.isfinite(made)):
        raise ValueError("no number")
    return made


def _page(root: Element) -> tuple[float, float, float, float]:
    """Left, top, width and height of the page [px]."""
    numbers = [float(number) for number in _NUMBER.findall(root.get("viewBox", "")[:200])]
    if len(numbers) == 4 and numbers[2] > 0.0 and numbers[3] > 0.0:
        return numbers[0], numbers[1], numbers[2], numbers[3]
    sizes = [_NUMBER.match(root.get(key, "")) for key in ("width", "height")]
    width, height = (float(found[0]) if found else 100.0 for found in sizes)
    return 0.0, 0.0, width, height
