"""A hydraulic that comes back, from its file to its recording."""

import json

import pytest

from sandbox.level.assembly.build_world import build_world
from sandbox.level.document.canonical import level_text
from sandbox.level.document.schema import schema
from sandbox.level.reading.parse import parse_level
from sandbox.session.commands import SetDrive
from sandbox.session.session import Session


def flipper(**more):
    """A level of a hydraulic between a pin and a ball, as its data."""
    return {
        "format": "spring-sandbox/level",
        "version": 3,
        "name": "Flipper",
        "settings": {"gravity": [0.0, 0.0], "solver": "direct"},
        "particles": [{"id": "pin", "pinned": True}, {"id": "ball", "position": [1.0, 0.0]}],
        "springs": [{"a": "pin", "b": "ball", "hydraulic": {"shortest": 1.0, "longest": 1.5, "rate": 2.0, **more}}],
    }


def parsed(data):
    return parse_level(json.dumps(data).encode(), "flipper.json")


def test_a_level_says_that_a_hydraulic_returns_and_only_where_it_does():
    returning, staying = parsed(flipper(returns=True)), parsed(flipper())
    assert '"returns": true' in level_text(returning) and "returns" not in level_text(staying)
    assert parsed(json.loads(level_text(returning))) == returning
    assert parsed(flipper(returns=False)) == staying
    assert schema()["$defs"]["HydraulicDef"]["properties"]["returns"]["type"] == "boolean"


@pytest.mark.parametrize("returns", [True, False])
def test_what_its_key_drove_comes_back_when_the_key_is_up_again(returns):
    session = Session(parsed(flipper(returns=returns)))
    session.submit(SetDrive(0, 1.0))
    for _ in range(30):
        session.advance()
    out = session.snapshot().position[1, 0]
    session.submit(SetDrive(0, 0.0))
    for _ in range(60):
        session.advance()
    back = session.snapshot().position[1, 0]
    assert out == pytest.approx(1.5, abs=0.02)
    assert back == pytest.approx(1.0 if returns else 1.5, abs=0.02)


def test_a_level_without_any_builds_the_world_that_it_built():
    assert not build_world(parsed(flipper())).actuators.hydraulics.returns.any()
    assert build_world(parsed(flipper(returns=True))).actuators.hydraulics.returns.all()
