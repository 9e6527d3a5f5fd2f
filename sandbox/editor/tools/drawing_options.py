"""What a drawing tool can be told before and while it draws; remembered from one drawing to the next."""

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any, TypeVar

from sandbox.editor.document import EditError
from sandbox.editor.panel.field_info import SAG, FieldInfo
from sandbox.level.format.limits import (
    COORDINATE_LIMIT,
    DEFAULT_MATERIAL,
    MASS_RANGE,
    PARTICLE_LIMIT,
)

# Steps of a value that can be negative; others go up by 1, 2, 5, 10, 20, ...
SIGNED_STEP = 0.05
_STEPS = "The wheel or Up and Down change it."


def option(default: Any, about: FieldInfo) -> Any:
    """A field of options with its title, limits and tooltip."""
    return field(default=default, metadata={"about": about})


def number_option(
    default: float | None, title: str, text: str, unit: str = "", low: float = 0.0, high: float = COORDINATE_LIMIT,
    empty: str = "",
) -> Any:  # fmt: skip
    """A number; empty: a word for an empty field, where None is a value too."""
    tip = f"{text} {_STEPS}"
    return option(default, FieldInfo("number", title, unit, low, high, tooltip=tip, optional=bool(empty), empty=empty))


def count_option(title: str, text: str, low: int, default: int | None = None) -> Any:
    """A number of parts; None: as many as fit the size."""
    about = FieldInfo("integer", title, low=low, high=PARTICLE_LIMIT, tooltip=f"{text} {_STEPS}")
    return option(default, replace(about, optional=True, empty="auto") if default is None else about)


def mass_option(default: float | None, title: str = "mass", text: str = "Mass of the particle.") -> Any:
    """A mass [kg]; None: as the others."""
    return number_option(default, title, text, "kg", *MASS_RANGE, empty="same" if default is None else "")


def whole_mass_option() -> Any:
    """The mass of a body [kg]; None: as many times that of a particle as it has particles."""
    text = "Mass of the whole body. Empty = the more, the more particles it has."
    return number_option(None, "mass", text, "kg", *MASS_RANGE, empty="auto")


def sag_option(default: float | None) -> Any:
    """A sag [%] by which a body is as soft as a whole; None: as soft as its material makes it."""
    tip = f"{SAG.tooltip} Empty = as its material makes it. {_STEPS}"
    return option(default, replace(SAG, title="sag", tooltip=tip, optional=True, empty="material"))


def size_option(title: str, text: str) -> Any:
    """A length [m] that may be left to the drawing."""
    return number_option(None, title, text, "m", 1e-6, empty="auto")


def flag_option(default: bool, title: str, text: str) -> Any:
    """Yes or no."""
    return option(default, FieldInfo("yes_no", title, tooltip=text))


def material_option(default: str = DEFAULT_MATERIAL) -> Any:
    """The material of the springs."""
    return option(default, FieldInfo("material", "material", tooltip="Material of the springs."))


@dataclass(frozen=True)
class Options:
    """Base of the options of every tool."""


class BodyOptions(Options):
    """Options of a tool that draws a body: each has these among its own, in its own order."""

    # That of a particle, where the mass of the whole is not set.
    particle_mass: float
    mass: float | None = None
    material: str
    # Of those that have a firmness, in per cent.
    sag: float | None = None


class LineOptions(BodyOptions):
    """Options of a body from a start to an end."""

    segments: int | None
    pin_start: bool
    pin_end: bool


AnyOptions = TypeVar("AnyOptions", bound=Options)


def described(options: Options) -> dict[str, FieldInfo]:
    """The description of each option that is set in a row of fields, by its name, in order."""
    return {each.name: each.metadata["about"] for each in fields(options) if "about" in each.metadata}


def changed(options: AnyOptions, name: str, value: Any) -> AnyOptions:
    """The options with another value of one of them. Raises EditError with a line for the person."""
    about = described(options)[name]
    low, high = about.limits
    if value is None and not about.optional:
        raise EditError(f"{about.title}: give a value")
    if value is not None and about.kind in ("integer", "number"):
        if isinstance(value, bool) or not isinstance(value, int if about.kind == "integer" else int | float):
            raise EditError(f"{about.title}: give a {'whole ' if about.kind == 'count' else ''}number")
        if not low <= value <= high:
            raise EditError(f"{about.title}: {value:g} is not in {low:g}..{high:g} {about.unit}".rstrip())
        value = value if about.kind == "integer" else float(value)
    return replace(options, **{name: value})


def stepped(about: FieldInfo, value: float | None, by: int) -> float:
    """The value one step up or down from another, within its limits: 1, 2, 5, 10, ... or, of counts, the next.

    None steps to the least count, or to 1.
    """
    low, high = about.limits
    if value is None:
        target = low if about.kind == "integer" else 1.0
    elif about.kind == "integer":
        return int(min(max(value + by, low), high))
    elif low < 0.0:
        target = round((round(value / SIGNED_STEP) + by) * SIGNED_STEP, 9)
    elif value <= 0.0:
        target = 1.0
    else:
        decade = math.floor(math.log10(value))
        steps = [float(f"{digit}e{decade + up}") for up in (-1, 0, 1) for digit in (1, 2, 5)]
        beyond = [step for step in steps if (step > value if by > 0 else step < value)]
        target = beyond[0] if by > 0 else beyond[-1]
    return min(max(target, low), high)
