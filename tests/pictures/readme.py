"""Draws the moving picture of the README: a hand, a slider and a knife in a run of docs/readme/film.json, and back."""

from itertools import pairwise

import numpy as np
import pygame
from PIL import Image

from sandbox.app.draw.camera import Camera
from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.renderer import Overlay, Renderer
from sandbox.app.film.film import name_tag
from sandbox.app.widgets.fonts import plain_font
from sandbox.level.reading.files import read_level
from sandbox.physics.analysis.query import springs_crossing
from sandbox.session.commands import CutSprings, Grab, MoveGrab, Release, SetCoefficients
from sandbox.session.session import Session
from tests.pictures.photographer import DOCS

LEVEL, FILM = DOCS / "readme" / "film.json", DOCS / "readme" / "film.webp"
# Pictures a second, their size [pixels], how much larger they are drawn, and the quality of the file.
FPS, SIZE, LARGER, QUALITY = 30, (800, 450), 2, 60
# How long the level comes to rest before the first picture [s], how long it plays, and how long it then goes back.
REST, LENGTH, BACK = 5.0, 3.1, 0.9
# Where the pointer is at a time: s, m.
WAY = (
    (0.0, (-3.6, 1.7)), (0.2, (-4.0, 0.8)), (0.5, (-3.5, 2.6)), (0.75, (-1.9, 2.0)), (0.95, (-0.5, 2.5)),
    (1.05, (-0.2, 1.8)), (1.3, (2.5, 3.05)), (1.95, (4.6, 3.05)), (2.2, (-2.9, 1.3)), (2.32, (-2.5, -1.3)),
    (2.6, (-1.2, 1.6)), (3.1, (0.6, 2.2)),
)  # fmt: skip
# When it holds the body, moves the knob, and cuts [s].
HOLDS, SLIDES, CUTS = (0.2, 1.05), (1.3, 1.95), (2.2, 2.32)
HELD, PLANKS = "raspberry", "planks"
# What is read in the corner from a time on [s].
SAID = (0.0, "Drag anything"), (1.2, "From jelly to steel"), (2.0, "Cut"), (LENGTH, "And take it back")
# How much less the bridge would sag at the end of the slider, just before it is rigid.
STIFFER = 0.02
# The slider: between which places [m], and its words; corners of the pointer [pixels].
TRACK, WORDS = ((2.5, 3.05), (4.6, 3.05)), ("jelly", "steel")
POINTER = (0, 0), (0, 17), (4, 13.5), (6.6, 19.5), (9.4, 18.3), (6.8, 12.4), (12, 12)
INK, PAPER = (33, 37, 48), (255, 255, 255)


def pointer_at(seconds: float) -> np.ndarray:
    """Where the pointer is [m]: it comes to rest at each place of its way."""
    for (begins, start), (ends, end) in pairwise(WAY):
        if seconds <= ends:
            part = (seconds - begins) / (ends - begins)
            is_pressed = any(first <= begins and ends <= last for first, last in (HOLDS, CUTS))
            part = part if is_pressed else part * part * (3.0 - 2.0 * part)
            return np.array(start) + part * (np.array(end) - np.array(start))
    return np.array(WAY[-1][1])


def is_in(seconds: float, span: tuple[float, float]) -> bool:
    """Whether a time lies in a span."""
    return span[0] <= seconds < span[1]


class Performance:
    """The run, with what is done in it; share: where the bridge is from jelly, 0, to steel, 1."""

    def __init__(self) -> None:
        self.session = Session(read_level(LEVEL))
        self.rate = self.session.level.settings.tick_rate
        self.material = self.session.world.material_names.index(PLANKS)
        self.share = 0.0
        self.trail: list[tuple[float, float]] = []
        for _ in range(round(REST * self.rate)):
            self.session.advance()
        self.begins = self.session.tick

    @property
    def seconds(self) -> float:
        """The time since the first picture [s]."""
        return (self.session.tick - self.begins) / self.rate

    def advance(self) -> None:
        """A tick, with what the hand does before it."""
        now, at = self.seconds, pointer_at(self.seconds)
        before = now - 1.0 / self.rate
        if is_in(now, HOLDS):
            target = (float(at[0]), float(at[1]))
            self.session.submit(MoveGrab(0, target) if is_in(before, HOLDS) else Grab(0, self._held(at), target))
        elif is_in(before, HOLDS):
            self.session.submit(Release(0))
        if is_in(now, SLIDES):
            share = float(np.interp(at[0], [TRACK[0][0], TRACK[1][0]], [0.0, 1.0]))
            self._make(share)
        elif is_in(before, SLIDES):
            self._make(1.0)
        if is_in(now, CUTS):
            self.trail.append((float(at[0]), float(at[1])))
            if len(self.trail) > 1:
                crossed = springs_crossing(self.session.snapshot(), self.trail[-2], self.trail[-1])
                planks = [int(k) for k in crossed if self.session.world.material[k] == self.material]
                if planks:
                    self.session.submit(CutSprings(tuple(planks)))
        elif self.trail:
            self.trail = self.trail[2:]
        self.session.advance()

    def _make(self, share: float) -> None:
        """Set the bridge between jelly, 0, and steel, 1."""
        self.share = share
        soft = self.session.level.materials[PLANKS]
        damping = soft.damping + (1.0 - soft.damping) * share**0.5
        # It sags by (1 - Cd)/Cs.
        sag = (1.0 - soft.damping) / soft.stiffness * STIFFER**share
        stiffness = 1.0 if share == 1.0 else min(1.0, (1.0 - damping) / sag)
        self.session.submit(SetCoefficients(stiffness, damping, self.material))

    def _held(self, at: np.ndarray) -> int:
        """The particle of the body that is nearest to a place [m]."""
        world = self.session.world
        slots = [k for k, name in enumerate(world.particle_names) if name.split(".")[0] == HELD]
        return slots[int(np.argmin(((world.position[slots] - at) ** 2).sum(axis=1)))]


