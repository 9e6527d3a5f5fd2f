"""Reads a Tiled map: shapes of object layers, and tiles that are solid. Its XML is told as its JSON is."""

import base64
import binascii
import gzip
import io
import math
import re
import zlib
from collections.abc import Callable, Iterator
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from sandbox.bring.sketch import (
    POINT_LIMIT,
    FilledShape,
    LeftOut,
    Object,
    OpenLine,
    Sketch,
    Unreadable,
    local_name,
    number,
    objects,
    text,
    whole,
)

Cells = NDArray[np.int64]
# Gives the tile set of a file that a map names, or None where it is not there.
Beside = Callable[[str], Object | None]
LAYER_DEPTH = 8
# Corners of an ellipse.
ROUND = 32
# Bits of a tile's number: mirrored left and right, up and down, along the diagonal; and those of hexagonal maps.
MIRRORED, UPSIDE, SWAPPED, NUMBER = 0x80000000, 0x40000000, 0x20000000, 0x0FFFFFFF
# Properties and names of layers that say what is solid, in the words that makers of games use.
SOLID_PROPERTY = re.compile(r"collides?|collision|solid|blocks?|blocking|wall|impassable", re.IGNORECASE)
SOLID_LAYER = re.compile(
    r"collision|collide|solid|wall|(?<!back)(?<!fore)ground|platform|terrain|block|floor|obstacle|world|main",
    re.IGNORECASE,
)
# Digits of the number of a tile at most.
NUMBER_DIGITS = 10
# A layer that fills this share of its map is a background.
BACKGROUND = 0.95
# Shapes of a map, tiles that lie together counted as one.
BLOCK_LIMIT = 10_000
_AXES = np.array([1.0, -1.0])
# Objects that are left out by their names, and letters of such a name.
MOST_NAMED, NAME_LENGTH = 12, 40
# Tiles of all layers.
CELL_LIMIT = 1_000_000
# Attributes of XML that are whole numbers, and numbers; names of layers, and elements that are a form.
_WHOLE = ("width", "height", "tilewidth", "tileheight", "firstgid", "gid", "columns", "tilecount", "id")
_PLAIN = ("x", "y", "rotation", "offsetx", "offsety", "opacity")
_LAYERS = {"layer": "tilelayer", "objectgroup": "objectgroup", "imagelayer": "imagelayer", "group": "group"}
_FORMS = ("ellipse", "point", "capsule", "text")


def read_tiled(data: Object, beside: Beside) -> Sketch:
    """The shapes of a map, in its pixels; beside: gives the tile sets that it names. Raises Unreadable."""
    orientation = text(data, "orientation", "orthogonal")
    if orientation != "orthogonal":
        raise Unreadable(f"is an {orientation[:20]} map of Tiled; only orthogonal maps come in")
    tile = number(data, "tilewidth"), number(data, "tileheight")
    if not (0.0 < tile[0] <= 1e5 and 0.0 < tile[1] <= 1e5):
        raise Unreadable("tilewidth, tileheight: a map needs tiles of 1 pixel or more")
    drawing = Sketch("ground", metre=tile[0])
    layers = objects(data, "layers")
    reader = _Map(drawing, tile, _Tiles(data, beside, drawing), layers)
    reader.read(layers, (0.0, 0.0), 0)
    reader.take_tiles()
    return drawing


