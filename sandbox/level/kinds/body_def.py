"""What a level file says of a body of any kind: BodyDef, the base of their models."""

from collections.abc import Iterable
from typing import Literal

from pydantic import Field

from sandbox.level.format.actuator_defs import MuscleDef
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.quantities import (
    Coefficient,
    Collides,
    CollisionGroup,
    Description,
    Extras,
    Friction,
    GravityScale,
    Group,
    Id,
    Index,
    Length,
    Name,
    Point,
    Restitution,
    Velocity,
)

End = Literal["start", "end"]


class BodyDef(Description):
    """What every body has; `file_order` says where its fields stand between those of a kind of body."""

    type: str = Field(description="Kind of body.")
    id: Id = Field(description="Name of the body; `id.k` is its k-th particle and `id:k` its k-th spring, from 0.")
    velocity: Velocity = Field(default=(0.0, 0.0), description="Start velocity of every particle that is not pinned.")
    material: Name = Field(default=DEFAULT_MATERIAL, description="Name of the material of its springs.")
    pinned: tuple[Index, ...] = Field(default=(), description="Particles that are held, by index.")
    cut: tuple[Index, ...] = Field(
        default=(), description="Springs that are left out, by index; the others keep their names."
    )
    pose: tuple[Point, ...] | None = Field(
        default=None,
        description="Start place of each particle where the body does not start in its own form; "
        "rest lengths stay those of its form. null = its form.",
    )
    gravity_scale: GravityScale = 1.0
    drive: MuscleDef | None = Field(
        default=None, description="Wave that the rest lengths of its springs follow: a muscle; null = none."
    )
    particle_radius: Length | None = Field(
        default=None, description="Radius of its particles, where things touch; null = 0.05."
    )
    friction: Friction = None
    restitution: Restitution = None
    collides: Collides = True
    collision_group: CollisionGroup = None
    group: Group = None
    extras: Extras = Field(default={})


class BendingDef(Description):
    """Angular springs, which hold two springs that meet at the angle of the body's form."""

    stiffness: Coefficient = Field(
        default=0.5, description="Cs: part of its error that an angle corrects in a tick, alone."
    )
    damping: Coefficient = Field(
        default=0.9, description="Cd: part of its turning that an angle removes in a tick, alone."
    )


BENDING = "Angular springs at every particle where two springs of the body meet; null = it bends freely."


def file_order(names: Iterable[str]) -> list[str]:
    """Names of fields of a body in the order of a file: type, id, those of its kind, then the others of every body."""
    first = ("type", "id")
    last = tuple(name for name in BodyDef.model_fields if name not in first)
    return sorted(names, key=lambda name: 0 if name in first else 2 if name in last else 1)
