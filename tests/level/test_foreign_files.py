"""Files of other programs given as levels are named for what they are; a byte order mark is no fault."""

import json

import pytest

from sandbox.level.reading.files import LevelError, parse_level
from tests.support.malformed_levels import GOOD, encoded

FOREIGN = [
    ("Tiled map (XML)", b'<?xml version="1.0"?>\n<!-- <svg> -->\n<map version="1.10" width="4"></map>'),
    ("Tiled map (JSON)", json.dumps({"type": "map", "layers": [], "tilewidth": 16}).encode()),
    ("R.U.B.E. scene", json.dumps({"gravity": {"x": 0, "y": -10}, "body": [], "joint": []}).encode()),
    ("Matter.js world", json.dumps({"id": 0, "type": "composite", "bodies": []}).encode()),
    ("SVG drawing", b'<svg xmlns="http://www.w3.org/2000/svg"/>'),
    ("XML file", b"<scene><body/></scene>"),
    ("Algodoo scene (.phz)", b"PK\x03\x04" + bytes(26) + b"scene.phn"),
    ("Algodoo scene (.phn)", b"Scene.addCircle { radius := 1 };"),
    ("gzip", b"\x1f\x8b\x08\x00abc"),
    ("PNG picture", b"\x89PNG\r\n\x1a\n" + bytes(20)),
]
MARK = b"\xef\xbb\xbf"
# A mark stands before text alone.
MARKED = [(kind, MARK + data) for kind, data in FOREIGN if data.startswith((b"<", b"{", b"Scene"))]


@pytest.mark.parametrize(("kind", "data"), FOREIGN + MARKED)
def test_a_file_of_another_program_is_named_in_one_line(kind, data):
    with pytest.raises(LevelError) as caught:
        parse_level(data, "x")
    (fault,) = caught.value.faults
    assert kind in fault and "not a Spring Sandbox level" in fault


def test_a_level_may_begin_with_a_byte_order_mark():
    assert parse_level(MARK + encoded(GOOD), "x") == parse_level(encoded(GOOD), "x")
