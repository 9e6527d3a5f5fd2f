"""Cheats: hands that try to win a level in ways it is not about, and hands that do anything; by commands alone.

A trick is a generator: what stands between two of its yields is done while time stands, and each yield is a tick.
What hands may not do is refused by the session, as it is in the window, and changes nothing.
"""

import random
from collections.abc import Callable, Iterator
from itertools import chain, count
from typing import Any

import numpy as np

from sandbox.level.plan.actuators import driving_keys
from sandbox.physics.analysis.query import grip_radius, shown_particles, shown_springs
from sandbox.session.compare.rollback import RandomHands
from sandbox.session.outcome import outcome
from sandbox.session.session import Session
from sandbox.tools.dropping import PARTS

Place = tuple[float, float]
# What a key does until it is let go [ticks], and how often one is pressed.
HELD, KEYS_A_TICK = (10, 400), 0.02


class Cheat:
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

    def part(self, place: Place, size: float, wide: float = 1.0) -> dict[str, Any]:
        """A box of the strip of parts, at a place, so large [m]."""
        found = PARTS["box"].make(size, place, (0.0, 0.0), "").body
        return {**found, "shape": {"box": [size * wide, size]}}


def paused_moves(cheat: Cheat) -> Iterator[None]:
    """Put things where they win while time stands, at the start or later."""
    for _ in range(cheat.chance.choice((0, 0, 100))):
        yield
    for _ in range(4):
        name, (x, y) = cheat.thing(), cheat.goal()
        if name != "nothing":
            here = cheat.place(name)
            cheat.do("move_body", particle=name, by=[x - here[0], y - here[1]], at_rest=True)
            cheat.do("free", particle=name)


def carrying(cheat: Cheat) -> Iterator[None]:
    """Carry a thing over whatever is in the way to where it wins, slowly or in a jerk, and let it down there."""
    name = cheat.thing()
    if name == "nothing":
        return
    high, goal = cheat.corner[1] - cheat.chance.uniform(0.0, 0.5) * cheat.height, cheat.goal()
    here, ticks = cheat.place(name), cheat.chance.choice((4, 20, 60))
    reach = grip_radius(cheat.world, cheat.world.particle_slot(name))
    gesture = cheat.session.new_gesture()
    start = {"type": "grab", "grab": 0, "particle": name, "target": here, "strength": 300.0, "radius": reach}
    if not cheat.session.attempt(start, gesture):
        return
    for end in ((here[0], high), (goal[0], high), goal):
        for share in np.arange(1, ticks + 1) / ticks:
            target = [a + float(share) * (b - a) for a, b in zip(here, end, strict=True)]
            cheat.session.attempt({"type": "move_grab", "grab": 0, "target": target}, gesture)
            yield
        here = end
    for _ in range(cheat.chance.choice((0, 60, 300))):
        yield
    cheat.session.attempt({"type": "release", "grab": 0}, gesture)


def cutting(cheat: Cheat) -> Iterator[None]:
    """Cut springs, one after another or many at once."""
    for _ in range(8):
        slots = np.flatnonzero(shown_springs(cheat.world)).tolist()
        if slots:
            found = cheat.chance.sample(slots, min(len(slots), cheat.chance.choice((1, 1, 8))))
            cheat.do("cut_springs", springs=[cheat.world.spring_names[slot] for slot in found])
        yield from waiting(cheat, 40)


def removing(cheat: Cheat) -> Iterator[None]:
    """Take things out: what is in the way, or what has to arrive."""
    for _ in range(4):
        name = cheat.thing()
        cheat.do("remove", particle=name)
        cheat.do("remove", body=name.partition(".")[0])
        yield from waiting(cheat, 60)


def huge_part(cheat: Cheat) -> Iterator[None]:
    """Add a part as large as the picture, or a plank right across it."""
    size = cheat.chance.uniform(0.05, 0.6) * cheat.height
    cheat.do("add_body", body=cheat.part(cheat.goal(), size, cheat.chance.choice((1.0, 4.0))))
    yield


def parts_on_the_goal(cheat: Cheat) -> Iterator[None]:
    """Drop parts where the level is won, and join things to them by short springs."""
    for _ in range(5):
        x, y = cheat.goal()
        cheat.do("add_body", body=cheat.part((x, y), cheat.chance.uniform(0.3, 1.5)))
        cheat.do("add_particle", position=[x, y], mass=5000.0, radius=0.2)
        added = [name for name in cheat.world.particle_names if name.startswith("+.")]
        ends = {"particle_a": cheat.thing(), "particle_b": added[-1] if added else cheat.thing()}
        cheat.do("add_spring", **ends, rest_length=0.1, stiffness=0.9)
        yield from waiting(cheat, 30)


def other_air(cheat: Cheat) -> Iterator[None]:
    """Turn gravity off, over or sideways, and let the wind blow."""
    for _ in range(3):
        gravity = [cheat.chance.uniform(-20.0, 20.0), cheat.chance.uniform(-20.0, 20.0)]
        cheat.do("set_gravity", gravity=gravity)
        cheat.do("set_air", wind=[cheat.chance.uniform(-50.0, 50.0), 0.0], drag=1.0)
        yield from waiting(cheat, 100)


