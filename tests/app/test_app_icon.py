"""The app's icon: what is shipped is what the command draws, and it can be made out on light and dark at 20 pixels."""

import numpy as np
import pygame
import pytest

from sandbox.app.draw.app_icon import SIDE, app_icon, icon_file


def test_the_icon_that_is_shipped_is_the_one_that_the_command_draws():
    shipped, drawn = (
        np.dstack([pygame.surfarray.array3d(each), pygame.surfarray.array_alpha(each)[..., None]]).astype(int)
        for each in (pygame.image.load(icon_file()), app_icon(SIDE))
    )
    assert shipped.shape == drawn.shape == (SIDE, SIDE, 4)
    assert np.abs(shipped - drawn).mean() < 1.0


@pytest.mark.parametrize("ground", [(251, 243, 227), (32, 42, 62)])
def test_body_and_eyes_can_be_told_apart_at_20_pixels(ground):
    small = pygame.Surface((20, 20))
    small.fill(ground)
    small.blit(pygame.transform.smoothscale(app_icon(SIDE), (20, 20)), (0, 0))
    pixels = pygame.surfarray.array3d(small).astype(int)
    red = (pixels[..., 0] > 150) & (pixels[..., 1] < 130) & (pixels[..., 2] < 160)
    eyes = np.stack([pixels[6:9, 5:8], pixels[12:15, 5:8]]).reshape(-1, 3)
    assert red.sum() > 60 and eyes.sum(axis=1).max() > 480 and eyes.sum(axis=1).min() < 330
