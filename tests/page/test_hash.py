"""The page's hashes are those of Python."""

import hashlib
import json
import shutil
import subprocess

from sandbox.page.page import WEB
from tests.support.wants import skip_without

_SIZES = (0, 1, 127, 128, 129, 256, 1000)
_FLOATS = (0.0, -0.0, 1.0, -9.81, 0.1, 1e300, 1e-310)
_PROGRAM = """
import { blake2b, hexOf } from '%s';
const [sizes, floats] = JSON.parse(process.argv[1]);
const bytes = (size) => Uint8Array.from({ length: size }, (_, k) => 7 * k);
console.log(JSON.stringify([sizes.map((size) => blake2b(bytes(size), 16)), floats.map(hexOf)]));
"""


def test_hashes_and_the_digits_of_floats_are_those_of_python() -> None:
    node = shutil.which("node")
    if node is None:
        skip_without("node")
    program = _PROGRAM % (WEB / "hash.js").as_uri()
    arguments = [node, "--input-type=module", "--eval", program, json.dumps([_SIZES, _FLOATS])]
    said = json.loads(subprocess.run(arguments, capture_output=True, text=True, check=True).stdout)
    hashes = [hashlib.blake2b(bytes(7 * k % 256 for k in range(size)), digest_size=16).hexdigest() for size in _SIZES]
    assert said == [hashes, [(value + 0.0).hex() for value in _FLOATS]]
