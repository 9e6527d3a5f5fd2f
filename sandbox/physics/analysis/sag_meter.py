"""SagMeter: measures how far a body sags, and what makes it sag so far, by runs of the body's own solver.

Its runs go on a little at a time, while a window shows something else.
"""

import math
from collections.abc import Generator
from time import perf_counter

import numpy as np

from sandbox.physics.analysis.body_motion import present_coefficients
from sandbox.physics.analysis.firmness import FirmnessRange, OutOfReach
from sandbox.physics.analysis.sag_curve import SagCurve, softness_of
from sandbox.physics.analysis.stance import Stance
from sandbox.physics.analysis.standing import StandingRun
from sandbox.physics.equation import of_springs
from sandbox.physics.keeping.forms import Firmness, strength_of
from sandbox.physics.settings import WorldSettings
from sandbox.physics.solvers import SOLVERS

# A search ends this near to what is asked, and after so many runs.
NEAR, MOST_RUNS = 0.004, 8
# Work [s] that one question may take; what needs more is not measured.
MOST_WORK = 2.5
# Where a curve begins, and how many times as soft each of its runs is as the first; beyond this sag it ends.
CURVE_FROM, CURVE_STEPS, CURVE_TO = 0.02, (1.0, 4.0, 9.0, 18.0, 32.0), 0.5
# Cd at least of the run that tells how much of the damping holds up what stands.
LEAST_DAMPING = 0.2
# What sags by less is rigid, to the eye and to a search.
RIGID = 1e-7
# Softest that a search goes to, in what a sag would be by the slowest wobble alone.
SOFTEST = 8.0

Pair = tuple[float, float, float]
Steps = Generator[None, None, float]


