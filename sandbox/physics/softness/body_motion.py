"""BodyMotion: what Cs and Cd of a body's springs make of the body as a whole, in each solver.

How far it sags where it stands, in a number and a word, how its slowest wobble goes on (see firmness.py for both), and
at what height a column of its stuff buckles. Sags that no theory tells runs do: see SagCurve, which sag_meter.py makes.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.arrays import Floats
from sandbox.physics.equation import HIGHEST_COEFFICIENT, frequency_from_coefficients
from sandbox.physics.keeping.equipment import FirmBody, StiffForm, design_gravity
from sandbox.physics.settings import WorldSettings
from sandbox.physics.softness.firmness import WORDS, lowest_mode_of, standing_form
from sandbox.physics.softness.kernels.lowest_mode import rows_of
from sandbox.physics.softness.standing import StandingForm
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.substeps import ALL_BUT_FIRM, MOTION, substep_coefficients, substep_time, turned
from sandbox.physics.world import World

# Beyond this share of its height a body lies flat, and a sag says little.
FLAT = 0.5
# A body is called rigid where its springs take back all of their errors at once, and it sags by no more than this.
UNSEEN_SAG = 5e-4
# What a body is called that does not sag at all.
RIGID = "rigid"
# An error is at rest once no more than this share of the first is left.
AT_REST = 0.02
# Steps of an error that are looked at one by one; what takes longer is known by its slowest part alone.
LONGEST = 100_000
# Cs and sags below this count as this.
LEAST = 1e-12
# q H^3 / (E I) of a column that is about to buckle, by Greenhill (1881).
GREENHILL = 7.837

# Cs and Cd per tick of springs, and the lowest mode that they have.
Pair = tuple[float, float, float]


@dataclass(frozen=True)
class SpringMotion:
    """The decay of an error of a spring, or of a body's slowest wobble, once it is let go.

    hz, ratio: frequency [Hz] without damping, and damping ratio; inf where Cd is 1. swings: whether it crosses zero;
    half, rest [s]: when half of it, and when all but AT_REST is gone for good, inf: never.
    """

    hz: float
    ratio: float
    swings: bool
    half: float
    rest: float


@dataclass(frozen=True)
class SagCurve:
    """Sags, a share of its length, over softness (1 - y Cd) / Cs in a substep, both ascending; y: `damping_share`."""

    damping_share: float
    softness: tuple[float, ...]
    sag: tuple[float, ...]

    def of(self, stiffness: Floats, damping: Floats) -> Floats:
        """The sag (k,) at Cs and Cd (k,) in a substep; what is softer or stiffer than any run: in proportion."""
        soft = np.log(softness_of(stiffness, damping, self.damping_share))
        known, sag = np.log(self.softness), np.log(np.maximum(self.sag, LEAST))
        beyond = np.maximum(soft - known[-1], 0.0) - np.maximum(known[0] - soft, 0.0)
        return np.asarray(np.exp(np.interp(soft, known, sag) + beyond))


@dataclass(frozen=True)
class BodyMotion:
    """A form by its lowest mode, under gravity [m/s^2], in steps of h [s], some a tick, by a solver.

    form: what says how far it sags where it stands; iterations: of the iterative solver; curve: what runs have told of
    its sag, None: nothing.
    """

    lowest_mode: float
    form: StandingForm
    gravity: float
    h: float
    substeps: int
    solver: str
    iterations: int
    curve: SagCurve | None = None

    @classmethod
    def of(cls, shape: StiffForm, settings: WorldSettings, lowest_mode: float | None = None) -> "BodyMotion":
        """Motion of a body of a form; lowest_mode: where it is known."""
        mode = lowest_mode_of(shape) if lowest_mode is None else lowest_mode
        form, gravity = standing_form(shape, settings.gravity), design_gravity(*settings.gravity)
        substeps = settings.fewest_substeps
        return cls(mode, form, gravity, substep_time(settings), substeps, settings.solver, settings.iterations)

    def of_substep(self, stiffness: Floats, damping: Floats) -> tuple[Floats, Floats]:
        """Cs and Cd (k,) of a substep from those of a tick, as springs get them that have no firmness."""
        keeps = ALL_BUT_FIRM if self.solver == "direct" else MOTION
        return turned(stiffness, damping, np.zeros(len(stiffness)), self.substeps, keeps)

    def whole(self, stiffness: Floats, damping: Floats) -> tuple[Floats, Floats]:
        """Cs and Cd (k,) of the body's slowest wobble in a substep, from those of its springs in one."""
        a = self.lowest_mode
        if self.solver == "single_pass":
            return a * stiffness, a * damping
        if self.solver == "iterative":
            # What so many rounds of Gauss-Seidel have made of it.
            fraction = 1.0 - max(0.0, 1.0 - a) ** (2 * self.iterations)
            return fraction * stiffness, fraction * damping
        if self.solver != "direct":
            raise ValueError(f"what {self.solver} makes of a body's wobble is not known")
        limited, capped = _limited(stiffness, damping)
        shares = a / (a * capped + (1.0 - capped))
        return limited * shares, capped * shares

    @property
    def tells_sag(self) -> bool:
        """Whether a sag is known without a run of its own."""
        return self.curve is not None or (self.solver != "iterative" and self.lowest_mode > 0.0)

    def sag(self, stiffness: Floats, damping: Floats) -> Floats | None:
        """Part of its height by which it sags where it stands (k,), from Cs and Cd of its springs in a substep.

        None: only a run can tell.
        """
        if self.curve is not None:
            return self.curve.of(stiffness, damping)
        if not self.tells_sag:
            return None
        whole, damp = self.whole(stiffness, damping)
        # k / m of the wobble [1/s^2]: Cs_a / ((1 - Cd_a) h^2), in a single pass Cs_a / h^2
        rate = whole / (self.h * self.h) / (1.0 - damp if SOLVERS[self.solver].bounded else 1.0)
        square = rate / (4.0 * math.pi * math.pi) * self.form.length
        with np.errstate(divide="ignore"):
            return self.form.sags(np.where(square > 0.0, self.gravity / square, np.inf))

    def sag_of_tick(self, stiffness: Floats, damping: Floats) -> Floats:
        """The share of its height (k,) that it sags by, from Cs and Cd of its springs in a tick; see `tells_sag`."""
        sag = self.sag(*self.of_substep(stiffness, damping))
        assert sag is not None
        return sag

    def motion(self, stiffness: float, damping: float) -> SpringMotion:
        """How its slowest wobble goes on, from Cs and Cd of its springs in a substep."""
        whole, damp = self.whole(np.array([stiffness]), np.array([damping]))
        return motion_of(float(whole[0]), float(damp[0]), self.h)


