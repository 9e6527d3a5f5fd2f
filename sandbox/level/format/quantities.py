"""Types of the level format's values: numbers with unit and range, names, texts, and the base of every model."""

from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from sandbox.level.format.limits import (
    AMPLITUDE_LIMIT,
    ANGLE_LIMIT,
    BELT_LIMIT,
    COORDINATE_LIMIT,
    CORNER_LIMIT,
    DRAG_LIMIT,
    FORCE_LIMIT,
    FREQUENCY_RANGE,
    FRICTION_LIMIT,
    GRAVITY_LIMIT,
    GRAVITY_SCALE_LIMIT,
    HOOKE_LIMIT,
    INFLATION_LIMIT,
    MASS_RANGE,
    PERIOD_RANGE,
    RATE_LIMIT,
    RATIO_LIMIT,
    SAG_LIMIT,
    SECONDS_LIMIT,
    SPACING_RANGE,
    SPEED_LIMIT,
    STRAIN_LIMIT,
    TEXT_LIMIT,
    TORQUE_LIMIT,
    TURN_LIMIT,
    YIELD_RANGE,
    YIELD_SHARE_LIMIT,
)
from sandbox.physics.commands.command import MOST_ITERATIONS


def unit(name: str) -> dict[str, Any]:
    """The schema entry for the unit of a field."""
    return {"unit": name}


def empty(words: str) -> dict[str, Any]:
    """The schema entry for what null means, in a few words that fit into a text field."""
    return {"empty": words}


