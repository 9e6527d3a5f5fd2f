"""Cards of scenes and recordings: what each is of, when it was kept, what was done in it, and a picture of its end."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pygame

from sandbox.app.base.desktop import when_text
from sandbox.app.draw.colours import shown_theme
from sandbox.app.draw.picture import crop_of, draw_picture
from sandbox.app.draw.picture_cache import LINE_SCALE, SIZE, find_picture, keep_for_later, kept_picture, picture_key
from sandbox.app.gallery.card import Card
from sandbox.app.play.run_actions import level_name
from sandbox.level.document.model import Level
from sandbox.level.format.slices import goes_on, telling
from sandbox.level.plan.surfaces import terrain_of
from sandbox.physics.snapshot import Snapshot
from sandbox.session.replay.reader import read_in_slices
from sandbox.session.replay.recording import ReplayError
from sandbox.session.scene import SUFFIX, read_about, read_scene
from sandbox.session.solution import known_solution

# Bytes at the end of a scene's file, where the hash of its state is, which a picture goes by.
END_BYTES = 256


def level_of_scene(path: Path) -> str:
    """What the level of a scene is called; "Runs" where its file cannot be read, which its card says."""
    try:
        return level_name(read_about(path).name)
    except (ReplayError, OSError):
        return "Runs"


def fill_scene(card: Card, path: Path, is_kept: bool) -> Iterator[bool]:
    """Read a scene for its card and draw it, a slice at a time; is_kept: by itself, under no name."""
    try:
        about = read_about(path)
        with open(path, "rb") as file:
            file.seek(0, 2)
            file.seek(max(file.tell() - END_BYTES, 0))
            end = file.read()
    except (ReplayError, OSError) as error:
        card.show_fault(error.faults[0] if isinstance(error, ReplayError) else str(error))
        return
    when, level = when_text(about.when), level_name(about.name)
    name = level if is_kept else path.name.removesuffix(SUFFIX)
    card.line = f"{when}, {about.actions}" if is_kept else f"Scene, {when}"
    text = f"{level}, as it stood {when}: {about.actions}."
    card.show_texts(f"{level}, {when}, {about.actions}" if card.is_small else name, text, ("scene",))
    yield True
    if not show_kept(card, path, end):
        try:
            scene, _ = read_scene(path)
        except ReplayError as error:
            card.show_fault(error.faults[0])
            return
        yield True
        _show_drawn(card, end, scene.level, scene.state)


def fill_replay(card: Card, path: Path) -> Iterator[bool]:
    """Read a recording for its card and draw it, a slice at a time."""
    try:
        replay = yield from telling(read_in_slices(path, partial=True), goes_on)
    except ReplayError as error:
        card.show_fault(error.faults[0])
        return
    seconds, cut = replay.ticks / replay.level.settings.tick_rate, "" if replay.end_hash is not None else ", cut off"
    card.line = f"{replay.level.name}, {seconds:.1f} s{cut}, {date_of(path)}"
    gestures = len({line.gesture for line in replay.script})
    deeds = {0: "nothing was done", 1: "one deed"}.get(gestures, f"{gestures} deeds")
    size = path.stat().st_size / 1024
    card.show_texts(card.name, f"{replay.ticks:,} ticks, {deeds}, {size:,.0f} KiB", replay.level.tags)
    content = f"{path.name} {replay.hashes[-1].whole}".encode()
    if not show_kept(card, path, content):
        try:
            state = replay.state(max(replay.states))
        except (ReplayError, ValueError):
            return
        yield True
        _show_drawn(card, content, replay.level, state)


def fill_solved(card: Card, path: Path, level: Level) -> Iterator[bool]:
    """Read the solution beside a level's file, a slice at a time, and say on its card how it wins the level."""
    known = yield from telling(known_solution(level, path), goes_on)
    card.solved = "" if known is None else known[1]


def date_of(path: Path) -> str:
    """When a file was written."""
    return time.strftime("%d %b %Y, %H:%M", time.localtime(path.stat().st_mtime))


def show_kept(card: Card, path: Path, content: bytes) -> bool:
    """Show the picture that is kept of a content, if there is one; whether there is."""
    picture = find_picture(path, picture_key(content), card.picture_size, shown_theme())
    if picture is not None:
        card.show_picture(picture)
    return picture is not None


def _show_drawn(card: Card, content: bytes, level: Level, kept: Snapshot) -> None:
    """Draw a state of a level, show it, and keep the picture for its content."""
    # What does not move is in no kept state.
    state, theme = replace(kept, terrain=terrain_of(level)), shown_theme()
    asked = None if level.look is None else level.look.theme
    drawn = draw_picture(level, state, SIZE, crop_of(level, state), LINE_SCALE, asked or theme)
    card.show_picture(pygame.transform.smoothscale(drawn, card.picture_size))
    keep_for_later(drawn, kept_picture(picture_key(content), theme))
