"""Tables and tiles that drawing reads in place of arithmetic: skins, strips, sheets and grains; made once a theme."""

from collections.abc import Callable
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.colours import BRASS, STEEL, Colour, Theme, mixed, unpacked
from sandbox.app.draw.raster.bodies import GRAIN, INSIDE, LIT
from sandbox.app.draw.raster.mark_kernels import ACROSS, ALONG, SHEET

Floats = NDArray[np.float64]
Packed = NDArray[np.uint32]
WHITE: Colour = (255, 255, 255)
BLACK: Colour = (0, 0, 0)
# Tables of skins and sheets in colours that are kept, those used last; levels choose colours freely. A table has 64 kB,
# a sheet 32.
MOST_TABLES, MOST_SHEETS = 128, 64
# How names of tables of ground begin.
GROUND = "ground "
# How much of a skin's light and shade there is where it faces the light, and away from it.
LIT_UP, LIT_DOWN = 0.75, 0.85


def _packed(channels: Floats, alpha: Floats) -> Packed:
    red, green, blue = (np.clip(channels[..., k], 0, 255).astype(np.uint32) for k in range(3))
    return np.ascontiguousarray(np.clip(alpha, 0, 255).astype(np.uint32) << 24 | red << 16 | green << 8 | blue)


def _lit_table(base: Colour, light: Colour, shade: Colour, gloss: float, clear: float) -> Packed:
    """Colours (INSIDE, LIT) of a skin; gloss: how strong its gleam is, clear: how much shows through inside, 0..1."""
    inside = np.linspace(0.0, 1.0, INSIDE)[:, None]
    lit = np.linspace(-1.5, 1.5, LIT)[None, :]
    up, down = np.clip(lit * LIT_UP, 0.0, 0.85)[..., None], np.clip(-lit * LIT_DOWN, 0.0, 0.8)[..., None]
    own = np.array(base, dtype=np.float64)
    colour = own + (np.array(light) - own) * up + (np.array(shade) - own) * down
    gleam = np.clip((lit - 0.30) * 5, 0, 1) * np.clip((inside - 0.16) * 6, 0, 1) * np.clip((0.80 - inside) * 4, 0, 1)
    colour = colour + (255.0 - colour) * (gleam * gloss)[..., None]
    alpha = 255.0 * (1.0 - clear * inside * (1.0 - 0.5 * np.clip(np.abs(lit), 0, 1)))
    return _packed(colour, alpha)


def _deep_table(near: Colour, deep: Colour, light: float, dark: float, alpha: float) -> Packed:
    """Colours of ground: from near its edge to deep inside, lit and shaded a little at the edge."""
    inside = np.clip(np.linspace(0.0, 1.0, INSIDE) * 1.15 - 0.08, 0.0, 1.0)[:, None, None]
    lit = np.linspace(-1.5, 1.5, LIT)[None, :, None]
    colour = np.array(near) + (np.array(deep, dtype=np.float64) - np.array(near)) * inside
    colour = colour + (255.0 - colour) * np.clip(lit, 0, 1) * light - colour * np.clip(-lit, 0, 1) * dark
    return _packed(colour, np.full(colour.shape[:2], 255.0 * alpha))


class SkinLook(NamedTuple):
    """How white a skin is where light falls; its colour in shade, and how much; its gleam; how clear it is inside."""

    light: float
    shade: Colour
    dark: float
    gloss: float
    clear: float


_RUBBER = SkinLook(0.32, (20, 0, 40), 0.38, 0.15, 0.0)
_LAID = SkinLook(0.25, (30, 10, 0), 0.45, 0.0, 0.0)
_SKINS = {
    "jelly": SkinLook(0.62, (90, 10, 110), 0.40, 0.75, 0.13), "balloon": SkinLook(0.5, (60, 0, 70), 0.42, 0.0, 0.14),
    "tyre": SkinLook(0.30, BLACK, 0.6, 0.15, 0.0), "window": SkinLook(0.7, (60, 110, 150), 0.4, 0.5, 0.1),
    "lattice": SkinLook(0.25, BLACK, 0.2, 0.0, 0.66), "wood": _LAID, "stone": _LAID, "brick": _LAID,
    "flat": SkinLook(0.0, BLACK, 0.0, 0.0, 0.0), "rubber": _RUBBER, "plain": _RUBBER, "cloth": _RUBBER,
    "steel wheel": _RUBBER,
}  # fmt: skip


