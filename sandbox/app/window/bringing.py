"""Bringing in drawings, maps and scenes of other programs: what they become, a bar meanwhile, and the outcome."""

import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from sandbox.app.contracts.application import Application, Editing
from sandbox.app.widgets.dialogs import choose, show_lines
from sandbox.bring.bring import Brought, bring, usual_kind
from sandbox.bring.making import with_floor
from sandbox.bring.sketch import Kind
from sandbox.editor.document import Document
from sandbox.editor.edits.copying import put_in
from sandbox.editor.edits.fields import change_field
from sandbox.editor.items import chosen_bodies
from sandbox.level.document.model import ContactsDef
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.look import BodyLook
from sandbox.level.format.picture import NoPicture, read_picture
from sandbox.level.format.quantities import replaced
from sandbox.session.transaction import Interrupted

# How long the bar waits for the work before it is drawn again [s].
WAIT = 0.02
_LABELS: dict[Kind, str] = {"jelly": "As jelly", "ground": "As ground"}
AS_PICTURE = "As the picture of what is selected"
AS_THEY_MOVE = "What moves as jelly, the rest as ground"
_TEXT = "Its outlines become soft bodies, or ground that never moves."
_OWN = f"{_TEXT} They are a level of their own."


class _Making(threading.Thread):
    """Brings a file in beside the window, which is drawn meanwhile; done: how much is, 0..1.

    is_stopped: nobody wants it any more; it ends at the next thing.
    """

    def __init__(self, path: Path, kind: Kind | None) -> None:
        super().__init__(name="brings in", daemon=True)
        self._path, self._kind = path, kind
        self.done, self.is_stopped = 0.0, False
        self.brought: Brought | None = None
        self.fault: Exception | None = None

    def run(self) -> None:
        """Make the level, or note why there is none."""
        try:
            self.brought = bring(self._path, self._kind, tell=self._tell)
        except Exception as error:
            self.fault = error

    def _tell(self, done: float) -> None:
        if self.is_stopped:
            raise Interrupted
        self.done = done


def offer_to_bring(app: Application, path: Path) -> None:
    """Ask what a file is to become, what is usual for it first, and bring it in."""
    try:
        usual = usual_kind(path)
    except LevelError as error:
        _refuse_brought(app, path, error)
        return
    kinds: list[Kind] = sorted(_LABELS, key=lambda kind: kind != usual)
    choices: list[tuple[str, Callable[[], object]]] = [
        (_LABELS[kind], partial(_bring, app, path, kind)) for kind in kinds
    ]
    editor = None if _is_own(app) else app.documents.editor
    if (
        editor is not None
        and path.suffix.lower() == ".png"
        and chosen_bodies(editor.document.level, editor.document.selection)
    ):
        choices.append((AS_PICTURE, partial(_wear, app, editor, path)))
    if usual is None:
        choices.insert(0, (AS_THEY_MOVE, partial(_bring, app, path, None)))
    choose(app.ui, f"Bring in {one_line(path.name)}", _OWN if _is_own(app) else _TEXT, choices)


def _wear(app: Application, editor: Editing, path: Path) -> None:
    """Let the selected bodies wear a picture."""
    try:
        picture = read_picture(path)
    except NoPicture as error:
        app.say(f"{one_line(path.name)}: {error}.")
        return

    def worn(document: Document) -> Document:
        bodies = frozenset(item for item in document.selection if item.kind == "body")
        return change_field(
            document, bodies, "look", lambda look: {**(look or BodyLook()).__dict__, "picture": picture}
        )

    editor.edit("Picture", worn)


def _brought(app: Application, path: Path, kind: Kind | None) -> Brought | None:
    """What a file has become, with a bar while it is made; None: the person cancelled it. Raises LevelError."""
    making = _Making(path, kind)
    making.start()
    try:
        while making.is_alive():
            app.show_progress(making.done, f"Bringing in {one_line(path.name)}")
            making.join(WAIT)
    except Interrupted:
        making.is_stopped = True
        app.say("Cancelled: nothing came in.")
        return None
    if making.fault is not None:
        raise making.fault
    return making.brought


def _bring(app: Application, path: Path, kind: Kind | None) -> None:
    try:
        brought = _brought(app, path, kind)
    except LevelError as error:
        _refuse_brought(app, path, error)
        return
    if brought is None:
        return
    label, level = f"Bring in {one_line(path.name)}", brought.level
    tell = partial(_tell_brought, app, path, brought)
    editor = None if _is_own(app) else app.documents.editor
    if editor is None:
        app.documents.edit_level(with_floor(level), label, tell)
        return
    middle = editor.camera.centre
    if editor.edit(label, lambda document: _touching(put_in(document, level, middle))):
        tell()


def _is_own(app: Application) -> bool:
    """Whether what comes in is a level of its own: no sheet is seen that it could come into."""
    return app.mode != "edit" or app.gallery is not None


def _touching(document: Document) -> Document:
    """The document in a level whose things touch each other."""
    level = document.level
    return document if level.has_contacts else replace(document, level=replaced(level, contacts=ContactsDef()))


def _tell_brought(app: Application, path: Path, brought: Brought) -> None:
    if brought.left_out:
        lines = [f"{brought.came}.", "Left out:", *brought.left_out]
        show_lines(app.ui, f"{one_line(path.name)} came in", lines)
    else:
        app.say(f"{one_line(path.name)}: {brought.said()}.")


def _refuse_brought(app: Application, path: Path, error: LevelError) -> None:
    app.show_faults(f"{one_line(path.name)} cannot be brought in", [one_line(fault) for fault in error.faults])
