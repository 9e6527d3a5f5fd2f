"""Random levels and commands give the same bits in every way; a fault of one ulp is named, with the command line."""

import functools
import re

import numpy as np
import pytest

from sandbox.physics import jit
from sandbox.physics.solvers import SOLVERS
from sandbox.session.commands import COMMAND_TYPES
from tests.determinism.elsewhere import WEB, Missing
from tests.determinism.seeds.__main__ import main
from tests.determinism.seeds.child import run_there
from tests.determinism.seeds.difference import Plant, Watch, ulps
from tests.determinism.seeds.levels import random_level
from tests.determinism.seeds.player import recording
from tests.determinism.seeds.ways import run_way
from tests.support.wants import skip_without

pytestmark = pytest.mark.skipif(not jit.COMPILED, reason="interpreted kernels take minutes")
SEEDS, TICKS = range(4), 30
CHEAP = ("library", "undone", "saved", "cramped")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The folder of recordings, and the recording of a seed."""
    folder = tmp_path_factory.mktemp("seeds")
    return folder, functools.cache(lambda seed, ticks=TICKS: recording(seed, ticks, folder))


@pytest.mark.parametrize("way", CHEAP)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_seed_gives_the_same_bits(seed, way, recorded):
    folder, record = recorded
    result = run_way(way, Watch(record(seed)), seed, folder)
    assert result.difference is None, str(result.difference)
    assert result.checks >= TICKS


def test_seeds_make_every_solver_body_and_command(recorded):
    levels = [random_level(seed) for seed in range(60)]
    assert {level.settings.solver for level in levels} == set(SOLVERS)
    assert {level.settings.substeps for level in levels} == {1, 2, 4, "auto"}
    assert {body.type for level in levels for body in level.bodies} == {
        "rope", "bridge", "girder", "web", "wheel", "ring", "jelly", "mesh",
    }  # fmt: skip
    assert {level.has_contacts for level in levels} == {False, True}
    types = {line.record["type"] for seed in range(8) for line in recorded[1](seed, 60).script}
    assert types == set(COMMAND_TYPES)


def test_the_first_ticks_of_a_longer_recording_are_those_of_a_shorter_one(recorded):
    short, long = recorded[1](4, 10), recorded[1](4, 40)
    assert [line.record for line in short.script] == [line.record for line in long.script if line.tick < 10]
    assert [hashes.whole[:8] for hashes in short.hashes] == [hashes.whole[:8] for hashes in long.hashes[:11]]


@pytest.mark.parametrize("way", [*CHEAP, "web"])
@pytest.mark.parametrize(("array", "slot"), [("position", 3), ("rest_length", 2)])
def test_a_fault_of_one_ulp_is_named(way, array, slot, recorded):
    folder, record = recorded
    if way == "web":
        needs_web()
    result = run_way(way, Watch(record(0), Plant(7, array, slot)), 0, folder)
    found = result.difference.divergence
    assert (found.tick, found.array, np.atleast_1d(found.index)[0]) == (7, array, slot), str(found)
    assert result.put and ulps(found.expected, found.actual) == 1
    assert found.name.startswith("b0")


def test_calls_are_the_same_in_webassembly(recorded):
    needs_web()
    result = run_way("web", Watch(recorded[1](1, 12)), 1, recorded[0])
    assert result.difference is None and result.checks > 200, str(result.difference)


def needs_web():
    if jit.way() != "library":
        pytest.skip("calls are noted with the types of the library")
    try:
        WEB.command()
    except Missing as fault:
        skip_without(str(fault))


def test_another_process_interprets_kernels_and_names_a_fault_too(recorded):
    folder, record = recorded
    for seed in (1, 5):
        record(seed)
    ((_, equal), (_, other)) = run_there("interpreted", folder, {1: 2, 5: 3}, "3:velocity:1")
    assert equal.difference is None and (equal.ticks, equal.checks, equal.put) == (2, 3, False)
    assert str(other.difference).startswith("seed 5, interpreted: tick 3: velocity[1, 0] (b0.1): expected ")
    assert str(other.difference).endswith(", 1 ulp apart")


def test_the_program_ends_with_1_where_a_fault_is_planted_and_says_how_to_repeat_it(capsys):
    arguments = ["--first", "2", "--seeds", "1", "--ticks", "12", "--ways", "library,saved"]
    assert main(arguments) == 0
    assert "library: 1 seeds, 12 ticks, 13 checks, 0 differ\n" in capsys.readouterr().out
    assert main([*arguments, "--plant", "5:velocity:1"]) == 1
    told = capsys.readouterr().out
    assert re.search(r"seed 2, saved: tick 5: velocity\[1, 0\] \(.*\): expected .*, got .*, 1 ulp apart", told)
    repeat = "--first 2 --seeds 1 --ticks 12 --ways saved --plant 5:velocity:1"
    assert repeat in told and main(repeat.split()) == 1


@pytest.mark.parametrize("wrong", [["--ways", "library,guessed"], ["--plant", "5"], ["--plant", "5:law:1"]])
def test_what_is_asked_for_wrongly_is_refused(wrong, capsys):
    with pytest.raises(SystemExit):
        main(wrong)
    assert wrong[0] in capsys.readouterr().err


@pytest.mark.parametrize(
    ("values", "apart"),
    [((1.0, 1.0), 0), ((1.0, np.nextafter(1.0, 2.0)), 1), ((-5e-324, 5e-324), 2), ((1.0, np.inf), None)],
)
def test_numbers_between_two_are_counted(values, apart):
    assert ulps(*map(float, values)) == apart
