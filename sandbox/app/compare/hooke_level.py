"""The levels of the lesson: a weight on Hooke's spring F = -k x - c v, and the same weight on the article's spring.

Both are integrated alike, by symplectic Euler in a single pass. The article's damping acts on what gravity has just
added, too, so its weight hangs higher by Cd m g / k: 2 mm at first, and less the stiffer both are.
"""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import pygame

from sandbox.app.draw.colours import LINE, ThemeName
from sandbox.app.draw.picture import draw_picture
from sandbox.level.document.model import Level
from sandbox.level.reading.parse import parse_level
from sandbox.session.session import Session

# The spring that both begin with: k [N/m] and c [N s/m] of a weight of 1 kg at 60 ticks a second, as Cs and Cd.
FIRST_K, C = 225.0, 3.0
FIRST_CS, CD = 0.0625, 0.05
MOST_DOUBLINGS = 14
# Rest length of all springs together [m], and how far the last weight is drawn away at first.
LENGTH, DRAWN = 1.6, 0.5
# Drawn in this size [pixels] for each side, what it shows [m], and how thick lines are.
SIZE, BOX, LINE_SCALE = (320, 360), (-1.4, -3.1, 2.0, 0.6), 1.6


@dataclass(frozen=True)
class SpringTrial:
    """A trial of the lesson: how often stiffness was doubled, the weights [kg], the ticks a second, springs."""

    doublings: int = 0
    mass: float = 1.0
    rate: int = 60
    springs: int = 1

    @property
    def k(self) -> float:
        """Stiffness [N/m] of each of Hooke's springs."""
        return FIRST_K * 2.0**self.doublings

    @property
    def cs(self) -> float:
        """Cs of each of the article's; 1 is as stiff as a spring can be."""
        return min(1.0, FIRST_CS * 2.0**self.doublings)

    @property
    def highest_k(self) -> float:
        """The k [N/m] beyond which Hooke's springs explode, from the eigenvalues of the network that hangs straight."""
        # (k h^2 + 2 c h) lam < 4, lam the largest eigenvalue of N W N^T.
        inverse, h = 1.0 / self.mass, 1.0 / self.rate
        row = 2.0 * inverse * np.eye(self.springs) - inverse * (np.eye(self.springs, k=1) + np.eye(self.springs, k=-1))
        row[0, 0] = inverse
        return float((4.0 / np.linalg.eigvalsh(row)[-1] - 2.0 * C * h) / (h * h))

    @property
    def are_equal(self) -> bool:
        """Whether both springs are one and the same in this trial."""
        return self.mass == 1.0 and self.rate == 60 and FIRST_CS * 2.0**self.doublings <= 1.0 and self.springs == 1


SIDES = ((SpringTrial(), False), (SpringTrial(doublings=2), True))


def lesson_level(trial: SpringTrial, is_hooke: bool) -> Level:
    """The level of one side."""
    spring = {"stiffness": trial.cs, "damping": CD}
    material: dict[str, Any] = {"law": "hooke", "k": trial.k, "c": C} if is_hooke else spring
    count = trial.springs
    way = (np.arange(1, count + 1) / count)[:, None] * np.array([0.55, -1.0]) * (LENGTH + DRAWN)
    names = [f"weight {number + 1}" for number in range(count)]
    ball = {"mass": trial.mass, "radius": 0.24 if count == 1 else 0.12, "look": {"ball": "steel"}}
    level = {
        "format": "spring-sandbox/level", "version": 3, "name": "Hooke and the article",
        "settings": {"solver": "single_pass", "tick_rate": trial.rate}, "view": [-2.6, -4.2, 2.6, 1.0],
        "materials": {"spring": {**material, "look": {"line": "coil"}}},
        "particles": [
            {"id": "nail", "position": [0.0, 0.0], "pinned": True},
            *({"id": name, "position": at, **ball} for name, at in zip(names, way.tolist(), strict=True)),
        ],
        "springs": [
            {"a": a, "b": b, "rest_length": LENGTH / count, "material": "spring"}
            for a, b in zip(["nail", *names[:-1]], names, strict=True)
        ],
    }  # fmt: skip
    return parse_level(json.dumps(level).encode(), "lesson")


def words(trial: SpringTrial, exploded_at: int | None) -> str:
    """The words of a trial and of what to try next; exploded_at: the tick at which Hooke's side did."""
    weight, limit = f"{trial.mass:g} kg", f"{trial.highest_k:,.0f}"
    if exploded_at is not None:
        return (
            f"It exploded after {exploded_at} ticks. At {trial.rate} ticks a second and {weight}, Hooke's spring takes "
            f"no k above {limit} N/m; it has {trial.k:,.0f}. Each tick its force throws the weight farther past its "
            f"rest than it came from. The article's takes a part of the error away, Cs = {trial.cs:g}, and no part is "
            "more than 1: it cannot explode. Softer, or another weight or rate, and again."
        )
    if trial.k > trial.highest_k:
        return (
            f"k = {trial.k:,.0f} N/m is more than the left spring can take: it shakes and finds no rest. Push it, or "
            "make it stiffer still, and it flies apart. The right one does not care."
        )
    if trial.are_equal and trial.cs < 1.0:
        return (
            "Both are the same spring now: Cs = k h²/m. Drag a weight: both move alike, to 2 mm. Now make them "
            "stiffer, again and again."
        )
    if trial.are_equal:
        return (
            "Cs = 1: in one tick the article's spring takes its whole error away. There is no stiffer one. Hooke's k "
            "has no end, and nothing in F = -k x says how far one may go. Stiffer!"
        )
    if trial.cs == 1.0 and trial.mass == 1.0 and trial.rate == 60 and trial.springs == 1:
        return "The article's spring is at its end and stands. Hooke's overshoots more and more. Once more, stiffer!"
    return (
        f"The same k is another spring now: {weight}, {trial.rate} ticks a second. The most that Hooke's takes has "
        f"become {limit} N/m. Cs means the same as before, and ends at 1 as before. Make them stiffer."
    )


def lesson_picture(size: tuple[int, int], theme: ThemeName) -> pygame.Surface:
    """A picture of both springs side by side, in a size [pixels] and a theme."""
    whole = pygame.Surface((2 * SIZE[0], SIZE[1]), 0, 32)
    for k, (trial, is_hooke) in enumerate(SIDES):
        level = lesson_level(trial, is_hooke)
        whole.blit(draw_picture(level, Session(level).snapshot(), SIZE, BOX, LINE_SCALE, theme), (k * SIZE[0], 0))
    pygame.draw.line(whole, LINE, (SIZE[0], 0), (SIZE[0], SIZE[1]), 4)
    return pygame.transform.smoothscale(whole, size)


def twice(picture: pygame.Surface) -> pygame.Surface:
    """The middle of a picture twice beside itself, in the same size."""
    width, height = picture.get_size()
    whole = picture.copy()
    middle = pygame.Rect(width // 4, 0, width - width // 2, height)
    for left in (0, width // 2):
        whole.blit(picture, (left, 0), middle)
    pygame.draw.line(whole, LINE, (width // 2, 0), (width // 2, height), 2)
    return whole
