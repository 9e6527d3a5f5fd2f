"""Gallery: levels as cards with pictures, and saved recordings as a list."""

import json
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import pygame

from sandbox.app.application import Application
from sandbox.app.draw.colours import ACCENT, BACKGROUND, DANGER, LINE, MUTED, SURFACE, TEXT
from sandbox.app.picture_cache import (
    SECONDS,
    draw_in_slices,
    find_picture,
    forget_old_pictures,
    keep_picture,
    kept_picture,
    picture_key,
)
from sandbox.app.recordings import saved_recordings
from sandbox.app.widgets.painted import Lit, Pressable, wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.editor.storage.recent import recent_levels
from sandbox.level.faults.level_error import LevelError, one_line
from sandbox.level.format.files import parse_level, read_bytes, shipped_levels
from sandbox.physics.jit import COMPILED

# Sizes in layout units.
CARD_WIDTH = 250.0
PICTURE_RATIO = 9 / 16
TEXT_HEIGHT = 74.0
GAP = 20.0
TOP = 92.0
MARGIN = 36.0
ROW_HEIGHT = 52.0
WHEEL_STEP = 70.0
NEW_TIP = "Draw a level of your own, from an empty sheet"
# What is shown, a page each, and its name.
SECTIONS = (("levels", "Levels", ""), ("mine", "My levels", ""), ("recordings", "Replays", ""))
# Wall time [s] of a frame that cards are filled in.
FILL_BUDGET = 0.02
# What comes first while the physics is being prepared: levels that can be played without.
LIGHT_LEVELS = (
    "rope", "truss_bridge", "suspension_bridge", "ferris_wheel", "wrecking_ball", "breaking_bridge", "girder", "mast",
    "hooke_comparison", "side_by_side",
)  # fmt: skip


