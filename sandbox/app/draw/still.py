"""Still: the picture of a world in which nothing is seen to change; it is kept, and shown again for next to nothing."""

from collections.abc import Sequence

import numpy as np
import pygame
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Movements below this [pixels] are not seen, nor turns [rad], nor strains that differ by less.
UNSEEN, UNSEEN_TURN, UNSEEN_STRAIN = 0.08, 0.01, 1e-3


class Still:
    """Keeps a picture once two in a row were drawn from the same values."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._numbers: list[tuple[Floats, float]] = []
        self._picture: pygame.Surface | None = None
        self._is_same = False

    def follow(self, key: tuple[object, ...], numbers: Sequence[tuple[Floats, float]]) -> None:
        """Take in what the next picture is drawn from.

        key: what must be equal; numbers: arrays, each with how far its values may go from those of the picture.
        """
        self._is_same = (
            key == self._key
            and len(numbers) == len(self._numbers)
            and all(_is_near(new, old, most) for (new, most), (old, _) in zip(numbers, self._numbers, strict=True))
        )
        if not self._is_same:
            self._key, self._numbers, self._picture = key, [(values.copy(), most) for values, most in numbers], None

    def show(self, surface: pygame.Surface, place: pygame.Rect) -> bool:
        """Show the kept picture, if there is one; whether it did."""
        if not self._is_same or self._picture is None:
            return False
        surface.blit(self._picture, place)
        return True

    def keep(self, surface: pygame.Surface, place: pygame.Rect) -> None:
        """Keep the picture that was drawn, if it and the one before were drawn from the same values."""
        if self._is_same:
            self._picture = pygame.Surface(place.size, 0, surface)
            self._picture.blit(surface, (0, 0), place)


def _is_near(new: Floats, old: Floats, most: float) -> bool:
    if len(new) != len(old):
        return False
    with np.errstate(invalid="ignore"):
        return bool(((np.abs(new - old) <= most) | (new == old) | (np.isnan(new) & np.isnan(old))).all())