class _Tiles:
    """Properties of tiles: their collision shapes, and whether they are marked as solid."""

    def __init__(self, data: Object, beside: Beside, drawing: Sketch) -> None:
        self.shapes: dict[int, list[Object]] = {}
        self.solid: set[int] = set()
        self.sizes: list[tuple[int, float, float]] = []
        for entry in objects(data, "tilesets"):
            first, source = whole(entry, "firstgid", 1), text(entry, "source")
            found = beside(source) if source else entry
            if found is None:
                drawing.left_out.add("tile set that is not beside the map")
                continue
            self.sizes.append((first, number(found, "tilewidth"), number(found, "tileheight")))
            for tile in _tiles_of(found):
                group = tile.get("objectgroup")
                index = first + whole(tile, "id")
                if isinstance(group, dict) and objects(group, "objects"):
                    self.shapes[index] = objects(group, "objects")
                if _is_marked(tile):
                    self.solid.add(index)
        self.sizes.sort()

    def size_of(self, index: int, default: tuple[float, float]) -> tuple[float, float]:
        """Width and height of a tile of a number [pixels]."""
        found = next(((width, height) for first, width, height in reversed(self.sizes) if first <= index), default)
        return found[0] or default[0], found[1] or default[1]


class _Map:
    def __init__(self, drawing: Sketch, tile: tuple[float, float], tiles: _Tiles, layers: list[Object]) -> None:
        self.drawing, self._tile, self._tiles = drawing, tile, tiles
        self._layers: list[tuple[str, bool, NDArray[np.int64], tuple[int, int], tuple[float, float]]] = []
        self._points = self._cells = self._named = 0
        self._says_solid = _says_solid(layers, 0)

    def read(self, layers: list[Object], offset: tuple[float, float], depth: int) -> None:
        """Take in layers, those of groups too; tiles are kept for later."""
        if depth > LAYER_DEPTH:
            raise Unreadable(f"nests groups of layers more than {LAYER_DEPTH} deep; make it flatter")
        for layer in layers:
            kind = text(layer, "type")
            if layer.get("visible") is False and not SOLID_LAYER.search(text(layer, "name")):
                self.drawing.left_out.add("hidden layer")
                continue
            place = offset[0] + number(layer, "offsetx"), offset[1] + number(layer, "offsety")
            if kind == "group":
                self.read(objects(layer, "layers"), place, depth + 1)
            elif kind == "objectgroup":
                self._take_objects(layer, place)
            elif kind == "tilelayer":
                for cells, corner in _layer_cells(layer, self.drawing.left_out, CELL_LIMIT - self._cells):
                    self._cells += cells.size
                    self._layers.append((text(layer, "name"), _is_marked(layer), cells, corner, place))
            else:
                self.drawing.left_out.add("image layer" if kind == "imagelayer" else "layer of another kind")

    def _take_objects(self, layer: Object, offset: tuple[float, float]) -> None:
        title = text(layer, "name")[:NAME_LENGTH] or "without a name"
        is_solid = _is_marked(layer) or bool(SOLID_LAYER.search(title))
        for each in objects(layer, "objects"):
            # Where nothing is said of the layer: what its own kind says is solid, or all if none says so.
            said = text(each, "type") or text(each, "class")
            is_named = bool(SOLID_LAYER.search(said)) or _is_marked(each)
            if is_solid or is_named or not (said or self._says_solid):
                self._take_object(each, offset, is_solid or is_named)
                continue
            own = (text(each, "name") or said)[:NAME_LENGTH]
            self._named += 1
            name = f'"{own}"' if own and self._named <= MOST_NAMED else "object"
            self.drawing.left_out.add(f"{name} (layer {title})")

    def _take_object(self, each: Object, offset: tuple[float, float], is_solid: bool) -> None:
        x, y = number(each, "x") + offset[0], number(each, "y") + offset[1]
        name = text(each, "name")
        if each.get("visible") is False:
            self.drawing.left_out.add("hidden object")
        elif "gid" in each:
            self._take_tile_object(each, x, y, is_solid)
        elif "template" in each:
            self.drawing.left_out.add("object of a template")
        elif each.get("text"):
            self.drawing.left_out.add("text object")
        elif each.get("point"):
            self.drawing.left_out.add("point")
        else:
            self._take_shape(each, (x, y), np.eye(2), name)

    def _take_tile_object(self, each: Object, x: float, y: float, is_solid: bool) -> None:
        cell = whole(each, "gid")
        wide, high = self._tiles.size_of(cell & NUMBER, self._tile)
        # What is said to be solid and has no shape is so as a whole, as a tile of a layer is.
        whole_box = [{"width": wide, "height": high}] if is_solid or cell & NUMBER in self._tiles.solid else []
        shapes = self._tiles.shapes.get(cell & NUMBER, whole_box)
        if not shapes:
            self.drawing.left_out.add("tile object without a collision shape")
            return
        # Mirrored in its own box, stretched with that, and turned about its lower left corner.
        mirror, move = _mirroring(cell, wide, high)
        stretch = np.diag([(number(each, "width") or wide) / wide, (number(each, "height") or high) / high])
        angle = math.radians(number(each, "rotation"))
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]) @ stretch
        corner = turn @ (np.array(move) + np.array([0.0, -high]))
        for shape in shapes:
            self._take_shape(shape, (x + corner[0], y + corner[1]), turn @ mirror, text(each, "name"), inner=True)

    def _take_shape(
        self, each: Object, at: tuple[float, float], matrix: NDArray[np.float64], name: str, inner: bool = False
    ) -> None:
        """Add a shape; at: where its place is; matrix turns it; inner: its own x and y count as well."""
        form = _form(each)
        if form is None:
            self.drawing.left_out.add("shape of another kind")
            return
        points, closed = form
        angle = math.radians(number(each, "rotation"))
        if angle:
            points = points @ np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        if inner:
            points = points + np.array([number(each, "x"), number(each, "y")])
        placed = (points @ matrix.T + np.array(at)) * _AXES
        self._points += len(placed)
        if self._points > 10 * POINT_LIMIT:
            raise Unreadable(f"has more than {10 * POINT_LIMIT:,} points of shapes; make it smaller")
        if closed:
            if len(placed) > 2 and np.ptp(placed, axis=0).min() > 0.0:
                self.drawing.outlines.append(FilledShape((placed,), "nonzero", None, name))
            else:
                self.drawing.left_out.add("shape without an area")
        elif len(placed) > 1:
            self.drawing.lines.append(OpenLine(placed, 0.0, None, name))

    def take_tiles(self) -> None:
        """Take in what of the layers of tiles is solid; where nothing says what is, all that is no background."""
        found = False
        taken: list[str] = []
        for layer in self._layers:
            count = self._take_marked(layer)
            found = found or count > 0
            if count == 0 and layer[2].any():
                taken.append(layer[0])
        unmarked = [layer for layer in self._layers if layer[0] in taken and layer[2].any()]
        if not found and not self.drawing.outlines and not self.drawing.lines:
            for layer in unmarked:
                if np.mean(layer[2] != 0) >= BACKGROUND and len(unmarked) > 1:
                    self.drawing.left_out.add("tile layer that is a background")
                else:
                    self._take_blocks(layer[2] != 0, layer[3], layer[4])
        elif unmarked:
            self.drawing.left_out.add("tile layer without collision shapes", len({layer[0] for layer in unmarked}))

    def _take_marked(self, layer: tuple[str, bool, NDArray[np.int64], tuple[int, int], tuple[float, float]]) -> int:
        """Add the solid tiles of a layer, and give their number."""
        name, marked, cells, corner, offset = layer
        numbers = cells & NUMBER
        shaped = np.isin(numbers, np.fromiter(self._tiles.shapes, np.int64, len(self._tiles.shapes)))
        solid = np.isin(numbers, np.fromiter(self._tiles.solid, np.int64, len(self._tiles.solid))) & ~shaped
        if marked or (not solid.any() and SOLID_LAYER.search(name)):
            solid = (cells != 0) & ~shaped
        self._take_blocks(solid, corner, offset)
        width, height = self._tile
        for row, column in np.argwhere(shaped).tolist():
            cell = int(cells[row, column])
            x = (corner[0] + column) * width + offset[0]
            # Tiles larger than those of the map stand on the lower edge of their cell.
            wide, high = self._tiles.size_of(cell & NUMBER, self._tile)
            y = (corner[1] + row + 1) * height - high + offset[1]
            turn, move = _mirroring(cell, wide, high)
            for shape in self._tiles.shapes[cell & NUMBER]:
                self._take_shape(shape, (x + move[0], y + move[1]), turn, "", inner=True)
        taken = int(shaped.sum() + solid.sum())
        plain = int(np.count_nonzero(cells)) - taken
        if taken and plain:
            self.drawing.left_out.add("tile without a collision shape", plain)
        return taken

    def _take_blocks(self, solid: NDArray[np.bool_], corner: tuple[int, int], offset: tuple[float, float]) -> None:
        width, height = self._tile
        for left, top, right, bottom in _blocks(solid):
            if len(self.drawing.outlines) >= BLOCK_LIMIT:
                raise Unreadable(f"has solid tiles in more than {BLOCK_LIMIT:,} blocks; make it smaller")
            x0, x1 = ((corner[0] + k) * width + offset[0] for k in (left, right))
            y0, y1 = ((corner[1] + k) * height + offset[1] for k in (top, bottom))
            ring = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]) * _AXES
            self.drawing.outlines.append(FilledShape((ring,)))


