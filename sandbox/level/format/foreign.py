"""Recognises files of other programs by their first bytes or by their keys."""

import re
from typing import Any

# What Git LFS leaves in place of a file that was not fetched.
LFS_POINTER = b"version https://git-lfs.github.com/spec/"
SVG, PNG, RUBE = "an SVG drawing", "a PNG picture", "an R.U.B.E. scene (JSON)"
TILED, TILED_XML = "a Tiled map (JSON)", "a Tiled map (XML)"
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
_ROOTS = {"map": TILED_XML, "tileset": "a Tiled tile set (XML)", "svg": SVG}
_ROOT = re.compile(rb"<(?:[A-Za-z_][\w.-]*:)?([A-Za-z_][\w.-]*)[\s/>]")
_MAYBE_XML = re.compile(rb"<(?:[?!]|[A-Za-z_])")
# Where the first element of an XML file is looked for: after its declaration and comments.
_HEAD = 4096  # [bytes]


def foreign_fault(kind: str) -> str:
    """What is said of a file of another program in place of a level, and what can be done."""
    remedy = "; `sandbox bring` makes a level of it, and so does dropping it on the window" if kind in BROUGHT else ""
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
    if {"body", "gravity"} <= raw.keys() and isinstance(raw["body"], list):
        return RUBE
    if raw.get("type") in ("composite", "engine") or {"world", "timing"} <= raw.keys():
        return "a Matter.js world (JSON)"
    return None
