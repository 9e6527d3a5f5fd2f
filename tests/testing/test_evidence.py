"""What a failure leaves, where it may not, how many leave it; marks, times and the runs of failing tests in Python."""

import json
import re
import xml.etree.ElementTree as xml
from pathlib import Path

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import level_data
from sandbox.session.compare.comparison import verify
from sandbox.session.replay.reader import read_replay
from tests.support.rope_level import rope_level
from tests.testing import test_plugin as plugin_tests
from tests.testing.conftest import LOADED
from tests.testing.test_plugin import CHECKS

pytest_plugins = ["pytester"]

made, project = plugin_tests.made, plugin_tests.project
# Without what switches the cache off.
CACHED = LOADED[2:]
THREE = ["one.replay.jsonl", "two.replay.gz", "three.replay.jsonl.gz"]


@pytest.fixture
def edited(project):
    """That project after an edit of the level, with which all recordings diverge; its path."""
    level = level_data(rope_level(checks=CHECKS[:1], settings={"gravity": [0.0, -1.6]}))
    (project.path / "levels" / "rope.json").write_text(json.dumps(level))
    return project.path


def test_without_a_cache_the_difference_is_told_and_one_line_that_there_are_no_pictures(edited, pytester):
    result = pytester.runpytest_inprocess(*LOADED, "one.replay.jsonl", "--junitxml=report.xml")
    result.assert_outcomes(failed=1)
    told = result.stdout.str()
    assert "rope.json: sett" in told and "Traceback" not in told
    assert told.count("no pictures: pytest's cache is switched off; --replay-output DIR puts them") == 1
    failure = xml.parse(edited / "report.xml").find(".//failure")
    assert failure is not None and "rope.json: " in failure.text


@pytest.mark.parametrize("place", ["file", "/proc/none"])
def test_where_pictures_cannot_be_the_difference_is_told_and_why_there_are_none(edited, pytester, place):
    (edited / "file").write_text("")
    for options in ([f"--replay-output={place}", *LOADED], ["-o", f"cache_dir={place}/c", *CACHED]):
        result = pytester.runpytest_inprocess(*options, "one.replay.jsonl")
        result.assert_outcomes(failed=1)
        told = result.stdout.str()
        assert "rope.json: sett" in told and "Traceback" not in told
        assert told.count("no pictures: ") == 1 and "Error" not in told


@pytest.mark.parametrize("error", [OSError(28, "No space left on device", "a.png"), ValueError("no such colour")])
def test_a_picture_that_fails_hides_no_difference(edited, project, monkeypatch, error):
    def fail(*_):
        raise error

    monkeypatch.setattr("sandbox.app.share.evidence.write_picture", fail)
    result = project("one.replay.jsonl")
    result.assert_outcomes(failed=1)
    told = result.stdout.str()
    assert "rope.json: sett" in told and "Traceback" not in told
    assert f"no picture: {'a.png: No space left on device' if error.args[1:] else error}" in told


def test_pictures_are_of_the_first_failures_of_none_or_of_all(edited, project, monkeypatch):
    monkeypatch.setattr("sandbox.testing.evidence.FIRST", 2)
    for chosen, drawn in (("none", 0), ("first", 2), ("all", 3)):
        result = project(f"--replay-pictures={chosen}", *THREE)
        result.assert_outcomes(failed=3)
        told = result.stdout.str()
        assert told.count("player: ") == drawn
        assert told.count("no pictures: of the first 2 failures only") == (chosen == "first")
        out = edited / "out"
        assert len(list(out.iterdir()) if out.exists() else []) == 3 * drawn
        for path in out.iterdir() if out.exists() else ():
            path.unlink()
    assert project("--replay-pictures=some").ret == pytest.ExitCode.USAGE_ERROR


def test_two_recordings_of_one_name_have_pictures_of_their_own_wherever_they_lie(edited, project):
    for folder in ("runs/a", "runs-a"):
        (edited / folder).mkdir(parents=True)
        (edited / folder / "x.replay.jsonl").write_bytes((edited / "one.replay.jsonl").read_bytes())
    project("runs/a", "runs-a").assert_outcomes(failed=2)
    found = {path.relative_to(edited / "out").as_posix() for path in (edited / "out").rglob("*.png")}
    assert found == {"runs/a/x.replay.jsonl.png", "runs-a/x.replay.jsonl.png"}


