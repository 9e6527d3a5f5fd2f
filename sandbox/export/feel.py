"""Feel: how a thing comes back when it is let go, in the words of those who design motion; and from these to Cs, Cd.

The card has what is measured on the thing itself (release.py), the single spring that comes nearest to it, and how far
apart both are. A curve is how far the way is done, 0 as it is let go and 1 in the end.
"""

import copy
import math
from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np

from sandbox.export.engines import choose_body, springs_of
from sandbox.export.numbers import percent, short
from sandbox.export.release import NoCurve, StepResponse, particle_to_pull, release_in_slices
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.format.slices import as_part, at_once
from sandbox.physics.arrays import Floats
from sandbox.physics.equation import (
    HIGHEST_COEFFICIENT,
    coefficients_from_frequency,
    frequency_from_coefficients,
    highest_frequency,
)
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.softness.body_motion import AT_REST, errors_of

# Overshoots below this are none.
UNSEEN = 0.002
# Rounds in which a single spring is fitted to a curve, brought to an overshoot, and Cs and Cd of a thing are sought.
FITS, ROUNDS, SOUGHT = 40, 12, 10
# The highest frequency that is tried, as a share of the highest that there is, and in a tick; halvings until one
# settles in time.
HIGH, HIGHEST, BISECTIONS = 0.99, 0.4, 40
# How far the search goes at once, and where it has come to what it aimed at, in logarithms.
FARTHEST, REACHED = 1.5, 0.03
# How far off the single spring's Cs and Cd are at most that the search goes on from there alone.
ENOUGH = 0.25
# How near a thing's curve comes to what is asked for until that is enough, and what is as asked for a person.
NEAR, AS_ASKED = 0.01, 0.02


@dataclass(frozen=True)
class Numbers:
    """What a curve is in numbers: overshoot [1]; settling [s]: until no more than 2 % is left for good.

    swings: how often it passes its place by more than that.
    """

    overshoot: float
    settling: float
    swings: int


@dataclass(frozen=True, eq=False)
class Feel:
    """The card of a thing: its name, what was measured, and the single spring that comes nearest.

    stiffness, damping: Cs and Cd of that spring, of one tick. hz, ratio: its frequency [Hz] and damping ratio.
    difference: the largest distance between both curves, as a share of the way.
    """

    name: str
    released: StepResponse
    numbers: Numbers
    stiffness: float
    damping: float
    hz: float
    ratio: float
    difference: float

    @property
    def curve(self) -> Floats:
        """How far the way is done, tick by tick."""
        return 1.0 - self.released.errors

    @property
    def spring_curve(self) -> Floats:
        """The same of the single spring."""
        return 1.0 - errors_of(self.stiffness, self.damping, len(self.released.errors) - 1)


def numbers_of(errors: Floats, tick: float) -> Numbers:
    """The numbers of a curve of errors, a tick [s] apart, which is 1 first."""
    peaks = _peaks(errors)
    overshoot = max(0.0, -min(peaks, default=0.0))
    beyond = np.flatnonzero(np.abs(errors) > AT_REST)
    last = int(beyond[-1])
    after = abs(float(errors[last + 1])) if last + 1 < len(errors) else 0.0
    before = abs(float(errors[last]))
    same_side = last + 1 < len(errors) and errors[last] * errors[last + 1] > 0.0
    share = (before - AT_REST) / (before - after if same_side else before + after) if before > AT_REST else 0.0
    return Numbers(
        overshoot if overshoot > UNSEEN else 0.0, tick * (last + share), sum(abs(v) > AT_REST for v in peaks)
    )


def _peaks(errors: Floats) -> list[float]:
    # The turning points after the start, of cosines about 0 through three ticks: parabolas cut quick swings short.
    found = []
    for k in range(1, len(errors) - 1):
        a, b, c = (float(v) for v in errors[k - 1 : k + 2])
        if (b - a) * (c - b) < 0.0 or (b == a != c and k > 1):
            cosine = (a + c) / (2.0 * b) if abs(a + c) < 2.0 * abs(b) else 1.0
            across = (c - a) / (2.0 * math.sqrt(1.0 - cosine * cosine)) if cosine < 1.0 else 0.0
            found.append(math.copysign(math.hypot(b, across), b))
    return found


