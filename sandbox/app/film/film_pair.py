"""FilmPair: two films of the same ticks beside each other, or one below the other, as two runs are compared."""

from collections.abc import Iterator, Sequence

import pygame

from sandbox.app.draw.camera import Box
from sandbox.app.draw.colours import LINE
from sandbox.app.film.film import EDGE, Film, corner_tag, name_tag, picture_count
from sandbox.app.film.kinds import Size

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
        """What the pictures of each show [m]: left, bottom, right, top."""
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
    """What pictures of a pair are laid on. places: of each of the two [pixels]."""

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
        """Lay a picture of each on it."""
        for picture, place in zip(halves, self.places, strict=True):
            self._surface.blit(picture, place)
        pygame.draw.line(self._surface, LINE, *self._line, self._thick)
        for tag, corner in self._tags:
            self._surface.blit(tag, corner)
        return self._surface


def _tags_within(words: Sequence[str], room: int, scale: float) -> list[pygame.Surface]:
    """Tags in letters of one size, none wider than this many pixels; the end of what is too long is left out."""
    for part in SMALLER:
        tags = [name_tag(text, scale * part) for text in words]
        if all(tag.get_width() <= room for tag in tags):
            break
    return [tag.subsurface((0, 0, min(tag.get_width(), room), tag.get_height())) for tag in tags]
