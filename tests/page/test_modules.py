"""Modules of pages that need no browser, tested in node: the tests are in tests/page/modules."""

import json
import os
import random
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox import load_level
from sandbox.app.share.playing import playable
from sandbox.page.page import KERNELS
from sandbox.page.start import array_path
from sandbox.physics.arena import answer_of
from sandbox.physics.meshing import fitting
from sandbox.physics.snapshot import state_hash
from sandbox.physics.state import BY_NAME, COLUMNS
from sandbox.physics.step import step
from sandbox.physics.world import World
from sandbox.replay import read_replay, verify
from sandbox.session.check_run import run_checks
from sandbox.session.outcome import outcome
from sandbox.session.session import Session
from sandbox.tools.drawing import REFUSALS
from tests.determinism.golden import golden_path
from tests.support import rules_level
from tests.support.strokes import rough_stroke
from tests.support.wants import needs

NODE = shutil.which("node")
TESTS = Path(__file__).with_name("modules")
LEVELS = ("rope", "jelly_wheel", "newtons_cradle", "girder")
CHECKED = ("newtons_cradle", "rope")
# A level in which every array with a range has rows, and ticks before a value is spoilt and after that.
SPOILT, SPOILT_TICKS = "girder", 60
# Strokes that are meshed here and there.
STROKES = 300
# Goldens with what was done in them, and so many ticks of each.
GOLDENS, TICKS = ("rope", "walker", "breaking_bridge", "jelly_wheel"), 240


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the tests in node read: toys, and what they come to here."""
    made = tmp_path_factory.mktemp("toys")
    for name in LEVELS:
        (made / name).write_bytes(playable(load_level(name)).content)
    for name in GOLDENS:
        replay = read_replay(golden_path(name))
        played = playable(replay.level, replay.script, min(replay.ticks, TICKS))
        (made / f"{name}-golden").write_bytes(played.content)
    checks = {
        name: {each.check.name: {"passed": each.passed, "value": each.value} for each in run_checks(load_level(name))}
        for name in CHECKED
    }
    given = {"goldens": [f"{name}-golden" for name in GOLDENS], "checks": checks, "rules": _rules(made)}
    given["strokes"] = strokes()
    given["refusals"] = {"small": REFUSALS[fitting.TOO_SMALL], "crosses": REFUSALS[fitting.CROSSES]}
    given["spoilt"] = {"level": SPOILT, "ticks": SPOILT_TICKS, "tries": spoilt()}
    (made / "given.json").write_text(json.dumps(given), encoding="utf-8")
    return made


def _rules(folder: Path) -> dict[str, Any]:
    """A level with rules as a toy, what is done in a run of it, and what that comes to here at each tick."""
    level = rules_level.answering()
    (folder / "rules").write_bytes(playable(level).content)
    session = Session(level)
    hashes, won = [], []
    for tick in range(1, rules_level.TICKS + 1):
        rules_level.run(session, tick)
        found = outcome(level, session.world)
        hashes.append(state_hash(session.world))
        won.append(None if found is None else [found.is_won, found.text, found.stars, found.tick])
    keys = {tick: [command.down for command in rules_level.hands(tick)] for tick in range(rules_level.TICKS)}
    return {"hashes": hashes, "outcomes": won, "keys": {tick: downs for tick, downs in keys.items() if downs}}


def strokes() -> list[dict[str, Any]]:
    """Rough strokes as numbers of the mesher, and what they come to here: a mesh, or words."""
    generator, made = random.Random(2), []
    for _ in range(STROKES):
        numbers = rough_stroke(generator)
        code, arena = answer_of(fitting.fill_stroke, fitting.USUAL_ARENA, np.array(numbers))
        if code != fitting.FITS:
            made.append({"numbers": numbers, "refusal": REFUSALS[code]})
            continue
        mesh = fitting.found_in(arena)
        parts = {"particles": mesh.places, "springs": mesh.pairs, "triangles": mesh.triangles}
        lists = {name: part.tolist() for name, part in parts.items()}
        made.append({"numbers": numbers, "mesh": lists | {"spacing": mesh.spacing, "area": mesh.area}})
    return made


def spoilt() -> list[dict[str, Any]]:
    """What worlds come to after a value of each array with a range was spoilt, or one of a hand's cursor."""
    tries: list[dict[str, Any]] = []
    with_range = [(column, False) for column in COLUMNS if column.within]
    for column, is_cursor in [*with_range, (BY_NAME["position"], True)]:
        world = Session(load_level(SPOILT)).world
        _steps(world)
        place = column.width * world.grab_particle if is_cursor else 1
        getattr(world, column.name).reshape(-1)[place] = np.nan
        _steps(world)
        assert world.contained, column.name
        tries.append({"path": array_path(column), "place": place, "hash": state_hash(world)})
    return tries


def _steps(world: World) -> None:
    for _ in range(SPOILT_TICKS):
        step(world)


def run_in_node(name: str, folder: Path) -> None:
    """Run a file of tests."""
    environment = {**os.environ, "SANDBOX_TOYS": str(folder), "SANDBOX_KERNELS": str(KERNELS)}
    command = [str(NODE), "--test", "--test-reporter=spec", str(TESTS / f"{name}.test.mjs")]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, encoding="utf-8", check=False)
    assert ended.returncode == 0, ended.stdout[-6000:] + ended.stderr[-2000:]


@needs("node", NODE)
@pytest.mark.parametrize("name", sorted(path.name.partition(".")[0] for path in TESTS.glob("*.test.mjs")))
def test_a_module_of_pages_does_in_node_what_it_promises(name: str, folder: Path) -> None:
    run_in_node(name, folder)
    if name == "recording":
        assert verify(read_replay(folder / "written.replay.gz")) is None
