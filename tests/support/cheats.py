"""Cheats: hands that try to win a level in ways it is not about, and hands that do anything; by commands alone.

A trick is a way of playing, as `sandbox.session.looking` has it.
"""

from collections.abc import Callable, Iterator
from itertools import chain, count
from typing import Any

import numpy as np

from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.session.compare.rollback import RandomHands
from sandbox.session.looking import Person, Place, carrying, keys, played, waiting
from sandbox.session.session import Session
from sandbox.tools.dropping import PARTS


class Cheat(Person):
    """A person who tries anything."""

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


def cheated(session: Session, way: Callable[[Cheat, int], Iterator[None]], number: int, ticks: int) -> Iterator[None]:
    """Play a level in a way with a seed until it is won or lost, or so long; each yield is after a tick."""
    cheat = Cheat(session, f"{way.__name__} {number}")
    yield from played(session, ticks, way(cheat, number), keys(cheat))
