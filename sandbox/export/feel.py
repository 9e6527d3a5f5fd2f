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
from sandbox.export.release import NoCurve, StepResponse, release_in_slices
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.format.slices import as_part, at_once
from sandbox.physics.analysis import feel_search, step_response
from sandbox.physics.arena import FIRST_ARENA, answer_of
from sandbox.physics.arrays import Floats
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.softness.body_motion import errors_of

# How near a thing's curve comes to what is asked for that it is as asked for a person.
AS_ASKED = 0.02
# How it feels, by the overshoot up to which, in one sentence.
FEELS = (
    (0.0, "It glides home: no overshoot, still after {time}."),
    (0.05, "It is firm: overshoots by {overshoot}, still after {time}."),
    (0.3, "It is springy: overshoots by {overshoot}, still after {time}."),
    (2.0, "It is bouncy: overshoots by {overshoot}, still after {time}."),
)
# Cs and Cd in words, with the springs that they are for; how near a search came: what was found, and what was asked.
PAIR, PAIR_OF_ALL = "{} for the springs of {}", "{} for all springs"
CLOSEST = "the closest that was found: {}, of {} asked"
ALL_HOOKE = "its springs are classic Hooke springs, which have no Cs and Cd"
# Why nothing is found that feels as asked, in a line; {}: the soonest that a spring settles.
REFUSALS = {
    feel_search.NO_SUCH: "an overshoot is from 0 up to 100 %, and settling takes more than two ticks",
    feel_search.TOO_SOON: "no spring that swings so far settles before {} s here",
}


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
    slot = None if particle is None else world.particle_slot(particle)
    released = yield from release_in_slices(world, springs_of(world, chosen.name), way == "aside", slot)
    return card_of(chosen.name, released)


def card_of(name: str, released: StepResponse) -> Feel:
    """The card of what was measured."""
    found = np.zeros(step_response.RESPONSE)
    found[step_response.TICK] = released.tick
    step_response.measure_response(released.errors, found)
    _, overshoot, settling, swings, *spring = found.tolist()
    return Feel(name, released, Numbers(overshoot, settling, int(swings)), *spring)


def material_of(world: LevelWorld, body: str) -> int | None:
    """The material (index) that all springs of a body are of; None: they are of several.

    Raises NoCurve where Cs and Cd do not apply to them.
    """
    springs = springs_of(world, body)
    springs = springs[world.law[springs] != LAW_HOOKE]
    if not len(springs):
        raise NoCurve(ALL_HOOKE)
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
        overshoots, times = (found.overshoot, self.overshoot), (found.settling, self.settling)
        return CLOSEST.format(*(f"{percent(o)} and {short(t)} s" for o, t in zip(overshoots, times, strict=True)))

    def pair_text(self, world: LevelWorld) -> str:
        """Cs and Cd in words, with the springs that they are for."""
        least = max(min(self.stiffness, self.damping), 1e-9)
        decimals = max(3, 2 - math.floor(math.log10(least)))
        pair = f"Cs {self.stiffness:.{decimals}f}, Cd {self.damping:.{decimals}f}"
        return (
            PAIR_OF_ALL.format(pair)
            if self.material is None
            else PAIR.format(pair, f'"{world.material_names[self.material]}"')
        )


# Gives the card of a thing in a world, in slices.
Measure = Callable[[LevelWorld], Generator[float, None, Feel]]


def sought(world: LevelWorld, overshoot: float, settling: float, measure: Measure, material: int | None) -> Sought:
    """Cs and Cd of the springs of a material with which a thing comes nearest to an overshoot [1] and a settling [s].

    measure: gives its card in a copy of the world. See feel_search.py. Raises ValueError, NoCurve.
    """
    return at_once(sought_in_slices(world, overshoot, settling, measure, material))


def sought_in_slices(
    world: LevelWorld, overshoot: float, settling: float, measure: Measure, material: int | None
) -> Generator[float, None, Sought]:
    """As `sought`, a tick at a time; says how much is done at least, 0..1."""
    search = np.zeros(feel_search.SEARCH)
    search[: feel_search.TRIED] = overshoot, settling, 1.0 / world.settings.tick_rate, *_pair_now(world, material)
    found: dict[int, Feel] = {}
    follows, arena = answer_of(feel_search.seek, FIRST_ARENA, search)
    refusal = NoCurve("")
    while follows == feel_search.TRY:
        number, tried = int(search[feel_search.ROUND]), copy.deepcopy(world)
        stiffness, damping = search[feel_search.TRIED : feel_search.HAS].tolist()
        tried.set_coefficients(stiffness, damping, material)
        try:
            feel = yield from as_part(measure(tried), (number - 1) / feel_search.SOUGHT, number / feel_search.SOUGHT)
        except NoCurve as error:
            refusal = error
        else:
            found[number] = feel
            numbers = feel.numbers
            search[feel_search.GOT : feel_search.MISSED] = (
                numbers.overshoot, numbers.settling, feel.stiffness, feel.damping,
            )  # fmt: skip
        search[feel_search.HAS] = number in found
        follows, arena = answer_of(feel_search.seek, len(arena), search)
    if follows == feel_search.NO_CURVE:
        raise refusal
    if follows != feel_search.OVER:
        raise ValueError(REFUSALS[follows].format(short(search[feel_search.SOONEST])))
    missed, stiffness, damping, number = search[feel_search.MISSED : feel_search.ROUND].tolist()
    return Sought(overshoot, settling, stiffness, damping, material, found[int(number)], missed)


def _pair_now(world: LevelWorld, material: int | None) -> tuple[float, float]:
    # Cs and Cd of the springs of a material as they are, those in the middle where they differ.
    mine = (world.material >= 0 if material is None else world.material == material) & world.spring_active
    mine &= world.law != LAW_HOOKE
    return float(np.median(world.stiffness[mine])), float(np.median(world.damping[mine]))


def sentence(feel: Feel) -> str:
    """How it feels, in one sentence."""
    numbers = feel.numbers
    text = next(text for most, text in FEELS if numbers.overshoot <= most)
    return text.format(overshoot=percent(numbers.overshoot), time=f"{short(numbers.settling)} s")
