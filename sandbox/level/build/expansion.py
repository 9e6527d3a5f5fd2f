"""What a body becomes: the particles and springs of its form, with its pins, cuts and pose applied."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.level.kinds.bodies import AnyBody, BridgeDef, GirderDef, MeshDef, RopeDef, WebDef, WheelDef
from sandbox.level.kinds.shapes import Pairs, Points, distances, expand

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Expansion:
    """Particles and springs of one body, in generation order; before welds.

    Of n particles: position [m] (n, 2), form [m] (n, 2) = where they are at rest, velocity [m/s] (n, 2), mass [kg]
    (n,), pinned (n,). Of the m springs that are not cut: pairs (m, 2) of particles, numbers (m,) = the k of their names
    `id:k`, rest_length [m] (m,).
    """

    position: Points
    form: Points
    velocity: Points
    mass: Floats
    pinned: NDArray[np.bool_]
    pairs: Pairs
    numbers: NDArray[np.int64]
    rest_length: Floats


def expansion(body: AnyBody) -> Expansion:
    """Expand a body that check_level has found sound."""
    form, pairs = expand(body)
    kept = np.ones(len(pairs), dtype=np.bool_)
    kept[list(body.cut)] = False
    pairs = pairs[kept]
    return Expansion(
        position=form if body.pose is None else np.array(body.pose, dtype=np.float64).reshape(-1, 2),
        form=form,
        velocity=_velocities(body, len(form)),
        mass=masses(body, len(form)),
        pinned=_pinned(body, len(form)),
        pairs=pairs,
        numbers=np.flatnonzero(kept),
        rest_length=_rest_lengths(body, form, pairs),
    )


def masses(body: AnyBody, count: int) -> Floats:
    """Mass [kg] (count,) of each of a body's particles."""
    if isinstance(body, MeshDef):
        return np.ones(count) if body.masses is None else np.array(body.masses, dtype=np.float64)
    result = np.full(count, body.particle_mass)
    if isinstance(body, RopeDef) and body.end_mass is not None:
        result[-1] = body.end_mass
    if isinstance(body, WheelDef) and body.hub_mass is not None:
        result[0] = body.hub_mass
    return result


def named_particles(body: AnyBody) -> dict[str, int]:
    """Index of each particle that has a name besides its number: `start` of `id.start`."""
    match body:
        case RopeDef() | BridgeDef() | GirderDef():
            return {"start": 0, "end": body.segments}
        case WebDef():
            return {"centre": 0}
        case WheelDef():
            return {"hub": 0}
    return {}


def _velocities(body: AnyBody, count: int) -> Points:
    velocities = np.zeros((count, 2)) + np.array(body.velocity)
    if isinstance(body, MeshDef) and body.velocities is not None:
        velocities += np.array(body.velocities)
    return velocities


def _pinned(body: AnyBody, count: int) -> NDArray[np.bool_]:
    pinned = np.zeros(count, dtype=np.bool_)
    pinned[list(body.pinned)] = True
    match body:
        case RopeDef() | BridgeDef() | GirderDef():
            named = named_particles(body)
            pinned[[named[end] for end in body.pin]] = True
            if isinstance(body, BridgeDef):
                pinned[[named[end] + body.segments + 1 for end in body.pin]] = True
        case WebDef() if body.pin:
            pinned[count - body.spokes :] = True
        case WheelDef() if body.pin:
            pinned[0] = True
    return pinned


def _rest_lengths(body: AnyBody, form: Points, pairs: Pairs) -> Floats:
    if isinstance(body, RopeDef) and body.rest_length is not None:
        return np.full(len(pairs), body.rest_length)
    return distances(form, pairs)
