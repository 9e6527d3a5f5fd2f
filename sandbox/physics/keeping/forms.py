"""Forms of bodies at rest, and the firmness that is asked of them."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import FloatRows, Floats, SlotRows
from sandbox.physics.jit import inner_kernel, kernel, scalar_kernel

# Gravity [m/s^2] that a sag is meant for where there is none.
USUAL_GRAVITY = 9.81


@dataclass(frozen=True)
class Firmness:
    """The wanted firmness of a body: its sag, a share of its height; or the frequency [Hz] and damping ratio of its
    wobble.

    A sag of 0 is complete rigidity.
    """

    sag: float | None = None
    hz: float | None = None
    ratio: float | None = None

    def __str__(self) -> str:
        if self.sag is not None:
            return f"sag {self.sag:.3g}"
        return f"{self.hz:.4g} Hz" + ("" if self.ratio is None else f" at ratio {self.ratio:.4g}")


class StiffForm(NamedTuple):
    """The form of a body at rest: points [m] (n, 2), mass [kg] (n,), and what joins them, by index.

    pairs (m, 2); areas and bends (t, 3).
    """

    points: FloatRows
    mass: Floats
    pairs: SlotRows
    areas: SlotRows
    bends: SlotRows


@dataclass(frozen=True, eq=False)
class FirmBody:
    """A body of a world whose form may be stiff without pins, by name, with the slots of its springs and constraints.

    The constraints are of three corners each.
    """

    name: str
    shape: StiffForm
    springs: NDArray[np.int64]
    constraints: NDArray[np.int64]


@scalar_kernel
def design_gravity(gravity_x: float, gravity_y: float) -> float:
    """The strength of gravity [m/s^2] that a sag is designed for: the usual one where a level has none."""
    strength = math.sqrt(gravity_x * gravity_x + gravity_y * gravity_y)
    return strength if strength > 0.0 else USUAL_GRAVITY


@inner_kernel
def height_along(points: FloatRows, gravity_x: float, gravity_y: float) -> float:
    """Extent [m] of points (n, 2) along gravity [m/s^2]; along y where there is none."""
    strength = design_gravity(gravity_x, gravity_y)
    x, y = gravity_x / strength, gravity_y / strength
    if gravity_x == 0.0 and gravity_y == 0.0:
        y = 1.0
    lowest, highest = math.inf, -math.inf
    for k in range(points.shape[0]):
        along = points[k, 0] * x + points[k, 1] * y
        lowest, highest = min(lowest, along), max(highest, along)
    return highest - lowest


@kernel
def height_of(form: StiffForm, gravity_x: float, gravity_y: float) -> float:
    """`height_along` of a form."""
    return height_along(form.points, gravity_x, gravity_y)
