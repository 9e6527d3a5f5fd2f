"""Actuators of a world, with the limits of its materials and its surface. Constant while it runs, so no state."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import Floats, Slots

NEVER = np.inf


@dataclass(frozen=True, eq=False)
class StrainLimits:
    """Strains at which springs break or yield, one row for each material (k,); infinite = never.

    tension, compression: a spring breaks beyond; yielding: beyond it the rest length follows, by at most the share
    yield_share of the natural length either way.
    """

    tension: Floats
    compression: Floats
    yielding: Floats
    yield_share: Floats

    @cached_property
    def exist(self) -> bool:
        """Whether any spring can break or yield."""
        return bool(np.isfinite(self.tension).any() or np.isfinite(self.compression).any() or self.yields)

    @cached_property
    def yields(self) -> bool:
        """Whether any spring can yield."""
        return bool(np.isfinite(self.yielding).any())


def unlimited(materials: int) -> StrainLimits:
    """Limits of a number of materials that neither break nor yield."""
    never = np.full(materials, NEVER)
    return StrainLimits(never, never, never, np.zeros(materials))


@dataclass(frozen=True)
class Surface:
    """How a particle behaves at contacts: friction, restitution, group and collides, see StateArrays."""

    friction: float = 0.0
    restitution: float = 0.0
    group: int = 0
    collides: int = 0


def _slots() -> Slots:
    return np.zeros(0, dtype=np.int64)


def _flags() -> NDArray[np.bool_]:
    return np.zeros(0, dtype=np.bool_)


def _floats() -> Floats:
    return np.zeros(0)


@dataclass(frozen=True, eq=False)
class Muscles:
    """Springs whose rest length follows a wave: slot, amplitude as a share of the natural length, period [ticks] of 2
    or more, phase 0..1, force [N] at most; each (k,), force also (0,): without limits."""

    spring: Slots = field(default_factory=_slots)
    amplitude: Floats = field(default_factory=_floats)
    period: Slots = field(default_factory=_slots)
    phase: Floats = field(default_factory=_floats)
    force: Floats = field(default_factory=_floats)


@dataclass(frozen=True, eq=False)
class Hydraulics:
    """Springs whose rest length goes from shortest to longest [m] at rate [m/s] times their part's value.

    force [N] at most; returns: whether it goes back to its natural length at that rate while the value is 0. Each (k,);
    force also (0,): without limits; returns not given: none does.
    """

    spring: Slots = field(default_factory=_slots)
    shortest: Floats = field(default_factory=_floats)
    longest: Floats = field(default_factory=_floats)
    rate: Floats = field(default_factory=_floats)
    part: Slots = field(default_factory=_slots)
    force: Floats = field(default_factory=_floats)
    returns: NDArray[np.bool_] = field(default_factory=_flags)

    def __post_init__(self) -> None:
        if len(self.returns) != len(self.spring):
            object.__setattr__(self, "returns", np.zeros(len(self.spring), dtype=np.bool_))


@dataclass(frozen=True, eq=False)
class Motors:
    """Wheels that are turned about their hubs: hub slot, speed [rad/s], largest torque [N m], part; each (k,).

    rim[rim_start[k]:rim_start[k + 1]] are the particles of wheel k without its hub.
    """

    hub: Slots = field(default_factory=_slots)
    speed: Floats = field(default_factory=_floats)
    torque: Floats = field(default_factory=_floats)
    part: Slots = field(default_factory=_slots)
    rim_start: Slots = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    rim: Slots = field(default_factory=_slots)


@dataclass(frozen=True, eq=False)
class Actuators:
    """Everything that is driven; names: of the motors and hydraulics that a command can drive."""

    names: tuple[str, ...] = ()
    muscles: Muscles = field(default_factory=Muscles)
    hydraulics: Hydraulics = field(default_factory=Hydraulics)
    motors: Motors = field(default_factory=Motors)

    def springs(self, count: int) -> NDArray[np.bool_]:
        """Which of the first `count` springs have a rest length that is driven."""
        driven = np.zeros(count, dtype=np.bool_)
        driven[self.muscles.spring] = True
        driven[self.hydraulics.spring] = True
        return driven
