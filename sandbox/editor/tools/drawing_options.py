"""What a drawing tool can be told before and while it draws; remembered from one drawing to the next."""

import math
from dataclasses import dataclass, field, fields
from dataclasses import replace as _replace
from typing import Any, Literal, TypeVar

from sandbox.editor.document import EditError
from sandbox.level.format.limits import (
    COORDINATE_LIMIT,
    DEFAULT_MATERIAL,
    FRICTION_LIMIT,
    INFLATION_LIMIT,
    MASS_RANGE,
    PARTICLE_LIMIT,
)

Kind = Literal["count", "number", "flag", "material"]

# Steps of a value that can be negative; others go up by 1, 2, 5, 10, 20, ...
SIGNED_STEP = 0.05

# Slack of a rope: how much longer it is than the way from end to end, as a part of that.
SLACK_RANGE = (-0.5, 4.0)


@dataclass(frozen=True)
class About:
    """What a person is told of an option: kind, label, tooltip, unit, and least and most value (both included).

    optional: None is a value too, "choose one that fits the size".
    """

    kind: Kind
    label: str
    text: str
    unit: str = ""
    least: float = 0.0
    most: float = COORDINATE_LIMIT
    optional: bool = False


def _option(default: Any, about: About) -> Any:
    return field(default=default, metadata={"about": about})


def _count(label: str, text: str, least: int, default: int | None = None) -> Any:
    return _option(default, About("count", label, text, "", least, PARTICLE_LIMIT, optional=default is None))


def _mass(default: float | None, label: str = "mass", text: str = "Mass of each particle.") -> Any:
    return _option(default, About("number", label, text, "kg", *MASS_RANGE, optional=default is None))


def _size(label: str, text: str) -> Any:
    return _option(None, About("number", label, text, "m", 1e-6, optional=True))


def _surface(label: str, text: str, most: float) -> Any:
    return _option(None, About("number", label, text, "", 0.0, most, optional=True))


def _flag(default: bool, label: str, text: str) -> Any:
    return _option(default, About("flag", label, text))


def _material(default: str = DEFAULT_MATERIAL) -> Any:
    return _option(default, About("material", "material", "Material of the springs."))


@dataclass(frozen=True)
class PinOptions:
    """A pin has none."""


@dataclass(frozen=True)
class ParticleOptions:
    """A loose particle."""

    mass: float = _mass(1.0, text="Mass.")
    radius: float = _option(0.05, About("number", "radius", "Radius of the drawn disc.", "m"))
    pinned: bool = _flag(False, "pinned", "Hold it where it is.")


@dataclass(frozen=True)
class SpringOptions:
    """A loose spring, and the particles that it gets where it ends at none."""

    material: str = _material()
    mass: float = _mass(1.0, text="Mass of the particle that an end in empty space gets.")


@dataclass(frozen=True)
class RopeOptions:
    """A rope; segments None: links of about 0.25 m."""

    segments: int | None = _count("links", "Number of links; empty = links of about 0.25 m.", 1)
    slack: float = _option(
        0.0,
        About("number", "slack", "How much longer it is than the way from end to end, 0.1 = 10 %.", "", *SLACK_RANGE),
    )
    particle_mass: float = _mass(1.0)
    end_mass: float | None = _mass(None, "end mass", "Mass of the last particle; empty = as the others.")
    material: str = _material("steel")
    pin_start: bool = _flag(True, "pin start", "Hold the start, unless it joins a particle.")
    pin_end: bool = _flag(False, "pin end", "Hold the end, unless it joins a particle.")


@dataclass(frozen=True)
class TrussOptions:
    """A bridge or a girder; segments None: cells of about 0.5 m, height None: as fits the cells."""

    segments: int | None = _count("cells", "Number of cells; empty = cells of about 0.5 m.", 1)
    height: float | None = _size("height", "Height; empty = square or equilateral cells.")
    particle_mass: float = _mass(1.0)
    material: str = _material("steel")
    pin_start: bool = _flag(True, "pin start", "Hold the start, unless it joins a particle.")
    pin_end: bool = _flag(True, "pin end", "Hold the end, unless it joins a particle.")


