"""The CSS of a feel in a browser: a box that it moves is where the measured curve is, at times of the animation."""

from pathlib import Path

import numpy as np
import pytest

from sandbox.export.curves import MEASURED, NEAREST, card_page
from sandbox.export.feel import Feel, feel_of
from sandbox.level.assembly.build_world import build_world
from sandbox.level.reading.files import load_level
from tests.page.browser import Browser

# How far the page moves its box [CSS pixels], and how near it is to be to the curve, as a share of that.
WAY, NEAR = 240.0, 0.01
# The box, let go by a click, whose transition stands still and is put to each of some times [ms].
PLACES = """(() => {
  const box = document.getElementById("box"), start = box.getBoundingClientRect().left;
  document.getElementById("again").click();
  const [moving] = box.getAnimations();
  moving.pause();
  return TIMES.map((time) => { moving.currentTime = time; return box.getBoundingClientRect().left - start; });
})()"""


@pytest.fixture(scope="module")
def feel() -> Feel:
    return feel_of(build_world(load_level("low_door")), "bridge", way="aside")


@pytest.mark.parametrize("form", [MEASURED, NEAREST])
def test_a_box_that_css_moves_follows_the_curve(browser: Browser, feel: Feel, form: str, tmp_path: Path) -> None:
    path = tmp_path / "feel.html"
    path.write_text(card_page(feel, form), encoding="utf-8")
    curve = feel.curve if form == MEASURED else feel.spring_curve
    seconds = feel.released.tick * np.arange(0, 24)
    times = [float(time) for time in 1000.0 * seconds]
    places = browser.tab().show(path.as_uri()).evaluate(PLACES.replace("TIMES", str(times)))
    assert max(places) > 1.2 * WAY and places[0] == 0.0
    # A point between two ticks is on the line between them, on the page as on the curve.
    assert np.max(np.abs(np.array(places)[1:] / WAY - curve[1 : len(places)])) <= NEAR
