"""Anti-aliased lines and discs, and triangles, drawn into a surface's pixels by kernels, or by pygame without numba."""

import math

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.physics.jit import COMPILED, kernel, scalar_kernel

# Coordinates beyond this [pixels] are not drawn: float rounding would bend the line, and no screen is that large.
FARTHEST = 1e7


@scalar_kernel
def _blended(under, red, green, blue, share):  # type: ignore[no-untyped-def]
    # A packed pixel with share / 256 of a colour laid over it.
    r, g, b = (under >> 16) & 255, (under >> 8) & 255, under & 255
    r += ((red - r) * share) >> 8
    g += ((green - g) * share) >> 8
    b += ((blue - b) * share) >> 8
    return 0xFF000000 | (r << 16) | (g << 8) | b


@kernel
def _draw_lines(pixels, ends, colours, half_width, left, top, right, bottom):  # type: ignore[no-untyped-def]
    # Coverage of a pixel centre at distance d from the segment: clamp(half_width + 1/2 - d, 0, 1).
    reach = half_width + 1.0
    for s in range(ends.shape[0]):
        ax, ay, bx, by = ends[s, 0], ends[s, 1], ends[s, 2], ends[s, 3]
        if not (abs(ax) < FARTHEST and abs(ay) < FARTHEST and abs(bx) < FARTHEST and abs(by) < FARTHEST):
            continue
        dx, dy = bx - ax, by - ay
        length = math.sqrt(dx * dx + dy * dy)
        ux, uy = (dx / length, dy / length) if length > 1e-9 else (1.0, 0.0)
        steep = abs(dy) > abs(dx)
        along_a, along_b = (ay, by) if steep else (ax, bx)
        low, high = (top, bottom) if steep else (left, right)
        across_low, across_high = (left, right) if steep else (top, bottom)
        first = max(low, math.floor(min(along_a, along_b) - reach))
        last = min(high - 1, math.ceil(max(along_a, along_b) + reach))
        main = max(abs(ux), abs(uy))
        slope = (dx / dy if steep else dy / dx) if length > 1e-9 else 0.0
        across_a = ax if steep else ay
        spread = reach / main
        colour = colours[s]
        red, green, blue = (colour >> 16) & 255, (colour >> 8) & 255, colour & 255
        for i in range(first, last + 1):
            # Beyond an end the nearest point is that end itself, so the middle must not run on.
            inside = min(max(i + 0.5, min(along_a, along_b)), max(along_a, along_b))
            middle = across_a + (inside - along_a) * slope
            start = max(across_low, math.floor(middle - spread))
            stop = min(across_high - 1, math.ceil(middle + spread))
            for j in range(start, stop + 1):
                px, py = (j + 0.5, i + 0.5) if steep else (i + 0.5, j + 0.5)
                rx, ry = px - ax, py - ay
                t = rx * ux + ry * uy
                if t < 0.0:
                    distance = math.sqrt(rx * rx + ry * ry)
                elif t > length:
                    qx, qy = px - bx, py - by
                    distance = math.sqrt(qx * qx + qy * qy)
                else:
                    distance = abs(rx * uy - ry * ux)
                cover = half_width + 0.5 - distance
                if cover <= 0.0:
                    continue
                share = int(min(cover, 1.0) * 256.0)
                x, y = (j, i) if steep else (i, j)
                pixels[x, y] = _blended(int(pixels[x, y]), red, green, blue, share)


@kernel
def _draw_plain_lines(pixels, ends, colours, left, top, right, bottom):  # type: ignore[no-untyped-def]
    # One pixel per step along the longer side.
    for s in range(ends.shape[0]):
        ax, ay, bx, by = ends[s, 0], ends[s, 1], ends[s, 2], ends[s, 3]
        if not (abs(ax) < FARTHEST and abs(ay) < FARTHEST and abs(bx) < FARTHEST and abs(by) < FARTHEST):
            continue
        if max(ax, bx) < left or min(ax, bx) >= right or max(ay, by) < top or min(ay, by) >= bottom:
            continue
        colour = 0xFF000000 | colours[s]
        steps = int(max(abs(bx - ax), abs(by - ay))) + 1
        for i in range(steps + 1):
            x, y = math.floor(ax + (bx - ax) * i / steps), math.floor(ay + (by - ay) * i / steps)
            if left <= x < right and top <= y < bottom:
                pixels[x, y] = colour


