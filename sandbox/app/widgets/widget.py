"""Widget: a rectangle in the window that paints itself and reacts; and the two kinds that mouse and keys work on."""

from typing import Any, ClassVar

import pygame

from sandbox.app.widgets.fonts import plain_font


class WindowLayout:
    """A window of size [pixels]; positions and sizes given to it are layout units of `scale` pixels.

    pixel_ratio: pixels per unit of a mouse position. pointer: where the mouse is [pixels], and under: the widget that
    it is over. focus: the widget that has the keyboard. held: the one on which the left button was pressed, until it is
    let go. origin: what was clicked or left last, from which Tab goes on. is_laid: whether it is known where all are.
    """

    # The widgets are of classes that know this one.
    root: Any

    def __init__(self, size: tuple[int, int], scale: float, pixel_ratio: tuple[float, float] = (1.0, 1.0)) -> None:
        self.size = size
        self.scale = scale
        self.pixel_ratio = pixel_ratio
        self.pointer = (-1, -1)
        self.under: Any = None
        self.focus: Any = None
        self.held: Any = None
        self.origin: Any = None
        self.is_laid = False

    def px(self, units: float) -> int:
        """Layout units in pixels."""
        return round(units * self.scale)

    def rect(self, x: float, y: float, width: float, height: float) -> pygame.Rect:
        """A rectangle of layout units in pixels."""
        return pygame.Rect(self.px(x), self.px(y), self.px(width), self.px(height))

    @property
    def units(self) -> tuple[float, float]:
        """Size of the window in layout units."""
        return self.size[0] / self.scale, self.size[1] / self.scale

    def font(self, size: float, bold: bool = False) -> pygame.font.Font:
        """The widgets' font in a size of layout units."""
        return plain_font(self.px(size), bold)

    def focus_on(self, widget: Any, by_hand: bool = False) -> None:
        """Give a widget the keyboard; by_hand: it was clicked, which needs no ring around it."""
        raise NotImplementedError

    def blur(self) -> None:
        """Take the keyboard from the widget that has it, so that keys go to the world."""
        raise NotImplementedError

    def forget(self, widget: Any) -> None:
        """Forget a widget that is removed."""
        for name in ("under", "focus", "held", "origin"):
            if getattr(self, name) is widget:
                setattr(self, name, None)


ENTER_KEYS = (pygame.K_RETURN, pygame.K_KP_ENTER)

Pixel = tuple[int, int]


