"""Forms of bodies at rest, and the firmness that is asked of them."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import Floats, Slots

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


@dataclass(frozen=True, eq=False)
class StiffForm:
    """The form of a body at rest: points [m] (n, 2), mass [kg] (n,), and what joins them, by index.

    pairs (m, 2); areas and bends (t, 3).
    """

    points: Floats
    mass: Floats
    pairs: Slots
    areas: Slots
    bends: Slots

    def height(self, gravity: tuple[float, float]) -> float:
        """Extent [m] along gravity [m/s^2]; along y where there is none."""
        strength = design_gravity(gravity)
        x, y = (gravity[0] / strength, gravity[1] / strength) if any(gravity) else (0.0, 1.0)
        along = self.points[:, 0] * x + self.points[:, 1] * y
        return float(along.max() - along.min())


@dataclass(frozen=True, eq=False)
class FirmBody:
    """A body of a world whose form may be stiff without pins, by name, with the slots of its springs and constraints.

    The constraints are of three corners each.
    """

    name: str
    shape: StiffForm
    springs: NDArray[np.int64]
    constraints: NDArray[np.int64]


def design_gravity(gravity: tuple[float, float]) -> float:
    """The strength of gravity [m/s^2] that a sag is designed for: the usual one where a level has none."""
    return math.sqrt(gravity[0] * gravity[0] + gravity[1] * gravity[1]) or USUAL_GRAVITY
