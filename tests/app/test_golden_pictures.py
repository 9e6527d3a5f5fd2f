"""Levels look as they did: against kept pictures, in blocks of pixels, so that no machine's rounding counts.

Where one does not, expected, actual and their difference lie side by side in a file that the message names.
"""

import numpy as np
import pygame
import pytest

from sandbox.physics.jit import COMPILED
from tests.app.golden_pictures import KEPT, PICTURES, drawn, golden

# Blocks of pixels that are compared; how far they may be apart, on average and the worst, of 255.
BLOCK, ON_AVERAGE, AT_WORST = 5, 1.2, 20.0
LARGEST_FILE = 60_000


def blocks(surface):
    pixels = pygame.surfarray.array3d(surface).astype(float)
    width, height = KEPT[0] // BLOCK, KEPT[1] // BLOCK
    return pixels.reshape(width, BLOCK, height, BLOCK, 3).mean(axis=(1, 3))


def is_alike(one, other):
    apart = np.abs(blocks(one) - blocks(other))
    return apart.mean() <= ON_AVERAGE and apart.max() <= AT_WORST


def side_by_side(expected, actual):
    """Expected, actual, and four times their difference."""
    both = [pygame.surfarray.array3d(each).astype(int) for each in (expected, actual)]
    difference = np.clip(4 * np.abs(both[0] - both[1]), 0, 255)
    return pygame.surfarray.make_surface(np.concatenate([*both, difference]).astype(np.uint8))


@pytest.mark.skipif(not COMPILED, reason="golden pictures are drawn by kernels")
@pytest.mark.parametrize(("name", "theme", "lattice"), PICTURES, ids=[name for name, *_ in PICTURES])
def test_a_level_looks_as_it_did(name, theme, lattice, tmp_path):
    expected, actual = pygame.image.load(str(golden(name))), drawn(name, theme, lattice)
    if not is_alike(expected, actual):
        shown = tmp_path / f"{name}.png"
        pygame.image.save(side_by_side(expected, actual), str(shown))
        pytest.fail(
            f"expected | actual | difference: {shown}; if it should look so: python -m tests.app.golden_pictures"
        )


def test_the_files_are_small():
    assert all(golden(name).stat().st_size <= LARGEST_FILE for name, *_ in PICTURES)


def test_a_body_in_another_colour_or_place_is_told_and_a_rounding_is_not():
    picture = pygame.image.load(str(golden("jelly_pile")))
    rounded = picture.copy()
    rounded.fill((1, 1, 1), special_flags=pygame.BLEND_RGB_ADD)
    assert is_alike(picture, rounded)
    changed = picture.copy()
    changed.fill((255, 160, 40), pygame.Rect(100, 60, 14, 14))
    assert not is_alike(picture, changed)
    moved = picture.copy()
    moved.scroll(6, 0)
    assert not is_alike(picture, moved)
    assert side_by_side(picture, changed).get_size() == (3 * KEPT[0], KEPT[1])
