"""Gallery: levels as cards with pictures, by sections, found by what is typed; and saved recordings as a list."""

import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import pygame

from sandbox.app.base.desktop import recordings_folder, saved_recordings
from sandbox.app.base.loop import SliceQueue
from sandbox.app.base.shortcuts import hint, tip_of
from sandbox.app.compare.hooke_level import lesson_picture, twice
from sandbox.app.contracts.application import Application
from sandbox.app.draw.colours import TEXT, shown_theme
from sandbox.app.draw.picture_cache import (
    SECONDS,
    draw_in_slices,
    find_picture,
    keep_for_later,
    kept_picture,
    picture_key,
)
from sandbox.app.gallery.card import PICTURE_RATIO, TEXT_HEIGHT, Card, Preview, draw_shadow
from sandbox.app.gallery.filling import date_of, fill_replay, fill_scene, fill_solved, level_of_scene, show_kept
from sandbox.app.gallery.sections import FIRST, in_sections, is_found, search_rank
from sandbox.app.play.score import time_text
from sandbox.app.widgets.button import Button
from sandbox.app.widgets.field import Field
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.editor.storage.best_runs import best_result
from sandbox.editor.storage.preferences import played_levels, recent_levels
from sandbox.editor.storage.scene_shelf import scenes_in
from sandbox.level.format.level_error import LevelError, one_line
from sandbox.level.reading.files import parse_level, read_bytes, shipped_folder, shipped_levels
from sandbox.level.reading.pictures import read_pictures
from sandbox.physics import jit
from sandbox.session.scene import SUFFIX

# Sizes in layout units.
LEAST_WIDTH, MOST_WIDTH = 218.0, 420.0
SMALL_HEIGHT = 54.0
GAP = 16.0
# Large windows have larger cards, not more than this many side by side, until cards have their greatest width.
COLUMNS = 5
MARGIN = 36.0
HEADING = 40.0
SECTION_GAP = 4.0
# Wall time [s] of a frame that cards are filled in.
FILL_BUDGET = 0.02
TITLES = {"levels": "Levels", "mine": "My levels", "recordings": "Replays"}
# The level that a lesson plays twice.
COMPARED = "jelly_cube"
NO_LEVELS = (
    "You have no levels yet. Ctrl+S saves what you play, as it stands, and what you draw in the editor: press New, or "
    "E in any level."
)
NO_REPLAYS = "No recordings yet. Record a run with Ctrl+R, or save what you did with Ctrl+Shift+S."
# What stands in the file of a level that can be won.
RULES = b'"rules"'
SAVED, GO_ON, RECENT, WIN = "Saved", "Go on where you were", "Recently played", "Win levels"
KEPT_LINE = "Not saved, and kept as it stood; the oldest go some day."
# Where the card of what can be won is among toys.
WIN_PLACE = 1
STEPS = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_UP: (0, -1), pygame.K_DOWN: (0, 1)}


@dataclass
class Group:
    """Cards under a heading; columns: how many stand side by side; height: of a card [layout units]."""

    title: str
    line: str
    columns: int
    width: float
    height: float
    cards: list[Card] = field(default_factory=list)
    labels: list[TextBlock] = field(default_factory=list)
    # A row that repeats what is in other groups; it goes while something is searched.
    is_shortcut: bool = False
    top: int = 0