def softness_of(stiffness: Floats, damping: Floats, damping_share: float) -> Floats:
    """(1 - y Cd) / Cs (k,) of Cs and Cd (k,) in a substep, by which sags go; damping_share: y."""
    limited, capped = _limited(stiffness, damping)
    return np.asarray((1.0 - damping_share * capped) / np.maximum(limited, LEAST))


def _limited(stiffness: Floats, damping: Floats) -> tuple[Floats, Floats]:
    # As the direct solver limits Cd, and then Cs too.
    capped = np.minimum(damping, HIGHEST_COEFFICIENT)
    return np.where(damping > HIGHEST_COEFFICIENT, np.minimum(stiffness, HIGHEST_COEFFICIENT), stiffness), capped


@dataclass(frozen=True)
class BodyReading:
    """The firmness of a body as shown: its slowest wobble, and whether it is rigid.

    Rigid: its springs take back all of their errors, and keep none of their speed. view, stiffness, damping: what tells
    its sag.
    """

    view: BodyMotion
    stiffness: Floats
    damping: Floats
    motion: SpringMotion
    is_rigid: bool

    @property
    def sag(self) -> float | None:
        """Its sag as a share; None: not known."""
        sag = self.view.sag(self.stiffness, self.damping)
        return None if sag is None else float(sag[0])


def read_body(
    world: World, body: FirmBody, lowest_mode: float, present: tuple[Floats, Floats] | None = None
) -> BodyReading | None:
    """The reading of a body of `firm_bodies`; None where its springs have several Cs or Cd.

    lowest_mode: of its form; 0: no wobble is shown. present: see present_coefficients, None: found anew.
    """
    common = common_pair(world, body)
    if common is None or not lowest_mode > 0.0:
        return None
    first = body.springs[world.spring_active[body.springs]][:1]
    stiffness, damping = (each[first] for each in present or present_coefficients(world))
    view = BodyMotion.of(body.shape, world.settings, lowest_mode)
    motion = view.motion(float(stiffness[0]), float(damping[0]))
    return BodyReading(view, stiffness, damping, motion, common[:2] == (1.0, 1.0))


def present_coefficients(world: World) -> tuple[Floats, Floats]:
    """Cs and Cd (m,) of a substep that springs of a world have now."""
    return substep_coefficients(world, highest=SOLVERS[world.settings.solver].highest)


