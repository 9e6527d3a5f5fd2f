"""Goldens that pages play. All of them: make goldens-everywhere."""

from pathlib import Path

import pytest

from tests.page.browser import Browser
from tests.page.goldens import played

LONGER = ("catapult", "jelly_pile", "tumble_drum")


@pytest.mark.parametrize(
    "name", ["curtain", "wrecking_crane", *(pytest.param(name, marks=pytest.mark.whole_world) for name in LONGER)]
)
def test_a_page_plays_a_golden_bit_for_bit(browser: Browser, tmp_path: Path, name: str) -> None:
    assert played(browser, tmp_path, name).startswith("Verified")
