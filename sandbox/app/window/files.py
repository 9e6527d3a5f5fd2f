"""FileActions: opening levels, recordings and foreign drawings; recording; saving."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sandbox.app.base.desktop import (
    SUFFIX,
    chosen_path,
    free_path,
    move_new,
    plain_name,
    readable_name,
    recordings_folder,
    when_text,
)
from sandbox.app.contracts.application import Application
from sandbox.app.gallery.sections import in_sections
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.dialogs import ask
from sandbox.app.window.bringing import offer_to_bring
from sandbox.bring.bring import is_brought
from sandbox.editor.document import UNTITLED
from sandbox.editor.storage.preferences import remember_played
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.format.writing import refusal_of, write_file
from sandbox.level.reading.files import load_level, read_bytes, read_level, shipped_folder, shipped_levels
from sandbox.level.reading.pictures import lacking
from sandbox.session.commands import CommandError
from sandbox.session.replay.reader import begins_as_replay, read_replay
from sandbox.session.replay.recording import ReplayError
from sandbox.session.scene import SUFFIX as SCENE
from sandbox.session.scene import RunScene, begins_as_scene, read_scene, scene_lines
from sandbox.session.sweep.grid import SweepError
from sandbox.session.transaction import Interrupted

# How the name of a sweep's table ends.
TABLE = ".csv"
# Of a folder so many files are looked at for the next level.
MOST_LEVELS = 300


class FileActions:
    """Actions on files; faults are shown as lines, and the app goes on with what it had."""

    def __init__(self, app: Application) -> None:
        self.app = app

    # Opening.

    def open_path(self, path: str | Path) -> bool:
        """Open a level, a recording or a scene, or offer to bring in a drawing or map; True where it could be."""
        if Path(path).suffix.lower() == TABLE:
            return self.open_sweep(Path(path))
        try:
            if begins_as_scene(path):
                return self.open_scene(Path(path))
            is_replay = begins_as_replay(path)
            if not is_replay and is_brought(path):
                offer_to_bring(self.app, Path(path))
                return True
        except OSError as error:
            self._refuse(path, [one_line(f"{path}: cannot be read: {refusal_of(error)}")])
            return False
        return self.open_replay(path) if is_replay else self.open_level(path)

    def open_level(self, path: str | Path, shipped: bool = False) -> bool:
        """Open a level file: play it, or edit it where a level is edited now, a shipped one as a copy."""
        if self.app.mode == "edit":
            documents = self.app.documents
            (documents.open_copy if shipped else documents.open)(path)
            return True
        try:
            playback = Playback(read_level(Path(path)))
        except LevelError as error:
            self._refuse(path, error.faults)
            return False
        self.app.start(playback, None if shipped else Path(path))
        remember_played(path)
        return True

    def next_level(self, level: Level, source: Path | None) -> tuple[Path, bool] | None:
        """The next level with rules after one that was won, and whether it is shipped; None: there is none.

        source: the file of that one: the next is in its folder, by name. Else it is the next one of the gallery.
        """
        if source is not None:
            paths = sorted(source.parent.glob("*.json"), key=lambda path: path.name.casefold())[:MOST_LEVELS]
            here = [path for path in paths if path.name == source.name]
        else:
            paths = [path for _, found in in_sections(shipped_levels()) for path in found]
            here = [path for path in paths if _head_of(path).get("name") == level.name]
        after = paths[paths.index(here[0]) + 1 :] if here else []
        found = next((path for path in after if _head_of(path).get("rules")), None)
        return None if found is None else (found, source is None)

    def open_sweep(self, path: Path) -> bool:
        """Show a table of `sandbox sweep` behind the pad, if it is of the level that runs."""
        try:
            if self.app.play is None:
                raise SweepError(f"{path}: open its level first, then open it again")
            self.app.play.show_sweep(path)
        except (SweepError, UnicodeDecodeError) as error:
            self._refuse(path, [str(error)])
            return False
        except OSError as error:
            self._refuse(path, [one_line(f"{path}: cannot be read: {refusal_of(error)}")])
            return False
        return True

    def open_replay(self, path: str | Path) -> bool:
        """Open a replay and watch it; one that is cut off as far as it goes."""
        try:
            try:
                replay = read_replay(path)
            except ReplayError:
                replay = read_replay(path, partial=True)
            playback = Playback(replay.level, replay)
        except ReplayError as error:
            self._refuse(path, error.faults)
            return False
        self.app.start(playback)
        lacks = lacking(replay.level)
        words = f"{lacks}." if lacks else "Touch anything to take over."
        self.app.say(f"Watching {one_line(Path(path).name)}. {words}")
        return True

    def open_scene(self, path: Path) -> bool:
        """Open a scene as it stood, paused; where a level is edited now, that waits in the editor."""
        try:
            scene, about = read_scene(path)
            playback = Playback(scene.level, first=scene)
        except (ReplayError, CommandError) as error:
            self._refuse(path, error.faults)
            return False
        playback.clock.paused = True
        source = about.source if about.source is not None and about.source.is_file() else None
        self.app.start(playback, source)
        play = self.app.play
        if play is not None and path.parent != self.app.scenes.shelf.folder:
            play.saved = path, scene
        lacks = lacking(scene.level)
        self.app.say(f"As it stood {when_text(about.when)}. {f'{lacks}.' if lacks else 'Space lets it go on.'}")
        return True

    def ask_to_open(self) -> None:
        """Ask for the path of a level or replay, or a shipped level's name."""
        hint = "The path of a file, or the name of a shipped level. Drawings and maps of other programs come in, too."
        ask(self.app.ui, "Open a level or a recording", hint, "", "Open", self._fault_of, then=self._open_typed)

    def _fault_of(self, typed: str) -> str | None:
        """Why nothing can be opened by that name; a file's own faults are shown when it is opened."""
        if os.path.isfile(os.path.expanduser(typed)):
            return None
        try:
            load_level(typed)
        except LevelError as error:
            return error.faults[0]
        return None

    def _open_typed(self, typed: str) -> None:
        path = os.path.expanduser(typed)
        if os.path.isfile(path):
            self.open_path(path)
            return
        try:
            # It may have gone, or have changed, since it was typed.
            level = load_level(typed)
        except LevelError as error:
            self._refuse(typed, error.faults)
            return
        if self.app.mode == "edit":
            self.app.documents.edit_level(level)
        else:
            self.app.start(Playback(level))
            remember_played(shipped_folder("levels") / f"{typed}.json")

    def _refuse(self, path: str | Path, faults: list[str]) -> None:
        self.app.show_faults(f"{one_line(Path(path).name)} cannot be opened", [one_line(fault) for fault in faults])

    # Scenes.

    def save_scene(self) -> None:
        """Save how the run stands in My levels, at once, and ask for a name; once more where it has gone on."""
        play = self.app.play
        if play is None:
            return
        scene = play.playback.present_scene()
        again = play.saved is not None and scene.follows(play.saved[1])
        try:
            if again and play.saved is not None:
                path = play.saved[0]
            else:
                path = free_path(recordings_folder(), _proposed_name(scene), SCENE)
            write_file(path, b"".join(scene_lines(scene, play.source)))
        except OSError as error:
            self.app.say(f"The scene cannot be saved: {error.strerror or error}.")
            return
        play.saved = path, scene
        self.app.scenes.is_saved(scene)
        if again:
            self.app.say(_in_my_levels(path))
        else:
            self._name_scene(path, scene)

    def _name_scene(self, path: Path, scene: RunScene) -> None:
        def rename(typed: str) -> str | None:
            target, fault = self._renamed(path, typed, SCENE, _in_my_levels)
            if target is not None and self.app.play is not None:
                self.app.play.saved = target, scene
            return fault

        def discard() -> None:
            self._discard(path)
            self.app.scenes.is_saved(None)
            if self.app.play is not None:
                self.app.play.saved = None

        self.app.say(_in_my_levels(path))
        hint = "It is in My levels, as it stands now. Escape keeps the name."
        ask(self.app.ui, "Name the scene", hint, path.name.removesuffix(SCENE), "Save", rename, ("Discard", discard))

    # Recording.

    def toggle_recording(self) -> None:
        """Start recording the run, its beginning included, or stop and ask for a name."""
        path = self._write(Playback.record_to)
        # A disk may be full before what was until now is written: why it ended is said then.
        if path is not None and self.app.play is not None and self.app.play.playback.session.recording is not None:
            self.app.say(_recording(path))

    def save_run(self) -> None:
        """Save the run so far as a recording, under a name that is asked for."""
        path = self._write(Playback.save_to)
        if path is not None:
            self._name(path)

    def _write(self, write: Callable[[Playback, Path], Path | None]) -> Path | None:
        """Write a new file for the run's recording, or end the present one; its path, None where that cannot be."""
        if self.app.play is None:
            return None
        playback = self.app.play.playback
        if playback.session.recording is not None:
            self._stop_and_name()
            return None
        try:
            return write(playback, free_path(recordings_folder(), plain_name(playback.level.name)))
        except OSError as error:
            where = f" to {error.filename}" if error.filename else ""
            self.app.say(f"The recording cannot be written{where}: {error.strerror or error}.")
        except ValueError as error:
            self.app.say(f"The recording cannot be made: {error}.")
        except Interrupted:
            self.app.say("Cancelled: no recording was made.")
        return None

    def _stop_and_name(self) -> None:
        assert self.app.play is not None
        path = self.app.play.playback.stop_recording()
        if path is not None:
            self.app.take_back(_recording(path))
            self._name(path)

    def _name(self, path: Path) -> None:
        self.app.say(_saved(path))
        suggestion = path.name.removesuffix(SUFFIX)
        ask(
            self.app.ui,
            "Name the recording",
            f"In {path.parent}. Escape keeps the name.",
            suggestion,
            "Save",
            lambda typed: self._rename(path, typed),
            ("Discard", lambda: self._discard(path)),
        )

    def _rename(self, path: Path, typed: str) -> str | None:
        return self._renamed(path, typed, SUFFIX, _saved)[1]

    def _renamed(
        self, path: Path, typed: str, suffix: str, message: Callable[[Path], str]
    ) -> tuple[Path | None, str | None]:
        """Give a file that was saved another name: its path then, or else why not; message: the line about it."""
        if typed.removesuffix(suffix) == path.name.removesuffix(suffix):
            return path, None
        try:
            target = chosen_path(path.parent, typed, suffix)
            move_new(path, target)
        except ValueError as error:
            return None, str(error)
        except OSError as error:
            return None, f"It stays {path.name}: {error.strerror or error}."
        self.app.take_back(message(path))
        self.app.say(message(target))
        return target, None

    def _discard(self, path: Path) -> None:
        try:
            path.unlink()
        except OSError as error:
            self.app.say(f"{path} cannot be removed: {error.strerror or error}.")
        else:
            for message in (_saved, _in_my_levels):
                self.app.take_back(message(path))
            self.app.say(f"Removed {path.name}.")


def _head_of(path: Path) -> dict[str, Any]:
    """The data of a file whose level is not checked yet; empty where it holds none."""
    try:
        data = json.loads(read_bytes(path))
    except (LevelError, ValueError, RecursionError):
        return {}
    return data if isinstance(data, dict) else {}


def _recording(path: Path) -> str:
    return f"Recording to {path}, from the beginning of the run."


def _proposed_name(scene: RunScene) -> str:
    name = scene.level.name
    return readable_name(name) if name != UNTITLED else "Scene"


def _in_my_levels(path: Path) -> str:
    return f"Saved in My levels as {path.name.removesuffix(SCENE)}."


def _saved(path: Path) -> str:
    return f"Saved as {path}"