def test_tests_are_chosen_by_what_they_are_and_by_marks_that_the_project_gives(project):
    project("-m", "replay").assert_outcomes(passed=3, deselected=2)
    project("-m", "level", "--strict-markers").assert_outcomes(passed=2, deselected=3)
    (project.path / "pytest.ini").write_text(
        "[pytest]\nmarkers = slow: takes long\nsandbox_marks =\n  slow: t*.replay.*gz\n  xfail: one.*\n"
    )
    project("-m", "slow", "--strict-markers").assert_outcomes(passed=2, deselected=3)
    project("one.replay.jsonl").assert_outcomes(xpassed=1)
    (project.path / "pytest.ini").write_text("[pytest]\nsandbox_marks = slow\n")
    result = project()
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    assert "sandbox_marks: 'slow': write a mark, a colon and a pattern of files" in result.stderr.str()


def test_a_solver_that_there_is_not_is_one_usage_error(project):
    result = project("--replay-solver=nix")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    assert "--replay-solver: there is no solver 'nix'; there are " in result.stderr.str()


def test_each_check_is_run_as_far_as_it_needs_and_has_that_time(project):
    checks = [{**CHECKS[0], "name": f"after {after} s", "after": after} for after in (8.0, 0.1, 4.0)]
    (project.path / "levels" / "rope.json").write_text(json.dumps(level_data(rope_level(checks=checks))))
    project("levels", "-k", "0.1", "--junitxml=report.xml").assert_outcomes(passed=1, deselected=3)
    project("levels", "--junitxml=report.xml").assert_outcomes(passed=4)
    project("levels", "-k", "4.0 or 8.0", "-p", "no:randomly").assert_outcomes(passed=2, deselected=2)


def test_check_and_replay_tell_programs_how_long_each_took(project, capsys):
    level, recording = project.path / "levels" / "rope.json", project.path / "two.replay.gz"
    assert main(["check", str(level), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert 0.0 < told["checks"][0]["wall_seconds"] < told["wall_seconds"]
    assert main(["replay", str(recording), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["wall_seconds"] > 0.0


def test_a_folder_of_recordings_is_verified_in_one_process_or_in_several(project, capsys):
    nested = project.path / "more" / ".hidden"
    nested.mkdir(parents=True)
    (nested / "no.replay.gz").write_bytes(b"")
    (project.path / "more" / "bad.replay.gz").write_bytes((project.path / "two.replay.gz").read_bytes()[:-40])
    results = []
    for processes in ("1", "2"):
        assert main(["replay", str(project.path), "--processes", processes]) == 2
        results.append(capsys.readouterr())
    assert results[0] == results[1]
    names = [Path(line.partition(": ")[0]).name for line in results[0].out.splitlines()]
    assert names == sorted(THREE) and "bad.replay.gz: " in results[0].err
    assert main(["replay", str(project.path / "levels")]) == 2
    assert "there is no recording in this folder; their names end in .replay.jsonl" in capsys.readouterr().err


def test_a_test_in_python_that_fails_leaves_its_run_and_a_page_and_says_what_it_measured(project, pytester):
    pytester.makepyfile(
        """
        def test_slows_down(sandbox_session):
            run = sandbox_session("levels/rope.json")
            run.drag("rope.end", (3.0, 3.0), seconds=0.2)
            run.run_until(lambda run: run.speed("rope.end") < 0.0 and run.strain("rope") < 1, within=0.1)

        def test_names(sandbox_session):
            sandbox_session("levels/rope.json").cut("rope:999")

        def test_passes(sandbox_session):
            sandbox_session("levels/rope.json").run(0.1)
        """
    )
    result = project("-k", "slows or names or passes")
    result.assert_outcomes(passed=1, failed=2, deselected=5)
    told = result.stdout.str()
    assert "it did not come to hold; measured last:\n" in told and "speed('rope.end') = " in told
    assert "def run_until" not in told and "def cut" not in told and 'there is no spring "rope:999"' in told
    assert told.count("Spring Sandbox") == 2
    kept = sorted(path.name for path in (project.path / "out").iterdir())
    assert [name.rpartition("-")[2] for name in kept] == [
        "test_names.html", "test_names.recording.gz", "test_slows_down.html", "test_slows_down.recording.gz",
    ]  # fmt: skip
    replay = read_replay(project.path / "out" / kept[3])
    assert verify(replay) is None and replay.ticks == round(0.3 * rope_level().settings.tick_rate)
    assert "did not come to hold" in (project.path / "out" / kept[2]).read_text()
    # What was kept is no test of the next run.
    project("-k", "out").assert_outcomes(deselected=8)


def test_the_tests_in_python_that_the_documents_show_pass(project, pytester):
    text = (Path(__file__).resolve().parents[2] / "docs" / "testing.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n([^`]*?def test_.*?)```", text, re.DOTALL)
    for number, block in enumerate(blocks):
        (project.path / f"test_block_{number}.py").write_text(block)
    project("-k", "block").assert_outcomes(passed=len(blocks), deselected=5)
    assert len(blocks) >= 2
