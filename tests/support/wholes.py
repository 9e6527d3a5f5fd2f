"""Sizes of tests: a part for every run of tests, and the whole for whole-world tests."""

from typing import Any

import pytest


def part_and_whole(part: Any, whole: Any) -> list[Any]:
    """Values of a parameter: the part, and the whole that only whole-world tests take."""
    return [part, pytest.param(whole, marks=pytest.mark.whole_world)]
