"""Writing a film into a file: PNG, GIF, MP4 or a page that plays it, a slice of the work at a time; whole or not."""

import contextlib
import os
import re
import subprocess
import tempfile
import wave
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pygame

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.picture import write_png
from sandbox.app.film.film import Film, FilmPair, picture_count
from sandbox.app.film.kinds import Size
from sandbox.app.sound.sound_events import SoundEvents
from sandbox.app.sound.sounds import cue_of
from sandbox.app.sound.voices import Mixdown, Voices
from sandbox.app.sound.waves import RATE, Bank
from sandbox.level.format.writing import unfinished, write_file
from sandbox.session.commands import CommandError

# The work, in slices: each gives the part of it that is done, 0..1, the last nothing.
Slices = Generator[float, None, None]


@dataclass(frozen=True)
class Excerpt:
    """The part of a film that is kept: start..end [s from its beginning], of a PNG its end; size [pixels].

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
        self, film: Film | FilmPair, excerpt: Excerpt, path: Path, keep: Callable[[Path, Path], object] = os.replace
    ) -> None:
        self.film, self.excerpt, self.path = film, excerpt, path
        self.picture: pygame.Surface | None = None
        self._count = 1 if excerpt.kind == "png" else picture_count(excerpt.start, excerpt.end, excerpt.fps)
        self._keep = keep

    def slices(self) -> Slices:
        """Do the work. Raises OSError where the file cannot be written, of the file's name."""
        # In the same folder, where it can be renamed; hidden, and of the same kind for programs that look.
        fresh = unfinished(self.path, f".{self.excerpt.kind}")
        writers = {
            "gif": self._write_gif, "mp4": self._write_movie, "png": self._write_still, "html": self._write_page,
        }  # fmt: skip
        write = writers[self.excerpt.kind]
        try:
            # What the folder refuses is said before any work is done.
            fresh.touch()
            yield from write(fresh)
            self._keep(fresh, self.path)
        except OSError as error:
            raise OSError(error.errno or 0, error.strerror or str(error), str(self.path)) from None
        finally:
            with contextlib.suppress(OSError):
                fresh.unlink(missing_ok=True)

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

        excerpt = self.excerpt
        with tempfile.TemporaryDirectory() as folder:
            sound = Path(folder) / "sound.wav"
            _, part = self.film.parts[0]
            for _ in write_soundtrack(part, excerpt.start, excerpt.end, sound):
                yield 0.0
            writer = MovieWriter(path, excerpt.size, excerpt.fps, sound if sound.exists() else None)
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

    def _write_page(self, path: Path) -> Slices:
        """A page that can be taken over; of two runs, and of what such a page cannot play, one that shows what was."""
        film, excerpt = self.film, self.excerpt
        try:
            yield from self._write_playing(path)
        except CommandError:
            yield from self._write_player_page(path)
        # For the clipboard.
        for picture in film.pictures(excerpt.end, excerpt.end, excerpt.fps, excerpt.size, excerpt.name):
            self.picture = picture or self.picture
            yield 1.0

    def _write_playing(self, path: Path) -> Slices:
        from sandbox.app.share.playing import playable_in_slices
        from sandbox.page.page import page_text

        film, excerpt = self.film, self.excerpt
        if not isinstance(film, Film) or film.script is None:
            raise CommandError("only one run, from its beginning, can be taken over")
        begin, end = (film.first + round(at * film.rate) for at in (excerpt.start, excerpt.end))
        made = yield from playable_in_slices(film.level, film.script, max(end, begin + 1), begin)
        write_file(path, page_text(*made).encode())

    def _write_player_page(self, path: Path) -> Slices:
        from sandbox.session.player.page import PlaybackData, PlayerPage, steps_between

        film, excerpt, box = self.film, self.excerpt, np.array(self.film.box)
        ticks = max(1, round((excerpt.end - excerpt.start) * film.rate))
        sides, count = [], len(film.parts)
        for number, (words, part) in enumerate(film.parts):
            side, passed = PlaybackData(words or excerpt.name, film.level, box), 0
            for world in part.states(excerpt.start, excerpt.end):
                if world is not None:
                    if passed % steps_between(ticks, world.particle_count, count) == 0:
                        side.add(world)
                    passed += 1
                yield (number + passed / (ticks + 1)) / count
            sides.append(side)
        PlayerPage(excerpt.name or self.path.stem, box, film.rate, sides).write(path)

    def _pictures(self, write: Callable[[pygame.Surface], object]) -> Slices:
        excerpt, done = self.excerpt, 0
        start = excerpt.end if excerpt.kind == "png" else excerpt.start
        for picture in self.film.pictures(start, excerpt.end, excerpt.fps, excerpt.size, excerpt.name):
            if picture is not None:
                write(picture)
                self.picture = picture
                done += 1
            yield done / self._count


