"""Bodies and balls that are heavier or lighter as a whole."""

from typing import Any

from sandbox.level.document.model import ParticleDef
from sandbox.level.format.quantities import significant
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.body_def import BodyDef

# Digits of what is written: the sum of many is then as it was asked for.
DIGITS = 12


def mass_of(part: BodyDef | ParticleDef) -> float:
    """Mass [kg] of a whole body, or of a ball."""
    return part.mass if isinstance(part, ParticleDef) else float(expansion(part).mass.sum())


def masses_for(part: BodyDef | ParticleDef, mass: float) -> dict[str, Any]:
    """The fields of a body or a ball with which the whole has that mass [kg]; its particles keep their shares."""
    factor = mass / mass_of(part)
    found: dict[str, Any] = {}
    for field in ("mass", "particle_mass", "end_mass", "hub_mass"):
        value = part.__dict__.get(field)
        if value is not None:
            found[field] = significant(factor * value, DIGITS)
    if "masses" in part.__dict__ and isinstance(part, BodyDef):
        found["masses"] = tuple(significant(factor * each, DIGITS) for each in expansion(part).mass.tolist())
    return found
