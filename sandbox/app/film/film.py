"""Film: the past of a run drawn again as pictures, from its keyframes and commands; the run itself is not touched."""

import math
from collections.abc import Iterator, Sequence
from weakref import WeakSet

import numpy as np
import pygame

from sandbox.app.draw.camera import Box, Camera
from sandbox.app.draw.colours import LINE
from sandbox.app.draw.picture import view_of
from sandbox.app.draw.renderer import Overlay, Renderer
from sandbox.app.film.kinds import Size
from sandbox.app.run.followers import StabilityPaint
from sandbox.app.widgets.fonts import plain_font
from sandbox.level.assembly.build_world import LevelWorld
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands.records import script_of
from sandbox.session.session import Session

# Lines are never drawn thinner than at this scale [pixels per layout unit].
SMALLEST_SCALE = 0.5
# Pictures that show the colours of a whole film.
SAMPLES = 12
# The name in the corner, at a height of 360 pixels: size of its letters, and how far it is from the edges.
TEXT_HEIGHT, EDGE = 13.0, 12.0
SHADE = (0, 0, 0, 96)


class Film:
    """The ticks of a session in a span, as a camera shows them and a renderer draws them.

    What becomes of the three after that does not change the film. box [m]: what is shown instead, as large as it goes,
    whatever shape the pictures have. first, last: its ticks. is_latest: whether it ends where the run is. script: all
    that was done until its end, from the level's start; None where the run began later.
    """

    def __init__(
        self, session: Session, camera: Camera, renderer: Renderer, span: tuple[int, int], box: Box | None = None
    ) -> None:
        self.level = session.level
        self.rate = session.world.settings.tick_rate
        self.last = min(max(span[1], 0), session.last_tick)
        self._past = session.retold(min(span[0], self.last))
        self.first = min(max(self._past.tick, span[0]), self.last)
        self.is_latest = session.tick == self.last
        history, is_whole = session.history, session.history.keyframes.first.tick == 0
        self.script = script_of(history.until(self.last), session.world) if is_whole else None
        self._end = session.snapshot() if self.is_latest else session.keyframes(0, self.last)[-1]
        self._centre, self._zoom = camera.centre, camera.zoom
        self._shown, self._box = camera.viewport[2:], box
        self._renderer = renderer.alike(renderer.scale)
        # Those that pictures are drawn from at the moment.
        self._running: WeakSet[Session] = WeakSet()

    @property
    def seconds(self) -> float:
        """Length of the film [s]."""
        return (self.last - self.first) / self.rate

    @property
    def parts(self) -> "tuple[tuple[str, Film], ...]":
        """Pairs of a caption and a film, as a pair of films has them; here itself alone, without a caption."""
        return (("", self),)

    @property
    def box(self) -> Box:
        """The part of the world that its pictures show [m]: left, bottom, right, top."""
        if self._box is not None:
            return self._box
        (x, y), wide, tall = self._centre, self._shown[0] / self._zoom / 2, self._shown[1] / self._zoom / 2
        return x - wide, y - tall, x + wide, y + tall

    def states(self, start: float, end: float) -> Iterator[LevelWorld | None]:
        """The world at every tick of start..end [s from its beginning]: itself, to be looked at before the next.

        Before them None, for each tick made.
        """
        first, last = (min(self.first + round(at * self.rate), self.last) for at in (start, end))
        twin = self._past.retold(first)
        self._running.add(twin)
        yield twin.world if twin.tick == first else None
        while twin.tick < last:
            with np.errstate(over="ignore", invalid="ignore"):
                twin.advance()
            yield twin.world if twin.tick >= first else None

    def pictures(
        self, start: float, end: float, fps: float, size: Size, name: str = ""
    ) -> Iterator[pygame.Surface | None]:
        """Pictures of start..end [s from its beginning], fps of them a second; between them None, for each tick made.

        Each is drawn on the same surface. name: a text in the corner.
        """
        stage = _FilmStage(self, size, name)
        twin = self._past.retold(self.first + math.floor(start * self.rate))
        self._running.add(twin)
        before = now = twin.snapshot()
        for picture in range(picture_count(start, end, fps)):
            at = min(self.first + (start + picture / fps) * self.rate, self.last)
            tick = math.ceil(at - 1e-6)
            while twin.tick < tick:
                if twin.tick == tick - 1:
                    before = twin.snapshot()
                with np.errstate(over="ignore", invalid="ignore"):
                    twin.advance()
                if twin.tick < tick:
                    yield None
            if now.tick < tick:
                now = twin.snapshot()
                if len(now.mass) != len(before.mass) or before.tick != now.tick - 1:
                    before = now
            yield stage.draw(twin, before, now, 1.0 - (tick - at) if before is not now else 1.0)

    def samples(self, start: float, end: float, size: Size, name: str = "") -> list[pygame.Surface]:
        """A few pictures from start to end [s from its beginning], of states that are kept: what colours there are."""
        first, last = (self.first + round(at * self.rate) for at in (start, end))
        kept = [self._past.snapshot(), *self._past.keyframes(first, last), self._end]
        chosen = [kept[round(k)] for k in np.linspace(0, len(kept) - 1, min(len(kept), SAMPLES))]
        stage = _FilmStage(self, size, name)
        return [stage.draw(self._past, state, state, 1.0).copy() for state in chosen]


