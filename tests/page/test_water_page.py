"""A page of a level with water comes to the bits of the desktop, and shows the water."""

import json
from pathlib import Path

from sandbox import Session
from sandbox.app.share.playing import page_of
from sandbox.level.reading.parse import parse_level
from sandbox.physics.snapshot import state_hash
from tests.page.browser import Browser
from tests.page.opened import START_OVER, opened
from tests.support.pools import jelly, pool

TICKS = 150
PIXEL = """(() => { const canvas = document.querySelector('canvas'), { camera, picture } = page.toy;
  const [x, y] = camera.toPixels(%f, %f), data = canvas.getContext('2d').getImageData(
    Math.round(x * picture.ratio), Math.round(y * picture.ratio), 1, 1).data;
  return Array.from(data).slice(0, 3); })()"""


def test_a_page_floats_bodies_as_the_desktop_does_and_shows_the_water(browser: Browser, tmp_path: Path) -> None:
    ring = {"type": "ring", "id": "ring", "radius": 0.4, "segments": 12, "position": [2.0, 1.0], "particle_mass": 0.1}
    box = jelly((1.0, 0.5), 0.5, 1.0, 0.4, 0.6, angle=0.2)
    places = [-2.0, -1.6, -1.2, -0.8]
    balls = [{"id": f"b{k}", "position": [x, 2.0], "radius": 0.15, "mass": 0.2 * k + 0.2} for k, x in enumerate(places)]
    head = {"format": "spring-sandbox/level", "version": 3, "name": "water", "view": [-4, -3, 4, 3], "contacts": {}}
    zones = [pool((-3.5, -2.5, 3.5, 0.0), flow=[0.3, 0.0])]
    parts = box | {"bodies": [*box["bodies"], ring], "particles": balls, "zones": zones}
    level = parse_level(json.dumps(head | parts).encode(), "water")
    tab = opened(browser, tmp_path, page_of(level))
    tab.evaluate(START_OVER)
    found = tab.evaluate(f"for (let k = 0; k < {TICKS}; k++) page.toy.tick(); page.toy.world.hash().whole")
    session = Session(level)
    for _ in range(TICKS):
        session.advance()
    assert found == state_hash(session.world)
    air, water = (tab.evaluate(PIXEL % (-3.2, height)) for height in (1.0, -1.0))
    assert water[2] - water[0] > air[2] - air[0] + 25
    assert tab.faults == []
