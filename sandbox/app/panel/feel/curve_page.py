"""The page of what a feel takes home: for which tool, in which form, the text to copy, and files to save."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pygame

from sandbox.app.base.desktop import copy_text, free_path, pictures_folder, plain_name
from sandbox.app.base.sentences import capitalised, sentence
from sandbox.app.draw.picture import write_png
from sandbox.app.panel.feel.feel_curve import curve_picture
from sandbox.app.panel.take_home_page import CodeBlock, code_height
from sandbox.app.widgets.dialogs import BUTTON, MARGIN, Dialog, choose
from sandbox.app.widgets.scroll import BAR_WIDTH, ScrollArea
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.export.curves import MEASURED, NEAREST, TOOLS, card_page, card_picture, curve_for
from sandbox.export.feel import Feel
from sandbox.level.format.writing import write_file

# What a person calls the tools and the forms.
NAMES = {
    "css": "CSS", "unity": "Unity", "godot": "Godot", "swiftui": "SwiftUI", "flutter": "Flutter", "motion": "Motion",
    "react-spring": "react-spring",
}  # fmt: skip
FORMS = {MEASURED: "As measured", NEAREST: "Nearest single spring"}
# Sizes in layout units.
WIDTH, HEIGHT, ROW, GAP, ABOUT, NOTE = 800.0, 500.0, 30.0, 10.0, 36.0, 34.0


def show_curves(ui: Ui, feel: Feel, tool: str = "css", form: str = MEASURED, note: str = "") -> None:
    """Cover the window by the curve of a card as a tool takes it, in a form or the one that there is."""
    _CurvePage(ui, feel, tool, form, note)


class _CurvePage:
    """The page, for a tool and a form, until it is closed or another one is chosen."""

    def __init__(self, ui: Ui, feel: Feel, tool: str, form: str, note: str) -> None:
        self._ui, self._feel, self._tool = ui, feel, tool
        self._form = form if form in TOOLS[tool] else TOOLS[tool][0]
        try:
            about, self._code = curve_for(feel, tool, self._form)
        except ValueError as error:
            about, self._code = str(error), ""
        self._dialog = dialog = Dialog(ui, "Take it home", WIDTH, HEIGHT, self._reopen, is_page=True)
        y = 58.0
        tools = [(name, NAMES[name], "") for name in TOOLS]
        chosen = ui.choice(dialog.place(y, ROW), tools, lambda name: self._go(tool=name), dialog.box)
        chosen.show(tool)
        y += ROW + GAP
        forms = [(each, words, "") for each, words in FORMS.items()]
        made = ui.choice(dialog.place(y, ROW), forms, lambda each: self._go(form=each), dialog.box)
        made.show(self._form)
        for each, button in made.buttons.items():
            button.is_enabled = each in TOOLS[tool]
        y += ROW + GAP
        TextBlock(ui, dialog.place(y, ABOUT), sentence(about), dialog.box, 12.0)
        self._show_code(y + ABOUT)
        self._note = TextBlock(ui, dialog.place(dialog.height - MARGIN - BUTTON - NOTE, NOTE), note, dialog.box, 12.0)
        copy = dialog.add_buttons(("Copy", self._copy), ("Save ...", self._ask), ("Back", dialog.end))
        copy.is_enabled = bool(self._code)
        ui.focus_on(chosen.buttons[tool])

    def _show_code(self, y: float) -> None:
        ui, dialog = self._ui, self._dialog
        place = dialog.place(y, dialog.height - y - MARGIN - BUTTON - NOTE - GAP)
        wide = place.width
        place.width += ui.px(BAR_WIDTH)
        area, high = ScrollArea(ui, place, dialog.box), code_height(ui, self._code, wide)
        CodeBlock(ui, pygame.Rect(0, 0, wide, high), self._code, area.content)
        area.set_height(high)

    def _reopen(self, ui: Ui) -> None:
        show_curves(ui, self._feel, self._tool, self._form, self._note.text)

    def _go(self, tool: str = "", form: str = "") -> None:
        self._dialog.end()
        show_curves(self._ui, self._feel, tool or self._tool, form or self._form)

    def _copy(self) -> None:
        copied = copy_text(self._code)
        self._note.show_text("It is on the clipboard." if copied else "The clipboard is not available here.")

    def _ask(self) -> None:
        writers: tuple[tuple[str, str, Callable[[Path], object]], ...] = (
            ("Picture (.png)", ".png", lambda path: write_png(curve_picture(self._feel), path)),
            ("Picture (.svg)", ".svg", lambda path: write_file(path, card_picture(self._feel).encode())),
            ("Page that plays it (.html)", ".html", lambda path: write_file(path, self._page().encode())),
        )
        choices = [(words, partial(self._save, suffix, write)) for words, suffix, write in writers]
        choose(self._ui, "Save", "", choices)

    def _page(self) -> str:
        return card_page(self._feel, self._form)

    def _save(self, suffix: str, write: Callable[[Path], object]) -> None:
        try:
            path = free_path(pictures_folder(), plain_name(f"feel {self._feel.name}"), suffix)
            write(path)
        except OSError as error:
            self._note.show_text(f"It cannot be saved: {capitalised(error.strerror or str(error))}.")
        else:
            self._note.show_text(f"Saved as {path}")
