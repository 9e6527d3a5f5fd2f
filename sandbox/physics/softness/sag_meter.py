"""How far the bodies of a world sag, and what makes them sag so far, measured by runs of their own solver.

`measured_bodies` says which bodies can be measured, SagMeters has a SagMeter for each. Its runs go on a little at a
time, while a window shows something else.
"""

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from time import perf_counter, process_time

import numpy as np

from sandbox.physics.arrays import Floats
from sandbox.physics.equation import of_springs
from sandbox.physics.jit import COMPILED
from sandbox.physics.keeping.equipment import FirmBody, Firmness, StiffForm, design_gravity
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.settings import WorldSettings
from sandbox.physics.softness.body_motion import Pair, SagCurve, present_coefficients, softness_of
from sandbox.physics.softness.firmness import FREQUENCIES, LARGEST_READ, FirmnessRange, firm_bodies, lowest_mode_of
from sandbox.physics.softness.kernels.reach import STANDING
from sandbox.physics.softness.settling import SettleRun, Support, SupportedBody, supported_body
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.world import World

# A search ends this near to what is asked, and after so many runs.
NEAR, MOST_RUNS = 0.004, 8
# Time of the processor [s] that may go into a sag, of which there may be an estimate, into a search, and into the
# curve, which nobody waits for; what needs more is not measured.
MOST_OF_SAG, MOST_OF_SEARCH, MOST_OF_CURVE = 4.0, 6.0, 10.0
# Time of the processor [s] after which a sag without an estimate is given up, and a search has a first answer.
PATIENCE, FIRST_ANSWER = 1.5, 0.4
CURVE_ASKED = "curve"
# Sags that a curve is measured at, about.
CURVE = (0.02, 0.08, 0.16, 0.3, 0.5)
# Cd at least of the run that tells how much of the damping holds up what stands, and what is taken before it is known.
LEAST_DAMPING, USUAL_SHARE = 0.2, 0.5
# What sags by less is rigid, to the eye and to a search.
RIGID = 1e-7
# Parts of what is guessed at first, where that is too soft to rest.
FOOTHOLDS = (1.0, 0.1, 0.01)
# Sags between these say where other runs come to rest; a search takes what sags by more for collapsed.
SMALL, LARGE, FLYING = 1e-5, 0.5, 2.0
# Halvings of the range of frequencies.
HALVINGS = 24

# Digits of lengths and masses by which bodies count as alike.
ALIKE = 9
# A rope or a net is set by its material, of whose springs at least this share is its own.
OWN = 0.9

# Work that goes on a tick of a run at a time, to a sag or a share.
Work = Generator[None, None, None]
Measuring = Generator[None, None, float]


@dataclass(frozen=True, eq=False)
class MeasuredBody:
    """A body by its name; slot: its place among `firm_bodies`, None: a rope or a net, which pins hold.

    lowest_mode: of its form; 0: it is not stiff without pins, or a net.
    """

    name: str
    body: FirmBody
    slot: int | None
    lowest_mode: float


