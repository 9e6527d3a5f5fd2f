"""Pages that play runs: what they hold, and in a real browser that keys play, step and seek them."""

import base64
import json
import os
import re
import shutil
import signal
import subprocess
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from queue import Queue
from threading import Thread
from urllib.parse import unquote, urlsplit

import numpy as np
import pytest

from sandbox.session.commands import AddParticle, CutSprings
from sandbox.session.player.page import PlayerPage
from sandbox.session.player.reel import NOWHERE, STEPS, Reel, gathered, shown_box, steps_between, told_states
from sandbox.session.session import Session
from tests.support.rope_level import rope_level

BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "chrome")
TICKS = 30


def rope_page(title: str = "Rope", lines=("first difference at tick 12",)) -> PlayerPage:
    """A page of a rope beside one of which a spring is cut at tick 12."""
    level = rope_level()
    runs = [Session(level), Session(level)]
    box = shown_box(level, runs[0].world)
    for _ in range(12):
        runs[1].advance()
    runs[1].submit(CutSprings((4,)))
    reels = [gathered(Reel(name, level, box), told_states(run, 0, TICKS), 3, 13)
             for name, run in zip(("expected", "actual"), runs, strict=True)]  # fmt: skip
    return PlayerPage(title, box, 60, reels, marks=[(12, "cut_springs")], difference=(13, 5), lines=lines)


def data_of(page: PlayerPage) -> dict:
    (data,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page.text(), re.DOTALL)
    return json.loads(data)


def test_a_page_holds_every_picture_of_both_runs_where_they_are():
    data = data_of(rope_page())
    assert data["ticks"] == [*range(0, 13, 3), 13, *range(15, TICKS + 1, 3)]
    expected, actual = data["sides"]
    assert [len(form["lines"]) for form in expected["forms"]] == [15]
    assert [(form["from"], len(form["lines"])) for form in actual["forms"]] == [(0, 15), (5, 14)]
    run = Session(rope_level())
    left, bottom, right, top = data["box"]
    span = max(right - left, top - bottom)
    places = np.frombuffer(base64.b64decode(expected["frames"]), dtype="<u2").reshape(len(data["ticks"]), -1, 2)
    for place, tick in enumerate(data["ticks"]):
        while run.tick < tick:
            run.advance()
        at = places[place] * (span / STEPS) + (left - span, bottom - span)
        shown = slice(0, run.world.grab_particle)
        assert np.abs(at[shown] - run.world.position[shown]).max() <= 0.51 * span / STEPS


def test_what_is_far_away_or_no_number_is_nowhere_and_what_joins_is_there():
    level = rope_level()
    run = Session(level)
    reel = Reel("run", level, shown_box(level, run.world))
    reel.add(run.world)
    run.submit(AddParticle((1.0, 1.0)))
    run.advance()
    run.world.position[3] = np.nan
    run.world.position[4] = 1e9
    reel.add(run.world)
    places = np.frombuffer(base64.b64decode(reel.data()["frames"]), dtype="<u2").reshape(-1, 2)
    second = places[reel.data()["sizes"][0] :]
    assert (second[3:5] == NOWHERE).all() and (second[5] != NOWHERE).all()
    assert [disc[4] for disc in reel.data()["forms"][1]["discs"]].count(1) == 1


def test_a_page_of_a_long_run_has_fewer_pictures():
    assert steps_between(600, 100, 2) == 1
    assert steps_between(36_000, 1_000, 2) * 6_000_000 >= 36_000 * 1_000 * 8


def test_no_name_of_a_level_can_become_part_of_the_page():
    text = rope_page("</title><script>alert(1)</script>@DATA@", ["</script><script>alert(2)</script>"]).text()
    assert "<script>alert" not in text and text.count("@DATA@") == 2
    assert not re.search(r"https?://|<link|<img|\bsrc=", text)


PROBE = """
<script>
const seen = [], state = () => [+document.documentElement.dataset.tick, document.documentElement.dataset.playing];
const press = (key, more) => document.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true, ...more}));
const note = what => seen.push([what, ...state()]);
note("begin");
const keys = ["Home", "ArrowRight", "ArrowRight", "ArrowLeft", "End", "ArrowRight", "d", "Home"];
for (const key of keys) press(key), note(key);
press("ArrowRight", {shiftKey: true}); note("ten");
document.getElementById("scrub").value = 2;
document.getElementById("scrub").dispatchEvent(new Event("input")); note("scrub");
press("o"); note(document.getElementById("over").getAttribute("aria-pressed"));
const pixels = [...document.querySelectorAll("canvas")].map(
  c => c.getContext("2d").getImageData(0, 0, c.width, c.height).data.some(each => each > 0));
press("Home"); press(" "); note("plays");
const waiting = setInterval(() => {
  if (state()[0] === 0) return;
  clearInterval(waiting);
  note("later"); press(" "); note("pauses");
  const apart = document.getElementById("now").textContent;
  location.href = "told?" + encodeURIComponent(JSON.stringify({seen, pixels, apart}));
}, 50);
</script>
</body>
"""
LONGEST = 120


class Probed(BaseHTTPRequestHandler):
    """Gives a page to a browser, and keeps what the page tells back by where it goes: its policy lets it do no more."""

    def do_GET(self):
        address = urlsplit(self.path)
        if address.path == "/told":
            self.server.told.put(json.loads(unquote(address.query)))
        self.send_response(200)
        self.end_headers()
        self.wfile.write(self.server.page if address.path == "/" else b"")

    def log_message(self, *_):
        pass


@contextmanager
def opened_in(browser, page: str, folder):
    """A queue of what a page tells that a real browser shows, in its own time, until the block is left."""
    with ThreadingHTTPServer(("127.0.0.1", 0), Probed) as server:
        server.page, server.told = page.encode(), Queue()
        Thread(target=server.serve_forever, daemon=True).start()
        quiet = ("--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync")
        options = ("--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", *quiet)
        address = f"http://127.0.0.1:{server.server_port}/"
        shown = subprocess.Popen(
            [browser, *options, f"--user-data-dir={folder}", address],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)  # fmt: skip
        try:
            yield server.told
        finally:
            os.killpg(shown.pid, signal.SIGTERM)
            shown.wait()
            server.shutdown()


def test_in_a_browser_keys_play_step_and_seek(tmp_path):
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        pytest.skip(f"no browser is installed: none of {', '.join(BROWSERS)}")
    with opened_in(browser, rope_page().text().replace("</body>", PROBE), tmp_path) as told:
        found = told.get(timeout=LONGEST)
    seen = {what: tick for what, tick, _ in found["seen"]}
    assert found["seen"][0][1] == 13
    ticks = [tick for _, tick, _ in found["seen"][1:9]]
    assert ticks == [0, 3, 6, 3, 30, 30, 13, 0]
    assert (seen["ten"], seen["scrub"], seen["true"]) == (27, 6, 6)
    assert found["pixels"] == [True, True]
    states = {what: playing for what, _, playing in found["seen"]}
    assert (states["plays"], states["pauses"]) == ("true", "false")
    assert 0 < seen["later"] <= 30 and found["apart"].endswith("m apart")
