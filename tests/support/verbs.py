"""What people do to soft bodies, on any level, and what is wrong with the picture a while later."""

from collections.abc import Callable, Iterator

import numpy as np

from sandbox.level.document.model import Level
from sandbox.physics.world import World
from sandbox.session.commands import (
    Command,
    Pin,
    SetCoefficients,
    SetFirmness,
    SetInflation,
    SetSolver,
)
from sandbox.session.session import Session
from tests.support.overlaps import overlaps

# As the window has it [s].
RAMP_TIME = 1.25
# How long a level runs first, and after what is done to it [s].
BEFORE, AFTER = 2.0, 3.0
# Depth of an overlap at most, as a share of the shortest spring's length; part of the bodies in the picture at least.
DEEPEST, LEAST_SEEN = 1 / 20, 9 / 10

Step = Callable[[World, int], Iterator[Command]]


def _firmness(sag: float) -> Step:
    def commands(world: World, duration: int) -> Iterator[Command]:
        for body in range(len(world.forms)):
            yield SetFirmness(body, sag=sag, duration=duration)

    return commands


def _coefficients(stiffness: float, damping: float) -> Step:
    def commands(world: World, duration: int) -> Iterator[Command]:
        yield SetCoefficients(stiffness, damping, duration=duration)

    return commands


def _solver(name: str) -> Step:
    def commands(world: World, duration: int) -> Iterator[Command]:
        yield SetSolver(solver=name, duration=duration)

    return commands


def _inflation(value: float) -> Step:
    def commands(world: World, duration: int) -> Iterator[Command]:
        for body in range(len(world.area_names)):
            yield SetInflation(body, value, duration)

    return commands


def _freeze(world: World, duration: int) -> Iterator[Command]:
    ends = world.particle_a[world.forms[-1].springs], world.particle_b[world.forms[-1].springs]
    for particle in np.unique(np.concatenate(ends)).tolist():
        if world.inverse_mass[particle] > 0.0:
            yield Pin(particle)


# What is done, one step after another.
VERBS: dict[str, tuple[Step, ...]] = {
    "soften": (_firmness(0.25),),
    "stiffen": (_firmness(0.0),),
    "soften and stiffen": (_firmness(0.25), _firmness(0.0)),
    "soften and stiffen springs": (_coefficients(0.05, 0.2), _coefficients(1.0, 1.0)),
    "melt": (_solver("single_pass"),),
    "melt and make whole": (_solver("single_pass"), _solver("direct")),
    "freeze": (_freeze,),
    "freeze and stiffen": (_freeze, _firmness(0.0)),
    "grow": (_inflation(1.3),),
    "grow and shrink": (_inflation(1.3), _inflation(0.8)),
}


def played(level: Level, verb: str) -> Session:
    """A run in which that was done, a while after."""
    session = Session(level)
    rate = session.world.settings.tick_rate
    _go(session, round(BEFORE * rate))
    for step in VERBS[verb]:
        for command in step(session.world, round(RAMP_TIME * rate)):
            session.submit(command)
        _go(session, round(AFTER * rate))
    return session


def _go(session: Session, ticks: int) -> None:
    for _ in range(ticks):
        session.advance()


def seen(session: Session) -> dict[str, bool]:
    """The bodies that have a form, and whether the middle of each is in the level's picture."""
    world, view = session.world, session.level.view
    found = {}
    for form in world.forms:
        place = world.position[world.particle_a[form.springs]].mean(axis=0)
        found[form.name] = view is None or bool(view[0] <= place[0] <= view[2] and view[1] <= place[1] <= view[3])
    return found


def faults(session: Session) -> list[str]:
    """What is wrong with the picture."""
    world = session.world
    used = world.spring_active & (world.material >= 0)
    spacing = float(world.natural_length[used].min()) if used.any() else 1.0
    radius = float(world.radius[world.particle_active].max())
    found = []
    for (first, second), depth in overlaps(world).depth.items() if world.has_contacts else ():
        if depth * radius > DEEPEST * spacing:
            of = "itself" if first == second else f"shape {second}"
            found.append(f"shape {first} in {of}, {depth * radius / spacing:.2f} of a spacing deep")
    there = list(seen(session).values())
    if there and np.mean(there) < LEAST_SEEN:
        found.append(f"{there.count(False)} of {len(there)} bodies out of the picture")
    return found
