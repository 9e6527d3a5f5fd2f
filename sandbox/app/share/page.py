"""SharePage: what of the last seconds is kept, and as what; how far it is; or a link to the run, on the clipboard."""

from collections.abc import Callable, Generator, Iterator
from typing import Any

import pygame

from sandbox.app.base.desktop import copy_text
from sandbox.app.contracts.application import Application
from sandbox.app.draw.colours import ACCENT, BACKGROUND, LINE, TEXT, Colour
from sandbox.app.film.film import Film, FilmPair
from sandbox.app.share.runs_for_pages import link_to
from sandbox.app.share.sharing import LIVELY, SHORTEST_FILM, SIZES, Sharing
from sandbox.app.widgets.boxes import ProgressBar
from sandbox.app.widgets.dialogs import MARGIN, Dialog
from sandbox.app.widgets.slider import RangeSlider
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.level.format.slices import telling, work_for
from sandbox.physics.snapshot import state_hash
from sandbox.session.commands.records import script_of
from sandbox.session.replay.link import run_of
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session

# Sizes in layout units.
WIDTH, HEIGHT = 740.0, 424.0
TOP, GAP = 56.0, 22.0
ROW, LABEL, AFTER_ROW = 32.0, 19.0, 7.0
BUTTON_WIDTH, BUTTON = 124.0, 36.0
SLIDER, CAPTION = 32.0, 18.0
# The part of the width that the preview has, and its shape.
PREVIEW_PART, SHAPE = 0.55, 9 / 16
KINDS = (
    ("html", "Page", "One file for a browser: play it there, take it over, save what you did"),
    ("gif", "GIF", "Plays everywhere, over and over"),
    ("mp4", "MP4", "A film: sharper and smaller, for chats and players"),
    ("png", "PNG", "One picture, of the moment that you choose"),
)
LINK = ("link", "Link", "The whole run as an address: it opens on a page of this level")
SIZE_NAMES = [(f"{width}x{height}", f"{width} x {height}", "") for width, height in SIZES]
NAMED = (("yes", "Shown", "Small, in the corner"), ("no", "Hidden", "Nothing but the run"))


class SharePage:
    """The page, open or not; it follows what becomes of `sharing`.

    page: what is on it while it is open; after that nothing is kept of the window that it was in.
    """

    def __init__(self, app: Application, sharing: Sharing, copy_link: Callable[[], None]) -> None:
        self._app, self._sharing, self._copy_link = app, sharing, copy_link
        self.page: ShareForm | None = None

    def open(self) -> None:
        """Show the page, where there is something to share."""
        if self.page is None and self._sharing.begin():
            self._build(self._app.ui)

    def leave(self) -> None:
        """Go back to the run; a file that is being written goes on."""
        self._close()
        self._sharing.leave()

    def _close(self) -> None:
        if self.page is not None:
            self.page.sheet.remove()
            self.page = None

    def _build(self, ui: Ui) -> None:
        self.page = ShareForm(ui, self._sharing, self.leave, self._build, self._link)

    def _link(self) -> None:
        self.leave()
        self._copy_link()

    def update(self) -> None:
        """Show what has changed."""
        if self.page is None:
            return
        if not self.page.sheet.is_there:
            # The screen under it was left, and the page with it.
            self.page = None
            self._sharing.leave()
            return
        if self.page.step != self._sharing.step and not self._app.ui.has_question:
            self._close()
            self._build(self._app.ui)
        self.page.update()


