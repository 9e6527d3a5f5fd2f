"""Collision groups of a level: which there are, and what names one that is gone."""

from sandbox.editor.items import with_same
from sandbox.level.document.model import Level, ParticleDef
from sandbox.level.format.quantities import Described, replaced
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.plan.surfaces import group_bits


def collision_groups(level: Level) -> tuple[str, ...]:
    """Names of the collision groups of a level, those that every level has first."""
    return tuple(group_bits(level))


def without_lost_groups(level: Level) -> Level:
    """A level in which nothing collides by a group that no body and no particle is in."""
    known = set(collision_groups(level))

    def kept(part: Described) -> Described:
        assert isinstance(part, BodyDef | ParticleDef)
        names = part.collides
        if isinstance(names, bool) or known.issuperset(names):
            return part
        return replaced(part, collides=tuple(name for name in names if name in known))

    return with_same(level, bodies=tuple(map(kept, level.bodies)), particles=tuple(map(kept, level.particles)))
