"""Wherever pytest is started, levels and recordings are tested; what looks like one and is none is named."""

import gzip
import json
import os
import shutil

import pytest

from sandbox.level.reading.files import level_data
from sandbox.session.commands import Pin
from sandbox.session.session import Session
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

CHECKS = [{"name": "the end stays up", "metric": "y", "particle": "rope.end", "after": 0.2, "at_least": -6.0}]
EDIT = {"gravity": [0.0, -1.6]}


def write_level(path, **changes):
    path.parent.mkdir(parents=True, exist_ok=True)
    level = rope_level(**({"checks": CHECKS} | changes))
    path.write_text(json.dumps(level_data(level)))


def record(level_path, path):
    from sandbox.level.reading.files import read_level

    path.parent.mkdir(parents=True, exist_ok=True)
    session = Session(read_level(level_path))
    session.record_to(path, 15)
    session.submit(Pin(4))
    for _ in range(20):
        session.advance()
    session.stop_recording()


@pytest.fixture
def game(pytester):
    """A project in a repository: its level has three tests, of which one is that of its recording."""
    (pytester.path / ".git").mkdir()
    folder = pytester.path / "studio" / "game"
    write_level(folder / "levels" / "rope.json")
    record(folder / "levels" / "rope.json", folder / "replays" / "pull.replay.gz")
    return folder


def run(pytester, folder, *arguments):
    os.chdir(folder)
    return pytester.runpytest_inprocess(*LOADED, "--replay-output=out", "--rootdir", str(folder), *arguments)


@pytest.mark.parametrize("start", ["", "..", "../..", "replays", "levels"])
@pytest.mark.parametrize("arguments", [(), ("-p", "no:warnings")])
def test_an_edited_level_is_seen_from_every_folder(start, arguments, game, pytester):
    at = (game / start).resolve()
    whole = {"replays": 1, "levels": 2}.get(start, 3)
    run(pytester, at, *arguments).assert_outcomes(passed=whole)
    write_level(game / "levels" / "rope.json", settings=EDIT)
    result = run(pytester, at, *arguments)
    if start == "levels":
        result.assert_outcomes(passed=2)
    else:
        result.assert_outcomes(failed=1, passed=whole - 1)
        assert "rope.json: settings" in result.stdout.str()


def test_of_two_levels_of_one_name_the_nearest_counts(game, pytester):
    for world in ("w1", "w2"):
        write_level(game / "levels" / world / "rope.json")
        record(game / "levels" / world / "rope.json", game / "levels" / world / "cut.replay.gz")
    write_level(game / "levels" / "w2" / "rope.json", settings=EDIT)
    result = run(pytester, game)
    result.assert_outcomes(failed=1, passed=8)
    assert "FAILED levels/w2/cut.replay.gz" in result.stdout.str()


def test_another_repository_is_not_looked_into(game, pytester):
    inner = game / "vendor"
    (inner / ".git").mkdir(parents=True)
    shutil.copy(game / "replays" / "pull.replay.gz", inner / "pull.replay.gz")
    run(pytester, inner).assert_outcomes(failed=1)


def plain(name):
    return lambda game: game.joinpath(*name.split("/")).write_bytes((game / "replays" / "pull.replay.gz").read_bytes())


def unpacked(name):
    return lambda game: (game / name).write_bytes(gzip.decompress((game / "replays" / "pull.replay.gz").read_bytes()))


def link(name):
    return lambda game: game.joinpath(*name.split("/")).symlink_to("nowhere")


def golden(name):
    return lambda game: (game / name).write_text('{"format": "spring-sandbox/golden"}')


def level(name):
    return lambda game: write_level(game / name)


