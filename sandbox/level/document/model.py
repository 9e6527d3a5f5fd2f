"""Level: the content of a level file, frozen, without behaviour."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, field_validator
from pydantic_core import PydanticKnownError

from sandbox.level.checks import CheckDef
from sandbox.level.format.actuator_defs import HydraulicDef, MuscleDef
from sandbox.level.format.limits import (
    CHECK_LIMIT,
    CORNER_LIMIT,
    DEFAULT_MATERIAL,
    MATERIAL_LIMIT,
    RULE_LIMIT,
    SUBSTEPS,
    TAG_LIMIT,
    VERSION,
    WATER_DENSITY_LIMIT,
    WATER_DRAG_LIMIT,
)
from sandbox.level.format.look import BodyLook, LevelLook, ParticleLook, ZoneLook
from sandbox.level.format.quantities import (
    Angle,
    Belt,
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
    Iterations,
    Length,
    Line,
    Mass,
    Name,
    Point,
    Restitution,
    Rolling,
    Share,
    Size,
    Tension,
    Text,
    TickRate,
    TurnRate,
    Velocity,
    YieldShare,
    YieldStrain,
    empty,
    unit,
)
from sandbox.level.kinds.bodies import AnyBody
from sandbox.level.rules.player_limits import PlayerLimits
from sandbox.level.rules.rule import CounterDef, RuleDef
from sandbox.physics.settings import AUTO, Substeps, WorldSettings
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.state import ROLLING_RESISTANCE


class Settings(Description):
    """How time passes: gravity, tick rate and the solver with its settings."""

    gravity: Gravity = Field(
        default=WorldSettings.gravity,
        description="Acceleration of every free particle: -9.81 is the Earth's, at 0 things float.",
    )
    tick_rate: TickRate = Field(default=WorldSettings.tick_rate, description="Ticks in a second.")
    substeps: Substeps = Field(
        default=WorldSettings.substeps,
        description="Number of steps in a tick. The direct solver keeps k and c of each spring, the other two keep its "
        'motion. "auto": each tick takes 1, 2, 4 or 8, by how far its springs turn.',
        json_schema_extra={"enum": [*SUBSTEPS, AUTO]},
    )
    solver: str = Field(
        # Every file names its solver, so that it keeps its meaning if the default changes.
        default=WorldSettings.solver,
        description="How the springs of a network are solved together.",
        json_schema_extra={"enum": [*sorted(SOLVERS)]},
    )
    iterations: Iterations = Field(
        default=WorldSettings.iterations,
        description="Iterations of the iterative solver in each substep; fewer make things softer.",
    )
    warm_start: Share = Field(
        default=WorldSettings.warm_start,
        description="Share of the last step's pulling impulses that the iterative solver starts from.",
    )
    wind: Velocity = Field(default=WorldSettings.wind, description="Velocity of the air. It acts only through `drag`.")
    drag: Drag = Field(
        default=WorldSettings.drag,
        description="Rate at which every free particle takes on the wind's velocity, at any mass. In a step of h "
        "seconds the difference falls to 1/(1 + drag h) of itself.",
    )

    @field_validator("substeps", mode="before")
    @classmethod
    def _count_or_auto(cls, substeps: Any) -> Any:
        # This comes before the type check: for a choice of types, the library would list a fault for each.
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
    """The fields that materials of both laws share: limits of strain, (length - rest length) / rest length."""

    tension_limit: Tension | None = Field(
        default=None, description="Strain beyond which a stretched spring breaks.", json_schema_extra=empty("never")
    )
    compression_limit: Compression | None = Field(
        default=None,
        description="Strain beyond which a compressed spring breaks, as a positive number.",
        json_schema_extra=empty("never"),
    )
    yield_strain: YieldStrain | None = Field(
        default=None,
        description="Strain, stretched or compressed, beyond which a spring bends for good.",
        json_schema_extra=empty("never"),
    )
    yield_limit: YieldShare = Field(
        default=0.25,
        description="Largest change of the rest length by yielding, as a share of the rest length as built.",
    )
    look: BodyLook | None = Field(
        default=None, description="How its bodies and springs look.", json_schema_extra=empty("automatic")
    )


class NissenMaterial(MaterialDef):
    """The impulse-based spring (Nissen 2019): Cs and Cd per tick, the same behaviour for every mass."""

    stiffness: Coefficient = Field(
        default=0.5, description="Cs: share of its length error that a spring corrects in a tick; more is stiffer."
    )
    damping: Coefficient = Field(
        default=0.9, description="Cd: share of its velocity error that a spring removes in a tick; more is calmer."
    )


class HookeMaterial(MaterialDef):
    """The classic spring, F = -k x - c u, for comparison: it explodes where k or c is too large for mass and step."""

    law: Literal["hooke"] = Field(
        description="Says that it is a Hooke material. Without `law` a material is the impulse-based spring."
    )
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
    position: Point = Field(default=(0.0, 0.0), description="Place of its centre.")
    velocity: Velocity = Field(default=(0.0, 0.0), description="Start velocity. A pinned particle starts at rest.")
    mass: Mass = Field(default=1.0, description="Mass.")
    radius: Length = Field(default=0.05, description="Radius of its disc.")
    pinned: bool = Field(default=False, description="Whether it stays where it is.")
    gravity_scale: GravityScale = 1.0
    friction: Friction = None
    restitution: Restitution = None
    collides: Collides = True
    collision_group: CollisionGroup = None
    rolls: bool = Field(
        default=True,
        description="Whether friction turns its disc while no spring and no pin holds it. If not, it slides.",
    )
    rolling: Rolling = ROLLING_RESISTANCE
    angle: Angle = Field(default=0.0, description="How far its disc has turned at the start. It is only shown.")
    spin: TurnRate = Field(
        default=0.0, description="How fast its disc turns at the start; counter-clockwise is positive."
    )
    group: Group = None
    look: ParticleLook | None = Field(default=None, description="How it looks.", json_schema_extra=empty("automatic"))
    extras: Extras = Field(default_factory=dict)


class SpringDef(Description):
    """A loose spring between two particles of the level. `:k` is spring k of the list, counted from 0."""

    a: Name = Field(description="One end: `id`, `id.k`, or a name such as `id.start`.")
    b: Name = Field(description="The other end.")
    name: Name | None = Field(
        default=None, description="Its name in the window.", json_schema_extra=empty("its number")
    )
    rest_length: Length | None = Field(
        default=None,
        description="Rest length. Left out of a hydraulic, it is the hydraulic's `shortest`.",
        json_schema_extra=empty("as placed"),
    )
    material: Name = Field(default=DEFAULT_MATERIAL, description="Name of its material.")
    drive: MuscleDef | None = Field(default=None, description="Makes a muscle of it.", json_schema_extra=empty("none"))
    hydraulic: HydraulicDef | None = Field(
        default=None, description="Makes a hydraulic of it.", json_schema_extra=empty("none")
    )
    group: Group = None
    extras: Extras = Field(default_factory=dict)

    @property
    def given_length(self) -> float | None:
        """Rest length [m] of the file; None = as placed."""
        if self.rest_length is None and self.hydraulic is not None:
            return self.hydraulic.shortest
        return self.rest_length


class ContactsDef(Description):
    """Lets things touch each other. Bodies, particles, walls and terrain may have other values of their own."""

    friction: FrictionCoefficient = Field(default=0.5, description="Friction of a surface.")
    restitution: Share = Field(
        default=0.0,
        description="Share of its speed that a thing keeps when it bounces. A loose disc keeps just that. Of a body, "
        "springs take what they damp: with 1, a box of 4 cells across that falls flat rises to all of its height if Cs "
        "and Cd are 1, to 0.76 of it at Cs 0.9 and Cd 0.99, to 0.01 at Cs 0.5 and Cd 0.9.",
    )


class WallsDef(Description):
    """Four walls around the level. Nothing leaves them."""

    box: tuple[Coordinate, Coordinate, Coordinate, Coordinate] = Field(
        description="Left, bottom, right, top of the room.", json_schema_extra=unit("m")
    )
    friction: Friction = None
    restitution: Restitution = None


class TerrainDef(Description):
    """A piece of terrain, which never moves: a line with two sides, or a solid polygon."""

    id: Id = Field(description="Name of the piece. No other piece, body or particle has it.")
    polyline: Corners | None = Field(
        default=None,
        description="Corners of a line, in order. A piece has this or `polygon`.",
        json_schema_extra=empty("none"),
    )
    polygon: Corners | None = Field(
        default=None,
        description="Corners of a solid shape, in order. Sides may not touch or cross.",
        json_schema_extra=empty("none"),
    )
    friction: Friction = None
    restitution: Restitution = None
    belt: Belt = 0.0
    group: Group = None
    extras: Extras = Field(default_factory=dict)


class WaterDef(Description):
    """Water in a zone: it lifts what is in it and slows it down. Its surface is the top of the zone."""

    density: float = Field(
        default=10.0,
        gt=0.0,
        le=WATER_DENSITY_LIMIT,
        description="Mass of the water in a square metre. What has less floats.",
        json_schema_extra=unit("kg/m^2"),
    )
    fast_drag: float = Field(
        default=1.0,
        ge=0.0,
        le=WATER_DRAG_LIMIT,
        description="Drag that grows with the square of the speed: a coefficient C, for a flat plate about 1. A side "
        "that moves at u m/s across itself takes C/4 density u^2 per metre.",
    )
    slow_drag: float = Field(
        default=0.5,
        ge=0.0,
        le=WATER_DRAG_LIMIT,
        description="Drag that grows with the speed: a side takes slow_drag density u per metre, whichever way it "
        "moves. It brings to rest what floats.",
        json_schema_extra=unit("m/s"),
    )
    flow: Velocity = Field(default=(0.0, 0.0), description="Velocity of the water. It acts only through drag.")


class ZoneDef(Description):
    """A part of the plane with a name: a box, a circle or a polygon. It is not solid."""

    id: Id = Field(description="Name of the zone. No other zone, piece of terrain, body or particle has it.")
    box: tuple[Coordinate, Coordinate, Coordinate, Coordinate] | None = Field(
        default=None,
        description="Left, bottom, right, top. A zone has this, `circle` or `polygon`.",
        json_schema_extra=unit("m") | empty("none"),
    )
    circle: tuple[Coordinate, Coordinate, Size] | None = Field(
        default=None, description="Place of its centre, and its radius.", json_schema_extra=unit("m") | empty("none")
    )
    polygon: Annotated[tuple[Point, ...], Field(min_length=3, max_length=CORNER_LIMIT)] | None = Field(
        default=None,
        description="Corners in order. Sides may not touch or cross.",
        json_schema_extra=empty("none"),
    )
    water: WaterDef | None = Field(
        default=None,
        description="Water in it; the zone is a box then. What has less kg/m^2 than the water floats.",
        json_schema_extra=empty("none"),
    )
    look: ZoneLook | None = Field(default=None, description="How it looks.", json_schema_extra=empty("automatic"))
    extras: Extras = Field(default_factory=dict)


class Level(Description):
    """A level: its author, its settings, and all things in it."""

    model_config = ConfigDict(serialize_by_alias=True)
    # The plan that its check made, for building its world. It is no field: not written, compared or copied.
    # So are the name of the file that it was read from, its rules as a run has them, and of settings that are not as in
    # the file.
    __slots__ = ("_file", "_plan", "_run_rules", "_run_with")

    schema_link: Line | None = Field(
        default=None,
        alias="$schema",
        description="Address of the schema, for editors that complete keys. The program keeps it and ignores it.",
        json_schema_extra=empty("none"),
    )
    format: Literal["spring-sandbox/level"] = Field(description="Says that the file is a level.")
    version: int = Field(description="Version of the format.", json_schema_extra={"const": VERSION})
    name: Name = Field(description="Title that the gallery shows.")
    description: Text = Field(
        default="",
        description="What it shows and what to try. Names in braces stand for controls, see [Hints](#hints).",
    )
    goal: Line = Field(default="", description='What wins it, in one line for players: "Bring the ball home".')
    author: Line = Field(default="", description="Who made it.")
    licence: Line = Field(default="", description='Licence, by its SPDX name: "CC0-1.0".')
    tags: tuple[Line, ...] = Field(default=(), max_length=TAG_LIMIT, description="Words to find it by.")
    settings: Settings = Field(default=Settings(), description="How time passes.")
    view: tuple[Coordinate, Coordinate, Coordinate, Coordinate] | None = Field(
        default=None,
        description="What the camera shows at first: left, bottom, right, top. These are no walls.",
        json_schema_extra=unit("m") | empty("everything"),
    )
    materials: dict[Name, Material] = Field(default={}, max_length=MATERIAL_LIMIT, description="Materials by name.")
    contacts: ContactsDef | None = Field(
        default=None,
        description="Lets things touch. A level with terrain or walls has the default contacts.",
        json_schema_extra=empty("nothing touches"),
    )
    walls: WallsDef | None = Field(
        default=None, description="Four walls around the level.", json_schema_extra=empty("none")
    )
    terrain: tuple[TerrainDef, ...] = Field(default=(), description="Lines and solid shapes that never move.")
    zones: tuple[ZoneDef, ...] = Field(default=(), description="Parts of the plane with a name, some with water.")
    bodies: tuple[AnyBody, ...] = Field(default=(), description="Bodies, in the order of their particles and springs.")
    particles: tuple[ParticleDef, ...] = Field(default=(), description="Loose particles, after those of the bodies.")
    springs: tuple[SpringDef, ...] = Field(default=(), description="Loose springs, after those of the bodies.")
    welds: tuple[tuple[Name, Name], ...] = Field(
        default=(),
        description="Pairs of particles that become one. Its mass is the sum, its place that of the first in "
        "generation order, and both names find it.",
    )
    counters: tuple[CounterDef, ...] = Field(
        default=(), max_length=RULE_LIMIT, description="Numbers that rules change and ask for."
    )
    rules: tuple[RuleDef, ...] = Field(
        default=(), max_length=RULE_LIMIT, description="What the level asks while it runs, and what it does then."
    )
    hands: PlayerLimits | None = Field(
        default=None, description="What hands may do while it runs.", json_schema_extra=empty("everything")
    )
    checks: tuple[CheckDef, ...] = Field(
        default=(), max_length=CHECK_LIMIT, description="What the level promises about its own run."
    )
    look: LevelLook | None = Field(default=None, description="How it looks.", json_schema_extra=empty("automatic"))
    extras: Extras = Field(default_factory=dict)

    @property
    def has_contacts(self) -> bool:
        """Whether things in the level touch."""
        return self.contacts is not None or self.walls is not None or bool(self.terrain)

    @property
    def has_goal(self) -> bool:
        """Whether a rule of the level wins it."""
        return any(action.win is not None for rule in self.rules for action in rule.then)

    @property
    def leaves_all_open(self) -> bool:
        """Whether it has a goal and lets hands do everything: then whoever puts things where they win has won."""
        return self.has_goal and (self.hands is None or self.hands.may is None)

    @property
    def has_water(self) -> bool:
        """Whether there is water in the level."""
        return any(zone.water is not None for zone in self.zones)

    @property
    def counter_names(self) -> tuple[str, ...]:
        """The names of counters, in the order of a world: its own, and what hands have left of each budget."""
        return (*(each.id for each in self.counters), *(() if self.hands is None else self.hands.counter_names))

    def material(self, name: str) -> "Material | None":
        """The material of that name, the default one even where the level does not list it; None: there is none."""
        return self.materials.get(name, NissenMaterial() if name == DEFAULT_MATERIAL else None)

    @field_validator("version")
    @classmethod
    def _known(cls, version: int) -> int:
        if version == VERSION:
            return version
        raise ValueError(version_fault(version))


def version_fault(version: int) -> str:
    """The fault of a level of another version than the present one."""
    known = f"this program reads version {VERSION} of the format"
    return f"made by a newer program; {known}, update it" if version > VERSION else known


def keys_of(model: type[BaseModel]) -> list[str]:
    """The keys of a model's object in a file, in order."""
    return [field.alias or name for name, field in model.model_fields.items()]


LEVEL_KEYS = keys_of(Level)
# Settings that a person may change while a world runs: all but the tick rate, which belongs to the whole run.
CHANGEABLE_SETTINGS = tuple(name for name in Settings.model_fields if name != "tick_rate")