def _says_solid(layers: list[Object], depth: int) -> bool:
    """Whether a layer of objects or tiles says that it is solid."""
    return depth <= LAYER_DEPTH and any(
        _says_solid(objects(layer, "layers"), depth + 1)
        if layer.get("type") == "group"
        else _is_marked(layer) or SOLID_LAYER.search(text(layer, "name"))
        for layer in layers
    )


def _tiles_of(tile_set: Object) -> list[Object]:
    """The tiles of a set; before Tiled 1.2 they stood by their numbers, and their properties apart."""
    numbered: dict[str, dict[str, Any]] = {}
    for key, place in (("tiles", None), ("tileproperties", "properties")):
        found = tile_set.get(key)
        for digits, each in found.items() if isinstance(found, dict) else ():
            if isinstance(each, dict) and digits.isdecimal() and len(digits) < NUMBER_DIGITS:
                numbered.setdefault(digits, {"id": int(digits)}).update(each if place is None else {place: each})
    return list(numbered.values()) or objects(tile_set, "tiles")


def _is_marked(holder: Object) -> bool:
    """Whether a property says that a tile or a layer is solid."""
    properties = holder.get("properties")
    if isinstance(properties, dict):
        properties = [{"name": name, "value": value} for name, value in properties.items()]
    if not isinstance(properties, list):
        return False
    return any(
        isinstance(each, dict) and each.get("value") is True and SOLID_PROPERTY.fullmatch(str(each.get("name")))
        for each in properties
    )