RECORDING, GOLDEN_END, SOLVES = (
    "a recording ends in .replay.jsonl or .replay.gz",
    "a golden file ends in",
    "solves no level",
)
MISNAMED = {
    **{name: (plain(name), RECORDING) for name in (
        "a.rec", "a.REC", "a.gz", "a.replay", "a.REPLAY.GZ", "a.Replay.gz", "a.replay.GZ", "replays/b.gz", "a.jsonl.gz",
    )},
    **{name: (unpacked(name), RECORDING) for name in (
        "a.jsonl", "b.rec", "a.replay.JSONL", "a.replay.json", "b.replay",
    )},
    **{name: (golden(name), GOLDEN_END) for name in (
        "swing_golden.json", "swing.Golden.json", "swing-golden.json", "swing.golden.JSON", "swinggolden.json",
    )},
    **{name: (level(name), "a level ends in .json") for name in (
        "levels/BIG.JSON", "levels/Big.Json", "levels/in/a.JSON",
    )},
    **{name: (link(name), "a link to nothing") for name in (
        "replays/x.replay.gz", "levels/x.json", "x.golden.json", "x.replay.jsonl",
    )},
    "levels/rope.solution.replay.jsonl": (unpacked("levels/rope.solution.replay.jsonl"), SOLVES),
    "levels/rope.solution.replay.jsonl.gz": (plain("levels/rope.solution.replay.jsonl.gz"), SOLVES),
    "levels/gone.solution.replay.gz": (plain("levels/gone.solution.replay.gz"), "there is no gone.json beside it"),
    "replays/rope.solution.replay.gz": (plain("replays/rope.solution.replay.gz"), "there is no rope.json beside it"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISNAMED)
def test_what_is_misnamed_is_named(name, game, pytester):
    make, why = MISNAMED[name]
    make(game)
    told = run(pytester, game).stdout.str()
    assert f"not tested: {name}: " in told and why in told


STRANGE = {
    "notes.gz": gzip.compress(b"notes"), "sound.rec": b"RIFF", "data.jsonl": b"{}", "half.gz": b"\x1f\x8b\x08",
    "package.JSON": b"{}", "levels.json": b"{}", "golden.txt": b"", ".hidden.replay.gz": b"",
}  # fmt: skip


@pytest.mark.parametrize("name", STRANGE)
def test_what_is_no_file_of_ours_is_not_named(name, game, pytester):
    (game / name).write_bytes(STRANGE[name])
    result = run(pytester, game)
    result.assert_outcomes(passed=3)
    assert "not tested" not in result.stdout.str()


def test_a_mark_that_fits_nothing_is_named_where_all_is_run(game, pytester):
    (game / "pytest.ini").write_text("[pytest]\nsandbox_marks =\n  xfail: replays/pul.replay.gz\n")
    assert "not tested: xfail: replays/pul.replay.gz: sandbox_marks: fits no" in run(pytester, game).stdout.str()
    assert "not tested" not in run(pytester, game, "levels").stdout.str()


def test_processes_of_xdist_name_it_too(game, pytester):
    plain("a.rec")(game)
    result = pytester.runpytest_subprocess(*LOADED, "-n", "2", "--rootdir", str(game), str(game))
    assert "not tested: a.rec: a recording ends in" in result.stdout.str()


EMPTY = {
    "an empty recording": lambda game: (game / "replays" / "pull.replay.gz").write_bytes(b""),
    "half a recording": lambda game: cut(game / "replays" / "pull.replay.gz"),
    "an empty level": lambda game: (game / "levels" / "rope.json").write_text(""),
    "half a level": lambda game: cut(game / "levels" / "rope.json"),
    "a level of another format": lambda game: (game / "levels" / "rope.json").write_text(
        '{"format": "spring-sandbox/lvel"}'
    ),
    "a renamed level": lambda game: write_level(game / "levels" / "rope.json", name="Another"),
    "a missing level": lambda game: (game / "levels" / "rope.json").unlink(),
    "an empty golden file": lambda game: (game / "a.golden.json").write_text(""),
}


def cut(path):
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])


@pytest.mark.parametrize("what", EMPTY)
def test_what_is_empty_cut_or_gone_fails(what, game, pytester):
    EMPTY[what](game)
    result = run(pytester, game)
    if what == "a renamed level":
        result.assert_outcomes(passed=3)
    else:
        assert result.ret == pytest.ExitCode.TESTS_FAILED


# ---- golden files


GOLDEN_FILE = {
    "format": "spring-sandbox/golden", "level": "levels/rope.json", "commands": "pull.jsonl", "at": [0.2],
    "places": {"rope.end": []},
}  # fmt: skip


def pin(tick):
    return json.dumps({"tick": tick, "command": {"type": "pin", "particle": "rope.4"}}) + "\n"


@pytest.mark.parametrize(
    ("script", "changes", "said"),
    [
        ("", {}, "commands: pull.jsonl holds none"),
        (pin(30), {}, "commands: 1 is after the last place, at tick 12"),
        (pin(1), {"places": {}, "values": {"the end stays up": None}}, "commands: act on places, and there are none"),
    ],
    ids=["empty", "late", "without places"],
)
def test_a_golden_file_carries_out_all_its_commands_or_refuses(script, changes, said, game, pytester):
    (game / "pull.jsonl").write_text(script)
    (game / "a.golden.json").write_text(json.dumps(GOLDEN_FILE | changes))
    result = run(pytester, game, "--replay-update")
    result.assert_outcomes(passed=3, failed=1)
    assert said in result.stdout.str()


# ---- marks


@pytest.mark.parametrize("mark", ["skip", "xfail", "usefixtures"])
def test_marks_of_the_setting_act_as_in_python(mark, game, pytester):
    (game / "pytest.ini").write_text(f"[pytest]\nsandbox_marks =\n  {mark}: replays/*.replay.gz\n")
    outcome = {"skip": {"skipped": 1}, "xfail": {"xpassed": 1}}.get(mark, {"passed": 1})
    run(pytester, game, "replays").assert_outcomes(**outcome)


@pytest.mark.parametrize(
    ("mark", "outcome"),
    [
        ("skip(reason='not now')", {"skipped": 1, "passed": 2}),
        ("skipif(True, reason='not here')", {"skipped": 1, "passed": 2}),
        ("skipif(False, reason='not here')", {"passed": 3}),
        ("xfail(reason='known')", {"xpassed": 1, "passed": 2}),
        ("xfail(reason='known', strict=True)", {"failed": 1, "passed": 2}),
        ("usefixtures('given')", {"passed": 3}),
    ],
)
def test_marks_of_a_conftest_act_as_in_python(mark, outcome, game, pytester):
    (game / "conftest.py").write_text(
        f"""
import pytest

@pytest.fixture
def given():
    print("given")

def pytest_collection_modifyitems(items):
    for item in items:
        if item.path.name.endswith(".replay.gz"):
            item.add_marker(pytest.mark.{mark})
"""
    )
    run(pytester, game).assert_outcomes(**outcome)
