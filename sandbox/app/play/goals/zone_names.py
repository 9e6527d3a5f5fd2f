"""The names of zones, written at their tops while their outlines are shown."""

from collections.abc import Sequence

import pygame

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.themes import Theme
from sandbox.app.draw.views.zone_outlines import name_place
from sandbox.app.widgets.ui import Ui
from sandbox.level.document.model import ZoneDef

# Sizes in layout units: of the text, of what surrounds it, and how far it is above its zone.
TEXT_SIZE, AROUND, ABOVE = 12.0, 4.0, 3.0
OPACITY = 200


def draw_zone_names(surface: pygame.Surface, ui: Ui, camera: Camera, zones: Sequence[ZoneDef], theme: Theme) -> None:
    """Write the name of each zone where it begins to be above it, inside the view."""
    font, view = ui.font(TEXT_SIZE, True), pygame.Rect(camera.viewport)
    for zone in zones:
        text = font.render(zone.id, True, theme.accent)
        plate = pygame.Surface((text.width + 2 * ui.px(AROUND), text.height + ui.px(AROUND)), pygame.SRCALPHA)
        pygame.draw.rect(plate, (*theme.card, OPACITY), plate.get_rect(), border_radius=ui.px(4))
        plate.blit(text, text.get_rect(center=plate.get_rect().center))
        x, y = camera.to_pixels(name_place(zone))
        if not view.inflate(view.size).collidepoint(x, y):
            continue
        place = plate.get_rect(midbottom=(round(x), round(y) - ui.px(ABOVE)))
        surface.blit(plate, place.clamp(view) if place.colliderect(view) else place)