class SagMeter:
    """Answers of one body in one stance; None: not known yet, and asked for. `advance` goes on with the work.

    lowest_mode: of its form; 0: it has none, and all its springs have Cs and Cd in common.
    """

    def __init__(self, stance: Stance, settings: WorldSettings, lowest_mode: float) -> None:
        self.stance, self.settings, self.mode = stance, settings, lowest_mode
        self.range = FirmnessRange(
            lowest_mode or 1.0, stance.length, strength_of(settings.gravity), 1.0 / settings.tick_rate
        )
        self.curve: SagCurve | None = None
        self._run: StandingRun | None = None
        self._sags: dict[Pair, float] = {}
        self._found: dict[float, Firmness | None] = {}
        self._jobs: dict[object, Generator[None, None, None]] = {}
        self._work: dict[object, float] = {}

    # Questions.

    def sag(self, stiffness: float, damping: float, lowest_mode: float) -> float | None:
        """The sag at Cs and Cd per tick, as springs with that lowest mode get them; NaN: it cannot be measured."""
        pair = stiffness, damping, lowest_mode
        if pair not in self._sags:
            self._ask(pair, self._measure(pair))
        return self._sags.get(pair)

    def firmness(self, sag: float) -> tuple[bool, Firmness | None]:
        """Whether it is known what makes the body sag so far, and that; None: nothing does."""
        if sag not in self._found:
            self._ask(sag, self._search(sag))
        return sag in self._found, self._found.get(sag)

    def trace(self) -> None:
        """Ask for the curve."""
        if self.curve is None:
            self._ask("curve", self._trace())

    @property
    def is_busy(self) -> bool:
        """Whether there is work to go on with."""
        return bool(self._jobs)

    def forget(self, question: object) -> None:
        """Ask no longer what is not known yet."""
        self._jobs.pop(question, None)

    # Work.

    def advance(self, seconds: float) -> bool:
        """Work for so long at least; whether anything has come to be known."""
        start = perf_counter()
        news = False
        while self._jobs and perf_counter() - start < seconds:
            # What was asked last is wanted first.
            question = next(reversed(self._jobs))
            news = self._go_on(question, start, seconds) or news
        return news

    def _go_on(self, question: object, start: float, seconds: float) -> bool:
        job, began = self._jobs[question], perf_counter()
        over = False
        while not over and perf_counter() - start < seconds:
            try:
                next(job)
            except StopIteration:
                over = True
        self._work[question] = self._work.get(question, 0.0) + perf_counter() - began
        if not over and self._work[question] < MOST_WORK:
            return False
        del self._jobs[question]
        if not over:
            self._give_up(question)
        return True

    def _give_up(self, question: object) -> None:
        if isinstance(question, tuple):
            self._sags[question] = math.nan
        elif isinstance(question, float):
            self._found[question] = None

    def _ask(self, question: object, job: Generator[None, None, None]) -> None:
        if question not in self._jobs and self._work.get(question, 0.0) < MOST_WORK:
            self._jobs[question] = job

    def _measure(self, pair: Pair) -> Generator[None, None, None]:
        yield from self._sag_of(pair)

    def _sag_of(self, pair: Pair) -> Steps:
        """The sag at a pair, from a run of its own if it is not known."""
        if pair not in self._sags:
            run = StandingRun(self.stance, self.settings)
            run.take(*pair)
            while not run.advance(1):
                yield
            assert run.sag is not None
            self._sags[pair] = run.sag
            self._run = run
        return self._sags[pair]

    def springs_of(self, firmness: Firmness) -> Pair:
        """Cs and Cd per tick and lowest mode that springs of that firmness have. Raises OutOfReach."""
        whole = self.range.coefficients(firmness)
        if whole == (1.0, 1.0):
            return (*whole, 0.0)
        return (*of_springs(*whole, self.mode), self.mode) if self.mode > 0.0 else (*whole, 0.0)

    def _by_wobble(self, sag: float) -> Firmness:
        """The firmness whose slowest wobble alone would sag so far. Raises OutOfReach."""
        hz = math.sqrt(0.0565 * self.range.gravity / (sag * max(self.range.height, 1e-9)))
        return self.range.nearest(Firmness(hz=float(f"{hz:.4g}")))

    def _search(self, sag: float) -> Generator[None, None, None]:
        """Look for the firmness that sags so far, by the secant of what runs have sagged, in logarithms."""
        self._found.pop(sag, None)
        if sag <= RIGID:
            self._found[sag] = Firmness(sag=0.0)
            return
        tried: list[tuple[float, float]] = []
        soft = self._guess(sag)
        for _ in range(MOST_RUNS):
            try:
                firmness = self._by_wobble(min(soft, SOFTEST))
                pair = self.springs_of(firmness)
            except OutOfReach:
                break
            found = yield from self._sag_of(pair)
            if abs(found / sag - 1.0) <= NEAR:
                self._found[sag] = firmness
                return
            if math.isfinite(found) and found > 0.0:
                tried.append((math.log(soft), math.log(found)))
            soft = self._next(tried, soft, math.log(sag))
            if soft > SOFTEST:
                break
        self._found[sag] = None

    def _guess(self, sag: float) -> float:
        return sag

    @staticmethod
    def _next(tried: list[tuple[float, float]], soft: float, wanted: float) -> float:
        """The softness to try next."""
        if not tried:
            return 0.25 * soft
        low = max((each for each in tried if each[1] < wanted), default=None)
        high = min((each for each in tried if each[1] > wanted), default=None)
        if low is None or high is None:
            x, y = tried[-1]
            return math.exp(x + wanted - y)
        share = min(max((wanted - low[1]) / (high[1] - low[1]), 0.05), 0.95)
        return math.exp(low[0] + share * (high[0] - low[0]))

    def _trace(self) -> Generator[None, None, None]:
        """Measure the curve."""
        share = 1.0
        if not SOLVERS[self.settings.solver].bounded:
            share = yield from self._damping_share()
        points: list[tuple[float, float]] = []
        soft = CURVE_FROM
        for step in CURVE_STEPS:
            try:
                pair = self.springs_of(self._by_wobble(soft * step))
            except OutOfReach:
                continue
            sag = yield from self._sag_of(pair)
            if step == 1.0 and 0.0 < sag < CURVE_FROM:
                # From here on in measured sags.
                soft *= CURVE_FROM / sag
            if not 0.0 < sag:
                break
            points.append((self._softness(pair, share), sag))
            if sag > CURVE_TO:
                break
        points.sort()
        rising = [each for k, each in enumerate(points) if k == 0 or each[1] > points[k - 1][1]]
        if rising:
            self.curve = SagCurve(share, tuple(x for x, _ in rising), tuple(y for _, y in rising))

    def _softness(self, pair: Pair, share: float) -> float:
        """Softness in a substep of springs of a pair per tick."""
        stiffness, damping = self._in_substep(pair)
        return float(softness_of(np.array(stiffness), np.array(damping), share))

    def _in_substep(self, pair: Pair) -> tuple[float, float]:
        assert self._run is not None
        world = self._run.world
        for name, value in zip(("stiffness", "damping", "lowest_mode"), pair, strict=True):
            world.change(name, value)
        stiffness, damping = present_coefficients(world)
        return float(stiffness[0]), float(damping[0])

    def _damping_share(self) -> Steps:
        """Which part of Cd holds up what stands, from runs at two Cd."""
        stiffness, damping, mode = self.springs_of(self._by_wobble(CURVE_FROM))
        high = max(damping, LEAST_DAMPING) if not SOLVERS[self.settings.solver].proven_limit else damping
        sags, dampings = [], []
        for each in (high, 0.5 * high):
            pair = stiffness, each, mode
            sags.append((yield from self._sag_of(pair)))
            dampings.append(self._in_substep(pair)[1])
        if not sags[0] > 0.0 or not sags[1] > 0.0:
            return 0.0
        # S ~ 1 - y Cd
        ratio = sags[1] / sags[0]
        below = ratio * dampings[0] - dampings[1]
        return min(max((ratio - 1.0) / below, 0.0), 1.0) if below > 0.0 else 0.0
