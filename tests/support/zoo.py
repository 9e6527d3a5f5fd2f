"""A level with one of everything, for tests of edits."""

import json

from sandbox.level.document.model import Level
from sandbox.level.reading.parse import parse_level

ZOO = {
    "format": "spring-sandbox/level",
    "version": 3,
    "name": "Zoo",
    "settings": {"solver": "single_pass"},
    "materials": {
        "steel": {"stiffness": 0.2, "damping": 0.3},
        "wire": {"law": "hooke", "k": 50.0},
        "unused": {},
    },
    "walls": {"box": [-40, -20, 40, 30], "friction": 0.2},
    "terrain": [
        {"id": "ground", "polygon": [[-20, -9], [20, -9], [20, -7], [3, -6], [-20, -7]], "friction": 0.8},
        {"id": "ramp", "polyline": [[22, -3], [25, -5], [30, -5]], "restitution": 0.5, "group": "crossing"},
    ],
    "bodies": [
        {"type": "rope", "id": "rope", "start": [0, 5], "end": [3, 5], "segments": 6, "rest_length": 0.6}
        | {"pin": ["start"], "pinned": [3], "cut": [4], "material": "steel", "velocity": [1, 0]},
        {"type": "bridge", "id": "deck", "start": [-5, 2], "end": [-1, 2.5], "segments": 4, "height": 0.5}
        | {"pin": ["start", "end"], "pinned": [7], "cut": [2], "group": "crossing"},
        {
            "type": "girder",
            "id": "beam",
            "start": [5, 1],
            "end": [8, 2],
            "segments": 3,
            "pin": ["start"],
            "pinned": [5],
        },
        {
            "type": "web",
            "id": "web",
            "collides": False,
            "position": [10, 5],
            "angle": 0.3,
            "radius": 2,
            "spokes": 5,
            "rings": 2,
        }
        | {"pin": ["rim"], "cut": [3]},
        {"type": "wheel", "id": "wheel", "position": [-8, 5], "radius": 1, "thickness": 0.25, "segments": 6}
        | {"pin": ["hub"], "pinned": [2], "hub_mass": 5, "gravity_scale": 0.5}
        | {"motor": {"speed": 3, "torque": 50, "key": "d", "reverse_key": "a"}},
        {"type": "jelly", "id": "cube", "shape": {"box": [1, 0.75]}, "position": [0, 9], "angle": 0.2, "spacing": 0.25}
        | {"pinned": [0], "cut": [5], "material": "wire"},
        {"type": "jelly", "id": "drop", "shape": {"polygon": [[0, 0], [1, 0], [0.2, 1]]}, "spacing": 0.2}
        | {"position": [4, 9], "pinned": [1], "velocity": [0, -2]},
        {"type": "jelly", "id": "ball", "shape": {"circle": 0.5}, "position": [7, 9], "spacing": 0.25}
        | {
            "drive": {"amplitude": 0.1, "period": 30, "phase": 0.25},
            "collision_group": "balls",
            "particle_radius": 0.1,
        },
        {"type": "ring", "id": "tyre", "position": [-12, 9], "radius": 1, "segments": 12, "inflation": 1.5}
        | {"particle_mass": 0.5, "pinned": [3], "bending": {"stiffness": 0.1}},
        {"type": "mesh", "id": "net", "particles": [[0, 0], [1, 0], [1, 1]], "masses": [1, 2, 3]}
        | {"velocities": [[0, 0], [0, 1], [1, 0]], "springs": [[0, 1], [1, 2]], "pose": [[0, 0], [1, 0.5], [1, 1.5]]},
    ],
    "particles": [
        {"id": "weight", "position": [3, 5], "mass": 20, "radius": 0.3, "group": "crossing"}
        | {"collides": ["balls"], "friction": 0.1},
        {"id": "hook", "position": [0, 7], "pinned": True},
        {"id": "hook 2", "position": [1, 7], "velocity": [1, 1]},
    ],
    "springs": [
        {"a": "hook", "b": "cube.2", "rest_length": 1.5, "material": "steel"},
        {"a": "weight", "b": "deck.end", "group": "crossing"},
        {"a": "net.1", "b": "beam.end", "hydraulic": {"shortest": 1, "longest": 9, "rate": 0.5, "key": "u"}},
        {"a": "hook", "b": "hook 2", "rest_length": 2.0, "drive": {"amplitude": 0.2, "period": 60}},
    ],
    "welds": [["rope.end", "weight"], ["beam.start", "deck.4"], ["web.centre", "hook 2"]],
    "checks": [
        {"name": "still", "metric": "speed", "particle": "rope.end", "at_most": 1.0},
        {"name": "tight", "metric": "max_strain", "at_most": 0.5},
    ],
}


def zoo() -> Level:
    """One of every body, with pins, cuts, a pose, groups, welds, springs and checks between them."""
    return parse_level(json.dumps(ZOO).encode(), "zoo")
