"""Random levels, as the text of level files: every kind of body, every solver, with and without contacts and rules."""

import json
import random
from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.parse import parse_level
from sandbox.physics.settings import AUTO
from tests.determinism.seeds.answers import answers
from tests.support.parts import CART, SKIN, placed, placed_cart

Part = dict[str, Any]

# Places of bodies [m], one for each; some overlap those beside them.
CELLS = [(-5.0 + 2.5 * column, 2.5 + 2.2 * row) for row in range(3) for column in range(5)]
ROOM = (-7.5, -0.5, 7.5, 10.0)
# Cs and Cd up to which the single pass bears a network of springs.
EXPLICIT = 0.05
# Levels that are drawn for a seed until one has no faults.
ATTEMPTS = 50


def random_level(seed: int) -> Level:
    """The level of a seed, read from its text."""
    chance = random.Random(f"level {seed}")
    for _ in range(ATTEMPTS):
        try:
            return parse_level(json.dumps(_level(chance, f"seed {seed}")).encode(), f"seed {seed}")
        except LevelError:
            continue
    raise AssertionError(f"seed {seed}: no level of {ATTEMPTS} is without faults")


def number(chance: random.Random, low: float, high: float) -> float:
    """A number of few digits."""
    return round(chance.uniform(low, high), 3)


def _level(chance: random.Random, name: str) -> Part:
    settings = _settings(chance)
    materials = {f"m{k}": _material(chance, settings["solver"] == "single_pass") for k in range(3)}
    cells = chance.sample(CELLS, chance.randint(1, 4))
    bodies = [_body(chance, f"b{k}", x, y) for k, (x, y) in enumerate(cells)]
    particles = [_particle(chance, k) for k in range(chance.choice([0, 0, 2, 5]))]
    level: Part = {
        "format": "spring-sandbox/level", "version": 3, "name": name, "settings": settings, "materials": materials,
        "bodies": bodies, "particles": particles, "springs": _springs(chance, bodies),
    }  # fmt: skip
    if chance.random() < 0.15:
        cart = placed_cart(number(chance, -3.0, 3.0), 1.2)
        bodies += [cart["body"], *cart["others"]]
        materials |= SKIN
        level["welds"] = [list(pair) for pair in CART["welds"]]
    if chance.random() < 0.65:
        level |= _surroundings(chance)
    if chance.random() < 0.4:
        level |= answers(chance, bodies, particles)
    return level


def _settings(chance: random.Random) -> Part:
    return {
        "solver": chance.choice(["direct", "direct", "iterative", "single_pass"]),
        "substeps": chance.choice([1, 1, 2, 4, AUTO]),
        "iterations": chance.randint(1, 20),
        "warm_start": chance.choice([0.0, 0.5, 1.0, number(chance, 0.0, 1.0)]),
        "tick_rate": chance.choice([60, 60, 30, 120]),
        "gravity": [chance.choice([0.0, 0.3]), chance.choice([0.0, -1.62, -9.81, -9.81])],
        "wind": chance.choice([[0.0, 0.0], [number(chance, -8.0, 8.0), number(chance, -1.0, 1.0)]]),
        "drag": chance.choice([0.0, number(chance, 0.0, 2.0)]),
    }


def _material(chance: random.Random, is_explicit: bool) -> Part:
    """A material; is_explicit: mostly one that the single pass bears."""
    limits: Part = {}
    if chance.random() < 0.3:
        limits["tension_limit"] = number(chance, 0.02, 0.6)
    if chance.random() < 0.2:
        limits["compression_limit"] = number(chance, 0.05, 0.6)
    if chance.random() < 0.2:
        limits["yield_strain"] = number(chance, 0.01, 0.2)
    if chance.random() < 0.15:
        return {"law": "hooke", "k": number(chance, 1.0, 300.0), "c": number(chance, 0.0, 3.0), **limits}
    most = EXPLICIT if is_explicit and chance.random() < 0.8 else 1.0
    damping = chance.choice([most, most * number(chance, 0.0, 1.0), 0.5 * most])
    stiffness = chance.choice([damping, damping * number(chance, 0.0, 1.0), min(damping, 1e-3), 0.0])
    return {"stiffness": stiffness, "damping": damping, **limits}


