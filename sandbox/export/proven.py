"""The article's loop: the largest Cs and Cd that are proven for a body in a single pass, and what they make of it.

A step of the loop with (Cs + 2 Cd) n_eff < 4 on every spring is stable (stability.py). That is per step: with n
substeps the same numbers hold in each of them, and n times as many steps make the body n^2 times as stiff.
"""

from dataclasses import dataclass

import numpy as np

from sandbox.export.chosen_body import ChosenBody
from sandbox.export.numbers import floored
from sandbox.physics.analysis.stability import BOUND
from sandbox.physics.equation import frequency_from_coefficients
from sandbox.physics.softness.body_motion import BodyMotion

SUBSTEPS = (1, 2, 4, 8)


@dataclass(frozen=True)
class LoopPair:
    """Cs and Cd of one step of the loop, and what the body does with them.

    frequency [Hz] and damping_ratio: of its slowest wobble; of one spring alone where its form is not stiff.
    sag: the share of its height by which it sags where it stands, None where its form is not stiff. stretch: the share
    of its length by which one of its springs is stretched by the weight of the whole body.
    """

    stiffness: float
    damping: float
    frequency: float
    damping_ratio: float
    sag: float | None
    stretch: float


@dataclass(frozen=True)
class LoopRow:
    """What is proven with some substeps of h [s] in a tick: the largest Cs = Cd, and the largest of the level's own
    ratio of Cs to Cd."""

    substeps: int
    h: float
    equal: LoopPair
    own: LoopPair


def loop_rows(body: ChosenBody) -> tuple[LoopRow, ...]:
    """What is proven for a body with 1, 2, 4 and 8 substeps."""
    equal = own = largest_pair(1.0, 1.0, body.n_eff)
    if max(body.stiffness, body.damping) > 0.0:
        own = largest_pair(body.stiffness, body.damping, body.n_eff)
    rows = []
    for substeps in SUBSTEPS:
        h = body.tick / substeps
        rows.append(LoopRow(substeps, h, _pair(body, *equal, h), _pair(body, *own, h)))
    return tuple(rows)


def largest_pair(stiffness: float, damping: float, n_eff: float) -> tuple[float, float]:
    """The largest Cs and Cd in that ratio, of three digits, with (Cs + 2 Cd) n_eff < 4 and neither above 1."""
    scale = min(1.0 / max(stiffness, damping), BOUND / (n_eff * (stiffness + 2.0 * damping)))

    def proven(stiff: float, damp: float) -> bool:
        return max(stiff, damp) <= 1.0 and (stiff + 2.0 * damp) * n_eff < BOUND

    # The larger of the two first, as the other follows from it.
    if damping >= stiffness:
        share = stiffness / damping
        damp = floored(scale * damping, lambda c: proven(share * c, c))
        return floored(share * damp, lambda c: proven(c, damp)), damp
    share = damping / stiffness
    stiff = floored(scale * stiffness, lambda c: proven(c, share * c))
    return stiff, floored(share * stiff, lambda c: proven(stiff, c))


def _pair(body: ChosenBody, stiffness: float, damping: float, h: float) -> LoopPair:
    # Of an eigenvalue a, the network is one spring of a Cs and a Cd (docs/physics.md, section 2).
    stretch = (
        body.weight * h * h / (stiffness * body.least_mass * body.least_length) if stiffness > 0.0 else float("inf")
    )
    if body.mode > 0.0:
        view = BodyMotion(body.mode, body.height, body.gravity, h, 1, "single_pass", 1)
        sag, motion = view.sag(np.array([stiffness]), np.array([damping])), view.motion(stiffness, damping)
        assert sag is not None
        return LoopPair(stiffness, damping, motion.hz, motion.ratio, float(sag[0]), stretch)
    hz, ratio = frequency_from_coefficients(stiffness, damping, h)
    return LoopPair(stiffness, damping, hz, ratio, None, stretch)
