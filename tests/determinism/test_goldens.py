"""Every run that is kept as a golden gives the bits that it gave: all solvers, hands, cuts, sliders, drives, air.

Of the long ones a part: all of them whole, by `make goldens`.
"""

import functools
import random

import pytest

from sandbox.level.reading.files import read_level, shipped_levels
from sandbox.physics.jit import COMPILED
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.determinism.golden import FOLDER, LONG, SHORTER, golden_commands, golden_names, golden_path

SIZE_LIMIT, SHORT_SIZE_LIMIT = 5_700_000, 1_150_000  # [bytes] of all goldens together, and of those that are short
SEED, SAMPLE_TICKS = 12, 120
# Interpreted kernels are some hundred times slower: no contacts, and no more than so many particles times ticks.
INTERPRETED_WORK = 6_000
MAKE = "python -m tests.determinism.make_goldens makes it"


@pytest.mark.parametrize("name", golden_names())
def test_a_golden_run_gives_the_same_bits(name):
    replay = read_replay(golden_path(name))
    # The last state is stored where nothing follows it.
    start = random.Random(f"{SEED} {name}").choice(sorted(replay.states)[:-1])
    end = replay.ticks if name in SHORTER else start + SAMPLE_TICKS
    if not COMPILED:
        ticks = INTERPRETED_WORK // len(replay.state(0).mass)
        if replay.level.has_contacts or not ticks:
            pytest.skip("takes too long with interpreted kernels")
        end = min(end, start + ticks)
    divergence = verify(replay, start=start, end=end)
    assert divergence is None, f"{name}: {divergence}"


def test_every_shipped_level_has_a_golden_of_a_minute_or_is_one_that_takes_long():
    missing = {path.stem for path in shipped_levels()} - set(golden_names())
    assert not missing, f"no golden of {', '.join(sorted(missing))}; {MAKE}"
    long = set(golden_names()) - set(SHORTER)
    assert len(long) >= 18
    assert all(_commands(name)[-1]["tick"] > 0.9 * LONG for name in long)


def test_goldens_hold_every_kind_of_change_and_each_level_all_solvers_that_hands_may_set():
    limited = {path.stem for path in shipped_levels() if read_level(path).hands is not None}
    types = set()
    for name in golden_names():
        commands = [line["command"] for line in _commands(name)]
        types |= {command["type"] for command in commands}
        solvers = {command.get("solver") for command in commands if command["type"] == "set_solver"}
        if name not in limited:
            assert solvers >= {"single_pass", "iterative", "direct"}, name
    assert types >= {
        "grab", "move_grab", "release", "pin", "unpin", "cut_springs", "add_particle", "add_spring",
        "set_coefficients", "set_firmness", "set_gravity", "set_air", "set_drive", "set_inflation", "set_solver",
        "undo", "redo",
    }  # fmt: skip


def test_goldens_stay_small():
    sizes = {path.name: path.stat().st_size for path in FOLDER.iterdir()}
    assert sum(sizes.values()) < SIZE_LIMIT
    assert sum(sizes[golden_path(name).name] for name in SHORTER) < SHORT_SIZE_LIMIT


_commands = functools.cache(golden_commands)
