"""The plugin of pytest, as a project sees it that has levels and recordings and nothing else."""

import json
import re
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np
import pytest

import sandbox.session.session as session_module
from sandbox.level.reading.files import level_data, read_level
from sandbox.physics.step import step
from sandbox.session.commands import Pin
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.format import encode_state, seal
from sandbox.session.replay.reader import read_replay
from sandbox.session.session import Session
from tests.support.rope_level import rope_level
from tests.testing.conftest import LOADED

pytest_plugins = ["pytester"]

CHECKS = [
    {"name": "the end stays up", "metric": "y", "particle": "rope.end", "after": 0.2, "at_least": -6.0},
    {"name": "it is slow", "metric": "max_speed", "after": 0.2, "at_most": 0.001},
]
TICKS = 40


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    """A folder with a level, and recordings of it under each of the names that recordings have."""
    folder = tmp_path_factory.mktemp("project")
    (folder / "levels").mkdir()
    level = rope_level(checks=CHECKS[:1])
    (folder / "levels" / "rope.json").write_text(json.dumps(level_data(level)))
    (folder / "levels" / "foreign.json").write_text('{"format": "something else", "note": "spring-sandbox/level"}')
    for number, name in enumerate(("one.replay.jsonl", "two.replay.gz", "three.replay.jsonl.gz")):
        session = Session(level)
        session.record_to(folder / name, 15)
        session.submit(Pin(4 + number))
        for _ in range(TICKS):
            session.advance()
        session.stop_recording()
    return folder


@pytest.fixture
def project(pytester, made):
    """A function that runs pytest in a copy of that folder, in this process."""
    for path in made.rglob("*"):
        if path.is_file():
            copy = pytester.path / path.relative_to(made)
            copy.parent.mkdir(exist_ok=True)
            copy.write_bytes(path.read_bytes())

    def run(*arguments):
        return pytester.runpytest_inprocess("--replay-output=out", *LOADED, *arguments)

    run.path = pytester.path
    return run


@pytest.fixture
def fault(monkeypatch):
    """A function that lets every run step wrongly at a tick: one velocity is one unit in the last place larger."""

    def inject(tick: int, slot: int, times: int) -> None:
        left = [None] * times

        def wrong(world):
            step(world)
            if world.tick == tick and left:
                left.pop()
                world.velocity[slot, 1] = np.nextafter(world.velocity[slot, 1], np.inf)

        monkeypatch.setattr(session_module, "step", wrong)

    return inject


def test_recordings_and_the_checks_of_levels_are_tests(project):
    result = project("-v")
    result.assert_outcomes(passed=5)
    names = re.findall(r"^(\S+)::(.*) PASSED", result.stdout.str(), re.MULTILINE)
    assert dict(names).keys() == {"levels/rope.json", "one.replay.jsonl", "two.replay.gz", "three.replay.jsonl.gz"}
    assert [name for file, name in names if file == "levels/rope.json"] == ["is valid", "the end stays up"]


def test_what_says_that_it_is_something_else_is_left_alone_also_where_levels_lie(project):
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "level"}
    (project.path / "levels" / "level.schema.json").write_text(json.dumps(schema))
    (project.path / "levels" / "map.json").write_text('{"type": "map", "layers": []}')
    project("levels").assert_outcomes(passed=2)
    project("levels/foreign.json", "-q").assert_outcomes()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "line 1, column 2: not JSON: the file ends inside the level"),
        ("", "is empty; a level is a JSON object {...}"),
        ("[1]", "a level is an object {...}; this is a list"),
        ('{"format": "spring-sandbox/levle"}', 'format: "spring-sandbox/levle" is not "spring-sandbox/level"'),
        ('{"format": "Spring Sandbox/level "}', 'format: "Spring Sandbox/level " is not "spring-sandbox/level"'),
        ('{"fromat": "spring-sandbox/level"}', 'fromat: unknown key; did you mean "format"?'),
        ('{"name": "x"}', "format: is missing"),
    ],
)
def test_a_level_that_is_cut_off_empty_or_misspelt_fails_where_levels_lie_and_where_it_is_named(project, text, told):
    (project.path / "levels" / "rope.json").write_text(text)
    for arguments in (["levels"], ["levels/rope.json"]):
        result = project(*arguments)
        result.assert_outcomes(failed=1)
        assert f"rope.json: {told}" in result.stdout.str()


