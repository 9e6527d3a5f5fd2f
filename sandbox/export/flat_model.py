"""FlatLevel: a level expanded, as other programs read it: nothing refers to anything but by index or name.

Format 1 of spring-sandbox/flat. Additions keep the number; a reader ignores keys that it does not know.
"""

from typing import Any, Literal

from pydantic import Field

from sandbox.level.format.look import BodyLook, LevelLook, ParticleLook
from sandbox.level.format.quantities import Description, unit

Place = tuple[float, float]
Indices = tuple[int, ...]
METRES, NUMBER = unit("m"), unit("1")
BELT = "How fast its surface runs, to the right of who stands on it."


class FlatParticle(Description):
    """A particle; others refer to it by its place in the list, from 0."""

    name: str = Field(description="Its first name in the level.")
    position: Place = Field(description="Where it starts.", json_schema_extra=METRES)
    velocity: Place = Field(default=(0.0, 0.0), description="How it starts.", json_schema_extra=unit("m/s"))
    mass: float = Field(description="Its mass, pinned or not.", json_schema_extra=unit("kg"))
    radius: float = Field(description="Of its disc.", json_schema_extra=METRES)
    pinned: bool = Field(default=False, description="Whether it is held where it is.")
    body: int | None = Field(default=None, description="Index of its body; null = a loose particle.")
    surface: int = Field(description="Index of what it is like to the touch.")
    gravity_scale: float = Field(default=1.0, description="Times that gravity pulls at it.", json_schema_extra=NUMBER)
    spin: float = Field(default=0.0, description="How fast its disc turns.", json_schema_extra=unit("rad/s"))
    look: ParticleLook | None = Field(default=None, description="How it looks; null = automatic.")
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")


class FlatSurface(Description):
    """What particles are like to the touch; those of one body never touch each other."""

    friction: float = Field(description="Of two that touch the geometric mean counts.", json_schema_extra=NUMBER)
    restitution: float = Field(description="Of two that touch the larger counts.", json_schema_extra=NUMBER)
    group: int = Field(description="Number of its group, from 0, which is that of terrain.")
    touches: Indices = Field(description="Numbers of the groups in this file that it touches, terrain's 0 included.")


class FlatSpring(Description):
    """A spring. Cs and Cd hold in the sandbox's solver; k and c are what F = -k x - c u needs for the same motion."""

    name: str = Field(description="Its name in the level.")
    a: int = Field(description="Particle at its first end, by index.")
    b: int = Field(description="Particle at its second end.")
    rest_length: float = Field(description="Where it pulls and pushes nothing.", json_schema_extra=METRES)
    Cs: float | None = Field(description="Stiffness of a tick; null = Hooke's spring.", json_schema_extra=NUMBER)
    Cd: float | None = Field(description="Damping of a tick; null = Hooke's spring.", json_schema_extra=NUMBER)
    k: float = Field(description="Spring constant.", json_schema_extra=unit("N/m"))
    c: float = Field(description="Damping constant, at `rate * steps`.", json_schema_extra=unit("N s/m"))
    rod: bool = Field(default=False, description="Whether it is too stiff to be added as a force: take a rigid joint.")
    edge: bool = Field(default=False, description="Whether it is a line that particles of others touch.")
    belt: float = Field(default=0.0, description=BELT, json_schema_extra=unit("m/s"))
    material: str = Field(description="Name of its material.")
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")


class FlatArea(Description):
    """A polygon of particles that keeps its area, counter-clockwise."""

    particles: Indices = Field(description="Its corners, by index.")
    area: float = Field(description="The area that it wants.", json_schema_extra=unit("m^2"))
    Cs: float = Field(description="Stiffness of a tick.", json_schema_extra=NUMBER)
    Cd: float = Field(description="Damping of a tick.", json_schema_extra=NUMBER)


class FlatBend(Description):
    """Two links that keep the angle between them."""

    particles: tuple[int, int, int] = Field(description="One end, the middle, the other end, by index.")
    cosine: float = Field(description="Of the angle between the links at rest.", json_schema_extra=NUMBER)
    sine: float = Field(description="Of that angle, above 0 to the left.", json_schema_extra=NUMBER)
    Cs: float = Field(description="Stiffness of a tick.", json_schema_extra=NUMBER)
    Cd: float = Field(description="Damping of a tick.", json_schema_extra=NUMBER)


class FlatTerrain(Description):
    """A piece that never moves."""

    id: str = Field(description="Its name; that of walls is `walls`.")
    kind: Literal["line", "solid", "hollow"] = Field(
        description="A line with two sides, a polygon solid inside, or one that is solid outside: walls."
    )
    corners: tuple[Place, ...] = Field(description="In order; polygons are closed.", json_schema_extra=METRES)
    friction: float = Field(description="Friction.", json_schema_extra=NUMBER)
    restitution: float = Field(description="Restitution.", json_schema_extra=NUMBER)
    belt: float = Field(default=0.0, description=BELT, json_schema_extra=unit("m/s"))
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")


class FlatOutline(Description):
    """Particles along the rim of a body, counter-clockwise about what is solid; or along a rope."""

    particles: Indices = Field(description="By index, in order.")
    closed: bool = Field(description="Whether the last is joined to the first.")


