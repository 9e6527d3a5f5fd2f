"""Settings of a world: checked where they are made."""

import dataclasses

import numpy as np
import pytest

from sandbox.level.document.model import Settings
from sandbox.physics.settings import AUTO, DEFAULT_SOLVER, SOLVER_NAMES, SUBSTEPS, WorldSettings
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.world import World

BAD = [
    ("solver", "dirct"), ("solver", None), ("substeps", 0), ("substeps", 3), ("substeps", 128), ("substeps", True),
    ("substeps", "many"), ("substeps", 2.0), ("tick_rate", 0), ("tick_rate", 60.0), ("tick_rate", True),
    ("iterations", 0), ("iterations", "10"), ("gravity", (0.0,)), ("gravity", 9.81), ("gravity", (0.0, np.nan)),
    ("wind", (np.inf, 0.0)), ("wind", ("1", 0.0)), ("warm_start", -0.1), ("warm_start", 1.1), ("warm_start", np.nan),
    ("drag", -1.0), ("drag", np.inf), ("drag", None),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value"), BAD, ids=str)
def test_a_setting_that_means_nothing_is_refused_in_one_line_that_names_it(name, value):
    with pytest.raises(ValueError) as refusal:
        WorldSettings(**{name: value})
    text = str(refusal.value)
    assert name in text and repr(value) in text and "\n" not in text


@pytest.mark.parametrize("substeps", [*SUBSTEPS, AUTO])
@pytest.mark.parametrize("solver", SOLVERS)
def test_every_solver_and_number_of_substeps_can_be_chosen(solver, substeps):
    chosen = WorldSettings((0, -1), 120, substeps, solver, 1, 0, (0.5, np.float64(2.0)), 3)
    assert (chosen.solver, chosen.substeps) == (solver, substeps)


def test_the_solvers_that_can_be_named_are_those_that_there_are():
    assert tuple(SOLVERS) == SOLVER_NAMES


def test_a_world_and_a_level_that_name_no_solver_have_the_same_one():
    assert World().settings.solver == Settings().solver == DEFAULT_SOLVER == "direct"


def test_a_levels_settings_are_those_of_a_world_with_the_same_defaults():
    assert list(Settings.model_fields) == [field.name for field in dataclasses.fields(WorldSettings)]
    assert WorldSettings(**dict(Settings())) == WorldSettings()