def test_a_pattern_of_levels_that_fits_no_file_is_a_usage_error(project):
    (project.path / "pytest.ini").write_text("[pytest]\nsandbox_levels = levels/*.json lvels/*.json\n")
    result = project()
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    assert "sandbox_levels: 'lvels/*.json': there is no such file in" in result.stderr.str()


def test_a_recording_runs_on_the_file_of_its_level_unless_its_own_copy_is_asked_for(project):
    level = level_data(rope_level(checks=CHECKS[:1], settings={"gravity": [0.0, -1.6]}))
    (project.path / "levels" / "rope.json").write_text(json.dumps(level))
    (project.path / "levels" / "damaged.json").write_text("{")
    result = project("one.replay.jsonl")
    result.assert_outcomes(failed=1)
    assert "rope.json: sett" in result.stdout.str()
    project("one.replay.jsonl", "--replay-against=own").assert_outcomes(passed=1)
    (project.path / "pytest.ini").write_text("[pytest]\nsandbox_against = own\n")
    project("one.replay.jsonl").assert_outcomes(passed=1)
    (project.path / "pytest.ini").unlink()
    (project.path / "levels" / "rope.json").unlink()
    project("one.replay.jsonl").assert_outcomes(passed=1)


def test_a_damaged_level_a_failing_check_and_a_changed_byte_fail_in_a_line_each(project):
    (project.path / "levels" / "damaged.json").write_text('{"format": "spring-sandbox/level", ')
    level = level_data(rope_level(checks=CHECKS))
    (project.path / "levels" / "rope.json").write_text(json.dumps(level))
    data = bytearray((project.path / "one.replay.jsonl").read_bytes())
    data[-300] ^= 1
    (project.path / "one.replay.jsonl").write_bytes(data)
    result = project()
    result.assert_outcomes(passed=4, failed=3)
    result.stdout.fnmatch_lines_random([
        "*damaged.json: line 1, column*",
        "it is slow: FAILS: max_speed after 0.2 s is *, wanted at most 0.001",
        "*one.replay.jsonl: line *: changed or damaged*",
    ])  # fmt: skip
    assert "Traceback" not in result.stdout.str()


def test_a_fault_is_told_by_tick_array_body_particle_and_bits_with_a_picture_and_a_film(project, fault):
    fault(tick=23, slot=7, times=1)
    result = project("one.replay.jsonl", "--junitxml=report.xml")
    result.assert_outcomes(failed=1)
    told = result.stdout.str()
    assert "first difference at tick 23, in velocity[7, 1]\nof body rope, particle 7\n" in told
    shown = re.findall(r"^(?:expected|actual) +(\S+)  (\S+)$", told, re.MULTILINE)
    values = [float(decimal) for decimal, _ in shown]
    assert values == [float.fromhex(bits) for _, bits in shown]
    assert values[1] == np.nextafter(values[0], np.inf)
    motion, page, picture = sorted((project.path / "out").iterdir())
    assert (motion.suffix, page.suffix, picture.suffix) == (".gif", ".html", ".png")
    assert '"first":23,' in page.read_text() and f"player: {page}" in told
    failure = xml.parse(project.path / "report.xml").find(".//failure")
    assert failure is not None and "body rope, particle 7" in failure.text


def test_where_a_recording_cannot_give_the_values_its_stored_states_around_that_tick_are_told(project, fault):
    fault(tick=23, slot=7, times=10)
    result = project("one.replay.jsonl")
    result.assert_outcomes(failed=1)
    told = result.stdout.str()
    assert "first difference at tick 23, in velocity" in told and "this build steps differently" in told
    assert "of the stored states the last before is that of tick 15, the first after that of tick 30" in told


