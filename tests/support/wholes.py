"""Sizes of tests: a part for every run of tests, and the whole for whole-world tests."""

from collections.abc import Container, Iterable
from typing import Any

import pytest


def part_and_whole(part: Any, whole: Any) -> list[Any]:
    """Values of a parameter: the part, and the whole that only whole-world tests take."""
    return [part, pytest.param(whole, marks=pytest.mark.whole_world)]


def some_and_whole(some: Container[Any], values: Iterable[Any]) -> list[Any]:
    """Values of a parameter: some for every run of tests, the others for whole-world tests; tuples are of several."""
    marks = {True: (), False: pytest.mark.whole_world}
    return [
        pytest.param(*(value if isinstance(value, tuple) else [value]), marks=marks[value in some]) for value in values
    ]
