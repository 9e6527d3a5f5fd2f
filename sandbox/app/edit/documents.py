"""DocumentActions: the level that the editor has open: new, opened, saved, played, and found again after a crash."""

import os
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from sandbox.app.base.desktop import plain_name, recordings_folder
from sandbox.app.contracts.application import Application
from sandbox.app.edit.edit_screen import EditScreen
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.dialogs import ask, choose, show_lines
from sandbox.bring.bring import is_brought
from sandbox.editor.document import UNTITLED, Document, empty_level, new_level
from sandbox.editor.history import History
from sandbox.editor.storage.autosave import Autosave, Orphan, orphans
from sandbox.editor.storage.level_file import ChangedOnDisk, FileExists, LevelFile, LevelInUse, StorageError
from sandbox.editor.storage.preferences import remember
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.session.replay.recording import Replay

# Longest name of a level's file [characters].
NAME_LIMIT = 200
# What is said where a new place is played in.
NEW_PLACE = "Click a part at the left, then the world. Ctrl+S saves the scene. E leads to the sheet of this place."
# Autosaves that are offered at once.
OFFERED = 5


class DocumentActions:
    """Actions on the level that is edited; `editor` is its screen, also while it is played."""

    def __init__(self, app: Application) -> None:
        self.app = app
        self.editor: EditScreen | None = None
        self._autosave: Autosave | None = None
        self._reported_change = False
        self._reported_fault: str | None = None

    # Opening.

    def begin(self, name: str) -> None:
        """Edit a level file, also one to come, or a shipped level by its name; "" = a new place, at the start."""
        if not name:
            self.new_place()
            return
        self.new()
        if is_brought(name):
            self.app.files.open_path(name)
        elif os.path.lexists(name):
            self.open(name)
        elif _is_to_come(name):
            self._begin_file(Path(name))
        else:
            try:
                self.edit_level(load_level(name))
            except LevelError as error:
                show_lines(self.app.ui, f"{name} cannot be opened", error.faults)

    def _begin_file(self, path: Path) -> None:
        """Begin with an empty sheet that is saved to a file which is not there yet."""
        try:
            level_file = LevelFile.to_come(path)
        except LevelInUse as error:
            show_lines(self.app.ui, f"{_called(path)} is in use", [str(error)])
            return
        self._show(replaced(empty_level(), name=one_line(path.stem)), level_file, "New")
        self.app.say(f"{_called(path)} is not there yet. Ctrl+S writes it.")

    def new(self, then: Callable[[], object] = lambda: None, level: Level | None = None) -> None:
        """Begin with a level that has no file, else an empty sheet; then: what is done once it is there."""

        def begin() -> None:
            self._show(level or empty_level(), LevelFile(), "New")
            then()

        self.if_saved(begin)

    def new_place(self) -> None:
        """Begin a level with ground and walls to play in, and show it in the editor."""
        self.new(level=new_level())

    def play_new(self) -> None:
        """Play in a new place, with the parts at hand; it lies on the sheet as well."""

        def begin() -> None:
            self.play()
            self.app.act("palette")
            self.app.say(NEW_PLACE)

        self.new(begin, new_level())

    def edit_level(self, level: Level, label: str = "Open", then: Callable[[], object] = lambda: None) -> None:
        """Edit a level that has no file of its own, and go on."""

        def show() -> None:
            self._show(level, LevelFile(), label)
            then()

        self.if_saved(show)

    def edit_run(self, level: Level, source: Path | None, then: Callable[[], object]) -> None:
        """Edit the level of a run, in the file that it is from where that still holds it, and go on."""

        def show() -> None:
            self._show(level, _file_of(level, source), "Open")
            then()

        if self.editor is not None and self.editor.document.level == level:
            self.back()
            then()
        else:
            self.if_saved(show)

    def open(self, path: str | Path) -> None:
        """Edit a level file; the one that is open already is shown as it is."""
        path = Path(path)
        if self._has_open(path):
            self.back()
            self.look_at_disk()
        else:
            self.if_saved(lambda: self._open(path, LevelFile.open))

    def _has_open(self, path: Path) -> bool:
        own = self.editor.level_file.path if self.editor is not None else None
        return own is not None and os.path.realpath(own) == os.path.realpath(path)

    def open_copy(self, path: str | Path) -> None:
        """Edit a level file's content under no name yet."""
        self.if_saved(lambda: self._open(Path(path), LevelFile.copy_of))

    def _open(self, path: Path, opener: Callable[[Path], tuple[LevelFile, Level]]) -> None:
        try:
            level_file, level = opener(path)
        except LevelInUse as error:
            choices = [("Open a copy", lambda: self._open(path, LevelFile.copy_of))]
            choose(self.app.ui, f"{_called(path)} is in use", f"{error}.", choices)
            return
        except LevelError as error:
            self._offer_salvage(path, error.faults)
            return
        self._show(level, level_file, "Open")
        if level_file.path is None:
            self.app.say(f"A copy of {_called(path)}: save it under a new name.")

    def _offer_salvage(self, path: Path, faults: list[str]) -> None:
        title = f"{_called(path)} cannot be opened"
        try:
            level_file, level, left_out = LevelFile.salvaged(path)
        except LevelError:
            level = None
        if level is None:
            show_lines(self.app.ui, title, faults)
            return
        found = level

        def open_valid() -> None:
            self._show(found, level_file, f"Open the valid rest of {_called(path)}")
            self.app.say(f"{_called(path)} does not change. Save the valid rest under a new name.")

        # Reading stops at the first kind of fault; what is left out is more, and the person has to agree to all of it.
        show_lines(self.app.ui, title, left_out or faults, ("Open the valid rest", open_valid))

    def _show(self, level: Level, level_file: LevelFile, label: str) -> None:
        if self.editor is not None:
            self.editor.level_file.close()
        self.give_up()
        if self._autosave is None:
            self._autosave = Autosave()
        self._reported_change = False
        self.editor = EditScreen(self.app, History(Document(level), label), level_file)
        if level_file.warning:
            self.app.say(level_file.warning)
        if level_file.path is not None and level_file.path.exists():
            remember(level_file.path)
        self.app.show_screen(self.editor)
        self.app.offer_tour()

    # Saving.

    def save(self) -> None:
        """Write the level to its file, or ask for a name where it has none."""
        self._save(lambda: None)

    def save_as(self) -> None:
        """Write the level to a file whose name is asked for."""
        self._ask_name(lambda: None)

    def _save(self, then: Callable[[], object]) -> None:
        editor = self.editor
        if editor is None:
            return
        if editor.level_file.path is None:
            self._ask_name(then)
        else:
            self._write(lambda replace: editor.level_file.save(editor.document.level, replace), then)

    def _write(
        self, write: Callable[[bool], str | None], then: Callable[[], object], replace: bool = False, typed: str = ""
    ) -> None:
        """Write the file, then go on; where a file is in the way, or it cannot be, the person is asked.

        typed: what was typed for its name.
        """
        editor = self.editor
        assert editor is not None
        before = editor.level_file.path
        try:
            warning = write(replace)
        except (FileExists, ChangedOnDisk) as error:
            title = "Replace the file?" if isinstance(error, FileExists) else "The file has changed"
            # Enter, pressed unawares, loses nothing.
            choices = [
                ("Save under another name", lambda: self._ask_name(then, typed)),
                ("Replace it", lambda: self._write(write, then, True, typed)),
            ]
            choose(self.app.ui, title, f"{error}.", choices)
            return
        except StorageError as error:
            text = f"{error}. The level is still here, and in the autosave."
            choose(self.app.ui, "Not saved", text, [("Save under another name", lambda: self._ask_name(then, typed))])
            return
        editor.history.mark_saved()
        self._reported_change = False
        path = editor.level_file.path
        assert path is not None
        remember(path)
        self.give_up()
        self.app.say(one_line(warning or f"Saved as {path}"))
        if path != before and editor.level_file.warning:
            self.app.say(editor.level_file.warning)
        then()

    def _ask_name(self, then: Callable[[], object], typed: str = "") -> None:
        """Ask for the file's name; typed: what was typed before, that could not be."""
        editor = self.editor
        if editor is None:
            return
        present = editor.level_file.path
        try:
            folder = present.parent if present is not None else recordings_folder()
        except OSError as error:
            folder = Path.cwd()
            self.app.say(f"The documents' folder cannot be used: {error.strerror or error}.")
        suggestion = typed or (one_line(present.stem) if present is not None else "")
        suggestion = suggestion or plain_name(editor.document.level.name)

        def path_of(typed: str) -> Path:
            path = folder / os.path.expanduser(typed)
            return path if path.suffix == ".json" else path.with_name(f"{path.name}.json")

        def answer(typed: str) -> str | None:
            if not typed.strip("./\\ ") or len(typed) > NAME_LIMIT or "\0" in typed:
                return f"Type a name of 1 to {NAME_LIMIT} characters."
            target = folder / os.path.expanduser(typed)
            if typed.endswith(("/", os.sep)) or os.path.isdir(target):
                return "This is a folder. Add a file name."
            if target.parent != folder and not os.path.isdir(target.parent):
                return f"There is no folder {one_line(str(target.parent))}."
            return None

        def write(typed: str) -> None:
            path = path_of(typed)

            def save_as(over: bool) -> str | None:
                # A level that nobody has named is called as its file.
                level = editor.document.level
                if level.name == UNTITLED:
                    level = replaced(level, name=one_line(path.stem))
                warning = editor.level_file.save_as(level, path, over)
                if level is not editor.document.level:
                    editor.apply("Name it as its file", replace(editor.document, level=level))
                return warning

            self._write(save_as, then, typed=typed)

        ask(
            self.app.ui,
            "Save the level as",
            f"In {one_line(str(folder))} - or type a full path.",
            suggestion,
            "Save",
            answer,
            then=write,
        )

    def revert(self) -> None:
        """Read the level from its file again, as a step that can be undone."""
        editor = self.editor
        if editor is None or editor.level_file.path is None:
            self.app.say("The level has no file yet.")
            return
        try:
            level = editor.level_file.read()
        except LevelError as error:
            show_lines(self.app.ui, "Not read again", error.faults)
            return
        editor.cancel()
        before = editor.document.level
        editor.take_over("Revert to the file", Document(level))
        editor.history.mark_saved()
        self.give_up()
        self._reported_change = False
        again = "" if level == before else " Undo (Ctrl+Z) brings your changes back."
        self.app.say(f"{_called(editor.level_file.path)} was read again.{again}")

    def if_saved(self, then: Callable[[], object]) -> None:
        """Go on, once the person has said what becomes of changes that are not saved, that being typed among them."""
        self.app.ui.blur()
        editor = self.editor
        if editor is None or editor.history.is_saved:
            then()
            return
        if self.app.ui.has_question:
            return
        title = f"Save “{editor.document.level.name}”?"
        choices = [("Save", lambda: self._save(then)), ("Discard the changes", then)]
        choose(self.app.ui, title, "It has unsaved changes.", choices, is_question=True)

    def give_up(self) -> None:
        """Keep nothing in the autosave: the person has saved, or does not want it."""
        if self._autosave is not None:
            self._autosave.clear()

    def close(self) -> None:
        """Close the file; edits that were not given up stay in the autosave and are offered at the next start."""
        if self.editor is not None:
            self.editor.level_file.close()
        if self._autosave is not None:
            self._autosave.close()

    # Safety.

    def update(self) -> None:
        """Say once where the autosave cannot be written."""
        fault = self._autosave.fault if self._autosave is not None else None
        if fault != self._reported_fault:
            self._reported_fault = fault
            if fault is not None:
                self.app.say(fault)

    def note(self, level: Level, path: Path | None, label: str) -> None:
        """Keep the present document in the autosave."""
        if self._autosave is not None:
            self._autosave.note(level, path, label)

    def look_at_disk(self) -> None:
        """Ask what to do where another program has written the file, once for each time."""
        editor = self.editor
        if editor is None or self._reported_change or self.app.ui.has_sheet or not editor.level_file.changed_on_disk():
            return
        self._reported_change = True
        path = editor.level_file.path
        choices = [("Read it again", self.revert), ("Keep my version", lambda: None)]
        text = "Another program changed this file. You can read it again, and undo that."
        choose(self.app.ui, f"{_called(path) if path else 'The file'} has changed", text, choices)

    def offer_recovery(self) -> None:
        """Offer what a session that ended badly has left in the autosave."""
        found = orphans()
        offered = found[:OFFERED]
        if not found:
            return

        def discard() -> None:
            for orphan in offered:
                orphan.dismiss()

        choices: list[tuple[str, Callable[[], object]]] = [
            (f"Recover {_described(orphan)}", partial(self._recover, orphan)) for orphan in offered
        ]
        more = f" {len(found) - OFFERED} more come at the next start." if len(found) > OFFERED else ""
        choices.append(("Discard all of these" if len(offered) > 1 else "Discard it", discard))
        text = f"The editor did not close properly last time. Your unsaved work was kept.{more}"
        choose(self.app.ui, "Recover your work?", text, choices, is_question=True)

    def _recover(self, orphan: Orphan) -> None:
        try:
            level, left_out = orphan.salvaged() if orphan.fault else (orphan.level(), [])
        except StorageError as error:
            show_lines(self.app.ui, "Not recovered", [str(error)])
            return
        if level is None:
            show_lines(self.app.ui, "Not recovered", [orphan.fault or "Nothing in it is valid."])
            return
        recovered = level

        def recover() -> None:
            self._show_recovered(orphan, recovered)
            if left_out:
                show_lines(self.app.ui, "This could not be recovered", left_out)

        if orphan.edited is not None and self._has_open(orphan.edited):
            recover()
        else:
            self.if_saved(recover)

    def _show_recovered(self, orphan: Orphan, level: Level) -> None:
        if orphan.edited is not None and self._has_open(orphan.edited):
            self.back()
        else:
            self._show_edited(orphan.edited)
        assert self.editor is not None and self._autosave is not None
        self.editor.take_over("Recover", Document(level))
        if level.view is None:
            self.editor.fit()
        else:
            self.editor.show_view()
        self._autosave.adopt(orphan, level)

    def _show_edited(self, path: Path | None) -> None:
        """Show the file that a lost session edited, or an empty sheet."""
        try:
            level_file, before = LevelFile.open(path) if path is not None else (LevelFile(), empty_level())
        except (StorageError, LevelError) as error:
            level_file, before = LevelFile(), empty_level()
            self.app.say(f"{str(error).splitlines()[0]}. What is recovered is saved under a new name.")
        self._show(before, level_file, "Open")

    # Playing.

    def keep_solution(self, run: Replay) -> None:
        """Keep a run as the solution of the level's file, which is written first where it is not saved."""
        editor = self.editor
        if editor is None:
            return

        def keep() -> None:
            if editor.level_file.path is not None:
                self.app.best.keep_solution(editor.level_file.path, run, self.app.say)

        if editor.level_file.path is not None and editor.history.is_saved:
            keep()
        else:
            self._save(keep)

    def play(self, watched: Replay | None = None, ghost: Replay | None = None) -> None:
        """Play the document from its beginning; watched: as this run does it; ghost: beside it."""
        editor = self.editor
        if editor is None:
            return
        editor.settle()
        # What is being typed is played, too.
        self.app.ui.blur()
        screen = self.app.start_document(Playback(editor.document.level, watched))
        if ghost is not None:
            screen.game.run_along(ghost)
        screen.camera.show_as(editor.camera)
        box = editor.whole_box
        if box is not None and editor.camera.shows(box):
            # A run has a bar or two more than the sheet.
            screen.camera.reveal(box)

    def back(self) -> None:
        """Go back from a run to the document as it was."""
        if self.editor is not None:
            play = self.app.play
            if play is not None:
                self.editor.watch.remember(play.playback.session)
            self.app.show_screen(self.editor)


def _file_of(level: Level, source: Path | None) -> LevelFile:
    """The file that a level is from, or none where it now holds another one."""
    try:
        level_file, there = LevelFile.open(source) if source is not None else (LevelFile(), None)
    except (StorageError, LevelError):
        return LevelFile()
    if there != level:
        level_file.close()
        return LevelFile()
    return level_file


def _is_to_come(name: str) -> bool:
    """Whether a name says where a level is to be written: in a folder that is there, as no shipped level is called."""
    path = Path(name)
    return path.suffix == ".json" and path.parent.is_dir() and path.stem not in {each.stem for each in shipped_levels()}


def _called(path: Path) -> str:
    """The name of a file, readable also where the system's encoding cannot show it."""
    return one_line(path.name)


def _described(orphan: Orphan) -> str:
    """An autosave in a few words."""
    when = f", {orphan.when.astimezone():%d %B, %H:%M}" if orphan.when is not None else ""
    name = f"“{orphan.name[:40]}”" if orphan.name else "a level"
    name += f" of {_called(orphan.edited)}" if orphan.edited is not None else ""
    return f"{name}{when}{' (damaged)' if orphan.fault else ''}"