class Widget:
    """A widget in another one (None: in the page); rect: its place in the window, which is kept [pixels].

    place: its rectangle in what holds it. seen: what of it nothing cuts off, as the window was laid out last. tip: what
    is said of it while the mouse rests on it. A widget that paints nothing holds others, and cuts off what is outside.
    """

    # Whether Tab reaches it; whether it looks different under the mouse and with the keyboard.
    is_focusable = False
    is_lit = False
    # Whether Tab and Escape too go to `press_key` while it has the keyboard.
    takes_all_keys = False

    def __init__(self, ui: WindowLayout, rect: pygame.Rect, parent: "Widget | None" = None) -> None:
        self.ui = ui
        self.parent: Widget | None = parent or ui.root
        self.children: list[Widget] = []
        self.place = pygame.Rect(rect)
        self.rect: pygame.Rect = self.place.move(self.parent.rect.topleft if self.parent is not None else (0, 0))
        self.seen = pygame.Rect(0, 0, 0, 0)
        self.tip = ""
        self.is_there = True
        self._is_visible = self._is_enabled = True
        self._picture: pygame.Surface | None = None
        self._is_stale = True
        if self.parent is not None:
            self.parent.children.append(self)
        ui.is_laid = False

    # What it looks like.

    def paint(self, size: tuple[int, int]) -> pygame.Surface | None:
        """The picture of the widget as it is now, with straight alpha; None: it has none."""
        return None

    def repaint(self) -> None:
        """Paint the widget anew, once it is seen."""
        self._is_stale = True

    @property
    def image(self) -> pygame.Surface | None:
        """The widget's picture, its colours multiplied by their alpha; None where there is no room for it."""
        if self._is_stale:
            self._is_stale = False
            picture = self.paint((max(self.rect.width, 0), max(self.rect.height, 0)))
            self._picture = picture if picture is None else picture.premul_alpha()
        return self._picture

    @property
    def hovered(self) -> bool:
        """Whether the mouse is over it, and over no other widget that lies on it."""
        return self.ui.under is self

    @property
    def focused(self) -> bool:
        """Whether the widget has the keyboard."""
        return self.ui.focus is self

    @property
    def in_hand(self) -> bool:
        """Whether the widget has the keyboard, or was clicked last."""
        return self is (self.ui.focus or self.ui.origin)

    @property
    def visible(self) -> bool:
        """Whether the widget and all that holds it are shown."""
        return self._is_visible and (self.parent is None or self.parent.visible)

    @visible.setter
    def visible(self, is_visible: bool) -> None:
        if is_visible != self._is_visible:
            self._is_visible = is_visible
            self.ui.is_laid = False

    @property
    def is_shown(self) -> bool:
        """Whether the widget is shown where its holder is."""
        return self._is_visible

    @property
    def is_enabled(self) -> bool:
        """Whether the widget can be used."""
        return self._is_enabled

    @is_enabled.setter
    def is_enabled(self, is_enabled: bool) -> None:
        if is_enabled != self._is_enabled:
            self._is_enabled = is_enabled
            self.repaint()

    # Where it is.

    def move_to(self, corner: Pixel) -> None:
        """Move the widget inside its holder."""
        if corner != self.place.topleft:
            by = corner[0] - self.place.left, corner[1] - self.place.top
            self.place.topleft = corner
            self._shift(by)
            self.ui.is_laid = False

    def _shift(self, by: Pixel) -> None:
        self.rect = self.rect.move(by)
        for child in self.children:
            child._shift(by)

    def resize(self, size: tuple[int, int]) -> None:
        """Give the widget another size."""
        if size != self.place.size:
            self.place.size = size
            self.rect = pygame.Rect(self.rect.topleft, size)
            self.repaint()
            self.ui.is_laid = False

    def reveal(self, widget: "Widget") -> None:
        """Bring one of the widgets inside into sight."""

    def remove(self) -> None:
        """Remove the widget, with all inside."""
        if self.is_there and self.parent is not None:
            self.parent.children.remove(self)
        self._end()

    def _end(self) -> None:
        # Whoever has it still, keeps nothing of it.
        self.is_there = False
        self._picture, self._is_stale = None, False
        self.ui.forget(self)
        self.clear()

    def clear(self) -> None:
        """Remove all widgets inside."""
        for child in self.children:
            child._end()
        self.children.clear()
        self.ui.is_laid = False

    # What mouse and keys do.

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """React to the left button, pressed on it; True: it is used, and what follows until it is let go comes here."""
        return False

    def on_drag(self, at: Pixel) -> None:
        """React to the mouse, which has moved while the button is held."""

    def on_release(self, at: Pixel) -> None:
        """React to the button, which is let go."""

    def on_move(self, at: Pixel) -> None:
        """React to the mouse, which moves over the widget."""

    def on_hover(self) -> None:
        """React to the mouse, which has come or gone."""
        if self.is_lit:
            self.repaint()

    def on_wheel(self, notches: float) -> bool:
        """React to the wheel; True: the event is used."""
        return False

    def on_focus(self) -> None:
        """React to the keyboard, which the widget has now."""
        if self.is_lit:
            self.repaint()

    def on_blur(self) -> None:
        """React to the keyboard, which the widget has no longer."""
        if self.is_lit:
            self.repaint()

    def press_key(self, event: pygame.event.Event) -> bool:
        """React to a key while the widget has the keyboard; True: the event is used."""
        return False


class Pressable(Widget):
    """A widget that a click presses, and while it has the keyboard a key."""

    is_focusable = True
    press_keys: ClassVar[tuple[int, ...]] = (*ENTER_KEYS, pygame.K_SPACE)

    def press(self) -> None:
        """Do what a press of the widget does."""
        raise NotImplementedError

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Press on a click."""
        self.press()
        return True

    def press_key(self, event: pygame.event.Event) -> bool:
        """Press by a key."""
        if event.key not in self.press_keys:
            return False
        self.press()
        return True


class Draggable(Widget):
    """A widget on which the mouse drags something."""

    is_focusable = True

    def can_drag(self) -> bool:
        """Whether the mouse may drag the widget."""
        return True

    def on_press(self, at: Pixel, clicks: int) -> bool:
        """Begin the drag."""
        if self.can_drag():
            self.on_drag(at)
        return self.can_drag()
