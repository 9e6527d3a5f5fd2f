"""Rules of a level as the table that kernels read, and the rows of a world's state that they need."""

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple, assert_never

import numpy as np
from numpy.typing import ArrayLike

from sandbox.level.checks import METRICS
from sandbox.level.document.model import Level, ZoneDef
from sandbox.level.format.quantities import Point
from sandbox.level.plan.plan import Plan
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.rules.player_limits import PlayerLimits
from sandbox.level.rules.rule import WALLS, QuestionDef, RuleDef
from sandbox.physics import rules
from sandbox.physics.arrays import Slots
from sandbox.physics.commands.command_table import CODES
from sandbox.physics.keeping.growing import grow
from sandbox.physics.rules import NOBODY, Rules, Terms, Things
from sandbox.physics.state import Family
from sandbox.physics.ways import followed
from sandbox.physics.world import World
from sandbox.physics.zones import BOX, CIRCLE, POLYGON, Zones

_KINDS = {
    "x": rules.CENTRE_X, "y": rules.CENTRE_Y, "speed": rules.SPEED, "distance": rules.DISTANCE,
    "inside": rules.INSIDE, "max_speed": rules.FASTEST, "strain": rules.STRAIN, "kinetic_energy": rules.MOTION,
    "broken_springs": rules.BROKEN, "non_finite": rules.UNSOUND, "settled": rules.SETTLED, "held": rules.BROKEN,
    "all": rules.ALL, "any": rules.ANY, "none": rules.NOT,
}  # fmt: skip
_OF_SPRINGS = ("strain", "broken_springs")


class _Term(NamedTuple):
    """A row of Terms; about: slots, or the terms that it asks."""

    kind: int
    about: Sequence[int] = ()
    zone: int = 0
    other: int = 0
    low: float = -math.inf
    high: float = math.inf


def add_rules(world: World, level: Level, plan: Plan, slots: Slots) -> None:
    """Give a world a level's rules and counters, and behind them a counter for each budget of hands.

    slots: the slot of each particle before welds.
    """
    if level.rules or level.counters:
        _add_rules(world, level, plan, slots)
    if level.hands is not None:
        _add_hands(world, level.hands)


def _add_hands(world: World, hands: PlayerLimits) -> None:
    _append(world, Family.COUNTER, hands.counter_names, counter=[most + 0.0 for most in hands.budgets.values()])
    count = len(world.counter)
    kinds = sorted(CODES, key=CODES.__getitem__)
    budgets = [hands.budget_of(kind) for kind in kinds]
    rows = [hands.row(budget, count) if budget else -1 for budget in budgets]
    refused = [hands.refuses(kind) for kind in kinds]
    _append(world, Family.DEED, kinds, deed_refused=refused, deed_budget=np.array(rows, np.int64))
    world.untouchable[:] = [not hands.lets_touch(name) for name in world.particle_names]
    world.spring_untouchable[:] = [not hands.lets_touch(name) for name in world.spring_names]


def _add_rules(world: World, level: Level, plan: Plan, slots: Slots) -> None:
    maker = _Maker(world, level, plan, slots)
    rules = run_rules(level)
    roots = [maker.root(rule) for rule in rules]
    rate = level.settings.tick_rate
    world.rules = maker.rules(roots, [round(rule.for_seconds * rate) for rule in rules], [rule.once for rule in rules])
    counters = level.counters
    _append(world, Family.RULE, [rule.id for rule in rules])
    _append(world, Family.COUNTER, [each.id for each in counters], counter=[each.start + 0.0 for each in counters])
    rows = np.array(maker.probes, np.int64).reshape(-1, 2)
    world.ways = followed(world.rules.zones, rows, world.particle_count)
    _append(world, Family.PROBE, maker.probing, probe_position=world.position[rows[:, 0]])
    _append(world, Family.STILL, maker.settling)
    _append(world, Family.KEY, maker.keys)


def _append(world: World, family: Family, names: Sequence[str], **arrays: ArrayLike) -> None:
    grow(world, family, len(names), arrays)
    world.row_names[family] += tuple(names)


