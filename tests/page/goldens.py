"""Goldens through pages in a browser: a page plays what was recorded and compares each tick with the desktop's.

Run by hand: python -m tests.page.goldens [GOLDEN ...]    (default: all)
"""

import sys
import tempfile
from pathlib import Path

from sandbox.app.share.playing import page_of
from sandbox.page.about import can_play
from sandbox.replay import read_replay
from tests.determinism.golden import golden_names, golden_path
from tests.page.browser import Browser, browser_path
from tests.page.opened import VERDICT, opened


def played(browser: Browser, folder: Path, name: str) -> str:
    """What a page says of a golden, until the tick in which something is added, for which it has no room."""
    replay = read_replay(golden_path(name))
    adding = (line.tick for line in replay.script if not can_play([line.record["type"]]))
    end = min(replay.ticks, next(adding, replay.ticks + 1) - 1)
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
        for name in sys.argv[1:] or golden_names():
            said = played(browser, Path(folder), name)
            differing += not said.startswith("Verified")
            print(f"page, {name}: {said}", flush=True)
    browser.close()
    return int(differing > 0)


if __name__ == "__main__":
    sys.exit(main())