def nearest_spring(errors: Floats) -> tuple[float, float]:
    """Cs and Cd of the single spring whose errors come nearest to some, by least squares (Gauss and Newton)."""
    steps = len(errors) - 1
    stiffness, damping = _recurrence(errors)

    def misses(point: Floats) -> Floats:
        return errors_of(float(point[0]), float(point[1]), steps) - errors

    point, damp = np.array([stiffness, damping]), 1e-3
    value = float(np.sum(misses(point) ** 2))
    for _ in range(FITS):
        miss, shift = misses(point), 1e-6
        columns = [(misses(point + shift * axis) - miss) / shift for axis in np.eye(2)]
        slopes = np.stack(columns, axis=1)
        normal = slopes.T @ slopes
        change = np.linalg.solve(normal + damp * np.diag(np.diag(normal) + 1e-12), -slopes.T @ miss)
        there = np.clip(point + change, 1e-9, HIGHEST_COEFFICIENT)
        reached = float(np.sum(misses(there) ** 2))
        damp = damp / 4.0 if reached < value else damp * 8.0
        if reached < value:
            ended = value - reached <= 1e-15 * (1.0 + value)
            point, value = there, reached
            if ended:
                break
    return float(point[0]), float(point[1])


def _recurrence(errors: Floats) -> tuple[float, float]:
    # x'' = (2 - Cs - Cd) x' - (1 - Cd) x, by least squares, with the step before it was let go: x' = x.
    x = np.concatenate([errors[:1], errors])
    # x'' - 2 x' + x = -Cs x' - Cd (x' - x)
    rows = np.stack([-x[1:-1], -(x[1:-1] - x[:-2])], axis=1)
    found = np.linalg.lstsq(rows, x[2:] - 2.0 * x[1:-1] + x[:-2], rcond=None)[0]
    low, high = 1e-6, HIGHEST_COEFFICIENT
    return float(np.clip(found[0], low, high)), float(np.clip(found[1], low, high))


def feel_of(world: LevelWorld, body: str | None = None, particle: str | None = None, way: str = "down") -> Feel:
    """The card of a body of a world as it stands; None: the first that has springs.

    particle: what is pulled; None: what is farthest from all that holds the body. way: "down", as gravity has it, or
    "aside".

    Raises NoSuchBody, NoCurve, and KeyError where there is no such particle.
    """
    return at_once(feel_in_slices(world, body, particle, way))


def feel_in_slices(
    world: LevelWorld, body: str | None = None, particle: str | None = None, way: str = "down"
) -> Generator[float, None, Feel]:
    """As `feel_of`, a tick at a time; says how much is done, 0..1."""
    chosen = choose_body(world, body)
    particles = np.unique(np.concatenate([world.particle_a[chosen.springs], world.particle_b[chosen.springs]]))
    slot = particle_to_pull(world, particles) if particle is None else world.particle_slot(particle)
    down = np.array(world.settings.gravity) if any(world.settings.gravity) else np.array([0.0, -1.0])
    along = down if way == "down" else np.array([-down[1], down[0]])
    size = float(np.max(np.ptp(world.position[particles], axis=0)))
    released = yield from release_in_slices(world, slot, along.tolist(), size)
    return card_of(chosen.name, released)


def card_of(name: str, released: StepResponse) -> Feel:
    """The card of what was measured."""
    stiffness, damping = nearest_spring(released.errors)
    hz, ratio = frequency_from_coefficients(stiffness, damping, released.tick)
    spring = errors_of(stiffness, damping, len(released.errors) - 1)
    difference = float(np.max(np.abs(spring - released.errors)))
    return Feel(
        name, released, numbers_of(released.errors, released.tick), stiffness, damping, hz, ratio, difference
    )  # fmt: skip


def pair_for(overshoot: float, settling: float, tick: float) -> tuple[float, float]:
    """Cs and Cd, of a tick [s], of a single spring that overshoots by a share [1] and settles after so long [s].

    Raises ValueError where no spring does: what is asked for takes less than two ticks, or overshoots by all or more.
    """
    return at_once(_pair_in_slices(overshoot, settling, tick))


