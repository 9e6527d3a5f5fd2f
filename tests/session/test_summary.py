"""Summaries of runs: energies that add up, checks that are held against them."""

import pytest

from sandbox.physics.analysis.energy import total_energy
from sandbox.session.check_run import run_checks
from sandbox.session.commands import CutSprings, Grab, Release, SetDrive
from sandbox.session.session import Session
from sandbox.session.summary import run
from tests.support.rope_level import rope_level


@pytest.mark.parametrize("solver", ["single_pass", "iterative", "direct"])
def test_what_was_there_is_still_there_or_dissipated(solver):
    coefficients = {"steel": {"stiffness": 0.2, "damping": 0.3}, "rubber": {"stiffness": 0.05, "damping": 0.1}}
    session = Session(rope_level(settings={"solver": solver}, materials=coefficients))
    start = total_energy(session.world)
    summary = run(session, 200)
    end = summary.kinetic_energy + summary.potential_energy
    assert summary.potential_energy == pytest.approx(summary.spring_energy + summary.gravity_energy)
    assert start == pytest.approx(end + summary.dissipated_energy, rel=1e-9)
    assert summary.dissipated_energy > 0.0


def test_what_commands_and_hands_change_is_not_counted_as_dissipated():
    session = Session(rope_level(settings={"solver": "direct", "gravity": [0.0, 0.0]}))
    session.submit(Grab(0, 11, (9.0, 9.0)))
    held = run(session, 30)
    assert held.dissipated_energy == 0.0
    assert held.kinetic_energy > 0.0
    session.submit(Release(0))
    session.submit(CutSprings(tuple(range(15))))
    free = run(session, 30)
    assert free.dissipated_energy == pytest.approx(0.0, abs=1e-9 * free.kinetic_energy)


@pytest.mark.parametrize(
    "working",
    [
        {"settings": {"wind": [5.0, 0.0], "drag": 1.0}},
        {"springs": [{"a": "soft.start", "b": "soft.end", "drive": {"amplitude": 0.3, "period": 30}}]},
        {"springs": [{"a": "rope.end", "b": "soft.end", "hydraulic": {"shortest": 1, "longest": 9, "rate": 2}}]},
    ],
)
def test_ticks_in_which_something_works_on_the_world_are_not_counted_as_dissipated(working):
    session = Session(rope_level(**working))
    if len(session.world.actuator_value):
        session.submit(SetDrive(0, 1.0))
    assert run(session, 60).dissipated_energy == 0.0
    if len(session.world.actuator_value):
        session.submit(SetDrive(0, 0.0))
        assert run(session, 10).dissipated_energy != 0.0


def test_a_check_on_a_particle_is_measured_where_it_is():
    check = {"name": "it falls", "metric": "y", "particle": "rope.end", "after": 1.0, "at_most": -1.0}
    (result,) = run_checks(rope_level(checks=[check]))
    session = Session(rope_level())
    run(session, 60)
    assert result.passed
    assert result.value == session.world.position[11, 1]