def common_pair(world: World, body: FirmBody) -> Pair | None:
    """Cs and Cd that all springs of a body share; None: they differ, or there are none."""
    springs = body.springs[world.spring_active[body.springs]]
    if not len(springs) or np.ptp(world.stiffness[springs]) or np.ptp(world.damping[springs]):
        return None
    first = springs[0]
    return float(world.stiffness[first]), float(world.damping[first]), float(world.lowest_mode[first])


def word_for(sag: float, is_rigid: bool) -> str:
    """The word for a body that sags by this share of its height: the nearest of WORDS, by ratio.

    Only a rigid body (`BodyReading`) that does not visibly sag is called rigid.
    """
    if is_rigid and sag <= UNSEEN_SAG:
        return RIGID
    words, edges = word_edges()
    return words[sum(sag < edge for edge in edges)]


def word_edges() -> tuple[list[str], list[float]]:
    """Words from soft to hard, but for rigid, and the sags (one less) at which one becomes the next."""
    words = sorted((word for word in WORDS if WORDS[word] > 0.0), key=WORDS.__getitem__, reverse=True)
    return words, [math.sqrt(WORDS[word] * WORDS[harder]) for word, harder in itertools.pairwise(words)]


def motion_of(stiffness: float, damping: float, h: float) -> SpringMotion:
    """Motion of a single spring of Cs and Cd in steps of h [s].

    Its error x follows  x'' = (2 - Cs - Cd) x' - (1 - Cd) x  from step to step.
    """
    hz, ratio = frequency_from_coefficients(stiffness, damping, h)
    if stiffness <= 0.0:
        return SpringMotion(hz, ratio, False, math.inf, math.inf)
    swings = bool(swings_back(np.array(stiffness), np.array(damping)))
    half, rest = (h * _last_above(stiffness, damping, share) for share in (0.5, AT_REST))
    return SpringMotion(hz, ratio, swings, half, rest)


def swings_back(stiffness: NDArray[np.float64], damping: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether a spring of each Cs and Cd crosses its length: its roots are no positive numbers."""
    # (Cs + Cd)^2 < 4 Cs, or both roots are below 0
    total = stiffness + damping
    return np.asarray((total * total < 4.0 * stiffness) | (total > 2.0))


def errors_of(stiffness: float, damping: float, steps: int) -> NDArray[np.float64]:
    """Error (steps + 1,) of one spring that is let go from an error of 1, step by step."""
    first, second = _roots(stiffness, damping)
    n = np.arange(steps + 1)
    if abs(first - second) < 1e-9:
        # x_n = (1 + n (1 - r)) r^n of equal roots
        return np.asarray(((1.0 + n * (1.0 - first)) * first**n).real)
    # x_0 = 1, x_1 = 1 - Cs
    weight = (1.0 - stiffness - second) / (first - second)
    return np.asarray((weight * first**n + (1.0 - weight) * second**n).real)


def _roots(stiffness: float, damping: float) -> tuple[complex, complex]:
    # Roots 1 - s of r^2 - (2 - Cs - Cd) r + (1 - Cd), from s^2 - (Cs + Cd) s + Cs: small ones keep their digits.
    total = stiffness + damping
    apart = complex(total * total - 4.0 * stiffness) ** 0.5
    quick = 0.5 * (total + apart)
    slow = stiffness / quick if quick else 0.0
    return complex(1.0 - slow), complex(1.0 - quick)


def _last_above(stiffness: float, damping: float, fraction: float) -> float:
    """Steps until no error above a share is left; inf: never."""
    slow = max(map(abs, _roots(stiffness, damping)))
    if slow >= 1.0:
        return math.inf
    if slow == 0.0:
        return 1.0
    # Where it creeps the first part of it is larger than the whole; where it swings, crossing takes it below.
    first, second = _roots(stiffness, damping)
    amount = abs((1.0 - stiffness - second) / (first - second)) if first != second else 1.0
    steps = math.log(fraction / max(amount, 1.0)) / math.log(slow) + 1.0
    if steps > LONGEST:
        return steps
    errors = np.abs(errors_of(stiffness, damping, 2 * math.ceil(steps) + 8))
    return float(np.flatnonzero(errors > fraction)[-1] + 1)


def critical_height(
    form: StiffForm, gravity: tuple[float, float], stiffness: float, damping: float, h: float
) -> float:  # fmt: skip
    """The height [m] above which a column of a form that is a box along gravity [m/s^2] buckles, in any solver.

    stiffness, damping: Cs and Cd of its springs in ticks of h [s]. An upright column of width w that stands on its foot
    leans out for ever where its weight q a metre is above

        q H^3 = 7.837 E I,      E I = E A w^2 / 12

    E A is what holds the form against an even stretch along gravity, while it gives way across.
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
