"""Cards of scenes: what each is of, when it was kept, what was done in it, and a picture of how it stands."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pygame

from sandbox.app.base.recordings import told_time
from sandbox.app.draw.colours import shown_theme
from sandbox.app.draw.picture import crop_of, draw_picture
from sandbox.app.draw.picture_cache import LINE_SCALE, SIZE, find_picture, keep_for_later, kept_picture, picture_key
from sandbox.app.gallery.card import Card
from sandbox.editor.document import UNTITLED
from sandbox.level.plan.surfaces import terrain_of
from sandbox.session.replay.recording import ReplayError
from sandbox.session.scene import SUFFIX, read_about, read_scene

# What the place is called that New begins with.
NEW_PLACE = "New place"
# Bytes at the end of a scene's file, where the hash of its state is, which a picture goes by.
END_BYTES = 256


def fill_scene(card: Card, path: Path, is_kept: bool) -> Iterator[bool]:
    """Read a scene for its card and draw it, a slice at a time; is_kept: by itself, under no name."""
    try:
        about = read_about(path)
        end = _end_of(path)
    except (ReplayError, OSError) as error:
        card.show_fault(error.faults[0] if isinstance(error, ReplayError) else str(error))
        return
    when, level = told_time(about.when), about.name if about.name != UNTITLED else NEW_PLACE
    name = level if is_kept else path.name.removesuffix(SUFFIX)
    card.line = f"{when}, {about.actions}" if is_kept else f"Scene, {when}"
    text = f"{level}, as it stood {when}: {about.actions}."
    card.show_texts(f"{level}, {when}, {about.actions}" if card.is_small else name, text, ("scene",))
    yield True
    key, theme = picture_key(end), shown_theme()
    picture = find_picture(path, key, card.picture_size, theme)
    if picture is not None:
        card.show_picture(picture)
        return
    try:
        scene, _ = read_scene(path)
    except ReplayError as error:
        card.show_fault(error.faults[0])
        return
    yield True
    # What does not move is in no kept state.
    state = replace(scene.state, terrain=terrain_of(scene.level))
    asked = None if scene.level.look is None else scene.level.look.theme
    drawn = draw_picture(scene.level, state, SIZE, crop_of(scene.level, state), LINE_SCALE, asked or theme)
    card.show_picture(pygame.transform.smoothscale(drawn, card.picture_size))
    keep_for_later(drawn, kept_picture(key, theme))


def _end_of(path: Path) -> bytes:
    with open(path, "rb") as file:
        file.seek(0, 2)
        file.seek(max(file.tell() - END_BYTES, 0))
        return file.read()
