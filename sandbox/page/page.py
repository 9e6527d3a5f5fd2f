"""The page that plays: an HTML file with a level, its world and the kernels in it, or with their addresses."""

import gzip
import html
import json
import re
import string
import struct
from collections.abc import Mapping
from typing import Any

from sandbox.export.policy import policy
from sandbox.level.hints import worded
from sandbox.page.bundle import BUNDLE, WEB
from sandbox.page.start import Image
from sandbox.physics.jit.library import FOLDER

KERNELS = FOLDER / "kernels.wasm"
MODULES = tuple(sorted(path.stem for path in WEB.glob("*.js")))
GZIP_LEVEL = 9
# Sources in policies: that lets kernels be compiled, and that of the icon; without one a browser asks a server for it.
COMPILING, ICON = "'wasm-unsafe-eval'", "data:"
# The digits of the numbers that content is written in: none has a meaning in HTML or JavaScript.
DIGITS = string.digits + string.ascii_letters + "!#$%()*+,-./:;=?@[]^_{|"
_POWERS = (85**4, 85**3, 85**2, 85, 1)

_PLACE = re.compile("@([A-Z]+)@")


def toy_content(level: Mapping[str, Any], image: Image) -> bytes:
    """The data of a page: the length of JSON, the level for its script as JSON, and the image of its world."""
    data = json.dumps(level, separators=(",", ":"), allow_nan=False).encode()
    return struct.pack("<I", len(data)) + data + image.content


def toy_file(content: bytes) -> bytes:
    """The file of a toy's content, compressed."""
    return gzip.compress(content, GZIP_LEVEL, mtime=0)


def page_text(title: str, hints: str, content: bytes) -> str:
    """The page of a toy that needs no other file. hints: what there is to do, as the level says it."""
    whole = BUNDLE.read_text(encoding="utf-8")
    held = {
        "TOY": packed(content),
        "KERNELS": packed(KERNELS.read_bytes()),
        "SCRIPT": packed(whole.encode()),
        "DIGITS": DIGITS,
    }
    # The page makes a script of what it has unpacked.
    return _page(title, hints, filled("packed", **held), f"<script>{whole}</script>", script=COMPILING)


def linked_page_text(
    title: str, hints: str, toy: str, bundle: str, home: str, shown: str = "", following: tuple[str, str] | None = None
) -> str:
    """The page of a toy whose files lie beside it. toy, bundle, home: quoted addresses of file, script and list.

    shown: elements of its head for who shows a link to it; following: the quoted address and the title of the page that
    comes after it is won; None: none.
    """
    around = {"HOME": f'<a href="{home}">All levels</a>', "SHOWN": shown}
    if following is not None:
        around["NEXT"] = f'<a href="{following[0]}">Next: {html.escape(following[1])}</a>'
    parts = filled("linked", TOY=toy, BUNDLE=bundle)
    return _page(title, hints, parts, around=around, script=f"'self' {COMPILING}", connect="'self'")


def _page(
    title: str, hints: str, parts: str, made: str = "", around: Mapping[str, str] | None = None, **sources: str
) -> str:
    """A page of these parts, which may run them and what it makes of them, and has these sources; around: elements by
    the places of the template where they stand."""
    held_to = policy(_template("page"), parts, made, img=ICON, **sources)
    fields = {"TITLE": html.escape(title), "HINTS": hint_markup(hints), "PARTS": parts, "POLICY": held_to}
    fields["ABOUT"] = html.escape(worded(hints, "mouse"))
    return filled("page", **{"HOME": "", "SHOWN": "", "NEXT": ""} | fields | dict(around or {}))


def hint_markup(text: str) -> str:
    """A hint as HTML: where its words differ, style sheets show those for a mouse or those for fingers alone."""
    mouse, finger = (html.escape(worded(text, place)) for place in ("mouse", "finger"))
    return mouse if mouse == finger else f"<span class=mouse>{mouse}</span><span class=finger>{finger}</span>"


def filled(template: str, **parts: str) -> str:
    """A template of the folder `web` with these parts in place of their names."""
    return _PLACE.sub(lambda found: parts[found[1]], _template(template))


def _template(name: str) -> str:
    return (WEB / f"{name}.html").read_text(encoding="utf-8")


def packed(content: bytes) -> str:
    """Compressed, each four bytes as five of DIGITS: a quarter longer than they are, where base64 is a third."""
    made = gzip.compress(content, GZIP_LEVEL, mtime=0)
    numbers = struct.unpack(f">{-(-len(made) // 4)}I", made.ljust(-(-len(made) // 4) * 4, b"\0"))
    return "".join(DIGITS[number // power % 85] for number in numbers for power in _POWERS) + DIGITS[-len(made) % 4]
