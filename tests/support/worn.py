"""A picture of four colours, and a level with a box that wears it."""

import io
import json
from pathlib import Path

from PIL import Image

RED, GREEN, BLUE, YELLOW = (200, 30, 30), (30, 160, 60), (40, 60, 210), (230, 210, 40)
NAME = "four.png"
HEAD = {"format": "spring-sandbox/level", "version": 4, "name": "worn"}


def four(size: tuple[int, int] = (64, 64), mode: str = "RGB", kind: str = "PNG") -> bytes:
    """A picture with red and green above, blue and yellow below."""
    made = Image.new("RGB", (2, 2))
    made.putdata([RED, GREEN, BLUE, YELLOW])
    made.resize(size, Image.Resampling.NEAREST).convert(mode).save(file := io.BytesIO(), kind)
    return file.getvalue()


def box(**fields: object) -> dict[str, object]:
    """A box that wears the picture."""
    made = {"type": "jelly", "id": "box", "shape": {"box": [4, 2]}, "spacing": 1.0, "look": {"picture": NAME}}
    return made | fields


def level_file(folder: Path, *bodies: dict[str, object], picture: bytes | None = None) -> Path:
    """The file of a level of these bodies without gravity, a picture beside it."""
    path = folder / "worn.json"
    path.write_text(json.dumps(HEAD | {"settings": {"gravity": [0, 0]}, "bodies": bodies or [box()]}))
    (folder / NAME).write_bytes(four() if picture is None else picture)
    return path