@kernel
def _draw_discs(pixels, centres, radii, colours, left, top, right, bottom):  # type: ignore[no-untyped-def]
    # Coverage of a pixel centre at distance d from the middle: clamp(radius + 1/2 - d, 0, 1).
    for p in range(centres.shape[0]):
        x0, y0, radius = centres[p, 0], centres[p, 1], radii[p]
        if not (abs(x0) < FARTHEST and abs(y0) < FARTHEST):
            continue
        colour = colours[p]
        red, green, blue = (colour >> 16) & 255, (colour >> 8) & 255, colour & 255
        first, last = max(left, math.floor(x0 - radius - 1.0)), min(right - 1, math.ceil(x0 + radius + 1.0))
        start, stop = max(top, math.floor(y0 - radius - 1.0)), min(bottom - 1, math.ceil(y0 + radius + 1.0))
        for x in range(first, last + 1):
            dx = x + 0.5 - x0
            for y in range(start, stop + 1):
                dy = y + 0.5 - y0
                cover = radius + 0.5 - math.sqrt(dx * dx + dy * dy)
                if cover <= 0.0:
                    continue
                share = int(min(cover, 1.0) * 256.0)
                pixels[x, y] = _blended(int(pixels[x, y]), red, green, blue, share)


@kernel
def _draw_triangles(pixels, corners, colours, left, top, right, bottom):  # type: ignore[no-untyped-def]
    # Pixels whose centre lies inside; one on a side belongs to one of two triangles that share it.
    for t in range(corners.shape[0]):
        colour = 0xFF000000 | colours[t]
        low = min(corners[t, 0, 1], corners[t, 1, 1], corners[t, 2, 1])
        high = max(corners[t, 0, 1], corners[t, 1, 1], corners[t, 2, 1])
        for y in range(max(top, math.ceil(low - 0.5)), min(bottom, math.ceil(high - 0.5))):
            middle = y + 0.5
            first = FARTHEST
            last = -FARTHEST
            for k in range(3):
                ax, ay = corners[t, k, 0], corners[t, k, 1]
                bx, by = corners[t, (k + 1) % 3, 0], corners[t, (k + 1) % 3, 1]
                if (ay <= middle) != (by <= middle):
                    x = ax + (middle - ay) * (bx - ax) / (by - ay)
                    first = min(first, x)
                    last = max(last, x)
            for column in range(max(left, math.ceil(first - 0.5)), min(right, math.ceil(last - 0.5))):
                pixels[column, y] = colour


def _has_plain_pixels(surface: pygame.Surface) -> bool:
    return surface.get_bitsize() == 32 and surface.get_shifts()[:3] == (16, 8, 0)


