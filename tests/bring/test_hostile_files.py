"""Hostile files of other programs cost little and end in one clear line, never in an error of the program."""

import base64
import json
import random
import re
import struct
import zlib

import pytest

from sandbox.bring.bring import bring
from sandbox.level.format.level_error import LevelError
from tests.support.foreign_files import samples, tiled

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">'
NUMBER = re.compile(rb"-?\d+\.?\d*")
WORD = re.compile(rb"[A-Za-z]{3,}")
PART = re.compile(rb'"[^"]*"|\{[^{}]*\}|\[[^\[\]]*\]|<[^<>]*>')
VALUES = (b"1e999", b"-1e308", b"NaN", b"-1", b"0", b"9" * 20, b"1e-320", b"null", b"{}", b"[]", b'""', b"true",
          b"4294967295", b"0.5", b"1e6", b"1e9")  # fmt: skip


def _chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def picture(width, height, data, extra=b""):
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) + extra + _chunk(b"IDAT", data) + _chunk(b"IEND", b"")


def layer(size, data):
    return {"type": "tilelayer", "name": "walls", "width": size, "height": size, "encoding": "base64",
            "compression": "zlib", "data": data}  # fmt: skip


def crossing(count):
    rng = random.Random(1)
    return " ".join(f"{100 * rng.random():.2f} {100 * rng.random():.2f}" for _ in range(count))


ENTITIES = "".join(f'<!ENTITY a{k} "&a{k - 1};&a{k - 1};">' for k in range(1, 30))
COPIES = "".join(f'<g id="u{k}">' + f'<use href="#u{k - 1}"/>' * 10 + "</g>" for k in range(1, 12))
ZEROS = base64.b64encode(zlib.compress(bytes(50_000_000))).decode()
MILLION = base64.b64encode(zlib.compress(b"\1\0\0\0" * 1_000_000)).decode()
HOSTILE = {
    "entities.svg": (f'<!DOCTYPE l [<!ENTITY a0 "ha">{ENTITIES}]>{HEAD}<text>&a29;</text></svg>', "declares entities"),
    "outside.svg": (f'<!DOCTYPE s [<!ENTITY x SYSTEM "file:///x">]>{HEAD}<text>&x;</text></svg>', "declares entities"),
    "deep.svg": (HEAD + "<g>" * 50_000 + "</g>" * 50_000 + "</svg>", "more than 100 deep"),
    "elements.svg": (HEAD + "<a/>" * 100_001 + "</svg>", "more than 100,000 elements"),
    "copies.svg": (f'{HEAD}<defs><rect id="u0"/>{COPIES}</defs><use href="#u11"/></svg>', "copies among them"),
    "path.svg": (f'{HEAD}<path d="M0 0 {"L1 1 2 0 " * 120_000}"/></svg>', "characters of paths"),
    "points.svg": (f'{HEAD}<polygon points="{"1 1 2 0 " * 11_000}"/></svg>', "more than 20,000 points"),
    "crossing.svg": (f'{HEAD}<polygon points="{crossing(3_000)}"/></svg>', "too many sides that cross"),
    "style.svg": (f"{HEAD}<style>{'a' * 8_000_000}</style></svg>", "no outline"),
    "comments.svg": (f"{HEAD}<style>{'/*' * 4_000_000}</style></svg>", "no outline"),
    "commas.svg": (f"{HEAD}<style>{'a,' * 4_000_000}b{{}}</style></svg>", "a style rule of more than 10,000"),
    "paint.svg": (f'{HEAD}<g fill="{"url(#" * 9_000}">{"<rect/>" * 15_000}</g></svg>', "style is more than 10,000"),
    "stroke.svg": (f'{HEAD}<path d="M0 0L9 9" fill="none" stroke="red" stroke-width="9e999"/></svg>', "a stroke wider"),
    "pixels.png": (picture(60_000, 60_000, zlib.compress(bytes(1_000))), "PNG"),
    "data.png": (picture(4, 4, zlib.compress(bytes(50_000_000))), "transparent all over"),
    "text.png": (picture(4, 4, b"", _chunk(b"zTXt", b"a\0\0" + zlib.compress(bytes(50_000_000)))), "damaged PNG"),
    "cells.tmj": (tiled(layers=[layer(100_000, "AAAA")]), "more than 1,000,000"),
    "layers.tmj": (tiled(layers=[layer(1_000, MILLION)] * 50), "more than 1,000,000 tiles in all"),
    "empty.tmj": (tiled(layers=[{**layer(1_000, None), "data": None}] * 3_000), "more than 1,000,000 tiles in all"),
    "points.tmx": (
        '<map orientation="orthogonal" tilewidth="16" tileheight="16"><objectgroup name="solid"><object>'
        f'<polygon points="{"1,2 " * 1_000_000}"/></object></objectgroup></map>',
        "a shape of more than 40,000 points",
    ),
    "zeros.tmj": (tiled(layers=[layer(10, ZEROS)]), "not as long as its size"),
    "deep.tmj": ('{"type": "map", "layers": ' + "[" * 100_000 + "]" * 100_000 + "}", "32 deep"),
    "nothing.tmj": (tiled(layers=[]), "has no outline to bring in"),
    "skewed.tmj": (tiled(orientation="isometric"), "only orthogonal maps come in"),
    "many.json": (json.dumps({"gravity": 0, "body": [{}] * 2_001}), "more than 2,000"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_what_would_grow_without_bound_is_refused_in_a_line(name, tmp_path):
    data, said = HOSTILE[name]
    path = tmp_path / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    with pytest.raises(LevelError) as caught:
        bring(path)
    (fault,) = caught.value.faults
    assert said in fault and "\n" not in fault


def test_a_copy_of_itself_is_counted_and_not_followed(tmp_path):
    path = tmp_path / "a.svg"
    path.write_text(f'{HEAD}<g id="a"><use href="#a"/><rect width="9" height="9"/></g></svg>')
    found = bring(path)
    assert found.left_out == ["1 copy of itself"] and len(found.level.bodies) == 1


def mutated(data, rng):
    """A file with a few bytes, numbers, words or parts of it changed."""
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 4))):
        kind = rng.choice(("byte", "cut", "twice", "number", "number", "number", "word", "part", "part"))
        at = rng.randrange(len(changed))
        if kind == "byte":
            changed[at] = rng.randrange(256)
        elif kind == "cut" and len(changed) > 50:
            del changed[at : at + rng.randrange(1, 40)]
        elif kind == "twice":
            changed[at:at] = changed[at : at + rng.randrange(1, 200)]
        else:
            found = list({"number": NUMBER, "word": WORD, "part": PART}.get(kind, WORD).finditer(bytes(changed)))
            if found:
                one, other = rng.choice(found), rng.choice(found)
                changed[one.start() : one.end()] = rng.choice(VALUES) if kind == "number" else other.group()
    return bytes(changed)


@pytest.mark.parametrize("name", samples())
def test_a_damaged_file_comes_in_or_is_refused_in_a_line(name, tmp_path):
    rng, data, outcomes = random.Random(name), samples()[name], set()
    path = tmp_path / name
    for _ in range(40):
        path.write_bytes(mutated(data, rng))
        try:
            bring(path, rng.choice((None, "jelly", "ground")), rng.choice((None, 1.0, 300.0)))
            outcomes.add("came in")
        except LevelError as error:
            assert len(error.faults) >= 1 and all("\n" not in fault for fault in error.faults)
            outcomes.add("refused")
    assert "refused" in outcomes