class Artist:
    """Draws pictures of the performance, with the pointer, the slider and what is said."""

    def __init__(self, performance: Performance) -> None:
        self.performance = performance
        size = LARGER * SIZE[0], LARGER * SIZE[1]
        self.surface = pygame.Surface(size, 0, 32)
        self.camera = Camera(viewport=(0, 0, *size))
        level = performance.session.level
        self.camera.fit(level.view)
        self.scale = size[1] / 450.0
        self.renderer = Renderer(self.scale * 0.85, level)
        self.renderer.theme = THEMES["light"]
        pygame.font.init()
        self.words = [plain_font(round(13 * self.scale), True).render(word, True, INK) for word in WORDS]

    def scene(self) -> pygame.Surface:
        """The world as it is, with the hand in it."""
        performance, now = self.performance, self.performance.session.snapshot()
        overlay = Overlay(trail=list(performance.trail))
        self.renderer.draw(self.surface, self.camera, now, now, 1.0, overlay)
        self._slider(performance.share)
        self._pointer(performance.seconds)
        return self.surface.copy()

    def _slider(self, share: float) -> None:
        start, end = (self.camera.to_pixels(place) for place in TRACK)
        knob = start[0] + (end[0] - start[0]) * share
        unit = self.scale
        card = pygame.Rect(start[0] - 66 * unit, start[1] - 17 * unit, end[0] - start[0] + 128 * unit, 34 * unit)
        pygame.draw.rect(self.surface, PAPER, card, border_radius=round(17 * unit))
        track = pygame.Rect(start[0], start[1] - 2 * unit, end[0] - start[0], 4 * unit)
        pygame.draw.rect(self.surface, (205, 211, 222), track, border_radius=round(2 * unit))
        accent = self.renderer.theme.accent
        pygame.draw.rect(self.surface, accent, (*track.topleft, knob - start[0], track.height))
        pygame.draw.aacircle(self.surface, accent, (knob, start[1]), 9 * unit)
        for word, x in zip(self.words, (start[0] - 36 * unit, end[0] + 34 * unit), strict=True):
            self.surface.blit(word, word.get_rect(center=(x, start[1])))

    def _pointer(self, seconds: float) -> None:
        x, y = self.camera.to_pixels(tuple(pointer_at(seconds)))
        corners = [(x + 1.25 * self.scale * right, y + 1.25 * self.scale * down) for right, down in POINTER]
        pygame.draw.polygon(self.surface, PAPER, corners)
        pygame.draw.lines(self.surface, INK, True, corners, round(1.6 * self.scale))

    def say(self, picture: pygame.Surface, seconds: float) -> Image.Image:
        """A picture with what is said at a time [s], in the size of the film."""
        text = [words for begins, words in SAID if begins <= seconds][-1]
        picture = picture.copy()
        edge = round(14 * self.scale)
        picture.blit(name_tag(text, 1.2 * self.scale), (edge, edge))
        made = Image.frombytes("RGB", picture.get_size(), pygame.image.tobytes(picture, "RGB"))
        return made.resize(SIZE, Image.Resampling.LANCZOS)


def pictures() -> list[Image.Image]:
    """All pictures of the film: what is done, then the same backwards and faster, back to the first."""
    performance = Performance()
    artist = Artist(performance)
    scenes = [artist.scene()]
    for _ in range(round(LENGTH * FPS)):
        for _ in range(performance.rate // FPS):
            performance.advance()
        scenes.append(artist.scene())
    forward = [artist.say(scene, number / FPS) for number, scene in enumerate(scenes)]
    places = np.linspace(len(scenes) - 1, 0, round(BACK * FPS) + 1)[1:-1]
    return forward + [artist.say(scenes[round(place)], LENGTH + 1.0) for place in places]


def draw() -> None:
    """Write the film: WebP, since a GIF of this size takes 2.6 times its bytes and has 255 colours."""
    first, *others = pictures()
    first.save(FILM, save_all=True, append_images=others, duration=round(1000 / FPS), loop=0, quality=QUALITY, method=6)
