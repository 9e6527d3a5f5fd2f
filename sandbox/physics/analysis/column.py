"""At what height a column of a body's stuff buckles under its own weight, whatever solver holds its springs.

An upright column of width w that stands on its foot leans out for ever where its weight q a metre is above

    q H^3 = 7.837 E I,      E I = E A w^2 / 12

E A is what holds the form against an even stretch along gravity, while it gives way across. Source: Greenhill 1881.
"""

import math

import numpy as np

from sandbox.physics.equation import HIGHEST_COEFFICIENT
from sandbox.physics.firmness.lowest_mode import rows_of
from sandbox.physics.keeping.forms import StiffForm, design_gravity

GREENHILL = 7.837


def critical_height(
    form: StiffForm, gravity: tuple[float, float], stiffness: float, damping: float, h: float
) -> float:  # fmt: skip
    """The height [m] above which a column of a form that is a box along gravity [m/s^2] buckles.

    stiffness, damping: Cs and Cd of its springs in ticks of h [s].
    """
    strength = design_gravity(*gravity)
    up = np.array(gravity) / strength if any(gravity) else np.array([0.0, 1.0])
    across = np.array([-up[1], up[0]])
    rows = rows_of(form)
    # u = e x: what even stretches along and across do to each spring and area.
    along, wide = (
        np.add.reduceat(
            np.sum(rows.gradient * ((form.points @ axis)[:, None] * axis)[rows.node], axis=1), rows.first[:-1]
        )
        for axis in (up, across)
    )
    both, one, other = (float(np.sum(rows.mass * a * b)) for a, b in ((along, wide), (along, along), (wide, wide)))
    held = one - both * both / other if other > 0.0 else one
    per_second = stiffness / (1.0 - min(damping, HIGHEST_COEFFICIENT)) / (h * h)
    # E A H = held per_second, q = sum m g / H
    width = float(np.ptp(form.points @ across))
    weight = float(np.sum(form.mass)) * strength
    return math.cbrt(GREENHILL / 12.0 * held * per_second * width * width / weight)
