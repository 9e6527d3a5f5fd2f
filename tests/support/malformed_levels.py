"""Malformed levels, by mutation of a good one and by hand: each must be refused, in clear lines and cheaply."""

import copy
import json
from collections.abc import Iterator
from typing import Any

GOOD: dict[str, Any] = {
    "format": "spring-sandbox/level",
    "version": 4,
    "name": "Good",
    "description": "Every kind of thing once.",
    "tags": ["demo"],
    "settings": {"gravity": [0.0, -9.81], "tick_rate": 60, "substeps": 2, "solver": "iterative", "iterations": 10},
    "view": [-12.0, -1.0, 12.0, 12.0],
    "materials": {"steel": {"stiffness": 1.0, "damping": 1.0}, "classic": {"law": "hooke", "k": 500.0, "c": 2.0}},
    "bodies": [
        {
            "type": "rope",
            "id": "rope",
            "start": [0, 5],
            "end": [3, 5],
            "segments": 30,
            "end_mass": 10.0,
            "pin": ["start"],
        },
        {
            "type": "bridge",
            "id": "deck",
            "start": [-5, 2],
            "end": [5, 2],
            "segments": 40,
            "height": 0.5,
            "pin": ["end"],
        },
        {"type": "jelly", "id": "cube", "shape": {"box": [2.0, 2.0]}, "position": [0, 6], "spacing": 0.25},
        {
            "type": "jelly",
            "id": "wheel",
            "shape": {"circle": 1.0},
            "spacing": 0.25,
            "angle": 1.0,
            "firmness": {"hz": 0.3, "ratio": 1.0},
        },
        {"type": "jelly", "id": "kite", "shape": {"polygon": [[0, 0], [2, 0], [0, 2]]}, "spacing": 0.5},
        {
            "type": "mesh",
            "id": "net",
            "particles": [[0, 0], [1, 0]],
            "masses": [1.0, 2.0],
            "velocities": [[0, 0], [0, 1]],
            "pinned": [0],
            "springs": [[0, 1]],
            "material": "steel",
        },
        {
            "type": "girder",
            "id": "crane",
            "start": [0.5, 0],
            "end": [0.5, 4],
            "segments": 4,
            "height": 0.5,
            "pin": ["start"],
            "pinned": [1, 8],
            "cut": [0, 14],
            "group": "yard",
        },
        {"type": "web", "id": "net 2", "radius": 2.0, "spokes": 6, "rings": 2, "pin": ["rim"], "angle": 0.5},
        {
            "type": "wheel",
            "id": "cart",
            "position": [4, 1],
            "radius": 1.0,
            "thickness": 0.25,
            "segments": 3,
            "hub_mass": 5.0,
            "pose": [[4, 1], [5, 1], [4, 2], [3, 1], [6, 1], [4, 3], [2, 1]],
        },
    ],
    "zones": [
        {"id": "pool", "box": [-9, -3, 9, -1], "water": {"density": 5.0, "flow": [0.5, 0.0]}},
        {"id": "goal", "circle": [8, 8, 1.5]},
        {"id": "gate", "polygon": [[7, 0], [8, 0], [8, 1]]},
    ],
    "particles": [{"id": "ball", "position": [0, 3], "mass": 100.0, "radius": 0.3, "pinned": False}],
    "springs": [{"a": "ball", "b": "deck.20", "rest_length": 0.5, "material": "steel", "group": "yard"}],
    "welds": [["cube.3", "kite.0"], ["net 2.centre", "cube.3"]],
    "checks": [{"name": "holds", "metric": "y", "particle": "ball", "after": 1.0, "at_least": -100.0}],
    "extras": {"editor": {"grid": 0.5}},
}

