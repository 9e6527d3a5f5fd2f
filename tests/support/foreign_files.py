"""Small files of other programs, sound ones: a drawing, a picture, maps and a scene, as bytes."""

import base64
import io
import json
import struct
import zlib

from PIL import Image, ImageDraw

SVG = b"""<?xml version="1.0"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 200 100">
<style>.blue{fill:#2040C0} .line{fill:none;stroke:#333;stroke-width:12}</style>
<defs><linearGradient id="g"><stop offset="0" stop-color="#FF8800"/></linearGradient>
<rect id="brick" width="20" height="10" fill="url(#g)"/></defs>
<g transform="translate(50,50) scale(0.5)"><path class="blue" fill-rule="evenodd"
 d="M-60-60H60V60H-60Z M-20-20 C-20-40 20-40 20-20 A20 20 0 0 1 20 20 Q0 40 -20 20 z"/></g>
<use xlink:href="#brick" x="150" y="30"/><polyline class="line" points="110,90 150,70 190,90"/>
<text x="5" y="5">one</text><text>two</text><circle cx="120" cy="20" r="10" style="display:none"/>
</svg>"""


def png():
    """A red ring of 300 pixels beside a green box."""
    picture = Image.new("RGBA", (600, 320))
    draw = ImageDraw.Draw(picture)
    draw.ellipse((10, 10, 310, 310), fill=(200, 40, 40, 255))
    draw.ellipse((110, 110, 210, 210), fill=(0, 0, 0, 0))
    draw.rectangle((400, 100, 580, 300), fill=(40, 180, 80, 255))
    held = io.BytesIO()
    picture.save(held, "PNG")
    return held.getvalue()


CELLS = [0, 0, 0, 0, 0, 0, 1, 0, 0, 2, 1, 1, 1, 1, 1]


def packed(cells):
    return base64.b64encode(zlib.compress(struct.pack(f"<{len(cells)}I", *cells))).decode()


TILE_SET = {
    "firstgid": 1, "tilewidth": 16, "tileheight": 16,
    "tiles": [{"id": 1, "objectgroup": {"objects": [
        {"id": 1, "x": 0, "y": 0, "polygon": [{"x": 0, "y": 16}, {"x": 16, "y": 0}, {"x": 16, "y": 16}]}]}}],
}  # fmt: skip


def tiled(**changes):
    """A map of 5 x 3 tiles: a floor, a block, a slope whose shape is its tile's, and objects."""
    data = {
        "type": "map", "orientation": "orthogonal", "width": 5, "height": 3, "tilewidth": 16, "tileheight": 16,
        "tilesets": [TILE_SET],
        "layers": [
            {"type": "tilelayer", "name": "ground", "width": 5, "height": 3, "data": CELLS},
            {"type": "objectgroup", "name": "collision", "objects": [
                {"id": 1, "name": "ball", "x": 0, "y": 0, "width": 8, "height": 8, "ellipse": True},
                {"id": 2, "name": "wire", "x": 20, "y": 4, "polyline": [{"x": 0, "y": 0}, {"x": 30, "y": 4}]},
                {"id": 3, "name": "spawn", "x": 3, "y": 3, "point": True}]},
            {"type": "imagelayer", "name": "sky"},
        ],
    }  # fmt: skip
    return json.dumps(data | changes).encode()


TMX = f"""<?xml version="1.0"?>
<map version="1.10" orientation="orthogonal" width="5" height="3" tilewidth="16" tileheight="16" infinite="0">
<tileset firstgid="1" name="t" tilewidth="16" tileheight="16"><tile id="1"><objectgroup>
<object id="1" x="0" y="0"><polygon points="0,16 16,0 16,16"/></object></objectgroup></tile></tileset>
<layer id="1" name="ground" width="5" height="3"><data encoding="base64" compression="zlib">
{packed(CELLS)}</data></layer>
<objectgroup id="2" name="collision"><object id="1" name="ball" x="0" y="0" width="8" height="8"><ellipse/></object>
<object id="2" name="wire" x="20" y="4"><polyline points="0,0 30,4"/></object>
<object id="3" name="spawn" x="3" y="3"><point/></object></objectgroup>
<imagelayer id="3" name="sky"/></map>""".encode()


def _box(x, y):
    return {"density": 1.0, "friction": 0.4, "polygon": {"vertices": {"x": [-x, x, x, -x], "y": [-y, -y, y, y]}}}


def rube(**changes):
    """A pendulum of two bars that hangs from the ground, a disc, a weld of two boxes, a joint without counterpart."""
    bodies = [
        {"name": "ground", "type": 0, "position": {"x": 0, "y": -1}, "fixture": [_box(6, 0.5)]},
        {"name": "upper", "type": 2, "position": {"x": 0, "y": 4}, "fixture": [_box(0.15, 0.6)]},
        {"name": "lower", "type": 2, "position": {"x": 0, "y": 3}, "fixture": [_box(0.15, 0.6)]},
        {"name": "disc", "type": 2, "position": {"x": 3, "y": 1}, "linearVelocity": {"x": -1, "y": 0},
         "fixture": [{"density": 2.0, "circle": {"center": 0, "radius": 0.5}}]},
        {"name": "left", "type": 2, "position": {"x": -3, "y": 1}, "fixture": [_box(0.5, 0.5)]},
        {"name": "right", "type": 2, "position": {"x": -2, "y": 1}, "fixture": [_box(0.5, 0.5)]},
    ]  # fmt: skip
    joints = [
        {"type": "revolute", "bodyA": 0, "bodyB": 1, "anchorA": {"x": 0, "y": 5.5}, "anchorB": {"x": 0, "y": 0.5}},
        {"type": "revolute", "bodyA": 1, "bodyB": 2, "anchorA": {"x": 0, "y": -0.5}, "anchorB": {"x": 0, "y": 0.5},
         "enableMotor": True},
        {"type": "weld", "bodyA": 4, "bodyB": 5, "anchorA": {"x": 0.5, "y": 0}, "anchorB": {"x": -0.5, "y": 0}},
        {"type": "prismatic", "bodyA": 3, "bodyB": 0, "anchorA": 0, "anchorB": 0},
    ]  # fmt: skip
    return json.dumps({"gravity": {"x": 0, "y": -10}, "body": bodies, "joint": joints} | changes).encode()


def samples():
    """Every kind of file, by the name of a file of it."""
    return {"a.svg": SVG, "a.png": png(), "a.tmj": tiled(), "a.tmx": TMX, "a.json": rube()}
