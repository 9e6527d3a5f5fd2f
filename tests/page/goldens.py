"""Goldens through pages in a browser: a page plays what was recorded and compares each tick with the desktop's.

Run by hand: python -m tests.page.goldens [--whole] [GOLDEN ...]    (default: the beginning of every golden)
"""

import sys
import tempfile
from pathlib import Path

from sandbox.app.share.playing import page_of
from sandbox.replay import read_replay
from tests.determinism.golden import golden_names, golden_path
from tests.page.browser import Browser, browser_path
from tests.page.opened import VERDICT, opened

# Ticks of a golden that is not played whole: by then everything was done once.
SOME = 1200


def played(browser: Browser, folder: Path, name: str | Path, most: int | None = SOME) -> str:
    """What a page says of a golden, or of a recording's file, of so many ticks of it at most (None: all)."""
    replay = read_replay(name if isinstance(name, Path) else golden_path(name))
    end = min(replay.ticks, most or replay.ticks)
    tab = opened(browser, folder, page_of(replay.level, replay.script, end))
    tab.evaluate("page.toy.pause()")
    said: str = tab.evaluate(VERDICT)
    # What a page is told leaves out what was undone; in the end both are the same.
    is_same = replay.hashes[end].whole.startswith(tab.evaluate("page.toy.level.recording.hashes.at(-1)"))
    return (said if is_same else f"The page was told other hashes than those of the golden at tick {end}.") + "".join(
        f" {fault}" for fault in tab.faults
    )


def main() -> int:
    """Go through goldens; a line for each."""
    path = browser_path()
    if path is None:
        print("left out: no Chromium is installed")
        return 0
    browser, differing = Browser(path), 0
    with tempfile.TemporaryDirectory() as folder:
        most = None if "--whole" in sys.argv else SOME
        for name in [each for each in sys.argv[1:] if each != "--whole"] or golden_names():
            said = played(browser, Path(folder), name, most)
            differing += not said.startswith("Verified")
            print(f"page, {name}: {said}", flush=True)
    browser.close()
    return int(differing > 0)


if __name__ == "__main__":
    sys.exit(main())