def _form(each: Object) -> tuple[NDArray[np.float64], bool] | None:
    """Points of a shape about its place, y downward, and whether it is closed."""
    for key in ("polygon", "polyline"):
        if key in each:
            places = (
                _pairs(each[key])
                if isinstance(each[key], str)
                else [(number(place, "x"), number(place, "y")) for place in objects(each, key)]
            )
            return np.array(places, dtype=np.float64).reshape(-1, 2), key == "polygon"
    width, height = number(each, "width"), number(each, "height")
    if each.get("ellipse"):
        turn = np.arange(ROUND) * (math.tau / ROUND)
        unit = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        return (unit + 1.0) * np.array([width, height]) / 2.0, True
    if each.get("capsule") or each.get("text") or each.get("point"):
        return None
    return np.array([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]), True


def _mirroring(cell: int, width: float, height: float) -> tuple[NDArray[np.float64], tuple[float, float]]:
    """How a tile's bits turn and mirror it, and how that is moved back into its cell."""
    matrix, move = np.eye(2), [0.0, 0.0]
    if cell & SWAPPED:
        matrix = np.array([[0.0, 1.0], [1.0, 0.0]])
    if cell & MIRRORED:
        matrix, move[0] = np.array([[-1.0, 0.0], [0.0, 1.0]]) @ matrix, width
    if cell & UPSIDE:
        matrix, move[1] = np.array([[1.0, 0.0], [0.0, -1.0]]) @ matrix, height
    return matrix, (move[0], move[1])


