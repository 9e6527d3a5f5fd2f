"""Recordings, scenes and pictures of runs: the folders that they are kept in, and names that overwrite nothing."""

import datetime
import os
import re
import unicodedata
from pathlib import Path

import platformdirs

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


def told_time(when: datetime.datetime) -> str:
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


def move_new(path: Path, wanted: Path) -> None:
    """Give a file another name, never that of a file that is there. Raises OSError."""
    try:
        # A link appears only where nothing is yet: no other program's file is lost in between.
        os.link(path, wanted)
    except FileExistsError:
        raise
    except (OSError, NotImplementedError):  # a file system without links
        path.rename(wanted)
    else:
        path.unlink()
