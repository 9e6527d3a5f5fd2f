"""Proofs of shipped puzzles after random edits: what is said of each is what a run of the level itself comes to."""

import copy
import json
import random
from collections import deque

import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_data
from sandbox.level.format.level_error import LevelError
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.level.reading.parse import parse_level
from sandbox.physics.jit import COMPILED
from sandbox.session.commands import CommandError
from sandbox.session.looking import Looking
from sandbox.session.outcome import outcome
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from sandbox.session.solution import AFTER, Proof, recorded_win, solution_of
from tests.solutions import SOLUTIONS
from tests.support.wholes import part_and_whole

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted, a level takes minutes")
# Edits of each puzzle, and after how many of those that lose the proof a way is looked for, 60 s of the processor each.
FEW, MANY, LOOKED = 2, 30, 1


def numbers(data, path=()):
    """The places of all numbers in a level's data."""
    if isinstance(data, dict):
        return [place for key, value in data.items() for place in numbers(value, (*path, key))]
    if isinstance(data, list):
        return [place for k, value in enumerate(data) for place in numbers(value, (*path, k))]
    return [path] if isinstance(data, (int, float)) and not isinstance(data, bool) and path != ("version",) else []


def edited(level, chance):
    """A level with one number another, or with other words, that can be built."""
    before = level_data(level)
    places = numbers(before)
    while True:
        data = copy.deepcopy(before)
        if chance.random() < 0.1:
            data["author"], data["view"] = "Somebody", [-20.0, -9.0, 20.0, 9.0]
        else:
            *path, last = chance.choice(places)
            inside = data
            for part in path:
                inside = inside[part]
            value = inside[last] * chance.uniform(0.7, 1.4) + chance.choice((0.0, chance.uniform(-0.5, 0.5)))
            inside[last] = round(value) if isinstance(inside[last], int) else round(value, 4)
        try:
            made = parse_level(json.dumps(data).encode(), "edited")
            build_world(made)
        except LevelError:
            continue
        return made


def run_itself(level, replay):
    """The outcome of a recording's commands on a level."""
    session, rate = Session(level, script=replay.script), level.settings.tick_rate
    try:
        while outcome(level, session.world) is None and session.tick < replay.ticks + round(AFTER * rate):
            session.advance()
    except CommandError:
        return None
    return outcome(level, session.world)


@pytest.mark.slow
@pytest.mark.parametrize("count", part_and_whole(FEW, MANY))
@pytest.mark.parametrize("name", SOLUTIONS)
def test_after_random_edits_what_is_said_of_a_solution_is_what_a_run_comes_to(name, count):
    level, chance = load_level(name), random.Random(f"edits of {name}")
    replay = read_replay(solution_of(next(path for path in shipped_levels() if path.stem == name)))
    won = looked = found = 0
    for _ in range(count):
        other = edited(level, chance)
        known, itself = recorded_win(other, replay), run_itself(other, replay)
        if known is not None:
            assert known == itself
            won += 1
            continue
        proof = Proof(other, replay)
        verdict = proof.whole()
        assert verdict.outcome == itself and verdict.passed == (itself is not None and itself.is_won)
        assert (proof.run is not None) == verdict.passed
        won += verdict.passed
        if not verdict.passed:
            assert "; it " in verdict.text and "\n" not in verdict.text
        if not verdict.passed and count == MANY and looked < LOOKED:
            looking = Looking(other, replay.script, replay.ticks)
            deque(looking.work, 0)
            looked, found = looked + 1, found + (looking.found is not None)
            assert looking.found is None or run_itself(other, looking.found).is_won
    print(f"{name}: {won} of {count} still won; a way was found for {found} of {looked} others within 60 s")