def rule_keys(level: Level) -> tuple[str, ...]:
    """The keys that rules ask for, in the order of the file: of each row of the family KEY."""

    def keys(question: QuestionDef) -> Iterable[str]:
        yield from [question.key] if question.key is not None else ()
        yield from itertools.chain.from_iterable(map(keys, question.members))

    return tuple(dict.fromkeys(key for rule in level.rules for key in keys(rule.when)))


class _Maker:
    """Makes the terms of questions, each behind those that it asks."""

    def __init__(self, world: World, level: Level, plan: Plan, slots: Slots) -> None:
        self._world, self._level, self._plan, self._slots = world, level, plan, slots
        self._zones = [zone.id for zone in level.zones]
        self._counters = level.counter_names
        self.keys = rule_keys(level)
        self._things = _things(level, plan)
        self._terms: list[_Term] = []
        # Particles whose way is followed, and the zones that they may cross.
        self.probes: list[tuple[int, int]] = []
        # The rule whose question is made, and that of each probe and each question whether something has settled.
        self._asking = ""
        self.probing: list[str] = []
        self.settling: list[str] = []

    def root(self, rule: RuleDef) -> int:
        """The number of the term that a rule asks."""
        self._asking = rule.id
        return self.term(rule.when)

    def term(self, asked: QuestionDef) -> int:
        """The number of a new term that asks this."""
        made = self._made(asked)
        self._terms.append(made)
        return len(self._terms) - 1

    def _made(self, asked: QuestionDef) -> _Term:
        low = -math.inf if asked.at_least is None else asked.at_least + 0.0
        high = math.inf if asked.at_most is None else asked.at_most + 0.0
        asks = asked.asked[0]
        value = getattr(asked, asks)
        match asks:
            case "touches":
                one, *others = (self._things[name] for name in value)
                return _Term(rules.TOUCHES, (), one, others[0] if others else NOBODY)
            case "crosses":
                about, zone = self._particles(asked), self._zones.index(value)
                first = len(self.probes)
                self.probes += [(slot, zone) for slot in about]
                self.probing += [self._asking] * len(about)
                return _Term(rules.CROSSES, about, other=first, low=1.0, high=1.0)
            case "breaks":
                return _Term(rules.BROKEN, self._springs(value), low=1.0)
            case "counter":
                return _Term(rules.COUNTER, (), 0, self._counters.index(value), low, high)
            case "key":
                return _Term(rules.KEY, (), 0, self.keys.index(value), 1.0, 1.0)
            case "time":
                return _Term(rules.TIME, low=value)
            case "metric":
                return self._of_metric(asked, low, high)
            case "all" | "any" | "none":
                return _Term(_KINDS[asks], [self.term(member) for member in value])
            case _:
                assert_never(asks)

    def _of_metric(self, asked: QuestionDef, low: float, high: float) -> _Term:
        metric = str(asked.metric)
        usual, kind = METRICS[metric].at_least, _KINDS[metric]
        if asked.at_least is None and asked.at_most is None and usual is not None:
            low = usual
        if metric in _OF_SPRINGS:
            return _Term(kind, self._springs(asked.body), low=low, high=high)
        if metric == "held":
            # A hand holds something by a spring: as many are gone as hands are empty.
            hands = [slot for slot in range(self._world.spring_count) if self._world.is_grab_spring(slot)]
            return _Term(kind, hands, low=len(hands) - high, high=len(hands) - low)
        other = 0
        if kind == rules.SETTLED:
            other = len(self.settling)
            self.settling.append(self._asking)
        elif kind == rules.DISTANCE:
            other = self._slot(str(asked.other))
        zone = self._zones.index(str(asked.zone)) if kind == rules.INSIDE else 0
        return _Term(kind, self._particles(asked), zone, other, low, high)

    def _slot(self, name: str) -> int:
        return int(self._slots[self._plan.layout.slot(name)])

    def _particles(self, asked: QuestionDef) -> list[int]:
        """Slots of a particle, a body, or all."""
        if asked.particle is not None:
            return [self._slot(asked.particle)]
        if asked.body is not None:
            owner = self._plan.layout.owners[asked.body]
            return list(dict.fromkeys(self._slots[owner.first : owner.first + owner.size].tolist()))
        return [slot for slot in range(self._world.particle_count) if not self._world.is_grab_particle(slot)]

    def _springs(self, body: str | None) -> list[int]:
        """Slots of the springs of a body, or of all but those of hands."""
        names = self._world.spring_names
        mine = [body is None or name.startswith(f"{body}:") for name in names]
        return [slot for slot, is_mine in enumerate(mine) if is_mine and not self._world.is_grab_spring(slot)]

    def rules(self, roots: Sequence[int], delays: Sequence[int], once: Sequence[bool]) -> Rules:
        """The whole table; roots: the terms of the rules."""
        # Those of TOUCHES come first, all others stay behind what they ask.
        order = sorted(range(len(self._terms)), key=lambda t: self._terms[t].kind != rules.TOUCHES)
        place = {t: at for at, t in enumerate(order)}
        terms = [self._terms[t] for t in order]
        is_group = [term.kind in (rules.ALL, rules.ANY, rules.NOT) for term in terms]
        slots: list[int] = []
        members: list[int] = []
        spans = []
        for term, grouped in zip(terms, is_group, strict=True):
            found = members if grouped else slots
            first = len(found)
            found += [place[t] for t in term.about] if grouped else term.about
            spans.append((first, len(found)))
        return Rules(
            zones_of(self._level.zones),
            Terms(
                _slots([term.kind for term in terms]),
                _slots([first for first, _ in spans]),
                _slots([last for _, last in spans]),
                _slots([term.zone for term in terms]),
                _slots([term.other for term in terms]),
                np.array([term.low for term in terms], np.float64),
                np.array([term.high for term in terms], np.float64),
                _slots(slots),
                _slots(members),
                np.zeros(len(terms)),
                np.zeros(len(terms), np.bool_),
            ),
            self._numbered_things(),
            _slots([place[t] for t in roots]),
            _slots(delays),
            np.array(once, np.bool_),
        )

    def _numbered_things(self) -> Things:
        """The things that particles, springs and edges of terrain belong to."""
        world, layout = self._world, self._plan.layout
        of_particle = np.full(world.particle_count, NOBODY)
        for name, owner in layout.owners.items():
            of_particle[self._slots[owner.first : owner.first + owner.size]] = self._things[name]
        of_spring = [self._things.get(name.partition(":")[0], NOBODY) for name in world.spring_names]
        first = len(layout.owners)
        return Things(of_particle, _slots(of_spring), world.terrain.chain + first)


