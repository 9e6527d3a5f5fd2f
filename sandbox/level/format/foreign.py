"""Looks at bytes before any parser: files of other programs, too much depth, too many lists and objects."""

import re
from typing import Any

import numpy as np

from sandbox.level.format.level_error import Fault
from sandbox.level.format.limits import CONTAINER_LIMIT, DEPTH_LIMIT

# What Git LFS leaves in place of a file that was not fetched.
LFS_POINTER = b"version https://git-lfs.github.com/spec/"
# How the lines begin that git puts into a text where two edits of it meet.
CONFLICT = re.compile(rb"^(?:<{7}|>{7}) ", re.MULTILINE)
# What the first line of a scene calls itself.
SCENE_FORMAT = "spring-sandbox/scene"
SCENE = "a scene, a run as it stood"
SVG, PNG, RUBE = "an SVG drawing", "a PNG picture", "an R.U.B.E. scene (JSON)"
TILED, TILED_XML = "a Tiled map (JSON)", "a Tiled map (XML)"
TILE_SET = "a Tiled tile set, and no map"
# What `sandbox bring` makes levels of.
BROUGHT = (SVG, PNG, TILED, TILED_XML, RUBE)
_STARTS = (
    (LFS_POINTER, "a Git LFS pointer (git lfs pull fetches the file)"),
    (b"\x1f\x8b", "compressed by gzip"),
    (b"\x89PNG\r\n", PNG),
    (b"GIF8", "a GIF picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"%PDF", "a PDF document"),
)
_ROOTS = {"map": TILED_XML, "tileset": TILE_SET, "svg": SVG}
_ROOT = re.compile(rb"<(?:[A-Za-z_][\w.-]*:)?([A-Za-z_][\w.-]*)[\s/>]")
_MAYBE_XML = re.compile(rb"<(?:[?!]|[A-Za-z_])")
# Where the first element of an XML file is looked for: after its declaration and comments.
_HEAD = 4096  # [bytes]


def foreign_fault(kind: str) -> str:
    """The message about a file of another program in place of a level, and what can be done."""
    remedy = "; `sandbox bring` makes a level of it, and so does dropping it on the window" if kind in BROUGHT else ""
    if kind == SCENE:
        remedy = "; `sandbox play` opens it"
    return f"is {kind}, not a Spring Sandbox level{remedy}"


def foreign_bytes(data: bytes) -> str | None:
    """The kind of a file by its first bytes, in words; None if unknown."""
    for start, kind in _STARTS:
        if data.startswith(start):
            return kind
    if data.startswith(b"PK\x03\x04"):
        is_scene = b".phn" in data[:_HEAD]
        return "an Algodoo scene (.phz)" if is_scene else "a zip archive, as Algodoo's .phz is"
    head = data[:_HEAD].lstrip()
    if SCENE_FORMAT.encode() in head[:64]:
        return SCENE
    if _MAYBE_XML.match(head):
        root = _ROOT.search(re.sub(rb"<!--.*?-->", b"", head, flags=re.DOTALL))
        return _ROOTS.get(root[1].decode(), "an XML file") if root else "an XML file"
    if b"Scene.add" in head or head.startswith((b"FileInfo", b"// FileVersion")):
        return "an Algodoo scene (.phn)"
    return None


def foreign_keys(raw: dict[str, Any]) -> str | None:
    """The kind of an object without a "format" by its keys, in words; None if unknown."""
    if "json-schema.org" in str(raw.get("$schema")):
        return "a JSON Schema"
    if raw.get("type") == "map" or {"layers", "tilewidth"} <= raw.keys():
        return TILED
    if raw.get("type") == "tileset" or {"tilewidth", "imagewidth"} <= raw.keys():
        return TILE_SET
    if {"body", "gravity"} <= raw.keys() and isinstance(raw["body"], list):
        return RUBE
    if raw.get("type") in ("composite", "engine") or {"world", "timing"} <= raw.keys():
        return "a Matter.js world (JSON)"
    return None


def scan(data: bytes) -> Fault | None:
    """The fault of a text that nests too deep or has too many lists and objects, or None. Takes linear time."""
    # Escapes go first, so that every quotation mark left opens or closes a string.
    if b"\\" in data:
        data = data.replace(b"\\\\", b"__").replace(b'\\"', b"__")
    text = np.frombuffer(data, dtype=np.uint8)
    outside = ~np.logical_xor.accumulate(text == ord('"'))
    opening = np.flatnonzero(((text == ord("[")) | (text == ord("{"))) & outside)
    closing = np.flatnonzero(((text == ord("]")) | (text == ord("}"))) & outside)
    if len(opening) > CONTAINER_LIMIT:
        return "", f"holds more than {CONTAINER_LIMIT:,} lists and objects; make it smaller"
    # Depth at each opening bracket: those opened up to it less those closed before it.
    depth = np.arange(1, len(opening) + 1) - np.searchsorted(closing, opening)
    too_deep = np.flatnonzero(depth > DEPTH_LIMIT)
    if not len(too_deep):
        return None
    line = data.count(b"\n", 0, int(opening[too_deep[0]])) + 1
    return f"line {line}", f"lists and objects are nested more than {DEPTH_LIMIT} deep; make it flatter"
