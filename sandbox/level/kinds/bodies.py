"""Models of bodies: rope, bridge, girder, web, wheel, ring, jelly and mesh, before expansion."""

from collections.abc import Iterable
from typing import Annotated, Any, Literal, get_args

from pydantic import Discriminator, Field, Tag

from sandbox.level.format.drives import MotorDef, MuscleDef
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.quantities import (
    Angle,
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
    Inflation,
    Length,
    Mass,
    Name,
    Point,
    Restitution,
    Size,
    Spacing,
    Velocity,
    unit,
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


_BENDING = "Angular springs at every particle where two springs of the body meet; null = it bends freely."


class RopeDef(BodyDef):
    """A chain of particles, placed evenly from start to end, with a spring between each two neighbours."""

    type: Literal["rope"] = Field(description="Kind of body.")
    start: Point = Field(description="Place of the first particle, `id.start`.")
    end: Point = Field(description="Place of the last particle, `id.end`.")
    segments: int = Field(ge=1, description="Number of springs; the particles are one more.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    end_mass: Mass | None = Field(default=None, description="Mass of the last particle; null = `particle_mass`.")
    rest_length: Length | None = Field(default=None, description="Rest length of each spring; null = as placed.")
    pin: tuple[End, ...] = Field(default=(), max_length=2, description='Ends that are held: any of "start", "end".')
    bending: BendingDef | None = Field(default=None, description=_BENDING)


class BridgeDef(BodyDef):
    """A truss: a top row from start to end, a bottom row `height` below, chords, verticals and crossed diagonals."""

    type: Literal["bridge"] = Field(description="Kind of body.")
    start: Point = Field(description="Place of the top row's first particle, `id.start`.")
    end: Point = Field(description="Place of the top row's last particle, `id.end`.")
    segments: int = Field(ge=1, description="Number of cells; each row has one particle more.")
    height: Size = Field(default=1.0, description="How far the bottom row lies straight below the top row.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    pin: tuple[End, ...] = Field(default=(), max_length=2, description='Ends where both rows are held: "start", "end".')


class GirderDef(BodyDef):
    """A Warren truss: a row from start to end, a row on its right half a cell further, chords and zigzag diagonals."""

    type: Literal["girder"] = Field(description="Kind of body.")
    start: Point = Field(description="Place of the first row's first particle, `id.start`.")
    end: Point = Field(description="Place of the first row's last particle, `id.end`.")
    segments: int = Field(
        ge=1, description="Number of cells, and of the second row's particles; the first has one more."
    )
    height: Size = Field(
        default=1.0, description="How far the second row lies to the right of the way from start to end."
    )
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    pin: tuple[End, ...] = Field(default=(), max_length=2, description='Ends that are held: any of "start", "end".')


class WebDef(BodyDef):
    """A round net: a particle in the centre, rings about it, a thread along every spoke and every ring."""

    type: Literal["web"] = Field(description="Kind of body.")
    position: Point = Field(default=(0.0, 0.0), description="Place of the particle in the centre, `id.centre`.")
    angle: Angle = Field(default=0.0, description="Direction of the first spoke, counter-clockwise from the right.")
    radius: Size = Field(description="Radius of the outermost ring; the others lie evenly inside.")
    spokes: int = Field(ge=3, description="Number of spokes, and of the particles of each ring.")
    rings: int = Field(ge=1, description="Number of rings.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    pin: tuple[Literal["rim"], ...] = Field(default=(), max_length=1, description='"rim": the outermost ring is held.')


class WheelDef(BodyDef):
    """A rim of two rings, braced crosswise, with a spoke from every particle of the inner ring to a hub."""

    type: Literal["wheel"] = Field(description="Kind of body.")
    position: Point = Field(default=(0.0, 0.0), description="Place of the hub, `id.hub`.")
    angle: Angle = Field(default=0.0, description="Direction of the first spoke, counter-clockwise from the right.")
    radius: Size = Field(description="Radius of the outer ring.")
    thickness: Size = Field(description="How far the inner ring lies inside the outer; below the radius.")
    segments: int = Field(ge=3, description="Number of spokes, and of the particles of each ring.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    hub_mass: Mass | None = Field(default=None, description="Mass of the hub; null = `particle_mass`.")
    pin: tuple[Literal["hub"], ...] = Field(default=(), max_length=1, description='"hub": the hub is held.')
    motor: MotorDef | None = Field(default=None, description="Motor that turns it about its hub; null = none.")


class RingDef(BodyDef):
    """A closed ring of particles, which keeps the area inside: a balloon, a tyre."""

    type: Literal["ring"] = Field(description="Kind of body.")
    position: Point = Field(default=(0.0, 0.0), description="Place of the centre.")
    angle: Angle = Field(default=0.0, description="Direction of the first particle, counter-clockwise from the right.")
    radius: Size = Field(description="Radius of the ring.")
    segments: int = Field(ge=3, description="Number of springs, and of particles.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    inflation: Inflation | None = Field(
        default=1.0, description="Area that the ring wants, as a multiple of its own; null = it holds nothing."
    )
    bending: BendingDef | None = Field(default=None, description=_BENDING)


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


class JellyDef(BodyDef):
    """A soft body: particles on a square grid inside a shape, each joined to its eight neighbours."""

    type: Literal["jelly"] = Field(description="Kind of body.")
    shape: Shape = Field(description='`{"box": [w, h]}`, `{"circle": radius}` or `{"polygon": [[x, y], ...]}`.')
    position: Point = Field(default=(0.0, 0.0), description="Place of the centre, the shape's own [0, 0].")
    angle: Angle = Field(default=0.0, description="Turn about the centre, counter-clockwise.")
    spacing: Spacing = Field(description="Distance of neighbours in the grid; a box stretches it to fit.")
    particle_mass: Mass = Field(default=1.0, description="Mass of each particle.")
    area: bool = Field(
        default=True,
        description="Whether its triangles keep their areas, with Cs and Cd of its material, so that it comes back "
        "from being crushed or turned inside out; those of a Hooke material never do.",
    )


class MeshDef(BodyDef):
    """Particles and springs one by one, for whatever the other bodies do not offer."""

    type: Literal["mesh"] = Field(description="Kind of body.")
    particles: tuple[Point, ...] = Field(min_length=1, description="Place of each particle.")
    masses: tuple[Mass, ...] | None = Field(
        default=None, description="Mass of each particle; null = 1 each.", json_schema_extra=unit("kg")
    )
    velocities: tuple[Velocity, ...] | None = Field(
        default=None,
        description="Start velocity of each particle, added to the body's `velocity`; null = none.",
        json_schema_extra=unit("m/s"),
    )
    springs: tuple[tuple[Index, Index], ...] = Field(
        default=(), description="Pairs of particles, by index, that a spring joins; rest lengths are as placed."
    )
    bending: BendingDef | None = Field(default=None, description=_BENDING)


AnyBody = Annotated[
    RopeDef | BridgeDef | GirderDef | WebDef | WheelDef | RingDef | JellyDef | MeshDef, Field(discriminator="type")
]
# Kinds of body by the name that a file gives them, in the order in which they are explained.
KINDS: dict[str, type[BodyDef]] = {
    get_args(kind.model_fields["type"].annotation)[0]: kind for kind in get_args(get_args(AnyBody)[0])
}


def file_order(names: Iterable[str]) -> list[str]:
    """Names of fields of a body in the order of a file: type, id, those of its kind, then the others of every body."""
    first = ("type", "id")
    last = tuple(name for name in BodyDef.model_fields if name not in first)
    return sorted(names, key=lambda name: 0 if name in first else 2 if name in last else 1)
