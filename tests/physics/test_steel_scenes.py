"""Random scenes of steel that springs tie: nothing within changes their momentum or adds energy, and no tick takes it.

Right values are those of mechanics alone. Of energy a reading knows what symplectic Euler keeps, to second order.
"""

from functools import cache

import pytest

from sandbox.physics.jit import COMPILED
from tests.support.steel_scenes import AIR, ROUGH, Account, account, is_supple, random_steel_scene
from tests.support.wholes import some_and_whole

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")

SECONDS = 3.0
SEEDS = some_and_whole(range(40), range(120))
# Rounding, in shares of sum m |v| and of sum m |v| r.
ROUNDING = 1e-8
# What a tick of 1/60 s and shorter may take or give of what moves within, and all ticks together may give.
SHARE, GROWN = 1.1e-2, 1e-1


@cache
def account_of(seed: int) -> Account:
    """The account of a random scene; in a fifth of them a hand pulls first, and lets go."""
    return account(random_steel_scene(seed)[1], SECONDS, pulls=seed % 5 == 4)


def share_of(seed: int) -> float:
    """What a tick may take or give: errors are of second order in the length of a tick."""
    return SHARE * max(1.0, 60.0 / random_steel_scene(seed)[1]["settings"]["tick_rate"]) ** 2


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_within_changes_the_momentum_of_steel_in_the_air_or_along_ice(seed):
    if random_steel_scene(seed)[0] in ROUGH:
        pytest.skip("friction holds it")
    assert account_of(seed).momentum < ROUNDING


@pytest.mark.parametrize("seed", range(40))
def test_nothing_within_turns_steel_in_the_air(seed):
    if random_steel_scene(seed)[0] not in AIR:
        pytest.skip("ground turns it")
    assert account_of(seed).angular < ROUNDING


@pytest.mark.parametrize("seed", range(40))
def test_no_tick_of_steel_takes_more_than_friction_dampers_and_impacts_can(seed):
    if is_supple(random_steel_scene(seed)[1]):
        pytest.skip("chains that come taut take energy as well")
    assert account_of(seed).lost < share_of(seed)


@pytest.mark.parametrize("seed", range(40))
def test_no_tick_of_steel_adds_energy(seed):
    assert account_of(seed).gained < share_of(seed)
    assert account_of(seed).grown < GROWN * max(1.0, share_of(seed) / SHARE)
