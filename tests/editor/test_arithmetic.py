"""Sums in number fields."""

import pytest

from sandbox.editor.document import EditError
from sandbox.editor.panel.typed import read_integer, read_number


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1+0.5", 1.5),
        ("1,5 + 0,5", 2.0),
        ("2*3", 6.0),
        ("1/4", 0.25),
        ("0.1+0.2", 0.3),
        ("2 - 3 - 4", -5.0),
        ("8/2/2", 2.0),
        ("1+2*3", 7.0),
        ("(1+2)*3", 9.0),
        ("-(2)", -2.0),
        ("--2", 2.0),
        ("1e-3*2", 0.002),
        (".5*4", 2.0),
        ("3", 3.0),
    ],
)
def test_a_sum_is_a_number(text, value):
    assert read_number("Mass", text) == value


@pytest.mark.parametrize(
    "text",
    ["1+", "*2", "1/0", "(1", "1)", "1 2", "2**3", "abs(1)", "__import__", "1e308*10", "(" * 5000, "", "2x", "()"],
)
def test_what_is_no_sum_is_refused_in_one_line(text):
    with pytest.raises(EditError) as error:
        read_number("Mass", text)
    assert str(error.value).startswith("Mass: ") and "\n" not in str(error.value)


def test_whole_numbers_are_sums_as_well():
    assert read_integer("Cells", "2*4") == 8
    with pytest.raises(EditError, match="whole"):
        read_integer("Cells", "1/2")
