"""docs/python.md has every public name, and its programs run."""

import importlib
import re
from pathlib import Path

import pytest

from sandbox import Session, load_level

PAGE = (Path(__file__).resolve().parents[1] / "docs" / "python.md").read_text(encoding="utf-8")
MODULES = ["sandbox", "sandbox.commands", "sandbox.replay", "sandbox.testing", "sandbox.bodies"]
PROGRAMS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def tables(module):
    """The names in each table below the heading of a module."""
    (section,) = [each for each in PAGE.split("\n## ") if each.partition("\n")[0].endswith(f"`{module}`")]
    found = [re.findall(r"^\| `(\w+)` \| \S.*\|$", each, re.MULTILINE) for each in section.split("|---|---|")[1:]]
    assert all(found)
    return found


@pytest.mark.parametrize("module", MODULES)
def test_the_page_has_every_public_name(module):
    assert sorted(tables(module)[0]) == sorted(importlib.import_module(module).__all__)


def test_the_page_has_every_name_of_a_session():
    session = Session(load_level("rope"))
    _, of_programs, of_window = tables("sandbox")
    assert sorted([*of_programs, *of_window]) == sorted(name for name in dir(session) if not name.startswith("_"))


@pytest.mark.parametrize("program", PROGRAMS, ids=MODULES)
def test_a_program_of_the_page_runs_and_uses_what_is_public_alone(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert set(re.findall(r"^(?:from|import) (\S+)", program, re.MULTILINE)) <= set(MODULES)
    exec(compile(program, "python.md", "exec"), {})