# Places of the good level, and the values that none of them may hold.
NUMBERS = [
    "settings.gravity.0",
    "settings.warm_start",
    "materials.steel.stiffness",
    "materials.classic.k",
    "bodies.0.start.1",
    "bodies.0.end_mass",
    "bodies.1.height",
    "bodies.2.shape.box.0",
    "bodies.2.spacing",
    "bodies.3.shape.circle",
    "bodies.3.angle",
    "bodies.3.firmness.hz",
    "bodies.3.firmness.ratio",
    "bodies.4.shape.polygon.1.0",
    "bodies.5.masses.1",
    "bodies.5.velocities.1.0",
    "bodies.6.height",
    "bodies.7.radius",
    "bodies.8.thickness",
    "bodies.8.hub_mass",
    "bodies.8.pose.2.1",
    "zones.0.box.2",
    "zones.0.water.density",
    "zones.0.water.flow.1",
    "zones.1.circle.2",
    "zones.2.polygon.1.0",
    "particles.0.mass",
    "particles.0.radius",
    "springs.0.rest_length",
    "checks.0.after",
    "view.2",
]
NO_NUMBERS = [True, "1", [], {}, float("nan"), float("inf"), float("-inf"), 10**400]
WHOLE = ["settings.tick_rate", "settings.substeps", "settings.iterations", "bodies.0.segments", "bodies.5.pinned.0"]
WHOLE += ["bodies.6.segments", "bodies.6.pinned.1", "bodies.6.cut.1", "bodies.7.spokes", "bodies.7.rings"]
NO_WHOLE = [1.0, True, "1", None, -1, 10**30]
TEXTS = ["name", "bodies.0.id", "bodies.0.material", "springs.0.a", "tags.0", "settings.solver", "checks.0.metric"]
TEXTS += ["welds.1.0", "bodies.7.pin.0"]
NO_TEXTS = [1, None, True, ["x"], "x" * 257, "\x00", "\x1b[31m"]
LISTS = ["bodies", "particles", "springs", "checks", "tags", "settings.gravity", "bodies.0.pin", "bodies.5.springs"]
LISTS += ["zones", "zones.0.box", "zones.2.polygon", "welds", "welds.0", "bodies.6.cut", "bodies.7.pinned"]
OBJECTS = ["settings", "materials", "materials.steel", "bodies.0", "bodies.2.shape", "springs.0", "zones.0", "extras"]
REQUIRED = [
    "format",
    "version",
    "name",
    "bodies.0.type",
    "bodies.0.id",
    "bodies.0.start",
    "bodies.1.end",
    "bodies.1.segments",
    "bodies.2.shape",
    "bodies.3.spacing",
    "bodies.5.particles",
    "bodies.6.segments",
    "bodies.7.spokes",
    "bodies.7.rings",
    "bodies.8.radius",
    "bodies.8.thickness",
    "particles.0.id",
    "welds.0.1",
    "springs.0.a",
    "springs.0.b",
    "checks.0.metric",
    "checks.0.name",
    "settings.gravity.1",
]
KITE: dict[str, Any] = {"type": "jelly", "id": "kite", "shape": {"polygon": [[0, 0], [2, 0], [0, 2]]}}
FITTED = KITE | {"mesh": "fitted", "spacing": 0.25}
OUTSIDE = [
    ("version", 5),
    ("version", 0),
    ("format", "tiled/map"),
    ("name", ""),
    ("settings.gravity", [0.0, -1.1e6]),
    ("settings.gravity", [1.0, 2.0, 3.0]),
    ("settings.tick_rate", 0),
    ("settings.tick_rate", 10_001),
    ("settings.substeps", 3),
    ("settings.substeps", 128),
    ("settings.substeps", "Auto"),
    ("settings.solver", "magic"),
    ("settings.iterations", 0),
    ("settings.iterations", 1_001),
    ("settings.warm_start", 1.1),
    ("settings.warm_start", -0.1),
    ("view", [1.0, 0.0, -1.0, 2.0]),
    ("view", [0.0, 0.0, 1.0]),
    ("materials.steel.stiffness", 1.3),
    ("materials.steel.stiffness", -0.1),
    ("materials.steel.damping", 1.0000001),
    ("materials.steel.stifness", 0.5),
    ("materials.steel.law", "rubber"),
    ("materials.classic.k", -1.0),
    ("materials.classic.stiffness", 0.5),
    ("bodies.0.type", "chain"),
    ("bodies.0.type", ["rope"]),
    ("bodies.0.id", ""),
    ("bodies.0.id", "a.b"),
    ("bodies.0.id", "a:b"),
    ("bodies.0.id", "a,b"),
    ("bodies.0.id", "+a"),
    ("bodies.0.id", "deck"),
    ("bodies.0.id", "ball"),
    ("bodies.0.start", [0.0]),
    ("bodies.0.start", [1e6 + 1, 0.0]),
    ("bodies.0.segments", 0),
    ("bodies.0.segments", 100_000),
    ("bodies.0.segments", 10**12),
    ("bodies.0.particle_mass", 0.0),
    ("bodies.0.particle_mass", -1.0),
    ("bodies.0.end_mass", 2e9),
    ("bodies.0.rest_length", -0.1),
    ("bodies.0.pin", ["middle"]),
    ("bodies.0.material", "rubber"),
    ("bodies.0.velocity", [2e9, 0.0]),
    ("bodies.0.colour", "red"),
    ("bodies.0.shape", {"box": [1.0, 1.0]}),
    ("bodies.1.segments", 10**12),
    ("bodies.1.height", 0.0),
    ("bodies.1.height", 1.1e6),
    ("bodies.1.start", [0.0, -1e6]),
    ("bodies.2.shape", {"box": [1e6, 1e6], "circle": 1.0}),
    ("bodies.2.shape", {"box": [0.0, 1.0]}),
    ("bodies.2.shape", {"star": 5}),
    ("bodies.2.shape.box", [1e6, 1e6]),
    ("bodies.2.spacing", 0.0),
    ("bodies.2.spacing", 1e-6),
    ("bodies.2.spacing", 5e-324),
    ("bodies.2.position", [999_999.5, 0.0]),
    ("bodies.3.shape.circle", 0.0),
    ("bodies.3.shape.circle", 1e6),
    ("bodies.4.shape.polygon", [[0, 0], [1, 0]]),
    ("bodies.4.shape.polygon", [[0, 0], [1, 1], [1, 0], [0, 1]]),
    ("bodies.4.shape.polygon", [[0, 0], [1, 0], [2, 0]]),
    ("bodies.4.shape.polygon", [[0, 0], [1, 0], [1, 0], [0, 1]]),
    ("bodies.4.shape.polygon", [[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]]),
    ("bodies.4.shape.polygon", [[0.1, 0.1], [0.2, 0.1], [0.1, 0.2]]),
    ("bodies.4.shape.polygon", [[0, 0], [1e6, 0], [1e6, 1e6]]),
    ("bodies.4.mesh", "triangles"),
    ("bodies.4.mesh", None),
    ("bodies.4.holes", [[[0.2, 0.2], [0.6, 0.2], [0.2, 0.6]]]),
    ("bodies.4.holes", [[[0, 0], [1, 0]]]),
    ("bodies.4.holes", [[0, 0], [1, 0], [0, 1]]),
    ("bodies.4", {"spacing": 10.0, "mesh": "fitted"} | KITE),
    ("bodies.4", {"spacing": 1e-6, "mesh": "fitted"} | KITE),
    ("bodies.4", {"holes": [[[0.1, 0.1], [0.5, 0.5], [0.5, 0.1], [0.1, 0.5]]]} | FITTED),
    ("bodies.4", {"holes": [[[1, 1], [3, 1], [1, 3]]]} | FITTED),
    ("bodies.4", {"holes": [[[0.2, 0.2], [0.6, 0.2], [0.2, 0.6]]] * 2} | FITTED),
    ("bodies.4", {"angle": 1.0} | FITTED | {"shape": {"polygon": [[0, 0], [1, 1], [1, 0], [0, 1]]}}),
    ("bodies.4", {"pinned": [1_000]} | FITTED),
    ("bodies.5.particles", []),
    ("bodies.5.masses", [1.0]),
    ("bodies.5.masses", [1.0, 0.0]),
    ("bodies.5.masses", [1.0, 1e-10]),
    ("bodies.5.velocities", [[0, 0]]),
    ("bodies.5.velocities", [[0, 0], [0, 1.1e9]]),
    ("bodies.5.pinned", [2]),
    ("bodies.5.pinned", [-1]),
    ("bodies.5.springs", [[0, 2]]),
    ("bodies.5.springs", [[1, 1]]),
    ("bodies.5.springs", [[0]]),
    ("bodies.5.springs", [[0, 1, 1]]),
    ("bodies.5.springs", [[0, -1]]),
    ("bodies.6.height", 0.0),
    ("bodies.6.height", 1e6),
    ("bodies.6.end", [0.5, 0]),
    ("bodies.6.end", [0.5, 1e-200]),
    ("bodies.6.segments", 0),
    ("bodies.6.segments", 50_000),
    ("bodies.6.segments", 10**12),
    ("bodies.6.pinned", [9]),
    ("bodies.6.cut", [15]),
    ("bodies.6.cut", [0, 10**15]),
    ("bodies.6.group", ""),
    ("bodies.6.group", 1),
    ("bodies.6.pose", [[0, 0]]),
    ("bodies.6.pose", []),
    ("bodies.0.pinned", [31]),
    ("bodies.0.cut", [30]),
    ("bodies.1.cut", [201]),
    ("bodies.2.pose", [[0, 0]] * 80),
    ("bodies.3.pinned", [1_000]),
    ("bodies.5.cut", [1]),
    ("bodies.7.spokes", 2),
    ("bodies.7.rings", 0),
    ("bodies.7.spokes", 10**12),
    ("bodies.7.pin", ["hub"]),
    ("bodies.7.pin", ["rim", "rim"]),
    ("bodies.7.radius", 0.0),
    ("bodies.7.position", [999_999.0, 0.0]),
    ("bodies.7.cut", [24]),
    ("bodies.8.segments", 2),
    ("bodies.8.thickness", 1.0),
    ("bodies.8.thickness", 0.0),
    ("bodies.8.hub_mass", 0.0),
    ("bodies.8.touches_mount", 1),
    ("bodies.8.touches_mount", None),
    ("bodies.8.pose", [[0, 0]] * 6),
    ("bodies.8.pose", [[0, 1e7]] * 7),
    ("bodies.8.position", [0.0, -1e6]),
    ("welds", [["rope.0"]]),
    ("welds", [["rope.0", "deck.0", "ball"]]),
    ("welds", [["rope.0", "rope.start"]]),
    ("welds", [["rope.0", "rope.1"]]),
    ("welds", [["rope.0", "deck.7"], ["deck.7", "rope.1"]]),
    ("welds", [["ball", "deck.20"]]),
    ("welds", [["rope", "deck.0"]]),
    ("welds", [["nobody", "deck.0"]]),
    ("welds", [["rope.0", "cart.8"]]),
    ("welds", [["rope.0", ""]]),
    ("particles.0.group", []),
    ("springs.0.group", "a\nb"),
    ("particles.0.id", "rope"),
    ("particles.0.mass", -100.0),
    ("particles.0.mass", 0),
    ("particles.0.mass", 1e10),
    ("particles.0.radius", -1.0),
    ("particles.0.position", [0.0, -1e7]),
    ("particles.0.pinned", 1),
    ("springs.0.a", "nobody"),
    ("springs.0.a", "deck"),
    ("springs.0.a", "ball.0"),
    ("springs.0.a", "deck.20"),
    ("springs.0.b", "ball"),
    ("springs.0.b", "deck.82"),
    ("springs.0.b", "deck.-1"),
    ("springs.0.b", "deck.020"),
    ("springs.0.b", "deck.\u0662"),
    ("springs.0.b", "deck."),
    ("springs.0.b", "cube.start"),
    ("springs.0.b", ""),
    ("springs.0.rest_length", -1.0),
    ("springs.0.material", "rubber"),
    ("checks.0.at_least", None),
    ("checks.0.at_most", -200.0),
    ("checks.0.particle", "nobody"),
    ("checks.0.particle", None),
    ("checks.0.metric", "max_strain"),
    ("checks.0.metric", "happiness"),
    ("checks.0.after", -1.0),
    ("checks.0.after", 1e9),
    ("extras.editor.grid", float("nan")),
    ("extras.editor.grid", 10**400),
    ("extras.editor.grid", "x" * 257),
    ("gravity", [0, -9.81]),
    ("", []),
    ("", "text"),
    ("", 1),
    ("", None),
]


