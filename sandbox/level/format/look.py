"""Models of looks of levels, bodies, materials, particles and zones; names of skins, lines, balls and colours.

Physics, hashes and recordings ignore looks.
"""

from typing import Annotated, Literal

from pydantic import Field

from sandbox.level.format.limits import BODY_RADIUS
from sandbox.level.format.picture import PICTURE_LIMIT, SIDE_LIMIT, PictureName
from sandbox.level.format.quantities import Description, Id, Index, Line, Name, empty

# Names of skins, lines, balls and grounds. A name that is not listed counts as automatic.
SKINS = ("jelly", "rubber", "balloon", "wood", "stone", "brick", "cloth", "plain", "lattice")
LINES = (
    "steel", "paint", "brass", "rope", "cable", "chain", "deck", "wood", "rubber", "thread", "silk", "coil", "bone",
    "muscle", "hidden",
)  # fmt: skip
BALLS = ("marble", "stripe", "steel", "sand", "bumper", "plain")
GROUNDS = ("soil", "rock", "metal", "wood", "glass")
# Automatic colours, in this order; neighbours differ in lightness too.
PALETTE = {
    "raspberry": 0xF2557B, "lemon": 0xFFD24A, "sky": 0x4DB3FF, "tangerine": 0xFF9142, "grape": 0x9B7BFF,
    "lime": 0x8EDB6B, "bubblegum": 0xFF9BD2, "lagoon": 0x2FC4B2,
}  # fmt: skip


COLOUR_PATTERN = rf"^({'|'.join(PALETTE)}|#[0-9A-Fa-f]{{6}})$"
ColourName = Annotated[str, Field(pattern=COLOUR_PATTERN, json_schema_extra={"examples": [*PALETTE]})]
SkinName = Annotated[Line, Field(json_schema_extra={"examples": [*SKINS]})]
LineName = Annotated[Line, Field(json_schema_extra={"examples": [*LINES]})]
BallName = Annotated[Line, Field(json_schema_extra={"examples": [*BALLS]})]
GroundName = Annotated[Line, Field(json_schema_extra={"examples": [*GROUNDS]})]
OwnColour = Annotated[
    ColourName | None,
    Field(description='Colour: a name of the palette, or "#RRGGBB".', json_schema_extra=empty("automatic")),
]


def colour_of(name: str) -> int:
    """A colour of the format as 0xRRGGBB."""
    return PALETTE[name] if name in PALETTE else int(name[1:], 16)


class LevelLook(Description):
    """How a level looks."""

    theme: Literal["dark", "light"] | None = Field(
        default=None, description="Theme that it is drawn in.", json_schema_extra=empty("the player's")
    )
    ground: dict[Line, GroundName] = Field(
        default={},
        max_length=1_000,
        description="What pieces of terrain are made of, by their ids: a name of a ground.",
    )
    faces: bool | None = Field(
        default=None,
        description="Whether jellies have faces; automatic: in levels of at most 16 bodies.",
        json_schema_extra=empty("automatic"),
    )
    material: Name | None = Field(
        default=None,
        description="Material that the panel shows first.",
        json_schema_extra=empty("of most springs"),
    )
    follow: Id | None = Field(
        default=None,
        description="Body or loose particle that the camera follows.",
        json_schema_extra=empty("none"),
    )


class BodyLook(Description):
    """How a body looks, or every body and spring of a material."""

    skin: SkinName | None = Field(
        default=None, description="What it is filled with: a name of a skin.", json_schema_extra=empty("automatic")
    )
    picture: PictureName | None = Field(
        default=None,
        description="Name of a PNG beside the level's file, which a jelly, a mesh of triangles, a ring or a wheel "
        "wears: stretched over its form, cut to its outline. Where the picture is transparent, the colour shows. At "
        f"most {PICTURE_LIMIT // 1024 // 1024} MiB and {SIDE_LIMIT:,} pixels a side.",
        json_schema_extra=empty("none"),
    )
    line: LineName | None = Field(
        default=None,
        description="What its springs are drawn as: a name of a line.",
        json_schema_extra=empty("automatic"),
    )
    colour: OwnColour = None
    face: bool | None = Field(default=None, description="Whether it has a face.", json_schema_extra=empty("automatic"))
    width: float = Field(
        default=1.0, ge=0.1, le=10.0, description="Width of its lines, as a multiple of the usual width."
    )
    panel: ColourName | None = Field(
        default=None,
        description="Colour of a panel that covers the inside of its outline.",
        json_schema_extra=empty("none"),
    )
    window: tuple[Index, ...] = Field(
        default=(), max_length=64, description="Corners of a window in the panel: particles, by index."
    )


class ParticleLook(Description):
    """How a loose particle looks."""

    ball: BallName | None = Field(
        default=None, description="What it is drawn as: a name of a ball.", json_schema_extra=empty("automatic")
    )
    colour: OwnColour = None


class ZoneLook(Description):
    """How a zone looks."""

    colour: OwnColour = None


def look_when_added(number: int, radius: float) -> ParticleLook:
    """How a loose particle of a radius [m] looks that was added to a run, the number-th of those that are there."""
    colours = list(PALETTE)
    return ParticleLook(
        ball="stripe" if radius > 2.0 * BODY_RADIUS else "marble", colour=colours[number % len(colours)]
    )
