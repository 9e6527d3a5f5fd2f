"""Reads an SVG drawing: shapes, paths, transforms, groups and copies; all else is counted."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.sketch import (
    PLACE_LIMIT,
    FilledShape,
    LeftOut,
    OpenLine,
    Ring,
    Rule,
    Sketch,
    Unreadable,
    area_of,
    bounds,
    local_name,
    xml_tree,
)

# Elements that are drawn, copies of copies among them.
DRAWN_LIMIT = 20_000
DEPTH_LIMIT = 40
# A first outline that covers this share of the page, or more, is its background.
BACKGROUND = 0.98
# What percentages are of where a page does not say how large it is [px].
USUAL_PAGE = 100.0
# Ends of a stroke meet that are no farther apart than this share of its size.
SMALL_GAP = 0.1
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
_UP_TO_BRACE = re.compile(r"([^{}]*)([{}]|\Z)")
_SIMPLE = re.compile(r"[.#]?[A-Za-z_][\w-]*")
_COMMENT = re.compile(r"/\*.*?(?:\*/|\Z)", re.DOTALL)
_PAINT_SERVER = re.compile(r"url\(\s*['\"]?#([^'\")]*)['\"]?\s*\)")
READ = ("fill", "stroke", "stroke-width", "fill-rule", "display", "visibility", "fill-opacity", "opacity", "color")
# What an element says that changes how it is seen, and is not followed.
UNFOLLOWED = {"clip-path": "clip path", "mask": "mask", "filter": "filter"}
RULE_LIMIT = 10_000
# Characters of a rule of a style sheet, or of what an element says of its style.
STYLE_LIMIT = 10_000
Sheet = dict[str, dict[str, str]]
# Points of a curve, and of a whole turn of an arc.
CURVE_POINTS, TURN_POINTS = 14, 48
# Characters of all paths of a drawing: reading a million of them takes five seconds.
PATH_LIMIT = 1_000_000
SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")
_T = np.linspace(0.0, 1.0, CURVE_POINTS + 1)[1:, None]
# Weights (points, controls) of a quadratic and a cubic curve.
_QUADRATIC = np.concatenate([(1 - _T) ** 2, 2 * _T * (1 - _T), _T**2], axis=1)
_CUBIC = np.concatenate([(1 - _T) ** 3, 3 * _T * (1 - _T) ** 2, 3 * _T**2 * (1 - _T), _T**3], axis=1)


@dataclass(frozen=True)
class Style:
    """The style that an element inherits: paints as they are written, and whether it is seen."""

    fill: str = "black"
    stroke: str = "none"
    stroke_width: str = "1"
    fill_rule: str = "nonzero"
    visibility: str = "visible"
    fill_opacity: str = "1"
    color: str = "black"


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
        self._paths = Paths((self._box[2] or USUAL_PAGE, self._box[3] or USUAL_PAGE))
        # Width and height that a copy gives to the drawing which it copies.
        self._copy_size: tuple[float | None, float | None] = None, None
        self._sheet: Sheet = _style_sheet(root, self.drawing.left_out)
        self._by_id: dict[str, Element] = {}
        for element in root.iter():
            self._by_id.setdefault(element.get("id", ""), element)
        self._drawn = 0
        self._reported_servers: set[str] = set()
        self._copied: list[Element] = []

    def read(self, element: Element, matrix: NDArray[np.float64], style: Style, depth: int, name: str) -> None:
        """Take in an element and all in it; matrix: from its parent's coordinates to those of the page."""
        own = _own_properties(element, self._sheet)
        attributes = {key.replace("-", "_"): value for key, value in own.items() if value != "inherit"}
        style = replace(style, **{key: value for key, value in attributes.items() if key in Style.__dataclass_fields__})
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
            matrix = matrix @ _matrix(own.get("transform") or element.get("transform") or "")
        except STUMBLES:
            self.drawing.left_out.add("transform that cannot be read")
        name = element.get(_LABEL) or (element.get("id", "") if kind in SHAPES else "") or name
        if kind == "use":
            self._copy(element, matrix, style, depth, name)
        elif kind in ("svg", "symbol"):
            self._read_viewport(element, matrix, style, depth, name)
        elif kind in CONTAINERS:
            for child in self._children(element):
                self.read(child, matrix, style, depth + 1, name)
        elif style.visibility not in ("hidden", "collapse") and not _is_zero(own.get("opacity", "1")):
            self._take(element, matrix, style, name)

    def _read_viewport(
        self, element: Element, matrix: NDArray[np.float64], style: Style, depth: int, name: str
    ) -> None:
        # A drawing, with a view box and lengths of its own: the page, one in it, or a symbol that is copied.
        size, self._copy_size = self._copy_size, (None, None)
        page = self._paths.page
        try:
            x, y = (0.0, 0.0) if depth == 0 else (self._paths.length(element, key, k) for k, key in enumerate("xy"))
            width, height = (
                self._paths.length(element, key, k, "100%") if size[k] is None or size[k] == 0.0 else size[k] or 0.0
                for k, key in enumerate(("width", "height"))
            )
            inner, self._paths.page = _view(element, (x, y, width, height))
        except STUMBLES:
            self.drawing.left_out.add("view box that cannot be read")
            inner = np.eye(3)
        if depth == 0:
            # Whole drawings are as large as they are made; but they may be stretched.
            inner = np.diag([1.0, inner[1, 1] / inner[0, 0], 1.0])
            self._box = self._box[0], self._box[1] * inner[1, 1], self._box[2], self._box[3] * inner[1, 1]
        for child in self._children(element):
            self.read(child, matrix @ inner, style, depth + 1, name)
        self._paths.page = page

    def _children(self, element: Element) -> Iterator[Element]:
        if local_name(element) == "switch":
            # The first that a program can show which knows English and nothing beyond SVG.
            shown = (child for child in element if local_name(child) != "foreignObject" and _is_chosen(child))
            yield from [child for child in shown if local_name(child) in (*SHAPES, *CONTAINERS, "use")][:1]
            return
        for child in element:
            kind, space = local_name(child), str(child.tag).rpartition("}")[0].removeprefix("{")
            if kind in SHAPES or kind == "use" or (kind in CONTAINERS and kind != "symbol"):
                yield child
            elif kind in ANIMATED:
                self.drawing.left_out.add("animation")
            elif kind not in QUIET and space in (SVG, ""):
                self.drawing.left_out.add(NAMES.get(kind, f"{kind[:40]} element"))

    def _copy(self, element: Element, matrix: NDArray[np.float64], style: Style, depth: int, name: str) -> None:
        link = (element.get("href") or element.get(_LINK) or "")[:STYLE_LIMIT].strip()
        target = self._by_id.get(link[1:]) if link.startswith("#") and len(link) > 1 else None
        if target is None or target in self._copied:
            self.drawing.left_out.add("copy of what is not in the file" if target is None else "copy of itself")
            return
        moved = np.eye(3)
        try:
            moved[:2, 2] = self._paths.length(element, "x", 0), self._paths.length(element, "y", 1)
        except STUMBLES:
            self.drawing.left_out.add("place that cannot be read")
        self._copied.append(target)
        if local_name(target) in ("svg", "symbol"):
            self._copy_size = self._size_of(element)
        self.read(target, matrix @ moved, style, depth + 1, name)
        self._copied.pop()

    def _size_of(self, copy: Element) -> tuple[float | None, float | None]:
        try:
            width, height = (
                self._paths.length(copy, key, k) if copy.get(key) else None for k, key in enumerate(("width", "height"))
            )
        except STUMBLES:
            return None, None
        return width, height

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
        if rings and _is_painted(style.fill, style.fill_opacity):
            rule: Rule = "evenodd" if style.fill_rule == "evenodd" else "nonzero"
            self.drawing.outlines.append(FilledShape(rings, rule, self._colour(style.fill, style), name))
        elif _is_painted(style.stroke, "1"):
            self._take_stroke(ways, matrix, style, name)

    def _take_stroke(self, ways: list[tuple[Ring, bool]], matrix: NDArray[np.float64], style: Style, name: str) -> None:
        """Add a stroke without a filling: closed, it is filled, open, it is a line."""
        tint = self._colour(style.stroke, style)
        found = _NUMBER.match(style.stroke_width)
        width = float(found[0]) * float(np.sqrt(abs(np.linalg.det(matrix[:2, :2])))) if found else 1.0
        if not width <= PLACE_LIMIT:
            raise Unreadable(f"has a stroke wider than {PLACE_LIMIT:,.0f}; draw it thinner")
        for points, closed in ways:
            if len(points) > 3 and not closed:
                # Ends that lie within each other's width are seen to meet, as in drawings by hand.
                reach = np.maximum(
                    1e-6 * (np.abs(points[0]) + 1.0), min(width, SMALL_GAP * np.ptp(points, axis=0).max())
                )
                closed = bool(np.all(np.abs(points[0] - points[-1]) <= reach))
            if closed and len(points) > 2:
                self.drawing.outlines.append(FilledShape((points,), "nonzero", tint, name))
            elif len(points) > 1:
                self.drawing.lines.append(OpenLine(points, width, tint, name))

    def _colour(self, paint: str, style: Style) -> str | None:
        named = _PAINT_SERVER.match(paint)
        if named is None:
            return _colour_of(paint, style)
        server = named[1]
        found = self._by_id.get(server)
        kind = SERVERS.get(local_name(found), "paint") if found is not None else "paint that is not in the file"
        if server not in self._reported_servers:
            self._reported_servers.add(server)
            self.drawing.left_out.add(f"{kind} (its first colour came in)" if kind == "gradient" else kind)
        for _ in range(5):
            if found is None:
                return None
            stops = [child for child in found if local_name(child) == "stop"]
            if stops:
                own = _declarations(stops[0].get("style", ""))
                return _colour_of(own.get("stop-color", stops[0].get("stop-color", "black")), style)
            found = self._by_id.get((found.get("href") or found.get(_LINK) or "").removeprefix("#"))
        return None

    def take_background(self) -> None:
        """Leave out a first outline that covers the whole page, where others lie on it."""
        outlines = self.drawing.outlines
        if not outlines or len(outlines) + len(self.drawing.lines) < 2:
            return
        found = bounds(outlines[0].rings)
        left, bottom, right, top = found or (0.0, 0.0, 0.0, 0.0)
        x, y, width, height = self._box
        if width <= 0.0 or height <= 0.0:
            return
        across = min(right, x + width) - max(left, x)
        up = min(top, -y) - max(bottom, -y - height)
        box = (right - left) * (top - bottom)
        if min(across / width, up / height) >= BACKGROUND and area_of(outlines[0].rings[0]) >= BACKGROUND * box:
            del outlines[0]
            self.drawing.left_out.add("background")