class SagMeter:
    """Measures how far a body sags at pairs of Cs and Cd; questions are queued, and `advance` works on them.

    What was asked last comes first, and the curve after all that somebody waits for.

    lowest_mode: of its form; 0: it has none, and all its springs have one Cs and Cd.
    """

    def __init__(self, body: SupportedBody, settings: WorldSettings, lowest_mode: float) -> None:
        self.body, self.settings, self.mode = body, settings, lowest_mode
        gravity, h = design_gravity(*settings.gravity), 1.0 / settings.tick_rate
        self.range = FirmnessRange(lowest_mode or 1.0, body.length, gravity, h)
        self.curve: SagCurve | None = None
        self._damping_ratio = 1.0 if SOLVERS[settings.solver].bounded else USUAL_SHARE
        # Where a spring of a pair gets what it has in a substep.
        self._probe = World(settings)
        self._probe.add_particles(["a", "b"], [[0.0, 0.0], [1.0, 0.0]])
        self._probe.add_springs(["s"], [0], [1])
        self._sags: dict[Pair, float] = {}
        self._given_up: dict[Pair, float] = {}
        self._found: dict[float, Firmness | None] = {}
        self._last: tuple[float, Floats] | None = None
        self._jobs: dict[object, Work | Measuring] = {}
        self._work: dict[object, float] = {}

    # Questions.

    def sag(self, pair: Pair) -> float | None:
        """The sag of springs of that Cs, Cd and mode; None: not known yet, NaN: it cannot be measured."""
        if pair not in self._sags:
            self._ask(pair, self._sag_of(pair))
        return self.sag_known(pair)

    def sag_known(self, pair: Pair) -> float | None:
        """The sag of a pair if it is known already; nothing is measured for it."""
        return self._sags.get(pair, self._given_up.get(pair))

    def firmness(self, sag: float) -> tuple[bool, Firmness | None]:
        """Whether the search for Cs and Cd at which the body sags so far has ended, and its result; None: nothing."""
        if sag not in self._found:
            self._ask(sag, self._search(sag))
        return sag in self._found, self._found.get(sag)

    def first_answer(self, sag: float) -> Firmness | None:
        """A first guess of Cs and Cd for a sag, of a search that takes longer; None: too early, or none."""
        is_due = self._work.get(sag, 0.0) >= FIRST_ANSWER and self._has_reference
        return self._as_soft_as(self._guess(sag))[0] if is_due else None

    def trace(self) -> None:
        """Ask for the curve."""
        if self.curve is None:
            self._ask(CURVE_ASKED, self._trace())

    @property
    def is_busy(self) -> bool:
        """Whether there is something left to measure."""
        return bool(self._jobs)

    # Work.

    def advance(self, seconds: float) -> bool:
        """Work for so long at most; whether anything has come to be known."""
        end, news = perf_counter() + seconds, False
        while self._jobs and perf_counter() < end:
            waited_for = (question for question in reversed(self._jobs) if question != CURVE_ASKED)
            news = self._go_on(next(waited_for, CURVE_ASKED), end) or news
        return news

    def _go_on(self, question: object, end: float) -> bool:
        job, began, is_over = self._jobs[question], process_time(), False
        most = self._most_for(question) - self._work.get(question, 0.0)
        while not is_over and perf_counter() < end and process_time() - began < most:
            try:
                next(job)
            except StopIteration:
                is_over = True
        self._work[question] = self._work.get(question, 0.0) + process_time() - began
        if not is_over and self._work[question] < self._most_for(question):
            return False
        del self._jobs[question]
        if isinstance(question, tuple) and question not in self._sags:
            found = self.estimate(question)
            self._given_up[question] = math.nan if found is None else found
        elif isinstance(question, float) and question not in self._found:
            # Not measured itself, but near to what was.
            self._found[question] = self._as_soft_as(self._guess(question))[0] if self._has_reference else None
        return True

    def _most_for(self, question: object) -> float:
        if question == CURVE_ASKED:
            return MOST_OF_CURVE
        if isinstance(question, float):
            return MOST_OF_SEARCH
        return MOST_OF_SAG if self._has_reference else PATIENCE

    @property
    def _has_reference(self) -> bool:
        """Whether a sag is known from which others can be told."""
        return any(SMALL < sag < LARGE for sag in self._sags.values())

    def estimate(self, pair: Pair) -> float | None:
        """A guess of the sag at a pair from other results; None: there are none."""
        if self.curve is not None:
            stiffness, damping = (np.array([each]) for each in self._in_substep(pair))
            return float(self.curve.of(stiffness, damping)[0])
        if not self._has_reference:
            return None
        known = [(self._softness(each), sag) for each, sag in self._sags.items() if SMALL < sag < LARGE]
        soft = self._softness(pair)
        nearest, sag = min(known, key=lambda each: abs(math.log(each[0] / soft)))
        return sag * soft / nearest

    def _ask(self, question: object, job: Work | Measuring) -> None:
        if question not in self._jobs and self._work.get(question, 0.0) == 0.0:
            self._jobs[question] = job

    # What one run tells.

    def _sag_of(self, pair: Pair) -> Measuring:
        """The sag of a pair; measured by a run of its own if it is not known."""
        if pair not in self._sags:
            run = SettleRun(self.body, self.settings, self._that_swings(pair), self._moved_at(pair))
            while not run.advance():
                yield
            assert run.sag is not None
            self._sags[pair] = run.sag
            if SMALL < run.sag < LARGE:
                self._last = self._softness(pair), run.moved
        return self._sags[pair]

    def _that_swings(self, pair: Pair) -> Pair:
        """In the direct solver, where k alone carries loads: a pair of the same k that comes to rest sooner."""
        if not SOLVERS[self.settings.solver].bounded:
            return pair
        soft = self._softness(pair)
        _, swinging = self._as_soft_as(soft)
        return swinging if abs(self._softness(swinging) / soft - 1.0) < NEAR else pair

    def _moved_at(self, pair: Pair) -> Floats | float:
        """About how far the particles (n, 2) will move until they rest, from how far they moved in the last run."""
        # On a floor, what has moved lies in it.
        if self._last is None or self.body.support in (Support.FLOOR, Support.ENDS):
            return 0.0
        soft, moved = self._last
        ratio = self._softness(pair) / soft
        return moved * ratio if float(np.abs(moved).max()) * ratio < LARGE * self.body.length else 0.0

    def _softness(self, pair: Pair) -> float:
        stiffness, damping = self._in_substep(pair)
        return float(softness_of(np.array(stiffness), np.array(damping), self._damping_ratio))

    def _in_substep(self, pair: Pair) -> tuple[float, float]:
        for name, value in zip(("stiffness", "damping", "lowest_mode"), pair, strict=True):
            self._probe.change(name, value)
        stiffness, damping = present_coefficients(self._probe)
        return float(stiffness[0]), float(damping[0])

    # Searching.

    def springs_of(self, firmness: Firmness) -> Pair:
        """Cs and Cd of the springs of a body of that firmness. Raises OutOfReach."""
        whole = self.range.coefficients(firmness)
        if whole == (1.0, 1.0) or not self.mode > 0.0:
            return (*whole, 0.0)
        return (*of_springs(*whole, self.mode), self.mode)

    def _of_frequency(self, hz: float) -> Firmness:
        return self.range.nearest(Firmness(hz=float(f"{hz:.4g}")))

    def _as_soft_as(self, soft: float) -> tuple[Firmness, Pair]:
        return self.firmness_at(lambda pair: self._softness(pair) > soft, HALVINGS)

    def firmness_at(self, is_softer: Callable[[Pair], bool], halvings: int) -> tuple[Firmness, Pair]:
        """The firmness, and its springs, where springs stop being softer; the softest or the stiffest if they do not.

        halvings: of the range of frequencies.
        """
        low, high = (math.log(each) for each in FREQUENCIES)
        for _ in range(halvings):
            middle = 0.5 * (low + high)
            softer = is_softer(self.springs_of(self._of_frequency(math.exp(middle))))
            low, high = (middle, high) if softer else (low, middle)
        firmness = self._of_frequency(math.exp(0.5 * (low + high)))
        return firmness, self.springs_of(firmness)

    def _search(self, sag: float) -> Work:
        """Look for the firmness that sags so far, by the secant of all that runs have sagged, in logarithms."""
        if sag <= RIGID:
            self._found[sag] = Firmness(sag=0.0)
            return
        yield from self._find_foothold()
        tried: dict[Pair, tuple[Firmness, float]] = {}
        for _ in range(MOST_RUNS):
            firmness, pair = self._as_soft_as(self._guess(sag))
            if pair in tried:
                break
            found = yield from self._sag_of(pair)
            tried[pair] = firmness, abs(math.log(found / sag)) if 0.0 < found < LARGE else math.inf
            if tried[pair][1] <= NEAR:
                break
        nearest, far = min(tried.values(), key=lambda each: each[1])
        self._found[sag] = nearest if math.isfinite(far) else None

    def _guess(self, sag: float) -> float:
        """The softness at which the body probably sags so far."""
        known = sorted((self._softness(pair), each) for pair, each in self._sags.items() if SMALL < each < FLYING)
        below = [each for each in known if each[1] < sag]
        above = [each for each in known if each[1] >= sag]
        if below and above:
            (soft, low), (softer, high) = below[-1], above[0]
            fraction = math.log(sag / low) / math.log(high / low)
            return soft * (softer / soft) ** min(max(fraction, 0.03), 0.97)
        if known:
            soft, nearest = below[-1] if below else above[0]
            return soft * sag / nearest
        # As a box would that stands.
        hz = math.sqrt(STANDING * self.range.gravity / (sag * self.range.height))
        return self._softness(self.springs_of(self._of_frequency(hz)))

    def _trace(self) -> Work:
        """Measure the curve."""
        if not SOLVERS[self.settings.solver].bounded:
            self._damping_ratio = yield from self._find_damping_ratio()
        points: list[tuple[float, float]] = []
        yield from self._find_foothold()
        for sag in CURVE:
            _, pair = self._as_soft_as(self._guess(sag))
            found = yield from self._sag_of(pair)
            # What is softer than it should be has buckled, or flies.
            if not found > 0.0:
                break
            points = sorted([*points, (self._softness(pair), found)])
            rising = [each for k, each in enumerate(points) if k == 0 or each[1] > points[k - 1][1]]
            self.curve = SagCurve(self._damping_ratio, tuple(x for x, _ in rising), tuple(y for _, y in rising))

    def _find_foothold(self) -> Work:
        """Measure a sag from which others can be guessed, the stiffer the later."""
        for fraction in FOOTHOLDS:
            if self._has_reference:
                break
            _, pair = self._as_soft_as(self._guess(CURVE[0]) * fraction)
            yield from self._sag_of(pair)

    def _find_damping_ratio(self) -> Measuring:
        """The fraction of Cd that holds up a standing body, from runs at two Cd."""
        _, (stiffness, damping, mode) = self._as_soft_as(self._guess(CURVE[0]))
        if not SOLVERS[self.settings.solver].proven_limit:
            damping = max(damping, LEAST_DAMPING)
        sags, dampings = [], []
        for each in (damping, 0.5 * damping):
            pair = stiffness, each, mode
            sags.append((yield from self._sag_of(pair)))
            dampings.append(self._in_substep(pair)[1])
        if not sags[0] > 0.0 or not sags[1] > 0.0:
            return USUAL_SHARE
        # S ~ 1 - y Cd
        ratio = sags[1] / sags[0]
        below = ratio * dampings[0] - dampings[1]
        return min(max((ratio - 1.0) / below, 0.0), 1.0) if below > 0.0 else USUAL_SHARE


