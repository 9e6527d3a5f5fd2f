"""Random mouse, touch and keys at pages, in a browser; then what was done is verified here, bit for bit.

Run by hand: python -m tests.page.soak [--seconds 600] [--seed 1] [LEVEL ...]    (default: the levels of the tests)
"""

import argparse
import random
import sys
import tempfile
import time
from pathlib import Path

from sandbox import load_level
from sandbox.app.share.playing import page_of
from sandbox.replay import read_replay, verify
from tests.page.browser import Browser, Tab, browser_path
from tests.page.levels import LEVELS
from tests.page.opened import opened, saved

SIZES = ({"width": 1280, "height": 720}, {"width": 390, "height": 844, "is_phone": True})
BUTTONS = ("play", "step", "slow", "undo", *["drag"] * 6, "pin", "cut", "sound", "tune", "hint")
KEYS = (" ", ".", "s", "d", "p", "c", "n", "q", "Enter", "ArrowLeft", "ArrowUp", "Escape", "+", "-", "h", "a", "d", "w")
# Gestures from one return of the view to the next, so that something stays in sight.
RETURN = 15
FOLLOW = """(() => {
  const { camera, world } = page.toy, at = world.view('state.position'), k = Math.floor(SHARE * world.particles.length);
  page.toy.fit();
  [camera.x, camera.y] = [at[2 * k], at[2 * k + 1]];
})()"""
# Where a particle is that is in the picture [pixels].
PLACE = """(() => {
  const { at } = page.toy.picture, count = page.toy.world.particles.length, k = Math.floor(SHARE * count);
  return [at[2 * k], at[2 * k + 1]];
})()"""
FIGURES = "[page.toy.run.time, page.toy.run.next, page.toy.world.view('state.position').buffer.byteLength]"


def _drag(tab: Tab, dice: random.Random, size: dict[str, int]) -> None:
    """Press at particles or anywhere, move about and let go, with one pointer or two."""

    def somewhere() -> tuple[float, float]:
        return dice.uniform(0, size["width"]), dice.uniform(0, size["height"])

    is_touch, count = bool(size.get("is_phone")), dice.choice((1, 1, 2))
    places = [tab.evaluate(PLACE.replace("SHARE", str(dice.random()))) if dice.random() < 0.7 else None for _ in "12"]
    points = [tuple(place) if place and None not in place else somewhere() for place in places][:count]
    if is_touch:
        tab.touch("touchStart", *points)
    else:
        tab.mouse("mousePressed", *points[0])
    for _ in range(dice.randrange(1, 12)):
        points = [(x + dice.gauss(0, 60), y + dice.gauss(0, 60)) for x, y in points]
        if is_touch:
            tab.touch("touchMove", *points)
        else:
            tab.mouse("mouseMoved", *points[0])
    if is_touch:
        tab.touch("touchEnd")
    else:
        tab.mouse("mouseReleased", *points[0])


def _do(tab: Tab, dice: random.Random, size: dict[str, int]) -> None:
    chance = dice.random()
    if chance < 0.75:
        _drag(tab, dice, size)
    elif chance < 0.9:
        tab.evaluate(f"document.getElementById('{dice.choice(BUTTONS)}').click()")
    elif chance < 0.94:
        tab.key(dice.choice(KEYS))
    elif chance < 0.95:
        tab.evaluate(f"page.toy.seek(Math.floor({dice.random()} * page.toy.run.last))")
    else:
        values = f"stiffness: {dice.random()}, damping: {dice.random()}"
        tab.evaluate(f"page.toy.command({{ type: 'set_coefficients', {values} }})")


def _soak(browser: Browser, folder: Path, name: str, size: dict[str, int], seconds: float, seed: int) -> bool:
    """Play one page for so long; whether nothing was wrong."""
    dice, tab = random.Random(seed), opened(browser, folder, page_of(load_level(name)), **size)
    began, heaps, done = time.monotonic(), [], 0
    while time.monotonic() - began < seconds:
        _do(tab, dice, size)
        done += 1
        if done % 4 == 0:
            tab.evaluate("page.toy.play()")
        if done % RETURN == 0:
            tab.evaluate(FOLLOW.replace("SHARE", str(dice.random())))
        if done % 20 == 0:
            tab.send("HeapProfiler.collectGarbage")
            heaps.append(tab.send("Runtime.getHeapUsage")["usedSize"] / 1e6)
    tab.evaluate("page.toy.pause()")
    ticks, commands, memory = tab.evaluate(FIGURES)
    divergence = verify(read_replay(saved(tab, folder)))
    is_bad = bool(tab.faults) or divergence is not None
    print(
        f"{name}, {size['width']} wide: {done} gestures, {ticks} ticks, {commands} commands; heap "
        f"{min(heaps, default=0):.1f} to {max(heaps, default=0):.1f} MB, at the end {(heaps or [0])[-1]:.1f}; kernels' "
        f"memory {memory / 1e6:.1f} MB; {tab.faults[:1] or 'no fault'}; {divergence or 'verified'}",
        flush=True,
    )
    return not is_bad


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.page.soak", description=str(__doc__).partition("\n")[0])
    parser.add_argument("levels", nargs="*", default=LEVELS, metavar="LEVEL")
    parser.add_argument("--seconds", type=float, default=600.0, help="for all levels together")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    path = browser_path()
    if path is None:
        print("no Chromium is installed")
        return 2
    browser, good = Browser(path), True
    with tempfile.TemporaryDirectory() as folder:
        for k, name in enumerate(options.levels):
            each = options.seconds / len(options.levels)
            good &= _soak(browser, Path(folder), name, SIZES[k % 2], each, options.seed + k)  # type: ignore[arg-type]
    browser.close()
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