class _FilmStage:
    """Surface, camera and renderer for one pass through a film."""

    def __init__(self, film: Film, size: Size, name: str) -> None:
        part = min(size[0] / film._shown[0], size[1] / film._shown[1])
        self._camera = Camera(film._centre, film._zoom * part, (0, 0, *size))
        if film._box is not None:
            self._camera.fit(film._box)
        scale = film._renderer.scale * self._camera.zoom / film._zoom
        self._renderer = film._renderer.alike(max(SMALLEST_SCALE, scale))
        self._paint = StabilityPaint()
        self._surface = pygame.Surface(size, 0, 32)
        self._tag = corner_tag(name, size) if name else None

    def draw(self, session: Session, before: Snapshot, now: Snapshot, alpha: float) -> pygame.Surface:
        """Draw the state between two ticks of a session."""
        surface, overlay = self._surface, Overlay()
        if "stability" in self._renderer.overlays.shown:
            overlay.stability = self._paint.shares(session.world)
        self._renderer.draw(surface, self._camera, before, now, alpha, overlay)
        if self._tag is not None:
            surface.blit(*self._tag)
        return surface


def film_of_view(session: Session, size: Size, seconds: float) -> Film:
    """The last seconds [s] of a run as its level's view shows them, in the lines that a picture of a size has."""
    camera = Camera(viewport=(0, 0, *size))
    camera.fit(view_of(session.level, session.keyframes(0, session.tick)[0]))
    scale = max(SMALLEST_SCALE, min(size[0] / 1280, size[1] / 720))
    return Film(session, camera, Renderer(scale, session.level), last_ticks(session, seconds))


def last_ticks(session: Session, seconds: float) -> tuple[int, int]:
    """The first and last tick of the last seconds [s] of a run until now."""
    return max(0, session.tick - round(seconds * session.world.settings.tick_rate)), session.tick


def picture_count(start: float, end: float, fps: float) -> int:
    """How many pictures a film of start..end [s] has."""
    return max(1, round((end - start) * fps))


# What divides them, at a height of 360 pixels.
THICK = 2.0
# How much smaller letters over them may be, until they have room.
SMALLER = (1.0, 0.9, 0.8, 0.7)


