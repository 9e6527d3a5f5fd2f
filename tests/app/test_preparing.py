"""From interpreted kernels to compiled ones while the app runs."""

import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from sandbox.app.kernels import preparing
from sandbox.app.kernels.preparing import Preparation
from tests.app.conftest import small_level

ROOT = Path(__file__).resolve().parents[2]


class FakeCrew:
    """Children that have compiled what a test says."""

    def __init__(self):
        self.there, self.has_failed, self.progress = set(), False, (3, 7)

    def has(self, groups):
        return self.there >= set(groups)


class FakePace:
    """A level that holds the pace, once its trial is over."""

    def __init__(self, level):
        self.level, self.holds, self.is_over = level, False, False

    @property
    def is_known(self):
        return self.is_over

    def end(self):
        return self.is_over


@pytest.fixture
def start(monkeypatch):
    """A preparation that begins with interpreted kernels and an empty cache, and what happens to it."""
    seen = SimpleNamespace(crew=FakeCrew(), loaded=[], switched=0, noted=0, paces=[])

    def switch():
        seen.jit.COMPILED = seen.can_compile
        return seen.can_compile

    def pace(level):
        seen.paces.append(FakePace(level))
        return seen.paces[-1]

    def switched():
        seen.switched += 1

    def note():
        seen.noted += 1

    seen.can_compile = True
    seen.jit = SimpleNamespace(COMPILED=False, switch_to_compiled=switch)
    for name, value in {
        "jit": seen.jit,
        "Pace": pace,
        "Crew": lambda count: seen.crew,
        "is_prepared": lambda: False,
        "note_prepared": note,
        "_load_basics": lambda: seen.loaded.append("basics"),
        "_load_contacts": lambda: seen.loaded.append("contacts"),
    }.items():
        monkeypatch.setattr(preparing, name, value)
    seen.preparation = Preparation(switched)
    return seen


def steps(seen, level=None, contacts=False):
    """As many frames as everything takes that needs no more than time."""
    for _ in range(30):
        seen.preparation.update(level, contacts)
        if seen.preparation._thread is not None:
            seen.preparation._thread.join()


def test_a_level_that_holds_the_pace_is_played_at_once_and_goes_on_compiled(start):
    level = small_level()
    steps(start, level)
    assert not start.preparation.may_play(False)
    start.paces[0].holds = start.paces[0].is_over = True
    assert start.preparation.may_play(False) and not start.preparation.is_ready(False)
    start.crew.there.add("basics")
    steps(start, level)
    assert start.switched == 1 and start.loaded == ["basics"]
    assert start.preparation.is_ready(False)


def test_the_switch_waits_for_a_trial_that_is_in_the_midst_of_a_tick(start):
    start.crew.there.update(("basics", "contacts"))
    steps(start, small_level())
    assert start.switched == 0
    start.paces[0].is_over = True
    steps(start, start.paces[0].level)
    assert start.switched == 1


def test_a_run_in_which_things_touch_goes_on_interpreted_until_its_contacts_are_compiled(start):
    level = small_level(contacts={})
    start.crew.there.add("basics")
    steps(start, level, contacts=True)
    start.paces[0].holds = start.paces[0].is_over = True
    steps(start, level, contacts=True)
    assert start.switched == 0 and start.preparation.may_play(True)
    start.crew.there.add("contacts")
    steps(start, level, contacts=True)
    assert start.switched == 1 and start.loaded == ["basics", "contacts"]


def test_what_was_switched_before_its_contacts_were_compiled_waits_for_them(start):
    start.crew.there.add("basics")
    steps(start)
    assert start.switched == 1
    steps(start, small_level(contacts={}), contacts=True)
    assert not start.preparation.may_play(True)
    assert start.preparation.progress == (3, 7)
    start.crew.there.add("contacts")
    steps(start, small_level(contacts={}), contacts=True)
    assert start.preparation.may_play(True)


def test_where_children_fail_this_process_compiles_and_nothing_is_noted(start):
    start.crew.has_failed = True
    start.crew.there.update(("basics", "contacts"))
    steps(start, contacts=True)
    assert start.loaded == ["basics", "contacts"] and start.noted == 0


