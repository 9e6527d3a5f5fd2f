"""BodyMotion: what Cs and Cd of a body's springs make of the body as a whole, in each solver.

How far it sags where it stands, and how its slowest wobble goes on: see firmness.py for both.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from sandbox.physics.analysis.firmness import WORDS, lowest_mode_of
from sandbox.physics.analysis.sag_curve import SagCurve
from sandbox.physics.analysis.spring_motion import SpringMotion, motion_of
from sandbox.physics.arrays import Floats
from sandbox.physics.equation import HIGHEST_COEFFICIENT
from sandbox.physics.firmness.reach import STANDING
from sandbox.physics.keeping.forms import FirmBody, StiffForm, design_gravity, height_of
from sandbox.physics.settings import WorldSettings
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.substeps import ALL_BUT_FIRM, MOTION, substep_coefficients, substep_time, turned
from sandbox.physics.world import World

# Beyond this share of its height a body lies flat, and a sag says little.
FLAT = 0.5
# A body is called rigid where its springs take back all of their errors at once, and it sags by no more than this.
UNSEEN_SAG = 5e-4
# What a body is called that does not sag at all.
RIGID = "rigid"
_RANKED = sorted(WORDS.items(), key=lambda item: -item[1])


@dataclass(frozen=True)
class BodyMotion:
    """A form by its lowest mode and height [m], under gravity [m/s^2], in steps of h [s], some a tick, by a solver.

    iterations: of the iterative solver; curve: what runs have told of its sag, None: nothing.
    """

    lowest_mode: float
    height: float
    gravity: float
    h: float
    substeps: int
    solver: str
    iterations: int
    curve: SagCurve | None = None

    @classmethod
    def of(cls, shape: StiffForm, settings: WorldSettings, lowest_mode: float | None = None) -> "BodyMotion":
        """That of a form; lowest_mode: where it is known."""
        mode = lowest_mode_of(shape) if lowest_mode is None else lowest_mode
        height, gravity = height_of(shape, *settings.gravity), design_gravity(*settings.gravity)
        substeps = settings.fewest_substeps
        return cls(mode, height, gravity, substep_time(settings), substeps, settings.solver, settings.iterations)

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
            share = 1.0 - max(0.0, 1.0 - a) ** (2 * self.iterations)
            return share * stiffness, share * damping
        if self.solver != "direct":
            raise ValueError(f"what {self.solver} makes of a body's wobble is not known")
        capped = np.minimum(damping, HIGHEST_COEFFICIENT)
        shares = a / (a * capped + (1.0 - capped))
        limited = np.where(damping > HIGHEST_COEFFICIENT, np.minimum(stiffness, HIGHEST_COEFFICIENT), stiffness)
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
        square = rate / (4.0 * math.pi * math.pi) * self.height
        with np.errstate(divide="ignore"):
            return np.asarray(np.where(square > 0.0, STANDING * self.gravity / square, np.inf))

    def sag_of_tick(self, stiffness: Floats, damping: Floats) -> Floats:
        """The share of its height (k,) that a body sags by, from Cs and Cd of springs in a tick; see `tells_sag`."""
        sag = self.sag(*self.of_substep(stiffness, damping))
        assert sag is not None
        return sag

    def motion(self, stiffness: float, damping: float) -> SpringMotion:
        """How its slowest wobble goes on, from Cs and Cd of its springs in a substep."""
        whole, damp = self.whole(np.array([stiffness]), np.array([damping]))
        return motion_of(float(whole[0]), float(damp[0]), self.h)


@dataclass(frozen=True)
class BodyReading:
    """The firmness of a body as shown: its sag as a share (None: not known), its slowest wobble, whether it is rigid.

    Rigid: its springs take back all of their errors, and keep none of their speed.
    """

    sag: float | None
    motion: SpringMotion
    is_rigid: bool


def present_coefficients(world: World) -> tuple[Floats, Floats]:
    """Cs and Cd (m,) of a substep that springs of a world have now."""
    return substep_coefficients(world, highest=SOLVERS[world.settings.solver].highest)


def read_body(
    world: World, body: FirmBody, lowest_mode: float, present: tuple[Floats, Floats] | None = None
) -> BodyReading | None:
    """The reading of a body of `firm_bodies`; None where its springs have several Cs or Cd.

    lowest_mode: of its form; 0: no wobble is shown. present: see present_coefficients, None: found anew.
    """
    springs = body.springs[world.spring_active[body.springs]]
    differ = not len(springs) or np.ptp(world.stiffness[springs]) or np.ptp(world.damping[springs])
    if differ or not lowest_mode > 0.0:
        return None
    pair = [each[springs[:1]] for each in present or present_coefficients(world)]
    view = BodyMotion.of(body.shape, world.settings, lowest_mode)
    sag = view.sag(*pair)
    rigid = bool(world.stiffness[springs[0]] == world.damping[springs[0]] == 1.0)
    return BodyReading(None if sag is None else float(sag[0]), view.motion(float(pair[0][0]), float(pair[1][0])), rigid)


def word_edges() -> tuple[list[str], list[float]]:
    """Words from soft to hard, but for rigid, and the sags (one less) at which one becomes the next."""
    named = [(word, value) for word, value in _RANKED if value > 0.0]
    return [word for word, _ in named], [
        math.sqrt(first * second) for (_, first), (_, second) in itertools.pairwise(named)
    ]


def word_for(sag: float, is_rigid: bool) -> str:
    """The word for a body that sags by this share of its height: the nearest of WORDS, by ratio.

    Only a rigid body (`BodyReading`) that does not visibly sag is called rigid.
    """
    if is_rigid and sag <= UNSEEN_SAG:
        return RIGID
    words, edges = word_edges()
    return words[sum(sag < edge for edge in edges)]