# Constant quality of x264, 0 (best) to 51, and how long it may think.
QUALITY, PRESET = "20", "veryfast"
# Windows would open a console; an interrupt of the terminal is for the program that asked for the film alone.
_NO_WINDOW = getattr(subprocess, "CREATE_NO_WINDOW", 0)


class MovieWriter:
    """Writes pictures of a size, whose sides are even, into a file, fps of them a second. Raises OSError.

    sound: a WAV file that is heard with them; None: there is none.
    """

    def __init__(self, path: Path, size: tuple[int, int], fps: float, sound: Path | None = None) -> None:
        import imageio_ffmpeg

        self._path = path
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115
        taken = ["-f", "rawvideo", "-pix_fmt", "bgra", "-s", f"{size[0]}x{size[1]}", "-r", f"{fps:g}", "-i", "-"]
        heard = ["-an"] if sound is None else ["-c:a", "aac", "-b:a", "160k"]
        taken += [] if sound is None else ["-i", str(sound)]
        made = [*heard, "-c:v", "libx264", "-preset", PRESET, "-crf", QUALITY, "-pix_fmt", "yuv420p"]
        command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-v", "error", *taken, *made]
        self._ffmpeg = subprocess.Popen(
            [*command, "-movflags", "+faststart", "-f", "mp4", str(path)], stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL, stderr=self._errors, start_new_session=True, creationflags=_NO_WINDOW,
        )  # fmt: skip

    def add(self, surface: pygame.Surface) -> None:
        """Write the next picture."""
        assert self._ffmpeg.stdin is not None
        try:
            self._ffmpeg.stdin.write(surface.get_buffer().raw)
        except OSError:
            self._ffmpeg.wait()
            raise self._refusal() from None

    def is_closed(self) -> bool:
        """Close the encoder's input; whether the file is whole by now."""
        assert self._ffmpeg.stdin is not None
        if not self._ffmpeg.stdin.closed:
            try:
                self._ffmpeg.stdin.close()
            except OSError:
                self._ffmpeg.wait()
        if self._ffmpeg.poll() is None:
            return False
        if self._ffmpeg.returncode != 0:
            raise self._refusal()
        self._errors.close()
        return True

    def give_up(self) -> None:
        """Write no more."""
        self._ffmpeg.kill()
        self._ffmpeg.wait()
        self._errors.close()

    def _refusal(self) -> OSError:
        """The first line of ffmpeg's complaints."""
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").splitlines()
        # Before the words stands which of its parts says them.
        said = [text for line in lines if (text := re.sub(r"^\[[^]]*\] ", "", line).strip())]
        # And before what the system refuses stands what ffmpeg was about.
        reason = said[0].rpartition(": ")[2] if said else "ffmpeg has stopped"
        return OSError(0, reason, str(self._path))


# What is never louder than this share of full scale is silence.
SILENCE = 1e-3
# Of this shape a picture is, as to where on it a sound is heard.
_SIZE = (1280, 720)


def write_soundtrack(film: Film, start: float, end: float, path: Path) -> Iterator[None]:
    """Write what is heard from start to end [s] of a film, a tick at a time; where nothing is, there is no file."""
    camera = Camera(viewport=(0, 0, *_SIZE))
    camera.fit(film.box)
    events, bank, mixdown = SoundEvents(), Bank(), Mixdown()
    voices = Voices(mixdown, bank)
    for world in film.states(start, end):
        if world is not None:
            events.hear(world)
            heard, events.heard = events.heard, []
            voices.play([cue_of(each, camera) for each in heard], mixdown.now)
            voices.hum([cue_of(each, camera) for each in events.motors(world)], mixdown.now)
            mixdown.advance(1.0 / film.rate)
        yield
    mixed = mixdown.mixed
    if not len(mixed) or float(np.abs(mixed).max()) < SILENCE:
        return
    with wave.open(str(path), "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes((np.clip(mixed, -1.0, 1.0) * 32767.0).astype("<i2").tobytes())
