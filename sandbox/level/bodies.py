"""Models of bodies: rope, bridge, jelly and mesh, as a level file describes them before expansion."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from sandbox.level.limits import DEFAULT_MATERIAL
from sandbox.level.quantities import (
    Angle,
    Description,
    Extras,
    Id,
    Index,
    Length,
    Mass,
    Name,
    Point,
    Size,
    Spacing,
    Velocity,
    unit,
)

End = Literal["start", "end"]


# What every body has. The order of a model's fields is the order in which they are written.
BodyId = Annotated[
    Id, Field(description="Name of the body; `id.k` is its k-th particle and `id:k` its k-th spring, from 0.")
]
BodyVelocity = Annotated[Velocity, Field(description="Start velocity of every particle that is not pinned.")]
BodyMaterial = Annotated[Name, Field(description="Name of the material of its springs.")]


class RopeDef(Description):
    """A chain of particles, placed evenly from start to end, with a spring between each two neighbours."""

    type: Literal["rope"] = Field(description="Kind of body.")
    id: BodyId
    start: Point = Field(description="Place of the first particle, `id.start`.")
    end: Point = Field(description="Place of the last particle, `id.end`.")
    segments: int = Field(ge=1, description="Number of springs; the particles are one more.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    end_mass: Mass | None = Field(default=None, description="Mass of the last particle; null = `particle_mass`.")
    rest_length: Length | None = Field(default=None, description="Rest length of each spring; null = as placed.")
    pin: tuple[End, ...] = Field(default=(), max_length=2, description='Ends that are held: any of "start", "end".')
    velocity: BodyVelocity = (0.0, 0.0)
    material: BodyMaterial = DEFAULT_MATERIAL
    extras: Extras = Field(default={})


class BridgeDef(Description):
    """A truss: a top row from start to end, a bottom row `height` below, chords, verticals and crossed diagonals."""

    type: Literal["bridge"] = Field(description="Kind of body.")
    id: BodyId
    start: Point = Field(description="Place of the top row's first particle, `id.start`.")
    end: Point = Field(description="Place of the top row's last particle, `id.end`.")
    segments: int = Field(ge=1, description="Number of cells; each row has one particle more.")
    height: Size = Field(default=1.0, description="How far the bottom row lies straight below the top row.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    pin: tuple[End, ...] = Field(default=(), max_length=2, description='Ends where both rows are held: "start", "end".')
    velocity: BodyVelocity = (0.0, 0.0)
    material: BodyMaterial = DEFAULT_MATERIAL
    extras: Extras = Field(default={})


class BoxShape(Description):
    """A rectangle about the jelly's centre."""

    box: tuple[Size, Size] = Field(description="Width and height.", json_schema_extra=unit("m"))


class CircleShape(Description):
    """A disc about the jelly's centre."""

    circle: Size = Field(description="Radius.")


class PolygonShape(Description):
    """A simple polygon, corners relative to the jelly's centre."""

    polygon: tuple[Point, ...] = Field(
        min_length=3,
        description="Corners in order, relative to the jelly's position; sides may not touch or cross.",
    )


SHAPES = ("box", "circle", "polygon")


def _shape_of(value: Any) -> str | None:
    if isinstance(value, dict):
        return next((name for name in SHAPES if name in value), None)
    return next((name for name in SHAPES if hasattr(value, name)), None)


Shape = Annotated[
    Annotated[BoxShape, Tag("box")] | Annotated[CircleShape, Tag("circle")] | Annotated[PolygonShape, Tag("polygon")],
    Discriminator(_shape_of),
]


class JellyDef(Description):
    """A soft body: particles on a square grid inside a shape, each joined to its eight neighbours."""

    type: Literal["jelly"] = Field(description="Kind of body.")
    id: BodyId
    shape: Shape = Field(description='`{"box": [w, h]}`, `{"circle": radius}` or `{"polygon": [[x, y], ...]}`.')
    position: Point = Field(default=(0.0, 0.0), description="Place of the centre, the shape's own [0, 0].")
    angle: Angle = Field(default=0.0, description="Turn about the centre, counter-clockwise.")
    spacing: Spacing = Field(description="Distance of neighbours in the grid; a box stretches it to fit.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    velocity: BodyVelocity = (0.0, 0.0)
    material: BodyMaterial = DEFAULT_MATERIAL
    extras: Extras = Field(default={})


class MeshDef(Description):
    """Particles and springs one by one, for whatever the other bodies do not offer."""

    type: Literal["mesh"] = Field(description="Kind of body.")
    id: BodyId
    particles: tuple[Point, ...] = Field(min_length=1, description="Place of each particle.")
    masses: tuple[Mass, ...] | None = Field(
        default=None, description="Mass of each particle; null = 1 each.", json_schema_extra=unit("kg")
    )
    velocities: tuple[Velocity, ...] | None = Field(
        default=None,
        description="Start velocity of each particle, added to the body's `velocity`; null = none.",
        json_schema_extra=unit("m/s"),
    )
    pinned: tuple[Index, ...] = Field(default=(), description="Particles that are held, by index.")
    springs: tuple[tuple[Index, Index], ...] = Field(
        default=(), description="Pairs of particles, by index, that a spring joins; rest lengths are as placed."
    )
    velocity: BodyVelocity = (0.0, 0.0)
    material: BodyMaterial = DEFAULT_MATERIAL
    extras: Extras = Field(default={})


AnyBody = Annotated[RopeDef | BridgeDef | JellyDef | MeshDef, Field(discriminator="type")]
