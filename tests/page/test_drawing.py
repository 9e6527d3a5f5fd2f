"""What a page draws is what the desktop draws."""

import base64
import io
from pathlib import Path

import numpy as np
import pygame
import pytest
from numpy.typing import NDArray

from sandbox import load_level
from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.picture import view_of
from sandbox.app.draw.renderer import Renderer
from sandbox.app.share.playing import page_of
from sandbox.level.reading.files import read_level
from sandbox.session.session import Session
from tests.page.browser import Browser, Tab
from tests.page.levels import level_page
from tests.page.opened import FRAMES, SETTLED, START_OVER, opened
from tests.page.pointing import click, drag
from tests.support.wholes import some_and_whole
from tests.support.worn import BLUE, GREEN, RED, YELLOW, level_file

TICKS, SIZE, BLOCK = 90, (1280, 720), 16
COOKBOOK = Path(__file__).parents[2] / "docs" / "cookbook"
BELTS, PICTURES = str(COOKBOOK / "belts.json"), str(COOKBOOK / "pictures.json")
# Blocks of pixels differ by so little on average, and no more than one in a hundred by so much, of 255 a channel.
USUAL, MOST = 2.5, 25.0
DRAW = """(() => {{
  const {{ toy }} = page, canvas = document.createElement('canvas');
  canvas.style.width = '{0}px';
  const camera = Object.assign(new toy.camera.constructor(), toy.camera,
    {{ width: {0}, height: {1}, x: {2}, y: {3}, zoom: {4} }});
  const picture = new toy.picture.constructor(canvas, toy.level.scene, toy.world);
  picture.draw(camera, toy.level.scene.themes['{5}'], toy.world.view('state.position').slice(), 1, {6});
  return canvas.toDataURL('image/png').slice(22);
}})()"""


def _ran(browser: Browser, folder: Path, name: str) -> Tab:
    tab = opened(browser, folder, level_page(name))
    tab.evaluate(f"page.toy.pause(); page.toy.seek(0); for (let k = 0; k < {TICKS}; k++) page.toy.tick()")
    return tab


def _blocks(picture: pygame.Surface) -> NDArray[np.float64]:
    pixels = pygame.surfarray.array3d(picture).astype(np.float64)
    wide, high = SIZE[0] // BLOCK, SIZE[1] // BLOCK
    return np.asarray(pixels.reshape(wide, BLOCK, high, BLOCK, 3).mean(axis=(1, 3)))


@pytest.mark.parametrize(
    "name",
    some_and_whole(
        ("jelly_wheel", "suspension_car", BELTS, PICTURES),
        ["jelly_wheel", "curtain", "walker", "pinball", "suspension_car", BELTS, PICTURES],
    ),
)
def test_a_page_looks_as_the_desktop_does(browser: Browser, tmp_path: Path, name: str) -> None:
    level = load_level(name)
    session = Session(level)
    for _ in range(TICKS):
        session.advance()
    snapshot, camera = session.snapshot(), Camera(viewport=(0, 0, *SIZE))
    camera.fit(view_of(level, snapshot))
    tab = _ran(browser, tmp_path, name)
    for theme in THEMES:
        surface, renderer = pygame.Surface(SIZE, 0, 32), Renderer(1.0, level)
        renderer.theme, renderer.has_effects = THEMES[theme], False
        renderer.draw(surface, camera, snapshot, snapshot, 1.0)
        seconds = (snapshot.tick + 1.0) / snapshot.settings.tick_rate
        x, y = camera.centre
        drawn = tab.evaluate(DRAW.format(*SIZE, x, y, camera.zoom, theme, seconds))
        page = pygame.image.load(io.BytesIO(base64.b64decode(drawn)), "page.png")
        apart = np.abs(_blocks(page) - _blocks(surface)).mean(axis=2)
        assert apart.mean() < USUAL, theme
        assert np.quantile(apart, 0.99) < MOST, theme
    assert tab.faults == []


def _bright(picture: pygame.Surface) -> NDArray[np.bool_]:
    red, green, blue = np.moveaxis(pygame.surfarray.array3d(picture).astype(int), -1, 0)
    return np.asarray((red > 200) & (green > 150) & (blue < red - 100))


