"""Makes the goldens anew: of every shipped level, or of those that are named.

python -m tests.determinism.make_goldens [LEVEL ...]        (all: make goldens-record)

Only a change of what a tick computes (a new physics version) or of a level's meaning is a reason to.
"""

import argparse
import math
import os
import random
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.settings import AUTO
from sandbox.physics.softness.firmness import firm_bodies, lowest_mode_of
from sandbox.physics.solvers import SOLVERS
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session
from tests.determinism.golden import LONG, SHORTER, STATE_TICKS, golden_path

ROUNDS = 3  # of all scenes in a recording of a minute; others are a round
MOVE_TICKS = 10  # between two moves of a hand
# Cs and Cd of everything in the single pass, where those that other solvers bear would blow the level up.
EXPLICIT_COEFFICIENT = 0.04


def _coefficients(session: Session) -> dict[str, tuple[float, float]]:
    """Cs and Cd of each material that springs are made of."""
    world = session.world
    found, first = np.unique(world.material, return_index=True)
    return {
        world.material_names[material]: (float(world.stiffness[spring]), float(world.damping[spring]))
        for material, spring in zip(found.tolist(), first.tolist(), strict=True)
        if material >= 0
    }


class NotAllowed(ValueError):
    """What the level does not let hands do."""


class Person:
    """Who plays a level, and writes down what she does; the same for the same level."""

    def __init__(self, name: str, session: Session) -> None:
        self.random = random.Random(name)
        self.session = session
        self.shipped = session.world.settings
        self.lines: list[dict[str, Any]] = []
        self.coefficients = _coefficients(session)
        positions = session.world.position[shown_particles(session.world)]
        self.low, self.high = positions.min(axis=0), positions.max(axis=0)
        self.reach = min(max(0.08 * math.dist(self.low, self.high), 0.1), 1.0)  # [m] of a hand's move
        self.solvers = sorted(SOLVERS, key=lambda name: (name != self.shipped.solver, name))

    def do(self, gesture: int, **command: Any) -> None:
        """Carry a command out and write it down. Raises NotAllowed, or ValueError where it is refused for else."""
        session, before = self.session, len(self.session.messages)
        session.submit(from_record(command, session.world), gesture)
        session.apply_pending()
        if len(session.messages) > before:
            said = session.messages[before]
            is_allowed = not said.startswith(("in this level hands may not", "not enough"))
            raise ValueError(f"{command}: {said}") if is_allowed else NotAllowed(said)
        self.lines.append({"tick": session.tick, "gesture": gesture, "command": command})

    def do_once(self, **command: Any) -> None:
        """A command that is a gesture of its own."""
        self.do(self.session.new_gesture(), **command)

    def free_particle(self) -> int:
        """Slot of some particle that moves, if there is one where the level began."""
        world = self.session.world
        free = shown_particles(world) & (world.inverse_mass > 0.0)
        near = free & np.all((world.position > self.low - 1.0) & (world.position < self.high + 1.0), axis=1)
        return self.random.choice(np.flatnonzero(near if near.any() else free).tolist())

    def number(self, low: float, high: float) -> float:
        """A number of few digits."""
        return round(self.random.uniform(low, high), 3)


# What a person does in a scene of some ticks: carried out up to each yield, then the world steps.


def drag(person: Person, ticks: int, hand: int = 0) -> Iterator[None]:
    """Take a particle round a circle."""
    world, gesture, slot = person.session.world, person.session.new_gesture(), person.free_particle()
    x, y = world.position[slot].tolist()
    turn, start = person.random.choice([-0.12, 0.12]), person.random.uniform(0.0, 6.0)
    for tick in range(ticks - 2):
        angle = start + turn * tick
        target = [
            round(x + person.reach * (math.cos(angle) - math.cos(start)), 3),
            round(y + person.reach * (math.sin(angle) - math.sin(start)), 3),
        ]
        if tick == 0:
            person.do(gesture, type="grab", grab=hand, particle=world.particle_names[slot], target=target)
        elif tick % MOVE_TICKS == 0:
            person.do(gesture, type="move_grab", grab=hand, target=target)
        yield
    person.do(gesture, type="release", grab=hand)


def drag_with_another_hand(person: Person, ticks: int) -> Iterator[None]:
    """Take a particle round a circle with hand 9."""
    return drag(person, ticks, hand=9)


