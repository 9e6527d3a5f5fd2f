"""Writing a film into a file: PNG, GIF or MP4, a slice of the work at a time, whole or not at all."""

import contextlib
import os
from collections.abc import Callable, Generator
from dataclasses import dataclass
from pathlib import Path

import pygame

from sandbox.app.draw.picture import write_png
from sandbox.app.share.film import Film, picture_count
from sandbox.app.share.kinds import Size

# The work, in slices: each gives the part of it that is done, 0..1, the last nothing.
Slices = Generator[float, None, None]


@dataclass(frozen=True)
class Excerpt:
    """What is kept of a film: start..end [s from its beginning], of a PNG its end; size [pixels].

    name: a text in the corner of every picture.
    """

    kind: str
    start: float
    end: float
    fps: float
    size: Size
    name: str = ""


class Export:
    """An excerpt that is being written; `slices` does the work, closing them gives it up and leaves no file.

    keep: gives the finished file, which is the first, its name, the second. picture: the one written last.
    """

    def __init__(
        self, film: Film, excerpt: Excerpt, path: Path, keep: Callable[[Path, Path], object] = os.replace
    ) -> None:
        self.film, self.excerpt, self.path = film, excerpt, path
        self.picture: pygame.Surface | None = None
        self._count = 1 if excerpt.kind == "png" else picture_count(excerpt.start, excerpt.end, excerpt.fps)
        self._keep = keep

    def slices(self) -> Slices:
        """Do the work. Raises OSError where the file cannot be written, of the file's name."""
        # In the same folder, where it can be renamed; hidden, and of the same kind for programs that look.
        unfinished = self.path.with_name(f".{self.path.stem[:80]}-{os.getpid()}.{self.excerpt.kind}")
        write = {"gif": self._write_gif, "mp4": self._write_movie, "png": self._write_still}[self.excerpt.kind]
        try:
            # What the folder refuses is said before any work is done.
            unfinished.touch()
            yield from write(unfinished)
            self._keep(unfinished, self.path)
        except OSError as error:
            raise OSError(error.errno or 0, error.strerror or str(error), str(self.path)) from None
        finally:
            with contextlib.suppress(OSError):
                unfinished.unlink(missing_ok=True)

    def _write_gif(self, path: Path) -> Slices:
        from sandbox.app.share.gif import GifWriter

        excerpt = self.excerpt
        with path.open("wb") as file:
            yield 0.0
            samples = self.film.samples(excerpt.start, excerpt.end, excerpt.size, excerpt.name)
            writer = GifWriter(file, excerpt.size, excerpt.fps, samples, self._count)
            yield from self._pictures(writer.add)
            writer.close()

    def _write_movie(self, path: Path) -> Slices:
        from sandbox.app.share.movie import MovieWriter

        writer = MovieWriter(path, self.excerpt.size, self.excerpt.fps)
        try:
            yield from self._pictures(writer.add)
            while not writer.is_closed():
                yield 1.0
        finally:
            writer.give_up()

    def _write_still(self, path: Path) -> Slices:
        yield from self._pictures(lambda picture: None)
        assert self.picture is not None
        write_png(self.picture, path)

    def _pictures(self, write: Callable[[pygame.Surface], object]) -> Slices:
        excerpt, done = self.excerpt, 0
        start = excerpt.end if excerpt.kind == "png" else excerpt.start
        for picture in self.film.pictures(start, excerpt.end, excerpt.fps, excerpt.size, excerpt.name):
            if picture is not None:
                write(picture)
                self.picture = picture
                done += 1
            yield done / self._count