class Gallery:
    """The page of levels or recordings."""

    def __init__(
        self, ui: Ui, app: Application, section: str, close: Callable[[], None], query: str = "",
        place: tuple[str, float] = ("", 0.0),
    ) -> None:  # fmt: skip
        self._ui, self._app, self._close = ui, app, close
        self.groups: list[Group] = []
        self.section = section
        # What is still to be found out or drawn for cards: each goes on by a slice, False where it has to wait.
        self._unfilled = SliceQueue()
        self._paths: dict[Card, Path] = {}
        self._preview: tuple[Card, Preview, pygame.Surface | None] | None = None
        self.title = TITLES[section]
        self.query = ""
        self.sheet = ui.open_sheet(
            self._escape, "cover", reopen=lambda _: app.open_gallery(section, self.header.search.typed)
        )
        self._width = ui.units[0] - 2 * MARGIN
        self._build_groups_of = {"levels": self._add_shipped, "mine": self._add_own, "recordings": self._add_recordings}
        self.header = Header(ui, app, section, self.sheet, query)
        self.header.search.enter = self._open_first
        top = self.header.height
        around = ui.rect(MARGIN - 6, top, ui.units[0] - 2 * MARGIN + 22, ui.units[1] - top)
        self.area = ScrollArea(ui, around, self.sheet)
        self._nothing = TextBlock(ui, ui.rect(6, 12, self._width, 60), "", self.area.content, 13.0)
        self._build_groups_of[section]()
        titles = [group.title for group in self.groups if group.cards and not group.is_shortcut]
        if section == "levels":
            self.header.show_sections(titles, self._show_section)
        self._arrange()
        self.area.scroll_to(sum(group.top for group in self.groups if group.title == place[0]) + ui.px(place[1]))

    @property
    def place(self) -> tuple[str, float]:
        """Where it is scrolled to: the heading that was reached last, and how far below that [layout units]."""
        reached = [group for group in self.groups if group.top <= self.area.offset and not self.query]
        group = reached[-1] if reached else self.groups[0]
        return (group.title, (self.area.offset - group.top) / self._ui.scale) if reached else ("", 0.0)

    @property
    def cards(self) -> list[Card]:
        """All cards but those of rows that repeat others, in their order."""
        return [card for group in self.groups if not group.is_shortcut for card in group.cards]

    @property
    def is_on_top(self) -> bool:
        """Whether no other page lies over the gallery."""
        return self._ui.top_sheet is self.sheet

    def close(self) -> None:
        """Take the page away."""
        self.sheet.remove()

    def _escape(self) -> None:
        if self.query:
            self.header.search.typed = ""
        elif self._app.screen is not None:
            self._close()

    # What there is.

    def _group(self, title: str, line: str = "", *, is_shortcut: bool = False) -> Group:
        """A group of cards, as many side by side as fit."""
        columns = max(1, int((self._width + GAP) // (LEAST_WIDTH + GAP)))
        if not is_shortcut:
            columns = max(min(columns, COLUMNS), math.ceil((self._width + GAP) / (MOST_WIDTH + GAP)))
        width = (self._width - GAP * (columns - 1)) / columns
        height = SMALL_HEIGHT if is_shortcut else width * PICTURE_RATIO + TEXT_HEIGHT
        group = Group(title, line, columns, width, height, is_shortcut=is_shortcut)
        self.groups.append(group)
        return group

    def _add_shipped(self) -> None:
        is_play = self._app.mode == "play"
        shortcuts = self._group(GO_ON if is_play else RECENT, is_shortcut=True)
        for path in self._app.scenes.shelf.others()[:1] if is_play else []:
            self._add_scene(shortcuts, path, is_kept=True)
        for path in played_levels()[: shortcuts.columns - len(shortcuts.cards)]:
            self._add_level(shortcuts, path)
        for place, (section, paths) in enumerate(in_sections(shipped_levels())):
            if place == 2 and is_play:
                self._add_lessons()
            group = self._group(section.title, section.line)
            if place == 1 and is_play:
                self._add_way_to(group, paths[0])
            for path in paths:
                self._add_level(group, path, section.levels.get(path.stem, ""))
                if path.stem == FIRST and not played_levels():
                    group.cards[-1].badge = "Start here"
        own = self._group("Your own")
        for path in recent_levels():
            self._add_level(own, path)

    def _add_way_to(self, group: Group, first: Path) -> None:
        """Add a card to the first group that leads to another one; first: the level whose picture it has."""
        text = "Levels that can be won, each with up to three stars."
        card = self._add_card(self.groups[1], WIN, text, partial(self._show_section, group.title))
        self.groups[1].cards.insert(WIN_PLACE, self.groups[1].cards.pop())
        card.line, card.tags = group.line, ("goal", "puzzle", "win")
        show_kept(card, first, first.read_bytes())

    def _add_lessons(self) -> None:
        group = self._group("Lessons", "Try it, and see why.")
        name, text = "Stiffer, until it explodes", "Hooke's spring beside the article's: the same spring, made stiffer."
        card = self._add_card(group, name, text, self._app.start_lesson)
        card.line, card.tags = "Find where Hooke's breaks", ("lesson", "article", "hooke")
        card.show_picture(lesson_picture(card.picture_size, shown_theme()))
        text = "The same numbers, solved one by one: jellies melt. Solved all at once, they are whole again."
        card = self._add_card(group, "Melt the jellies", text, self._app.start_melt)
        card.line, card.tags = "One button: melt, and whole again", ("lesson", "solver", "article", "jelly")
        first = shipped_folder("levels") / f"{FIRST}.json"
        show_kept(card, first, first.read_bytes())
        path = shipped_folder("levels") / f"{COMPARED}.json"
        if path.is_file():
            text = (
                "A level twice, side by side: other springs for A and for B, one hand that pulls at both. F9 anywhere."
            )
            card = self._add_card(group, "Two settings at once", text, partial(self._app.start_pair, path))
            card.line, card.tags = "Softer springs for B, then pull", ("lesson", "compare")
            picture = find_picture(path, picture_key(path.read_bytes()), card.picture_size, shown_theme())
            if picture is not None:
                card.show_picture(twice(picture))

    def _add_own(self) -> None:
        group = self._group(SAVED)
        try:
            saved = scenes_in(recordings_folder())
        except OSError:
            saved = []
        levels = recent_levels()
        times = {path: when for path in (*saved, *levels) if (when := _written(path)) is not None}
        for path in sorted(times, key=lambda path: times[path], reverse=True):
            if path in levels:
                self._add_level(group, path)
            else:
                self._add_scene(group, path, is_kept=False)
        kept: dict[str, list[Path]] = {}
        for path in self._app.scenes.shelf.others():
            kept.setdefault(level_of_scene(path), []).append(path)
        for name, paths in kept.items():
            group = self._group(name, f"{len(paths)} {'run' if len(paths) == 1 else 'runs'}. {KEPT_LINE}")
            for path in paths:
                self._add_scene(group, path, is_kept=True)

    def _add_scene(self, group: Group, path: Path, is_kept: bool) -> None:
        name = one_line(path.name.removesuffix(SUFFIX))
        card = self._add_card(group, "" if is_kept else name, "", partial(self._app.files.open_scene, path))
        self._unfilled.add(fill_scene(card, path, is_kept))

    def _add_level(self, group: Group, path: Path, line: str = "") -> None:
        is_shipped = path.parent == shipped_folder("levels")
        action = partial(self._app.files.open_level, path, is_shipped)
        card = self._add_card(group, one_line(path.stem), "", action)
        card.line = line
        try:
            content = read_bytes(path)
        except LevelError as error:
            card.show_fault(error.faults[0])
            return
        if is_shipped:
            # What was shipped needs no check before it is shown.
            data = json.loads(content)
            card.show_texts(data["name"], hint(data.get("description", "")), tuple(data.get("tags", ())))
        else:
            card.repaint()
        self._paths[card] = path
        self._unfilled.add(self._fill(card, path, content, is_shipped))

    def _add_card(self, group: Group, name: str, text: str, action: Callable[[], object]) -> Card:
        place = self._ui.rect(6, 0, group.width, group.height)
        card = Card(self._ui, place, name, text, action, self.area.content, is_small=group.is_shortcut)
        group.cards.append(card)
        return card

    def _fill(self, card: Card, path: Path, content: bytes, is_shipped: bool) -> Iterator[bool]:
        key, size, theme = picture_key(content), card.picture_size, shown_theme()
        has_picture = show_kept(card, path, content)
        if has_picture:
            yield True
            if is_shipped and RULES not in content:
                return
        try:
            level = parse_level(content, str(path))
            read_pictures(level, path.parent, str(path))
        except LevelError as error:
            card.show_fault(error.faults[0])
            return
        if not is_shipped:
            # Levels of one's own are often still without a name.
            about = [one_line(path.name), *([hint(level.description)] if level.description else [])]
            card.show_texts(level.name, ": ".join(about), level.tags)
        result = best_result(level) if level.rules and not card.is_small else None
        if result is not None:
            card.show_won(result.stars, time_text(result.seconds))
        if level.rules and not card.is_small:
            yield from fill_solved(card, path, level)
        if has_picture:
            return
        picture = yield from draw_in_slices(level, theme, SECONDS if jit.COMPILED else 0.0)
        card.show_picture(pygame.transform.smoothscale(picture, size))
        if jit.COMPILED:
            keep_for_later(picture, kept_picture(key, theme))

    def _add_recordings(self) -> None:
        group = self._group("")
        for path in saved_recordings():
            card = self._add_card(group, one_line(path.name), "", partial(self._app.files.open_replay, path))
            card.line = date_of(path)
            card.repaint()
            self._unfilled.add(fill_replay(card, path))

    # Where it stands.

    def _arrange(self) -> None:
        """Lay out the groups with the cards that fit the search."""
        ui, y = self._ui, 0.0
        for group in self.groups:
            shown = [card for card in group.cards if self._fits(group, card)]
            for card in group.cards:
                card.visible = card in shown
            self._head(group, y, bool(shown))
            group.top = ui.px(y)
            if not shown:
                continue
            y += HEADING if group.title else GAP / 2
            for index, card in enumerate(shown):
                x = 6 + index % group.columns * (group.width + GAP)
                below = y + index // group.columns * (group.height + GAP)
                card.move_to(ui.rect(x, below, 0, 0).topleft)
            y += -(-len(shown) // group.columns) * (group.height + GAP) + SECTION_GAP
        self._nothing.show_text("" if y else self._words_for_nothing())
        self.area.set_height(ui.px(max(y, 80.0) + MARGIN / 2))

    def _words_for_nothing(self) -> str:
        if self.query:
            return f"No level matches “{self.query}”. Escape shows everything again."
        return NO_REPLAYS if self.section == "recordings" else NO_LEVELS

    def _fits(self, group: Group, card: Card) -> bool:
        if not self.query:
            return True
        return not group.is_shortcut and is_found(self.query, card.name, card.line, card.text, group.title, *card.tags)

    def _head(self, group: Group, y: float, is_shown: bool) -> None:
        """Move a group's heading, or hide it."""
        ui = self._ui
        if group.title and not group.labels:
            wide = ui.font(15, True).size(group.title)[0] / ui.scale + 14
            place = ui.rect(6, y, wide, 24)
            group.labels.append(TextBlock(ui, place, group.title, self.area.content, 15.0, TEXT, is_bold=True))
            if group.line:
                place = ui.rect(6 + wide, y, max(self._width - wide, 1), 20)
                group.labels.append(TextBlock(ui, place, group.line, self.area.content, 12.0))
        for index, label in enumerate(group.labels):
            label.visible = is_shown
            label.move_to((label.place.left, ui.px(y + 8 + 3 * index)))

    def _show_section(self, title: str) -> None:
        """Scroll to a section."""
        group = next(group for group in self.groups if group.title == title)
        self.area.scroll_to(group.top)

    # A frame.

    @property
    def moves(self) -> bool:
        """Whether cards are still filled in, or one plays."""
        return len(self._unfilled) > 0 or (self._preview is not None and self._preview[1].moves)

    def update(self, frame_time: float) -> None:
        """Go on filling cards for a while; show what has the focus."""
        self._unfilled.go_on(FILL_BUDGET)
        self._search(self.header.search.typed)
        self._mark_section()
        self._play(frame_time)

    def _mark_section(self) -> None:
        """Mark the section that is read: the last one that has reached the top, at the end the last of all."""
        line = self.area.offset + self._ui.px(HEADING)
        groups = [group for group in self.groups if group.cards and not group.is_shortcut]
        reached = [group.title for group in groups if group.top <= line] or [group.title for group in groups[:1]]
        if groups and self.area.is_at_end:
            reached = [groups[-1].title]
        self.header.mark(reached[-1] if reached and not self.query else "")

    def _search(self, query: str) -> None:
        if query.strip() == self.query:
            return
        self.query = query.strip()
        self._arrange()
        self.area.scroll_to(0.0)

    def _play(self, frame_time: float) -> None:
        """Play the level under the pointer in its card."""
        pointed = [card for card in self._shown() if card.is_pointed_at]
        card = next((card for card in pointed if card.hovered), pointed[0] if pointed else None)
        if self._preview is not None and self._preview[0] is not card:
            before, _, still = self._preview
            self._preview = None
            if still is not None:
                before.show_picture(still)
        if card is None or card not in self._paths or card.is_small or self._app.chosen["motion"] == "less":
            return
        if self._preview is None:
            self._preview = card, Preview(self._paths[card], card.picture_size), card.picture
        preview = self._preview[1]
        if preview.update(frame_time) and preview.picture is not None:
            card.show_picture(preview.picture)

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the whole card that is pointed at, over its neighbours."""
        if not self.is_on_top:
            return
        for card in self._shown():
            if card.is_pointed_at and not card.is_small:
                picture = card.paint_open()
                view = self.area.view.rect.inflate(0, -2)
                place = picture.get_rect(midtop=card.rect.midtop).clamp(view)
                draw_shadow(surface, place, self._ui)
                surface.blit(picture, place)
                return

    # Keys.

    def _shown(self) -> list[Card]:
        return [card for group in self.groups for card in group.cards if card.visible]

    def _open_first(self, query: str) -> None:
        # A fast hand has typed it since the last frame.
        self._search(query)
        found = self._shown()
        if self.query and found:
            min(found, key=lambda card: search_rank(self.query, card.name)).press()

    def press_key(self, event: pygame.event.Event) -> bool:
        """Go from card to card with the arrow keys; a letter begins a search."""
        if not self.is_on_top:
            return False
        search = self.header.search
        if event.key in STEPS and not (self._ui.typing and event.key != pygame.K_DOWN):
            self._go(*STEPS[event.key])
            return True
        is_plain = not event.mod & (pygame.KMOD_CTRL | pygame.KMOD_META | pygame.KMOD_ALT)
        if not self._ui.typing and is_plain and event.unicode.isprintable() and event.unicode.strip():
            # The letter itself comes as text after its key.
            self._ui.focus_on(search)
            search.select(len(search.typed), len(search.typed))
            return True
        return False

    def _go(self, dx: int, dy: int) -> None:
        shown, focus = self._shown(), self._ui.focus
        if not shown:
            return
        target: Card | None = shown[0]
        if isinstance(focus, Card) and focus in shown:
            target = _beside(shown, focus, dx, dy)
        if target is not None:
            self._ui.focus_on(target)

    def scroll(self, notches: float) -> None:
        """Move the cards by notches of the wheel."""
        self.area.scroll_by(notches)


def _written(path: Path) -> float | None:
    """When a file was written, None where it is gone by now."""
    try:
        return path.stat().st_mtime
    except OSError:
        return None


def _beside(cards: Sequence[Card], card: Card, dx: int, dy: int) -> Card | None:
    """The card at the side of another: the next in a row, or the nearest of the row above or below."""
    if dx:
        index = cards.index(card) + dx
        return cards[index] if 0 <= index < len(cards) else None
    ahead = [each for each in cards if (each.rect.top - card.rect.top) * dy > 0]
    return min(
        ahead, key=lambda each: (abs(each.rect.top - card.rect.top), abs(each.rect.left - card.rect.left)), default=None
    )


# Sizes in layout units.
_MARGIN = 36.0
_BUTTON = 32.0
_GAP = 8.0
PAGES_WIDTH, SEARCH_WIDTH = 260.0, 240.0
# Narrower windows have two rows and no line of sections.
ROOM_FOR_ONE_ROW = 980.0
NEW_TIP = "A place of your own: ground, walls and parts to play with"
PAGES = (("levels", "Levels"), ("mine", "My levels"), ("recordings", "Replays"))
SEARCH = "Type to search"


class Header:
    """The widgets above the cards; height [layout units]; section: the page that is shown."""

    def __init__(self, ui: Ui, app: Application, section: str, sheet: Any, query: str) -> None:
        self._ui, self._sheet = ui, sheet
        width = ui.units[0]
        self._is_wide = width >= ROOM_FOR_ONE_ROW
        self._sections: dict[str, Button] = {}
        title = "Edit a level" if app.mode == "edit" else "Spring Sandbox"
        ui.label(ui.rect(_MARGIN, 20, 230, 36), title, sheet, "display")
        right = width - _MARGIN
        right = self._buttons(app, right)
        second = 72.0
        if self._is_wide:
            left = _MARGIN + 250
            pages = ui.rect(left, 24, PAGES_WIDTH, _BUTTON)
            left = max(right - _GAP - SEARCH_WIDTH, left + PAGES_WIDTH + 2 * _GAP)
            search = ui.rect(left, 24, right - _GAP - left, _BUTTON)
            self.height = second + (34 if section == "levels" else 4)
        else:
            pages = ui.rect(_MARGIN, second, PAGES_WIDTH, _BUTTON)
            left = _MARGIN + PAGES_WIDTH + _GAP
            search = ui.rect(left, second, width - _MARGIN - left, _BUTTON)
            self.height = second + _BUTTON + 10
        # Ctrl+L opens another page in each mode.
        page, action = ("mine", "recent") if app.mode == "edit" else ("recordings", "recordings")
        tips = {page: tip_of(action, app.mode)}
        choices = [(name, text, tips.get(name, "")) for name, text in PAGES]
        ui.choice(pages, choices, app.open_gallery, sheet).show(section)
        self.search: Field = ui.field(search, query, lambda _: True, sheet, 80, hint=SEARCH)

    def _buttons(self, app: Application, right: float) -> float:
        """Add New, Open file and Settings, the last of them ending at `right`; where the first begins."""
        ui, sheet = self._ui, self._sheet
        documents = app.documents
        new = documents.new_place if app.mode == "edit" else documents.play_new
        buttons = [(58.0, "New", new), (94.0, "Open file", app.files.ask_to_open)]
        left = right - _BUTTON - sum(width + _GAP for width, _, _ in buttons)
        x = left
        for width, text, action in buttons:
            tip = NEW_TIP if text == "New" else tip_of("open_file" if app.mode == "edit" else "open", app.mode)
            ui.button(ui.rect(x, 24, width, _BUTTON), text, action, sheet, tip=tip)
            x += width + _GAP
        place = ui.rect(x, 24, _BUTTON, _BUTTON)
        ui.button(place, "", lambda: app.act("settings"), sheet, icon="settings", tip=tip_of("settings", app.mode))
        return left

    def show_sections(self, titles: Sequence[str], go: Callable[[str], None]) -> None:
        """Open the menu of sections, where there is room for them."""
        if not self._is_wide or len(titles) < 2:
            return
        ui, x = self._ui, _MARGIN
        for title in titles:
            wide = ui.font(12).size(title)[0] / ui.scale + 22
            place = ui.rect(x, 70, wide, 26)
            self._sections[title] = ui.button(place, title, partial(go, title), self._sheet, style="chip")
            x += wide + 4

    def mark(self, title: str) -> None:
        """Mark the section that is seen."""
        for name, button in self._sections.items():
            button.is_selected = name == title
