"""Colours of materials while a level is edited."""

from collections.abc import Mapping
from itertools import cycle

from sandbox.app.draw.colours import MATERIAL_COLOURS, RELAXED, Colour, unpacked
from sandbox.level.document.model import Material
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.look import colour_of


def material_colours(materials: Mapping[str, Material]) -> dict[str, Colour]:
    """Colours of the materials of a level, in its order, and of the one that needs no definition: those of their looks.

    A material whose look has no colour gets one of a row that repeats.
    """
    own = (name for name in materials if name != DEFAULT_MATERIAL)
    colours: dict[str, Colour] = {DEFAULT_MATERIAL: RELAXED, **dict(zip(own, cycle(MATERIAL_COLOURS), strict=False))}
    looks = {name: each.look.colour for name, each in materials.items() if each.look is not None}
    return colours | {name: unpacked(colour_of(colour)) for name, colour in looks.items() if colour is not None}
