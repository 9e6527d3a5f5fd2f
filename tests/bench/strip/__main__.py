"""The same rope in four engines after the same second, as a table and a strip of pictures.

python -m tests.bench.strip [PICTURE.png]

Each engine runs at its defaults. An engine that is not here is left out, which is said.
"""

import importlib.metadata
import importlib.util
import math
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

import numpy as np
import pygame

from sandbox.app.draw.picture import write_png
from sandbox.app.widgets.fonts import plain_font
from sandbox.physics.arrays import Floats
from tests.bench.engines import FRAME, Setting, box2d_setting, pymunk_setting, sandbox_setting
from tests.bench.scenes import LINK, Scene, rope
from tests.bench.strip.rapier import NoRapier, fetched

OURS = "Spring Sandbox"
# A rope of 40 links with 100 times the mass of one at its end, let go level.
COUNT, LOAD = 40, 100.0
SECONDS, RUNS = 1.0, 21
FRAMES = round(SECONDS / FRAME)
# A panel [pixels], how much larger it is drawn, the height of what is written below, and the pixels of a metre.
PANEL, LARGER, BELOW, METRE = (250, 250), 2, 78, 43.0
PIN = (34, 26)
PAPER, INK, MUTED, TRUE = (255, 255, 255), (31, 35, 40), (89, 99, 110), (140, 149, 159)
CALM, STRETCHED, MOST = (46, 112, 190), (214, 84, 20), 0.5


@dataclass(frozen=True)
class Result:
    """What came of it in an engine: ms of a frame, median of the best run, and positions [m] (n, 2) at the end."""

    engine: str
    setting: str
    milliseconds: float
    position: Floats

    @property
    def strain(self) -> Floats:
        """The strain of each link."""
        return np.sqrt(np.sum(np.diff(self.position, axis=0) ** 2, axis=1)) / LINK - 1.0

    @property
    def rms(self) -> float:
        """RMS stretch."""
        return float(np.sqrt(np.mean(self.strain**2)))


def measured(scene: Scene, setting: Setting, engine: str) -> Result:
    """A scene in an engine that Python drives."""
    medians = []
    for _ in range(RUNS):
        running, times = setting.build(scene), []
        for _ in range(FRAMES):
            began = time.perf_counter()
            running.frame()
            times.append(time.perf_counter() - began)
        medians.append(1e3 * float(np.median(times)))
    return Result(engine, setting.name, min(medians), running.state()[0].copy())


def results() -> tuple[list[Result], list[Result]]:
    """The engines of the picture, this project last, and what is only in the table."""
    scene, found, more = rope(COUNT, LOAD), [], []
    for module, name, setting in (
        ("pymunk", "pymunk", lambda: pymunk_setting(1, 10)), ("pyb2d3", "Box2D v3", lambda: box2d_setting(4)),
    ):  # fmt: skip
        if importlib.util.find_spec(module) is None:
            print(f"{name} is left out: {module} is not installed", file=sys.stderr)
            continue
        found.append(measured(scene, setting(), f"{name} ({module} {importlib.metadata.version(module)})"))
    try:
        with fetched() as engine:
            for method, into in (("impulse", found), ("multibody", more)):
                version, seconds, places = engine.run(scene, method, FRAMES, RUNS)
                best = 1e3 * float(np.median(seconds, axis=1).min())
                into.append(Result(f"Rapier (npm {version}, in node)", f"revolute {method} joints", best, places))
    except NoRapier as why:
        print(why, file=sys.stderr)
    found.append(measured(scene, sandbox_setting(1), OURS))
    return found, more


def table(rows: list[Result]) -> str:
    """Markdown."""
    lines = ["| engine | setting | RMS stretch after 1 s | ms per frame | time, times ours |", "|---|---|---|---|---|"]
    (ours,) = (row.milliseconds for row in rows if row.engine == OURS)
    for row in rows:
        cells = [percent(row.rms), f"{row.milliseconds:.3f}", f"{row.milliseconds / ours:.1f}"]
        lines.append(f"| {' | '.join([row.engine, row.setting, *cells])} |")
    return "\n".join(lines)


def percent(stretch: float) -> str:
    """A stretch in percent, in one or two digits that count."""
    return f"{100 * stretch:.0f} %" if stretch >= 0.01 else f"{100 * stretch:.1g} %"


def draw(rows: list[Result], path: Path) -> None:
    """Write the strip."""
    pygame.font.init()
    width, height = PANEL[0] * len(rows), PANEL[1] + BELOW
    surface = pygame.Surface((LARGER * width, LARGER * height))
    surface.fill(PAPER)
    for number, row in enumerate(rows):
        _draw_panel(surface, row, LARGER * PANEL[0] * number)
    write_png(pygame.transform.smoothscale(surface, (width, height)), path)


def _draw_panel(surface: pygame.Surface, row: Result, left: int) -> None:
    x0, y0, metre = left + LARGER * PIN[0], LARGER * PIN[1], LARGER * METRE
    length = COUNT * LINK * metre
    for degree in range(0, 91, 3):
        turns = [math.radians(each) for each in (degree, degree + 1.5)]
        ends = [(x0 + length * math.cos(turn), y0 + length * math.sin(turn)) for turn in turns if turn <= math.pi / 2]
        if len(ends) == 2:
            pygame.draw.line(surface, TRUE, *ends, LARGER)
    places = [(x0 + metre * x, y0 - metre * y) for x, y in row.position.tolist()]
    for start, end, strain in zip(places[:-1], places[1:], row.strain.tolist(), strict=True):
        part = min(1.0, abs(strain) / MOST)
        colour = [round(calm + part * (hot - calm)) for calm, hot in zip(CALM, STRETCHED, strict=True)]
        pygame.draw.line(surface, colour, start, end, 2 * LARGER)
        pygame.draw.aacircle(surface, colour, end, 2 * LARGER)
    pygame.draw.rect(surface, INK, pygame.Rect(x0 - 5 * LARGER, y0 - 5 * LARGER, 10 * LARGER, 10 * LARGER))
    pygame.draw.aacircle(surface, INK, places[-1], 9 * LARGER)
    texts = (
        (row.engine.split(" (")[0], 17, True, INK), (f"stretched by {percent(row.rms)}", 14, False, INK),
        (f"{row.milliseconds:.3f} ms a frame", 14, False, MUTED),
    )  # fmt: skip
    y = LARGER * PANEL[1]
    for text, letters, bold, colour in texts:
        picture = plain_font(LARGER * letters, bold).render(text, True, colour)
        surface.blit(picture, (left + LARGER * 24, y))
        y += LARGER * 23


def main() -> None:
    """Print the table, and draw the picture where one is named."""
    shown, more = results()
    print(table(shown + more))
    if sys.argv[1:]:
        draw(shown, Path(sys.argv[1]))


if __name__ == "__main__":
    main()