def _pair_in_slices(overshoot: float, settling: float, tick: float) -> Generator[float, None, tuple[float, float]]:
    if not (0.0 <= overshoot < 1.0 and settling > 2.0 * tick):
        raise ValueError("an overshoot is from 0 up to 100 %, and settling takes more than two ticks")
    asked, wanted = overshoot, (0.0, 0.0)
    for number in range(ROUNDS):
        yield number / ROUNDS
        # exp(-pi z / sqrt(1 - z^2)) of the overshoot, which a spring in ticks misses by a little.
        fall = -math.log(max(asked, UNSEEN)) / math.pi
        wanted = _settling_in(settling, fall / math.hypot(1.0, fall) if overshoot > UNSEEN else 1.0, tick)
        found = numbers_of(errors_of(*wanted, _steps(settling, tick)), tick).overshoot
        if overshoot <= UNSEEN or abs(found - overshoot) < 1e-4 * overshoot:
            break
        asked = min(0.999, asked * overshoot / max(found, UNSEEN))
    return wanted


def _settling_in(settling: float, ratio: float, tick: float) -> tuple[float, float]:
    # Cs and Cd of the spring of a damping ratio that settles in time: the higher its frequency, the sooner it does.
    def settles(hz: float) -> float:
        errors = errors_of(*coefficients_from_frequency(hz, ratio, tick), _steps(settling, tick))
        return numbers_of(errors, tick).settling

    low, high = 0.1 / settling, min(HIGH * highest_frequency(ratio, tick), HIGHEST / tick)
    soonest = settles(high)
    if soonest > settling:
        raise ValueError(f"no spring that swings so far settles before {short(soonest)} s here")
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if settles(middle) > settling else (low, middle)
    return coefficients_from_frequency(high, ratio, tick)


def _steps(settling: float, tick: float) -> int:
    return math.ceil(8.0 * settling / tick) + 60


def material_of(world: LevelWorld, body: str) -> int | None:
    """The material (index) that all springs of a body are of; None: they are of several.

    Raises NoCurve where Cs and Cd do not apply to them.
    """
    springs = springs_of(world, body)
    springs = springs[world.law[springs] != LAW_HOOKE]
    if not len(springs):
        raise NoCurve("its springs are classic Hooke springs, which have no Cs and Cd")
    found = np.unique(world.material[springs])
    return int(found[0]) if len(found) == 1 else None


@dataclass(frozen=True, eq=False)
class Sought:
    """What was found for an overshoot [1] and a settling [s]: Cs and Cd of the springs of a material, None: of all.

    feel: the card of the thing with them. missed: how far it is from what was asked, as a share.
    """

    overshoot: float
    settling: float
    stiffness: float
    damping: float
    material: int | None
    feel: Feel
    missed: float

    @property
    def nearness(self) -> str:
        """How near it is to what was asked, as the end of a sentence."""
        if self.missed <= AS_ASKED:
            return "as asked"
        found = self.feel.numbers
        return (
            f"the closest that was found: {percent(found.overshoot)} and {short(found.settling)} s, "
            f"of {percent(self.overshoot)} and {short(self.settling)} s asked"
        )

    def pair_text(self, world: LevelWorld) -> str:
        """Cs and Cd in words, with the springs that they are for."""
        least = max(min(self.stiffness, self.damping), 1e-9)
        decimals = max(3, 2 - math.floor(math.log10(least)))
        springs = "all springs" if self.material is None else f'the springs of "{world.material_names[self.material]}"'
        return f"Cs {self.stiffness:.{decimals}f}, Cd {self.damping:.{decimals}f} for {springs}"


# Gives the card of a thing in a world, in slices.
Measure = Callable[[LevelWorld], Generator[float, None, Feel]]


def sought(world: LevelWorld, overshoot: float, settling: float, measure: Measure, material: int | None) -> Sought:
    """Cs and Cd of the springs of a material with which a thing comes nearest to an overshoot [1] and a settling [s].

    measure: gives its card in a copy of the world. What a thing makes of Cs and Cd, as a single spring, is brought to
    what is wanted (Broyden 1965). Raises ValueError, NoCurve.
    """
    return at_once(sought_in_slices(world, overshoot, settling, measure, material))