def skin_look(skin: str) -> SkinLook:
    """How a skin is lit."""
    return _SKINS[skin]


class GroundTones(NamedTuple):
    """Colours of ground near its edge and deep inside, how lit, shaded and dense it is, and the colour of its line."""

    near: Colour
    deep: Colour
    light: float
    dark: float
    alpha: float
    line: Colour


def ground_tones(kind: str, theme: Theme) -> GroundTones:
    """How a kind of ground looks in a theme."""
    match kind:
        case "soil":
            return GroundTones(*theme.soil, 0.10, 0.25, 1.0, theme.soil[1])
        case "rock":
            return GroundTones(*theme.rock, 0.25, 0.35, 1.0, theme.rock[1])
        case "wood":
            return GroundTones(unpacked(0xC28E57), unpacked(0x9A6C40), 0.30, 0.40, 1.0, unpacked(0x6E4A28))
        case "glass":
            return GroundTones(unpacked(0xD4EEFA), unpacked(0x8CC4E6), 0.6, 0.30, 0.42, unpacked(0x6FA8C8))
        case "metal":
            near, deep = mixed(*theme.metal, 0.25), mixed(*theme.metal, 0.55)
            return GroundTones(near, deep, 0.45, 0.45, 1.0, theme.metal[1])
    raise ValueError(f"there is no ground {kind!r}")


@lru_cache(MOST_TABLES)
def skin_table(skin: str, colour: int, theme: Theme) -> Packed:
    """The table of a skin, or of a kind of ground, in a colour 0xRRGGBB (ground has its own)."""
    base = unpacked(colour)
    if skin.startswith(GROUND):
        tones = ground_tones(skin.removeprefix(GROUND), theme)
        return _deep_table(tones.near, tones.deep, tones.light, tones.dark, tones.alpha)
    if skin == "lattice":
        # Glass between springs at rest and what the theme is drawn on, so that they stand out on it.
        base = mixed(base, theme.card, 0.55)
    light, shade, dark, gloss, clear = skin_look(skin)
    return _lit_table(base, mixed(base, WHITE, light), mixed(base, shade, dark), gloss, clear)


def _profile(base: int, gleam: float, top: float = 0.5, bottom: float = 0.55) -> Floats:
    """A round bar across (ACROSS, 3): light above, dark below, a line at both sides."""
    across = (np.arange(ACROSS) + 0.5) / 8 - 1
    own = np.array(unpacked(base), dtype=np.float64)
    lit, dark = np.clip(-across - 0.1, 0, 1)[:, None] * top, np.clip(across + 0.1, 0, 1)[:, None] * bottom
    colour = own + (255.0 - own) * lit * 0.6 - own * dark * 0.6
    colour += (255.0 - colour) * (gleam * np.exp(-(((across + 0.42) / 0.16) ** 2)))[:, None]
    return np.asarray(colour * (1 - 0.5 * np.clip((np.abs(across) - 0.72) / 0.28, 0, 1))[:, None])


_V = (np.arange(ACROSS)[:, None] + 0.5) / 8 - 1
_U = (np.arange(ALONG)[None, :] + 0.5) / ALONG
_FULL = np.full((ACROSS, ALONG), 255.0)


def _bar(base: int, gleam: float = 0.35, **light: float) -> Packed:
    return _packed(np.repeat(_profile(base, gleam, **light)[:, None, :], ALONG, axis=1), _FULL)


def _twist(light: int, dark: int, slope: float, count: int) -> Packed:
    wave = 0.5 + 0.5 * np.cos(2 * np.pi * (_U * count + _V * slope))
    weight = np.clip((wave - 0.22) * 2.2, 0, 1)[..., None]
    low = np.array(unpacked(dark), dtype=np.float64)
    colour = low + (np.array(unpacked(light)) - low) * weight
    rounded = 1 - 0.62 * np.clip(_V + 0.25, 0, 1) ** 1.2 - 0.35 * np.clip((np.abs(_V) - 0.7) / 0.3, 0, 1)
    return _packed(colour * (rounded + 0.22 * np.exp(-(((_V + 0.4) / 0.25) ** 2)))[..., None], _FULL)


