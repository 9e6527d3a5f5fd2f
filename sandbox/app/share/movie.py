"""MP4 files: H.264 with 4:2:0 colours, which every player shows, by the ffmpeg that comes with imageio-ffmpeg."""

import re
import subprocess
import tempfile
from pathlib import Path

import imageio_ffmpeg
import pygame

# Constant quality of x264, 0 (best) to 51, and how long it may think.
QUALITY, PRESET = "20", "veryfast"
# Windows would open a console; an interrupt of the terminal is for the program that asked for the film alone.
_NO_WINDOW = getattr(subprocess, "CREATE_NO_WINDOW", 0)


class MovieWriter:
    """Writes pictures of a size, whose sides are even, into a file, fps of them a second. Raises OSError.

    sound: a WAV file that is heard with them; None: there is none.
    """

    def __init__(self, path: Path, size: tuple[int, int], fps: float, sound: Path | None = None) -> None:
        self._path = path
        self._told = tempfile.TemporaryFile()  # noqa: SIM115
        taken = ["-f", "rawvideo", "-pix_fmt", "bgra", "-s", f"{size[0]}x{size[1]}", "-r", f"{fps:g}", "-i", "-"]
        heard = ["-an"] if sound is None else ["-c:a", "aac", "-b:a", "160k"]
        taken += [] if sound is None else ["-i", str(sound)]
        made = [*heard, "-c:v", "libx264", "-preset", PRESET, "-crf", QUALITY, "-pix_fmt", "yuv420p"]
        command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-v", "error", *taken, *made]
        self._ffmpeg = subprocess.Popen(
            [*command, "-movflags", "+faststart", "-f", "mp4", str(path)], stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL, stderr=self._told, start_new_session=True, creationflags=_NO_WINDOW,
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
        """Have the file ended; whether it is whole."""
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
        self._told.close()
        return True

    def give_up(self) -> None:
        """Write no more."""
        self._ffmpeg.kill()
        self._ffmpeg.wait()
        self._told.close()

    def _refusal(self) -> OSError:
        """What ffmpeg says, in a line: the first thing that it complains of."""
        self._told.seek(0)
        lines = self._told.read().decode(errors="replace").splitlines()
        # Before the words stands which of its parts says them.
        said = [text for line in lines if (text := re.sub(r"^\[[^]]*\] ", "", line).strip())]
        # And before what the system refuses stands what ffmpeg was about.
        reason = said[0].rpartition(": ")[2] if said else "ffmpeg has stopped"
        return OSError(0, reason, str(self._path))
