"""A golden that fails says what was edited and how far its runs come apart, in a real run of pytest."""

import json

import pytest
from PIL import Image, ImageChops

from sandbox.cli import main
from sandbox.level.reading.files import level_data
from sandbox.physics.snapshot import restore
from sandbox.session.commands import Grab, Pin, Release
from sandbox.session.compare.comparison import compare, to_the_end
from sandbox.session.compare.distance import distance_in_step, metres
from sandbox.session.level_edits import with_value
from sandbox.session.replay.format import seal
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

CHECKS = [
    {"name": "it hangs", "metric": "y", "particle": "rope.end", "after": 0.5, "at_most": 5.0},
    {"name": "it is slow", "metric": "max_speed", "after": 0.2, "at_most": 2.5},
]
TICKS = 200
BASE = rope_level(checks=CHECKS)


def recorded(path, level=BASE, by_hand=None):
    """A recording of a rope that is taken, moved and let go."""
    session = Session(level)
    session.record_to(path, 60)
    session.submit(Pin(4))
    for tick in range(TICKS):
        if tick == 20:
            session.submit(Grab(0, session.world.particle_slot("rope.end"), (4.0, 1.0)))
        if tick == 60:
            session.submit(Release(0))
        if tick == by_hand:
            session.world.velocity[7, 1] = 1.5
        session.advance()
    session.stop_recording()
    return session


def resealed(path, **changes):
    """Change values of the lines of a recording that have them, and seal it anew."""
    sealed, chain = b"", ""
    for line in path.read_bytes().splitlines():
        values = json.loads(line)
        del values["chain"]
        fresh, chain = seal(values | {key: value for key, value in changes.items() if key in values}, chain)
        sealed += fresh
    path.write_bytes(sealed)


@pytest.fixture
def project(pytester):
    """A folder with a level and a recording of it, and a function that runs pytest there."""
    path = pytester.path
    (path / "levels").mkdir()
    recorded(path / "pull.replay.jsonl")
    (path / "pytest.ini").write_text("[pytest]\nsandbox_against = levels\n")

    def run(*arguments):
        found = pytester.runpytest_inprocess("-q", *LOADED, "--replay-output=out", *arguments)
        return found.ret, found.stdout.str()

    def edit(**changes):
        level = BASE
        for name, value in changes.items():
            level = with_value(level, name.replace("__", "."), value)
        (path / "levels" / "rope.json").write_text(json.dumps(level_data(level)))

    run.path, run.edit = path, edit
    edit()
    return run


def test_an_edited_level_is_told_by_its_field_its_distance_and_what_accepts_it(project):
    assert project("pull.replay.jsonl")[0] == 0
    project.edit(materials__steel__stiffness=0.6, settings__gravity=[0.0, -14.0])
    code, told = project("pull.replay.jsonl")
    assert code == 1
    assert "rope.json: settings.gravity: [0.0, -9.81] (default) -> [0.0, -14.0]\n" in told
    assert "rope.json: materials.steel.stiffness: 0.8 -> 0.6\n" in told
    found = to_the_end(
        compare(
            read_replay(project.path / "pull.replay.jsonl"),
            level=with_value(with_value(BASE, "materials.steel.stiffness", 0.6), "settings.gravity", [0.0, -14.0]),
        )
    )
    assert found.distance.farthest > 0.05 and found.distance.tick > 20
    most = f"at most {metres(found.distance.farthest)} apart, {found.distance.particle} at tick {found.distance.tick}; "
    assert most + f"{metres(found.distance.end)} at the end, tick {TICKS}\n" in told
    assert "checks in this run: 1 of 2 hold as before\nheld before: it is slow: FAILS: max_speed" in told
    assert "to accept: pytest --replay-update pull.replay.jsonl\n" in told
    # The picture is of the tick at which they are farthest apart: its halves differ.
    with Image.open(project.path / "out" / "pull.replay.jsonl.png") as picture:
        half = picture.height // 2
        halves = [picture.convert("RGB").crop((0, top + 26, picture.width, top + half)) for top in (0, half)]
    changed = ImageChops.difference(*halves).getbbox()
    assert changed is not None and changed[2] - changed[0] > 60
    page = (project.path / "out" / "pull.replay.jsonl.html").read_text()
    assert f'"first":{found.distance.tick},' in page
    assert project("pull.replay.jsonl", "--replay-update")[0] == 0
    assert project("pull.replay.jsonl")[0] == 0