class SagMeters:
    """The meters of the bodies of a run: those that are alike, and held alike, have one in common."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[tuple[object, ...], SupportedBody]] = {}
        self._meters: dict[tuple[object, ...], SagMeter] = {}

    def of(self, world: World, measured: MeasuredBody) -> SagMeter:
        """The meter of a body that is held as it is now."""
        made_of = (id(world), world.topology_version, measured.body.shape, world.settings.gravity)
        kept = self._kept.get(measured.name)
        if kept is None or kept[0] != made_of:
            kept = self._kept[measured.name] = made_of, supported_body(world, measured.body)
        supported = kept[1]
        settings = replace(world.settings, wind=(0.0, 0.0))
        places = supported.points - supported.points.min(axis=0)
        exact = (supported.held, supported.rests, supported.gravity_scale, supported.friction, supported.pairs)
        about = (places, supported.mass, supported.rest, supported.radius)
        key = (
            settings, supported.support, *(each.tobytes() for each in exact),
            *(np.round(each, ALIKE).tobytes() for each in about),
        )  # fmt: skip
        if key not in self._meters:
            self._meters[key] = SagMeter(supported, settings, measured.lowest_mode)
        return self._meters[key]

    @property
    def busy(self) -> list[SagMeter]:
        """The meters with something left to measure."""
        return [meter for meter in self._meters.values() if meter.is_busy]

    def advance(self, seconds: float) -> bool:
        """Work for so long at most; whether anything has come to be known."""
        busy = self.busy
        return any([meter.advance(seconds / len(busy)) for meter in busy])


def measured_bodies(world: World) -> dict[str, MeasuredBody]:
    """The bodies that are stiff by their form, and the ropes and nets that pins hold from end to end, by name."""
    found = {}
    for slot, body in enumerate(firm_bodies(world)):
        is_whole = any(body is form for form in world.forms)
        mode = float(world.lowest_mode[body.springs[0]]) if is_whole else 0.0
        # While kernels are interpreted, finding one takes long.
        if not mode > 0.0 and COMPILED and len(body.shape.mass) <= LARGEST_READ:
            mode = lowest_mode_of(body.shape)
        # What is held everywhere cannot sag.
        if mode > 0.0 and not supported_body(world, body).held.all():
            found[body.name] = MeasuredBody(body.name, body, slot, mode)
    named: dict[str, list[int]] = {}
    for slot, name in enumerate(world.spring_names):
        owner, colon, _ = name.rpartition(":")
        if owner and colon and world.spring_active[slot] and world.law[slot] != LAW_HOOKE:
            named.setdefault(owner, []).append(slot)
    for name, springs in named.items():
        net = None if name in found else _net(world, name, springs)
        if net is not None:
            supported = supported_body(world, net)
            if supported.support is Support.SPANNED and not supported.held.all():
                found[name] = MeasuredBody(name, net, None, 0.0)
    return found


def _net(world: World, name: str, slots: list[int]) -> FirmBody | None:
    """A body of springs alone that has a material almost for itself; None: it is none."""
    springs = np.array(slots, np.int64)
    kinds = np.unique(world.material[springs])
    if len(kinds) != 1 or kinds[0] < 0 or OWN * np.count_nonzero(world.material == kinds[0]) > len(springs):
        return None
    ends = np.stack([world.particle_a[springs], world.particle_b[springs]], axis=1)
    particles, pairs = np.unique(ends, return_inverse=True)
    if not 3 <= len(particles) <= LARGEST_READ:
        return None
    none = np.zeros((0, 3), np.int64)
    shape = StiffForm(world.origin[particles], world.mass[particles], pairs.reshape(-1, 2), none, none)
    return FirmBody(name, shape, springs, np.zeros(0, np.int64))