class Card(Lit, Pressable):
    """One thing to open: a picture where there is one, a name, a line of text."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, name: str, text: str, action: Callable[[], object], container: Any
    ) -> None:
        super().__init__(ui, rect, container)
        self.name, self.text, self.action = name, text, action
        self.picture: pygame.Surface | None = None
        self.has_picture = True
        self.broken = False
        self.home = rect.copy()
        ui.add(self)

    def show_picture(self, picture: pygame.Surface) -> None:
        """Show a picture of the size that there is for it."""
        self.picture = picture
        self.repaint()

    def show_fault(self, fault: str) -> None:
        """Show why the file cannot be opened."""
        self.text, self.broken = fault, True
        self.repaint()

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """The card as it is now."""
        ui, (width, height) = self.ui, size
        card = pygame.Surface(size, pygame.SRCALPHA)
        pygame.draw.rect(card, SURFACE, card.get_rect(), border_radius=ui.px(10))
        picture_height = height - ui.px(TEXT_HEIGHT) if self.has_picture else 0
        if self.has_picture:
            self._paint_picture(card, width, picture_height)
        rim = ACCENT if self.hovered else LINE
        pygame.draw.rect(card, rim, card.get_rect(), max(1, ui.px(1.4)), border_radius=ui.px(10))
        y = picture_height + ui.px(9)
        name = wrapped(self.name, ui.font(14, True), width - ui.px(28), 1)[0]
        card.blit(ui.font(14, True).render(name, True, TEXT), (ui.px(14), y))
        y += ui.px(22)
        for line in wrapped(self.text, ui.font(11.5), width - ui.px(28), 2 if self.has_picture else 1):
            card.blit(ui.font(11.5).render(line, True, DANGER if self.broken else MUTED), (ui.px(14), y))
            y += ui.px(16)
        return card

    def _paint_picture(self, card: pygame.Surface, width: int, height: int) -> None:
        ui = self.ui
        frame = pygame.Rect(1, 1, width - 2, height)
        pygame.draw.rect(card, BACKGROUND, frame, border_top_left_radius=ui.px(10), border_top_right_radius=ui.px(10))
        if self.picture is not None:
            inset = self.picture.get_rect(center=frame.center)
            card.blit(self.picture, inset)
        pygame.draw.line(card, LINE, (1, height), (width - 2, height))

    def press(self) -> None:
        """Open it."""
        self.action()


class Gallery:
    """The page of levels or recordings."""

    def __init__(self, ui: Ui, app: Application, section: str, close: Callable[[], None]) -> None:
        self._ui, self._app = ui, app
        self.cards: list[Card] = []
        self.section = section
        # What is still to be found out or drawn for cards: each goes on by a slice, False where it has to wait.
        self._unfilled: deque[Iterator[bool]] = deque()
        self._has_kernels: Callable[[bool], bool] = lambda contacts: False
        self._scroll = 0.0
        self._columns = 1
        self.title = {name: text for name, text, _ in SECTIONS}[section]
        self._open = partial(app.files.open_level, shipped=section == "levels")
        end = close if app.screen is not None else lambda: None
        self.sheet = ui.open_sheet(end, "@cover", again=lambda _: app.open_gallery(section))
        width, height = ui.units
        editing = app.mode == "edit"
        ui.label(ui.rect(MARGIN, 26, 300, 40), "Edit a level" if editing else "Spring Sandbox", self.sheet, "@display")
        tabs = ui.choice(ui.rect(width - MARGIN - 424, 32, 252, 32), SECTIONS, self._app.open_gallery, self.sheet)
        tabs.show(section)
        ui.button(ui.rect(width - MARGIN - 162, 32, 58, 32), "New", app.documents.new, self.sheet, tip=NEW_TIP)
        ui.button(ui.rect(width - MARGIN - 98, 32, 98, 32), "Open file", app.files.ask_to_open, self.sheet)
        place = ui.rect(MARGIN - 6, TOP, width - 2 * MARGIN + 12, height - TOP)
        self.area = ui.area(place, self.sheet)
        if section == "recordings":
            self._add_recordings()
        else:
            self._add_levels(self._shipped() if section == "levels" else recent_levels())

    def close(self) -> None:
        """Take the page away."""
        self._ui.close_sheet(self.sheet)

    def _shipped(self) -> list[Path]:
        if self._app.ready:
            return shipped_levels()
        place = {name: index for index, name in enumerate(LIGHT_LEVELS)}
        return sorted(shipped_levels(), key=lambda path: place.get(path.stem, len(place)))

    def _add_levels(self, paths: Sequence[Path]) -> None:
        ui = self._ui
        if not paths:
            text = "No levels of yours yet. Draw one in the editor (New, or E in any level) and save it with Ctrl+S."
            ui.label(ui.rect(6, 6, 760, 30), text, self.area, "@muted")
        width = ui.units[0] - 2 * MARGIN
        columns = self._columns = max(1, int((width + GAP) // (CARD_WIDTH + GAP)))
        card_width = (width - GAP * (columns - 1)) / columns
        card_height = card_width * PICTURE_RATIO + TEXT_HEIGHT
        for index, path in enumerate(paths):
            x = 6 + index % columns * (card_width + GAP)
            y = 6 + index // columns * (card_height + GAP)
            self._add_level(ui.rect(x, y, card_width, card_height), path)

    def _add_level(self, rect: pygame.Rect, path: Path) -> None:
        card = self._add_card(rect, one_line(path.stem), "", partial(self._open, path))
        try:
            content = read_bytes(path)
        except LevelError as error:
            card.show_fault(error.faults[0])
            return
        is_shipped = self.section == "levels"
        if is_shipped:
            # What was shipped needs no check before it is shown.
            data = json.loads(content)
            card.name, card.text = data["name"], data.get("description", "")
            card.repaint()
        self._unfilled.append(self._fill(card, path, content, is_shipped))

    def _fill(self, card: Card, path: Path, content: bytes, is_shipped: bool) -> Iterator[bool]:
        key = picture_key(content)
        size = (card.rect.width - 2, card.rect.height - self._ui.px(TEXT_HEIGHT) - 1)
        picture = find_picture(path, key, size)
        if picture is not None:
            card.show_picture(picture)
            yield True
            if is_shipped:
                return
        try:
            level = parse_level(content, str(path))
        except LevelError as error:
            card.show_fault(error.faults[0])
            return
        if not is_shipped:
            # Levels of one's own are often still without a name.
            card.name, card.text = level.name, f"{one_line(path.name)}  {level.description}".strip()
            card.repaint()
        if picture is not None:
            return
        while not self._has_kernels(level.has_contacts):
            yield False
        picture = yield from draw_in_slices(level, SECONDS if COMPILED else 0.0)
        card.show_picture(pygame.transform.smoothscale(picture, size))
        if COMPILED:
            with suppress(OSError):
                keep_picture(picture, kept_picture(key))
                forget_old_pictures(kept_picture(key).parent)

    def _add_recordings(self) -> None:
        ui = self._ui
        width = min(ui.units[0] - 2 * MARGIN, 760.0)
        found = saved_recordings()
        if not found:
            text = "No replays yet. Record a run with Ctrl+R, or save what you did with Ctrl+S."
            ui.label(ui.rect(6, 6, width, 30), text, self.area, "@muted")
        for index, path in enumerate(found):
            stat = path.stat()
            when = time.strftime("%d %B %Y, %H:%M", time.localtime(stat.st_mtime))
            rect = ui.rect(6, 6 + index * (ROW_HEIGHT + 10), width, ROW_HEIGHT)
            card = Card(
                ui, rect, one_line(path.name), f"{when}, {stat.st_size / 1024:,.0f} KiB",
                partial(self._app.files.open_replay, path), self.area,
            )  # fmt: skip
            card.has_picture = False
            card.repaint()
            self.cards.append(card)

    def _add_card(self, rect: pygame.Rect, name: str, text: str, action: Callable[[], object]) -> Card:
        card = Card(self._ui, rect, name, text, action, self.area)
        card.repaint()
        self.cards.append(card)
        return card

    def update(self, has_kernels: Callable[[bool], bool]) -> None:
        """Go on filling cards for a while, those whose kernels are there (see Preparation); show the focused one."""
        self._has_kernels = has_kernels
        end, waiting = time.perf_counter() + FILL_BUDGET, 0
        while waiting < len(self._unfilled):
            went_on = next(self._unfilled[0], None)
            if went_on is None:
                self._unfilled.popleft()
            elif not went_on:
                self._unfilled.rotate(-1)
                waiting += 1
            if time.perf_counter() > end:
                break
        focus = self._ui.focus
        if isinstance(focus, Card) and focus in self.cards:
            self._show(focus)

    def press_key(self, key: int) -> bool:
        """Go from card to card with the arrow keys."""
        step = {pygame.K_LEFT: -1, pygame.K_RIGHT: 1, pygame.K_UP: -self._columns, pygame.K_DOWN: self._columns}
        if key not in step or not self.cards or self._ui.typing:
            return False
        focus = self._ui.focus
        here = self.cards.index(focus) if isinstance(focus, Card) and focus in self.cards else None
        target = 0 if here is None else here + step[key]
        if 0 <= target < len(self.cards):
            self._ui.focus_on(self.cards[target])
            self._show(self.cards[target])
        return True

    def scroll(self, notches: float) -> None:
        """Move the cards by notches of the wheel."""
        self._scroll_to(self._scroll - notches * self._ui.px(WHEEL_STEP))

    def _show(self, card: Card) -> None:
        gap = self._ui.px(GAP)
        top, bottom = card.home.top - gap, card.home.bottom + gap
        if top < self._scroll:
            self._scroll_to(top)
        elif bottom > self._scroll + self.area.rect.height:
            self._scroll_to(bottom - self.area.rect.height)

    def _scroll_to(self, offset: float) -> None:
        lowest = max((card.home.bottom for card in self.cards), default=0) + self._ui.px(MARGIN)
        offset = min(max(offset, 0.0), max(0.0, lowest - self.area.rect.height))
        if offset == self._scroll:
            return
        self._scroll = offset
        for card in self.cards:
            card.set_relative_position((card.home.left, card.home.top - round(offset)))
