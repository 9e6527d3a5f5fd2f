"""Ui: all widgets of a window: who gets an event, who has the keyboard, which pages lie over which; and its tip."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import pygame

from sandbox.app.draw.colours import ACCENT
from sandbox.app.widgets.button import Button, Choice, Icon
from sandbox.app.widgets.field import Field
from sandbox.app.widgets.styles import TIP, Plate, box
from sandbox.app.widgets.texts import Label, line_height, wrapped
from sandbox.app.widgets.widget import ENTER_KEYS, Pixel, Widget, WindowLayout

# The tip comes after so long [s].
DELAY = 0.6
# Sizes of a tip in layout units: the widest, its letters, the room around them, its corners, away from its widget.
WIDEST, TEXT_SIZE, ACROSS, DOWN, CORNER, GAP = 260.0, 12.0, 9.0, 6.0, 6.0, 8.0
MOST_LINES = 30
# Delay and interval of a key that is held down [ms].
KEY_REPEAT = (400, 40)
# The next press of a double click comes no later [ms], and no further away [layout units].
CLICK_TIME, CLICK_NEAR = 400, 4.0
ARROWS = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_UP: (0, -1), pygame.K_DOWN: (0, 1)}
# Opens a modal page again on other widgets, with what was typed so far.
Reopen = Callable[["Ui"], object]


@dataclass
class Sheet:
    """A modal page; close: what Escape does; is_page: it is read, so no notices lie over it.

    reopen: opens it in another layout; None = it ends with this one. is_question: it outlives the screen under it.
    is_menu: a press beside what it holds closes it. work: called once a frame, until it says that it is done.
    """

    panel: Plate
    close: Callable[[], object]
    is_page: bool
    reopen: Reopen | None
    is_question: bool
    is_menu: bool
    work: Callable[[], bool] | None = None


class Ui(WindowLayout):
    """Widgets on a window of size [pixels]; the topmost page alone reacts, and the topmost widget first."""

    def __init__(self, size: tuple[int, int], scale: float, pixel_ratio: tuple[float, float] = (1.0, 1.0)) -> None:
        super().__init__(size, scale, pixel_ratio)
        self.root: Widget | None = None
        self.root = Widget(self, pygame.Rect((0, 0), size))
        self._sheets: list[Sheet] = []
        # What is seen, from below to the top; which of it is of the topmost page.
        self._seen: list[Widget] = []
        self._top = 0
        self._focus_is_by_hand = False
        self._to_reveal: Widget | None = None
        self._clicks: tuple[int, Pixel, int] = (-CLICK_TIME, (0, 0), 0)
        self.tip = Tip(self)
        pygame.key.set_repeat(*KEY_REPEAT)

    # Making widgets.

    def panel(self, rect: pygame.Rect, container: Widget | None = None, style: str = "") -> Plate:
        """A background that holds other widgets."""
        return Plate(self, rect, container, style)

    def area(self, rect: pygame.Rect, container: Widget | None = None) -> Widget:
        """A part of the window that clips what it holds."""
        return Widget(self, rect, container)

    def label(self, rect: pygame.Rect, text: str, container: Widget | None = None, style: str = "") -> Label:
        """One line of text."""
        return Label(self, rect, text, container, style)

    def button(
        self,
        rect: pygame.Rect,
        text: str,
        action: Callable[[], object],
        container: Widget | None = None,
        *,
        style: str = "",
        icon: Icon = "",
        icon_size: float = 18.0,
        tip: str = "",
    ) -> Button:
        """A button with text or an icon."""
        button = Button(self, rect, text, action, container, style=style, icon=icon, icon_size=icon_size)
        button.tip = tip
        return button

    def choice(
        self,
        rect: pygame.Rect,
        options: Sequence[tuple[str, str, str]],
        choose: Callable[[str], object],
        container: Widget | None = None,
    ) -> Choice:
        """A row of buttons, one per (value, text, tip), that share the rectangle."""
        buttons, count, gap = {}, len(options), self.px(3)
        width = (rect.width - gap * (count - 1)) / count
        for index, (value, text, tip) in enumerate(options):
            left, right = round(index * (width + gap)), round(index * (width + gap) + width)
            place = pygame.Rect(rect.left + left, rect.top, right - left, rect.height)
            buttons[value] = self.button(place, text, partial(choose, value), container, style="segment", tip=tip)
        return Choice(buttons)

    def field(
        self, rect: pygame.Rect, text: str, commit: Callable[[str], bool], container: Widget | None = None,
        limit: int = 200, *, hint: str = "",
    ) -> Field:  # fmt: skip
        """A line to type into; hint: what it says while it is empty."""
        return Field(self, rect, text, commit, container, limit, hint)

    # Sheets: modal pages on top of all else.

    @property
    def shows_page(self) -> bool:
        """Whether the topmost modal page is one to read."""
        return bool(self._sheets) and self._sheets[-1].is_page

    @property
    def has_sheet(self) -> bool:
        """Whether a modal page is open."""
        return bool(self._sheets)

    @property
    def is_covered(self) -> bool:
        """Whether a modal page is open that is no menu."""
        return any(not sheet.is_menu for sheet in self._sheets)

    @property
    def top_sheet(self) -> Plate | None:
        """The topmost modal page."""
        return self._sheets[-1].panel if self._sheets else None

    @property
    def has_question(self) -> bool:
        """Whether a question is open that stays when another screen comes."""
        return any(sheet.is_question for sheet in self._sheets)

    def open_sheet(
        self,
        close: Callable[[], object] | None = None,
        style: str = "shade",
        *,
        is_page: bool = False,
        reopen: Reopen | None = None,
        is_question: bool = False,
        is_menu: bool = False,
    ) -> Plate:
        """Cover the window by a modal page, which goes as any widget does; the others are those of Sheet.

        close: what Escape does; None: it takes the page away.
        """
        self.blur()
        panel = Plate(self, pygame.Rect((0, 0), self.size), None, style)
        self._sheets.append(Sheet(panel, close or panel.remove, is_page, reopen, is_question, is_menu))
        return panel

    def work_on(self, panel: Plate, work: Callable[[], bool]) -> None:
        """Call `work` once a frame while a modal page is open, until it gives True: all is done."""
        for sheet in self._sheets:
            sheet.work = work if sheet.panel is panel else sheet.work

    @property
    def moves(self) -> bool:
        """Whether work of a modal page goes on."""
        return any(sheet.work is not None for sheet in self._sheets)

    def forget(self, widget: Widget) -> None:
        """Forget a widget that is removed, and the modal page that it was."""
        super().forget(widget)
        self._sheets = [sheet for sheet in self._sheets if sheet.panel is not widget]

    def adopt_sheets(self, old: "Ui", questions_alone: bool = False) -> None:
        """Open the modal pages of an earlier layout, and end that; questions_alone: pages of its screen are left."""
        for sheet in old._sheets:
            if sheet.reopen is not None and (sheet.is_question or not questions_alone):
                sheet.reopen(self)
                if isinstance(self.focus, Field):
                    # The next letter is added to what was typed; it does not replace it.
                    self.focus.select(len(self.focus.typed), len(self.focus.typed))
        old.end()

    def end(self) -> None:
        """Take all widgets away; who still has this layout, or one of its widgets, does not keep them all."""
        assert self.root is not None
        self.root.remove()
        self._sheets.clear()
        self._seen.clear()
        self._to_reveal = None
        self.tip.hide()

    # Where widgets are.

    def walk(self, widget: Widget | None = None) -> Iterator[Widget]:
        """A widget and all in it, or all of the window, in the order in which they were made."""
        top = widget or self.root
        assert top is not None
        yield top
        for child in top.children:
            yield from self.walk(child)

    @property
    def _page(self) -> list[Widget]:
        """The widgets of the topmost page."""
        if self._sheets:
            return list(self.walk(self._sheets[-1].panel))
        return list(self.walk())

    def _lay_out(self) -> None:
        """Find the visible part of each widget."""
        assert self.root is not None
        sheets = {sheet.panel for sheet in self._sheets}
        self._seen, self.is_laid = [], True
        for child in self.root.children:
            if child not in sheets:
                self._lay_out_in(child, self.root.rect)
        self._top = 0
        for sheet in self._sheets:
            self._top = len(self._seen)
            self._lay_out_in(sheet.panel, self.root.rect)

    def _lay_out_in(self, widget: Widget, clip: pygame.Rect) -> None:
        widget.seen = widget.rect.clip(clip)
        if widget.is_shown and widget.seen.width and widget.seen.height:
            self._seen.append(widget)
            for child in widget.children:
                self._lay_out_in(child, widget.seen)

    def _under(self, at: Pixel) -> list[Widget]:
        """The widgets of the topmost page at a pixel, from the top down."""
        if not self.is_laid:
            self._lay_out()
        return [widget for widget in reversed(self._seen[self._top :]) if widget.seen.collidepoint(at)]

    def _point(self, at: Pixel) -> None:
        """Note the place of the mouse, and the widget under it."""
        self.pointer = at
        under = next((widget for widget in self._under(at) if widget.image is not None), None)
        before, self.under = self.under, under
        if before is not under:
            self.tip.hide()
            for widget in (before, under):
                if widget is not None:
                    widget.on_hover()
        if under is not None and self.held is None:
            under.on_move(at)

    def _scaled(self, position: tuple[int, int]) -> Pixel:
        x, y = position
        return round(x * self.pixel_ratio[0]), round(y * self.pixel_ratio[1])

    # Events.

    @property
    def typing(self) -> bool:
        """Whether keys go into a line of text."""
        return isinstance(self.focus, Field)

    def process(self, event: pygame.event.Event) -> bool:
        """Hand an event to the widgets; True where they use it."""
        if event.type == pygame.MOUSEMOTION:
            return self._move(self._scaled(event.pos))
        if event.type == pygame.MOUSEBUTTONDOWN and event.button in (1, 2, 3):
            return self._press(self._scaled(event.pos), event.button)
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self.held is not None:
            held, self.held = self.held, None
            held.on_release(self._scaled(event.pos))
            return True
        if event.type == pygame.MOUSEWHEEL:
            notches = event.precise_y or event.y
            return any(widget.on_wheel(notches) for widget in self._under(self.pointer) if widget.is_enabled)
        if event.type == pygame.KEYDOWN:
            self.tip.hide(until_moved=True)
            return self._press_key(event)
        if event.type in (pygame.TEXTINPUT, pygame.TEXTEDITING) and isinstance(self.focus, Field):
            (self.focus.insert if event.type == pygame.TEXTINPUT else self.focus.compose)(event.text)
            return True
        return False

    def _move(self, at: Pixel) -> bool:
        held = self.held
        self._point(at)
        if held is not None:
            held.on_drag(at)
        return held is not None

    def _press(self, at: Pixel, button: int) -> bool:
        self.tip.hide(until_moved=True)
        self._point(at)
        under = self._under(at)
        if self._sheets and self._sheets[-1].is_menu and under[:1] == [self.top_sheet]:
            self._sheets[-1].close()
            return True
        # Tab goes on from what was clicked.
        self.origin = next((widget for widget in under if widget.is_focusable and widget.is_enabled), None)
        if not (isinstance(self.focus, Field) and self.focus is self.origin):
            self.blur()
            # What was typed may have laid the page out again.
            under = self._under(at)
        if button != 1:
            return any(isinstance(widget, Plate) for widget in under)
        clicks = self._count_clicks(at)
        for widget in under:
            if widget.is_enabled and widget.is_there:
                # Who is pressed may look so, and may end the drag by what it does.
                self.held = widget
                if widget.on_press(at, clicks):
                    return True
                self.held = None
        return False

    def _count_clicks(self, at: Pixel) -> int:
        (before, (x, y), count), now, near = self._clicks, pygame.time.get_ticks(), self.px(CLICK_NEAR)
        is_next = now - before <= CLICK_TIME and abs(at[0] - x) <= near and abs(at[1] - y) <= near
        self._clicks = now, at, count % 3 + 1 if is_next else 1
        return self._clicks[2]

    def _press_key(self, event: pygame.event.Event) -> bool:
        focus = self.focus
        if focus is not None and focus.takes_all_keys:
            return bool(focus.press_key(event))
        if event.key == pygame.K_TAB and not event.mod & (pygame.KMOD_CTRL | pygame.KMOD_ALT):
            self._move_focus(-1 if event.mod & pygame.KMOD_SHIFT else 1)
            return True
        if event.key == pygame.K_ESCAPE:
            return self._escape()
        if focus is None:
            return event.key in ENTER_KEYS and self._press_main()
        if focus.press_key(event):
            return True
        if isinstance(focus, Button) and self._sheets and event.key in ARROWS:
            self._step_to_button(focus, *ARROWS[event.key])
            return True
        return False

    def _press_main(self) -> bool:
        """Press the main button of the page on top, after a click beside its fields; whether there is one."""
        main = next((button for button in self.buttons() if button.is_main), None) if self._sheets else None
        if main is not None:
            main.action()
        return main is not None

    def _step_to_button(self, start: Button, dx: int, dy: int) -> None:
        """Give the keyboard to the nearest button of a page that way, if there is one."""
        here, ways = start.rect, []
        for button in self.buttons():
            x, y = button.rect.centerx - here.centerx, button.rect.centery - here.centery
            along, across = x * dx + y * dy, abs(x * dy) + abs(y * dx)
            if along > 0:
                ways.append((along + 2 * across, button))
        if ways:
            self.focus_on(min(ways, key=lambda way: way[0])[1])

    def _escape(self) -> bool:
        had_focus = self.focus is not None
        if isinstance(self.focus, Field):
            self.focus.revert()
        self.blur()
        if self._sheets:
            self._sheets[-1].close()
            return True
        return had_focus

    # The keyboard.

    def buttons(self) -> list[Button]:
        """The buttons that Tab reaches now."""
        return [widget for widget in self.ring() if isinstance(widget, Button)]

    def ring(self) -> list[Widget]:
        """The widgets that Tab goes through: those of the topmost page."""
        return [each for each in self._page if each.is_focusable and each.visible and each.is_enabled]

    def _move_focus(self, by: int) -> None:
        ring = self.ring()
        if not ring:
            return
        here = self.focus or self.origin
        start = ring.index(here) if here in ring else (-1 if by > 0 else 0)
        self.focus_on(ring[(start + by) % len(ring)])

    @property
    def focus_place(self) -> int | None:
        """Which widget of the topmost page has the keyboard, those counted that Tab leaves out now."""
        places = [each for each in self._page if each.is_focusable]
        return places.index(self.focus) if self.focus in places else None

    def focus_at(self, place: int | None) -> None:
        """Give the keyboard to a widget of the topmost page by its place, where there is one that can have it."""
        places = [each for each in self._page if each.is_focusable]
        if place is not None and place < len(places) and places[place] in self.ring():
            self.focus_on(places[place])

    def focus_on(self, widget: Widget, by_hand: bool = False) -> None:
        """Give a widget the keyboard; by_hand: it was clicked, which needs no ring around it."""
        if self.focus is not widget:
            self.blur()
        if not widget.is_there:
            return
        self.focus, self._focus_is_by_hand = widget, by_hand
        self._to_reveal = None if by_hand else widget
        widget.on_focus()

    def blur(self) -> None:
        """Take the keyboard from the widget that has it, so that keys go to the world."""
        before, self.focus = self.focus, None
        self._to_reveal = None
        if before is not None:
            before.on_blur()

    def _show_focus(self) -> None:
        """Bring what has the keyboard into sight, once after each change of it."""
        widget, self._to_reveal = self._to_reveal, None
        holder = None if widget is None else widget.parent
        while widget is not None and holder is not None:
            holder.reveal(widget)
            holder = holder.parent

    # Frames.

    def update(self, frame_time: float) -> None:
        """Update the widgets by frame_time [s]."""
        for sheet in list(self._sheets):
            if sheet.work is not None and sheet.work():
                sheet.work = None
        self._show_focus()
        at = self._scaled(pygame.mouse.get_pos())
        if at != self.pointer or not self.is_laid:
            self._point(at)
        self.tip.pass_time(frame_time)
        if isinstance(self.focus, Field):
            self.focus.pass_time(frame_time)

    def draw(self, surface: pygame.Surface) -> None:
        """Draw all widgets, the ring around the one that has the keyboard, and the tip."""
        if not self.is_laid:
            self._lay_out()
        shown = ((widget, widget.image) for widget in self._seen)
        surface.blits(
            [
                (
                    picture,
                    widget.seen,
                    widget.seen.move(-widget.rect.left, -widget.rect.top),
                    pygame.BLEND_PREMULTIPLIED,
                )
                for widget, picture in shown
                if picture is not None
            ],
            False,
        )
        if self.focus is not None and not self._focus_is_by_hand:
            self._draw_ring(surface, self.focus)
        self.tip.draw(surface)

    def _draw_ring(self, surface: pygame.Surface, focus: Widget) -> None:
        # What is scrolled out of its area has no ring either.
        clip, holder, margin = surface.get_rect(), focus.parent, self.px(5)
        while holder is not None and holder is not self.root:
            clip, holder = clip.clip(holder.rect.inflate(margin, margin)), holder.parent
        surface.set_clip(clip)
        pygame.draw.rect(surface, ACCENT, focus.rect.inflate(margin, margin), max(1, self.px(2)), self.px(8))
        surface.set_clip(None)


class Tip:
    """The only tip of a window; place: where it is shown [pixels], None while it is not."""

    def __init__(self, ui: WindowLayout) -> None:
        self._ui = ui
        self._rested = 0.0
        self._shown: tuple[Any, str] | None = None
        self._picture: pygame.Surface | None = None
        self.place: pygame.Rect | None = None

    @property
    def text(self) -> str:
        """The text of the tip that is shown; "" while none is."""
        return "" if self.place is None or self._shown is None else self._shown[1]

    def hide(self, until_moved: bool = False) -> None:
        """Hide the tip, and wait anew; until_moved: until the mouse has come to another widget."""
        self._rested = -float("inf") if until_moved else 0.0
        self._shown = self.place = self._picture = None

    def pass_time(self, seconds: float) -> None:
        """Count for how long the mouse rests [s], and show the tip once that is long enough."""
        self._rested += seconds
        under = self._ui.under
        text = under.tip if under is not None and self._ui.held is None else ""
        if not text or self._rested < DELAY:
            self._shown = self.place = self._picture = None
        elif self._shown != (under, text):
            self._shown = under, text
            self._picture = self._painted(text)
            self.place = self._placed(self._picture.get_rect(), under)

    def _painted(self, text: str) -> pygame.Surface:
        ui, font = self._ui, self._ui.font(TEXT_SIZE)
        across, down, high = ui.px(ACROSS), ui.px(DOWN), line_height(font)
        width = min(ui.px(WIDEST), ui.size[0]) - 2 * across
        lines = [line for part in text.split("\n") for line in wrapped(part, font, width, MOST_LINES)]
        wide = max(font.size(line)[0] for line in lines)
        size = wide + 2 * across, high * len(lines) + 2 * down
        picture = box(size, TIP, ui.px(CORNER), max(ui.px(1), 1)).copy()
        for number, line in enumerate(lines):
            picture.blit(font.render(line, True, TIP.text), (across, down + number * high))
        return picture

    def _placed(self, place: pygame.Rect, owner: Any) -> pygame.Rect:
        """Beside the panel at a side of the window that holds its widget, not over the next one; else below it."""
        ui, gap, holder = self._ui, self._ui.px(GAP), owner
        window = pygame.Rect((0, 0), ui.size)
        while holder.parent is not None and holder.parent is not ui.root:
            holder = holder.parent
        if holder is not owner and 2 * holder.rect.width < window.width:
            beside = place.copy()
            beside.top = max(min(owner.rect.top, window.bottom - place.height), 0)
            if holder.rect.centerx > window.centerx:
                beside.right = holder.rect.left - gap
            else:
                beside.left = holder.rect.right + gap
            if window.contains(beside):
                return beside
        place.midtop = owner.seen.centerx, owner.seen.bottom + gap
        if place.bottom > window.bottom:
            place.bottom = owner.seen.top - gap
        return place.clamp(window)

    def draw(self, surface: pygame.Surface) -> None:
        """Draw the tip, while it is shown."""
        if self.place is not None and self._picture is not None:
            surface.blit(self._picture, self.place)
