"""The command that measures the tables of docs/benchmarks.md writes each below its heading, and nothing else."""

import pytest

from tests.bench.tables import PAGE, PROGRAMS, RUN, machine, table_of, with_table

NEW = "| a | b |\n|---|---|\n| 1 | 2 |"


@pytest.mark.parametrize("heading", PROGRAMS)
def test_a_table_takes_the_place_of_the_one_below_its_heading(heading):
    page = PAGE.read_text()
    changed = with_table(page, heading, NEW)
    before, after = (text.split(f"## {heading}\n")[1].split("\n## ")[0] for text in (page, changed))
    assert NEW in after
    assert changed.replace(after, before) == page
    assert [line for line in after.splitlines() if line[:1] != "|"] == [
        line for line in before.splitlines() if line[:1] != "|"
    ]


def test_a_heading_that_is_not_there_is_said():
    with pytest.raises(ValueError, match="no table below 'Nothing'"):
        with_table(PAGE.read_text(), "Nothing", NEW)


def test_a_program_that_prints_no_table_is_said():
    with pytest.raises(ValueError, match="no table: 'out of memory'"):
        table_of("out of memory\n")
    assert table_of(f"one\n{NEW}\ntwo\n") == NEW


def test_day_and_machine_take_the_place_of_those_of_the_run_before():
    changed = RUN.sub(machine(), PAGE.read_text(), count=1)
    assert changed.splitlines()[2] == machine()
    assert len(changed.splitlines()) == len(PAGE.read_text().splitlines())
