"""`sandbox take-home` and `sandbox export`, as from a shell."""

import json
import xml.etree.ElementTree as ElementTree

import pytest

from sandbox.cli import main
from sandbox.export.take_home import TARGETS, as_text, take_home
from sandbox.level.reading.files import load_level


def test_take_home_prints_every_number_of_the_first_body_and_how_to_have_the_programs(capsys):
    assert main(["take-home", "jelly_pile"]) == 0
    said = capsys.readouterr().out
    assert said == as_text(take_home(load_level("jelly_pile")))
    assert said.startswith('"cube 1" of "Jelly pile": ')
    for word in ("8 substeps", "Box2D 3", "Unity 2D", "Godot 4", "Rapier 2D", "pymunk 7", "Chipmunk 7", "--to csharp"):
        assert word in said


@pytest.mark.parametrize("to", TARGETS)
def test_take_home_prints_one_thing_where_it_is_asked_for_one(to, capsys):
    assert main(["take-home", "jelly_pile", "--body", "plank 7", "--to", to]) == 0
    said = capsys.readouterr().out
    assert said.startswith('"plank 7" of "Jelly pile": ')
    languages = [line for line in said.splitlines() if line.startswith("---- ")]
    wanted = {"article": 5, "csharp": 1, "gdscript": 1, "cpp": 1, "javascript": 1, "python": 1}
    assert len(languages) == wanted.get(to, 0)
    assert ("What it prints" in said) == (to in wanted)


@pytest.mark.parametrize(("arguments", "fault"), [
    (["jelly_pile", "--body", "plnk 7"], 'jelly_pile: there is no body with springs called "plnk 7"; did you mean'),
    (["jelly_pile", "--to", "rapir"], '--to rapir: there is nothing called "rapir"; did you mean "rapier"?'),
    (["jelly_pile", "--to", "zzz"], '--to zzz: there is nothing called "zzz"; there are all, article'),
    (["hourglass", "--body", "x"], "hourglass: no spring does anything here"),
])  # fmt: skip
def test_take_home_says_in_one_line_what_is_not_there(arguments, fault, capsys):
    assert main(["take-home", *arguments]) == 2
    said = capsys.readouterr()
    (line,) = said.err.splitlines()
    assert fault in line and said.out == ""


def test_export_prints_flat_data_or_writes_it_with_its_size(tmp_path, capsys):
    assert main(["export", "walker"]) == 0
    printed = capsys.readouterr().out
    assert json.loads(printed)["format"] == "spring-sandbox/flat"
    target = tmp_path / "walker.json"
    assert main(["export", "walker", "--to", "flat", "-o", str(target)]) == 0
    assert target.read_text(encoding="utf-8") == printed
    assert capsys.readouterr().out == f"{target}: {len(printed.encode()) / 1000:.1f} kB\n"


def test_export_writes_a_picture_a_program_and_the_schema(capsys):
    assert main(["export", "walker", "--to", "svg"]) == 0
    assert ElementTree.fromstring(capsys.readouterr().out).tag.endswith("svg")
    assert main(["export", "walker", "--to", "pymunk"]) == 0
    compile(capsys.readouterr().out, "walker.py", "exec")
    assert main(["export", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out)["title"] == "Spring Sandbox flat level"


@pytest.mark.parametrize(("arguments", "fault"), [
    ([], "name a level, or say --schema: one of the two"),
    (["walker", "--schema"], "name a level, or say --schema: one of the two"),
    (["walkr"], "walkr"),
    (["walker", "-o", "no/such/folder/x.json"], "no/such/folder"),
])  # fmt: skip
def test_export_says_in_one_line_what_cannot_be_done(arguments, fault, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["export", *arguments]) == 2
    said = capsys.readouterr()
    (line,) = said.err.splitlines()
    assert fault in line and said.out == ""
