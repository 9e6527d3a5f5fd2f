"""The language of kernels: what is translated to C++ and how, and what is refused, with its line and the reason."""

import importlib
import re
import sys
import textwrap
from pathlib import Path

import pytest

from sandbox.physics.jit.translate.cpp_types import Untranslatable
from sandbox.physics.jit.translate.program import Translation

HEAD = """
import math
from typing import NamedTuple
from sandbox.physics.arrays import Flags, FloatRows, Floats, Int32s, SlotRows, Slots
from sandbox.physics.jit import Bundle, unpack, inner_kernel, kernel, parallel, set_field

LIMIT = 3
SHARE = 0.1

class Pair(NamedTuple):
    values: Floats
    rows: FloatRows

"""


@pytest.fixture
def translated(tmp_path, monkeypatch):
    """A function that translates kernels, of which the last is an entry, and gives the C++ of that one, or another."""
    monkeypatch.syspath_prepend(str(tmp_path))
    count = 0

    def translate(text, name_of_kernel=""):
        nonlocal count
        count += 1
        name = f"kernels_of_{tmp_path.name}_{count}".replace("-", "_")
        (tmp_path / f"{name}.py").write_text(HEAD + textwrap.dedent(text))
        module = importlib.import_module(name)
        *_, last = [value for value in vars(module).values() if getattr(value, "_kernel", None) is not None]
        whole = Translation([last._kernel]).text()
        wanted = name_of_kernel or last._kernel.function.__name__
        return re.search(rf"static [^\n]* {wanted}\(.*?\n}}", whole, re.S)[0]

    yield translate
    for name in [name for name in sys.modules if name.startswith("kernels_of_")]:
        del sys.modules[name]


def test_a_kernel_is_written_with_its_names_and_comments(translated):
    text = translated(
        """
        @kernel
        def add(values: Floats, active: Flags, by: float) -> int:
            # Active ones alone.
            count = 0
            for k in range(values.shape[0]):
                if active[k] and count < LIMIT:
                    values[k] += by * SHARE
                    count += 1
            return count
        """
    )
    assert text.splitlines()[1:] == [
        "    // Active ones alone.",
        "    int64_t count = 0;",
        "    for (int64_t k = 0; k < values.shape[0]; k++) {",
        "        if (active(k) && count < LIMIT) {",
        "            values(k) += by * SHARE;",
        "            count += 1;",
        "        }",
        "    }",
        "    return count;",
        "}",
    ]


@pytest.mark.parametrize(
    ("said", "written"),
    [
        ("a // b", "py::floordiv(a, b)"),
        ("a % b", "py::mod(a, b)"),
        ("a / b", "double(a) / b"),
        ("math.floor(x)", "py::floor(x)"),
        ("min(x, y)", "py::min(x, y)"),
        ("max(x, 0)", "py::max<double>(x, 0)"),
        ("x - (y - x)", "x - (y - x)"),
        ("(a & b) << 2", "int64_t(a & b) << 2"),
        ("x if a < b < 3 else y", "a < b && b < 3 ? x : y"),
        ("-x * y", "-x * y"),
        ("int(x)", "int64_t(x)"),
    ],
)
def test_an_expression_means_what_it_means_in_python(said, written, translated):
    given = "int" if written.startswith(("py::floor", "py::mod", "int64_t")) else "float"
    text = translated(f"@kernel\ndef gives(a: int, b: int, x: float, y: float) -> {given}:\n    return {said}\n")
    assert f"return {written};" in text


def test_values_that_change_places_are_all_read_before_one_is_set(translated):
    text = translated(
        "@kernel\ndef turn(x: float, y: float) -> float:\n    for k in range(2):\n        x, y = y, -x\n    return x\n"
    )
    assert re.search(r"const double (\w+) = y;\s+const double (\w+) = -x;\s+x = \1;\s+y = \2;", text)


def test_what_a_bundle_holds_is_not_copied(translated):
    text = translated(
        """
        @kernel
        def fill(pointer: Bundle[Pair], other: Floats) -> None:
            pair = unpack(pointer)
            set_field(pair, "values", other)
            pair.rows[0, 1] = other[0]
        """
    )
    assert "const Pair &pair = unpack(pointer);" in text and "set_field(pair.values, other);" in text


