"""What icons of tools are drawn with, and those that the app shows elsewhere too; nothing here takes long to import."""

from collections.abc import Callable
from typing import Protocol


class IconPen(Protocol):
    """Draws on a grid of 24 x 24, y downward."""

    def line(self, *points: tuple[float, float], width: float = ...) -> None:
        """A line through points, with round ends."""
        ...

    def shape(self, *points: tuple[float, float]) -> None:
        """A filled polygon."""
        ...

    def disc(self, x: float, y: float, radius: float, width: float = ...) -> None:
        """A disc, or a ring of a width."""
        ...

    def arc(self, x: float, y: float, radius: float, start: float, end: float) -> None:
        """An arc about a point, counter-clockwise between two angles in degrees."""
        ...


Icon = Callable[[IconPen], None]


def draw_spring(pen: IconPen) -> None:
    """A zigzag between two particles."""
    pen.line((3, 12), (6, 12), (8, 6), (12, 18), (16, 6), (18, 12), (21, 12), width=2.2)
    pen.disc(3.5, 12, 3)
    pen.disc(20.5, 12, 3)


def draw_pin(pen: IconPen) -> None:
    """A pin with a round head."""
    pen.disc(12, 9, 6, 2)
    pen.disc(12, 9, 2)
    pen.line((12, 15), (12, 21))
