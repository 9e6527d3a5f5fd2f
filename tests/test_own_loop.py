"""A level in a loop of one's own: the program of docs/how-to-loop.md runs, draws, listens, forks and records."""

import re
from collections import Counter
from pathlib import Path

import pygame
import pytest

import sandbox
from sandbox.replay import read_replay, verify

DOCUMENT = Path(__file__).resolve().parents[1] / "docs" / "how-to-loop.md"
FRAMES = 240


@pytest.fixture
def program(tmp_path, monkeypatch):
    """The program, in a folder of its own, on a clock that is never late."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        pygame.time, "Clock", lambda: type("Clock", (), {"tick": lambda self, rate: 1000 // rate + 1})()
    )
    (text,) = re.findall(r"```python\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)
    return compile(text, "loop.py", "exec")


def test_the_program_plays_a_drag_shows_the_future_and_leaves_a_recording_that_verifies(program, tmp_path, monkeypatch):
    frames, seen = Counter(), {}

    def flip():
        frames["drawn"] += 1
        number, surface = frames["drawn"], pygame.display.get_surface()
        events = {
            20: pygame.event.Event(pygame.MOUSEBUTTONDOWN, pos=(500, 300), button=1),
            30: pygame.event.Event(pygame.MOUSEMOTION, pos=(560, 120), rel=(0, 0), buttons=(1, 0, 0)),
            90: pygame.event.Event(pygame.MOUSEBUTTONUP, pos=(560, 120), button=1),
            100: pygame.event.Event(pygame.KEYDOWN, key=pygame.K_SPACE),
            FRAMES: pygame.event.Event(pygame.QUIT),
        }
        if number in events:
            pygame.event.post(events[number])
        seen[number] = pygame.image.tobytes(surface, "RGB")

    monkeypatch.setattr(pygame.display, "flip", flip)
    told = {}
    exec(program, told)
    assert frames["drawn"] == FRAMES + 1 and len(set(seen.values())) > FRAMES // 2
    assert told["ghosts"] and "cube 1 at" in pygame.display.get_caption()[0]
    replay = read_replay(tmp_path / "played.replay.gz")
    assert verify(replay) is None and replay.ticks == told["session"].tick >= FRAMES
    assert [line.record["type"] for line in replay.script] == ["grab", "move_grab", "release"]
    pygame.display.quit()


def test_the_program_flashes_those_that_begin_to_touch(program, monkeypatch):
    flashed = set()

    def flip():
        flashed.update(told["flash"])
        if told["session"].tick > 150:
            pygame.event.post(pygame.event.Event(pygame.QUIT))

    monkeypatch.setattr(pygame.display, "flip", flip)
    told = {}
    exec(program, told)
    assert "pit" in flashed and any(name.startswith("cube") for name in flashed)
    pygame.display.quit()


def test_the_page_names_what_there_is():
    text = DOCUMENT.read_text(encoding="utf-8")
    for name in re.findall(r"from sandbox import (.*)", text)[0].split(", "):
        assert name in sandbox.__all__
    assert (
        text.count("\n```python\n") == 1
        and len(re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0].splitlines()) < 90
    )
