"""What a page holds, read back."""

import gzip
import json
import re
import struct
from typing import Any

from sandbox.page.page import DIGITS


def unpacked(page: str, name: str) -> bytes:
    """The content of the script of a page with that id."""
    found = re.search(rf'<script id="{name}" type="text/plain">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    digits = [DIGITS.index(digit) for digit in found[1]]
    numbers = [
        sum(digit * 85**power for digit, power in zip(digits[k : k + 5], (4, 3, 2, 1, 0), strict=True))
        for k in range(0, len(digits) - 1, 5)
    ]
    content = struct.pack(f">{len(numbers)}I", *numbers)
    return gzip.decompress(content[: len(content) - digits[-1]])


def data_of(page: str) -> dict[str, Any]:
    """What a page knows of its level."""
    content = unpacked(page, "toy")
    (length,) = struct.unpack_from("<I", content)
    data: dict[str, Any] = json.loads(content[4 : 4 + length])
    return data
