"""What README and docs show works as they say."""

import json
import re
from pathlib import Path

import numpy as np

from sandbox.level.format.files import load_level, parse_level
from sandbox.session.checking import run_checks
from sandbox.session.records import COMMAND_TYPES
from sandbox.session.replay.reader import read_script
from sandbox.session.session import Session

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")


def test_the_level_in_the_readme_keeps_its_own_checks():
    section = README.split("## A level\n")[1]
    text = "\n".join(line for line in section.lstrip("\n").split("\n\n")[0].splitlines() if line.startswith("    "))
    results = run_checks(parse_level(text.encode(), "README.md"))
    assert results and all(result.passed for result in results), [result.text for result in results]


def test_the_program_in_the_readme_prints_that_every_tick_is_equal(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (program,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    exec(compile(program, "README.md", "exec"), {})
    assert capsys.readouterr().out == "None\n"


def test_the_commands_in_the_documentation_are_all_there_are_and_every_one_is_carried_out(tmp_path):
    lines, driving, pumping = re.findall(r"```jsonl\n(.*?)```", COMMANDS, re.DOTALL)
    shown = (lines + driving + pumping).splitlines()
    assert {json.loads(line)["command"]["type"] for line in shown} == set(COMMAND_TYPES)
    table = COMMANDS.split("|---|---|---|")[1]
    named = {
        name
        for row in table.splitlines()
        if row.startswith("|")
        for name in re.findall(r"`(\w+)`", row[: row.index("|", 1)])
    }
    assert named == set(COMMAND_TYPES)
    (tmp_path / "moves.jsonl").write_text(lines)
    session = Session(load_level("rope"), read_script(tmp_path / "moves.jsonl"))
    for _ in range(140):
        session.advance()
    assert not session.messages
    assert session.world.settings.solver == "iterative"
    assert "+.0" in session.world.particle_names
    (tmp_path / "fire.jsonl").write_text(driving)
    session = Session(load_level("catapult"), read_script(tmp_path / "fire.jsonl"))
    for _ in range(180):
        session.advance()
    assert len(session.messages) == 1 and session.messages[0].endswith(" broke")
    (tmp_path / "pump.jsonl").write_text(pumping)
    session = Session(load_level("balloons"), read_script(tmp_path / "pump.jsonl"))
    wanted = session.world.element_rest.copy()
    for _ in range(70):
        session.advance()
    assert not session.messages
    assert np.count_nonzero(session.world.element_rest > wanted) == 1
