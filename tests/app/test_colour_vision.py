"""Colours that carry meaning stay apart for every type of colour vision; what else is seen goes with each of them.

Machado, Oliveira and Fernandes, "A Physiologically-based Model for Simulation of Color Vision Deficiency", 2009: the
matrices of full severity, on linear RGB. Distances are those of CIELAB, of which 2.3 can just be told apart.
"""

import numpy as np
import pytest

from sandbox.app.draw.colours import THEMES
from sandbox.app.draw.overlays import SLIGHT_STRAIN, stability_tones, strain_place, strain_tones

VISION = {
    "usual": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = np.array([0.9505, 1.0, 1.089])
# Neighbouring steps of a scale, and colours that stand for different things, are at least so far apart.
STEP, APART = 8.0, 14.0


def lab(colours, vision):
    """CIELAB (k, 3) of colours (k, 3) 0..255, as someone sees them."""
    plain = np.asarray(colours, dtype=float) / 255.0
    linear = np.where(plain <= 0.04045, plain / 12.92, ((plain + 0.055) / 1.055) ** 2.4)
    relative = np.clip(linear @ VISION[vision].T, 0.0, 1.0) @ TO_XYZ.T / WHITE
    f = np.where(relative > 0.008856, np.cbrt(relative), 7.787 * relative + 16 / 116)
    return np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1)


def channels(tones):
    return np.stack([tones >> 16, (tones >> 8) & 255, tones & 255], axis=1)


def distances(points):
    return np.sqrt(np.sum(np.diff(points, axis=0) ** 2, axis=1))


def test_the_simulation_leaves_greys_grey_and_brings_red_and_green_together():
    greys = [[k, k, k] for k in (0, 90, 180, 255)]
    for vision in VISION:
        assert lab(greys, vision) == pytest.approx(lab(greys, "usual"), abs=0.7)
    pair = [[213, 94, 0], [124, 138, 0]]
    usual, seen = (float(distances(lab(pair, vision))[0]) for vision in ("usual", "deuteranopia"))
    assert seen < 0.4 * usual


@pytest.mark.parametrize("vision", VISION)
@pytest.mark.parametrize("theme", THEMES.values(), ids=THEMES)
def test_steps_of_strain_stay_apart_and_squeezed_is_never_taken_for_stretched(theme, vision):
    # Strains of a factor of five from step to step.
    sizes = SLIGHT_STRAIN * 5.0 ** np.arange(3)
    strain = np.concatenate([-sizes[::-1], [0.0], sizes])
    tones = lab(channels(strain_tones(strain, theme.strain)), vision)
    assert distances(tones).min() > STEP
    for near, far in zip(tones[:3][::-1], tones[4:], strict=True):
        assert np.sqrt(np.sum((near - far) ** 2)) > APART
    # Its width says the same: hue is never alone.
    assert (np.diff(np.abs(strain_place(sizes))) > 0.1).all()


@pytest.mark.parametrize("vision", VISION)
@pytest.mark.parametrize("theme", THEMES.values(), ids=THEMES)
def test_steps_of_stability_and_what_is_past_the_limit_stay_apart(theme, vision):
    tones = lab(channels(stability_tones(np.array([0.0, 0.33, 0.67, 1.0, 1.1]), theme)), vision)
    assert distances(tones).min() > STEP


@pytest.mark.parametrize("vision", VISION)
@pytest.mark.parametrize("theme", THEMES.values(), ids=THEMES)
def test_arrows_and_contacts_are_told_apart_and_seen_on_their_rims(theme, vision):
    own = lab([theme.contact, theme.force, theme.velocity], vision)
    assert min(np.sqrt(np.sum((own[a] - own[b]) ** 2)) for a, b in ((0, 1), (0, 2), (1, 2))) > APART
    rim = lab([theme.card], vision)
    assert np.abs(own[:, 0] - rim[:, 0]).min() > 35.0
