"""The programs in docs/examples do what they say, with nothing but what is public."""

import ast
import re
import runpy
import sys
from pathlib import Path

import pytest

from sandbox.physics.jit import COMPILED

ROOT = Path(__file__).resolve().parents[1]
PROGRAMS = sorted((ROOT / "docs" / "examples").glob("*.py"))
PUBLIC = {"sandbox", "sandbox.commands", "sandbox.replay", "sandbox.bodies"}

needs_compiled = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")


def imports_of(source):
    """Dotted names of the modules that a program imports."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module


def said(program, capsys, *arguments):
    """The lines that a program prints, run as from a shell."""
    known, sys.argv = sys.argv, [program, *map(str, arguments)]
    try:
        runpy.run_path(str(ROOT / "docs" / "examples" / program), run_name="__main__")
    finally:
        sys.argv = known
    return capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.name)
def test_an_example_says_what_it_is_and_how_to_run_it_and_uses_what_is_public_alone(program):
    source = program.read_text(encoding="utf-8")
    assert f"\npython docs/examples/{program.name}" in ast.get_docstring(ast.parse(source))
    ours = {name for name in imports_of(source) if name.partition(".")[0] == "sandbox"}
    assert ours and ours <= PUBLIC
    assert {name for name in imports_of(source)} - ours <= sys.stdlib_module_names


def test_the_programs_in_the_documentation_use_what_is_public_alone():
    for page in ("headless", "how-to-test"):
        text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
        (program,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
        ours = {name for name in imports_of(program) if name.partition(".")[0] == "sandbox"}
        assert ours and ours <= PUBLIC


@needs_compiled
def test_a_bridge_holds_what_it_carries_and_breaks_under_little_more(capsys):
    *tests, result = said("bridge_breaks.py", capsys)
    carried, broke = (float(number) for number in re.findall(r"(\d+) kg", result))
    assert 0.0 < carried < broke <= 1.06 * carried
    held = {float(line.split(" kg")[0]): "holds" in line for line in tests}
    assert max(load for load, holds in held.items() if holds) == pytest.approx(carried, abs=0.5)
    assert min(load for load, holds in held.items() if not holds) == pytest.approx(broke, abs=0.5)


@needs_compiled
def test_a_walker_that_a_loop_tunes_walks_farther(capsys):
    *_, result = said("tune_walker.py", capsys, 2)
    born, walks = (float(number) for number in re.findall(r"(-?[\d.]+) m\b", result))
    assert walks > 1.1 * born


@needs_compiled
def test_a_level_made_in_python_can_be_read_and_played(capsys, tmp_path):
    (line,) = said("make_level.py", capsys, tmp_path / "gap.json")
    assert (tmp_path / "gap.json").is_file()
    assert "rests on the bridge" in line
