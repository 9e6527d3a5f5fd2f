"""Sketch: what a reader finds in a file, as closed outlines and open lines; y points up.

And what readers take it from: values of JSON, each of the type that is needed, and XML of strangers within limits.
"""

import io
import math
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal
from xml.etree.ElementTree import Element, ParseError

import numpy as np
from numpy.typing import NDArray

from sandbox.level.format.level_error import shown
from sandbox.physics.geometry.segment import signed_area

Object = Mapping[str, Any]
Ring = NDArray[np.float64]
Rule = Literal["nonzero", "evenodd"]
# What can be made of a drawing, in the words of the shell.
Kind = Literal["jelly", "ground"]
# Points of all outlines and lines; reading and uniting them takes time in proportion to these.
POINT_LIMIT = 40_000
# Points of one outline or line: simplifying it goes as deep into itself as it has points.
RING_LIMIT = 20_000
# Farthest point from [0, 0] in units of the file.
PLACE_LIMIT = 1e9
# Elements of an XML text, and how deep they nest.
ELEMENT_LIMIT, DEPTH_LIMIT = 100_000, 100
# Words that end the noun in the name of what was left out.
_AFTER = ("of", "that", "without", "too", "in", "with", "for")


@dataclass(frozen=True)
class FilledShape:
    """A filled shape: closed rings (n, 2) and the rule that says what is inside; colour: "#RRGGBB" or None."""

    rings: tuple[Ring, ...]
    rule: Rule = "nonzero"
    colour: str | None = None
    name: str = ""


@dataclass(frozen=True)
class OpenLine:
    """An open line (n, 2), and how wide it is drawn."""

    points: Ring
    width: float = 0.0
    colour: str | None = None
    name: str = ""


@dataclass
class LeftOut:
    """Counts of the things of a file that were left out, by names in the singular."""

    counts: Counter[str] = field(default_factory=Counter)

    def add(self, name: str, count: int = 1) -> None:
        """Count things of a name."""
        self.counts[name] += count

    def words(self) -> list[str]:
        """ "3 text elements", "1 gradient": the most frequent first."""
        return [f"{count:,} {name if count == 1 else plural(name)}" for name, count in self.counts.most_common()]


@dataclass(frozen=True)
class Pixels:
    """The pixels (h, w, 4) of a picture, 0..255, where its lower left corner lies (y up), and the size of a pixel."""

    pixels: NDArray[np.uint8]
    corner: tuple[float, float]
    size: float


@dataclass
class Sketch:
    """Outlines and lines in the file's own unit, and what was left out.

    usual: what a drawing of this kind becomes unless told otherwise. tolerance: how far an outline may be moved without
    a loss that is seen. metre: what becomes a metre. Both are in the file's unit. picture: what
    jellies wear.
    """

    usual: Kind
    outlines: list[FilledShape] = field(default_factory=list)
    lines: list[OpenLine] = field(default_factory=list)
    left_out: LeftOut = field(default_factory=LeftOut)
    tolerance: float = 0.0
    metre: float | None = None
    picture: Pixels | None = None

    def points(self) -> Iterator[Ring]:
        """The points of all rings and lines."""
        for outline in self.outlines:
            yield from outline.rings
        for line in self.lines:
            yield line.points


class Unreadable(ValueError):
    """A file that cannot be brought in; its text is one line, to be read after the file's name."""


def plural(name: str) -> str:
    """The plural of a name: of its last word before "of", "that" and the like; what stands in brackets stays."""
    name, bracket, rest = name.partition(" (")
    words = name.split(" ")
    stop = next((k for k, word in enumerate(words) if word in _AFTER), len(words))
    noun = words[stop - 1]
    ending = "ies" if noun.endswith("y") else "es" if noun.endswith(("s", "h", "x")) else "s"
    words[stop - 1] = (noun[:-1] if noun.endswith("y") else noun) + ending
    many = " ".join(words).replace(" that has ", " that have ").replace(" that is ", " that are ")
    return many + bracket + rest


def bounds(rings: Iterable[Ring]) -> tuple[float, float, float, float] | None:
    """Left, bottom, right, top of all points; None where there are none."""
    found = [ring for ring in rings if len(ring)]
    if not found:
        return None
    lows, highs = np.array([ring.min(axis=0) for ring in found]), np.array([ring.max(axis=0) for ring in found])
    left, bottom = lows.min(axis=0).tolist()
    right, top = highs.max(axis=0).tolist()
    return left, bottom, right, top


def area_of(ring: Ring) -> float:
    """The area inside a ring."""
    return abs(signed_area(ring, np.roll(ring, -1, axis=0)))


def check_points(drawing: Sketch) -> None:
    """Raise Unreadable for a drawing of too many points, or of places that no level could hold."""
    total = 0
    for ring in drawing.points():
        total += len(ring)
        if len(ring) > RING_LIMIT:
            raise Unreadable(f"has an outline of more than {RING_LIMIT:,} points; simplify it")
        if not np.all(np.abs(ring) <= PLACE_LIMIT):
            raise Unreadable(f"has places beyond {PLACE_LIMIT:,.0f}; draw it nearer to its origin")
    if total > 10 * POINT_LIMIT:
        raise Unreadable(f"has more than {10 * POINT_LIMIT:,} points; simplify it")


def number(holder: Object, key: str, default: float = 0.0) -> float:
    """A finite number; default where there is none. Raises Unreadable."""
    value = holder.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
        raise Unreadable(f"{key}: {shown(value)} is no number")
    return float(value)


def whole(holder: Object, key: str, default: int = 0) -> int:
    """A whole number; default where there is none. Raises Unreadable."""
    value = number(holder, key, default)
    if value != math.floor(value) or abs(value) > 2**53:
        raise Unreadable(f"{key}: {shown(holder.get(key))} is no whole number")
    return int(value)


def text(holder: Object, key: str, default: str = "") -> str:
    """A text; default where there is none. Raises Unreadable."""
    value = holder.get(key, default)
    if not isinstance(value, str):
        raise Unreadable(f"{key}: {shown(value)} is no text")
    return value


def objects(holder: Object, key: str) -> list[Object]:
    """A list of objects, empty where there is none. Raises Unreadable."""
    value = holder.get(key)
    if value is None:
        return []
    if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
        raise Unreadable(f"{key}: {shown(value)} is no list of objects")
    return value


def xml_tree(data: bytes) -> Element:
    """The root of an XML text. Raises Unreadable."""
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import iterparse

    depth = count = 0
    root: Element | None = None
    try:
        events: Any = iterparse(io.BytesIO(data), events=("start", "end"))
        for event, element in events:
            root = element if root is None else root
            depth += 1 if event == "start" else -1
            count += event == "start"
            if depth > DEPTH_LIMIT:
                raise Unreadable(f"nests elements more than {DEPTH_LIMIT} deep; make it flatter")
            if count > ELEMENT_LIMIT:
                raise Unreadable(f"has more than {ELEMENT_LIMIT:,} elements; simplify it")
    except DefusedXmlException:
        raise Unreadable("declares entities of XML; save it without them, as plain XML") from None
    except ParseError as error:
        line, column = error.position
        raise Unreadable(f"line {line}, column {column + 1}: not XML: {str(error).partition(':')[0]}") from None
    except (LookupError, ValueError) as error:
        if isinstance(error, Unreadable):
            raise
        raise Unreadable("has a character set that is not known; save it as UTF-8") from None
    if root is None:
        raise Unreadable("is empty")
    return root


def local_name(element: Element) -> str:
    """The name of an element without its namespace; "" for comments and the like."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