def test_chevrons_of_belts_are_where_the_desktop_has_them(browser: Browser, tmp_path: Path) -> None:
    level, tab = load_level(BELTS), _ran(browser, tmp_path, BELTS)
    session = Session(level)
    for _ in range(TICKS):
        session.advance()
    snapshot, camera = session.snapshot(), Camera((0.0, 2.5), 80.0, (0, 0, *SIZE))
    surface, renderer = pygame.Surface(SIZE, 0, 32), Renderer(1.0, level)
    renderer.theme = THEMES["dark"]
    renderer.draw(surface, camera, snapshot, snapshot, 1.0)
    drawn = tab.evaluate(DRAW.format(*SIZE, 0.0, 2.5, 80.0, "dark", (TICKS + 1.0) / level.settings.tick_rate))
    page = _bright(pygame.image.load(io.BytesIO(base64.b64decode(drawn)), "page.png"))
    desktop, near = _bright(surface), np.zeros_like(page)
    for x in range(-2, 3):
        for y in range(-2, 3):
            near |= np.roll(page, (x, y), axis=(0, 1))
    assert desktop.sum() > 1000
    assert (desktop & near).sum() > 0.97 * desktop.sum()


def test_what_is_nowhere_is_not_drawn(browser: Browser, tmp_path: Path) -> None:
    tab = _ran(browser, tmp_path, "jelly_wheel")
    tab.evaluate("page.toy.world.view('state.position').fill(NaN)")
    tab.evaluate(DRAW.format(*SIZE, 0.0, 0.0, 50.0, "dark", 1.0))
    assert tab.faults == []


def test_drawn_wood_steel_and_rope_look_like_these_where_a_level_has_none_of_them(
    browser: Browser, tmp_path: Path
) -> None:
    tab = opened(browser, tmp_path, level_page("jelly_cube"), width=1280, height=720)
    tab.evaluate(START_OVER)
    click(tab, "#make")
    places, seen = {"wood": (200.0, 300.0), "steel": (900.0, 300.0), "rope": (900.0, 150.0)}, {}
    for stuff, (x, y) in places.items():
        click(tab, f"#{stuff}")
        tab.evaluate(SETTLED)
        ways = [(x + 100, y), (x + 100, y + 100), (x, y + 100), (x, y + 2)]
        drag(tab, (x, y), *(ways[:1] if stuff == "rope" else ways))
        tab.evaluate(FRAMES)
        picture = pygame.image.load(io.BytesIO(tab.picture()))
        box = pygame.Rect(x + 20, y - 2, 60, 4) if stuff == "rope" else pygame.Rect(x + 20, y + 20, 60, 60)
        seen[stuff] = pygame.surfarray.array3d(picture.subsurface(box)).astype(np.float64)
    red, _, blue = seen["wood"].mean(axis=(0, 1))
    assert red > 1.3 * blue
    red, _, blue = seen["steel"].mean(axis=(0, 1))
    assert blue > red
    # Planks have joints, and the strands of a rope are twisted: along the middle not all is of one tone.
    assert seen["wood"].std(axis=(0, 1)).max() > 2 * seen["steel"].std(axis=(0, 1)).max()
    assert seen["rope"].mean(axis=1).std(axis=0).max() > 8
    assert tab.evaluate("page.toy.run.commands.length") >= 3 and tab.faults == []


def test_a_page_draws_what_a_body_wears_where_it_is(browser: Browser, tmp_path: Path) -> None:
    tab = opened(browser, tmp_path, page_of(read_level(level_file(tmp_path))))
    tab.evaluate(FRAMES)
    # Turned by 90 degrees, moved and stretched: colours of the four quarters, at their middles.
    found = tab.evaluate("""(() => {
      const { toy } = page, { world, canvas } = toy, at = world.view('state.position'), ratio = toy.picture.ratio;
      toy.pause();
      const moved = (x, y) => [0.5 - 1.5 * y, x];
      for (let k = 0; k < at.length; k += 2) [at[k], at[k + 1]] = moved(at[k], at[k + 1]);
      toy.picture.draw(toy.camera, toy.theme, at.slice(), 1, 0);
      return [[-1, 0.5], [1, 0.5], [-1, -0.5], [1, -0.5]].map((place) => {
        const [x, y] = toy.camera.toPixels(...moved(...place));
        return [...canvas.getContext('2d').getImageData(x * ratio, y * ratio, 1, 1).data].slice(0, 3);
      });
    })()""")
    assert np.abs(np.array(found) - np.array([RED, GREEN, BLUE, YELLOW])).max() <= 2
    assert tab.faults == []
