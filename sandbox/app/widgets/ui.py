"""Ui: the widgets of the app. Of its files, those of widgets alone know pygame_gui; others get callbacks."""

import html
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from dataclasses import field as default
from functools import partial
from typing import Any

import pygame
import pygame_gui
from pygame_gui.core import ObjectID, UIContainer, UIElement
from pygame_gui.elements import UIButton, UILabel, UIPanel, UITextEntryLine

from sandbox.app.draw.colours import ACCENT
from sandbox.app.widgets.button import Button
from sandbox.app.widgets.fields import Choice, Field
from sandbox.app.widgets.hinted_entry import HintedEntry
from sandbox.app.widgets.layout import WindowLayout
from sandbox.app.widgets.painted import ENTER_KEYS, Painted

# It warns of every label that is a pixel lower than its font: only people who lay out can do something about that.
warnings.filterwarnings("ignore", message="Label Rect is too small", module="pygame_gui")

# Layers between the page and a modal sheet, and between one sheet and the next.
SHEET_HEIGHT = 40
# Delay and interval of a key that is held down [ms].
KEY_REPEAT = (400, 40)
ANSWERS = (
    pygame_gui.UI_BUTTON_PRESSED,
    pygame_gui.UI_TEXT_ENTRY_FINISHED,
)


# Opens a modal page again on other widgets, with what was typed so far.
Again = Callable[["Ui"], object]


@dataclass
class Sheet:
    """A modal page and the widgets on it; close: what Escape does; is_page: it is read, so no notices lie over it.

    again: opens it again in another layout; None = it ends with this one. is_question: it outlives the screen under it.
    """

    panel: UIPanel
    close: Callable[[], None]
    is_page: bool
    again: Again | None
    is_question: bool
    widgets: list[UIElement] = default(default_factory=list)


ARROWS = {pygame.K_LEFT: (-1, 0), pygame.K_RIGHT: (1, 0), pygame.K_UP: (0, -1), pygame.K_DOWN: (0, 1)}