def _blocks(solid: NDArray[np.bool_]) -> Iterator[tuple[int, int, int, int]]:
    """Left, top, right, bottom of rectangles that cover the cells: runs of a row, as far down as they are the same."""
    running: dict[tuple[int, int], int] = {}
    for row in range(len(solid) + 1):
        runs = set()
        if row < len(solid):
            turns = np.flatnonzero(np.diff(np.concatenate([[False], solid[row], [False]]).astype(np.int8)))
            runs = set(zip(turns[0::2].tolist(), turns[1::2].tolist(), strict=True))
        for ended in sorted(running.keys() - runs):
            yield ended[0], running.pop(ended), ended[1], row
        for run in runs:
            running.setdefault(run, row)


def _layer_cells(layer: Object, left_out: LeftOut, most: int) -> Iterator[tuple[Cells, tuple[int, int]]]:
    """Numbers of tiles (rows, columns), and the column and row of the first, of each part of a layer of so many.

    Raises Unreadable for what is damaged.
    """
    parts = objects(layer, "chunks") if "chunks" in layer else [layer]
    packing = text(layer, "compression")
    if packing not in ("", "zlib", "gzip"):
        left_out.add(f"tile layer packed as {packing[:20]}")
        return
    total = 0
    for part in parts:
        width, height = whole(part, "width"), whole(part, "height")
        total += max(0, width) * max(0, height)
        if width < 0 or height < 0 or total > most:
            raise Unreadable(f"has a layer of tiles of no size, or more than {CELL_LIMIT:,} tiles in all")
        cells = _cells(part.get("data"), width * height, packing)
        yield cells.reshape(height, width), (whole(part, "x"), whole(part, "y"))


def _cells(data: Any, count: int, packing: str) -> Cells:
    if data is None:
        return np.zeros(count, dtype=np.int64)
    if isinstance(data, str):
        return _unpacked(data, count, packing)
    if not isinstance(data, list) or len(data) != count:
        raise Unreadable("has a layer of tiles whose data is no list as long as its size")
    if not all(type(cell) is int and 0 <= cell < 2**32 for cell in data):
        raise Unreadable("has a layer of tiles whose data holds more than numbers of tiles")
    return np.array(data, dtype=np.int64)


def _unpacked(data: str, count: int, packing: str) -> Cells:
    try:
        packed = base64.b64decode(data.strip(), validate=False)
        if packing == "zlib":
            packed = zlib.decompressobj().decompress(packed, 4 * count + 1)
        elif packing == "gzip":
            with gzip.GzipFile(fileobj=io.BytesIO(packed)) as file:
                packed = file.read(4 * count + 1)
    except (binascii.Error, zlib.error, OSError, EOFError, ValueError):
        raise Unreadable("has a layer of tiles whose packed data is damaged") from None
    if len(packed) != 4 * count:
        raise Unreadable("has a layer of tiles whose data is not as long as its size")
    return np.frombuffer(packed, dtype="<u4").astype(np.int64)


def map_data(root: Element) -> dict[str, Any]:
    """A map as data. Raises Unreadable."""
    data = _attributes(root)
    data["infinite"] = root.get("infinite") == "1"
    data["tilesets"] = [tileset_data(child) for child in root if local_name(child) == "tileset"]
    data["layers"] = _layers(root)
    return data


