"""The constant part of a world, beside its state; replaced as a whole when a body joins or leaves."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from sandbox.physics.actuators import Actuators, StrainLimits
from sandbox.physics.arrays import SlotRows
from sandbox.physics.keeping.forms import FirmBody


@dataclass(frozen=True, eq=False)
class Joined:
    """Bodies that joined a world together while it ran.

    definition: what a command said of them. names: of the bodies. first_particle, first_spring, first_part: their
    slots, in the order of the names of particles and springs; second_names: further names of particles, with their
    slots.
    """

    definition: Mapping[str, Any]
    names: tuple[str, ...]
    first_particle: int
    first_spring: int
    first_part: int
    particle_names: tuple[str, ...]
    spring_names: tuple[str, ...]
    second_names: tuple[tuple[str, int], ...]


class Equipment(NamedTuple):
    """The constant part of a world, by the names that World has for it.

    Names of materials and the strains that each bears; driven parts; bodies that keep areas, and the constraints of
    each; bodies that may be stiff by their form; hulls, which displace water (water/pools.py); what joined the world
    while it ran, in order.
    """

    material_names: tuple[str, ...]
    limits: StrainLimits
    actuators: Actuators
    area_names: tuple[str, ...]
    area_constraints: tuple[range, ...]
    forms: tuple[FirmBody, ...]
    hulls: SlotRows
    joined: tuple[Joined, ...]
