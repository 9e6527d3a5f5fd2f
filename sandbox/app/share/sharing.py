"""Sharing: keeps the last seconds of a run as a file: what is wanted, the film it is made of, the work, the outcome."""

import contextlib
import tempfile
import time
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Literal

import pygame

from sandbox.app.base.desktop import (
    chosen_path,
    copy_text,
    copying_picture,
    free_path,
    move_new,
    open_path,
    pictures_folder,
    plain_name,
)
from sandbox.app.contracts.application import Application
from sandbox.app.draw.colours import ACCENT, Colour
from sandbox.app.draw.picture import write_png
from sandbox.app.film.film import Film, FilmPair, last_ticks
from sandbox.app.film.kinds import KINDS, Missing, Size, require
from sandbox.app.share.export import Excerpt, Export, Slices
from sandbox.app.widgets.dialogs import Choice, choose
from sandbox.editor.document import empty_level
from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.level.format.level_error import one_line

# How much of a run can be kept [s]; what is chosen at first, its end; and how long the liveliest part is.
REMEMBERED, USUAL, LIVELY = 60.0, 10.0, 5.0
# A film shorter than this [s] is a picture.
SHORTEST_FILM = 0.1
SIZES: tuple[Size, ...] = ((640, 360), (1280, 720))
# The moving preview: its pictures a second, their size, and how many there are at most.
PREVIEW_FPS, PREVIEW_SIZE, MOST_PICTURES = 15.0, (380, 214), 150
# Wall time [s] that a frame may take for the preview, for the work while its page is open, and beside a run.
PREVIEW_BUDGET, OPEN_BUDGET, PLAY_BUDGET = 0.02, 0.1, 0.006
# What files of a level without a name are called.
NAMELESS = "My toy"
# Under what choices are remembered.
KIND, SIZE, NAMED = "share_kind", "share_size", "share_named"

Step = Literal["choose", "work", "done"]


@dataclass(frozen=True)
class Choices:
    """The person's choices: kind, start..end [s of the film], size, whether the level is named, the file's name.

    own_name: whether the name was typed.
    """

    kind: str
    start: float
    end: float
    size: Size
    named: bool
    name: str
    own_name: bool = False