class ShareForm:
    """The form of one step of sharing, in one window; reopen: called where it is laid out again."""

    def __init__(
        self, ui: Ui, sharing: Sharing, leave: Callable[[], None], reopen: Callable[[Ui], None],
        copy_link: Callable[[], None],
    ) -> None:  # fmt: skip
        self._ui, self._sharing, self._leave, self._copy_link = ui, sharing, leave, copy_link
        self.step = sharing.step
        self._seen: tuple[object, ...] = ()
        dialog = Dialog(ui, _title(sharing.film), WIDTH, HEIGHT, reopen, leave, is_page=True)
        self.sheet, self._box, self._width, self._height = dialog.sheet, dialog.box, dialog.width, dialog.height
        self._build_preview()
        {"choose": self._build_choices, "work": self._build_work, "done": self._build_outcome}[self.step]()

    def update(self) -> None:
        """Show what has changed."""
        sharing = self._sharing
        seen = (sharing.choices, sharing.note)
        if seen != self._seen:
            self._seen = seen
            self._refresh()
        self.preview.show_picture(sharing.shown_picture())
        if self.step == "work":
            self.bar.show_fraction(sharing.done)

    # Building.

    def _build_preview(self) -> None:
        ui = self._ui
        available = self._width - 2 * MARGIN - GAP
        wide = available * PREVIEW_PART
        tall = min(wide * SHAPE, self._height - TOP - SLIDER - CAPTION - BUTTON - MARGIN - 14)
        self._right, self._side = MARGIN + wide + GAP, available - wide
        # Of the shape of what is kept, also where a low window leaves it less height.
        self.preview = FilmPreview(ui, ui.rect(MARGIN, TOP, tall / SHAPE, tall), self._box)
        self._below = TOP + tall
        self.slider: RangeSlider | None = None

    def _row(self, text: str, top: float) -> pygame.Rect:
        self._ui.label(self._ui.rect(self._right, top, self._side, LABEL), text, self._box, "muted")
        return self._ui.rect(self._right, top + LABEL, self._side, ROW)

    def _build_choices(self) -> None:
        ui, sharing, step = self._ui, self._sharing, LABEL + ROW + AFTER_ROW
        film = sharing.film
        assert film is not None
        place = ui.rect(MARGIN, self._below + 6 + CAPTION, self._preview_width, SLIDER)
        self.caption = ui.label(
            ui.rect(MARGIN, self._below + 6, self._preview_width, CAPTION), "", self._box, "muted"
        )  # fmt: skip
        self.kinds = ui.choice(self._row("Format", TOP - 4), [*KINDS, LINK], self._choose_kind, self._box)
        self.sizes = ui.choice(self._row("Size", TOP - 4 + step), SIZE_NAMES, self._choose_size, self._box)
        self.named = ui.choice(
            self._row("Show the level's name", TOP - 4 + 2 * step), NAMED,
            lambda value: sharing.choose(named=value == "yes"), self._box,
        )  # fmt: skip
        for button in self.named.buttons.values():
            button.is_enabled = bool(sharing.level_name)
        row = self._row("File name", TOP - 4 + 3 * step)
        row.width -= ui.px(44)
        self.field = ui.field(row, sharing.choices.name, self._type_name, self._box, 120)
        self.field.enter = self._save_as
        self.suffix = ui.label(pygame.Rect(row.right + ui.px(6), row.top, ui.px(40), row.height), "", self._box)
        if film.seconds >= SHORTEST_FILM:
            self.slider = RangeSlider(ui, place, film.seconds, self._choose_range, self._box)
            if film.seconds > LIVELY:
                wide = 92.0
                spot = ui.rect(MARGIN + self._preview_width - wide, self._below + 2, wide, 24)
                tip = f"The {LIVELY:g} seconds in which the most moved"
                self.caption.resize((spot.left - self.caption.place.left, self.caption.place.height))
                ui.button(spot, f"Liveliest {LIVELY:g} s", sharing.choose_liveliest, self._box, style="quiet", tip=tip)
        else:
            for kind in ("gif", "mp4", "html"):
                self.kinds.buttons[kind].is_enabled = False
        self._build_note(TOP + 4 * step)
        self._add_button("Save", self._save, 0, "primary")
        self._add_button("Close", self._leave, 1)

    @property
    def _preview_width(self) -> float:
        return self._right - GAP - MARGIN

    def _build_note(self, top: float) -> None:
        # Beside the buttons on the left, where there is nothing else, up to the end of the page.
        bottom = self._height - MARGIN - BUTTON - 8
        place = self._ui.rect(self._right, top, self._side, max(bottom - top, 18))
        if self.step == "choose":
            # Left of both buttons.
            wide = min(self._preview_width, self._width - 2 * MARGIN - 2 * BUTTON_WIDTH - 20)
            place = self._ui.rect(MARGIN, self._height - MARGIN - BUTTON, wide, BUTTON + 14)
        self.note = TextBlock(self._ui, place, "", self._box, 12.0, TEXT)

    def _build_work(self) -> None:
        ui, sharing = self._ui, self._sharing
        kind = sharing.choices.kind
        name = f"Writing {sharing.choices.name}.{kind}"
        ui.label(ui.rect(self._right, TOP - 4, self._side, 26), name, self._box)
        self.bar = ProgressBar(ui, ui.rect(self._right, TOP + 30, self._side, 10), self._box)
        self._build_note(TOP + 54)
        self._add_button("Cancel", sharing.cancel, 0)
        self._add_button("Play on", self._leave, 1, tip="You can play on while it is written")

    def _build_outcome(self) -> None:
        sharing, ui = self._sharing, self._ui
        self._build_note(TOP - 2)
        top = self._height - MARGIN - 3 * BUTTON - 24
        ui.button(ui.rect(self._right, top, self._side, BUTTON), "Open it", sharing.open_it, self._box)
        half = (self._side - 10) / 2
        actions = ("Open folder", sharing.open_folder), ("Copy path", sharing.copy_path)
        for index, (text, action) in enumerate(actions):
            place = ui.rect(self._right + index * (half + 10), top + BUTTON + 10, half, BUTTON)
            ui.button(place, text, action, self._box)
        self.note.resize((ui.px(self._side), ui.px(top - TOP - 8)))
        self.note.repaint()
        self._add_button("Close", self._leave, 0, "primary")
        self._add_button("Another", sharing.another, 1, tip="Of the same seconds")

    def _add_button(self, text: str, action: Any, place: int, style: str = "", tip: str = "") -> None:
        x = self._width - MARGIN - (place + 1) * BUTTON_WIDTH - place * 10
        rect = self._ui.rect(x, self._height - MARGIN - BUTTON, BUTTON_WIDTH, BUTTON)
        button = self._ui.button(rect, text, action, self._box, style=style, tip=tip)
        if place == 0:
            self._ui.focus_on(button)

    # What the person does.

    def _choose_kind(self, kind: str) -> None:
        if kind == "link":
            self._copy_link()
        else:
            self._sharing.choose(kind=kind)

    def _choose_size(self, text: str) -> None:
        width, height = text.split("x")
        self._sharing.choose(size=(int(width), int(height)))

    def _choose_range(self, start: float, end: float) -> None:
        self._sharing.choose(start=start, end=end)

    def _type_name(self, text: str) -> bool:
        self._sharing.choose(name=text.strip(), own_name=True)
        return True

    def _save_as(self, text: str) -> None:
        self._type_name(text)
        self._sharing.save()

    def _save(self) -> None:
        self.field.finish()
        self._sharing.save()

    def _refresh(self) -> None:
        sharing, choices = self._sharing, self._sharing.choices
        self.note.show_text(sharing.note)
        if self.step != "choose":
            return
        self.kinds.show(choices.kind)
        self.sizes.show(f"{choices.size[0]}x{choices.size[1]}")
        for button in self.sizes.buttons.values():
            button.is_enabled = choices.kind != "html"
        self.named.show("yes" if choices.named and self._sharing.level_name else "no")
        self.field.show(choices.name)
        self.suffix.show_text(f".{choices.kind}")
        film = sharing.film
        if self.slider is not None and film is not None:
            is_still = choices.kind == "png"
            self.slider.show_range(choices.start, choices.end, is_still)
            ago = film.seconds - choices.end
            when = "the last moment" if ago < 0.05 else f"{ago:.1f} s before the last moment"
            text = f"The picture: {when}" if is_still else f"{choices.end - choices.start:.1f} s, to {when}"
            self.caption.show_text(text)