LAID_OUT = """
from typing import Annotated
from sandbox.physics.arena import Arena, new_tuple

class Marks(NamedTuple):
    mark: Annotated[Flags, "nodes"]

class Graph(NamedTuple):
    start: Annotated[Slots, "nodes + 1"]
    rows: Annotated[FloatRows, f"{LIMIT} * links, 2"]
    marks: Marks
    weight: Floats

@inner_kernel
def graph_of(weight: Floats, arena: Arena) -> Graph:
    return new_tuple(Graph, arena, GIVEN)

@kernel
def gives(weight: Floats, arena: Arena) -> float:
    return graph_of(weight, arena).weight[0]
"""


def test_arrays_of_a_named_tuple_have_the_lengths_that_stand_beside_them(translated):
    right = "weight=weight, nodes=weight.shape[0], links=2 * LIMIT"
    text = translated(LAID_OUT.replace("GIVEN", right), "graph_of")
    assert text.splitlines()[1] == (
        "    return Graph{arena::new_slots(arena, weight.shape[0] + 1), "
        "arena::new_float_rows(arena, 3 * (2 * LIMIT), 2), Marks{arena::new_flags(arena, weight.shape[0])}, "
        "weight};"
    )
    for wrong, why in (
        ("weight=weight, nodes=weight.shape[0]", "the length links is not given"),
        ("nodes=1, links=1", "Graph.weight is not given, and has no lengths"),
        ("weight=1, nodes=1, links=1", "Graph.weight is Array<double, 1>, given int64_t"),
        ("weight=weight, nodes=1.0, links=1", "new_tuple: rows is int64_t, given double"),
    ):
        with pytest.raises(Untranslatable, match=re.escape(why)):
            translated(LAID_OUT.replace("GIVEN", wrong))


def test_a_parallel_loop_hands_its_items_to_one_call(translated):
    text = translated("""
        @inner_kernel
        def one(k: int, values: Floats) -> None:
            values[k] = 1.0

        @kernel
        def all_of(values: Floats) -> None:
            for k in parallel(values.shape[0], 8 * values.shape[0]):
                one(k, values)
        """)
    assert "parallel(values.shape[0], 8 * values.shape[0], [&](const int64_t k) {" in text
    assert "one(k, values);" in text


PAGE = (Path(__file__).resolve().parents[2] / "docs" / "kernels.md").read_text(encoding="utf-8")
REFUSED = re.findall(r"^\| `(.*?)` \| (.*) \|$", PAGE.partition("is told")[2], re.M)
REFUSED += [("while x > 0.0: return x\n    else: return x", "a loop has no else")]


@pytest.mark.parametrize(
    ("line", "why"), [*REFUSED, ("while x > 0.0: return x\n    else: return x", "a loop has no else")]
)
def test_what_the_page_says_is_refused_is_so_with_its_line_and_that_reason(line, why, translated):
    with pytest.raises(Untranslatable) as refused:
        translated(
            "@inner_kernel\ndef other(x: float, values: Floats) -> float:\n    return x + values[0]\n\n"
            f"@kernel\ndef gives(x: float, values: Floats) -> float:\n    {line}\n    return x\n"
        )
    place, _, reason = str(refused.value).partition(": ")
    assert reason == why and re.fullmatch(r"kernels_of_\w+\.py:20", place)


def test_the_kernel_of_the_page_is_translated(translated):
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    assert "most = py::max(most, _stretch(position, ends(s, 0), ends(s, 1)));" in translated(code)


def test_a_parameter_without_an_annotation_or_of_another_type_is_refused(translated):
    with pytest.raises(Untranslatable, match="gives: x has no annotation"):
        translated("@kernel\ndef gives(x) -> float:\n    return x\n")
    with pytest.raises(Untranslatable, match="gives: <class 'str'> is no type of kernels"):
        translated("@kernel\ndef gives(x: str) -> float:\n    return 1.0\n")


def test_a_kernel_that_calls_itself_is_refused(translated):
    with pytest.raises(Untranslatable, match="a kernel calls itself"):
        translated("@kernel\ndef gives(x: float) -> float:\n    return gives(x)\n")
