"""Looking for a way: hands at random, and changes of what brought a level nearer to its goal, until it is won.

A way of playing is a generator: what stands between two of its yields is done while time stands, and each yield is a
tick. What hands may not do is refused by the session, as it is in the window, and changes nothing.
"""

import random
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any

import numpy as np

from sandbox.level.document.model import Level, ZoneDef
from sandbox.level.plan.actuators import driving_keys
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.rules.rule import QuestionDef
from sandbox.physics.analysis.query import grip_radius, shown_particles
from sandbox.physics.snapshot import state_hash
from sandbox.physics.world import World
from sandbox.session.commands.records import ScriptLine, script_of
from sandbox.session.outcome import Outcome, outcome
from sandbox.session.replay.link import run_of
from sandbox.session.replay.recording import Replay
from sandbox.session.session import Session

Place = tuple[float, float]
# What a key does until it is let go [ticks], and how often one is pressed.
HELD, KEYS_A_TICK = (10, 400), 0.02
# How long is looked [s of the processor], for how long a run without a solution goes on [s], and how much longer than
# the solution one with it.
SECONDS, USUAL, LONGER = 60.0, 20.0, 1.3
# From one look at where things are to the next [ticks], and how many of the best runs are changed.
LOOK, KEPT = 6, 6
# Numbers of a command that are changed by a factor, and those of them that are 1 at most.
SHARES = ("stiffness", "damping")
NUMBERS = (*SHARES, "hz", "sag", "value", "strength")


class Person:
    """A person at a session: what is chosen at random, and commands by the session's own check."""

    def __init__(self, session: Session, seed: str) -> None:
        self.session, self.world, self.level = session, session.world, session.level
        self.chance = random.Random(seed)
        left, bottom, right, top = self.level.view or (-5.0, -5.0, 5.0, 5.0)
        self.view, self.width, self.height = (left, bottom), right - left, top - bottom

    def do(self, kind: str, **fields: Any) -> bool:
        """Give a command of its own; whether it was carried out."""
        return self.session.attempt({"type": kind, **fields}, self.session.new_gesture())

    def goal(self) -> Place:
        """A place in a zone of the level, or else anywhere in the picture."""
        boxes = [zone.box for zone in self.level.zones if zone.box is not None]
        left, bottom, right, top = self.chance.choice(boxes or [(*self.view, *self.corner)])
        low, high = np.maximum((left, bottom), self.view), np.minimum((right, top), self.corner)
        x, y = (self.chance.uniform(*sorted(ends)) for ends in zip(low.tolist(), high.tolist(), strict=True))
        return x, y

    @property
    def corner(self) -> Place:
        """The upper right corner of the picture [m]."""
        return self.view[0] + self.width, self.view[1] + self.height

    def thing(self) -> str:
        """A particle that moves, of what there are few of as likely as of what there are many of."""
        slots = np.flatnonzero(shown_particles(self.world) & (self.world.inverse_mass > 0.0)).tolist()
        names = [self.world.particle_names[slot] for slot in slots]
        owners = sorted({name.partition(".")[0] for name in names})
        if not names:
            return "nothing"
        owner = self.chance.choice(owners)
        return self.chance.choice([name for name in names if name.partition(".")[0] == owner])

    def place(self, name: str) -> Place:
        """Where a particle is."""
        x, y = self.world.position[self.world.particle_slot(name)].tolist()
        return x, y


def waiting(person: Person, most: int) -> Iterator[None]:
    """Let some ticks pass."""
    for _ in range(person.chance.randint(0, most)):
        yield


def carrying(person: Person) -> Iterator[None]:
    """Carry a thing over whatever is in the way to where it wins, slowly or in a jerk, and let it down there."""
    name = person.thing()
    if name == "nothing":
        return
    high, goal = person.corner[1] - person.chance.uniform(0.0, 0.5) * person.height, person.goal()
    here, ticks = person.place(name), person.chance.choice((4, 20, 60))
    reach = grip_radius(person.world, person.world.particle_slot(name))
    gesture = person.session.new_gesture()
    start = {"type": "grab", "grab": 0, "particle": name, "target": here, "strength": 300.0, "radius": reach}
    if not person.session.attempt(start, gesture):
        return
    for end in ((here[0], high), (goal[0], high), goal):
        for share in np.arange(1, ticks + 1) / ticks:
            target = [a + float(share) * (b - a) for a, b in zip(here, end, strict=True)]
            person.session.attempt({"type": "move_grab", "grab": 0, "target": target}, gesture)
            yield
        here = end
    for _ in range(person.chance.choice((0, 60, 300))):
        yield
    person.session.attempt({"type": "release", "grab": 0}, gesture)


