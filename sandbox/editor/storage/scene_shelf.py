"""SceneShelf: how runs stand, kept by themselves in the person's data folder by a thread of its own."""

import contextlib
import secrets
import threading
import time
from pathlib import Path

from sandbox.editor.storage.data_folder import data_folder
from sandbox.level.format.level_error import one_line
from sandbox.level.format.writing import refusal_of, write_file
from sandbox.session.replay.scene_file import SUFFIX, scene_lines
from sandbox.session.scene import RunScene

# Scenes that are kept, newest first; one that is older than all of these goes.
KEPT = 60
# Pause [s] after a write of a run that goes on, as many times the time it took, within these bounds.
_PAUSE_FACTOR = 5.0
_PAUSES = (0.25, 4.0)


class SceneShelf:
    """Keeps the runs of one window on disk: the present one as it goes on, and each that was set aside as it stood.

    folder: where, by default in the person's data folder. `fault`: a line for the person while nothing can be written.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = shelf_folder() if folder is None else folder
        self.fault: str | None = None
        # Where the present run is kept, once something was done in it.
        self.present = self._new_path()
        self._changed = threading.Condition()
        self._wanted: dict[Path, tuple[RunScene, Path | None]] = {}
        self._busy = self._is_closing = False
        # What was set aside, by where it is kept.
        self._aside: dict[Path, RunScene] = {}
        self._thread: threading.Thread | None = None

    def note(self, scene: RunScene, source: Path | None) -> None:
        """Keep the present run so from now on; source: the file of its level. Returns at once."""
        if scene.script:
            self.present = self._place(scene)
            self._want(scene, source)

    def set_aside(self, scene: RunScene, source: Path | None) -> None:
        """Keep the present run so for good: what comes is another one."""
        if scene.script:
            self.note(scene, source)
            self._aside[self.present] = scene
            for path in list(self._aside)[:-KEPT]:
                del self._aside[path]

    def give_up(self, scene: RunScene) -> None:
        """Keep the present run no more: it has been saved as this scene."""
        aside = self._aside.get(self.present)
        if aside is not None and not aside.is_done_by(scene.script):
            return
        with self._changed:
            self._wanted.pop(self.present, None)
        self.settle()
        with contextlib.suppress(OSError):
            self.present.unlink(missing_ok=True)
        self._aside.pop(self.present, None)

    def _place(self, scene: RunScene) -> Path:
        """Where a scene is kept: where one is of the same deeds, in which only time has passed, or else of its own."""
        for path, kept in self._aside.items():
            if kept.tick <= scene.tick and kept.is_done_by(scene.script) and kept.level == scene.level:
                return path
        return self._new_path() if self.present in self._aside else self.present

    def others(self) -> list[Path]:
        """What is kept, newest first, but the run that goes on here."""
        return [path for path in kept_scenes(self.folder) if path != self.present or path in self._aside]

    def settle(self) -> None:
        """Wait until all that was noted is written, or cannot be."""
        with self._changed:
            self._changed.wait_for(lambda: not (self._wanted or self._busy))

    def close(self) -> None:
        """Write what was noted last and end."""
        with self._changed:
            self._is_closing = True
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join()
        self._thread = None

    def _new_path(self) -> Path:
        return self.folder / f"{time.strftime('%Y%m%d-%H%M%S')}-{secrets.token_hex(6)}{SUFFIX}"

    def _want(self, scene: RunScene, source: Path | None) -> None:
        with self._changed:
            self._wanted[self.present] = scene, source
            if self._thread is None:
                self._is_closing = False
                self._thread = threading.Thread(target=self._work, name="scenes", daemon=True)
                self._thread.start()
            self._changed.notify_all()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._wanted or self._is_closing)
                if not self._wanted:
                    return
                path = next(iter(self._wanted))
                scene, source = self._wanted.pop(path)
                self._busy = True
            start = time.monotonic()
            self.fault = self._write(path, scene, source)
            shortest, longest = _PAUSES
            pause = min(max(_PAUSE_FACTOR * (time.monotonic() - start), shortest), longest)
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                # A run that goes on waits; where another has begun meanwhile, its file is the next one.
                self._changed.wait_for(self._is_pressed, pause)

    def _is_pressed(self) -> bool:
        return self._is_closing or len(self._wanted) > 1

    def _write(self, path: Path, scene: RunScene, source: Path | None) -> str | None:
        """Write a scene: None, or why it cannot be."""
        try:
            is_new = not path.exists()
            self.folder.mkdir(parents=True, exist_ok=True)
            write_file(path, b"".join(scene_lines(scene, source)))
        except (OSError, ValueError, MemoryError) as error:
            why = refusal_of(error) if isinstance(error, OSError) else one_line(str(error))
            return f"The run cannot be kept in {one_line(str(self.folder))}: {why}. Save it yourself."
        if is_new:
            for old in kept_scenes(self.folder)[KEPT:]:
                with contextlib.suppress(OSError):
                    old.unlink()
        return None


def shelf_folder() -> Path:
    """The folder of the runs that are kept by themselves."""
    return data_folder() / "scenes"


def kept_scenes(folder: Path | None = None) -> list[Path]:
    """Scenes that were kept, newest first."""
    return scenes_in(shelf_folder() if folder is None else folder)


def scenes_in(folder: Path) -> list[Path]:
    """The scenes of a folder, newest first."""
    try:
        return sorted(folder.glob(f"*{SUFFIX}"), key=lambda path: path.stat().st_mtime_ns, reverse=True)
    except OSError:
        return []
