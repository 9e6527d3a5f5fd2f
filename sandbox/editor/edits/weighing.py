"""Making bodies and balls heavier or lighter as a whole."""

from functools import partial
from typing import Any

from sandbox.editor.document import Document
from sandbox.editor.edits.fields import change_items
from sandbox.editor.items import Item
from sandbox.level.document.model import ParticleDef
from sandbox.level.format.quantities import significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef

# The fields of a thing that are masses.
_MASSES = ("mass", "particle_mass", "end_mass", "hub_mass", "masses")
# Digits of what is written: the sum of many is then as it was asked for.
_DIGITS = 12


def mass_of(part: BodyDef | ParticleDef) -> float:
    """Mass [kg] of a whole body, or of a ball."""
    return part.mass if isinstance(part, ParticleDef) else float(expansion(part).mass.sum())


def weighing(document: Document, item: Item, part: BodyDef | ParticleDef, mass: float) -> Document:
    """Give a body or a ball another mass of the whole [kg]; its particles keep their shares. Raises EditError."""
    factor = mass / mass_of(part)

    def scaled(field: str, part: Any) -> Any:
        value = getattr(part, field)
        if field == "masses":
            return tuple(significant(factor * each, _DIGITS) for each in expansion(part).mass.tolist())
        return None if value is None else significant(factor * value, _DIGITS)

    for field in _MASSES:
        if field in part.__dict__:
            document = change_items(document, [item], field, partial(scaled, field))
    return document
