"""What of a source machine code follows from: edits of that are noticed, and no others."""

import pytest

from sandbox.physics.jit.sources import edited, kernel_digest, sources_now

SOURCE = '''"""A file."""

from typing import NamedTuple

import numpy as np

from sandbox.physics.equation import capped
from sandbox.physics.jit import inner_kernel, kernel

LIMIT = 3.0
OTHER = 4.0
HALF = 0.5 * LIMIT


class Pair(NamedTuple):
    """Two."""

    first: float
    second: float


class World:
    """Not for kernels."""

    size = 1


@inner_kernel
def shrunk(pair: Pair, share: float) -> float:
    """Some words."""
    return capped(pair.first * share) - HALF


@kernel
def run(values, pair):
    # A remark.
    for k in range(values.shape[0]):
        values[k] = shrunk(pair, 0.25)


def plain(world: World) -> float:
    return OTHER * world.size
'''
NAME = "physics/some.py"


def digest(*change, others=()):
    text = SOURCE
    if change:
        assert text.count(change[0]) == 1
        text = text.replace(*change)
    return kernel_digest(NAME, text.encode(), others)


@pytest.mark.parametrize(
    "change",
    [
        ("# A remark.", "# Another remark."),
        ('"""Some words."""', '"""Other words."""'),
        ("return OTHER * world.size", "return OTHER + world.size"),
        ("OTHER = 4.0", "OTHER = 5.0"),
        ("import numpy as np", "import numpy as np\nimport math"),
        ("    size = 1", "    size = 2"),
        ("capped(pair.first * share) - HALF", "(capped(pair.first*share)\n            - HALF)"),
    ],
)
def test_edits_that_no_machine_code_follows_from_are_none(change):
    assert digest(*change) == digest()


@pytest.mark.parametrize(
    "change",
    [
        ("0.25", "0.26"),
        ("pair.first * share", "pair.second * share"),
        ("LIMIT = 3.0", "LIMIT = 3"),
        ("HALF = 0.5 * LIMIT", "HALF = 0.25 * LIMIT"),
        ("    second: float\n", "    third: float\n"),
        ("@kernel\ndef run", "@inner_kernel\ndef run"),
        ("sandbox.physics.equation import capped", "sandbox.physics.terrain import capped"),
        ("def run(values, pair)", "def run(pair, values)"),
        ("share: float) -> float:", "share: int) -> int:"),
        ("first: float", "first: int"),
    ],
)
def test_edits_that_machine_code_follows_from_change_the_digest(change):
    assert digest(*change) != digest()


def test_a_constant_that_another_file_takes_is_among_it():
    assert digest("OTHER = 4.0", "OTHER = 5.0", others=["OTHER"]) != digest(others=["OTHER"])


def test_a_file_without_kernels_has_no_digest():
    assert kernel_digest(NAME, b"LIMIT = 1.0\n") == ""


@pytest.fixture(scope="module")
def now():
    return sources_now()


def test_the_constants_that_kernels_take_from_other_files_are_known(now):
    assert "HIGHEST_COEFFICIENT" in now["physics/equation.py"]["taken"]
    assert now["physics/step.py"]["taken"] == []


def test_only_files_whose_kernels_differ_are_edited(now):
    assert edited(now) == []
    with_kernels, without = "physics/integrate.py", "physics/step.py"
    stale = now | {name: now[name] | {"text": "other"} for name in (with_kernels, without)}
    assert edited(stale) == []
    assert edited(now | {with_kernels: {"text": "other", "kernels": "other", "taken": []}}) == [with_kernels]
    # One that the manifest does not know counts if there are kernels in it.
    assert edited({name: entry for name, entry in now.items() if name not in (with_kernels, without)}) == [with_kernels]
