"""Small pictures of levels, drawn once for each content of a level file: shipped, or kept in the user's cache folder.

`python -m sandbox.app.draw.picture_cache` draws those that are shipped (`make pictures`).
"""

import contextlib
import hashlib
import os
from collections.abc import Generator
from pathlib import Path

import platformdirs
import pygame

from sandbox.app.base.recent_pictures import RecentPictures
from sandbox.app.draw.colours import THEME_NAMES, ThemeName
from sandbox.app.draw.picture import crop_of, draw_picture, run_ahead
from sandbox.level.document.model import Level
from sandbox.level.format.slices import at_once
from sandbox.level.format.writing import unfinished
from sandbox.level.reading.files import read_level, shipped_folder, shipped_levels

# Every picture's size [pixels]: that of a card at scale 2, and twice that at scale 1.
SIZE = (576, 324)
# Thickness of lines in them.
LINE_SCALE = 1.4
# They show the level after this time [s], or it would hang in mid-air where it was built.
SECONDS = 0.8
# Levels of more particles than this are drawn as they are built: the gallery stays quick.
PARTICLES = 3000
# Rises when the same level is drawn otherwise.
VERSION = 4
# Pictures that are kept, those used last.
KEPT = 300
# What pictures in the size of cards may take in memory [bytes]: 170 at scale 1, and a page of them at scale 4.
HELD = 32_000_000
# How pictures are written: a fifth of the bytes of a PNG file.
SUFFIX = ".jpg"


def picture_key(content: bytes) -> str:
    """The name of the picture of a level file's content."""
    # Git may have given the file the line ends of the system.
    text = content.replace(b"\r\n", b"\n")
    return hashlib.blake2b(text, digest_size=8, person=f"{VERSION} {SIZE[0]}x{SIZE[1]}".encode()).hexdigest()


def shipped_picture(level: Path, key: str, theme: ThemeName) -> Path:
    """Where the picture of a shipped level in a theme lies."""
    return shipped_folder("assets") / "pictures" / f"{level.stem}-{theme}-{key}{SUFFIX}"


def kept_picture(key: str, theme: ThemeName) -> Path:
    """The path of the kept picture of a level that is not shipped, in a theme."""
    folder = Path(platformdirs.user_cache_dir("spring-sandbox", appauthor=False)) / "pictures"
    return folder / f"{key}-{theme}{SUFFIX}"


def find_picture(level: Path, key: str, size: tuple[int, int], theme: ThemeName) -> pygame.Surface | None:
    """The picture of a level file in a size [pixels] and a theme, where there is one."""
    for path in (shipped_picture(level, key, theme), kept_picture(key, theme)):
        with contextlib.suppress(OSError, pygame.error):
            return read_picture(path, size)
    return None


# Each in the size that was asked for last: a window has cards of another size once its own is another.
_held: RecentPictures[Path] = RecentPictures(HELD)


def read_picture(path: Path, size: tuple[int, int]) -> pygame.Surface:
    """The picture of a file in a size. Raises OSError and pygame.error."""
    picture = _held.find(path)
    if picture is None or picture.get_size() != size:
        _held.forget(path)
        with path.open("rb") as file:
            picture = pygame.transform.smoothscale(pygame.image.load(file, path.name).convert(32), size)
        _held.keep(path, picture)
    return picture


def draw_in_slices(level: Level, theme: ThemeName, seconds: float = SECONDS) -> Generator[bool, None, pygame.Surface]:
    """Draw a level after this many seconds, a slice of the work at a time; the picture is what it gives in the end.

    theme: what it is drawn in, where the level itself asks for none.
    """
    snapshot = yield from run_ahead(level, round(seconds * level.settings.tick_rate), PARTICLES)
    yield True
    asked = None if level.look is None else level.look.theme
    return draw_picture(level, snapshot, SIZE, crop_of(level, snapshot), LINE_SCALE, asked or theme)


def keep_picture(picture: pygame.Surface, path: Path) -> None:
    """Write a picture, whole or not at all. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = unfinished(path, SUFFIX)
    try:
        pygame.image.save(picture, str(fresh))
        os.replace(fresh, path)
    except pygame.error as error:
        raise OSError(0, str(error), str(path)) from None
    finally:
        fresh.unlink(missing_ok=True)
    _held.forget(path)


def keep_for_later(picture: pygame.Surface, path: Path) -> None:
    """Keep a picture that can be drawn again, where that can be, in place of the oldest ones."""
    with contextlib.suppress(OSError):
        keep_picture(picture, path)
        forget_old_pictures(path.parent)


def forget_old_pictures(folder: Path) -> None:
    """Remove all but the newest pictures of a folder."""
    with contextlib.suppress(OSError):
        files = sorted(folder.glob("*.*"), key=lambda path: path.stat().st_mtime, reverse=True)
        for file in files[KEPT:]:
            file.unlink(missing_ok=True)


def stale_pictures() -> tuple[dict[Path, tuple[Path, ThemeName]], list[Path]]:
    """Pictures of shipped levels that are missing, each with its level and theme; and pictures of nothing."""
    needed: dict[Path, tuple[Path, ThemeName]] = {
        shipped_picture(level, picture_key(level.read_bytes()), name): (level, name)
        for level in shipped_levels()
        for name in THEME_NAMES
    }
    there = set((shipped_folder("assets") / "pictures").glob("*.*"))
    missing = {path: of for path, of in needed.items() if path not in there}
    return missing, sorted(there - set(needed))


def draw_shipped_pictures() -> None:
    """Draw the pictures of shipped levels that are missing, and remove those of nothing."""
    missing, unused = stale_pictures()
    for path in unused:
        path.unlink()
    for path, (level, theme) in missing.items():
        keep_picture(at_once(draw_in_slices(read_level(level), theme)), path)
        print(path.name)


if __name__ == "__main__":
    draw_shipped_pictures()
