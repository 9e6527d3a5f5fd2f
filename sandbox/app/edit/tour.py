"""Guide: the tour on the screen: a small card with the step, and a ring around what it points at; it blocks nothing."""

import math
from typing import Any

import pygame

from sandbox.app.contracts.application import Application
from sandbox.app.draw.colours import ACCENT, MUTED, TEXT, WARNING
from sandbox.app.edit.canvas.pointer import DrawTool
from sandbox.app.edit.documents import DocumentActions
from sandbox.app.edit.edit_screen import EditScreen
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.editor.storage.preferences import preference, set_preference
from sandbox.editor.tour import STEPS, Situation, Target, Tour

# Name of the preference, and sizes in layout units.
SEEN = "tour_seen"
WIDTH, HEIGHT = 330.0, 138.0
# Where the canvas is narrower, the card is too, and higher by this.
EXTRA_HEIGHT = 36.0
PADDING = 14.0
COUNT_SIZE = 11.5
GAP = 18.0
BUTTON_WIDTH, BUTTON_HEIGHT = 74.0, 28.0
RING = 5.0
SPOT = 17.0
# The ring grows and shrinks once in this time [s].
PULSE_SECONDS = 1.4

Place = tuple[int, int]


class Guide:
    """Offers the tour once, and leads through it; may_offer: whether a person is there to be asked."""

    def __init__(self, app: Application, documents: DocumentActions) -> None:
        self._app, self._documents = app, documents
        self.may_offer = False
        self.tour: Tour | None = None
        self._offers = False
        self._card: pygame.Rect | None = None
        self._panel: Any = None
        self.buttons: dict[str, Any] = {}
        self._made_for: tuple[object, ...] = ()
        self._seconds = 0.0

    # What the person can do.

    def offer(self) -> None:
        """Ask whether the person wants the tour, the first time that they see a sheet on which nothing moves yet."""
        editor = self._documents.editor
        if self.may_offer and editor is not None and not len(editor.scene.position) and not preference(SEEN):
            set_preference(SEEN, True)
            self._offers = True

    def begin(self) -> None:
        """Start from an empty sheet."""
        self._documents.new(self._start)

    def _start(self) -> None:
        self.tour, self._offers = Tour(), False

    def skip(self) -> None:
        """End the tour, or want none; F1 has it again."""
        if self._offers:
            self._app.say("You can start the tour again from the help page (F1).")
        self.tour, self._offers = None, False
        self._take_away()

    def _back(self) -> None:
        if self.tour is not None:
            self.tour.back()

    def _next(self) -> None:
        if self.tour is not None:
            self.tour.next()

    # The card.

    def build(self) -> None:
        """Lay the card out again, the window's widgets being new."""
        self._panel, self._made_for, self.buttons = None, (), {}

    def _take_away(self) -> None:
        if self._panel is not None:
            self._panel.remove()
        self._card = None
        self.build()

    @property
    def moves(self) -> bool:
        """Whether the ring swells."""
        return self._card is not None and self.tour is not None and not self.tour.is_over

    def update(self, frame_time: float) -> None:
        """Follow what the person does, and show the step."""
        self._seconds += frame_time
        situation = self._situation()
        # The offer is about the sheet: over a run of the level it has no place.
        offers = self._offers and self._app.mode == "edit"
        if (self.tour is None and not offers) or situation is None:
            if self._panel is not None:
                self._take_away()
            return
        if self.tour is not None:
            self.tour.follow(situation)
        place = self._card_place(self._spot(situation))
        key = (*place, self._offers, self.tour and (self.tour.index, self.tour.stays))
        if key != self._made_for:
            self._take_away()
            self._made_for, self._card = key, place
            self._make(self._app.ui, place)

    def _make(self, ui: Ui, place: pygame.Rect) -> None:
        tour = self.tour
        self._panel = panel = ui.panel(place, style="dialog")
        width, height = place.width / ui.scale, place.height / ui.scale
        inside = width - 2 * PADDING
        if tour is None:
            title, count = "New here?", f"{len(STEPS)} steps"
            text = "A short tour: you build a rope bridge that carries a weight, and play it."
        else:
            title, text = tour.step.title, tour.step.text
            count = "" if tour.is_over else f"{tour.index + 1} of {len(STEPS)}"
        ui.label(ui.rect(PADDING, 10, inside - 60, 22), title, panel, "title")
        wide = ui.font(COUNT_SIZE).size(count)[0] / ui.scale + 2
        TextBlock(ui, ui.rect(width - PADDING - wide, 15, wide, 18), count, panel, COUNT_SIZE, MUTED)
        TextBlock(ui, ui.rect(PADDING, 38, inside, height - 82), text, panel, 12.5, TEXT)
        x, y = width - PADDING - BUTTON_WIDTH, height - PADDING - BUTTON_HEIGHT + 4
        for name, label, action, style in self._offered():
            button = ui.button(ui.rect(x, y, BUTTON_WIDTH, BUTTON_HEIGHT), label, action, panel, style=style)
            self.buttons[name] = button
            x -= BUTTON_WIDTH + 8

    def _offered(self) -> list[tuple[str, str, Any, str]]:
        """Buttons from the right: name, label, what it does, style."""
        if self.tour is None:
            return [("start", "Start", self.begin, "primary"), ("skip", "Skip", self.skip, "quiet")]
        if self.tour.is_over:
            return [("skip", "Done", self.skip, "primary")]
        buttons = [("next", "Next", self._next, "primary")] if self.tour.stays else []
        if self.tour.index:
            buttons.append(("back", "Back", self._back, ""))
        return [*buttons, ("skip", "Skip", self.skip, "quiet")]

    # Where things are.

    def _situation(self) -> Situation | None:
        """What the person has done; None where neither the document nor a run of it is on the screen."""
        app, editor = self._app, self._documents.editor
        is_played = app.play is not None and app.play.of_document
        if editor is None or app.gallery is not None or not (app.screen is editor or is_played):
            return None
        options = editor.pointer_tool.drawing.options if isinstance(editor.pointer_tool, DrawTool) else None
        return Situation(editor.scene, editor.tool, options, is_played)

    def _spot(self, situation: Situation) -> pygame.Rect | None:
        """The part of the window [pixels] that the step points at; None = the whole canvas."""
        editor = self._documents.editor
        if self.tour is None or editor is None or self._app.screen is not editor:
            return None
        return _rect_of(self.tour.step.target(situation), editor)

    def _viewport(self) -> pygame.Rect:
        screen = self._app.screen
        assert screen is not None
        return pygame.Rect(screen.camera.viewport)

    def _card_place(self, spot: pygame.Rect | None) -> pygame.Rect:
        """Beside what it points at, inside the canvas; away from a place in the level, and from the bar's tooltips."""
        ui, view = self._app.ui, self._viewport()
        gap = ui.px(GAP)
        card = ui.rect(0, 0, WIDTH, HEIGHT)
        if card.width > view.width - 2 * gap:
            card.width, card.height = view.width - 2 * gap, ui.px(HEIGHT + EXTRA_HEIGHT)
        card.topleft = view.left + gap, view.top + gap
        if spot is not None and not view.colliderect(spot):
            card.center = spot.center
        card.clamp_ip(view.inflate(-2 * gap, -2 * gap))
        hides_spot = spot is not None and view.colliderect(spot) and card.inflate(4 * gap, 4 * gap).colliderect(spot)
        if hides_spot or self._app.mode == "play":
            card.right = view.right - gap
        return card

    # Drawing.

    def draw(self, surface: pygame.Surface) -> None:
        """Point at the widget or place that the step is about."""
        situation = self._situation()
        if self._card is None or self.tour is None or situation is None or self._app.ui.has_sheet:
            return
        spot = self._spot(situation)
        if spot is not None:
            self._ring(surface, spot)
        elif not self.tour.is_over:
            self._arrow_across(surface)

    def _ring(self, surface: pygame.Surface, spot: pygame.Rect) -> None:
        ui, card = self._app.ui, self._card
        assert card is not None
        swell = RING + 2.0 * math.sin(math.tau * self._seconds / PULSE_SECONDS)
        ring = spot.inflate(2 * ui.px(swell), 2 * ui.px(swell))
        pygame.draw.rect(surface, WARNING, ring, max(2, ui.px(2)), ui.px(9))
        # From the ring to the nearest point of the card.
        near = pygame.Vector2(
            min(max(ring.centerx, card.left), card.right), min(max(ring.centery, card.top), card.bottom)
        )
        edge = pygame.Vector2(min(max(near.x, ring.left), ring.right), min(max(near.y, ring.top), ring.bottom))
        if (near - edge).length() > 2:
            pygame.draw.aaline(surface, WARNING, near, edge)

    def _arrow_across(self, surface: pygame.Surface) -> None:
        editor, view = self._documents.editor, self._viewport()
        tool = editor.pointer_tool if editor is not None else None
        if not isinstance(tool, DrawTool) or tool.drawing.under_way:
            return
        head, y = self._app.ui.px(9), view.top + round(view.height * 0.45)
        start, end = view.left + view.width // 4, view.right - view.width // 4
        pygame.draw.line(surface, ACCENT, (start, y), (end, y), 2)
        pygame.draw.lines(surface, ACCENT, False, [(end - head, y - head), (end, y), (end - head, y + head)], 2)
        pygame.draw.aacircle(surface, ACCENT, (start, y), head // 2)


def _rect_of(target: Target, editor: EditScreen) -> pygame.Rect | None:
    """Where a target is in the window [pixels]; None = the whole canvas."""
    if isinstance(target, tuple):
        x, y = editor.camera.to_pixels(target)
        size = editor.ui.px(SPOT)
        return pygame.Rect(round(x) - size // 2, round(y) - size // 2, size, size)
    if target in editor.options.fields:
        return editor.options.fields[target][0].rect.copy()
    button = editor.palette.tools.get(target.removeprefix("tool_")) or editor.bar.buttons.get(target)
    return button.rect.copy() if button is not None else None
