"""The system around the window: its clipboard and file manager, and folders and names for a person's files."""

import datetime
import os
import re
import shutil
import subprocess
import sys
import time
import unicodedata
from collections.abc import Generator
from pathlib import Path

import platformdirs
import pygame


def copy_text(text: str) -> bool:
    """Put a text on the system's clipboard; whether it took it."""
    try:
        pygame.scrap.put_text(text)
    except pygame.error:
        return False
    return True


def copied_text() -> str:
    """The text on the system's clipboard; nothing where there is none."""
    try:
        return pygame.scrap.get_text() if pygame.scrap.has_text() else ""
    except pygame.error:
        return ""


def copying_picture(png: Path) -> Generator[None, None, bool]:
    """Put the picture of a PNG file on the system's clipboard, in slices; in the end whether a tool there did it."""
    tool = _clipboard_tool()
    if tool is None:
        return False
    command, reads = tool
    try:
        with open(png if reads else os.devnull, "rb") as source:
            # What a tool leaves behind to serve the clipboard must not keep pipes of ours open.
            running = subprocess.Popen(
                command, stdin=source, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                env={**os.environ, "SANDBOX_PICTURE": str(png)},
            )  # fmt: skip
    except OSError:
        return False
    end = time.monotonic() + PATIENCE
    while running.poll() is None:
        if time.monotonic() > end:
            running.kill()
            running.wait()
            return False
        yield
    return running.returncode == 0


# How long a tool of the system may take [s].
PATIENCE = 8.0
_POWERSHELL = (
    "Add-Type -AssemblyName System.Windows.Forms, System.Drawing;"
    "$picture = [System.Drawing.Image]::FromFile($env:SANDBOX_PICTURE);"
    "[System.Windows.Forms.Clipboard]::SetDataObject($picture, $true)"
)
_APPLESCRIPT = 'set the clipboard to (read (POSIX file (system attribute "SANDBOX_PICTURE")) as «class PNGf»)'


def _clipboard_tool() -> tuple[list[str], bool] | None:
    """The command that puts a PNG on the clipboard, and whether it reads it as its input; None where there is none."""
    if sys.platform == "win32":
        choices = [(["powershell", "-NoProfile", "-STA", "-Command", _POWERSHELL], False)]
    elif sys.platform == "darwin":
        choices = [(["osascript", "-e", _APPLESCRIPT], False)]
    else:
        choices = [(["xclip", "-selection", "clipboard", "-t", "image/png"], True)]
        if os.environ.get("WAYLAND_DISPLAY"):
            choices.insert(0, (["wl-copy", "--type", "image/png"], True))
    return next((choice for choice in choices if shutil.which(choice[0][0])), None)


def open_path(path: Path) -> bool:
    """Open a folder in the system's file manager, or a file in what the system has for it; whether there is that."""
    if sys.platform == "win32":
        try:
            os.startfile(path)
        except OSError:  # no program has its kind
            return False
        return True
    opener = shutil.which("open" if sys.platform == "darwin" else "xdg-open")
    if opener is None:
        return False
    try:
        subprocess.Popen(
            [opener, str(path)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True,
        )  # fmt: skip
    except OSError:
        return False
    return True


SUFFIX = ".replay.jsonl"
# Most recordings that the list shows, newest first.
LISTED = 60
# Longest name [characters] that every file system takes with the suffix.
NAME_LIMIT = 120
# What no name of a file has in it.
FORBIDDEN = r'[\\/:*?"<>|\x00-\x1f]'


def recordings_folder() -> Path:
    """The folder of the person's recordings, made where it is missing. Raises OSError."""
    folder = Path(platformdirs.user_documents_dir()) / "Spring Sandbox"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def pictures_folder() -> Path:
    """The folder of what the person shares, made where it is missing. Raises OSError."""
    folder = Path(platformdirs.user_pictures_dir()) / "Spring Sandbox"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def saved_recordings() -> list[Path]:
    """Recordings in the folder, newest first."""
    try:
        found = [*recordings_folder().glob(f"*{SUFFIX}"), *recordings_folder().glob(f"*{SUFFIX}.gz")]
        return sorted(found, key=lambda path: path.stat().st_mtime, reverse=True)[:LISTED]
    except OSError:
        return []


def plain_name(text: str) -> str:
    """A file name made of the letters and digits of a level's name, in any script."""
    # Marks, M, are parts of letters: most vowels of Hindi are.
    kept = (each if each.isalnum() or unicodedata.category(each)[0] == "M" else " " for each in text.lower())
    return "-".join("".join(kept).split())[:60].strip("-") or "run"


def readable_name(text: str) -> str:
    """A file name made of a level's name, as it is read, without what no file may have in its name."""
    return re.sub(rf"{FORBIDDEN}+", " ", text).strip(". ")[:60].strip() or "Scene"


def when_text(when: datetime.datetime) -> str:
    """A time as a person says it today: the day is left out where it is this one."""
    here = when.astimezone()
    is_today = here.date() == datetime.datetime.now(datetime.UTC).astimezone().date()
    return f"{here:%H:%M}" if is_today else f"{here:%d %b, %H:%M}"


def free_path(folder: Path, name: str, suffix: str = SUFFIX) -> Path:
    """A path in the folder that nothing has: name, then name-2, name-3, ..."""
    count = 1
    while True:
        path = folder / f"{name if count == 1 else f'{name}-{count}'}{suffix}"
        if not path.exists():
            return path
        count += 1


def chosen_path(folder: Path, typed: str, suffix: str = SUFFIX) -> Path:
    """The path for a name that was typed. Raises ValueError with one line where it cannot be used."""
    name = typed.removesuffix(suffix).strip()
    if not name:
        raise ValueError("Type a name.")
    if len(name) > NAME_LIMIT or re.search(FORBIDDEN, name) or name.startswith("."):
        raise ValueError(
            'A name has no / \\ : * ? " < > | in it, does not begin with a dot and is not longer than 120.'
        )
    path = folder / f"{name}{suffix}"
    if path.exists():
        raise ValueError(f"{path.name} exists already. Choose another name.")
    return path


def move_new(path: Path, target: Path) -> None:
    """Give a file another name, never that of a file that is there. Raises OSError."""
    try:
        # A link appears only where nothing is yet: no other program's file is lost in between.
        os.link(path, target)
    except FileExistsError:
        raise
    except (OSError, NotImplementedError):  # a file system without links
        path.rename(target)
    else:
        path.unlink()
