"""Bringing in: a drawing, picture or map that was dropped or opened comes into the sheet, as what the person says."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from sandbox.app.contracts.application import Application
from sandbox.app.widgets.dialogs import choose, show_lines
from sandbox.bring.bring import Brought, bring, usual_kind
from sandbox.bring.making import with_floor
from sandbox.bring.sketch import Kind
from sandbox.editor.document import Document
from sandbox.editor.edits.copying import put_in
from sandbox.level.document.model import ContactsDef
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.quantities import replaced

LABELS: dict[Kind, str] = {"jelly": "As jelly", "ground": "As ground"}
AS_THEY_MOVE = "What moves as jelly, the rest as ground"
TEXT = "Its outlines become soft bodies, or ground that never moves."


def offer_to_bring(app: Application, path: Path) -> None:
    """Ask what a file is to become, what is usual for it first, and bring it in."""
    try:
        usual = usual_kind(path)
    except LevelError as error:
        _refuse(app, path, error)
        return
    kinds: list[Kind] = sorted(LABELS, key=lambda kind: kind != usual)
    choices: list[tuple[str, Callable[[], object]]] = [
        (LABELS[kind], partial(_bring, app, path, kind)) for kind in kinds
    ]
    if usual is None:
        choices.insert(0, (AS_THEY_MOVE, partial(_bring, app, path, None)))
    choose(app.ui, f"Bring in {one_line(path.name)}", TEXT, choices)


def _bring(app: Application, path: Path, kind: Kind | None) -> None:
    try:
        brought = bring(path, kind)
    except LevelError as error:
        _refuse(app, path, error)
        return
    label = f"Bring in {one_line(path.name)}"
    editor = app.documents.editor if app.mode == "edit" else None
    if editor is None:
        app.documents.edit_level(with_floor(brought.level), label)
        _tell(app, path, brought)
        return
    middle = editor.camera.centre
    if editor.edit(label, lambda document: _touching(put_in(document, brought.level, middle))):
        _tell(app, path, brought)


def _touching(document: Document) -> Document:
    """The document in a level whose things touch each other."""
    level = document.level
    return document if level.has_contacts else replace(document, level=replaced(level, contacts=ContactsDef()))


def _tell(app: Application, path: Path, brought: Brought) -> None:
    if brought.left_out:
        lines = [f"{brought.came}.", "Left out:", *brought.left_out]
        show_lines(app.ui, f"{one_line(path.name)} came in", lines)
    else:
        app.say(f"{one_line(path.name)}: {brought.said()}.")


def _refuse(app: Application, path: Path, error: LevelError) -> None:
    app.show_faults(f"{one_line(path.name)} cannot be brought in", [one_line(fault) for fault in error.faults])
