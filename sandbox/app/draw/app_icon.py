"""The app's icon: a jelly with a face on a spring. `python -m sandbox.app.draw.app_icon` draws assets/icon.png."""

import os

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

import math

import numpy as np
import pygame

from sandbox.app.draw.colours import CHEEK, INK, outline_of, unpacked
from sandbox.level.format.look import PALETTE
from sandbox.level.format.shipped import shipped_folder

# Side of the file [pixels], and how much larger it is drawn for smooth edges. All else is in parts of the side.
SIDE, OVERSAMPLING = 256, 4
BODY, CORNER = (0.14, 0.06, 0.72, 0.60), 0.20
COIL_TOP, COIL_BOTTOM, COIL_WIDE, COIL_TURNS, WIRE = 0.64, 0.93, 0.24, 2.5, 0.055
STEEL, STEEL_LIGHT = 0x5B6780, 0xB9C4D8


def icon_file() -> str:
    """Where the icon is shipped."""
    return str(shipped_folder("assets") / "icon.png")


def app_icon(side: int) -> pygame.Surface:
    """The icon of this many pixels, with straight alpha."""
    large = side * OVERSAMPLING
    picture = pygame.Surface((large, large), pygame.SRCALPHA)
    _draw_spring(picture, large)
    _draw_body(picture, large)
    _draw_face(picture, large)
    return pygame.transform.smoothscale(_bled(picture), (side, side))


def _bled(picture: pygame.Surface) -> pygame.Surface:
    """The picture with the outline's colour under its transparent pixels, which scaling mixes in."""
    below = pygame.Surface(picture.get_size(), pygame.SRCALPHA)
    below.fill((*unpacked(outline_of(PALETTE["raspberry"])), 0))
    below.blit(picture, (0, 0))
    return below


def _draw_spring(picture: pygame.Surface, k: int) -> None:
    t = np.linspace(0.0, 1.0, 160)
    x = 0.5 + COIL_WIDE * np.sin(2.0 * math.pi * COIL_TURNS * t)
    points = np.stack([x, COIL_TOP - 0.05 + (COIL_BOTTOM - COIL_TOP + 0.05) * t], axis=1) * k
    foot = [(0.24 * k, COIL_BOTTOM * k), (0.76 * k, COIL_BOTTOM * k)]
    for colour, wide in ((outline_of(STEEL), WIRE + 0.03), (STEEL, WIRE), (STEEL_LIGHT, 0.4 * WIRE)):
        radius = 0.5 * wide * k
        for line in (points.tolist(), foot):
            pygame.draw.lines(picture, unpacked(colour), False, line, round(2 * radius))
            for point in line:
                pygame.draw.circle(picture, unpacked(colour), point, radius)


def _draw_body(picture: pygame.Surface, k: int) -> None:
    colour = PALETTE["raspberry"]
    left, top, wide, high = (part * k for part in BODY)
    body, line = pygame.Rect(left, top, wide, high), round(0.022 * k)
    pygame.draw.rect(
        picture, unpacked(outline_of(colour)), body.inflate(2 * line, 2 * line), border_radius=int(CORNER * k)
    )
    mask = pygame.Surface(body.size, pygame.SRCALPHA)
    pygame.draw.rect(mask, (255, 255, 255), mask.get_rect(), border_radius=int((CORNER - 0.02) * k))
    # Lit from above left: lighter there, darker below.
    y, x = np.mgrid[0 : body.height, 0 : body.width] / np.array([[[body.height]], [[body.width]]])
    light = 1.12 - 0.34 * (0.75 * y + 0.25 * x)
    shaded = np.clip(light[..., None] * np.array(unpacked(colour)), 0, 255).astype(np.uint8)
    skin = pygame.Surface(body.size, pygame.SRCALPHA)
    pygame.surfarray.blit_array(skin, shaded.transpose(1, 0, 2))
    skin.blit(mask, (0, 0), special_flags=pygame.BLEND_RGBA_MIN)
    picture.blit(skin, body)
    gleam = pygame.Surface((round(0.30 * k), round(0.075 * k)), pygame.SRCALPHA)
    pygame.draw.rect(gleam, (255, 255, 255, 150), gleam.get_rect(), border_radius=gleam.get_height() // 2)
    picture.blit(gleam, (left + 0.10 * k, top + 0.055 * k))


def _draw_face(picture: pygame.Surface, k: int) -> None:
    for x in (0.355, 0.645):
        for colour, dx, dy, radius in (
            (unpacked(INK), 0.0, 0.0, 0.108), ((255, 255, 255), 0.0, 0.0, 0.096), (unpacked(INK), 0.012, 0.018, 0.060),
            ((255, 255, 255), -0.008, -0.012, 0.022),
        ):  # fmt: skip
            pygame.draw.circle(picture, colour, ((x + dx) * k, (0.33 + dy) * k), radius * k)
        cheek = pygame.Surface((round(0.12 * k), round(0.07 * k)), pygame.SRCALPHA)
        pygame.draw.ellipse(cheek, (*unpacked(CHEEK), 150), cheek.get_rect())
        picture.blit(cheek, ((x + (-0.15 if x < 0.5 else 0.03)) * k, 0.435 * k))
    turns = np.linspace(0.18 * math.pi, 0.82 * math.pi, 40)
    for turn in turns.tolist():
        at = (0.5 + 0.115 * math.cos(turn)) * k, (0.435 + 0.105 * math.sin(turn)) * k
        pygame.draw.circle(picture, unpacked(INK), at, 0.019 * k)


if __name__ == "__main__":
    pygame.image.save(app_icon(SIDE), icon_file())