def setting(person: Person) -> Iterator[None]:
    """Make a material or a body softer or firmer."""
    material = person.chance.choice(person.world.material_names)
    person.do("set_coefficients", material=material, stiffness=person.chance.random(), damping=person.chance.random())
    forms = [form.name for form in person.world.forms]
    if forms:
        body, sag = person.chance.choice(forms), person.chance.choice((0.0, 0.02, 0.1, 0.3))
        person.do("set_firmness", body=body, sag=sag, duration=75)
    yield


def adding(person: Person) -> Iterator[None]:
    """Put a box somewhere in the picture, or where something has to come to."""
    size = person.chance.uniform(0.05, 0.3) * person.height
    across = (
        person.chance.uniform(person.view[0], person.corner[0]),
        person.chance.uniform(person.view[1], person.corner[1]),
    )
    body = {"type": "jelly", "position": person.chance.choice((person.goal(), across)), "sag": 0.0}
    person.do("add_body", body=body | {"shape": {"box": [size * person.chance.choice((1.0, 4.0)), size]}})
    yield


def deeds(person: Person) -> Iterator[None]:
    """What hands do that look for a way, for ever."""
    while True:
        yield from person.chance.choice((carrying, setting, adding))(person)
        yield from waiting(person, 120)


def keys(person: Person) -> Iterator[None]:
    """Press the level's keys at random, and hold each for a while."""
    names, held = sorted({*driving_keys(person.level), *person.world.rule_keys}), dict[str, int]()
    while True:
        for key in names:
            tick = person.session.tick
            ends = held.get(key, tick + 1) <= tick
            if ends or (key not in held and person.chance.random() < KEYS_A_TICK):
                _press(person, key, not ends)
                held[key] = tick + person.chance.randint(*HELD)
            if ends:
                del held[key]
        yield


def _press(person: Person, key: str, down: bool) -> None:
    gesture, parts = person.session.new_gesture(), person.world.actuators.names
    for part, value in driving_keys(person.level).get(key, []):
        record = {"type": "set_drive", "part": parts[part], "value": value if down else 0.0}
        person.session.attempt(record, gesture)
    if key in person.world.rule_keys:
        person.session.attempt({"type": "hold_key", "key": key, "down": down}, gesture)


def played(session: Session, ticks: int, *ways: Iterator[None]) -> Iterator[None]:
    """Play in these ways at once until it is won or lost, or until a tick; each yield is after a tick."""
    for _ in zip(*ways, strict=False):
        with np.errstate(over="ignore", invalid="ignore"):
            session.advance()
        yield
        if session.tick >= ticks or outcome(session.level, session.world) is not None:
            return


class Looking:
    """Looks for a way to win a level, from a script on: `work` goes on a slice, `done` is the part of its time, 0..1.

    seconds: of the processor, which it may take. found: the run that wins, None while there is none; runs: how many
    were tried.
    """

    def __init__(
        self, level: Level, script: Sequence[ScriptLine] = (), ticks: int = 0, seconds: float = SECONDS
    ) -> None:
        self.level, self.seconds = level, seconds
        self.found: Replay | None = None
        self.outcome: Outcome | None = None
        self.runs, self._used = 0, 0.0
        rate = level.settings.tick_rate
        self._ticks = round(LONGER * ticks) + 2 * rate if ticks else round(USUAL * rate)
        self._chance = random.Random(0)
        # What came nearest, with how near that was: larger is nearer.
        self._best: list[tuple[Place, tuple[ScriptLine, ...]]] = []
        self._aims = _aims(level)
        self.work = self._work(tuple(script))

    @property
    def done(self) -> float:
        """The part of its time that is over."""
        return min(self._used / self.seconds, 1.0)

    def _work(self, script: tuple[ScriptLine, ...]) -> Iterator[None]:
        yield from self._try(script, self._ticks)
        while self.found is None and self._used < self.seconds:
            made, until = script, self._ticks
            if self._best and self._chance.random() < 0.8:
                made = changed(self._chance.choice(self._best)[1], self._chance, self.level.settings.tick_rate)
            if not made or self._chance.random() < 0.3:
                until = self._chance.choice((0, self._chance.randint(0, self._ticks)))
            yield from self._try(made, until)

    def _try(self, script: tuple[ScriptLine, ...], until: int) -> Iterator[None]:
        """Play a script until a tick, and then at random; keep what came nearest."""
        started = time.thread_time()
        self.runs += 1
        session = Session(self.level)
        person, near = Person(session, f"look {self.runs}"), (-1.0, -np.inf)
        ways = [_told(person, script, until), *([keys(person)] if until < self._ticks else [])]
        for _ in played(session, self._ticks, *ways):
            if session.tick % LOOK == 0:
                near = max(near, _nearness(session.world, self._aims))
                self._used, started = self._used + time.thread_time() - started, time.thread_time()
                yield None
                started = time.thread_time()
                if self._used >= self.seconds:
                    return
        found, world = outcome(self.level, session.world), session.world
        told = script_of([entry for entry in session.history.timeline if entry.in_effect], world)
        self._used += time.thread_time() - started
        if found is not None and found.is_won:
            self.outcome = found
            self.found = run_of("the way that was found", self.level, told, session.tick, state_hash(world))
            return
        self._best = sorted([*self._best, (near, told)], key=lambda each: each[0], reverse=True)[:KEPT]


