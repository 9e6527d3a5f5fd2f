"""A Tiled map or tile set in XML, told as its JSON is."""

from collections.abc import Callable
from typing import Any
from xml.etree.ElementTree import Element

from sandbox.bring.sketch import Unreadable
from sandbox.bring.xml_tree import local_name

_WHOLE = ("width", "height", "tilewidth", "tileheight", "firstgid", "gid", "columns", "tilecount", "id")
_PLAIN = ("x", "y", "rotation", "offsetx", "offsety", "opacity")
_LAYERS = {"layer": "tilelayer", "objectgroup": "objectgroup", "imagelayer": "imagelayer", "group": "group"}
_FORMS = ("ellipse", "point", "capsule", "text")


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
        "layer": _tile_layer, "objectgroup": _group, "group": _nested, "imagelayer": _attributes,
    }  # fmt: skip
    layers = []
    for child in parent:
        kind = local_name(child)
        if kind in made:
            layers.append(made[kind](child) | {"type": _LAYERS[kind], "visible": child.get("visible") != "0"})
    return layers


def _nested(element: Element) -> dict[str, Any]:
    return _attributes(element) | {"layers": _layers(element)}


def _tile_layer(element: Element) -> dict[str, Any]:
    layer = _attributes(element)
    data = next((child for child in element if local_name(child) == "data"), None)
    if data is None:
        return layer
    layer |= {"encoding": data.get("encoding", "xml"), "compression": data.get("compression", "")}
    chunks = [child for child in data if local_name(child) == "chunk"]
    if chunks:
        layer["chunks"] = [_attributes(chunk) | {"data": _cells(chunk, layer["encoding"])} for chunk in chunks]
    else:
        layer["data"] = _cells(data, layer["encoding"])
    return layer


def _cells(element: Element, encoding: str) -> Any:
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
            data[kind] = [_place(pair) for pair in (child.get("points") or "").split()]
    return data


def _place(pair: str) -> dict[str, float]:
    x, comma, y = pair.partition(",")
    if not comma:
        raise Unreadable(f"points: {pair[:40]} is no pair of numbers")
    return {"x": _number(x, "points"), "y": _number(y, "points")}


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
