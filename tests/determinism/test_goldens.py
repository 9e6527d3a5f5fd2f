"""Every run that is kept as a golden gives the bits that it gave: all solvers, hands, cuts, sliders, drives, air."""

import pytest

from sandbox.level.format.files import shipped_levels
from sandbox.physics.jit import COMPILED
from tests.determinism.golden import FOLDER, KEPT_TICKS, golden_names, played, read_golden

SIZE_LIMIT = 1_000_000  # [bytes] of all goldens together
# Interpreted kernels are some hundred times slower: up to the first kept tick, where particles times ticks are few.
INTERPRETED_WORK = 6_000
MAKE = "python -m tests.determinism.make_goldens makes it"


@pytest.mark.parametrize("name", golden_names())
def test_a_golden_run_gives_the_same_bits(name):
    golden = read_golden(name)
    session, expected = golden.start(), golden.kept
    if not COMPILED:
        if session.level.has_contacts or session.world.particle_count * KEPT_TICKS > INTERPRETED_WORK:
            pytest.skip("takes too long with interpreted kernels")
        expected = expected[:1]
    states = played(session, expected[-1].tick)
    for kept, present in zip(expected, states, strict=True):
        names = {*kept.arrays, *present.arrays}
        differing = sorted(array for array in names if kept.arrays.get(array) != present.arrays.get(array))
        place = f"{name}, between tick {kept.tick - KEPT_TICKS} and {kept.tick}"
        assert not differing, f"{place}: these arrays differ: {', '.join(differing)}"
        assert present.hash == kept.hash, f"{place}: no array differs, but settings or the order of hashing do"


def test_every_shipped_level_has_a_golden():
    missing = {path.stem for path in shipped_levels()} - set(golden_names())
    assert not missing, f"no golden of {', '.join(sorted(missing))}; {MAKE}"


def test_goldens_hold_every_kind_of_change_and_each_level_all_solvers():
    types = set()
    for name in golden_names():
        commands = [line["command"] for line in read_golden(name).commands]
        types |= {command["type"] for command in commands}
        solvers = {command.get("solver") for command in commands if command["type"] == "set_solver"}
        assert solvers >= {"single_pass", "iterative", "direct"}, name
    assert types >= {
        "grab", "move_grab", "release", "pin", "unpin", "cut_springs", "add_particle", "add_spring",
        "set_coefficients", "set_firmness", "set_gravity", "set_air", "set_drive", "set_inflation", "set_solver",
        "undo", "redo",
    }  # fmt: skip


def test_goldens_stay_small():
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) < SIZE_LIMIT
