"""SettingsSheet: what can be chosen, a row each, and the keys of everything that keys do."""

from collections.abc import Callable
from functools import partial
from typing import Any

import pygame

from sandbox.app.base.shortcuts import Mode, Shortcut, combination_of, shortcuts, spoken, with_keys
from sandbox.app.draw.colours import ACCENT, LINE, MUTED, SURFACE, TEXT, mixed
from sandbox.app.settings.chosen import SETTINGS, Address, Amount, Chosen, OneOf
from sandbox.app.widgets.dialogs import MARGIN, Dialog
from sandbox.app.widgets.scroll import BAR_WIDTH, ScrollArea
from sandbox.app.widgets.texts import TextBlock, text_height, wrapped
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Pressable

# Sizes in layout units.
WIDTH, HEIGHT = 720.0, 676.0
TOP, BOTTOM = 104.0, 66.0
ROW, KEY_ROW, HEADING = 56.0, 30.0, 36.0
LABEL_SHARE = 0.42
# A narrower page has the label of a row above its buttons.
ROOM_BESIDE = 520.0
BUTTON, TIP_TEXT = 34.0, 11.0
PAGES = (("general", "General", ""), ("play", "Keys in play", ""), ("edit", "Keys in editor", ""))
KEYS_NOTE = "Click a row, then press the new keys. Delete clears it, Escape cancels."
TEXT_SIZE = 12.5


class SettingsSheet:
    """A modal page; page: one of PAGES. It is made again after what changes how all widgets look."""

    def __init__(
        self,
        ui: Ui,
        chosen: Chosen,
        page: str = "general",
        note: str = "",
        offset: float = 0.0,
        focus: int | None = None,
    ) -> None:
        self._ui, self._chosen, self._page = ui, chosen, page
        self._y = 0.0
        dialog = Dialog(ui, "Settings", WIDTH, HEIGHT, self._reopen, is_page=True)
        self._sheet, box, height = dialog.sheet, dialog.box, dialog.height
        self._width = dialog.inside - BAR_WIDTH
        tabs = ui.choice(ui.rect(MARGIN, 56, min(420, self._width), 32), PAGES, self._turn, box)
        tabs.show(page)
        self.area = ScrollArea(ui, dialog.place(TOP, height - TOP - BOTTOM), box)
        place = ui.rect(MARGIN, height - BOTTOM + 12, self._width - 236, BOTTOM - 18)
        self._note = TextBlock(ui, place, note or (KEYS_NOTE if page != "general" else ""), box, 12.0)
        done = dialog.add_buttons(("Close", dialog.end), ("Defaults", self._reset))
        if page == "general":
            self._add_settings()
        else:
            self._add_keys("edit" if page == "edit" else "play")
        self.area.set_height(ui.px(self._y))
        self.area.scroll_to(offset)
        ui.focus_on(done)
        ui.focus_at(focus)

    def _reopen(self, ui: Ui) -> None:
        SettingsSheet(ui, self._chosen, self._page, self._note.text, self.area.offset, self._ui.focus_place)

    def _turn(self, page: str) -> None:
        if page != self._page:
            self._sheet.remove()
            SettingsSheet(self._ui, self._chosen, page)

    def _reset(self) -> None:
        """Go back to the usual values of what this page shows."""
        if self._page == "general":
            self._note.show_text("The defaults apply again.")
            for setting in SETTINGS:
                self._chosen.choose(setting.name, None)
        else:
            self._note.show_text("The default keys apply again.")
            names = {entry.name for entry in _changeable(self._page)}
            self._chosen.choose_keys({name: keys for name, keys in self._chosen.keys.items() if name not in names})
        self._show_anew()

    def _show_anew(self) -> None:
        # What was chosen may have laid all widgets out again, and this page with them, by `_reopen`.
        if self._sheet.is_there:
            focus = self._ui.focus_place
            self._sheet.remove()
            SettingsSheet(self._ui, self._chosen, self._page, self._note.text, self.area.offset, focus)

    # Rows.

    def _heading(self, text: str) -> None:
        place = self._ui.rect(0, self._y + 12, self._width, 20)
        TextBlock(self._ui, place, text.upper(), self.area.content, 11.0, is_bold=True)
        self._y += HEADING

    def _add_settings(self) -> None:
        group = ""
        for setting in SETTINGS:
            if setting.group != group:
                group = setting.group
                self._heading(group)
            if isinstance(setting, OneOf):
                self._add_choice(setting)
            elif isinstance(setting, Amount):
                self._add_amount(setting)
            else:
                self._add_address(setting)

    def _row(self, label: str, tip: str) -> tuple[float, float]:
        """Make the label of a row and the line about it; gives left edge and width of the place for its buttons."""
        ui, content = self._ui, self.area.content
        is_beside = self._width >= ROOM_BESIDE
        wide = self._width * LABEL_SHARE - 12 if is_beside else self._width
        TextBlock(ui, ui.rect(0, self._y, wide, 20), label, content, 13.0, TEXT)
        tall = 30.0 if is_beside else text_height(tip, ui.font(TIP_TEXT), ui.px(wide)) / ui.scale + 1
        TextBlock(ui, ui.rect(0, self._y + 19, wide, tall), tip, content, TIP_TEXT)
        if is_beside:
            return self._width * LABEL_SHARE, self._width * (1 - LABEL_SHARE) - 4
        self._y += 23 + tall
        return 0.0, self._width - 4

    def _add_choice(self, setting: OneOf) -> None:
        left, width = self._row(setting.label, setting.tip)
        options = [(value, words, "") for value, words in setting.options]
        choose = partial(self._choose, setting.name)
        row = self._ui.choice(self._ui.rect(left, self._y + 2, width, BUTTON), options, choose, self.area.content)
        row.show(self._chosen[setting.name])
        self._y += ROW

    def _add_address(self, setting: Address) -> None:
        def take(typed: str) -> bool:
            fault = setting.fault_of(typed.strip())
            self._note.show_text(f"{setting.label}: {fault}." if fault else "")
            if fault is None:
                self._chosen.choose(setting.name, typed.strip() or None)
            return fault is None

        left, width = self._row(setting.label, setting.tip)
        place = self._ui.rect(left, self._y + 2, width, BUTTON)
        self._ui.field(place, self._chosen[setting.name], take, self.area.content, 400)
        self._y += ROW

    def _choose(self, name: str, value: object) -> None:
        self._chosen.choose(name, value)
        self._show_anew()

    def _add_amount(self, setting: Amount) -> None:
        ui, content = self._ui, self.area.content
        left, width = self._row(setting.label, setting.tip)
        value = self._chosen[setting.name]
        shown = self._chosen.automatic[setting.name] if value is None else value
        y, x = self._y + 2, left
        for text, by in (("−", -setting.by), ("+", setting.by)):
            target = min(max(round((shown + by) / setting.by) * setting.by, setting.low), setting.high)
            ui.button(ui.rect(x, y, BUTTON, BUTTON), text, partial(self._choose, setting.name, target), content)
            if by < 0:
                ui.label(ui.rect(x + BUTTON, y, 66, BUTTON), f"{100 * shown:.0f} %", content, "middle")
            x += BUTTON + 66
        if setting.default is None:
            place = ui.rect(x - 56, y, min(118.0, width - x + left + 56), BUTTON)
            button = ui.button(place, "Automatic", partial(self._choose, setting.name, None), content, style="segment")
            if value is None:
                button.is_selected = True
        self._y += ROW

    # Keys.

    def _add_keys(self, mode: Mode) -> None:
        group = ""
        for entry in sorted(_changeable(mode), key=lambda entry: entry.group):
            if entry.group != group:
                group = entry.group
                self._heading(group)
            place = self._ui.rect(2, self._y, self._width - 6, KEY_ROW - 3)
            KeyRow(self._ui, place, entry, partial(self._take, entry), self.area.content)
            self._y += KEY_ROW

    def _take(self, entry: Shortcut, keys: tuple[str, ...]) -> None:
        """Give an action other keys, and say from what they were taken."""
        changed, losers = with_keys(self._chosen.keys, entry, keys)
        note = f"{entry.label}: {spoken(keys)}."
        for loser in losers:
            note += f" “{loser.label}” had that key" + (" and has none now." if not loser.keys else ".")
        self._note.show_text(note)
        self._chosen.choose_keys(changed)
        self._show_anew()


