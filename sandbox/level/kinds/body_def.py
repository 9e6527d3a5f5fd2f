"""BodyDef: the fields that all bodies share, and models of objects inside bodies."""

from collections.abc import Iterable
from typing import Literal

from pydantic import Field, model_validator

from sandbox.level.format.actuator_defs import MuscleDef
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.look import BodyLook
from sandbox.level.format.quantities import (
    Belt,
    Coefficient,
    Collides,
    CollisionGroup,
    DampingRatio,
    Description,
    Extras,
    Frequency,
    Friction,
    GravityScale,
    Group,
    Id,
    Index,
    Length,
    Name,
    Point,
    Restitution,
    Sag,
    Velocity,
    empty,
    unit,
)
from sandbox.physics.keeping.equipment import Firmness

End = Literal["start", "end"]


class FirmnessDef(Description):
    """How soft a body is as a whole, at any grid, size and mass: by `sag`, or by `hz` and `ratio`."""

    sag: Sag | None = Field(
        default=None,
        description="How far it sags under its own weight where it stands, as a share of its height; 0 = rigid.",
        json_schema_extra=empty("by frequency"),
    )
    hz: Frequency | None = Field(
        default=None,
        description="Frequency of its slowest wobble, undamped.",
        json_schema_extra=unit("Hz") | empty("by sag"),
    )
    ratio: DampingRatio | None = Field(
        default=None,
        description="Damping ratio of that wobble: below 1 it swings, above 1 it creeps back.",
        json_schema_extra=empty("0.15, or the least possible"),
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> "FirmnessDef":
        if (self.sag is None) == (self.hz is None):
            raise ValueError("say sag, or hz: one of the two")
        if self.sag is not None and self.ratio is not None:
            raise ValueError("ratio goes with hz; take it out beside sag")
        return self

    @property
    def asked(self) -> Firmness:
        """The firmness in the words of the physics."""
        return Firmness(self.sag, self.hz, self.ratio)


class BodyDef(Description):
    """The fields that all bodies share."""

    type: str = Field(description="Kind of body.")
    id: Id = Field(description="Name of the body. `id.k` is its particle k and `id:k` its spring k, counted from 0.")
    velocity: Velocity = Field(default=(0.0, 0.0), description="Start velocity of its particles that are not pinned.")
    material: Name = Field(default=DEFAULT_MATERIAL, description="Name of the material of its springs.")
    firmness: FirmnessDef | None = Field(
        default=None,
        description="How soft it is as a whole, in place of Cs and Cd of its material. For forms that are stiff "
        "without pins.",
        json_schema_extra=empty("as its material"),
    )
    pinned: tuple[Index, ...] = Field(default=(), description="Particles that stay where they are, by index.")
    cut: tuple[Index, ...] = Field(
        default=(), description="Springs that are left out, by index. The others keep their names."
    )
    pose: tuple[Point, ...] | None = Field(
        default=None,
        description="Start place of each particle, if the body does not start in its own form. Rest lengths stay those "
        "of its form.",
        json_schema_extra=empty("its own form"),
    )
    gravity_scale: GravityScale = 1.0
    drive: MuscleDef | None = Field(
        default=None, description="Makes a muscle of each of its springs.", json_schema_extra=empty("none")
    )
    particle_radius: Length | None = Field(
        default=None, description="Radius of its particles in collisions.", json_schema_extra=empty("0.05")
    )
    friction: Friction = None
    restitution: Restitution = None
    belt: Belt = 0.0
    collides: Collides = True
    collision_group: CollisionGroup = None
    group: Group = None
    look: BodyLook | None = Field(
        default=None, description="How it looks.", json_schema_extra=empty("as its material, or automatic")
    )
    extras: Extras = Field(default_factory=dict)


class BendingDef(Description):
    """Angular springs: each keeps two springs that meet at the angle that they have in the body's form."""

    stiffness: Coefficient = Field(
        default=0.5, description="Cs: share of its error that an angle, alone, corrects in a tick."
    )
    damping: Coefficient = Field(
        default=0.9, description="Cd: share of its turning that an angle, alone, removes in a tick."
    )


BENDING = "Angular springs at every particle where just two springs of the body meet."
BENDS_FREELY = empty("bends freely")


def file_order(names: Iterable[str]) -> list[str]:
    """Names of fields of a body in the order of a file: type, id, those of its kind, then the other shared ones."""
    first = ("type", "id")
    last = tuple(name for name in BodyDef.model_fields if name not in first)
    return sorted(names, key=lambda name: 0 if name in first else 2 if name in last else 1)
