"""Situations from public bug reports of engines and sandboxes, each a level whose checks hold the right value.

A level's description names the report and derives the value. Files are named KIND--SITUATION; promises over whole
scopes are in the other files of tests/physics.
"""

from pathlib import Path

import pytest

from sandbox.level.reading.files import load_level
from sandbox.session.check_run import run_checks
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session

LEVELS = Path(__file__).parent / "levels"
CHECKED = sorted(path.stem for path in LEVELS.glob("*.json") if load_level(str(path)).checks)


@pytest.mark.parametrize("situation", CHECKED)
def test_it_comes_out_as_physics_says(situation):
    results = run_checks(load_level(str(LEVELS / f"{situation}.json")))
    assert results
    assert [result.text for result in results if not result.passed] == []


def test_what_hangs_at_rest_stays_where_it_is_when_substeps_change():
    session = Session(load_level(str(LEVELS / "substeps--one.json")))
    for _ in range(2400):
        session.advance()
    end = session.world.particle_slot("r.end")
    hung = float(session.world.position[end, 1])
    session.submit(from_record({"type": "set_solver", "substeps": 8}, session.world))
    for _ in range(2400):
        session.advance()
    # 21 mm of 4 m are stretch; by substeps that kept motion alone it became 239 mm.
    assert abs(float(session.world.position[end, 1]) - hung) < 1e-4