def _things(level: Level, plan: Plan) -> dict[str, int]:
    """A number for each body, loose particle, piece of terrain, and the walls, which come behind it."""
    names = [*plan.layout.owners, *(piece.id for piece in level.terrain)]
    return {WALLS: len(names)} | {name: number for number, name in enumerate(names)}


def zones_of(zones: Sequence[ZoneDef]) -> Zones:
    """Zones in the arrays of kernels."""
    kinds, shapes, firsts = [], [], [0]
    corners: list[Point] = []
    for zone in zones:
        if zone.box is not None:
            kinds.append(BOX)
            shapes.append(zone.box)
        elif zone.circle is not None:
            kinds.append(CIRCLE)
            shapes.append((*zone.circle, 0.0))
        else:
            polygon = zone.polygon or ()
            kinds.append(POLYGON)
            across, up = zip(*polygon, strict=True)
            shapes.append((min(across), min(up), max(across), max(up)))
            corners += polygon
        firsts.append(len(corners))
    return Zones(
        _slots(kinds), np.array(shapes, np.float64).reshape(-1, 4) + 0.0, _slots(firsts),
        np.array(corners, np.float64).reshape(-1, 2) + 0.0,
    )  # fmt: skip


def _slots(values: Sequence[int]) -> Slots:
    return np.array(values, np.int64)
