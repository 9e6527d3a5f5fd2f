"""Small levels for the session tests."""

import json
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.reading.files import parse_level


def rope_level(**changes: Any) -> Level:
    """A rope of 11 links, pinned at its start, with two materials' worth of bodies; it resists bending."""
    data = {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Test rope",
        "settings": {"solver": "iterative"},
        "materials": {"steel": {"stiffness": 0.8, "damping": 0.9}, "rubber": {"stiffness": 0.05, "damping": 0.1}},
        "bodies": [
            {"type": "rope", "id": "rope", "start": [0, 0], "end": [5.5, 0], "segments": 11, "pin": ["start"],
             "material": "steel", "bending": {"stiffness": 0.1, "damping": 0.1}},
            {"type": "rope", "id": "soft", "start": [0, 3], "end": [2, 3], "segments": 4, "pin": ["start"],
             "material": "rubber"},
        ],
        **changes,
    }  # fmt: skip
    return parse_level(json.dumps(data).encode(), "test")