def small() -> Iterator[tuple[str, bytes]]:
    """Malformed levels of an ordinary size."""
    for place, value in [
        *((place, value) for place in NUMBERS for value in NO_NUMBERS),
        *((place, value) for place in WHOLE for value in NO_WHOLE),
        *((place, value) for place in TEXTS for value in NO_TEXTS),
        *((place, value) for place in LISTS for value in ({}, "x", None, 1)),
        *((place, value) for place in OBJECTS for value in ([], "x", None, 1)),
        *OUTSIDE,
    ]:
        yield f"{place or 'all'}={str(value)[:30]!a}", encoded(changed(place, value))
    for place in REQUIRED:
        yield f"without {place}", encoded(without(place))
    yield from by_hand()


def by_hand() -> Iterator[tuple[str, bytes]]:
    """What no change of one value makes: broken text, repeated keys, wrong encodings."""
    good = encoded(GOOD)
    for end in range(0, len(good) - 1, 97):
        yield f"cut at {end}", good[:end]
    text = good.decode()
    yield "empty", b""
    yield "blank", b" \n\t "
    yield "nul bytes", b"\0" * 100
    yield "nul at the end", good + b"\0"
    yield "binary", bytes(range(256)) * 4
    yield "gzip", b"\x1f\x8b\x08\x00" + good
    yield "utf-16", text.encode("utf-16")
    yield "utf-16 without mark", text.encode("utf-16-le")
    yield "utf-32", text.encode("utf-32")
    yield "latin-1", text.replace("Good", "Br\u00fccke").encode("latin-1")
    yield "surrogate bytes", text.replace("Good", "\ud800").encode("utf-8", "surrogatepass")
    yield "lone surrogate", text.replace("Good", "\\ud800").encode()
    yield "lone surrogate key", text.replace('"grid"', '"\\udfff"').encode()
    yield "1e999", text.replace("0.25", "1e999").encode()
    yield "-1e999", text.replace("-9.81", "-1e999").encode()
    yield "1e999 in extras", text.replace('"grid": 0.5', '"grid": 1e999').encode()
    yield "5000 digits", text.replace("0.25", "9" * 5000).encode()
    yield "1000 digits", text.replace("0.25", "9" * 1000).encode()
    yield "5000 digits in extras", text.replace('"grid": 0.5', '"grid": ' + "9" * 5000).encode()
    yield "hexadecimal", text.replace("0.25", "0x10").encode()
    yield "leading zero", text.replace("0.25", "00.25").encode()
    yield "plus sign", text.replace("0.25", "+0.25").encode()
    yield "comment", b"// a level\n" + good
    yield "single quotes", text.replace('"', "'").encode()
    yield "trailing comma", text.replace('["demo"]', '["demo",]').encode()
    yield "two documents", good + good
    yield "line break in a string", text.replace("Good", "Go\nod").encode()
    yield "key twice", text.replace('"name"', '"name": "Other", "name"').encode()
    yield "key twice in a body", text.replace('"segments"', '"segments": 3, "segments"').encode()
    yield "key twice in extras", text.replace('"grid"', '"grid": 1, "grid"').encode()
    yield "key twice, escaped", text.replace('"name"', '"n\\u0061me": "Other", "name"').encode()
    yield (
        "key twice inside what a key twice replaces",
        text.replace('"extras"', '"extras": {"a": 1, "a": 2}, "extras"').encode(),
    )
    yield "path as a key", text.replace('"grid"', '"../../etc/passwd\\n"').replace('"tags"', '"a\\nb"').encode()


def changed(place: str, value: Any) -> Any:
    """The good level with another value at a place, a path of keys and indices joined by dots."""
    if not place:
        return value
    level = copy.deepcopy(GOOD)
    holder, key = _holder(level, place)
    holder[key] = value
    return level


def without(place: str) -> Any:
    """The good level without what stands at a place."""
    level = copy.deepcopy(GOOD)
    holder, key = _holder(level, place)
    del holder[key]
    return level


def encoded(level: Any) -> bytes:
    """A level as the bytes of a file."""
    return json.dumps(level).encode()


def _holder(level: Any, place: str) -> tuple[Any, Any]:
    *path, last = place.split(".")
    for part in path:
        level = level[int(part)] if isinstance(level, list) else level[part]
    return level, int(last) if isinstance(level, list) else last