@dataclass(frozen=True)
class WebOptions:
    """A web; rings None: rings of about 0.25 m."""

    spokes: int = _count("spokes", "Number of spokes.", 3, 12)
    rings: int | None = _count("rings", "Number of rings; empty = about 0.25 m apart.", 1)
    particle_mass: float = _mass(0.1)
    material: str = _material("rubber")
    pin_rim: bool = _flag(True, "pin rim", "Hold the outermost ring.")


@dataclass(frozen=True)
class WheelOptions:
    """A wheel; segments None: about 0.5 m of rim each, thickness None: a quarter of the radius."""

    segments: int | None = _count("spokes", "Number of spokes; empty = about 0.5 m of rim each.", 3)
    thickness: float | None = _size("thickness", "Thickness of the rim; empty = a quarter of the radius.")
    particle_mass: float = _mass(1.0)
    hub_mass: float | None = _mass(None, "hub mass", "Mass of the hub; empty = as the others.")
    material: str = _material("rubber")
    pin_hub: bool = _flag(False, "pin hub", "Hold the hub, unless it joins a particle.")


@dataclass(frozen=True)
class RingOptions:
    """A ring; segments None: about 0.25 m each."""

    segments: int | None = _count("parts", "Number of parts; empty = about 0.25 m each.", 3)
    inflation: float | None = _option(
        1.2,
        About("number", "inflation", "Area that it wants, times its own; empty = it holds nothing.", "", 0.0,
              INFLATION_LIMIT, optional=True),
    )  # fmt: skip
    particle_mass: float = _mass(0.1)
    material: str = _material("rubber")


@dataclass(frozen=True)
class JellyOptions:
    """A jelly of any shape; cells None: 8 across, fewer where it is long and thin."""

    cells: int | None = _count("cells", "Cells across the shorter side; empty = 8, fewer in long shapes.", 1)
    particle_mass: float = _mass(0.1)
    material: str = _material("jelly")


@dataclass(frozen=True)
class SurfaceOptions:
    """Terrain or walls; None: friction and restitution of the level's contacts."""

    friction: float | None = _surface("friction", "Friction of its surface; empty = the level's.", FRICTION_LIMIT)
    restitution: float | None = _surface("bounce", "Share of its speed that bounces; empty = the level's.", 1.0)


Options = (
    SurfaceOptions
    | PinOptions
    | ParticleOptions
    | SpringOptions
    | RopeOptions
    | TrussOptions
    | WebOptions
    | WheelOptions
    | RingOptions
    | JellyOptions
)
AnyOptions = TypeVar("AnyOptions", bound=Options)


def described(options: Options) -> dict[str, About]:
    """What a person is told of each option, by its name, in order."""
    return {each.name: each.metadata["about"] for each in fields(options)}


def changed(options: AnyOptions, name: str, value: Any) -> AnyOptions:
    """The options with another value of one of them. Raises EditError with a line for the person."""
    about = described(options)[name]
    if value is None and not about.optional:
        raise EditError(f"{about.label}: give a value")
    if value is not None and about.kind in ("count", "number"):
        if isinstance(value, bool) or not isinstance(value, int if about.kind == "count" else int | float):
            raise EditError(f"{about.label}: give a {'whole ' if about.kind == 'count' else ''}number")
        if not about.least <= value <= about.most:
            raise EditError(f"{about.label}: {value:g} is not in {about.least:g}..{about.most:g} {about.unit}".rstrip())
        value = value if about.kind == "count" else float(value)
    return _replace(options, **{name: value})


def stepped(about: About, value: float | None, by: int) -> float:
    """The value one step up or down from another, within its limits: 1, 2, 5, 10, ... or, of counts, the next.

    None steps to the least count, or to 1.
    """
    if value is None:
        wanted = about.least if about.kind == "count" else 1.0
    elif about.kind == "count":
        return int(min(max(value + by, about.least), about.most))
    elif about.least < 0.0:
        wanted = round((round(value / SIGNED_STEP) + by) * SIGNED_STEP, 9)
    elif value <= 0.0:
        wanted = 1.0
    else:
        decade = math.floor(math.log10(value))
        steps = [float(f"{digit}e{decade + up}") for up in (-1, 0, 1) for digit in (1, 2, 5)]
        beyond = [step for step in steps if (step > value if by > 0 else step < value)]
        wanted = beyond[0] if by > 0 else beyond[-1]
    return min(max(wanted, about.least), about.most)
