"""Types of the level format's values: numbers with unit and range, names, texts, and the base of every model."""

from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field

from sandbox.level.limits import (
    ANGLE_LIMIT,
    COORDINATE_LIMIT,
    GRAVITY_LIMIT,
    HOOKE_LIMIT,
    INFLATION_LIMIT,
    MASS_RANGE,
    SECONDS_LIMIT,
    SPACING_RANGE,
    SPEED_LIMIT,
    TEXT_LIMIT,
)


def unit(name: str) -> dict[str, Any]:
    """What a field adds to the schema for its unit."""
    return {"unit": name}


class Description(BaseModel):
    """Base of all models: strict types, frozen, no unknown keys, finite numbers."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


Described = TypeVar("Described", bound=Description)

# Looked up once: a copy costs little more than these calls.
_new, _set = object.__new__, object.__setattr__


def replaced(item: Described, **changes: Any) -> Described:
    """A copy of a description with other values of some fields, which are NOT validated.

    For edits of thousands of items at once by code that has checked types, ranges and field names itself: under 1 us
    each, less than half of `model_copy`. What the two share is immutable, but for `extras`, which nobody changes.
    """
    copy = _new(type(item))
    _set(copy, "__dict__", {**item.__dict__, **changes})
    # Which fields were given is of no interest anywhere, so the copy shares the item's.
    _set(copy, "__pydantic_fields_set__", item.__pydantic_fields_set__)
    _set(copy, "__pydantic_extra__", None)
    _set(copy, "__pydantic_private__", None)
    return copy


# Control characters would break one-line messages; a description alone may hold line breaks.
LINE_PATTERN = r"^[^\x00-\x1f\x7f-\x9f]*$"
TEXT_PATTERN = r"^[^\x00-\x08\x0b-\x1f\x7f-\x9f]*$"
# `.`, `:` and `,` build names of particles and springs; `+` begins the names of what is added while playing.
ID_PATTERN = r"^[^+.:,\x00-\x1f\x7f-\x9f][^.:,\x00-\x1f\x7f-\x9f]*$"

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
Seconds = Annotated[float, Field(ge=0.0, le=SECONDS_LIMIT, json_schema_extra=unit("s"))]
Index = Annotated[int, Field(ge=0)]
Extras = Annotated[dict[str, Any], Field(description="Data of other tools; kept and ignored.")]
Group = Annotated[Name | None, Field(description="Group that it is selected and moved with in the editor.")]
