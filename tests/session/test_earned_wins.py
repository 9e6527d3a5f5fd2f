"""Levels that ask something are won by what they are about: not by a pause, a carry, or anything hands may not do."""

import collections
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from sandbox.level.reading.files import load_level
from sandbox.physics.jit import COMPILED
from sandbox.session.outcome import outcome
from sandbox.session.session import Session
from tests.solutions import SOLUTIONS
from tests.support.cheats import cheated, random_play, some_tricks
from tests.support.wholes import part_and_whole

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")

# Runs of each way in which a level is played, and for how long [s]. With 200 all levels take 40 minutes of a processor.
FEW, MANY, SECONDS = 4, 40, 10.0
KEYS = {"set_drive", "hold_key", "undo", "redo"}
PULLING = {"grab", "move_grab", "release"}
# What hands may do in each level.
DEEDS: dict[str, set[str]] = {
    "chain_of_events": PULLING, "basket_throw": PULLING, "ferry": PULLING,
    "squeeze": {"set_firmness"}, "egg_drop": {"set_firmness"}, "low_door": {"set_firmness", "set_coefficients"},
    "trampoline_basket": {"set_coefficients"}, "catapult_practice": {"set_coefficients"},
    "bridge_budget": {"add_body", "add_particle", "add_spring", "remove"},
    "crane": set(), "truck_course": set(), "sorting_belt": set(), "pinball_score": set(),
}  # fmt: skip
WALL, WALL_TOP = 1.2, 4.2


class Seen:
    """What was seen of a run, tick by tick, by names of particles."""

    def __init__(self, session: Session) -> None:
        self.session, self.world = session, session.world
        self.faults: list[str] = []

    def at(self, name: str) -> tuple[float, float]:
        """Where a particle is."""
        x, y = self.world.position[self.world.particle_slot(name)].tolist()
        return x, y

    def places(self, body: str) -> np.ndarray[Any, Any]:
        """Where the particles of a body are (n, 2)."""
        names = self.world.particle_names
        slots = [slot for slot, name in enumerate(names) if name.startswith(f"{body}.")]
        assert self.world.particle_active[slots].all()
        return self.world.position[slots]


def chain_of_events(seen: Seen) -> Iterator[str | None]:
    """The hand lets the marble go before the dominoes, and each link sets off the next."""
    held = False
    while True:
        held = held or (seen.world.any_held() and seen.at("marble")[0] > -6.7)
        first = seen.world.rule_first[1:5].tolist()
        yield "carried" if held else ("no chain" if sorted(first) != first or first[0] < 0 else None)


def basket_throw(seen: Seen) -> Iterator[str | None]:
    """Since it came from this side of the wall no hand has held the ball, and it went over the wall."""
    fault: str | None = None
    before = seen.at("ball")
    while True:
        x, y = seen.at("ball")
        if x <= WALL:
            fault = None
        elif seen.world.any_held():
            fault = "carried"
        elif before[0] <= WALL and max(y, before[1]) < WALL_TOP:
            fault = "through the wall"
        before = (x, y)
        yield fault


def ferry(seen: Seen) -> Iterator[str | None]:
    """In the middle of the river each crate is in the boat."""
    flying = collections.Counter[int]()
    while True:
        boat = seen.places("boat")
        for crate in (1, 2, 3):
            x, y = seen.places(f"crate {crate}").mean(axis=0).tolist()
            low, high = boat.min(axis=0), boat.max(axis=0)
            is_in = low[0] - 0.3 < x < high[0] + 0.3 and low[1] < y < high[1] + 1.0
            flying[crate] += abs(x) < 0.4 and not is_in
        yield "flew" if max(flying.values()) > 12 else None


def trampoline_basket(seen: Seen) -> Iterator[str | None]:
    """The ball has been on the bed."""
    lowest = np.inf
    while True:
        x, y = seen.at("ball")
        lowest = min(lowest, y) if -8.4 < x < -3.6 else lowest
        yield None if lowest < 4.2 else "never on the bed"


