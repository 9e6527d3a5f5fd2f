"""What is drawn over the canvas: marks of snapping, the keyboard cursor, measures, and places that are pointed out."""

import pygame

from sandbox.app.draw.camera import Box, Camera, Point
from sandbox.app.draw.colours import ACCENT, BACKGROUND, MUTED, TEXT, WARNING, WELD
from sandbox.app.widgets.ui import Ui
from sandbox.editor.tools.snap import Snap

# Distance of a label from the pointer [layout units].
LABEL_GAP = 16.0
# Radius of a corner of an outline [layout units].
CORNER = 4.5
# A place that is pointed out is circled for this long [s].
SPOT_SECONDS = 1.5


def draw_snap(surface: pygame.Surface, ui: Ui, at: Point, snapped: Snap) -> None:
    """Mark a place that the pointer snaps to: a ring on particles, a cross elsewhere, and what it is in a word."""
    scale = ui.scale
    if snapped.kind in ("particle", "end"):
        pygame.draw.aacircle(surface, WELD, at, 10 * scale, max(1, round(2 * scale)))
        _tag(surface, ui, (at[0] + 13 * scale, at[1] - 26 * scale), snapped.hint)
        return
    colour = ACCENT if snapped.kind != "free" else MUTED
    size = 5 * scale
    pygame.draw.line(surface, colour, (at[0] - size, at[1]), (at[0] + size, at[1]))
    pygame.draw.line(surface, colour, (at[0], at[1] - size), (at[0], at[1] + size))
    if snapped.kind in ("angle", "corner", "edge"):
        _tag(surface, ui, (at[0] + 13 * scale, at[1] - 26 * scale), snapped.hint)


def _tag(surface: pygame.Surface, ui: Ui, at: Point, text: str) -> None:
    picture = ui.font(11).render(text, True, BACKGROUND, None)
    box = picture.get_rect(topleft=(round(at[0]), round(at[1]))).inflate(ui.px(8), ui.px(2))
    box.clamp_ip(surface.get_clip())
    pygame.draw.rect(surface, WELD if text.startswith(("on ", "joins ")) else ACCENT, box, border_radius=ui.px(4))
    surface.blit(picture, picture.get_rect(center=box.center))


def draw_label(surface: pygame.Surface, ui: Ui, pointer: Point, text: str, viewport: tuple[int, int, int, int]) -> None:
    """Draw a line of text beside the pointer, inside the viewport."""
    picture = ui.font(12).render(text, True, TEXT)
    gap = ui.px(LABEL_GAP)
    box = picture.get_rect(topleft=(round(pointer[0]) + gap, round(pointer[1]) + gap)).inflate(ui.px(12), ui.px(6))
    box.clamp_ip(pygame.Rect(viewport))
    pygame.draw.rect(surface, BACKGROUND, box, border_radius=ui.px(5))
    pygame.draw.rect(surface, ACCENT, box, 1, border_radius=ui.px(5))
    surface.blit(picture, picture.get_rect(center=box.center))


def draw_box(surface: pygame.Surface, camera: Camera, box: Box) -> None:
    """Draw a box [m] that something has to be inside of."""
    (left, bottom), (right, top) = camera.to_pixels(box[:2]), camera.to_pixels(box[2:])
    place = pygame.Rect(round(left), round(top), round(right - left), round(bottom - top))
    shade = pygame.Surface(place.clip(surface.get_clip()).size, pygame.SRCALPHA)
    shade.fill((*ACCENT, 24))
    surface.blit(shade, place.clip(surface.get_clip()))
    pygame.draw.rect(surface, ACCENT, place, 2)


def draw_outline(surface: pygame.Surface, points: list[Point], scale: float) -> None:
    """Draw corners [pixels] that are set, and the way from each to the next."""
    if len(points) > 1:
        pygame.draw.aalines(surface, ACCENT, False, points)
    for point in points:
        draw_corner(surface, point, scale, CORNER, is_chosen=False)


def draw_corner(surface: pygame.Surface, at: Point, scale: float, size: float, is_chosen: bool) -> None:
    """Draw a corner of terrain that can be taken; the chosen one is filled."""
    pygame.draw.aacircle(surface, BACKGROUND, at, (size + 1.5) * scale)
    pygame.draw.aacircle(surface, ACCENT, at, size * scale)
    if not is_chosen:
        pygame.draw.aacircle(surface, BACKGROUND, at, (size - 1.6) * scale)


def draw_cursor(surface: pygame.Surface, at: Point, scale: float) -> None:
    """Draw the keyboard cursor."""
    (x, y), near, far, width = at, 5 * scale, 14 * scale, max(1, round(2 * scale))
    for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        pygame.draw.line(surface, ACCENT, (x + dx * near, y + dy * near), (x + dx * far, y + dy * far), width)


def draw_spot(surface: pygame.Surface, at: Point, age: float, scale: float) -> None:
    """Circle a place, the narrower the longer it was ago [s]."""
    radius = (14 + 40 * max(0.0, 1.0 - 3.0 * age)) * scale
    pygame.draw.aacircle(surface, WARNING, at, radius, max(1, round(2.4 * scale)))
