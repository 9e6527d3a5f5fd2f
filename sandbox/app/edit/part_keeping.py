"""Keeping of what is selected as a part of the person's own: a name is asked for, and it joins the catalogue."""

from pathlib import Path

from sandbox.app.base.sentences import capitalised, sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.widgets.dialogs import ask
from sandbox.editor.document import EditError
from sandbox.editor.edits.copying import part_of
from sandbox.editor.items import chosen_definitions
from sandbox.editor.storage.level_file import StorageError, keep_part


def ask_to_keep_part(screen: Editing) -> None:
    """Ask for the name of a part, and write it."""
    document = screen.document
    if not document.selection:
        screen.say("Select what the part consists of first.")
        return
    names = {getattr(part, "group", None) for part in chosen_definitions(document.level, document.selection)}
    one = names.pop() if len(names) == 1 else None
    first = chosen_definitions(document.level, document.selection)[0]
    kept: list[Path] = []
    suggestion: str = one or getattr(first, "id", None) or "Part"

    def answer(typed: str) -> str | None:
        try:
            path = keep_part(part_of(document, typed))
        except (EditError, StorageError) as error:
            return sentence(error)
        kept.append(path)
        return None

    def show(typed: str) -> None:
        screen.say(f"{typed} is in the catalogue now, under Your own parts.")
        screen.show_parts(kept[-1])

    hint = "The selection becomes a part that you can use in all your levels."
    ask(screen.ui, "Keep as a part", hint, capitalised(suggestion), "Keep", answer, then=show)