def _grained() -> Packed:
    rng = np.random.default_rng(4)
    colour = np.repeat(_profile(0xC99258, 0.0, 0.35, 0.45)[:, None, :], ALONG, axis=1)
    lines = rng.normal(0, 1, (ACROSS, 1)) * 9 + np.sin(2 * np.pi * (_U + _V * 0.7)) * 5 * (
        rng.random((ACROSS, 1)) > 0.5
    )
    return _packed(colour + lines[..., None], _FULL)


def _chain() -> Packed:
    # One period: a link seen flat, a ring, then one on edge, a bar through its ends.
    colour = np.repeat(_profile(0xB0BCCD, 0.4)[:, None, :], ALONG, axis=1)
    x = (_U - 0.30) / 0.36
    flat = np.clip((0.27 - np.abs(np.sqrt(0.9 * x**2 + _V**2) - 0.74)) * 8, 0, 1)
    near = np.abs(np.minimum(np.abs(_U - 0.80), np.abs(_U + 0.2)))
    edge = np.clip((0.34 - np.abs(_V)) * 8, 0, 1) * np.clip((0.27 - near) * 16, 0, 1)
    return _packed(colour, 255.0 * np.maximum(flat, edge))


def _muscle() -> Packed:
    colour = np.repeat(_profile(0xDE5462, 0.3)[:, None, :], ALONG, axis=1)
    return _packed(colour * (0.88 + 0.12 * np.cos(4 * np.pi * _U))[..., None], _FULL)


def _deck() -> Packed:
    # Planks side by side: a dark joint once a period.
    colour = np.repeat(_profile(0xC48E58, 0.0, 0.4, 0.6)[:, None, :], ALONG, axis=1)
    joint = 1 - 0.55 * np.clip((0.06 - np.minimum(_U, 1 - _U)) * 40, 0, 1)
    return _packed(colour * (joint * (1 + 0.05 * np.sin(_V * 9)))[..., None], _FULL)


def _turf(theme: Theme) -> Packed:
    top = -0.45 + 0.38 * np.abs(np.sin(5 * np.pi * _U)) + 0.16 * np.sin(6 * np.pi * _U + 0.7)
    low = 0.52 + 0.20 * np.sin(4 * np.pi * _U + 0.5) + 0.10 * np.sin(10 * np.pi * _U)
    weight = np.clip(0.5 - _V * 0.5, 0, 1)[..., None] * np.ones((1, ALONG, 1))
    dark = np.array(theme.turf[1], dtype=np.float64)
    colour = dark + (np.array(theme.turf[0]) - dark) * weight
    return _packed(colour, 255.0 * np.clip((_V - top) * 4, 0, 1) * np.clip((low - _V) * 6, 0, 1))


_TILES: dict[str, Callable[[], Packed]] = {
    "steel": lambda: _bar(STEEL), "paint": lambda: _bar(0xFFFFFF, 0.3), "brass": lambda: _bar(BRASS, 0.5),
    "rope": lambda: _twist(0xDEB276, 0x80542C, 0.16, 2), "cable": lambda: _twist(0xBEC8D8, 0x5C667A, 0.12, 3),
    "chain": _chain, "deck": _deck, "wood": _grained, "rubber": lambda: _bar(0xEB605C, 0.25),
    "thread": lambda: _bar(0xCED2DA, 0.0), "silk": lambda: _bar(0x8C9BB2, 0.0), "bone": lambda: _bar(0xF0E4CC, 0.15),
    "muscle": _muscle,
}  # fmt: skip
# Tiles of strips by name; the bars of bare colours come after them.
TILE = {name: k for k, name in enumerate((*_TILES, "turf"))}


@cache
def _stuffs(theme: Theme) -> Packed:
    return np.stack([*(make() for make in _TILES.values()), _turf(theme)])


class Tiles:
    """Tiles of strips (t, ACROSS, ALONG): those of stuffs, and bars of any colour, added when first asked for."""

    def __init__(self, theme: Theme) -> None:
        self.array = _stuffs(theme)
        self._bars: dict[int, int] = {}

    def bar(self, colour: int) -> int:
        """The tile of a round bar of a colour."""
        if colour not in self._bars:
            self._bars[colour] = len(self.array)
            self.array = np.concatenate([self.array, _bar(colour, 0.3)[None]])
        return self._bars[colour]


