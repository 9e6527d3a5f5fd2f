"""bring: a level of a file of another program, and a word about all of it that did not come in."""

import contextlib
import importlib.util
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from sandbox.bring.making import level_of_drawing, tidy
from sandbox.bring.picture import read_picture
from sandbox.bring.rube import level_of_rube
from sandbox.bring.sketch import Kind, LeftOut, Object, Unreadable, check_points, local_name, xml_tree
from sandbox.bring.svg import read_svg
from sandbox.bring.tiled import map_data, read_tiled, tileset_data
from sandbox.level.document.messages import worded
from sandbox.level.document.model import Level, Settings
from sandbox.level.faults.validate import check_level
from sandbox.level.format.foreign import BROUGHT, PNG, RUBE, SVG, TILED_XML, foreign_bytes, foreign_keys
from sandbox.level.format.level_error import LevelError
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.reading.files import read_bytes
from sandbox.level.reading.parse import json_value
from sandbox.physics.softness.firmness import FirmnessRange, OutOfReach

# What the readers need beside what is always installed.
MODULES = ("shapely", "svgelements", "defusedxml", "contourpy", "PIL")
MISSING = 'bringing in drawings and maps needs more packages: pip install "spring-sandbox[bring]"'
# Tile sets that a map may name.
TILE_SETS = 50
HEAD = 4096  # [bytes]
# How much of the work is done once outlines are bodies.
MADE = 0.4
MARK = b"\xef\xbb\xbf"


@dataclass(frozen=True)
class Brought:
    """A brought level, with what was left out: "3 text elements"."""

    level: Level
    left_out: list[str]

    @property
    def came(self) -> str:
        """The line of what was brought: "2 jellies and 1 piece of ground came in"."""
        level = self.level
        plain = all(body.type == "jelly" for body in level.bodies)
        bodies = ("jelly", "jellies") if plain else ("body", "bodies")
        parts = ((len(level.bodies), *bodies), (len(level.terrain), "piece of ground", "pieces of ground"))
        came = " and ".join(f"{count:,} {one if count == 1 else many}" for count, one, many in parts if count)
        return f"{came} came in"

    def said(self) -> str:
        """A line for the person: what was brought in, and what was left out."""
        return self.came + (f"; left out: {', '.join(self.left_out)}" if self.left_out else "")


def is_brought(path: str | os.PathLike[str]) -> bool:
    """Whether a file is of a kind that can be brought in, by its first bytes or its keys."""
    try:
        with open(path, "rb") as file:
            # Levels and recordings are read but once.
            if b"spring-sandbox/" in file.read(HEAD):
                return False
        return _recognised(read_bytes(path), os.fspath(path))[0] in BROUGHT
    except (LevelError, OSError, ValueError):
        return False


def usual_kind(path: str | os.PathLike[str]) -> Kind | None:
    """What a file becomes unless told otherwise; None: each of its things what fits it. Raises LevelError."""
    name = _recognised(read_bytes(path), os.fspath(path))[0]
    return None if name == RUBE else "jelly" if name in (SVG, PNG) else "ground"


def bring(
    path: str | os.PathLike[str], kind: Kind | None = None, width: float | None = None,
    tell: Callable[[float], object] = lambda done: None,
) -> Brought:  # fmt: skip
    """Make a level of a file; kind: what outlines become, width: of all of it [m]; None: as is usual for such a file.

    tell: is called with how much is done, 0..1; what it raises ends the work. Raises LevelError with one line.
    """
    source = os.fspath(path)
    if any(importlib.util.find_spec(module) is None for module in MODULES):
        raise LevelError(source, [("", MISSING)])
    data = read_bytes(source)
    name, raw = _recognised(data, source)
    if name not in BROUGHT:
        said = f"is {name}" if name else "is nothing that is known here"
        raise LevelError(source, [("", f"{said}; SVG, PNG, Tiled maps and R.U.B.E. scenes (JSON) come in")])
    try:
        # Numbers beyond all bounds are found where they have come to.
        with np.errstate(all="ignore"):
            level, left_out = _level(name, data, raw, source, kind, width)
        for number, body in enumerate(level.bodies):
            tell(MADE + (1.0 - MADE) * number / len(level.bodies))
            _try_firmness(body, level.settings)
        check_level(level, source)
    except Unreadable as error:
        raise LevelError(source, [("", str(error))]) from None
    except ValidationError as error:
        errors: list[Any] = error.errors(include_url=False)
        place, text = next(worded(errors))
        raise LevelError(source, [("", f"holds a value that no level may have: {place}: {text}")]) from None
    except (MemoryError, RecursionError):
        raise LevelError(source, [("", "is too large or too deep to be read")]) from None
    return Brought(level, left_out.words())


def _try_firmness(body: AnyBody, settings: Settings) -> None:
    """Find out how firm a body can be, which takes most of the time and is kept for the check of the whole level."""
    if body.firmness is not None:
        form = FirmnessRange.of(expansion(body).stiff_form, settings.gravity, settings.tick_rate)
        with contextlib.suppress(OutOfReach):
            form.coefficients(body.firmness.asked)


def _level(
    name: str, data: bytes, raw: Object | None, source: str, kind: Kind | None, width: float | None
) -> tuple[Level, LeftOut]:
    title = tidy(Path(source).stem) or "Brought in"
    if name == RUBE:
        assert raw is not None
        return level_of_rube(raw, kind, width, title)
    if name == PNG:
        drawing = read_picture(data)
    elif name == SVG:
        drawing = read_svg(data)
    else:
        found = map_data(xml_tree(data)) if name == TILED_XML else raw
        assert found is not None
        drawing = read_tiled(found, _Shelf(Path(source).parent).tile_set)
    check_points(drawing)
    return level_of_drawing(drawing, kind or drawing.usual, width, title), drawing.left_out


def _recognised(data: bytes, source: str) -> tuple[str | None, Object | None]:
    """The kind of a file in words, and its JSON where it is that. Raises LevelError."""
    data = data.removeprefix(MARK)
    kind = foreign_bytes(data)
    if kind is not None:
        return kind, None
    raw = json_value(data, source)
    if not isinstance(raw, dict):
        return None, None
    return ("a level already" if "format" in raw else foreign_keys(raw)), raw


class _Shelf:
    """The tile sets that lie beside a map."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._read = folder, 0

    def tile_set(self, name: str) -> Object | None:
        """The tile set that a map names by a path from its own folder; None where none can be read."""
        self._read += 1
        if self._read > TILE_SETS:
            raise Unreadable(f"names more than {TILE_SETS} tile sets")
        if os.path.isabs(name) or "\0" in name or not name.lower().endswith((".tsx", ".tsj", ".json", ".xml")):
            return None
        try:
            data = read_bytes(self._folder / name.replace("\\", "/"))
            if data.lstrip().removeprefix(MARK).startswith(b"<"):
                root = xml_tree(data)
                return tileset_data(root) if local_name(root) == "tileset" else None
            found = json_value(data, name)
        except LevelError:
            return None
        return found if isinstance(found, dict) and "tilewidth" in found else None