def _body(chance: random.Random, name: str, x: float, y: float) -> Part:
    kind = chance.choice(["rope", "bridge", "girder", "web", "wheel", "ring", "jelly", "jelly", "mesh"])
    form: Part = {
        "rope": _rope, "bridge": _truss, "girder": _truss, "web": _web, "wheel": _wheel, "ring": _ring, "jelly": _jelly,
        "mesh": _mesh,
    }[kind](chance)  # fmt: skip
    body = placed(form, x, y) | {"type": kind, "id": name, "material": f"m{chance.randrange(3)}"}
    if kind != "mesh":
        body["particle_mass"] = chance.choice([1.0, number(chance, 0.01, 0.5), number(chance, 1.0, 500.0)])
    for field, share, low, high in (
        ("friction", 0.3, 0.0, 2.0), ("restitution", 0.3, 0.0, 1.0), ("particle_radius", 0.2, 0.0, 0.1),
        ("gravity_scale", 0.15, -0.5, 2.0), ("belt", 0.15, -4.0, 4.0),
    ):  # fmt: skip
        if chance.random() < share:
            body[field] = number(chance, low, high)
    if chance.random() < 0.4:
        body["velocity"] = [number(chance, -6.0, 6.0), number(chance, -6.0, 6.0)]
    if chance.random() < 0.2:
        body["pinned"] = [chance.randrange(3)]
    if chance.random() < 0.12:
        body["drive"] = _muscle(chance)
    if chance.random() < 0.2:
        body["collision_group"] = chance.choice(["red", "blue"])
        body["collides"] = chance.choice([True, False, ["red"], ["blue", "terrain"]])
    return body


def _rope(chance: random.Random) -> Part:
    turn = number(chance, -0.5, 0.5)
    rope: Part = {"start": [-1.1, -turn], "end": [1.1, turn], "segments": chance.randint(2, 16)}
    rope["pin"] = chance.choice([[], ["start"], ["start", "end"]])
    return rope | _bending(chance) | ({"end_mass": number(chance, 0.1, 60.0)} if chance.random() < 0.3 else {})


def _truss(chance: random.Random) -> Part:
    pin = chance.choice([[], [], ["start"], ["start", "end"]])
    return {"start": [-1.1, 0.0], "end": [1.1, 0.0], "segments": chance.randint(2, 7), "height": 0.4, "pin": pin}


def _web(chance: random.Random) -> Part:
    sizes = {"spokes": chance.randint(3, 8), "rings": chance.randint(1, 3)}
    return {"position": [0.0, 0.0], "radius": 0.9, "pin": chance.choice([[], ["rim"]]), **sizes}


def _wheel(chance: random.Random) -> Part:
    wheel: Part = {"position": [0.0, 0.0], "radius": 0.7, "thickness": 0.2, "segments": chance.randint(4, 12)}
    wheel["pin"] = chance.choice([[], ["hub"]])
    if chance.random() < 0.7:
        keys = chance.choice([{}, {"key": "d", "reverse_key": "a"}])
        wheel["motor"] = {"speed": number(chance, -15.0, 15.0), "torque": number(chance, 1.0, 200.0), **keys}
    return wheel


def _ring(chance: random.Random) -> Part:
    inflation = chance.choice([1.0, number(chance, 0.8, 1.5)])
    ring = {"position": [0.0, 0.0], "radius": 0.7, "segments": chance.randint(4, 16), "inflation": inflation}
    return ring | _bending(chance)


def _jelly(chance: random.Random) -> Part:
    shape: Part = chance.choice([
        {"box": [number(chance, 0.4, 1.8), number(chance, 0.4, 1.4)]}, {"circle": number(chance, 0.4, 0.8)},
        {"polygon": [[-0.7, -0.5], [0.8, -0.4], [0.3, 0.7]]},
    ])  # fmt: skip
    jelly: Part = {"position": [0.0, 0.0], "shape": shape, "spacing": chance.choice([0.15, 0.25, 0.4])}
    jelly |= {"angle": number(chance, 0.0, 6.0), "area": chance.random() < 0.8}
    jelly["mesh"] = chance.choice(["grid", "grid", "fitted"])
    if chance.random() < 0.25:
        jelly["firmness"] = chance.choice([{"sag": number(chance, 0.01, 0.3)}, {"hz": number(chance, 1.0, 6.0)}])
    return jelly


