"""Cards of recordings: what each is of, how long it is, and a picture of where it ends."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pygame

from sandbox.app.draw.colours import shown_theme
from sandbox.app.draw.picture import crop_of, draw_picture
from sandbox.app.draw.picture_cache import LINE_SCALE, SIZE, find_picture, keep_for_later, kept_picture, picture_key
from sandbox.app.gallery.card import Card
from sandbox.level.plan.surfaces import terrain_of
from sandbox.session.replay.reader import read_in_slices
from sandbox.session.replay.recording import Replay, ReplayError


def fill_replay(card: Card, path: Path) -> Iterator[bool]:
    """Read a recording for its card and draw it, a slice at a time."""
    reading = read_in_slices(path, partial=True)
    try:
        while True:
            next(reading)
            yield True
    except StopIteration as end:
        replay: Replay = end.value
    except ReplayError as error:
        card.show_fault(error.faults[0])
        return
    card.line = f"{replay.level.name}, {_length(replay)}, {date_of(path)}"
    card.show_texts(card.name, _contents(replay, path), replay.level.tags)
    key, theme = picture_key(f"{path.name} {replay.hashes[-1].whole}".encode()), shown_theme()
    picture = find_picture(path, key, card.picture_size, theme)
    if picture is not None:
        card.show_picture(picture)
        return
    try:
        # What does not move is in no recorded state.
        state = replace(replay.state(max(replay.states)), terrain=terrain_of(replay.level))
    except (ReplayError, ValueError):
        return
    yield True
    asked = None if replay.level.look is None else replay.level.look.theme
    drawn = draw_picture(replay.level, state, SIZE, crop_of(replay.level, state), LINE_SCALE, asked or theme)
    card.show_picture(pygame.transform.smoothscale(drawn, card.picture_size))
    keep_for_later(drawn, kept_picture(key, theme))


def date_of(path: Path) -> str:
    """When a file was written."""
    return time.strftime("%d %b %Y, %H:%M", time.localtime(path.stat().st_mtime))


def _length(replay: Replay) -> str:
    cut = ", cut off" if replay.end_hash is None else ""
    return f"{replay.ticks / replay.level.settings.tick_rate:.1f} s{cut}"


def _contents(replay: Replay, path: Path) -> str:
    gestures = len({line.gesture for line in replay.script})
    deeds = {0: "nothing was done", 1: "one deed"}.get(gestures, f"{gestures} deeds")
    return f"{replay.ticks:,} ticks, {deeds}, {path.stat().st_size / 1024:,.0f} KiB"
