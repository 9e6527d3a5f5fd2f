"""GIF files: what a viewer decodes is what was drawn, for as long as it was to be seen."""

import io

import numpy as np
import pygame
import pytest
from PIL import Image, ImageSequence

from sandbox.app.share.gif import GifWriter

SIZE = (96, 54)


def picture(step, still=False):
    """A dark stage that grows lighter downward, with a lit ball that goes across it."""
    surface = pygame.Surface(SIZE, 0, 32)
    for row in range(SIZE[1]):
        surface.fill((12 + row // 4, 16 + row // 3, 24 + row // 2), (0, row, SIZE[0], 1))
    if not still:
        pygame.draw.circle(surface, (242, 85, 123), (10 + 6 * step, 30), 9)
        pygame.draw.circle(surface, (255, 190, 210), (8 + 6 * step, 27), 3)
    return surface


def written(pictures, fps):
    file = io.BytesIO()
    writer = GifWriter(file, SIZE, fps, pictures[:: max(1, len(pictures) // 4)], len(pictures))
    for one in pictures:
        writer.add(one)
    writer.close()
    return file.getvalue()


def frames(data):
    with Image.open(io.BytesIO(data)) as gif:
        assert gif.info["loop"] == 0
        return [
            (np.asarray(one.convert("RGB")).astype(int), one.info["duration"]) for one in ImageSequence.Iterator(gif)
        ]


def pixels(surface):
    return pygame.surfarray.array3d(surface).transpose(1, 0, 2).astype(int)


def test_every_picture_is_seen_as_it_was_drawn_but_for_a_shade():
    drawn = [picture(step) for step in range(12)]
    shown = frames(written(drawn, 20))
    assert [duration for _, duration in shown] == [50] * 12
    for surface, (frame, _) in zip(drawn, shown, strict=True):
        error = np.abs(frame - pixels(surface))
        assert error.mean() < 3.0 and np.quantile(error, 0.99) < 24.0


def test_a_slow_gradient_has_no_bands():
    shown, _ = frames(written([picture(0, still=True)] * 2, 10))[0]
    wanted = pixels(picture(0, still=True))
    # Bands would be rows that are all too dark beside rows that are all too light.
    assert np.abs(shown.mean(axis=1) - wanted.mean(axis=1)).max() < 2.5


@pytest.mark.parametrize("fps", [15, 24, 33])
def test_what_hundredths_of_a_second_cannot_say_does_not_add_up(fps):
    shown = frames(written([picture(step % 13) for step in range(fps)], fps))
    assert sum(duration for _, duration in shown) == 1000


def test_what_stands_still_takes_one_picture_and_next_to_no_bytes():
    still, moving = written([picture(0)] * 40, 20), written([picture(step % 13) for step in range(40)], 20)
    assert [duration for _, duration in frames(still)] == [2000]
    assert len(still) < len(moving) / 3


def test_what_moves_everywhere_is_kept_small_by_leaving_slight_changes_out(monkeypatch):
    rng = np.random.default_rng(1)
    shade = rng.integers(60, 120, (SIZE[0] + 120, SIZE[1], 3))
    drawn = []
    for step in range(120):
        drawn.append(picture(step % 13))
        pygame.surfarray.pixels3d(drawn[-1])[:, 30:] = shade[step : step + SIZE[0], 30:]
    free = written(drawn, 20)
    monkeypatch.setattr("sandbox.app.share.gif.MOST_BYTES", 0.6 * len(free) / (SIZE[0] * SIZE[1]))
    bounded = written(drawn, 20)
    assert len(bounded) < 0.8 * len(free)
    last = frames(bounded)[-1][0]
    assert np.abs(last - pixels(drawn[-1])).mean() < 20.0
