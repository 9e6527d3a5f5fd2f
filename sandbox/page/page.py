"""The page that plays: one HTML file with a level, its world and the kernels, which needs no network."""

import gzip
import html
import json
import re
import string
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sandbox.page.image import Image
from sandbox.physics.jit.library import FOLDER

HERE = Path(__file__).with_name("web")
# In an order in which each is behind what it imports from.
MODULES = ("hash", "world", "run", "recording", "paint", "things", "draw", "hand", "panel", "sound", "main")
GZIP_LEVEL = 9
# The digits of the numbers that content is written in: none has a meaning in HTML or JavaScript.
DIGITS = string.digits + string.ascii_letters + "!#$%()*+,-./:;=?@[]^_{|"
_POWERS = (85**4, 85**3, 85**2, 85, 1)

_IMPORT = re.compile(r"^import (\{.*?\}) from '\./(\w+)\.js';$", re.MULTILINE | re.DOTALL)
_COMMENT, _INDENT = re.compile(r"^\s*//.*\n", re.MULTILINE), re.compile(r"^\s+", re.MULTILINE)
_EXPORT = re.compile(r"^export ((?:async )?(?:function\*? |class |const ))(\w+)", re.MULTILINE)


def page_text(title: str, level: Mapping[str, Any], image: Image) -> str:
    """The page of a level; level: what its scripts read of it, image: its world."""
    data = json.dumps(level, separators=(",", ":"), allow_nan=False).encode()
    parts = {
        "TITLE": html.escape(title),
        "DATA": packed(data),
        "IMAGE": packed(image.content),
        "KERNELS": packed((FOLDER / "kernels.wasm").read_bytes()),
        "SCRIPT": packed(script().encode()),
        "DIGITS": DIGITS,
    }
    template = (HERE / "page.html").read_text(encoding="utf-8")
    return re.sub("@([A-Z]+)@", lambda found: parts[found[1]], template)


def script() -> str:
    """All modules as one script, without comments and indents: each is a function, which gives what it exports."""
    whole = "\n".join(_as_function(name, (HERE / f"{name}.js").read_text(encoding="utf-8")) for name in MODULES)
    return _INDENT.sub("", _COMMENT.sub("", whole))


def _as_function(name: str, text: str) -> str:
    exported = ", ".join(found[2] for found in _EXPORT.finditer(text))
    body = _EXPORT.sub(r"\1\2", _IMPORT.sub(r"const \1 = from_\2;", text))
    return f"const from_{name} = (() => {{\n{body}return {{ {exported} }};\n}})();\n"


def packed(content: bytes) -> str:
    """Compressed, each four bytes as five of DIGITS: a quarter longer than they are, where base64 is a third."""
    made = gzip.compress(content, GZIP_LEVEL, mtime=0)
    numbers = struct.unpack(f">{-(-len(made) // 4)}I", made.ljust(-(-len(made) // 4) * 4, b"\0"))
    return "".join(DIGITS[number // power % 85] for number in numbers for power in _POWERS) + DIGITS[-len(made) % 4]