class FilmPair:
    """Two films as one; words: what stands over each. is_wide: they are beside each other.

    parts: each with its words.
    """

    def __init__(self, films: Sequence[Film], words: Sequence[str], is_wide: bool) -> None:
        self.parts = tuple(zip(words, films, strict=True))
        first = films[0]
        self.level, self.rate, self.is_latest = first.level, first.rate, first.is_latest
        self.seconds = min(film.seconds for film in films)
        self._is_wide = is_wide

    @property
    def box(self) -> Box:
        """The part of the world that each picture shows [m]: left, bottom, right, top."""
        return self.parts[0][1].box

    def pictures(
        self, start: float, end: float, fps: float, size: Size, name: str = ""
    ) -> Iterator[pygame.Surface | None]:
        """Pictures of both, as `Film.pictures` gives them of one."""
        sheet = _PairSheet(self, size, name)
        halves = [
            film.pictures(start, end, fps, place.size)
            for (_, film), place in zip(self.parts, sheet.places, strict=True)
        ]
        for _ in range(picture_count(start, end, fps)):
            drawn = []
            for half in halves:
                for picture in half:
                    if picture is not None:
                        drawn.append(picture)
                        break
                    yield None
            yield sheet.lay(drawn)

    def samples(self, start: float, end: float, size: Size, name: str = "") -> list[pygame.Surface]:
        """A few pictures from start to end [s from its beginning]: what colours there are."""
        sheet = _PairSheet(self, size, name)
        halves = [
            film.samples(start, end, place.size) for (_, film), place in zip(self.parts, sheet.places, strict=True)
        ]
        count = max(len(half) for half in halves)
        return [sheet.lay([half[min(k, len(half) - 1)] for half in halves]).copy() for k in range(count)]


class _PairSheet:
    """The sheet of both pictures of a pair. places: of each of the two [pixels]."""

    def __init__(self, pair: FilmPair, size: Size, name: str) -> None:
        (width, height), scale = size, size[1] / 360.0
        self._surface = pygame.Surface(size, 0, 32)
        half = pygame.Rect(0, 0, width // 2, height) if pair._is_wide else pygame.Rect(0, 0, width, height // 2)
        shift = (width - half.width, 0) if pair._is_wide else (0, height - half.height)
        self.places = (half, half.move(shift))
        middle = ((width // 2, 0), (width // 2, height)) if pair._is_wide else ((0, height // 2), (width, height // 2))
        self._line, self._thick = middle, max(1, round(THICK * scale))
        edge = round(EDGE * scale)
        tags = _tags_within([words for words, _ in pair.parts], half.width - 2 * edge, scale)
        corners = [(int(place.left) + edge, int(place.top) + edge) for place in self.places]
        self._tags = list(zip(tags, corners, strict=True))
        if name:
            self._tags.append(corner_tag(name, size))

    def lay(self, halves: Sequence[pygame.Surface]) -> pygame.Surface:
        """Lay a picture of each run on the sheet."""
        for picture, place in zip(halves, self.places, strict=True):
            self._surface.blit(picture, place)
        pygame.draw.line(self._surface, LINE, *self._line, self._thick)
        for tag, corner in self._tags:
            self._surface.blit(tag, corner)
        return self._surface


def _tags_within(words: Sequence[str], width: int, scale: float) -> list[pygame.Surface]:
    """Tags in letters of one size, none wider than this many pixels; the end of what is too long is left out."""
    for part in SMALLER:
        tags = [name_tag(text, scale * part) for text in words]
        if all(tag.get_width() <= width for tag in tags):
            break
    return [tag.subsurface((0, 0, min(tag.get_width(), width), tag.get_height())) for tag in tags]


def corner_tag(name: str, size: Size) -> tuple[pygame.Surface, tuple[int, int]]:
    """A name for the lower left corner of a picture, and where it is there."""
    scale = size[1] / 360.0
    tag, edge = name_tag(name, scale), round(EDGE * scale)
    return tag, (edge, size[1] - edge - tag.get_height())


def name_tag(name: str, scale: float) -> pygame.Surface:
    """A name on a shade, in letters as they are at a height of 360 pixels times scale."""
    pygame.font.init()
    text = plain_font(max(9, round(TEXT_HEIGHT * scale)), True).render(name, True, (255, 255, 255))
    side, above = round(9 * scale), round(3 * scale)
    tag = pygame.Surface((text.get_width() + 2 * side, text.get_height() + 2 * above), pygame.SRCALPHA)
    pygame.draw.rect(tag, SHADE, tag.get_rect(), border_radius=round(8 * scale))
    tag.blit(text, (side, above))
    return tag
