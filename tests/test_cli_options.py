"""Options of commands are typed objects: what no parser declares, nobody can read."""

import argparse
import ast
import subprocess
import sys
from dataclasses import dataclass, fields
from pathlib import Path
from typing import get_type_hints

import pytest

from sandbox.cli import COMMANDS, main, play
from sandbox.cli.base.command import Subcommand, argument, declare, flag, option, option_or, read
from sandbox.level.reading.files import load_level
from sandbox.session.scene import SceneTaker, scene_lines
from sandbox.session.session import Session
from sandbox.terminal import seconds

ROOT = Path(__file__).resolve().parents[1]
# Functions that make a parser and read what it gave, both in one place.
READERS = {"cli/base/command.py", "cli/__init__.py", "physics/jit/making/libraries.py"}
WRONG = """
from dataclasses import dataclass
from sandbox.cli.base.command import Subcommand, WindowOptions
from sandbox.cli.base.command import flag, option
from sandbox.cli.play import PlayOptions
from sandbox.terminal import seconds

@dataclass(frozen=True, kw_only=True)
class Wrong:
    length: str | None = option(seconds, help="a number that is called a text")

def misspelled(options: PlayOptions) -> bool:
    return options.state

def of_another(options: WindowOptions) -> int:
    return 0 if options.profile else 1

COMMAND = Subcommand("play", "take options that are not its own", PlayOptions, lambda options: options.nothing)
"""


@dataclass(frozen=True, kw_only=True)
class ShakeOptions:
    """One of each kind."""

    level: str = argument(str, "LEVEL")
    start: float | None = option(seconds, "-s", "--from")
    seconds: float | None = option(seconds, help="for how long")
    strength: int = option_or(3, int)
    is_quiet: bool = flag("print nothing")


def parsed(*words):
    """What a parser of ShakeOptions makes of these words."""
    parser = argparse.ArgumentParser()
    declare(parser, ShakeOptions)
    return read(parser.parse_args(words), ShakeOptions)


def test_a_field_is_read_by_its_own_function_and_has_its_default_where_it_is_left_out():
    assert parsed("rope") == ShakeOptions(level="rope", seconds=None, strength=3, start=None, is_quiet=False)
    assert parsed("rope", "--seconds", "2", "--strength", "5", "-s", "1", "--is-quiet") == ShakeOptions(
        level="rope", seconds=2.0, strength=5, start=1.0, is_quiet=True
    )
    assert parsed("rope", "--from", "4").start == 4.0


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_command_takes_the_options_that_its_parser_declares(command):
    (taken,) = (hint for name, hint in get_type_hints(command.action).items() if name != "return")
    assert taken is command.options
    assert all(each.metadata for each in fields(command.options))


def test_the_bare_program_is_play_without_a_level(monkeypatch):
    taken = []
    command = play.COMMAND
    noted = Subcommand(command.name, command.text, command.options, lambda options: taken.append(options) or 0)
    monkeypatch.setattr("sandbox.cli.COMMANDS", (noted,))
    monkeypatch.setattr(sys, "argv", ["sandbox"])
    assert main() == main([]) == main(["play"]) == 0
    assert taken[0] == taken[1] == taken[2] and taken[0].level is None


def test_no_function_but_the_reader_of_options_is_given_what_a_parser_gave():
    named = set()
    for path in (ROOT / "sandbox").rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        words = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        words |= {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        if words & {"Namespace", "parse_args", "parse_known_args"}:
            named.add(path.relative_to(ROOT / "sandbox").as_posix())
    assert named == READERS


@pytest.mark.slow
def test_the_type_checker_finds_an_option_that_is_not_declared_or_has_another_type(tmp_path):
    (tmp_path / "wrong.py").write_text(WRONG)
    command = [sys.executable, "-m", "mypy", "--follow-imports=silent", "--check-untyped-defs", "wrong.py"]
    command += ["--config-file=", f"--cache-dir={ROOT / '.mypy_cache'}"]
    run = subprocess.run(command, cwd=tmp_path, env={"MYPYPATH": str(ROOT), "PATH": ""}, capture_output=True, text=True)
    lines = [line.partition(": error: ")[::2] for line in run.stdout.splitlines() if "error" in line]
    found = {int(place.split(":")[1]): text for place, text in lines if place.startswith("wrong.py")}
    assert set(found) == {10, 13, 16, 18}, run.stdout + run.stderr
    assert '"PlayOptions" has no attribute "state"' in found[13]


def test_a_value_below_zero_is_no_option(tmp_path, capsys):
    assert main(["run", "rope_bridge_jelly", "--ticks", "20", "--record", str(tmp_path / "a.replay.gz")]) == 0
    capsys.readouterr()
    for said in (["--leaves", "-1e6,-1e6,1e6,1e6"], ["--leaves=-1e6,-1e6,1e6,1e6"]):
        assert main(["shrink", str(tmp_path / "a.replay.gz"), *said, "-o", str(tmp_path / "b.replay.gz")]) == 2
        assert "expected one argument" not in (told := capsys.readouterr().err) and "a.replay.gz" in told


def test_a_scene_is_told_from_a_level(tmp_path, capsys):
    path = tmp_path / "kept.scene.jsonl"
    path.write_bytes(b"".join(scene_lines(SceneTaker(Session(load_level("rope_bridge_jelly"))).take(), None)))
    for command in ("info", "check", "run"):
        assert main([command, str(path)]) == 2
        told = f"{path}: is a scene, a run as it stood, not a Spring Sandbox level; `sandbox play` opens it\n"
        assert capsys.readouterr().err == told