class Description(BaseModel):
    """Base of all models: strict types, frozen, no unknown keys, finite numbers."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)


def significant(value: float, digits: int) -> float:
    """A number rounded to a number of significant digits."""
    return float(f"{value:.{digits}g}")


Described = TypeVar("Described", bound=Description)

# Looked up once: a copy costs little more than these calls.
_new = object.__new__
_set_fields, _set_given, _set_extra, _set_private = (
    BaseModel.__dict__[name].__set__
    for name in ("__dict__", "__pydantic_fields_set__", "__pydantic_extra__", "__pydantic_private__")
)


def replaced(item: Described, **changes: Any) -> Described:
    """A copy of a description with other values of some fields, which are NOT validated.

    For edits of thousands of items, by code that checks types, ranges and field names itself. It takes under 1 us, less
    than half of `model_copy`. Both share their values, which are immutable, except `extras`, which nobody changes.
    """
    copy = _new(type(item))
    _set_fields(copy, item.__dict__ | changes)
    # Nobody asks which fields were given, so the copy shares the item's set.
    _set_given(copy, item.__pydantic_fields_set__)
    _set_extra(copy, None)
    _set_private(copy, None)
    return copy


# Control characters would break one-line messages; a description alone may hold line breaks.
LINE_PATTERN = r"^[^\x00-\x1f\x7f-\x9f]*$"
TEXT_PATTERN = r"^[^\x00-\x08\x0b-\x1f\x7f-\x9f]*$"
# `.`, `:` and `,` build names of particles and springs; `+` begins the names of what is added while playing.
ID_PATTERN = r"^[^+.:,\x00-\x1f\x7f-\x9f][^.:,\x00-\x1f\x7f-\x9f]*$"
# Keys of a keyboard that every layout has unshifted, and the arrows.
ARROW_KEYS = ("left", "right", "up", "down")
KEY_PATTERN = rf"^([a-z0-9]|{'|'.join(ARROW_KEYS)})$"

Id = Annotated[str, Field(min_length=1, max_length=TEXT_LIMIT, pattern=ID_PATTERN)]
Line = Annotated[str, Field(max_length=TEXT_LIMIT, pattern=LINE_PATTERN)]
Name = Annotated[str, Field(min_length=1, max_length=TEXT_LIMIT, pattern=LINE_PATTERN)]
Text = Annotated[str, Field(max_length=TEXT_LIMIT, pattern=TEXT_PATTERN)]

Coordinate = Annotated[float, Field(ge=-COORDINATE_LIMIT, le=COORDINATE_LIMIT)]
Point = Annotated[tuple[Coordinate, Coordinate], Field(json_schema_extra=unit("m"))]
Speed = Annotated[float, Field(ge=-SPEED_LIMIT, le=SPEED_LIMIT)]
Velocity = Annotated[tuple[Speed, Speed], Field(json_schema_extra=unit("m/s"))]
Acceleration = Annotated[float, Field(ge=-GRAVITY_LIMIT, le=GRAVITY_LIMIT)]
Gravity = Annotated[tuple[Acceleration, Acceleration], Field(json_schema_extra=unit("m/s^2"))]
Mass = Annotated[float, Field(ge=MASS_RANGE[0], le=MASS_RANGE[1], json_schema_extra=unit("kg"))]
Length = Annotated[float, Field(ge=0.0, le=COORDINATE_LIMIT, json_schema_extra=unit("m"))]
Size = Annotated[float, Field(gt=0.0, le=COORDINATE_LIMIT, json_schema_extra=unit("m"))]
Spacing = Annotated[float, Field(ge=SPACING_RANGE[0], le=SPACING_RANGE[1], json_schema_extra=unit("m"))]
Angle = Annotated[float, Field(ge=-ANGLE_LIMIT, le=ANGLE_LIMIT, json_schema_extra=unit("rad"))]
Coefficient = Annotated[float, Field(ge=0.0, le=1.0, json_schema_extra=unit("per tick"))]
Inflation = Annotated[float, Field(ge=0.0, le=INFLATION_LIMIT)]
HookeStiffness = Annotated[float, Field(ge=0.0, le=HOOKE_LIMIT, json_schema_extra=unit("N/m"))]
HookeDamping = Annotated[float, Field(ge=0.0, le=HOOKE_LIMIT, json_schema_extra=unit("N s/m"))]
Drag = Annotated[float, Field(ge=0.0, le=DRAG_LIMIT, json_schema_extra=unit("1/s"))]
GravityScale = Annotated[
    float,
    Field(
        ge=-GRAVITY_SCALE_LIMIT,
        le=GRAVITY_SCALE_LIMIT,
        description="Factor of gravity for its particles: 0 floats, a negative value rises.",
    ),
]
Sag = Annotated[float, Field(ge=0.0, le=SAG_LIMIT)]
Frequency = Annotated[float, Field(ge=FREQUENCY_RANGE[0], le=FREQUENCY_RANGE[1])]
DampingRatio = Annotated[float, Field(ge=0.0, le=RATIO_LIMIT)]
Drive = Annotated[float, Field(ge=-1.0, le=1.0)]
TickRate = Annotated[int, Field(ge=1, le=10_000, json_schema_extra=unit("1/s"))]
Iterations = Annotated[int, Field(ge=1, le=MOST_ITERATIONS)]
Tension = Annotated[float, Field(gt=0.0, le=STRAIN_LIMIT)]
Compression = Annotated[float, Field(gt=0.0, le=1.0)]
YieldStrain = Annotated[float, Field(ge=YIELD_RANGE[0], le=YIELD_RANGE[1])]
YieldShare = Annotated[float, Field(ge=0.0, le=YIELD_SHARE_LIMIT)]
Amplitude = Annotated[float, Field(ge=0.0, le=AMPLITUDE_LIMIT)]
Period = Annotated[int, Field(ge=PERIOD_RANGE[0], le=PERIOD_RANGE[1], json_schema_extra=unit("ticks"))]
Phase = Annotated[float, Field(ge=0.0, le=1.0)]
TurnRate = Annotated[float, Field(ge=-TURN_LIMIT, le=TURN_LIMIT, json_schema_extra=unit("rad/s"))]
Torque = Annotated[float, Field(ge=0.0, le=TORQUE_LIMIT, json_schema_extra=unit("N m"))]
Force = Annotated[float, Field(gt=0.0, le=FORCE_LIMIT, json_schema_extra=unit("N"))]
Rate = Annotated[float, Field(ge=0.0, le=RATE_LIMIT, json_schema_extra=unit("m/s"))]
Key = Annotated[str, Field(pattern=KEY_PATTERN)]
Seconds = Annotated[float, Field(ge=0.0, le=SECONDS_LIMIT, json_schema_extra=unit("s"))]
Index = Annotated[int, Field(ge=0)]
# pydantic would copy a default of {} deeply for each item, and a factory does not appear in the schema.
Extras = Annotated[
    dict[str, Any],
    Field(description="Data of other tools. The program keeps it and ignores it.", json_schema_extra={"default": {}}),
]
Group = Annotated[
    Name | None,
    Field(
        description="Group: the editor selects and moves its members together, and rules may name it.",
        json_schema_extra=empty("none"),
    ),
]
Corners = Annotated[tuple[Point, ...], Field(min_length=2, max_length=CORNER_LIMIT)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
FrictionCoefficient = Annotated[float, Field(ge=0.0, le=FRICTION_LIMIT)]
Rolling = Annotated[
    Share,
    Field(
        description="Rolling resistance: the torque that slows its turning, divided by its radius times the force that "
        "presses it on. Of two discs the larger value counts."
    ),
]


def _groups(value: Any) -> Any:
    # This comes before the type check: for a choice of types, the library would list a fault for each.
    if isinstance(value, bool):
        return value
    if isinstance(value, list | tuple) and all(isinstance(name, str) for name in value):
        return tuple(value)
    raise ValueError("use true, false or a list of groups")


Collides = Annotated[
    bool | tuple[Name, ...],
    BeforeValidator(_groups),
    Field(description="What it touches if the level has contacts: everything, nothing, or these collision groups."),
]
CollisionGroup = Annotated[
    Name | None,
    Field(
        description="Collision group that it is in; others name it in `collides`.", json_schema_extra=empty("default")
    ),
]
Friction = Annotated[
    FrictionCoefficient | None,
    Field(description="Friction of its surface.", json_schema_extra=empty("the level's")),
]
Belt = Annotated[
    float,
    Field(
        ge=-BELT_LIMIT,
        le=BELT_LIMIT,
        description="How fast its surface runs, as that of a conveyor belt, to the right of who stands on it. Friction "
        "carries along what touches it.",
        json_schema_extra=unit("m/s"),
    ),
]
Restitution = Annotated[
    Share | None,
    Field(
        description="Share of its speed that it keeps when it bounces, but for what springs of a body damp, see "
        "`contacts`.",
        json_schema_extra=empty("the level's"),
    ),
]