_Y, _X = np.mgrid[0:SHEET, 0:SHEET]


def _sheet(colour: Floats) -> NDArray[np.int64]:
    return np.ascontiguousarray(_packed(colour, np.zeros(colour.shape[:2])).astype(np.int64))


@lru_cache(MOST_SHEETS)
def woven(colour: int, stripe: int) -> NDArray[np.int64]:
    """A woven sheet (SHEET, SHEET), stripes of a second colour."""
    own = np.where((_X % SHEET < 20)[..., None], unpacked(stripe), unpacked(colour)).astype(np.float64)
    over = np.where((_X // 2 + _Y // 2) % 2 == 0, 1.0, 0.93) * (1 - 0.05 * (_X % 2 == 0))
    return _sheet(own * over[..., None])


@lru_cache(MOST_SHEETS)
def laid(skin: str, colour: int) -> NDArray[np.int64]:
    """A sheet of planks, bricks or stones."""
    rng = np.random.default_rng(1)
    rows = 4
    high = SHEET // rows
    course = _Y // high
    own = np.array(unpacked(colour), dtype=np.float64)
    shift = (_X - (course % 2) * SHEET // 2) % SHEET
    if skin == "wood":
        tone = rng.normal(1, 0.05, rows)[course]
        grain = 1 + 0.035 * np.sin(_Y * 2.1 + 2.2 * np.sin(_X * 2 * np.pi / SHEET + course))
        joint = np.where(_Y % high == 0, 0.62, np.where(_Y % high == 1, 1.14, 1.0)) * np.where(shift == 0, 0.66, 1.0)
        nail = (np.abs(shift - 4) < 1.5) & (np.abs(_Y % high - high // 2) < 1.5)
        return _sheet(own * (tone * grain * joint * np.where(nail, 0.6, 1.0))[..., None])
    block = course * 4 + (_X - (course % 2) * 16) % SHEET // 32
    tone = rng.normal(1, 0.06, 4 * rows + 4)[block]
    joint = (_Y % high < 2) | ((_X - (course % 2) * 16) % 32 < 2)
    return _sheet(np.where(joint[..., None], own * 0.4 + 110.0, own * tone[..., None]))


def _noise(rng: np.random.Generator, reach: int) -> Floats:
    """Noise (GRAIN, GRAIN) that tiles, of patches about this many texels wide, of deviation 1."""
    noise = rng.normal(0, 1, (GRAIN, GRAIN))
    for _ in range(2):
        for axis in (0, 1):
            noise = np.mean([np.roll(noise, k, axis) for k in range(-reach, reach + 1)], axis=0)
    return np.asarray(noise / noise.std())


@cache
def grains() -> NDArray[np.int64]:
    """Grains (2, GRAIN, GRAIN) that tile: earth with strata and pebbles, and wood."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[0:GRAIN, 0:GRAIN] * (2 * np.pi / GRAIN)
    bent = 0.6 * np.sin(x) + 0.3 * _noise(rng, 16)
    earth = 1.2 * _noise(rng, 2) + 1.8 * _noise(rng, 9) + 4.0 * np.tanh(2 * np.sin(4 * y + 1.6 * bent))
    wood = 5.0 * np.sin(18 * y + 1.5 * np.sin(x) + 0.5 * np.sin(3 * x)) + 3.0 * np.sin(46 * y + np.sin(2 * x))
    for _ in range(16):
        i, j, size = rng.integers(0, GRAIN), rng.integers(0, GRAIN), rng.uniform(0.9, 3.0)
        rows, columns = np.mgrid[-4:5, -4:5]
        pebble = np.clip(size + 0.5 - np.sqrt(rows**2 + columns**2), 0, 1) * rng.choice([-15.0, 18.0])
        earth[(i + rows) % GRAIN, (j + columns) % GRAIN] += pebble
    return np.ascontiguousarray(np.stack([earth, wood + _noise(rng, 2)]).round().astype(np.int64))


EARTH, TIMBER = 0, 1
