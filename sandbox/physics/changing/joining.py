"""Joining: the particles, springs, constraints and driven parts of one world are added behind those of another."""

from dataclasses import fields, replace
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.actuators import Actuators, Hydraulics, Motors, Muscles, StrainLimits
from sandbox.physics.arrays import Slots
from sandbox.physics.keeping.equipment import Equipment
from sandbox.physics.state import FAMILIES, Family
from sandbox.physics.water.pools import HULL
from sandbox.physics.world import World

Parts = TypeVar("Parts", Muscles, Hydraulics)


class Place(NamedTuple):
    """The slots of bodies that join: first slots of their particles, springs, constraints, corners and driven parts;
    first owner; names of the materials from now on, and which of them (k,) each of its own is.
    """

    particle: int
    spring: int
    constraint: int
    corner: int
    part: int
    owner: int
    material_names: tuple[str, ...]
    materials: Slots


def equipped(world: World, other: World, place: Place, parts: tuple[str, ...]) -> Equipment:
    """The equipment of a world once another is joined to it; parts: names of the other's driven parts.

    Bodies have the names that they have in the other.
    """
    limits = StrainLimits(
        *(
            _limits_of(getattr(world.limits, each.name), getattr(other.limits, each.name), place)
            for each in fields(StrainLimits)
        )
    )
    forms = [
        replace(form, springs=form.springs + place.spring, constraints=form.constraints + place.constraint)
        for form in other.forms
    ]
    areas = [range(each.start + place.constraint, each.stop + place.constraint) for each in other.area_constraints]
    hulls = other.hulls + np.array([world.hulls[-1:, HULL].sum() + 1, place.spring, 0])
    return Equipment(
        place.material_names,
        limits,
        _joined_actuators(world.actuators, other.actuators, parts, place),
        (*world.area_names, *other.area_names),
        (*world.area_constraints, *areas),
        (*world.forms, *forms),
        np.concatenate([world.hulls, hulls]),
        world.joined,
    )


def _limits_of(present: NDArray[np.float64], added: NDArray[np.float64], place: Place) -> Any:
    result = np.zeros(len(place.material_names))
    result[place.materials] = added
    result[: len(present)] = present
    return result


def _joined_actuators(present: Actuators, added: Actuators, names: tuple[str, ...], place: Place) -> Actuators:
    motors = added.motors
    moved = replace(
        motors,
        hub=motors.hub + place.particle,
        part=motors.part + place.part,
        rim_start=motors.rim_start[1:] + present.motors.rim_start[-1],
        rim=motors.rim + place.particle,
    )
    return Actuators(
        (*present.names, *names),
        _behind(present.muscles, replace(added.muscles, spring=added.muscles.spring + place.spring)),
        _behind(
            present.hydraulics,
            replace(
                added.hydraulics,
                spring=added.hydraulics.spring + place.spring,
                part=added.hydraulics.part + place.part,
            ),
        ),
        Motors(
            *(
                np.concatenate([getattr(present.motors, each.name), getattr(moved, each.name)])
                for each in fields(Motors)
            )
        ),
    )


def _behind(present: Parts, added: Parts) -> Parts:
    """Driven springs of two worlds; where any has a largest force, those that have none have an infinite one."""
    arrays = {
        each.name: np.concatenate([getattr(present, each.name), getattr(added, each.name)])
        for each in fields(present)
        if each.name != "force"
    }
    forces = [each.force if len(each.force) else np.full(len(each.spring), np.inf) for each in (present, added)]
    is_limited = len(present.force) or len(added.force)
    return type(present)(**arrays, force=np.concatenate(forces) if is_limited else np.zeros(0))


def append_state(world: World, other: World, place: Place, group: Slots, collides: Slots) -> None:
    """Add every row of the state of another world, which has hands, but those of its hands, behind those of a world.

    group, collides: of its particles from now on.
    """
    particles, springs = other.grab_particle, other.grab_spring
    owners = other.owner[:particles]
    given: dict[str, Any] = {
        "owner": np.where(owners >= 0, owners + place.owner, owners - place.particle),
        "group": group,
        "collides": collides,
        "particle_a": other.particle_a[:springs] + place.particle,
        "particle_b": other.particle_b[:springs] + place.particle,
        "material": place.materials[other.material[:springs]],
        "constraint_first": other.constraint_first + place.corner,
        "constraint_material": np.append(place.materials, -1)[other.constraint_material],
        "corner_particle": other.corner_particle + place.particle,
    }
    counts = {
        Family.PARTICLE: particles,
        Family.SPRING: springs,
        Family.CONSTRAINT: other.constraint_count,
        Family.CORNER: len(other.corner_particle),
        Family.ACTUATOR: len(other.actuator_value),
    }
    for family, count in counts.items():
        rows = {column.name: given.get(column.name, getattr(other, column.name)[:count]) for column in FAMILIES[family]}
        world.append(family, count, **rows)