class Sharing:
    """Makes the files that are shared, one at a time; `update` goes on with the present one a slice a frame.

    is_open: whether its page is. film: the run's last seconds, when that was opened. pictures: of the preview, as far
    as there are any. note: what there is to say. done: how much is written, 0..1. saved: the file, once it is there.
    """

    def __init__(self, app: Application) -> None:
        self._app = app
        self.is_open = False
        self.film: Film | FilmPair | None = None
        self.choices = Choices("gif", 0.0, 0.0, SIZES[0], True, "")
        self.pictures: list[pygame.Surface] = []
        self.note = ""
        self.done = 0.0
        self.saved: Path | None = None
        self._export: Export | None = None
        self._slices: Slices | None = None
        self._filming: Iterator[pygame.Surface | None] | None = None
        self._copying: Generator[None, None, bool] | None = None
        self._shown_at = 0.0
        # Of which seconds the preview is, and how many pictures of a second it has.
        self._previewed: tuple[float, ...] = ()
        self._preview_fps = PREVIEW_FPS
        # What waits for the file to be whole.
        self._then: Callable[[], object] | None = None

    @property
    def step(self) -> Step:
        """The step that the page is at."""
        return "work" if self._slices is not None else "choose" if self.saved is None else "done"

    # What the person does.

    def begin(self) -> bool:
        """Take the run's last seconds, where nothing is written at the moment; whether there is anything to share."""
        if self._slices is None:
            play = self._app.play
            if play is None:
                self._app.say("There is nothing to share yet: play a level first.")
                return False
            self.saved, self.note = None, ""
            self._take(play.film(REMEMBERED))
        self._previewed = ()
        self._film_preview()
        self.is_open = True
        return True

    def _take(self, film: Film | FilmPair) -> None:
        self.film = film
        kind, size = preference(KIND), preference(SIZE)
        self.choices = Choices(
            kind if isinstance(kind, str) and kind in KINDS else "gif", max(0.0, film.seconds - USUAL), film.seconds,
            SIZES[1] if size == "large" else SIZES[0], preference(NAMED) is not False, "",
        )  # fmt: skip
        self._say_where()
        if film.seconds < SHORTEST_FILM:
            self.choices = replace(self.choices, kind="png")
            self.note = "Nothing has moved yet, so there is only this picture. Let it play for a few seconds first."
        self._suggest_name()

    def leave(self) -> None:
        """Go back to the run; a file that is being written goes on."""
        self.is_open = False
        self.pictures, self._filming = [], None
        if self._slices is None:
            self._let_go()
        else:
            self._app.say("You can play on while it is written. Share (F12) shows the progress and can cancel it.")

    def choose(self, **changes: object) -> None:
        """Change the choices."""
        self.choices = replace(self.choices, **changes)  # type: ignore[arg-type]
        if self.is_open:
            self._film_preview()
        self._say_where()
        if "kind" in changes:
            set_preference(KIND, self.choices.kind)
            self._suggest_name()
        if "size" in changes:
            set_preference(SIZE, "large" if self.choices.size == SIZES[1] else "small")
        if "named" in changes:
            set_preference(NAMED, self.choices.named)

    def choose_liveliest(self) -> None:
        """Choose the seconds in which the most moved."""
        film, play = self.film, self._app.play
        if film is None or play is None:
            return
        first, last = last_ticks(play.playback.session, film.seconds)
        rate = play.playback.session.world.settings.tick_rate
        start = (play.playback.activity.liveliest(first, last, round(LIVELY * rate)) - first) / rate
        self.choose(start=start, end=min(start + LIVELY, film.seconds))

    def _film_preview(self) -> None:
        """Draw the chosen film again, where its seconds changed."""
        film, choices = self.film, self.choices
        chosen = (0.0, film.seconds) if film is not None and choices.kind == "png" else (choices.start, choices.end)
        if film is None or chosen == self._previewed:
            return
        self._previewed, self.pictures = chosen, []
        self._preview_fps = min(PREVIEW_FPS, MOST_PICTURES / max(chosen[1] - chosen[0], 1e-3))
        self._filming = film.pictures(*chosen, self._preview_fps, PREVIEW_SIZE)

    @property
    def level_name(self) -> str:
        """The level's name, "" where nobody has given it one."""
        name = "" if self.film is None else one_line(self.film.level.name)
        return "" if name == empty_level().name else name

    def _say_where(self) -> None:
        with contextlib.suppress(OSError):
            self.note = f"Goes to {_shown(pictures_folder())}"

    def _suggest_name(self) -> None:
        if self.choices.own_name or self.film is None:
            return
        try:
            name = plain_name(self.level_name or NAMELESS)
            path = free_path(pictures_folder(), name, f".{self.choices.kind}")
        except OSError as error:
            self.note = f"The folder for pictures cannot be made: {error.strerror or error}."
            return
        self.choices = replace(self.choices, name=path.stem)

    def save(self) -> None:
        """Begin to write the chosen file."""
        film, choices = self.film, self.choices
        if film is None or self._slices is not None:
            return
        try:
            require(choices.kind)
            path = chosen_path(pictures_folder(), choices.name, f".{choices.kind}")
        except (Missing, ValueError) as error:
            self._tell(str(error))
            return
        except OSError as error:
            self._tell(f"The folder for pictures cannot be made: {error.strerror or error}.")
            return
        name = self.level_name if choices.named else ""
        excerpt = Excerpt(choices.kind, choices.start, choices.end, KINDS[choices.kind].usual_fps, choices.size, name)
        self._export, self.done, self.saved = Export(film, excerpt, path, move_new), 0.0, None
        self.note = "Play on closes this page: it is written while you play."
        self._slices = self._export.slices()

    def cancel(self) -> None:
        """Stop writing the file, and remove what there is of it."""
        if self._slices is None:
            return
        self._slices.close()
        self._slices, self._export, self.note = None, None, "Cancelled: no file was kept."
        self._then = None

    def if_written(self, then: Callable[[], object]) -> None:
        """Go on, once the person has said what becomes of a file that is being written."""
        if self._export is None or self._slices is None:
            then()
            return
        if self._app.ui.has_question:
            return
        self._then = None
        choices: list[Choice] = [
            ("Finish writing, then close", partial(self._finish, then)),
            ("Close without the file", then),
        ]
        title = f"{self._export.path.name} is still being written"
        choose(self._app.ui, title, f"{100.0 * self.done:.0f} % of it is done.", choices, is_question=True)

    def _finish(self, then: Callable[[], object]) -> None:
        if self._export is None or self._slices is None:
            then()
            return
        self._then = then
        self._tell(f"The window closes once {self._export.path.name} is written.")

    def another(self) -> None:
        """Choose again, of the same seconds."""
        self.saved = None
        self._say_where()
        self.choices = replace(self.choices, own_name=False)
        self._suggest_name()

    def open_folder(self) -> None:
        """Open the file's folder in the system's file manager."""
        if self.saved is not None and not open_path(self.saved.parent):
            self._tell(f"No file manager was found. The folder is {_shown(self.saved.parent)}")

    def open_it(self) -> None:
        """Open the file in what the system has for it: a page in the browser."""
        if self.saved is not None and not open_path(self.saved):
            self._tell(f"Nothing was found that opens it. The file is {_shown(self.saved)}")

    def copy_path(self) -> None:
        """Put the file's path on the clipboard."""
        if self.saved is not None:
            self._tell(
                "The file's path is on the clipboard." if copy_text(str(self.saved)) else "No clipboard was found."
            )

    def _tell(self, text: str) -> None:
        self.note = text
        if not self.is_open:
            self._app.say(text)

    # A frame.

    @property
    def moves(self) -> bool:
        """Whether a file is being written, or the page shows the film."""
        return self.is_open or self._slices is not None or self._copying is not None

    def update(self, frame_time: float) -> None:
        """Let frame_time [s] pass, and go on with the work for a part of it."""
        if self._slices is not None:
            self._work(OPEN_BUDGET if self.is_open or self._then is not None else PLAY_BUDGET)
        elif self._copying is not None:
            self._go_on_copying()
        elif self._then is not None:
            then, self._then = self._then, None
            then()
        elif self.is_open and self._filming is not None:
            self._go_on_filming()
        self._shown_at += frame_time

    def shown_picture(self) -> pygame.Surface | None:
        """The preview's present picture: the film from start to end, over and over."""
        if self._export is not None and self._slices is not None:
            return self._export.picture
        if not self.pictures:
            return None
        choices = self.choices
        at = choices.end
        if choices.kind != "png" and choices.end > choices.start:
            at = self._shown_at % (choices.end - choices.start)
        return self.pictures[min(int(at * self._preview_fps), len(self.pictures) - 1)]

    def status(self) -> list[tuple[str, Colour]]:
        """The status line's words about work beside a run."""
        if self._slices is None or self._export is None or self.is_open:
            return []
        return [(f"writing {self._export.path.name}: {100.0 * self.done:.0f} %", ACCENT)]

    def _go_on_filming(self) -> None:
        assert self._filming is not None
        end = time.perf_counter() + PREVIEW_BUDGET
        for picture in self._filming:
            if picture is not None:
                self.pictures.append(picture.copy())
            if time.perf_counter() > end:
                return
        self._filming = None

    def _work(self, budget: float) -> None:
        assert self._slices is not None and self._export is not None
        end = time.perf_counter() + budget
        try:
            for done in self._slices:
                self.done = done
                if time.perf_counter() > end:
                    return
        except OSError as error:
            self._slices = self._then = None
            self._tell(f"{self._export.path.name} cannot be written: {error.strerror or error}.")
            self._let_go()
            return
        self._slices, self.saved = None, self._export.path
        size = self.saved.stat().st_size / 1e6
        self._tell(f"Saved as {self.saved.name}, {size:.1f} MB, in {_shown(self.saved.parent)}.")
        self._copying = self._put_on_clipboard(self._export)
        self._let_go()

    def _let_go(self) -> None:
        """Keep no film that nobody can see or use any more: it holds the states of seconds."""
        self._export = None
        if not self.is_open:
            self.film = None

    def _put_on_clipboard(self, export: Export) -> Generator[None, None, bool]:
        """The last picture, as a file where the system's tool can read it; else the path."""
        with tempfile.TemporaryDirectory() as folder:
            png = Path(folder) / "picture.png"
            if export.excerpt.kind == "png":
                png = export.path
            elif export.picture is not None:
                write_png(export.picture, png)
            copied = yield from copying_picture(png)
        if copied:
            what = "The picture" if export.excerpt.kind == "png" else "Its last picture"
            self._tell_more(f"{what} is on the clipboard.")
        elif copy_text(str(export.path)):
            self._tell_more("Could not copy the file; its path is copied.")
        return copied

    def _tell_more(self, text: str) -> None:
        self._tell(f"{self.note}\n{text}" if self.is_open else text)

    def _go_on_copying(self) -> None:
        assert self._copying is not None
        try:
            next(self._copying)
        except StopIteration:
            self._copying = None
        except OSError as error:
            self._copying = None
            self._tell_more(f"The clipboard has nothing of it: {error.strerror or error}.")

    # With the app.

    def close(self) -> None:
        """Give everything up, as the app ends."""
        self.cancel()
        if self._copying is not None:
            self._copying.close()


def _shown(folder: Path) -> str:
    """A folder's path as people write it."""
    home = Path.home()
    return str(Path("~") / folder.relative_to(home)) if folder.is_relative_to(home) else str(folder)