def _changeable(mode: str) -> list[Shortcut]:
    """Actions whose keys can be changed in a mode."""
    return [entry for entry in shortcuts("edit" if mode == "edit" else "play") if entry.action]


class KeyRow(Pressable):
    """An action and the caps of its keys; after a press it takes the next keys, Delete takes them away.

    take(keys) is called with the new ones.
    """

    is_lit = True

    def __init__(
        self, ui: Ui, rect: pygame.Rect, entry: Shortcut, take: Callable[[tuple[str, ...]], object], container: Any
    ) -> None:
        super().__init__(ui, rect, container)
        self.entry = entry
        self._take = take

    def press(self) -> None:
        """Wait for keys."""
        self.ui.focus_on(self)
        self._listen(True)

    def _listen(self, listening: bool) -> None:
        self.takes_all_keys = listening
        self.repaint()

    def on_blur(self) -> None:
        """Wait no longer."""
        self._listen(False)

    def press_key(self, event: pygame.event.Event) -> bool:
        """Take the pressed keys; Escape leaves the old ones."""
        if not self.takes_all_keys:
            return super().press_key(event)
        if event.key == pygame.K_ESCAPE and self.entry.keys != ("Escape",):
            self._listen(False)
        elif event.key in (pygame.K_DELETE, pygame.K_BACKSPACE) and not event.mod & pygame.KMOD_CTRL:
            self._listen(False)
            self._take(())
        else:
            keys = combination_of(event.key, event.mod)
            if keys is not None:
                self._listen(False)
                self._take((keys,))
        return True

    def paint(self, size: tuple[int, int]) -> pygame.Surface:
        """Label at the left, caps at the right."""
        ui, surface = self.ui, pygame.Surface(size, pygame.SRCALPHA)
        if self.hovered or self.takes_all_keys:
            pygame.draw.rect(surface, mixed(SURFACE, TEXT, 0.08), surface.get_rect(), border_radius=ui.px(6))
        font, bold = ui.font(TEXT_SIZE), ui.font(11.5, True)
        right = size[0] - ui.px(8)
        words = ("press the new keys",) if self.takes_all_keys else self.entry.keys or ("none",)
        is_key = bool(self.entry.keys) and not self.takes_all_keys
        for word in reversed(words):
            picture = bold.render(word, True, TEXT if is_key else ACCENT if self.takes_all_keys else MUTED)
            cap = picture.get_rect(midright=(right - ui.px(7), size[1] // 2)).inflate(ui.px(14), ui.px(4))
            if is_key:
                pygame.draw.rect(surface, mixed(SURFACE, TEXT, 0.14), cap, border_radius=ui.px(4))
                pygame.draw.rect(surface, LINE, cap, 1, border_radius=ui.px(4))
            surface.blit(picture, picture.get_rect(center=cap.center))
            right = cap.left - ui.px(6)
        label = wrapped(self.entry.label, font, max(right - ui.px(14), 1), 1)[0]
        picture = font.render(label, True, TEXT)
        surface.blit(picture, picture.get_rect(midleft=(ui.px(8), size[1] // 2)))
        return surface