def _mesh(chance: random.Random) -> Part:
    places = [[number(chance, -0.9, 0.9), number(chance, -0.9, 0.9)] for _ in range(chance.randint(3, 8))]
    pairs = {tuple(sorted(chance.sample(range(len(places)), 2))) for _ in range(2 * len(places))}
    mesh: Part = {"particles": places, "springs": [list(pair) for pair in sorted(pairs)]}
    return mesh | {"masses": [number(chance, 0.1, 20.0) for _ in places]}


def _bending(chance: random.Random) -> Part:
    if chance.random() < 0.5:
        return {}
    return {"bending": {"stiffness": number(chance, 0.0, 0.9), "damping": number(chance, 0.0, 1.0)}}


def _muscle(chance: random.Random) -> Part:
    muscle: Part = {"amplitude": number(chance, 0.05, 0.3), "period": chance.randint(8, 90)}
    muscle["phase"] = number(chance, 0.0, 1.0)
    return muscle | ({"force": number(chance, 10.0, 500.0)} if chance.random() < 0.5 else {})


def _particle(chance: random.Random, k: int) -> Part:
    particle: Part = {"id": f"p{k}", "position": [number(chance, -6.5, 6.5), number(chance, 0.6, 9.0)]}
    particle |= {"mass": number(chance, 0.05, 40.0), "radius": chance.choice([0.05, 0.2, 0.35])}
    particle |= {"velocity": [number(chance, -8.0, 8.0), number(chance, -8.0, 8.0)], "spin": number(chance, -9.0, 9.0)}
    return particle | {"rolls": chance.random() < 0.8, "restitution": chance.choice([0.0, 0.5, 1.0])}


def _springs(chance: random.Random, bodies: list[Part]) -> list[Part]:
    """Springs between the first particles of bodies: plain ones, muscles and hydraulics."""
    springs = []
    for k in range(chance.choice([0, 0, 1, 3]) if len(bodies) > 1 else 0):
        first, second = chance.sample(range(len(bodies)), 2)
        spring: Part = {"a": f"b{first}.{chance.randrange(3)}", "b": f"b{second}.{chance.randrange(3)}"}
        spring["material"] = f"m{k}"
        if chance.random() < 0.4:
            reach = {"shortest": 0.5, "longest": number(chance, 1.0, 4.0), "rate": number(chance, 0.1, 3.0)}
            spring["hydraulic"] = reach | {"key": "w", "returns": chance.random() < 0.5, "force": 800.0}
        elif chance.random() < 0.3:
            spring["drive"] = _muscle(chance)
        springs.append(spring)
    return springs


def _surroundings(chance: random.Random) -> Part:
    """Contacts, and what else there is to touch."""
    found: Part = {"contacts": {"friction": chance.choice([0.0, 0.5, 2.0]), "restitution": chance.choice([0.0, 0.3])}}
    if chance.random() < 0.7:
        found["walls"] = {"box": list(ROOM)}
    terrain: list[Part] = []
    if chance.random() < 0.6:
        top = [[7.5 - 1.5 * k, number(chance, -0.2, 1.6)] for k in range(11)]
        terrain.append({"id": "hill", "polygon": [[-7.5, -0.5], [7.5, -0.5], *top]})
    if chance.random() < 0.4:
        corners = [[-4.0 + 2.0 * k, number(chance, 1.6, 4.0)] for k in range(chance.randint(2, 5))]
        terrain.append({"id": "line", "polyline": corners, "friction": 0.2})
    for piece in terrain:
        piece["belt"] = chance.choice([0.0, 1.5, -4.0])
    return found | ({"terrain": terrain} if terrain else {})