def _is_chosen(element: Element) -> bool:
    languages = element.get("systemLanguage")
    return (not languages or "en" in languages) and not element.get("requiredExtensions")


def _view(
    element: Element, place: tuple[float, float, float, float]
) -> tuple[NDArray[np.float64], tuple[float, float]]:
    """From coordinates in a drawing to those around it, and its width and height in its own.

    place: left, top, width and height around it. Raises ValueError for a view box that is none.
    """
    x, y, width, height = place
    numbers = [float(number) for number in _NUMBER.findall(element.get("viewBox", "")[:200])]
    inner = np.eye(3)
    if not numbers:
        inner[:2, 2] = x, y
        return inner, (width, height)
    if len(numbers) != 4 or not (numbers[2] > 0.0 and numbers[3] > 0.0 and width > 0.0 and height > 0.0):
        raise ValueError("no view box")
    left, top, across, up = numbers
    words = element.get("preserveAspectRatio", "xMidYMid")[:100].split() or ["xMidYMid"]
    scale = np.array([width / across, height / up])
    if words[0] != "none":
        scale[:] = scale.max() if "slice" in words else scale.min()
    for axis, (word, room, size) in enumerate((("x", width, across), ("y", height, up))):
        at = next((k for k, side in enumerate(("Min", "Mid", "Max")) if f"{word}{side}".lower() in words[0].lower()), 1)
        inner[axis, axis] = scale[axis]
        spare = 0.0 if words[0] == "none" else 0.5 * at * (room - size * scale[axis])
        inner[axis, 2] = (x, y)[axis] + spare - scale[axis] * (left, top)[axis]
    return inner, (across, up)


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
    """Left, top, width and height of the page [px]; 0 where it does not say how large it is."""
    numbers = [float(number) for number in _NUMBER.findall(root.get("viewBox", "")[:200])]
    if len(numbers) == 4 and numbers[2] > 0.0 and numbers[3] > 0.0:
        return numbers[0], numbers[1], numbers[2], numbers[3]
    told = [root.get(key, "").strip()[:STYLE_LIMIT] for key in ("width", "height")]
    width, height = (float(found[0]) if (found := _NUMBER.match(size)) and size[-1] != "%" else 0.0 for size in told)
    return 0.0, 0.0, width, height