def test_without_pillow_there_is_the_picture_alone_and_a_line(project, fault, monkeypatch):
    fault(tick=23, slot=7, times=1)
    monkeypatch.setitem(sys.modules, "PIL", None)
    monkeypatch.setattr("sandbox.app.film.kinds.importlib.util.find_spec", lambda name: None)
    result = project("two.replay.gz")
    result.assert_outcomes(failed=1)
    assert 'motion: GIF needs Pillow: pip install "spring-sandbox[export]"' in result.stdout.str()
    assert sorted(path.suffix for path in (project.path / "out").iterdir()) == [".html", ".png"]


def test_a_stored_state_that_was_changed_and_sealed_anew_is_told(project):
    path = project.path / "one.replay.jsonl"
    other = Session(rope_level())
    for _ in range(30):
        other.advance()
    other.world.position[3, 0] += 1e-9
    sealed, chain = b"", ""
    for line in path.read_bytes().splitlines():
        values = json.loads(line)
        del values["chain"]
        if values.get("tick") == 30 and "state" in values:
            values["state"]["position"] = encode_state(other.world, ["position"])["state"]["position"]
        fresh, chain = seal(values, chain)
        sealed += fresh
    path.write_bytes(sealed)
    result = project("one.replay.jsonl")
    result.assert_outcomes(failed=1)
    assert "first difference at tick 30, in position[" in result.stdout.str()
    assert "the stored state is not the one whose hash stands at its tick" in result.stdout.str()


def test_recordings_run_on_the_present_level_of_their_name(project):
    level = level_data(rope_level(settings={"solver": "iterative", "gravity": [0.0, -1.6]}))
    (project.path / "levels" / "rope.json").write_text(json.dumps(level))
    (project.path / "pytest.ini").write_text("[pytest]\nsandbox_against = levels\n")
    (project.path / "levels" / "foreign.json").unlink()
    result = project("one.replay.jsonl", "two.replay.gz")
    result.assert_outcomes(failed=2)
    assert "first difference at tick 0, in settings" in result.stdout.str()
    result = project("one.replay.jsonl", "two.replay.gz", "--replay-update")
    result.assert_outcomes(passed=2)
    result.stdout.fnmatch_lines(
        ["*recorded again*", "rope.json: settings.gravity: *", "  at most * apart*", "  2 recordings: one*, two*"]
    )
    project("one.replay.jsonl", "two.replay.gz").assert_outcomes(passed=2)
    updated = read_replay(project.path / "two.replay.gz")
    assert (updated.ticks, len(updated.script), sorted(updated.states)) == (TICKS, 1, [0, 15, 30, 40])
    assert updated.level.settings.gravity == (0.0, -1.6)


def test_a_recording_of_another_physics_version_is_recorded_again_and_one_that_is_equal_left_alone(project):
    path = project.path / "one.replay.jsonl"
    sealed, chain = b"", ""
    for line in path.read_bytes().splitlines():
        values = json.loads(line)
        del values["chain"]
        values = {**values, "physics_version": 0} if "physics_version" in values else values
        fresh, chain = seal(values, chain)
        sealed += fresh
    path.write_bytes(sealed)
    untouched = (project.path / "two.replay.gz").stat().st_mtime_ns
    result = project("--replay-update")
    result.assert_outcomes(passed=5)
    result.stdout.fnmatch_lines(
        ["recorded with physics version 0", "  no particle is elsewhere*", "  1 recording: one.*"]
    )
    assert verify(read_replay(path)) is None
    assert (project.path / "two.replay.gz").stat().st_mtime_ns == untouched


