"""In other people's pipelines: the action's own steps, hooks of pre-commit, annotations, summary and JUnit file."""

import json
import os
import re
import shlex
import subprocess
import sys
import xml.etree.ElementTree
from pathlib import Path

import pytest
import yaml

from sandbox.cli import main
from sandbox.level.reading.files import level_data, write_level
from sandbox.session.level_edits import with_value
from tests.support.rope_level import rope_level

ROOT = Path(__file__).resolve().parents[2]
EDIT = "rope, 100%.json: settings.gravity: [0.0, -9.81] (default) -> [0.0, -14.0]"


@pytest.fixture
def repository(tmp_path):
    """A repository with a folder of tests, in which a level was edited on purpose after its recording."""
    folder = tmp_path / "game"
    (folder / "levels").mkdir(parents=True)
    level = folder / "levels" / "rope, 100%.json"
    write_level(rope_level(), level)
    assert main(["run", str(level), "--seconds", "0.5", "--record", str(folder / "run.replay.gz")]) == 0
    write_level(with_value(rope_level(), "settings.gravity.1", -14.0), level)
    return tmp_path


def step(name):
    """A step of the action."""
    action = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
    assert {each: True for each in action["inputs"]} == {
        each: True for each in re.findall(r"\{\{ inputs\.(\w+) \}\}", json.dumps(action["runs"]))
    }
    return next(each for each in action["runs"]["steps"] if each["name"] == name)


def test_the_steps_of_the_action_annotate_summarise_and_keep_a_report(repository):
    verify, kept = step("Verify"), step("Keep the report")
    results = repository / "temp" / "spring-sandbox"
    values = {"inputs.folder": "game", "inputs.arguments": "--replay-pictures=none", "runner.temp": str(results.parent)}

    def filled(text):
        return re.sub(r"\$\{\{ (.*?) \}\}", lambda found: values[found[1]], text)

    environment = {
        **os.environ,
        **{name: filled(text) for name, text in verify["env"].items()},
        "GITHUB_STEP_SUMMARY": str(repository / "summary.md"),
        "GITHUB_WORKSPACE": str(repository),
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
    }
    # As the runner does for `shell: bash`.
    command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", verify["run"]]
    run = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 1, run.stdout + run.stderr
    (annotation,) = [line for line in run.stdout.splitlines() if line.startswith("::")]
    title = EDIT.replace("%", "%25").replace(":", "%3A").replace(",", "%2C")
    assert annotation.startswith(f"::error file=game/run.replay.gz,title={title}::")
    assert annotation.endswith("%0Ato accept: pytest --replay-update run.replay.gz")
    summary = (repository / "summary.md").read_text(encoding="utf-8")
    assert "1 of 2 tests failed" in summary and f"    {EDIT}\n    at most " in summary
    assert Path(filled(kept["with"]["path"])) == results
    assert EDIT.replace(">", "&gt;") in (results / "report.html").read_text(encoding="utf-8")
    failures = [*xml.etree.ElementTree.parse(results / "junit.xml").iter("failure")]
    assert [each.get("message").splitlines()[0] for each in failures] == [EDIT]


def test_replay_tells_github_without_pytest(repository, monkeypatch, capsys):
    monkeypatch.chdir(repository)
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(repository / "summary.md"))
    monkeypatch.setenv("GITHUB_WORKSPACE", str(repository))
    capsys.readouterr()
    assert main(["replay", "game", "--against", "game/levels", "--github"]) == 1
    assert "::error file=game/run.replay.gz,title=rope%2C 100%25.json" in capsys.readouterr().out
    assert "1 of 1 tests failed" in (repository / "summary.md").read_text(encoding="utf-8")


def hook(name, *files):
    """The exit code of a hook on files, as pre-commit calls it."""
    hooks = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    (found,) = [each for each in hooks if each["id"] == name]
    chosen = [each for each in files if re.search(found["files"], each)]
    program, *arguments = shlex.split(found["entry"])
    assert program == "sandbox"
    return main([*arguments, *chosen]) if chosen else None


def test_the_hooks_of_pre_commit_write_and_check_levels(repository, monkeypatch, capsys):
    monkeypatch.chdir(repository)
    level = "game/levels/rope, 100%.json"
    assert hook("sandbox-format", "run.replay.gz", "package.json") is None
    Path(level).write_text(json.dumps(level_data(rope_level(settings={"gravity": [0.0, -14.0]}))), encoding="utf-8")
    other = "game/levels/damaged.json"
    Path(other).write_text("{", encoding="utf-8")
    assert hook("sandbox-format", other, level) == 2
    assert b"\n" in Path(level).read_bytes().rstrip() and Path(other).read_text(encoding="utf-8") == "{"
    assert "game/levels/damaged.json: " in capsys.readouterr().err
    assert hook("sandbox-check", level) == 0 and hook("sandbox-check", level, other) == 2


def test_a_recording_that_cannot_be_read_is_annotated_too(repository, monkeypatch, capsys):
    monkeypatch.chdir(repository)
    Path("bad.replay.gz").write_bytes(b"no recording")
    capsys.readouterr()
    assert main(["replay", "bad.replay.gz", "--github"]) == 2
    assert "::error file=bad.replay.gz,title=bad.replay.gz%3A damaged gzip data" in capsys.readouterr().out