def test_no_trial_with_contacts_holds_up_kernels_that_are_only_to_be_loaded(start, monkeypatch):
    monkeypatch.setattr(preparing, "is_prepared", lambda: True)
    steps(start, small_level(contacts={}), contacts=True)
    assert start.paces == [] and start.loaded == ["basics", "contacts"]


def test_a_trial_without_contacts_is_over_before_numba_takes_its_time(start, monkeypatch):
    monkeypatch.setattr(preparing, "is_prepared", lambda: True)
    monkeypatch.setattr(preparing, "_import_numba", lambda: start.loaded.append("numba"))
    level = small_level()
    steps(start, level)
    assert start.loaded == []
    start.paces[0].is_over = True
    steps(start, level)
    assert start.loaded == ["numba", "basics"]


def test_when_all_is_compiled_it_is_noted_for_the_next_start(start):
    start.crew.there.update(("basics", "contacts"))
    steps(start, contacts=True)
    assert start.noted == 1


def test_without_numba_every_level_is_played_as_it_is(start):
    start.can_compile = False
    level = small_level(contacts={})
    steps(start, level, contacts=True)
    start.crew.there.update(("basics", "contacts"))
    steps(start, level, contacts=True)
    assert not start.preparation.may_play(True)
    start.paces[0].is_over = True
    steps(start, start.paces[0].level, contacts=True)
    assert start.preparation.may_play(True) and start.switched == 0 and start.loaded == []


def test_kernels_that_cannot_be_compiled_end_the_program_with_the_reason(start, monkeypatch):
    def fail():
        raise RuntimeError("this processor is not known")

    monkeypatch.setattr(preparing, "_load_basics", fail)
    start.crew.there.add("basics")
    with pytest.raises(RuntimeError, match="not known"):
        steps(start)


PROGRAM = """
import json, sys
import pygame
from sandbox.physics import jit
jit.start_interpreted()
import sandbox.app.kernels.preparing as preparing
from sandbox.app.window.app import App
from sandbox.app.base.display import Display
from sandbox.app.base.start_request import StartRequest

from sandbox.level.reading.files import load_level
from sandbox.session.replay.reader import read_replay
from sandbox.session.replay.verify import verify
from pathlib import Path

preparing.is_prepared = lambda: True
ticks = []
app = App(Display(1.0))
app.open(StartRequest(load_level("rope")))
switched = app._switched
app.preparation._switched = lambda: (ticks.append(app._tick), switched())
app.play.playback.session.record_to(Path(sys.argv[1]))
steps, app.preparation._steps = app.preparation._steps, iter(())
# As the app's own loop does: one that never waits takes the interpreter from the thread that tries the level out.
clock = pygame.time.Clock()
while app._tick < 4:
    app.frame(clock.tick(60) / 1000)
    pace = app.preparation._pace
    assert pace is None or pace._trial.is_alive() or pace.holds, "the rope is not played while it is interpreted"
assert "numba" not in sys.modules
app.preparation._steps = steps
while app._tick < ticks[0] + 30 if ticks else True:
    app.frame(clock.tick(60) / 1000)
app.close()
replay = read_replay(sys.argv[1])
print(json.dumps([ticks, jit.COMPILED, str(verify(replay)), replay.ticks]))
"""


@pytest.mark.slow
@pytest.mark.skipif(not preparing.jit.COMPILED, reason="nothing is compiled here")
def test_a_run_in_the_window_is_switched_between_two_ticks_and_its_recording_verifies(tmp_path):
    environment = {
        **os.environ,
        "SDL_VIDEODRIVER": "dummy",
        "XDG_CACHE_HOME": str(tmp_path),
        "HOME": str(tmp_path),
    }
    command = [sys.executable, "-c", PROGRAM, str(tmp_path / "run.replay.jsonl")]
    ended = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    (tick,), compiled, difference, ticks = json.loads(ended.stdout.splitlines()[-1])
    assert compiled and difference == "None"
    assert 4 <= tick < ticks