def sought_in_slices(
    world: LevelWorld, overshoot: float, settling: float, measure: Measure, material: int | None
) -> Generator[float, None, Sought]:
    """As `sought`, a tick at a time; says how much is done at least, 0..1."""
    part = 1.0 / (SOUGHT + 1)
    aim, tick = (overshoot, settling), 1.0 / world.settings.tick_rate
    aimed = _worth((yield from as_part(_pair_in_slices(*aim, tick), 0.0, part)))
    # From where it is now, or where a single spring would be: from what is nearer.
    begins = [_pair_now(world, material), aimed]
    there, at, slopes = begins.pop(), aimed, np.eye(2)
    best: Sought | None = None
    for number in range(1, SOUGHT + 1):
        pair, feel = _pair(there), None
        tried = copy.deepcopy(world)
        tried.set_coefficients(*pair, material)
        try:
            feel = yield from as_part(measure(tried), part * number, part * (number + 1))
        except NoCurve:
            if best is None and not begins:
                raise
        miss = math.inf if feel is None else _missed(feel, overshoot, settling)
        is_better = feel is not None and (best is None or miss < best.missed)
        change, now = there - at, np.zeros(2) if feel is None else _worth((feel.stiffness, feel.damping))
        if best is not None and feel is not None and change.any() and not begins:
            made = _worth((best.feel.stiffness, best.feel.damping))
            slopes += np.outer(now - made - slopes @ change, change) / float(change @ change)
        if feel is not None and is_better:
            best, at = Sought(overshoot, settling, *pair, material, feel, miss), there
        if miss < NEAR:
            break
        if miss > ENOUGH and begins:
            there = begins.pop()
            continue
        begins.clear()
        if feel is None or not is_better:
            # Too far: springs that are that soft let it lie on something, or turn over.
            there = 0.5 * (there + at)
            continue
        if float(np.max(np.abs(now - aimed))) < REACHED:
            # It is that single spring by now, and its curve is another one nevertheless: aim to the other side of it.
            aim = max(aim[0] + overshoot - feel.numbers.overshoot, 0.0), aim[1] * settling / feel.numbers.settling
            try:
                aimed = _worth((yield from as_part(_pair_in_slices(*aim, tick), *2 * (part * (number + 1),))))
            except ValueError:
                break
        there = at + np.clip(np.linalg.lstsq(slopes, aimed - now, rcond=None)[0], -FARTHEST, FARTHEST)
    assert best is not None
    return best


def _missed(feel: Feel, overshoot: float, settling: float) -> float:
    return max(abs(feel.numbers.overshoot - overshoot), abs(feel.numbers.settling / settling - 1.0))


def _pair_now(world: LevelWorld, material: int | None) -> Floats:
    # What Cs and Cd of the springs of a material are worth as they are, those in the middle where they differ.
    mine = (world.material >= 0 if material is None else world.material == material) & world.spring_active
    mine &= world.law != LAW_HOOKE
    return _worth((float(np.median(world.stiffness[mine])), float(np.median(world.damping[mine]))))


def _worth(pair: tuple[float, float]) -> Floats:
    # Logarithms of Cs / (1 - Cd), which is what a spring is worth, and of -log(1 - Cd), which is how it decays.
    left = max(1.0 - pair[1], 1e-12)
    return np.log([max(pair[0], 1e-12) / left, max(-math.log(left), 1e-12)])


def _pair(worth: Floats) -> tuple[float, float]:
    stiff, decay = np.exp(worth).tolist()
    left = math.exp(-decay)
    return min(stiff * left, HIGHEST_COEFFICIENT), min(1.0 - left, HIGHEST_COEFFICIENT)


def sentence(feel: Feel) -> str:
    """How it feels, in one sentence."""
    numbers = feel.numbers
    still = f"still after {short(numbers.settling)} s"
    if numbers.overshoot == 0.0:
        return f"It glides home: no overshoot, {still}."
    word = "firm" if numbers.overshoot < 0.05 else "springy" if numbers.overshoot < 0.3 else "bouncy"
    return f"It is {word}: overshoots by {percent(numbers.overshoot)}, {still}."
