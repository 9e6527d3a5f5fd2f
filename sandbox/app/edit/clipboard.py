"""Clipboard: parts of a level and whole levels as JSON text, by way of the system's clipboard."""

import json
from collections.abc import Callable, Mapping
from typing import ClassVar

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.widgets.dialogs import choose
from sandbox.editor.document import Document
from sandbox.editor.edits.copying import copy_text, paste
from sandbox.editor.edits.deleting import delete
from sandbox.level.document.canonical import level_text
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.format.picture import Picture
from sandbox.level.reading.files import parse_level
from sandbox.level.reading.pictures import pictures_of, take_pictures


class Clipboard:
    """Copies and pastes for a screen; where the system has no clipboard, within the program.

    Text holds no pictures: those that were copied last go along within the program, from level to level.
    """

    pictures: ClassVar[Mapping[str, Picture]] = {}

    def __init__(self, screen: Editing, open_as_new: Callable[[Level], object]) -> None:
        self._screen, self._open = screen, open_as_new
        self._own = ""

    def copy(self) -> bool:
        """Copy the selection; False where nothing is selected."""
        screen = self._screen
        if not screen.document.selection:
            screen.say("Nothing is selected.")
            return False
        self._own = copy_text(screen.document)
        Clipboard.pictures = pictures_of(screen.document.level)
        self._put(self._own)
        return True

    def cut(self) -> None:
        """Copy the selection and delete it."""
        if self.copy():
            self._screen.edit("Cut", delete)

    def copy_level(self) -> None:
        """Copy the whole level."""
        Clipboard.pictures = pictures_of(self._screen.document.level)
        self._put(level_text(self._screen.document.level))
        self._screen.say("The whole level is on the clipboard, as JSON.")

    def paste(self) -> None:
        """Paste parts at the pointer; a whole level from elsewhere as the person chooses."""
        screen, text = self._screen, self._get()
        if not text.strip():
            screen.say("The clipboard holds no text.")
            return
        level = _whole_level(text) if text != self._own else None
        if level is None:
            self._paste_parts(text)
            return
        take_pictures(level, self.pictures)
        choices = [
            ("Paste as parts of this level", lambda: self._paste_parts(text)),
            ("Open as a new level", lambda: self._open(level)),
        ]
        choose(screen.ui, f"Paste “{level.name}”", "The clipboard holds a whole level.", choices)

    def _paste_parts(self, text: str) -> None:
        screen = self._screen
        at = None if screen.pointer is None else screen.snapped(screen.camera.to_world(screen.pointer), 0).point

        def pasted(document: Document) -> Document:
            return paste(document, text, at, self.pictures)

        screen.edit("Paste", pasted)

    def _put(self, text: str) -> None:
        try:
            pygame.scrap.put_text(text)
        except pygame.error:
            self._screen.say("The system's clipboard is not available. You can paste in this window only.")

    def _get(self) -> str:
        try:
            return pygame.scrap.get_text() if pygame.scrap.has_text() else ""
        except pygame.error:
            return self._own


def _whole_level(text: str) -> Level | None:
    """The level that a text is, unless it has nothing but the parts of a copied selection."""
    try:
        data = json.loads(text)
        is_level = isinstance(data, dict) and ("name" in data and "settings" in data)
        return parse_level(text.encode(), "clipboard") if is_level else None
    except (ValueError, LevelError, RecursionError):
        return None
