"""Level: what a level file says, frozen, with no behaviour."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, field_validator
from pydantic_core import PydanticKnownError

from sandbox.level.checks import CheckDef
from sandbox.level.format.actuator_defs import HydraulicDef, MuscleDef
from sandbox.level.format.limits import (
    CHECK_LIMIT,
    DEFAULT_MATERIAL,
    DEFAULT_SOLVER,
    MATERIAL_LIMIT,
    SUBSTEPS,
    TAG_LIMIT,
    VERSION,
)
from sandbox.level.format.look import BodyLook, LevelLook, ParticleLook
from sandbox.level.format.quantities import (
    Angle,
    Coefficient,
    Collides,
    CollisionGroup,
    Compression,
    Coordinate,
    Corners,
    Description,
    Drag,
    Extras,
    Friction,
    FrictionCoefficient,
    Gravity,
    GravityScale,
    Group,
    HookeDamping,
    HookeStiffness,
    Id,
    Length,
    Line,
    Mass,
    Name,
    Point,
    Restitution,
    Rolling,
    Share,
    Tension,
    Text,
    TurnRate,
    Velocity,
    YieldShare,
    YieldStrain,
    unit,
)
from sandbox.level.kinds.bodies import AnyBody
from sandbox.physics.settings import AUTO, Substeps
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.state import ROLLING_RESISTANCE


class Settings(Description):
    """How time passes: gravity, tick rate and the solver with its settings."""

    gravity: Gravity = Field(default=(0.0, -9.81), description="Acceleration of every free particle.")
    tick_rate: int = Field(default=60, ge=1, le=10_000, description="Ticks in a second.", json_schema_extra=unit("1/s"))
    substeps: Substeps = Field(
        default=1,
        description="Parts that a tick is cut into; coefficients are converted: in the direct solver springs keep "
        "their k and c, else their motion. "
        '"auto": every tick chooses 1, 2, 4 or 8, by how far the springs turn in it.',
        json_schema_extra={"enum": [*SUBSTEPS, AUTO]},
    )
    solver: str = Field(
        # Written into every file all the same, so that a file keeps its meaning.
        default=DEFAULT_SOLVER,
        description="How the springs of a network are solved together.",
        json_schema_extra={"enum": [*sorted(SOLVERS)]},
    )
    iterations: int = Field(default=10, ge=1, le=1_000, description="Rounds of the iterative solver in each substep.")
    warm_start: float = Field(
        default=0.5,
        ge=0.0,
        le=1.0,
        description="Part of the last step's pulling impulses that the iterative solver reuses.",
    )
    wind: Velocity = Field(default=(0.0, 0.0), description="Velocity of the air; it acts by `drag` alone.")
    drag: Drag = Field(
        default=0.0,
        description="Rate at which every free particle takes on the wind's velocity, whatever its mass: what it "
        "differs by falls to 1/(1 + drag h) in a step of h seconds.",
    )

    @field_validator("substeps", mode="before")
    @classmethod
    def _count_or_auto(cls, substeps: Any) -> Any:
        # Before the type is looked at: of a choice of types, the library would list a fault for each.
        if isinstance(substeps, int) and not isinstance(substeps, bool):
            if substeps in SUBSTEPS:
                return substeps
            raise ValueError("substeps are a power of two: " + ", ".join(map(str, SUBSTEPS)) + f'; or "{AUTO}"')
        if substeps == AUTO:
            return substeps
        raise PydanticKnownError("int_type")

    @field_validator("solver")
    @classmethod
    def _exists(cls, solver: str) -> str:
        if solver in SOLVERS:
            return solver
        raise ValueError("there is no such solver; use one of " + ", ".join(sorted(SOLVERS)))


class MaterialDef(Description):
    """What springs of every law have: limits of strain, (length - rest length) / rest length, at the end of a tick."""

    tension_limit: Tension | None = Field(
        default=None, description="Strain beyond which a stretched spring breaks; null = never."
    )
    compression_limit: Compression | None = Field(
        default=None, description="Strain beyond which a compressed spring breaks, above 0; null = never."
    )
    yield_strain: YieldStrain | None = Field(
        default=None, description="Strain either way beyond which the rest length follows for good; null = elastic."
    )
    yield_limit: YieldShare = Field(
        default=0.25, description="Largest change of the rest length by yielding, as a share of it as built."
    )
    look: BodyLook | None = Field(default=None, description="How what is made of it looks; null = automatic.")


class NissenMaterial(MaterialDef):
    """The impulse-based spring (Nissen 2019): Cs and Cd per tick, the same behaviour for every mass."""

    stiffness: Coefficient = Field(
        default=0.5, description="Cs: part of its distance error that a spring corrects in a tick."
    )
    damping: Coefficient = Field(
        default=0.9, description="Cd: part of its velocity error that a spring removes in a tick."
    )


class HookeMaterial(MaterialDef):
    """The classic spring, F = -k x - c u, for comparison: it explodes where k or c is too large for mass and step."""

    law: Literal["hooke"] = Field(description='"hooke"; without `law` a material is the impulse-based spring.')
    k: HookeStiffness = Field(default=500.0, description="Spring constant.")
    c: HookeDamping = Field(default=2.0, description="Damping constant.")


def _law_of(value: Any) -> str:
    if isinstance(value, dict):
        return "hooke" if "law" in value else "nissen"
    return "hooke" if hasattr(value, "law") else "nissen"


Material = Annotated[
    Annotated[NissenMaterial, Tag("nissen")] | Annotated[HookeMaterial, Tag("hooke")], Discriminator(_law_of)
]


class ParticleDef(Description):
    """A loose particle, which belongs to no body."""

    id: Id = Field(description="Name of the particle.")
    position: Point = Field(default=(0.0, 0.0), description="Place.")
    velocity: Velocity = Field(default=(0.0, 0.0), description="Start velocity; a pinned particle starts at rest.")
    mass: Mass = Field(default=1.0, description="Mass.")
    radius: Length = Field(default=0.05, description="Radius of its disc.")
    pinned: bool = Field(default=False, description="Whether it is held where it is.")
    gravity_scale: GravityScale = 1.0
    friction: Friction = None
    restitution: Restitution = None
    collides: Collides = True
    collision_group: CollisionGroup = None
    rolls: bool = Field(
        default=True,
        description="Whether friction turns its disc, while no spring and no pin holds it; false = it slides.",
    )
    rolling: Rolling = ROLLING_RESISTANCE
    angle: Angle = Field(default=0.0, description="How far its disc has turned at the start; it is only shown.")
    spin: TurnRate = Field(default=0.0, description="How fast its disc turns at the start, anticlockwise.")
    group: Group = None
    look: ParticleLook | None = Field(default=None, description="How it looks; null = automatic.")
    extras: Extras = Field(default_factory=dict)


class SpringDef(Description):
    """A loose spring between two particles of the level; the k-th of the list is named `:k`."""

    a: Name = Field(description="One end: `id`, `id.k`, or a name such as `id.start`.")
    b: Name = Field(description="The other end.")
    name: Name | None = Field(default=None, description="What it is called in the window; null = by its number.")
    rest_length: Length | None = Field(
        default=None, description="Rest length; null = as placed, of a hydraulic its shortest."
    )
    material: Name = Field(default=DEFAULT_MATERIAL, description="Name of its material.")
    drive: MuscleDef | None = Field(
        default=None, description="Wave that its rest length follows: a muscle; null = none."
    )
    hydraulic: HydraulicDef | None = Field(
        default=None, description="Lengths between which it is driven; null = it is no hydraulic."
    )
    group: Group = None
    extras: Extras = Field(default_factory=dict)

    @property
    def given_length(self) -> float | None:
        """Rest length [m] that it is given; None = as placed."""
        if self.rest_length is None and self.hydraulic is not None:
            return self.hydraulic.shortest
        return self.rest_length


class ContactsDef(Description):
    """That things touch each other, and how, unless they say otherwise."""

    friction: FrictionCoefficient = Field(default=0.5, description="Friction of a surface.")
    restitution: Share = Field(default=0.0, description="Part of its speed with which a surface bounces.")


class WallsDef(Description):
    """Four walls, solid outside, that nothing leaves."""

    box: tuple[Coordinate, Coordinate, Coordinate, Coordinate] = Field(
        description="Left, bottom, right, top of the room.", json_schema_extra=unit("m")
    )
    friction: Friction = None
    restitution: Restitution = None


class TerrainDef(Description):
    """A piece of terrain, which never moves: a line with two sides, or a solid polygon."""

    id: Id = Field(description="Name of the piece; other pieces, bodies and particles have others.")
    polyline: Corners | None = Field(default=None, description="Corners of a line; this or `polygon`.")
    polygon: Corners | None = Field(
        default=None, description="Corners of a solid shape in order; sides may not touch or cross."
    )
    friction: Friction = None
    restitution: Restitution = None
    group: Group = None
    extras: Extras = Field(default_factory=dict)


class Level(Description):
    """A level: who made it, how time passes, and what is in it."""

    model_config = ConfigDict(serialize_by_alias=True)
    # What its check has made of it, kept for its world: no field, so neither written nor compared nor copied.
    __slots__ = ("_plan",)

    schema_link: Line | None = Field(
        default=None,
        alias="$schema",
        description="Address of the schema, for editors that complete keys; kept and ignored.",
    )
    format: Literal["spring-sandbox/level"] = Field(description="Says that this is a level.")
    version: int = Field(description="Version of the format.", json_schema_extra={"const": VERSION})
    name: Name = Field(description="Title, as the gallery shows it.")
    description: Text = Field(default="", description="What it shows and what to try.")
    author: Line = Field(default="", description="Who made it.")
    licence: Line = Field(default="", description='Licence, by its SPDX name: "CC0-1.0".')
    tags: tuple[Line, ...] = Field(default=(), max_length=TAG_LIMIT, description="Words to find it by.")
    settings: Settings = Field(default=Settings(), description="How time passes.")
    view: tuple[Coordinate, Coordinate, Coordinate, Coordinate] | None = Field(
        default=None,
        description="What the camera shows at first: left, bottom, right, top; null = everything. No walls.",
        json_schema_extra=unit("m"),
    )
    materials: dict[Name, Material] = Field(default={}, max_length=MATERIAL_LIMIT, description="Materials by name.")
    contacts: ContactsDef | None = Field(
        default=None,
        description="That things touch; null = nothing touches anything, unless there are terrain or walls.",
    )
    walls: WallsDef | None = Field(default=None, description="Walls all round; null = none.")
    terrain: tuple[TerrainDef, ...] = Field(default=(), description="Lines and solid shapes that never move.")
    bodies: tuple[AnyBody, ...] = Field(default=(), description="Bodies, in the order of their particles and springs.")
    particles: tuple[ParticleDef, ...] = Field(default=(), description="Loose particles, after those of the bodies.")
    springs: tuple[SpringDef, ...] = Field(default=(), description="Loose springs, after those of the bodies.")
    welds: tuple[tuple[Name, Name], ...] = Field(
        default=(),
        description="Pairs of particles that are one: their masses add, and it stands where the first of them in "
        "order does. Both names find it.",
    )
    checks: tuple[CheckDef, ...] = Field(
        default=(), max_length=CHECK_LIMIT, description="What must hold of the level's run."
    )
    look: LevelLook | None = Field(default=None, description="How it looks; null = automatic.")
    extras: Extras = Field(default_factory=dict)

    @property
    def has_contacts(self) -> bool:
        """Whether anything in the level touches anything."""
        return self.contacts is not None or self.walls is not None or bool(self.terrain)

    @field_validator("version")
    @classmethod
    def _known(cls, version: int) -> int:
        if version == VERSION:
            return version
        raise ValueError(f"this program reads version {VERSION} of the format")


def keys_of(model: type[BaseModel]) -> list[str]:
    """The keys that an object of a model has in a file, in its order."""
    return [field.alias or name for name, field in model.model_fields.items()]


LEVEL_KEYS = keys_of(Level)
# Settings that a person may change while a world runs: all but the tick rate, which is that of its whole run.
CHANGEABLE_SETTINGS = tuple(name for name in Settings.model_fields if name != "tick_rate")
