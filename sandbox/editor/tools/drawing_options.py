"""What a drawing tool can be told before and while it draws; remembered from one drawing to the next."""

import math
from dataclasses import dataclass, field, fields
from dataclasses import replace as _replace
from typing import Any, Literal, TypeVar

from sandbox.editor.document import EditError
from sandbox.level.format.limits import (
    COORDINATE_LIMIT,
    DEFAULT_MATERIAL,
    MASS_RANGE,
    PARTICLE_LIMIT,
    SAG_LIMIT,
)

Kind = Literal["count", "number", "flag", "material"]

# Steps of a value that can be negative; others go up by 1, 2, 5, 10, 20, ...
SIGNED_STEP = 0.05


@dataclass(frozen=True)
class OptionInfo:
    """What a person is told of an option: kind, label, tooltip, unit, and least and most value (both included).

    optional: None is a value too, "choose one that fits the size"; empty: a word that stands in an empty field.
    """

    kind: Kind
    label: str
    text: str
    unit: str = ""
    least: float = 0.0
    most: float = COORDINATE_LIMIT
    optional: bool = False
    empty: str = "auto"


def option(default: Any, about: OptionInfo) -> Any:
    """A field of options with its label, limits and tooltip."""
    return field(default=default, metadata={"about": about})


def count_option(label: str, text: str, least: int, default: int | None = None) -> Any:
    """A number of parts; None: as many as fit the size."""
    return option(default, OptionInfo("count", label, text, "", least, PARTICLE_LIMIT, optional=default is None))


def mass_option(default: float | None, label: str = "mass", text: str = "Mass of each particle.") -> Any:
    """A mass [kg]; None: as the others."""
    return option(default, OptionInfo("number", label, text, "kg", *MASS_RANGE, optional=default is None, empty="same"))


def sag_option(default: float | None) -> Any:
    """A sag [%] by which a body is as soft as a whole; None: as soft as its material makes it."""
    text = "How far it sags under its weight, in % of its height; empty = as its material makes it."
    about = OptionInfo("number", "sag", text, "%", 0.0, 100.0 * SAG_LIMIT, optional=True, empty="material")
    return option(default, about)


def size_option(label: str, text: str) -> Any:
    """A length [m] that may be left to the drawing."""
    return option(None, OptionInfo("number", label, text, "m", 1e-6, optional=True))


def flag_option(default: bool, label: str, text: str) -> Any:
    """Yes or no."""
    return option(default, OptionInfo("flag", label, text))


def material_option(default: str = DEFAULT_MATERIAL) -> Any:
    """The material of the springs."""
    return option(default, OptionInfo("material", "material", "Material of the springs."))


@dataclass(frozen=True)
class Options:
    """Base of the options of every tool."""


class BodyOptions(Options):
    """Options of a tool that draws a body: each has these among its own, in its own order."""

    particle_mass: float
    material: str
    # Of those that have a firmness, in per cent.
    sag: float | None = None


class LineOptions(BodyOptions):
    """Options of a body from a start to an end."""

    segments: int | None
    pin_start: bool
    pin_end: bool


AnyOptions = TypeVar("AnyOptions", bound=Options)


def described(options: Options) -> dict[str, OptionInfo]:
    """What a person is told of each option that is set in a row of fields, by its name, in order."""
    return {each.name: each.metadata["about"] for each in fields(options) if "about" in each.metadata}


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


def stepped(about: OptionInfo, value: float | None, by: int) -> float:
    """The value one step up or down from another, within its limits: 1, 2, 5, 10, ... or, of counts, the next.

    None steps to the least count, or to 1.
    """
    if value is None:
        target = about.least if about.kind == "count" else 1.0
    elif about.kind == "count":
        return int(min(max(value + by, about.least), about.most))
    elif about.least < 0.0:
        target = round((round(value / SIGNED_STEP) + by) * SIGNED_STEP, 9)
    elif value <= 0.0:
        target = 1.0
    else:
        decade = math.floor(math.log10(value))
        steps = [float(f"{digit}e{decade + up}") for up in (-1, 0, 1) for digit in (1, 2, 5)]
        beyond = [step for step in steps if (step > value if by > 0 else step < value)]
        target = beyond[0] if by > 0 else beyond[-1]
    return min(max(target, about.least), about.most)