class FlatBody(Description):
    """A body of the level."""

    id: str = Field(description="Its name.")
    type: str = Field(description="Kind of body.")
    material: str = Field(description="Name of its material.")
    outlines: tuple[FlatOutline, ...] = Field(default=(), description="Its rim, and those of holes.")
    look: BodyLook | None = Field(default=None, description="How it looks; null = automatic.")
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")


class FlatMaterial(Description):
    """A material; null = never."""

    tension_limit: float | None = Field(default=None, description="Strain that breaks it.", json_schema_extra=NUMBER)
    compression_limit: float | None = Field(
        default=None, description="Strain that breaks it, squeezed, above 0.", json_schema_extra=NUMBER
    )
    yield_strain: float | None = Field(
        default=None, description="Strain beyond which its rest length follows.", json_schema_extra=NUMBER
    )
    yield_limit: float = Field(default=0.25, description="At most by this share.", json_schema_extra=NUMBER)
    look: BodyLook | None = Field(default=None, description="How it looks; null = automatic.")


class FlatMuscle(Description):
    """A spring whose rest length follows a wave of two parabolas a period."""

    spring: int = Field(description="By index.")
    amplitude: float = Field(description="Share of the rest length.", json_schema_extra=NUMBER)
    period: int = Field(description="From one swing to the next.", json_schema_extra=unit("tick"))
    phase: float = Field(description="Part of a period that it is ahead.", json_schema_extra=NUMBER)
    force: float | None = Field(default=None, description="Largest force; null = any.", json_schema_extra=unit("N"))


class FlatHydraulic(Description):
    """A spring whose rest length goes from one length to another while it is driven."""

    spring: int = Field(description="By index.")
    shortest: float = Field(description="Least rest length.", json_schema_extra=METRES)
    longest: float = Field(description="Largest rest length.", json_schema_extra=METRES)
    rate: float = Field(description="How fast it grows at a value of 1.", json_schema_extra=unit("m/s"))
    value: float = Field(description="How it is driven at the start, -1..1.", json_schema_extra=NUMBER)
    force: float | None = Field(default=None, description="Largest force; null = any.", json_schema_extra=unit("N"))
    returns: bool = Field(
        default=False, description="Whether it goes back to the length where it began, as fast, while its value is 0."
    )


class FlatMotor(Description):
    """What turns particles about a hub."""

    hub: int = Field(description="By index.")
    rim: Indices = Field(description="By index.")
    speed: float = Field(description="At a value of 1, anticlockwise.", json_schema_extra=unit("rad/s"))
    torque: float = Field(description="Largest torque.", json_schema_extra=unit("N m"))
    value: float = Field(description="How it is driven at the start, -1..1.", json_schema_extra=NUMBER)


class FlatLevel(Description):
    """A level expanded to particles and springs. Units are SI, y points up."""

    format: Literal["spring-sandbox/flat"] = Field(description="Says that this is a flat level.")
    version: Literal[1] = Field(description="Version of the format.")
    name: str = Field(description="Title of the level.")
    rate: int = Field(description="Ticks in a second, of which Cs and Cd are.", json_schema_extra=unit("1/s"))
    steps: int = Field(description="Steps of a tick with which forces of k and c can be added one by one.")
    solver: str = Field(description="The level's solver, for which Cs and Cd hold.")
    substeps: int | Literal["auto"] = Field(description="Its substeps of a tick.")
    gravity: Place = Field(description="Gravity.", json_schema_extra=unit("m/s^2"))
    wind: Place = Field(default=(0.0, 0.0), description="Velocity of the air.", json_schema_extra=unit("m/s"))
    drag: float = Field(default=0.0, description="Rate at which all takes it on.", json_schema_extra=unit("1/s"))
    contacts: bool = Field(description="Whether anything touches anything.")
    view: tuple[float, float, float, float] | None = Field(
        default=None, description="Left, bottom, right, top; null = everything.", json_schema_extra=METRES
    )
    look: LevelLook | None = Field(default=None, description="How it looks; null = automatic.")
    extras: dict[str, Any] = Field(default={}, description="Data of other tools.")
    materials: dict[str, FlatMaterial] = Field(description="Materials by name.")
    surfaces: tuple[FlatSurface, ...] = Field(description="Surfaces.")
    bodies: tuple[FlatBody, ...] = Field(description="Bodies.")
    particles: tuple[FlatParticle, ...] = Field(description="Particles.")
    springs: tuple[FlatSpring, ...] = Field(description="Springs.")
    areas: tuple[FlatArea, ...] = Field(default=(), description="Areas that are kept.")
    bends: tuple[FlatBend, ...] = Field(default=(), description="Angles that are kept.")
    terrain: tuple[FlatTerrain, ...] = Field(default=(), description="Terrain, and walls last.")
    muscles: tuple[FlatMuscle, ...] = Field(default=(), description="Muscles.")
    hydraulics: tuple[FlatHydraulic, ...] = Field(default=(), description="Hydraulics.")
    motors: tuple[FlatMotor, ...] = Field(default=(), description="Motors.")


def flat_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a flat level; `unit` on a property is its unit."""
    title = "Spring Sandbox flat level"
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **FlatLevel.model_json_schema(), "title": title}