def test_with_another_solver_a_recording_is_compared_with_a_second_run_of_its_own(project, fault):
    project("--replay-solver=single_pass").assert_outcomes(passed=5)
    fault(tick=23, slot=7, times=1)
    result = project("--replay-solver=single_pass", "one.replay.jsonl")
    result.assert_outcomes(failed=1)
    assert "two runs with single_pass differ" in result.stdout.str()
    assert project("--replay-solver=x", "--replay-update").ret == pytest.ExitCode.USAGE_ERROR


def test_workers_of_xdist_share_the_tests(project):
    result = project("-n2", "--junitxml=report.xml", "-k", "one or valid")
    result.assert_outcomes(passed=2)
    names = {case.get("name") for case in xml.parse(project.path / "report.xml").iter("testcase")}
    assert names == {"replay", "is valid"}


def test_a_test_in_python_drags_cuts_drives_and_measures(made, pytester):
    pytester.makepyfile(
        """
        import pytest
        from sandbox import Session
        from sandbox.commands import CommandError

        WHEEL = {
            "format": "spring-sandbox/level", "version": 3, "name": "Wheel", "settings": {"solver": "iterative"},
            "bodies": [
                {"type": "wheel", "id": "wheel", "position": [0, 1], "radius": 0.5, "thickness": 0.1, "segments": 8,
                 "motor": {"speed": 5, "torque": 50}},
                {"type": "rope", "id": "rope", "start": [5, 0], "end": [8, 0], "segments": 6, "pin": ["start"],
                 "material": "thread"},
            ],
            "materials": {"thread": {"stiffness": 0.9, "damping": 0.9, "tension_limit": 0.2}},
        }

        def test_driver(sandbox_session):
            run = sandbox_session(WHEEL)
            run.drag("rope.end", (8.0, 1.0), seconds=0.25)
            assert run.seconds == 0.25 and 0.5 < run.position("rope.end")[1]
            run.drive("wheel", 1.0)
            run.run_until(lambda run: run.speed("wheel.0") > 1.0, within=2.0)
            run.cut("rope:2")
            run.run_until(1.5)
            assert run.position("rope.end")[1] < -2.0 and run.broken() == []
            assert run.strain("rope:0") <= run.strain("rope") <= run.strain() < 0.2
            with pytest.raises(CommandError, match="no particle"):
                run.do({"type": "pin", "particle": "nobody"})
            with pytest.raises(CommandError, match="there is no spring"):
                run.cut("rope:2")
            with pytest.raises(CommandError, match='no particle "rpoe.3"; did you mean "rope.3"'):
                run.position("rpoe.3")
            with pytest.raises(CommandError, match='no body with springs "nobody"'):
                run.strain("nobody")
            with pytest.raises(CommandError, match="seconds: must be greater than or equal to 0, not -1"):
                run.run(-1)
            with pytest.raises(CommandError, match="it is 1.5 s already"):
                run.run_until(1.0)

        def test_break(sandbox_session):
            run = sandbox_session(WHEEL)
            run.drag("rope.end", (12.0, 0.0), seconds=0.5, hold=True, strength=1e5)
            assert run.broken() and all(name.startswith("rope:") for name in run.broken())
            run.let_go()
        """
    )
    pytester.runpytest_inprocess(*LOADED).assert_outcomes(passed=2)


def test_a_recording_whose_level_is_gone_fails_unless_it_is_to_run_on_its_own_copy(project):
    level = read_level(project.path / "levels" / "rope.json")
    session = Session(level)
    session.record_to(project.path / "gone.replay.gz")
    session.advance()
    session.stop_recording()
    project("gone.replay.gz").assert_outcomes(passed=1)
    (project.path / "levels" / "rope.json").unlink()
    told = project("gone.replay.gz", "-p", "no:warnings")
    told.assert_outcomes(failed=1)
    assert "its level, rope.json with the title 'Test rope', is neither beside it nor in a" in told.stdout.str()
    project("gone.replay.gz", "--replay-against=own").assert_outcomes(passed=1)


def test_going_back_by_no_tick_is_a_usage_error(project):
    result = project("--replay-rollback=0")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    assert "--replay-rollback: 0: at least 1 tick" in result.stderr.str()