def _told(person: Person, script: Sequence[ScriptLine], until: int) -> Iterator[None]:
    """Do what a script says until a tick, as far as it can be done, and then anything."""
    lines = iter([*script, None])
    line = next(lines)
    while person.session.tick < until:
        while line is not None and line.tick <= person.session.tick:
            person.session.attempt(line.record, line.gesture)
            line = next(lines)
        yield
    yield from deeds(person)


def changed(script: Sequence[ScriptLine], chance: random.Random, rate: int) -> tuple[ScriptLine, ...]:
    """A script with one of its gestures later or earlier, elsewhere, harder or softer, or left out."""
    gestures = [
        list(lines) for _, lines in groupby(sorted(script, key=lambda line: line.gesture), lambda line: line.gesture)
    ]
    if not gestures:
        return ()
    number, kind = chance.randrange(len(gestures)), chance.random()
    lines = gestures[number]
    if kind < 0.35:
        later, is_rest = round(chance.gauss(0.0, 0.4) * rate), chance.random() < 0.5
        for each in range(number, len(gestures) if is_rest else number + 1):
            gestures[each] = [replace(line, tick=max(line.tick + later, 0)) for line in gestures[each]]
    elif kind < 0.45 and len(gestures) > 1:
        del gestures[number]
    elif kind < 0.6:
        factor, first = float(np.exp(chance.gauss(0.0, 0.3))), lines[0].tick
        gestures[number] = [replace(line, tick=first + round(factor * (line.tick - first))) for line in lines]
    else:
        size = chance.choice((0.05, 0.3, 1.0))
        by, factor = (chance.gauss(0.0, size), chance.gauss(0.0, size)), float(np.exp(chance.gauss(0.0, size)))
        shares = np.linspace(0.0, 1.0, len(lines)).tolist()
        gestures[number] = [
            replace(line, record=_other(line.record, by, factor, share))
            for line, share in zip(lines, shares, strict=True)
        ]
    return tuple(sorted((line for each in gestures for line in each), key=lambda line: (line.tick, line.gesture)))


def _other(record: dict[str, Any], by: Place, factor: float, share: float) -> dict[str, Any]:
    """A command with numbers times a factor, and places farther by as much as of its gesture has passed, 0..1."""
    made = dict(record)
    for name in NUMBERS:
        if isinstance(made.get(name), float):
            made[name] = made[name] * factor if name not in SHARES else min(made[name] * factor, 1.0)
    if "target" in made:
        made["target"] = [each + share * more for each, more in zip(made["target"], by, strict=True)]
    if "position" in made.get("body", {}):
        made["body"] = made["body"] | {"position": [a + b for a, b in zip(made["body"]["position"], by, strict=True)]}
    return made


def _aims(level: Level) -> list[tuple[int, str, Place]]:
    """What rules want to be in zones: number of the rule, body or particle, middle of the zone [m]."""
    zones = {zone.id: _middle(zone) for zone in level.zones}
    found: list[tuple[int, str, Place]] = []

    def note(rule: int, question: QuestionDef) -> None:
        thing, zone = question.body or question.particle, question.zone or question.crosses
        if thing and zone in zones:
            found.append((rule, thing, zones[zone]))
        for each in (*(question.all or ()), *(question.any or ())):
            note(rule, each)

    for number, rule in enumerate(run_rules(level)):
        if all(action.fail is None for action in rule.then):
            note(number, rule.when)
    return found


def _middle(zone: ZoneDef) -> Place:
    if zone.box is not None:
        return (zone.box[0] + zone.box[2]) / 2, (zone.box[1] + zone.box[3]) / 2
    if zone.circle is not None:
        return zone.circle[0], zone.circle[1]
    x, y = np.mean(zone.polygon or [(0.0, 0.0)], axis=0).tolist()
    return x, y


def _nearness(world: World, aims: Sequence[tuple[int, str, Place]]) -> tuple[float, float]:
    """How many rules have fired, and how far [m, negative] what has yet to come somewhere is from there."""
    fired, away = world.rule_first >= 0, 0.0
    names, active = world.particle_names, world.particle_active
    for rule, thing, goal in aims:
        if fired[rule]:
            continue
        slots = [
            slot for slot, name in enumerate(names) if active[slot] and (name == thing or name.startswith(f"{thing}."))
        ]
        away += float(np.linalg.norm(world.position[slots].mean(axis=0) - goal)) if slots else 100.0
    return float(fired.sum() + world.counter.sum() / 1000.0), -away
