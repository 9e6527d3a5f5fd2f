"""Settings that are changed while a world runs reach a level whole."""

from dataclasses import fields, replace

import pytest

from sandbox.app.panel.contacts import level_at_rate
from sandbox.app.panel.sweeps.pad_sweeps import _present
from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.model import CHANGEABLE_SETTINGS, Settings
from sandbox.physics.settings import WorldSettings
from tests.app.conftest import small_level

OTHERS = {"gravity": (1.0, -2.0), "wind": (3.0, 0.0), "drag": 0.7, "solver": "iterative", "substeps": 4,
          "iterations": 33, "warm_start": 0.25}  # fmt: skip


def test_a_setting_of_a_world_is_one_of_a_level_and_may_change_unless_it_is_the_tick_rate():
    names = {each.name for each in fields(WorldSettings)}
    assert names == set(Settings.model_fields) == {*CHANGEABLE_SETTINGS, "tick_rate"}
    assert set(OTHERS) == set(CHANGEABLE_SETTINGS), "give the new setting a value here"


@pytest.mark.parametrize("name", CHANGEABLE_SETTINGS)
def test_each_setting_that_was_changed_is_in_the_level_of_a_sweep_and_of_another_tick_rate(name):
    level = small_level()
    world = build_world(level)
    world.settings = replace(world.settings, **{name: OTHERS[name]})
    assert getattr(level.settings, name) != OTHERS[name]
    assert getattr(_present(level, world.settings).settings, name) == OTHERS[name]
    assert getattr(level_at_rate(level, world, 120, in_pace=False).settings, name) == OTHERS[name]
