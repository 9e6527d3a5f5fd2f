"""SceneShelf: how runs stand, kept by themselves in the person's data folder by a thread of its own."""

import contextlib
import secrets
import time
from pathlib import Path

from sandbox.editor.storage.background_writer import BackgroundWriter
from sandbox.editor.storage.preferences import data_folder
from sandbox.level.format.writing import write_file
from sandbox.session.scene import SUFFIX, RunScene, scene_lines

# Scenes that are kept, newest first; one that is older than all of these goes.
KEPT = 60


class SceneShelf:
    """Keeps the runs of one window on disk: the present one as it goes on, and each that was set aside as it stood.

    folder: where, by default in the person's data folder.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = shelf_folder() if folder is None else folder
        # Where the present run is kept, once something was done in it.
        self.present = self._new_path()
        # What was set aside, by where it is kept.
        self._aside: dict[Path, RunScene] = {}
        self._writer: BackgroundWriter[tuple[RunScene, Path | None]] = BackgroundWriter("run", self._write)

    @property
    def fault(self) -> str | None:
        """A line for the person while nothing can be written, else None."""
        return self._writer.fault

    def note(self, scene: RunScene, source: Path | None) -> None:
        """Keep the present run so from now on; source: the file of its level. Returns at once."""
        if scene.script:
            self.present = self._place(scene)
            self._writer.note(self.present, (scene, source))

    def set_aside(self, scene: RunScene, source: Path | None) -> None:
        """Keep the present run for good in this state: the next one is another."""
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
        self._writer.forget(self.present)
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
        """The kept runs, newest first, without the present one."""
        return [path for path in kept_scenes(self.folder) if path != self.present or path in self._aside]

    def settle(self) -> None:
        """Wait until all that was noted is written, or cannot be."""
        self._writer.settle()

    def close(self) -> None:
        """Write the scene noted last and end."""
        self._writer.close()

    def _new_path(self) -> Path:
        return self.folder / f"{time.strftime('%Y%m%d-%H%M%S')}-{secrets.token_hex(6)}{SUFFIX}"

    def _write(self, path: Path, content: tuple[RunScene, Path | None]) -> None:
        is_new = not path.exists()
        self.folder.mkdir(parents=True, exist_ok=True)
        write_file(path, b"".join(scene_lines(*content)))
        if is_new:
            for old in kept_scenes(self.folder)[KEPT:]:
                with contextlib.suppress(OSError):
                    old.unlink()


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