def freezing(cheat: Cheat) -> Iterator[None]:
    """Fix things where they are, and let go what was fixed."""
    for _ in range(6):
        cheat.do("pin", particle=cheat.thing())
        fixed = np.flatnonzero(shown_particles(cheat.world) & (cheat.world.inverse_mass == 0.0)).tolist()
        if fixed:
            cheat.do("unpin", particle=cheat.world.particle_names[cheat.chance.choice(fixed)])
        yield from waiting(cheat, 40)


def tuning(cheat: Cheat) -> Iterator[None]:
    """Make everything softer, firmer, heavier, larger, and solve it otherwise."""
    for _ in range(cheat.chance.choice((1, 1, 6))):
        material = cheat.chance.choice(cheat.world.material_names)
        cheat.do("set_coefficients", material=material, stiffness=cheat.chance.random(), damping=cheat.chance.random())
        forms = [form.name for form in cheat.world.forms]
        if forms:
            cheat.do("set_firmness", body=cheat.chance.choice(forms), sag=cheat.chance.choice((0.0, 0.02, 0.1, 0.3)))
        cheat.do("scale_mass", particle=cheat.thing(), factor=cheat.chance.choice((0.1, 10.0)))
        if cheat.world.area_names:
            cheat.do("set_inflation", body=cheat.chance.choice(cheat.world.area_names), value=3.0)
        cheat.do("set_solver", solver="iterative", iterations=1)
        yield from waiting(cheat, 60)


def pushing(cheat: Cheat) -> Iterator[None]:
    """Push things towards where they win, and shake the world."""
    for _ in range(6):
        name, (x, y) = cheat.thing(), cheat.goal()
        if name != "nothing":
            here = cheat.place(name)
            impulse = [20.0 * (x - here[0]), 20.0 * (y - here[1]) + 40.0]
            cheat.do("push", position=here, impulse=impulse, radius=1.0)
        cheat.do("shake", acceleration=[cheat.chance.uniform(-100.0, 100.0), 50.0])
        yield from waiting(cheat, 40)


def undo_games(cheat: Cheat) -> Iterator[None]:
    """Do things, take them back and do them again."""
    for trick in cheat.chance.sample([paused_moves, carrying, parts_on_the_goal, cutting], 2):
        for _ in trick(cheat):
            yield
        for _ in range(cheat.chance.randint(1, 4)):
            cheat.session.undo()
            yield
        if cheat.chance.random() < 0.5:
            cheat.session.redo()
        yield


def waiting(cheat: Cheat, most: int) -> Iterator[None]:
    """Let some ticks pass."""
    for _ in range(cheat.chance.randint(0, most)):
        yield


TRICKS: tuple[Callable[[Cheat], Iterator[None]], ...] = (
    paused_moves, carrying, cutting, removing, huge_part, parts_on_the_goal, other_air, freezing, tuning, pushing,
    undo_games,
)  # fmt: skip


def some_tricks(cheat: Cheat, number: int) -> Iterator[None]:
    """The tricks that a run of this number begins with, and more at random, again and again."""
    for trick in chain([TRICKS[number % len(TRICKS)]], (cheat.chance.choice(TRICKS) for _ in count())):
        yield from trick(cheat)
        yield from waiting(cheat, 60)


def random_play(cheat: Cheat, number: int) -> Iterator[None]:
    """Hands that drag, push, drive, pin and cut whatever they find, for ever."""
    hands = RandomHands(cheat.session, number)
    while True:
        hands.act()
        yield


def keys(cheat: Cheat) -> Iterator[None]:
    """Press the level's keys at random, and hold each for a while."""
    driven, asked = driving_keys(cheat.level), cheat.world.rule_keys
    names, held = sorted({*driven, *asked}), dict[str, int]()
    while True:
        for key in names:
            tick = cheat.session.tick
            ends = held.get(key, tick + 1) <= tick
            if ends or (key not in held and cheat.chance.random() < KEYS_A_TICK):
                _press(cheat, key, not ends)
                held[key] = tick + cheat.chance.randint(*HELD)
            if ends:
                del held[key]
        yield


def _press(cheat: Cheat, key: str, down: bool) -> None:
    gesture, parts = cheat.session.new_gesture(), cheat.world.actuators.names
    for part, value in driving_keys(cheat.level).get(key, []):
        record = {"type": "set_drive", "part": parts[part], "value": value if down else 0.0}
        cheat.session.attempt(record, gesture)
    if key in cheat.world.rule_keys:
        cheat.session.attempt({"type": "hold_key", "key": key, "down": down}, gesture)


def cheated(session: Session, way: Callable[[Cheat, int], Iterator[None]], number: int, ticks: int) -> Iterator[None]:
    """Play a level in a way with a seed until it is won or lost, or so long; each yield is after a tick."""
    cheat = Cheat(session, f"{way.__name__} {number}")
    for _, _ in zip(way(cheat, number), keys(cheat), strict=False):
        session.advance()
        yield
        if session.tick >= ticks or outcome(session.level, session.world) is not None:
            return