class Ui(WindowLayout):
    """Widgets on a window of size [pixels]; positions and sizes given to it are layout units of `scale` pixels."""

    def __init__(self, size: tuple[int, int], scale: float, pixel_ratio: tuple[float, float] = (1.0, 1.0)) -> None:
        super().__init__(size, scale, pixel_ratio)
        self._actions: dict[UIElement, Callable[[], None]] = {}
        self._fields: dict[UIElement, Field] = {}
        self._sheets: list[Sheet] = []
        self._page: list[UIElement] = []
        pygame.key.set_repeat(*KEY_REPEAT)
        self._focus: UIElement | None = None
        # The line that Enter left: Tab goes on from there.
        self._left: UIElement | None = None

    def panel(self, rect: pygame.Rect, container: Any = None, style: str = "") -> UIPanel:
        """A background that holds other widgets."""
        return UIPanel(rect, 1, self.manager, container=container, margins=_NO_MARGINS, object_id=_style(style))

    def area(self, rect: pygame.Rect, container: Any = None) -> UIContainer:
        """A part of the window that clips what it holds."""
        return UIContainer(rect, self.manager, container=container)

    def label(self, rect: pygame.Rect, text: str, container: Any = None, style: str = "") -> UILabel:
        """One line of text."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return UILabel(rect, text, self.manager, container=container, object_id=_style(style))

    def button(
        self,
        rect: pygame.Rect,
        text: str,
        action: Callable[[], None],
        container: Any = None,
        *,
        style: str = "",
        icon: pygame.Surface | None = None,
        tip: str = "",
    ) -> Button:
        """A button with text or an icon."""
        button = Button(
            rect, text, self.manager, container=container, object_id=_style(style), icon=icon,
            tool_tip_text=_escaped(tip) or None,
        )  # fmt: skip
        self._actions[button] = action
        self._add_focusable(button)
        return button

    def choice(
        self,
        rect: pygame.Rect,
        options: Sequence[tuple[str, str, str]],
        choose: Callable[[str], None],
        container: Any = None,
    ) -> Choice:
        """A row of buttons, one per (value, text, tip), that share the rectangle."""
        buttons, count, gap = {}, len(options), self.px(3)
        width = (rect.width - gap * (count - 1)) / count
        for index, (value, text, tip) in enumerate(options):
            left, right = round(index * (width + gap)), round(index * (width + gap) + width)
            place = pygame.Rect(rect.left + left, rect.top, right - left, rect.height)
            buttons[value] = self.button(place, text, partial(choose, value), container, style="@segment", tip=tip)
        return Choice(buttons)

    def field(
        self, rect: pygame.Rect, text: str, commit: Callable[[str], bool], container: Any = None, limit: int = 200,
        *, hint: str = "",
    ) -> Field:  # fmt: skip
        """A line to type into; hint: what it says while it is empty."""
        entry = HintedEntry(rect, self.manager, container=container, initial_text=text, placeholder_text=hint or None)
        entry.set_text_length_limit(limit)
        self._fields[entry] = Field(entry, commit, text)
        self._add_focusable(entry)
        return self._fields[entry]

    def add(self, widget: Painted) -> None:
        """Let a painted widget be reached by Tab."""
        self._add_focusable(widget)

    def _add_focusable(self, widget: UIElement) -> None:
        (self._sheets[-1].widgets if self._sheets else self._page).append(widget)

    def remove(self, widget: UIElement) -> None:
        """Take a widget away; one that has the keyboard gives it back."""
        self._forget(widget)
        self._page = [other for other in self._page if other is not widget]
        if self._focus is widget:
            self._set_focus(None)
        widget.kill()

    def _forget(self, widget: UIElement) -> None:
        self._actions.pop(widget, None)
        self._fields.pop(widget, None)

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
    def top_sheet(self) -> UIPanel | None:
        """The topmost modal page."""
        return self._sheets[-1].panel if self._sheets else None

    @property
    def has_question(self) -> bool:
        """Whether a question is open that outlives the screen."""
        return any(sheet.is_question for sheet in self._sheets)

    def open_sheet(
        self,
        close: Callable[[], None],
        style: str = "@shade",
        *,
        is_page: bool = False,
        again: Again | None = None,
        is_question: bool = False,
    ) -> UIPanel:
        """Cover the window by a modal page; close is called when Escape asks for it; the others are those of Sheet."""
        sheet = UIPanel(
            pygame.Rect((0, 0), self.size),
            SHEET_HEIGHT * (len(self._sheets) + 1),
            self.manager,
            margins=_NO_MARGINS,
            object_id=_style(style),
        )
        self._sheets.append(Sheet(sheet, close, is_page, again, is_question))
        self._set_focus(None)
        return sheet

    def close_sheet(self, sheet: UIPanel) -> None:
        """Take a modal page away."""
        for entry in [entry for entry in self._sheets if entry.panel is sheet]:
            for widget in entry.widgets:
                self._forget(widget)
        self._sheets = [entry for entry in self._sheets if entry.panel is not sheet]
        self._set_focus(None)
        sheet.kill()

    def take_over(self, before: "Ui", questions_alone: bool = False) -> None:
        """Open the modal pages of an earlier layout, and end that; questions_alone: pages of its screen are left."""
        for sheet in before._sheets:
            if sheet.again is not None and (sheet.is_question or not questions_alone):
                sheet.again(self)
                if isinstance(self._focus, UITextEntryLine):
                    # The next letter is added to what was typed; it does not replace it.
                    self._focus.select_range = [0, 0]
                    self._focus.edit_position = len(self._focus.get_text())
        before._end()

    def _end(self) -> None:
        """Take all widgets away; who still has this layout, or one of its widgets, does not keep them all."""
        self.manager.clear_and_reset()
        # The library would find out what is still to be seen when it draws next.
        self.manager.ui_group.update_visibility()
        for widgets in (self._actions, self._fields, self._sheets, self._page):
            widgets.clear()
        self._focus = self._left = None

    # Events and focus.

    @property
    def typing(self) -> bool:
        """Whether keys go into a line of text."""
        return any(field.entry.is_focused for field in self._fields.values())

    @property
    def focus(self) -> UIElement | None:
        """The widget that the keyboard works on."""
        return self._focus

    def buttons(self) -> list[UIButton]:
        """The buttons that Tab reaches now."""
        return [widget for widget in self._ring() if isinstance(widget, UIButton)]

    def process(self, event: pygame.event.Event) -> bool:
        """Let the widgets have an event; True where they use it."""
        if event.type == pygame.MOUSEMOTION:
            # The wheel turns what it points at now, not what it pointed at when the last frame was drawn.
            self.manager.mouse_position = self.manager.calculate_scaled_mouse_position(event.pos)
        if event.type == pygame_gui.UI_BUTTON_PRESSED and event.ui_element in self._actions:
            self._actions[event.ui_element]()
            return True
        if event.type == pygame_gui.UI_TEXT_ENTRY_FINISHED and event.ui_element in self._fields:
            field = self._fields[event.ui_element]
            if field.enter is None:
                field.finish()
                self._set_focus(None)
                self._left = event.ui_element
            else:
                field.enter(event.text)
            return True
        if event.type == pygame.KEYDOWN and self._press_key(event):
            return True
        if event.type == pygame.MOUSEWHEEL and self._turn(event.precise_y or event.y):
            return True
        if event.type == pygame.MOUSEBUTTONDOWN and event.button in (1, 2, 3):
            # Tab goes on from what was clicked.
            self._focus, self._left = None, self._under_mouse()
        used = bool(self.manager.process_events(event))
        self._finish_left_fields()
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1:
            self._select_number()
        # What a widget answers comes before what the person did next, which may be in the queue already.
        for answer in pygame.event.get(ANSWERS, pump=False):
            self.process(answer)
        return used

    def _under_mouse(self) -> UIElement | None:
        at = self.manager.get_mouse_position()
        return next((widget for widget in reversed(self._ring()) if widget.hover_point(*at)), None)

    def _turn(self, notches: float) -> bool:
        """Step the value of the line under the mouse, or of the painted widget that was clicked, where it has steps."""
        under, here = self._under_mouse(), self._focus or self._left
        if isinstance(under, Painted):
            return under is here and under.turn(notches)
        field = self._fields.get(under) if under is not None else None
        return field is not None and field.step(1 if notches > 0.0 else -1)

    def _select_number(self) -> None:
        """Select the number in a line that a click has begun to edit, so that what is typed replaces it."""
        field = self._fields.get(self._left) if self._left is not None else None
        if field is None or not field.entry.is_focused or not field.is_begun:
            return
        field.is_begun = False
        first, last = field.entry.select_range
        if first == last and field.is_number:
            field.entry.select_range = [0, len(field.entry.get_text())]

    def _finish_left_fields(self) -> None:
        for field in list(self._fields.values()):
            if field.focused and not field.entry.is_focused:
                field.finish()
                # A line of text that is left turns the repetition of keys off.
                pygame.key.set_repeat(*KEY_REPEAT)
            elif field.entry.is_focused and not field.focused:
                field.is_begun = True
            field.focused = field.entry.is_focused

    def _press_key(self, event: pygame.event.Event) -> bool:
        typed_into = next((field for field in self._fields.values() if field.entry.is_focused), None)
        if isinstance(self._focus, Painted) and self._focus.takes_all_keys:
            return self._focus.press_key(event)
        if event.key == pygame.K_TAB and not event.mod & (pygame.KMOD_CTRL | pygame.KMOD_ALT):
            self._move_focus(-1 if event.mod & pygame.KMOD_SHIFT else 1)
            return True
        if event.key == pygame.K_ESCAPE:
            return self._escape(typed_into)
        if typed_into is not None:
            by = {pygame.K_UP: 1, pygame.K_DOWN: -1}.get(event.key)
            return by is not None and typed_into.step(by)
        if self._focus is None:
            return False
        if isinstance(self._focus, Painted):
            return self._focus.press_key(event)
        if isinstance(self._focus, UIButton) and event.key in (*ENTER_KEYS, pygame.K_SPACE):
            self._actions[self._focus]()
            return True
        if isinstance(self._focus, UIButton) and self._sheets and event.key in ARROWS:
            self._step_to_button(*ARROWS[event.key])
            return True
        return False

    def _step_to_button(self, dx: int, dy: int) -> None:
        """Give the keyboard to the nearest button of a page that way, if there is one."""
        assert self._focus is not None
        here = self._focus.rect
        ways = []
        for button in self.buttons():
            x, y = button.rect.centerx - here.centerx, button.rect.centery - here.centery
            along, across = x * dx + y * dy, abs(x * dy) + abs(y * dx)
            if along > 0:
                ways.append((along + 2 * across, button))
        if ways:
            self._set_focus(min(ways, key=lambda way: way[0])[1])

    def _escape(self, typed_into: Field | None) -> bool:
        if typed_into is not None:
            typed_into.revert()
        if typed_into is not None or self._focus is not None:
            self._set_focus(None)
            if not self._sheets:
                return True
        if self._sheets:
            self._sheets[-1].close()
            return True
        return False

    def _move_focus(self, by: int) -> None:
        ring = self._ring()
        if not ring:
            return
        here = self._focus or self._left
        start = ring.index(here) if here in ring else (-1 if by > 0 else 0)
        self._set_focus(ring[(start + by) % len(ring)])

    @property
    def _topmost(self) -> list[UIElement]:
        return self._sheets[-1].widgets if self._sheets else self._page

    def _ring(self) -> list[UIElement]:
        """What Tab goes through: the widgets of the topmost page."""
        ring = self._topmost
        return [widget for widget in ring if widget.alive() and widget.visible and getattr(widget, "is_enabled", True)]

    @property
    def focus_place(self) -> int | None:
        """Which widget of the topmost page has the keyboard, those counted that Tab leaves out now."""
        return self._topmost.index(self._focus) if self._focus in self._topmost else None

    def focus_at(self, place: int | None) -> None:
        """Give the keyboard to a widget of the topmost page by its place, where there is one that can have it."""
        if place is not None and place < len(self._topmost) and self._topmost[place] in self._ring():
            self._set_focus(self._topmost[place])

    def focus_on(self, widget: UIElement) -> None:
        """Give a widget the keyboard."""
        self._set_focus(widget)

    def _set_focus(self, widget: UIElement | None) -> None:
        self._focus = widget
        entry = widget if isinstance(widget, UITextEntryLine) else None
        self.manager.set_focus_set(entry.get_focus_set() if entry is not None else None)
        if entry is not None:
            entry.select_range = [0, len(entry.get_text())]
        self._finish_left_fields()

    def blur(self) -> None:
        """Give the keyboard back to the world."""
        self._set_focus(None)

    def update(self, frame_time: float) -> None:
        """Let the widgets move on by frame_time [s]."""
        self.manager.update(frame_time)

    def draw(self, surface: pygame.Surface) -> None:
        """Draw all widgets, and the ring around the one that has the keyboard."""
        self.manager.draw_ui(surface)
        if self._focus is not None and self._focus.alive():
            around = self._focus.rect.inflate(self.px(5), self.px(5))
            # What is scrolled out of its area has no ring either.
            clip = surface.get_rect()
            holder: Any = self._focus.ui_container
            while holder is not None and holder is not self.root:
                clip, holder = clip.clip(holder.rect.inflate(self.px(5), self.px(5))), holder.ui_container
            surface.set_clip(clip)
            pygame.draw.rect(surface, ACCENT, around, max(1, self.px(2)), self.px(8))
            surface.set_clip(None)


_NO_MARGINS = {"left": 0, "right": 0, "top": 0, "bottom": 0}


def _style(style: str) -> ObjectID | None:
    return ObjectID(class_id=style) if style else None


def _escaped(text: str) -> str:
    return html.escape(text, quote=False).replace("\n", "<br>")