class Canvas:
    """Draws many lines, discs and triangles on a surface; compiled: whether kernels do it, if they are."""

    def __init__(self, surface: pygame.Surface, compiled: bool = True) -> None:
        self.surface = surface
        self.compiled = compiled and COMPILED and _has_plain_pixels(surface)

    def lines(self, ends: NDArray[np.float64], colours: NDArray[np.int64], width: float) -> None:
        """Draw segments (m, 4) = x1, y1, x2, y2 [pixels] in colours (m,) 0xRRGGBB, width [pixels]."""
        if not len(ends):
            return
        if self.compiled:
            clip = self.surface.get_clip()
            pixels = pygame.surfarray.pixels2d(self.surface)
            _draw_lines(pixels, ends, colours, width / 2, clip.left, clip.top, clip.right, clip.bottom)
            return
        # draw.aaline clips, but only after ends of any size have become 32 bit integers.
        seen = (np.abs(ends) < FARTHEST).all(axis=1)
        for (x1, y1, x2, y2), colour in zip(ends[seen].tolist(), colours[seen].tolist(), strict=True):
            pygame.draw.aaline(self.surface, _rgb(colour), (x1, y1), (x2, y2), max(1, round(width)))

    def plain_lines(self, ends: NDArray[np.float64], colours: NDArray[np.int64]) -> None:
        """Draw segments as `lines` does, a pixel wide and with steps, in a tenth of the time."""
        if not len(ends):
            return
        if not self.compiled:
            self.lines(ends, colours, 1.0)
            return
        clip = self.surface.get_clip()
        pixels = pygame.surfarray.pixels2d(self.surface)
        _draw_plain_lines(pixels, ends, colours, clip.left, clip.top, clip.right, clip.bottom)

    def discs(self, centres: NDArray[np.float64], radii: NDArray[np.float64], colours: NDArray[np.int64]) -> None:
        """Draw filled circles of centres (n, 2) and radii (n,) [pixels] in colours (n,) 0xRRGGBB."""
        if not len(centres):
            return
        if self.compiled:
            clip = self.surface.get_clip()
            pixels = pygame.surfarray.pixels2d(self.surface)
            _draw_discs(pixels, centres, radii, colours, clip.left, clip.top, clip.right, clip.bottom)
            return
        seen = (np.abs(centres) < FARTHEST).all(axis=1)
        sprites: dict[tuple[int, int], pygame.Surface] = {}
        blits = []
        for (x, y), radius, colour in zip(
            centres[seen].tolist(), radii[seen].tolist(), colours[seen].tolist(), strict=True
        ):
            key = (max(1, round(radius)), colour)
            sprite = sprites.get(key) or sprites.setdefault(key, _disc_sprite(*key))
            blits.append((sprite, (round(x) - key[0] - 1, round(y) - key[0] - 1)))
        self.surface.fblits(blits, pygame.BLEND_PREMULTIPLIED)

    def triangles(self, corners: NDArray[np.float64], colours: NDArray[np.int64]) -> None:
        """Fill triangles (t, 3, 2) [pixels, within FARTHEST] in colours (t,) 0xRRGGBB."""
        if not len(corners):
            return
        if self.compiled:
            clip = self.surface.get_clip()
            pixels = pygame.surfarray.pixels2d(self.surface)
            _draw_triangles(pixels, corners, colours, clip.left, clip.top, clip.right, clip.bottom)
            return
        for outline, colour in zip(corners.tolist(), colours.tolist(), strict=True):
            pygame.draw.polygon(self.surface, _rgb(colour), outline)


def _disc_sprite(radius: int, colour: int) -> pygame.Surface:
    size = 2 * radius + 3
    sprite = pygame.Surface((size, size), pygame.SRCALPHA)
    pygame.draw.aacircle(sprite, _rgb(colour), (radius + 1, radius + 1), radius)
    return sprite.premul_alpha()


def _rgb(colour: int) -> tuple[int, int, int]:
    return (colour >> 16) & 255, (colour >> 8) & 255, colour & 255


def warm_up_lines() -> None:
    """Compile the drawing kernels, or load them from the cache."""
    canvas = Canvas(pygame.Surface((8, 8), 0, 32))
    # Interpreted ones are called too, so that it can be noted what they are called with.
    canvas.compiled = True
    canvas.lines(np.array([[1.0, 1.0, 6.0, 5.0]]), np.array([0xFFFFFF]), 2.0)
    canvas.plain_lines(np.array([[1.0, 1.0, 6.0, 5.0]]), np.array([0xFFFFFF]))
    canvas.discs(np.array([[3.0, 3.0]]), np.array([2.0]), np.array([0xFFFFFF]))
    canvas.triangles(np.array([[[1.0, 1.0], [6.0, 5.0], [2.0, 6.0]]]), np.array([0xFFFFFF]))
