"""Looks: what each body, spring and ball of a level is made of for the eye: what the level says, else automatic."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import cycle
from typing import Any

from sandbox.app.draw.colours import (
    BRICK,
    CLOTH,
    GLASS,
    MATERIAL_COLOURS,
    PAINTS,
    RELAXED,
    STONE,
    WOOD,
    Colour,
    unpacked,
)
from sandbox.level.document.model import Level, Material, NissenMaterial, ParticleDef, SpringDef
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.look import BALLS, GROUNDS, LINES, PALETTE, SKINS, colour_of
from sandbox.level.format.picture import Picture
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.reading.pictures import pictures_of

# What a word in a name says of its stuff; the first that fits counts.
_WORDS = {
    "wood": "wood", "plank": "wood", "beam": "wood", "timber": "wood", "cloth": "cloth", "fabric": "cloth",
    "silk": "silk", "string": "thread", "thread": "thread", "yarn": "thread", "rope": "rope", "hemp": "rope",
    "cord": "rope", "bed": "rope", "cable": "cable", "wire": "cable", "chain": "chain", "deck": "deck",
    "steel": "steel",
    "iron": "steel", "axle": "steel", "rod": "steel", "pin": "steel", "brass": "brass", "bone": "bone",
    "muscle": "muscle", "shock": "coil", "coil": "coil", "skin": "balloon", "balloon": "balloon", "rubber": "rubber",
    "tyre": "rubber", "brick": "brick", "stone": "stone", "jelly": "jelly",
}  # fmt: skip
_GROUND_WORDS = {
    "glass": "glass", "wood": "wood", "table": "wood", "frame": "wood", "lid": "wood", "foot": "wood", "beam": "wood",
    "plank": "wood", "rock": "rock", "cliff": "rock", "stone": "rock", "metal": "metal", "steel": "metal",
    "drain": "metal", "ground": "soil", "soil": "soil", "valley": "soil", "canyon": "soil", "pit": "soil",
    "hill": "soil",
}  # fmt: skip
# Cs from which a body is rubber and a line steel, and from which a loose spring is no coil.
FIRM, NO_COIL = 0.85, 0.3
# Cs below which a body that is pinned at its border is cloth.
DRAPES = 0.6
# A level of more bodies has no faces; more loose balls are grains of sand; a ball of this mass [kg] is of steel.
MOST_FACES, GRAINS, STEEL_MASS = 16, 60, 20.0
SOFT_SKINS = ("jelly", "rubber", "balloon", "plain", "wood", "stone", "brick")
STRANDS = ("rope", "cable", "chain", "deck", "thread", "silk")
_STUFF_COLOURS = {"wood": WOOD, "stone": STONE, "brick": BRICK, "cloth": CLOTH, "glass": GLASS}


@dataclass(frozen=True)
class Look:
    """The look of a body. skin: one of SKINS or tyre, "" = its lines alone; colours are 0xRRGGBB.

    picture: what it wears in place of its skin, None where it wears none, or none that was read.
    """

    skin: str
    line: str
    colour: int
    face: bool = False
    width: float = 1.0
    panel: int | None = None
    window: tuple[int, ...] = ()
    picture: Picture | None = None


def word_in(name: str, words: dict[str, str] = _WORDS) -> str:
    """The stuff that a name speaks of, or nothing."""
    low = name.lower()
    return next((kind for word, kind in words.items() if word in low), "")


def _stiffness(level: Level, material: str) -> float:
    found = level.materials.get(material, NissenMaterial())
    return float(getattr(found, "stiffness", 0.5))


def _said(level: Level, body: BodyDef | SpringDef) -> dict[str, Any]:
    """The look that a level gives a body, over that of its material; unknown names count as nothing."""
    said: dict[str, Any] = {}
    material = level.materials.get(body.material)
    for look in (None if material is None else material.look, getattr(body, "look", None)):
        if look is not None:
            said |= {name: getattr(look, name) for name in look.model_fields_set}
    known = {"skin": SKINS, "line": LINES}
    return {
        name: value for name, value in said.items() if value is not None and (name not in known or value in known[name])
    }


def is_filled(body: BodyDef) -> bool:
    """Whether a body is filled with triangles, as a jelly is."""
    return body.type == "jelly" or bool(body.__dict__.get("triangles"))


def body_looks(level: Level, pictures: Mapping[str, Picture] | None = None) -> list[Look]:
    """The look of each body; pictures: by name, None = the level's own."""
    pictures = pictures_of(level) if pictures is None else pictures
    names, toys = list(PALETTE.values()), 0
    faces = level.look.faces if level.look is not None else None
    may_have_faces = len(level.bodies) <= MOST_FACES if faces is None else faces
    looks = []
    for body in level.bodies:
        said = _said(level, body)
        stuff, firm = word_in(body.material), _stiffness(level, body.material)
        skin = said.get("skin") or _skin(body, stuff, firm)
        line = said.get("line") or _line(body, stuff, firm, skin)
        if "colour" in said:
            colour = colour_of(said["colour"])
        elif skin in _STUFF_COLOURS:
            colour = _STUFF_COLOURS[skin]
        elif skin in SOFT_SKINS:
            colour = names[toys % len(names)]
            toys += 1
        else:
            colour = PAINTS.get(body.type, PAINTS["mesh"])
        panel = colour_of(said["panel"]) if "panel" in said else None
        picture = said.get("picture")
        if picture is not None and picture.data is None:
            picture = pictures.get(picture)
        face = bool(said.get("face", skin == "jelly" and may_have_faces and picture is None))
        looks.append(Look(skin, line, colour, face, said.get("width", 1.0), panel, said.get("window", ()), picture))
    return looks