def _title(film: Film | FilmPair | None) -> str:
    """The page's title: how many seconds there are to share, and whether they are the latest."""
    if film is None or film.seconds < 2.0:
        return "Share"
    return f"Share some of {'the last ' if film.is_latest else ''}{film.seconds:.0f} seconds"


class FilmPreview(Widget):
    """A moving preview of the chosen film; nothing but a frame at first."""

    def __init__(self, ui: Ui, rect: pygame.Rect, container: Any) -> None:
        super().__init__(ui, rect, container)
        self.picture: pygame.Surface | None = None
        self.repaint()

    def show_picture(self, picture: pygame.Surface | None) -> None:
        """Show another picture, which may have been drawn on again."""
        if picture is not None:
            self.picture = picture
            self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The present picture, as large as it fits, in a frame."""
        surface = pygame.Surface(size, pygame.SRCALPHA)
        surface.fill(BACKGROUND)
        if self.picture is not None:
            wide, tall = self.picture.get_size()
            part = min(size[0] / wide, size[1] / tall)
            scaled = pygame.transform.smoothscale(self.picture, (round(wide * part), round(tall * part)))
            surface.blit(scaled, scaled.get_rect(center=surface.get_rect().center))
        pygame.draw.rect(surface, LINE, surface.get_rect(), 1)
        return surface


# Wall time [s] of a frame.
_BUDGET = 0.02
NO_SITE = "sandbox open plays it. With the address of a site in the settings, any browser does."


class LinkCopying:
    """Copies links, one at a time; `update` goes on with the present one a slice a frame."""

    def __init__(self, app: Application) -> None:
        self._app = app
        self._work: Iterator[None] | None = None
        self._done = 0.0

    def begin(self) -> None:
        """Begin with the run so far: a link to the site of the settings, or else for `sandbox open`."""
        play = self._app.play
        if play is None:
            self._app.say("There is nothing to share yet: play a level first.")
        else:
            self._work = self._make(link_to(so_far(play.playback.session), self._app.chosen["link_site"], 0))

    def status(self) -> list[tuple[str, Colour]]:
        """The status line's words about the work."""
        return [] if self._work is None else [(f"making the link: {100.0 * self._done:.0f} %", ACCENT)]

    @property
    def moves(self) -> bool:
        """Whether a link is being made."""
        return self._work is not None

    def update(self) -> None:
        """Go on with the work for a part of a frame."""
        if self._work is not None and work_for(self._work, _BUDGET):
            self._work = None

    def _make(self, slices: Generator[float, None, str]) -> Iterator[None]:
        try:
            self._copy((yield from telling(slices, self._show)))
        except ReplayError as error:
            self._app.say(f"No link: {error.faults[0].removeprefix('the run: ')}.")

    def _show(self, done: float) -> None:
        self._done = done

    def _copy(self, link: str) -> None:
        copied = copy_text(link)
        said = f"The link is copied, {len(link):,} characters." if copied else "No clipboard was found."
        self._app.say(said if "://" in link or not copied else f"{said} {NO_SITE}")


def so_far(session: Session) -> Replay:
    """The run of a session until its present tick; what was undone is left out."""
    entries = [entry for entry in session.history.timeline if entry.in_effect and entry.tick <= session.tick]
    script = script_of(entries, session.world)
    return run_of("the run", session.level, script, session.tick, state_hash(session.world))