def _style_sheet(root: Element, left_out: LeftOut) -> Sheet:
    """The style elements of a drawing: their rules by ".class", "#id" or the name of elements."""
    found: Sheet = {}
    for element in root.iter():
        if local_name(element) != "style" or not element.text:
            continue
        for count, (selectors, declarations) in enumerate(_rules(_COMMENT.sub("", element.text))):
            if count > RULE_LIMIT:
                left_out.add(f"style sheet too long (its first {RULE_LIMIT:,} rules came in)")
                break
            own = _declarations(declarations)
            for selector in selectors.split(","):
                if _SIMPLE.fullmatch(selector.strip()):
                    found.setdefault(selector.strip(), {}).update(own)
                elif not selector.strip().startswith("@"):
                    left_out.add("style rule")
    return found


def _rules(text: str) -> Iterator[tuple[str, str]]:
    """Selectors and declarations of the rules of a style sheet that hold for a page on a screen. In one pass."""
    selectors = None
    # Of what rules are in: whether it holds.
    around: list[bool] = []
    for found in _UP_TO_BRACE.finditer(text):
        before, brace = found.groups()
        head = before.rpartition(";")[2].strip()
        if brace == "{" and head.startswith("@"):
            around.append(_holds(head))
            selectors = None
        elif brace == "{":
            selectors = head
        elif brace == "}" and selectors is not None:
            if len(selectors) + len(before) > STYLE_LIMIT:
                raise Unreadable(f"has a style rule of more than {STYLE_LIMIT:,} characters; simplify it")
            if selectors and all(around):
                yield selectors, before
            selectors = None
        elif brace == "}" and around:
            around.pop()


