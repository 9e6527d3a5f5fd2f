"""Firmness: how soft a body is as a whole, by its sag or its wobble, for any grid, size and mass.

A body's slowest wobble moves as one spring with a Cs and Cd of its own (`of_body`). Firmness gives these two: by the
frequency and damping ratio of the wobble, or by the part of its height by which the body sags under its weight,

    sag = STANDING g / (F^2 H),   (2 pi F)^2 = k / m = Cs / ((1 - Cd) h^2),   H = height of the form along gravity g

F is the frequency f of the wobble where h is short; at Cs and Cd near 1 the wobble is slower than its k says.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context

from sandbox.physics.analysis.firm_bodies import firm_bodies
from sandbox.physics.equation import (
    HIGHEST_COEFFICIENT,
    coefficients_from_frequency,
    frequency_from_coefficients,
    of_springs,
)
from sandbox.physics.keeping import arguments
from sandbox.physics.keeping.forms import FirmBody, Firmness, StiffForm, design_gravity
from sandbox.physics.world import World

# F^2 sag H / g of a box that stands on the floor, which holds its foot: 0.75 of that of a free column.
STANDING = 0.0565
# Damping ratio of a sag, where no higher one is needed: it wobbles a few times. Then the least that is possible, and
# a little more.
USUAL_RATIO = 0.15
SPARE_RATIO = 1.05
# Sags by their words, from soft to hard.
WORDS = {"jelly": 0.25, "soft": 0.1, "firm": 0.02, "hard": 0.003, "rigid": 0.0}
# Cs and Cd are rounded to this many decimals, so that different libraries of mathematics build the same bits.
DECIMALS = 13
# Particles of the largest body whose firmness panels read where nothing has asked for it; it takes some 0.2 s.
LARGEST_READ = 2_000
# Steps of damping ratios, where the least is looked for, and halvings of ranges of frequencies and sags.
RATIO_STEPS = 1_000
HALVINGS = 100


class OutOfReach(ValueError):
    """No Cs and Cd give that firmness; nearest: the nearest that some give. Its text is one line for a person."""

    def __init__(self, text: str, nearest: Firmness | None) -> None:
        super().__init__(text)
        self.nearest = nearest


def lowest_mode_of(shape: StiffForm) -> float:
    """The lowest eigenvalue of a form, without unit; 0 where it is not stiff without pins."""
    from sandbox.physics.analysis.lowest_mode import find_lowest_mode

    return find_lowest_mode(shape)


@dataclass(frozen=True)
class FirmnessRange:
    """The range of firmness of a body whose form has this lowest mode and height [m].

    Under gravity [m/s^2], and in ticks of h [s].
    """

    lowest_mode: float
    height: float
    gravity: float
    h: float

    @classmethod
    def of(cls, shape: StiffForm, gravity: tuple[float, float], tick_rate: float) -> "FirmnessRange":
        """That of a form."""
        return cls(lowest_mode_of(shape), shape.height(gravity), design_gravity(gravity), 1.0 / tick_rate)

    def coefficients(self, firmness: Firmness) -> tuple[float, float]:
        """Cs and Cd of the body as a whole. Raises OutOfReach."""
        if firmness.sag is not None:
            return self._of_sag(firmness.sag)
        assert firmness.hz is not None
        hz, least = firmness.hz, least_ratio(firmness.hz, self.h)
        ratio = usual_ratio(hz, self.h) if firmness.ratio is None else firmness.ratio
        if ratio >= least and self._can_share(hz, ratio):
            return self._pair(hz, ratio)
        ratio = max(ratio, least)
        if not self._can_share(hz, ratio):
            hz = _rounded(_last(lambda f: self._can_share(f, ratio), 0.0, hz), ROUND_FLOOR)
        nearest = Firmness(hz=hz, ratio=ratio)
        raise self._out_of_reach(firmness, nearest)

    def nearest(self, firmness: Firmness) -> Firmness:
        """The firmness itself, or the nearest one in reach. Raises OutOfReach where none is."""
        try:
            self.coefficients(firmness)
        except OutOfReach as error:
            if error.nearest is None:
                raise
            return error.nearest
        return firmness

    def reading(self, stiffness: float, damping: float) -> tuple[float, float, float]:
        """Sag, frequency [Hz] and damping ratio of a body of these Cs and Cd as a whole."""
        return self.sag_of(stiffness, damping), *frequency_from_coefficients(stiffness, damping, self.h)

    def sag_of(self, stiffness: float, damping: float) -> float:
        """The sag of a body of these Cs and Cd as a whole; inf where Cs is 0."""
        per_second = stiffness / (1.0 - min(damping, HIGHEST_COEFFICIENT)) / (2.0 * math.pi * self.h) ** 2
        squares = self.height * per_second
        return STANDING * self.gravity / squares if squares > 0.0 else math.inf

    def _of_sag(self, sag: float) -> tuple[float, float]:
        if sag == 0.0:
            return 1.0, 1.0
        if not self.height > 0.0:
            raise OutOfReach("it has no height along gravity to sag by; say its frequency in Hz", None)

        def can(share: float) -> bool:
            # Along a ratio that is the least possible anyhow, there is no highest frequency.
            return self._can_share(*self._standing(share))

        if can(sag):
            return self._pair(*self._standing(sag))
        least = _rounded(1.0 - _last(lambda less: can(1.0 - less), 0.0, 1.0 - sag), ROUND_CEILING)
        raise self._out_of_reach(Firmness(sag=sag), Firmness(sag=least) if can(least) else Firmness(sag=0.0))

    def _standing(self, sag: float) -> tuple[float, float]:
        """Frequency [Hz] and damping ratio of the wobble of a body that sags so far."""
        highest = math.sqrt(STANDING * self.gravity / (sag * self.height))
        ratio = usual_ratio(highest, self.h)

        def is_softer(hz: float) -> bool:
            try:
                return self.sag_of(*coefficients_from_frequency(hz, ratio, self.h)) > sag
            except ValueError:
                return False

        return _last(is_softer, 0.0, SPARE_RATIO * highest), ratio

    def _out_of_reach(self, asked: Firmness, nearest: Firmness) -> OutOfReach:
        at = f"at {1.0 / self.h:g} ticks a second"
        rigid = ", but for 0, which is rigid" if nearest.sag else ""
        return OutOfReach(f"{asked} is out of reach {at}; the nearest is {nearest}{rigid}", nearest)

    def _pair(self, hz: float, ratio: float) -> tuple[float, float]:
        stiffness, damping = (round(value, DECIMALS) for value in coefficients_from_frequency(hz, ratio, self.h))
        # At the least ratio the two are equal but for rounding.
        return min(stiffness, damping), damping

    def _can_share(self, hz: float, ratio: float) -> bool:
        """Whether springs can give the body that, whose Cd is capped."""
        try:
            stiffness, damping = self._pair(hz, ratio)
        except ValueError:
            return False
        return of_springs(stiffness, damping, self.lowest_mode)[1] <= HIGHEST_COEFFICIENT


def set_firmness(world: World, body: int, stiffness: float, damping: float, duration: int = 0) -> None:
    """Give a body, by its place among `firm_bodies`, Cs and Cd as a whole: those of its slowest wobble, Cs <= Cd.

    They are shared out over its springs, areas and bends, in force in so many ticks (ramps.py); 0: at once.
    Raises IndexError and ValueError.
    """
    bodies = firm_bodies(world)
    body = arguments.slot("body", body, "bodies that may be stiff by their form", len(bodies))
    give_firmness(world, bodies[body], stiffness, damping, duration)


def give_firmness(world: World, body: FirmBody, stiffness: float, damping: float, duration: int = 0) -> None:
    """Give a body of a world, or a piece of one, Cs and Cd as `set_firmness` does. Raises ValueError."""
    stiffness, damping, lowest_mode = values_of(body, stiffness, damping)
    given = {"stiffness": stiffness, "damping": damping, "lowest_mode": lowest_mode, "duration": duration}
    world.command("firm_springs", springs=body.springs, **given)
    world.command("firm_constraints", constraints=body.constraints, **given)


def values_of(body: FirmBody, stiffness: float, damping: float) -> tuple[float, float, float]:
    """Cs, Cd and lowest mode of each spring of a body that has these Cs and Cd as a whole."""
    if stiffness == damping == 1.0:
        # All of them rigid, which they are alone as well.
        return stiffness, damping, 0.0
    lowest_mode = lowest_mode_of(body.shape)
    return (*of_springs(stiffness, damping, lowest_mode), lowest_mode)


def usual_ratio(hz: float, h: float) -> float:
    """Damping ratio of a sag of that frequency [Hz] in ticks of h [s]."""
    return max(USUAL_RATIO, min(1.0, _rounded(SPARE_RATIO * least_ratio(hz, h), ROUND_CEILING)))


def least_ratio(hz: float, h: float) -> float:
    """The least damping ratio, in thousandths, at which a frequency [Hz] has Cs <= Cd in ticks of h [s].

    So that it makes no energy of nothing: about pi f h.
    """
    phase = 2.0 * math.pi * hz * h

    def passive(ratio: float) -> bool:
        # Cs <= Cd: e <= cos(w h sqrt(1 - z^2)), e = exp(-z w h)
        turn = phase * math.sqrt(max(0.0, 1.0 - ratio * ratio))
        return turn < 0.5 * math.pi and math.exp(-ratio * phase) <= math.cos(turn)

    low, high = 0, RATIO_STEPS
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if passive(middle / RATIO_STEPS) else (middle, high)
    return high / RATIO_STEPS


def _rounded(value: float, rounding: str) -> float:
    """To three digits, so that a person can read it and what is named can be had."""
    return float(Context(prec=3, rounding=rounding).create_decimal(value))


def _last(inside: Callable[[float], bool], low: float, high: float) -> float:
    """The last number from low on that is inside, by halving; low is inside, high is not."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if inside(middle) else (low, middle)
    return low