def slide(person: Person, ticks: int) -> Iterator[None]:
    """Soften a material of the level little by little, then bring all of its springs to one damping."""
    world, gesture = person.session.world, person.session.new_gesture()
    used = np.unique(world.material[shown_springs(world)])
    if not used.size:
        return
    chosen = person.random.choice(used[used >= 0].tolist())
    spring = np.flatnonzero(world.material == chosen)[0]
    stiffness, damping = float(world.stiffness[spring]), float(world.damping[spring])
    name = world.material_names[chosen]
    for step in range(5):
        softer = round(stiffness * (1.0 - 0.1 * step), 6)
        person.do(gesture, type="set_coefficients", stiffness=softer, material=name)
        for _ in range(ticks // 8):
            yield
    person.do(gesture, type="set_coefficients", stiffness=stiffness, damping=round(0.8 * damping, 6), material=name)
    yield
    person.do_once(type="set_coefficients", damping=round(0.9 * damping, 6))


def drive(person: Person, ticks: int) -> Iterator[None]:
    """Drive what the level has to drive."""
    for values in ((1.0, 1.0), (-1.0, 0.0), (-1.0, 1.0)):
        for name in person.session.world.actuators.names:
            person.do_once(type="set_drive", part=name, value=person.number(*values))
        for _ in range(ticks // 3):
            yield


def inflate(person: Person, ticks: int) -> Iterator[None]:
    """Blow up and let out some of the level's rings and jellies."""
    names = person.session.world.area_names
    chosen = person.random.sample(names, min(3, len(names)))
    for low, high in ((1.2, 1.5), (0.7, 0.9), (1.0, 1.0)):
        for name in chosen:
            person.do_once(type="set_inflation", body=name, value=person.number(low, high))
        for _ in range(ticks // 3):
            yield


def firm(person: Person, ticks: int) -> Iterator[None]:
    """Make a body of the level softer than it was, by its firmness, and then firmer."""
    names = [body.name for body in firm_bodies(person.session.world) if lowest_mode_of(body.shape) > 0.0]
    for hz, ratio in ((1.5, 0.2), (4.0, 0.5)) if names else ():
        person.do_once(type="set_firmness", body=names[-1], hz=hz, ratio=ratio)
        for _ in range(ticks // 3):
            yield


def cut_and_regret(person: Person, ticks: int) -> Iterator[None]:
    """Cut springs, take it back, cut them again after all; cut another for good."""
    world = person.session.world
    left = [world.spring_names[slot] for slot in np.flatnonzero(shown_springs(world))]
    chosen = person.random.sample(left, min(3, max(len(left) - 1, 0)))
    if not chosen:
        return
    for command in (
        {"type": "cut_springs", "springs": chosen[1:] or chosen},
        {"type": "undo"},
        {"type": "redo"},
        {"type": "undo"},
        {"type": "cut_springs", "springs": chosen[:1]},
    ):
        person.do_once(**command)
        for _ in range(ticks // 6):
            yield


def pin(person: Person, ticks: int) -> Iterator[None]:
    """Pin a particle for a while, and let go for a while of one that the level pins."""
    world = person.session.world
    free = world.particle_names[person.free_particle()]
    held = np.flatnonzero(shown_particles(world) & (world.inverse_mass == 0.0)).tolist()
    pinned = world.particle_names[person.random.choice(held)] if held else None
    person.do_once(type="pin", particle=free)
    for _ in range(ticks // 3):
        yield
    if pinned is not None:
        person.do_once(type="unpin", particle=pinned)
    for _ in range(ticks // 6):
        yield
    if pinned is not None:
        person.do_once(type="pin", particle=pinned)
    person.do_once(type="unpin", particle=free)
    yield


def add(person: Person, ticks: int) -> Iterator[None]:
    """Hang a new particle on one of the level, and drop another."""
    world, gesture, slot = person.session.world, person.session.new_gesture(), person.free_particle()
    added = sum(name.startswith("+.") for name in world.particle_names)
    x, y = (round(value, 3) for value in world.position[slot].tolist())
    person.do(gesture, type="add_particle", position=[x, y + person.reach], mass=person.number(0.1, 0.5))
    person.do(gesture, type="add_spring", particle_a=f"+.{added}", particle_b=world.particle_names[slot], stiffness=0.2)
    for _ in range(ticks // 2):
        yield
    person.do_once(type="add_particle", position=[x, y + 3.0 * person.reach], mass=0.2, radius=0.08)
    yield


def weather(person: Person, ticks: int) -> Iterator[None]:
    """Wind, thick air and another gravity, then those that the level has."""
    wind, drag_rate = list(person.shipped.wind), person.shipped.drag
    person.do_once(type="set_air", wind=[person.number(-4.0, 4.0), person.number(-1.0, 1.0)], drag=0.4)
    for _ in range(ticks // 4):
        yield
    person.do_once(type="set_gravity", gravity=[person.number(-2.0, 2.0), person.number(-6.0, -3.0)])
    for _ in range(ticks // 4):
        yield
    person.do_once(type="set_gravity", gravity=list(person.shipped.gravity))
    person.do_once(type="set_air", wind=wind)
    person.do_once(type="set_air", drag=drag_rate)
    yield


def second_solver(person: Person, ticks: int) -> Iterator[None]:
    """Let another solver take over."""
    take_solver(person, person.solvers[1])
    yield


def third_solver(person: Person, ticks: int) -> Iterator[None]:
    """Let the solver take over that has not had its turn."""
    take_solver(person, person.solvers[2])
    yield


def take_solver(person: Person, solver: str) -> None:
    """Set a solver, with coefficients that it bears."""
    gesture = person.session.new_gesture()
    if solver == "single_pass":
        person.do(gesture, type="set_coefficients", stiffness=EXPLICIT_COEFFICIENT, damping=EXPLICIT_COEFFICIENT)
    person.do(gesture, type="set_solver", solver=solver, iterations=12, warm_start=0.8)


def other_substeps(person: Person, ticks: int) -> Iterator[None]:
    """Let each tick choose its substeps; in some levels give it twice those of the level."""
    twice = min(2 * person.shipped.fewest_substeps, 16)
    person.do_once(type="set_solver", substeps=person.random.choice([AUTO, AUTO, twice]))
    yield


def shipped_solver(person: Person, ticks: int) -> Iterator[None]:
    """Go back to the level's own solver and coefficients."""
    shipped, gesture = person.shipped, person.session.new_gesture()
    for name, (stiffness, damping) in person.coefficients.items():
        person.do(gesture, type="set_coefficients", stiffness=stiffness, damping=damping, material=name)
    person.do(
        gesture, type="set_solver", solver=shipped.solver, iterations=shipped.iterations, substeps=shipped.substeps,
        warm_start=shipped.warm_start,
    )  # fmt: skip
    yield


# Scenes of equal length, of acts that are carried out side by side; each solver has a third of them. Where an act
# undoes, it is alone: what is undone is the last gesture of all.
SCENES = (
    (drag, drive),
    (other_substeps, slide, inflate),
    (cut_and_regret,),
    (firm, pin, weather),
    (second_solver, drag, drag_with_another_hand),
    (pin, weather, drive),
    (other_substeps, slide, inflate),
    (add,),
    (third_solver, slide, inflate),
    (other_substeps, drive),
    (pin, weather, drag_with_another_hand),
    (shipped_solver, drag, drive, add),
)


def perform(person: Person, ticks: int, rounds: int) -> None:
    """Play every scene, and all of them again in each further round."""
    length = ticks // (rounds * len(SCENES))
    for scene in SCENES * rounds:
        acts = [act(person, length) for act in scene]
        for _ in range(length):
            for act in acts:
                # It ends where hands may not go on.
                with suppress(NotAllowed):
                    next(act, None)
            person.session.advance()
    while person.session.tick < ticks:
        person.session.advance()


def make_golden(path: Path) -> Path:
    """Record the golden of a level, in the place of the one that there is; its file."""
    name = path.stem
    target = golden_path(name)
    part = target.with_name(f"part-{target.name}")
    session = Session(read_level(path))
    session.record_to(part, STATE_TICKS)
    if name in SHORTER:
        perform(Person(name, session), SHORTER[name], 1)
    else:
        perform(Person(name, session), LONG, ROUNDS)
    assert session.stop_recording() == part, session.messages
    world = session.world
    assert np.isfinite(world.position).all(), f"{name}: blew up"
    return part.replace(target)


def main(names: list[str], processes: int) -> None:
    """Record the goldens of the shipped levels of these names, of all where there are none."""
    paths = [path for path in shipped_levels() if path.stem in names or not names]
    unknown = set(names) - {path.stem for path in paths}
    if unknown:
        raise SystemExit(f"no shipped level is called {', '.join(sorted(unknown))}")
    with ProcessPoolExecutor(processes) as pool:
        for path in pool.map(make_golden, paths):
            print(path, flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Record the goldens anew.")
    parser.add_argument("levels", nargs="*", metavar="LEVEL", help="shipped levels; default: all")
    parser.add_argument("--processes", type=int, default=os.cpu_count(), help="default: as many as processors")
    given = parser.parse_args()
    main(given.levels, given.processes)