def egg_drop(seen: Seen) -> Iterator[str | None]:
    """The egg is whole, and its thread is cut."""
    while True:
        names, active = seen.world.spring_names, seen.world.spring_active
        whole = all(on for name, on in zip(names, active.tolist(), strict=True) if name.startswith("egg:"))
        yield None if whole and seen.world.rule_first[0] >= 0 else "broken or hanging"


def low_door(seen: Seen) -> Iterator[str | None]:
    """Hands have made the bridge softer, and under the door the truck is as high as it was built."""
    fault: str | None = "never under the door"
    while True:
        roof, rear = seen.at("truck.7"), seen.at("rear wheel.hub")
        if abs(roof[0]) < 0.3:
            tuned = any(entry.command.type in DEEDS["low_door"] for entry in seen.session.history.log)
            high = np.hypot(roof[0] - rear[0], roof[1] - rear[1]) > 2.2
            fault = None if tuned and high else "a low truck" if tuned else "no tuning"
        yield fault


def catapult_practice(seen: Seen) -> Iterator[str | None]:
    """The ball flew over the wall."""
    fault: str | None = "not over the wall"
    while True:
        x, y = seen.at("ball")
        fault = None if 11.2 < x < 12.0 and y > 5.0 else fault
        yield fault


def bridge_budget(seen: Seen) -> Iterator[str | None]:
    """Nothing of the truck is gone, nothing is tied to it, and there were three parts at most."""
    count = len(seen.world.spring_names)
    while True:
        world, log = seen.world, seen.session.history.log
        parts = sum(entry.command.type.startswith("add_") for entry in log)
        undone = sum(entry.command.type in ("undo", "redo") for entry in log)
        seen.places("truck"), seen.places("rear wheel"), seen.places("front wheel")
        ends = (world.particle_a[count:].tolist(), world.particle_b[count:].tolist())
        names = [world.particle_names[slot] for side in ends for slot in side if world.particle_active[slot]]
        tied = any(name.partition(".")[0] in ("truck", "rear wheel", "front wheel") for name in names)
        yield "tied" if tied else ("too many parts" if parts > 3 and not undone else None)


# What a win has to look like beside what hands did; where nothing stands here, what hands did is all there is to it.
FAIR = {
    each.__name__: each
    for each in (
        chain_of_events, basket_throw, ferry, trampoline_basket, egg_drop, low_door, catapult_practice, bridge_budget
    )
}  # fmt: skip


def unfair(level: str, way: Any, runs: range) -> tuple[list[str], int]:
    """What was won or done in runs that the level does not allow, and how many were won."""
    found, won = [], 0
    description = load_level(level)
    for number in runs:
        session = Session(description)
        fault, judge = None, FAIR[level](Seen(session)) if level in FAIR else None
        for _ in cheated(session, way, number, round(SECONDS * description.settings.tick_rate)):
            fault = None if judge is None else next(judge)
        done = {entry.command.type for entry in session.history.log}
        result = outcome(description, session.world)
        is_won = result is not None and result.is_won
        won += is_won
        if done - DEEDS[level] - KEYS:
            found.append(f"{way.__name__} {number}: {sorted(done - DEEDS[level] - KEYS)}")
        if is_won and fault is not None:
            found.append(f"{way.__name__} {number}: {fault}")
    return found, won


@pytest.mark.slow
@pytest.mark.parametrize("runs", part_and_whole(FEW, MANY))
@pytest.mark.parametrize("way", [some_tricks, random_play], ids=lambda way: way.__name__)
@pytest.mark.parametrize("level", DEEDS)
def test_no_level_is_won_but_by_what_it_is_about(level, way, runs):
    assert unfair(level, way, range(runs))[0] == []


def test_every_level_that_asks_something_says_what_hands_may_do():
    assert set(DEEDS) == set(SOLUTIONS)
    assert [name for name in SOLUTIONS if load_level(name).leaves_all_open] == []