def _skin(body: BodyDef, stuff: str, firm: float) -> str:
    if is_filled(body):
        if stuff in SOFT_SKINS or stuff == "cloth":
            return stuff
        if firm < DRAPES and body.pinned:
            return "cloth"
        return "rubber" if firm >= FIRM else "jelly"
    if body.type == "ring":
        return "balloon" if getattr(body, "inflation", None) else "rubber"
    if body.type == "wheel":
        return "steel wheel" if stuff in ("steel", "brass") else "tyre"
    return ""


def _line(body: BodyDef, stuff: str, firm: float, skin: str) -> str:
    if is_filled(body) or body.type == "ring":
        # What hangs out of it where it is torn.
        return "thread" if skin == "cloth" else "paint"
    if body.type == "rope":
        own = word_in(body.id)
        if stuff == "steel" or not stuff:
            return own if own in STRANDS else "cable" if stuff else "rope"
        return "deck" if stuff == "wood" else stuff if stuff in LINES else "rope"
    if body.type == "web":
        return "silk"
    if body.type in ("bridge", "girder"):
        return stuff if stuff in ("wood", "brass", "bone") else "paint"
    if stuff in LINES:
        return stuff
    return "steel" if firm >= FIRM or body.type != "mesh" else "rubber"


def spring_look(level: Level, spring: SpringDef) -> Look:
    """The look of a loose spring."""
    said = _said(level, spring)
    stuff, firm = word_in(spring.material), _stiffness(level, spring.material)
    line = "muscle" if spring.drive is not None else "piston" if spring.hydraulic is not None else stuff
    if line not in LINES and line != "piston":
        line = "steel" if firm >= FIRM or stuff in SKINS else "rubber" if firm >= NO_COIL else "coil"
    colour = colour_of(said["colour"]) if "colour" in said else PAINTS["mesh"]
    return Look("", said.get("line", line), colour, width=said.get("width", 1.0))


def ball_look(level: Level, particle: ParticleDef, index: int, many: bool) -> tuple[str, int | None]:
    """The kind of ball that a loose particle is drawn as, and its colour, None = that of its kind."""
    look = particle.look
    ball = look.ball if look is not None and look.ball in BALLS else None
    colour = colour_of(look.colour) if look is not None and look.colour is not None else None
    if ball is None:
        if particle.mass >= STEEL_MASS:
            ball = "steel"
        elif particle.pinned:
            ball = "bumper"
        else:
            ball = "sand" if many else "stripe" if particle.radius < 0.2 else "marble"
    if colour is None and ball not in ("steel", "sand"):
        colour = list(PALETTE.values())[index % len(PALETTE)]
    return ball, colour


def ground_look(level: Level, name: str, wide: bool) -> str:
    """The material of a piece of terrain, as drawn."""
    said = level.look.ground.get(name) if level.look is not None else None
    return said if said in GROUNDS else word_in(name, _GROUND_WORDS) or ("soil" if wide else "metal")


def added_spring_look(stiffness: float) -> Look:
    """The look of a spring of that Cs which a command added by itself: a coil where it gives way, else a bar."""
    return Look("", "steel" if stiffness >= FIRM else "coil", PAINTS["mesh"])


def material_colours(materials: Mapping[str, Material]) -> dict[str, Colour]:
    """Colours of the materials of a level, in its order, and of the one that needs no definition: those of their looks.

    A material whose look has no colour gets one of a row that repeats.
    """
    own = (name for name in materials if name != DEFAULT_MATERIAL)
    colours: dict[str, Colour] = {DEFAULT_MATERIAL: RELAXED, **dict(zip(own, cycle(MATERIAL_COLOURS), strict=False))}
    looks = {name: each.look.colour for name, each in materials.items() if each.look is not None}
    return colours | {name: unpacked(colour_of(colour)) for name, colour in looks.items() if colour is not None}