def test_other_counts_are_told_by_body(project):
    project.edit(bodies__rope__segments=10)
    _, told = project("pull.replay.jsonl")
    assert "rope.json: bodies.rope.segments: 11 -> 10\n" in told
    assert "rope: 12 -> 11 particles, rope: 11 -> 10 springs\n" in told
    assert "1 particle is in one of the runs alone\n" in told


def test_a_recording_of_another_physics_version_is_measured_at_its_stored_states(project):
    resealed(project.path / "pull.replay.jsonl", physics_version=1)
    code, told = project("pull.replay.jsonl")
    assert code == 1 and "recorded with physics version 1; " in told
    assert f"no particle is elsewhere at the stored states until tick {TICKS}\n" in told
    project.edit(settings__gravity=[0.0, -14.0])
    _, told = project("pull.replay.jsonl")
    assert "rope.json: settings.gravity: [0.0, -9.81] (default) -> [0.0, -14.0]\n" in told
    assert " apart at the stored states, " in told and "to accept: pytest --replay-update" in told


def test_what_a_program_writes_into_a_recorded_world_is_named_when_it_is_recorded_and_replayed(tmp_path, capsys):
    path = tmp_path / "poked.replay.gz"
    session = recorded(path, by_hand=130)
    words = "at tick 130 a program wrote velocity[7] (rope.7) by hand"
    assert [words in message for message in session.messages] == [True]
    assert main(["replay", str(path)]) == 1
    told = capsys.readouterr().out
    assert "diverged at tick 131: " in told and words in told and "this build steps differently" not in told
    assert read_replay(path).written[0].tick == 130


def test_a_recording_of_commands_alone_names_nothing_as_written_by_hand(tmp_path):
    path = tmp_path / "clean.replay.gz"
    session = Session(BASE)
    session.record_to(path)
    for tick in range(60):
        session.submit(Pin(tick % 5 + 1))
        if tick % 7 == 6:
            session.undo()
        if tick % 14 == 8:
            session.redo()
        session.apply_pending()
        session.advance()
    session.stop_recording()
    assert not any("by hand" in each for each in session.messages)
    assert read_replay(path).written == () and compare(read_replay(path)) is None


def test_to_the_end_says_whether_a_difference_grows_or_shrinks(project, capsys):
    project.edit(settings__gravity=[0.0, -14.0])
    files = str(project.path / "pull.replay.jsonl"), "--against", str(project.path / "levels" / "rope.json")
    assert main(["replay", *files, "--to-end"]) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[0].endswith("at tick 0: settings: expected gravity [0.0, -9.81], got gravity [0.0, -14.0]")
    assert told[1] == "  rope.json: settings.gravity: [0.0, -9.81] (default) -> [0.0, -14.0]"
    assert told[-1].startswith("  it grows: ") and f"at tick {TICKS}" in told[-1]
    assert main(["replay", *files, "--to-end", "--json"]) == 1
    apart = json.loads(capsys.readouterr().out)["apart"]
    assert apart["farthest"] >= apart["end"] > 0.05 and apart["last"] == TICKS


def test_a_difference_that_heals_is_told_as_one(tmp_path):
    path = tmp_path / "a.replay.gz"
    session = Session(BASE)
    session.record_to(path)
    for _ in range(40):
        session.advance()
    session.stop_recording()
    replay = read_replay(path)
    expected, actual = Session(BASE), Session(BASE)
    actual.world.position[3, 0] += 0.25

    def heal():
        if actual.tick == 10:
            restore(actual.world, expected.snapshot())

    found = distance_in_step(expected, actual, replay.ticks, progress=lambda done, total: heal())
    assert found.first == 0 and found.heals is not None and found.end == 0.0
    assert found.verdict().startswith(f"it heals: from tick {found.heals} on no particle is elsewhere")