def _holds(head: str) -> bool:
    """Whether the rules behind "@media print" and the like hold for a page in light colours on a screen."""
    kind, _, asked = head[:STYLE_LIMIT].lower().partition(" ")
    if kind in ("@supports", "@layer"):
        return not asked.strip().startswith("not ")
    return kind == "@media" and any(
        (re.search(r"\b(print|speech)\b|:\s*dark\b", query) is None) != query.strip().startswith("not ")
        for query in asked.split(",")
    )


def _declarations(text: str) -> dict[str, str]:
    """The properties of "fill: red; stroke: none"."""
    pairs = (part.partition(":") for part in text.split(";"))
    return {key.strip(): value.replace("!important", "").strip() for key, _, value in pairs if value.strip()}


def _own_properties(element: Element, sheet: Sheet) -> dict[str, str]:
    """The properties of an element itself; its style attribute counts most, then its id, its classes and its name.

    Raises Unreadable.
    """
    if max(len(element.get(key, "")) for key in ("class", "style", *READ, *UNFOLLOWED)) > STYLE_LIMIT:
        raise Unreadable(f"has an element whose style is more than {STYLE_LIMIT:,} characters; simplify it")
    found = {key: value.strip() for key, value in element.attrib.items() if key in READ or key in UNFOLLOWED}
    classes = element.get("class", "").split()[:20]
    for selector in (local_name(element), *(f".{name}" for name in classes), f"#{element.get('id', '')}"):
        found.update(sheet.get(selector, {}))
    return found | _declarations(element.get("style", ""))


def _colour_of(paint: str, style: Style) -> str | None:
    """A paint as "#RRGGBB"; None for one that is no colour."""
    from svgelements import Color

    if paint.lower() == "currentcolor":
        paint = style.color
    if len(paint) > 100:
        return None
    try:
        found = Color(paint)
        value = None if found.value is None else (found.red, found.green, found.blue)
    except (ValueError, TypeError, IndexError, AttributeError, OverflowError):
        return None
    return None if value is None else "#" + "".join(f"{min(255, max(0, part)):02X}" for part in value)


def _is_painted(paint: str, opacity: str) -> bool:
    """Whether a paint is seen."""
    return paint.lower() not in ("none", "transparent", "") and not _is_zero(opacity)


def _is_zero(text: str) -> bool:
    try:
        return float(text.removesuffix("%")) == 0.0
    except ValueError:
        return False


class Paths:
    """Reads shapes, of a drawing of this page [px], as long as it has not more of them than can be read."""

    def __init__(self, page: tuple[float, float]) -> None:
        self.page = page
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
            text = element.get("points", "")
            if _NUMBER.sub("", text).strip(", \t\r\n"):
                raise ValueError("no number")
            numbers = np.array(_NUMBER.findall(text), dtype=np.float64)
            return [(numbers[: len(numbers) // 2 * 2].reshape(-1, 2), kind == "polygon")]
        if kind == "line":
            ends = [[self.length(element, f"x{k}", 0), self.length(element, f"y{k}", 1)] for k in (1, 2)]
            return [(np.array(ends), False)]
        return self._ways(self._path(element, kind))

    def length(self, element: Element, key: str, axis: int, default: str = "0") -> float:
        """An attribute as pixels; axis: what a percentage is of, 0 = width, 1 = height, 2 = both."""
        from svgelements import Length

        width, height = self.page
        whole = (width, height, math.hypot(width, height) / math.sqrt(2.0))[axis]
        text = element.get(key) or default
        if len(text) > STYLE_LIMIT:
            raise ValueError("too long")
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