def tileset_data(root: Element) -> dict[str, Any]:
    """A tile set as data. Raises Unreadable."""
    data = _attributes(root)
    data["tiles"] = []
    for child in root:
        if local_name(child) == "tile":
            tile = _attributes(child)
            groups = [_group(each) for each in child if local_name(each) == "objectgroup"]
            if groups:
                tile["objectgroup"] = groups[0]
            data["tiles"].append(tile)
    return data


def _layers(parent: Element) -> list[dict[str, Any]]:
    made: dict[str, Callable[[Element], dict[str, Any]]] = {
        "layer": _tile_layer, "objectgroup": _group, "imagelayer": _attributes,
        "group": lambda each: _attributes(each) | {"layers": _layers(each)},
    }  # fmt: skip
    layers = []
    for child in parent:
        kind = local_name(child)
        if kind in made:
            layers.append(made[kind](child) | {"type": _LAYERS[kind], "visible": child.get("visible") != "0"})
    return layers


def _tile_layer(element: Element) -> dict[str, Any]:
    layer = _attributes(element)
    data = next((child for child in element if local_name(child) == "data"), None)
    if data is None:
        return layer
    layer |= {"encoding": data.get("encoding", "xml"), "compression": data.get("compression", "")}
    chunks = [child for child in data if local_name(child) == "chunk"]
    if chunks:
        layer["chunks"] = [_attributes(chunk) | {"data": _xml_cells(chunk, layer["encoding"])} for chunk in chunks]
    else:
        layer["data"] = _xml_cells(data, layer["encoding"])
    return layer


def _xml_cells(element: Element, encoding: str) -> Any:
    content = (element.text or "").strip()
    if encoding == "base64":
        return content
    if encoding == "csv":
        return [_whole(cell, "a tile") for cell in content.replace("\n", "").split(",") if cell.strip()]
    return [_whole(child.get("gid", "0"), "gid") for child in element if local_name(child) == "tile"]


def _group(element: Element) -> dict[str, Any]:
    return _attributes(element) | {"objects": [_object(each) for each in element if local_name(each) == "object"]}


def _object(element: Element) -> dict[str, Any]:
    data = _attributes(element) | {"visible": element.get("visible") != "0"}
    for child in element:
        kind = local_name(child)
        if kind in _FORMS:
            data[kind] = True
        elif kind in ("polygon", "polyline"):
            # Kept as it is written, which takes least memory, until it is drawn.
            data[kind] = child.get("points") or ""
    return data


def _pairs(text: str) -> list[tuple[float, float]]:
    """The places of "1,2 3,4". Raises Unreadable."""
    if text.count(",") > POINT_LIMIT:
        raise Unreadable(f"has a shape of more than {POINT_LIMIT:,} points; make it smaller")
    places = []
    for pair in text.split():
        x, comma, y = pair.partition(",")
        if not comma:
            raise Unreadable(f"points: {pair[:40]} is no pair of numbers")
        places.append((_number(x, "points"), _number(y, "points")))
    return places


def _attributes(element: Element) -> dict[str, Any]:
    data: dict[str, Any] = {
        key: _whole(value, key) if key in _WHOLE and local_name(element) != "object" else value
        for key, value in element.attrib.items()
        if key != "visible"
    }
    for key in (*_PLAIN, *(("width", "height") if local_name(element) == "object" else ())):
        if key in data:
            data[key] = _number(data[key], key)
    if local_name(element) == "object" and "gid" in data:
        data["gid"] = _whole(data["gid"], "gid")
    properties = [each for child in element if local_name(child) == "properties" for each in child]
    data["properties"] = [
        {"name": each.get("name", ""), "value": each.get("value") == "true"}
        for each in properties
        if each.get("type") == "bool"
    ]
    return data


def _whole(text: str, key: str) -> int:
    try:
        if len(text) > 20:
            raise ValueError
        return int(text)
    except ValueError:
        raise Unreadable(f"{key}: {text[:40]!r} is no whole number") from None


def _number(text: str, key: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise Unreadable(f"{key}: {text[:40]!r} is no number") from None
