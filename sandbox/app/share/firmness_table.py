"""The table of firmness of a page: by material, Cs and Cd of each word, what sags by how much, and the pad's map."""

import math
from collections.abc import Generator
from dataclasses import replace
from typing import Any

import numpy as np

from sandbox.app.base.sag_sentences import sag_sentence, subject_words
from sandbox.app.widgets.coefficient_scale import scale_for
from sandbox.app.widgets.sag_map import SagMap
from sandbox.physics import jit
from sandbox.physics.analysis.body_motion import FLAT, BodyMotion
from sandbox.physics.analysis.firmness import WORDS
from sandbox.physics.analysis.sag_meter import SagMeter
from sandbox.physics.analysis.subjects import Meters, Subject, subjects_of
from sandbox.physics.keeping.forms import Firmness
from sandbox.physics.world import World

# Cs and Cd for the words of firmness where nothing sags that could tell what they mean.
USUAL = {"jelly": (0.01, 0.1), "soft": (0.05, 0.2), "firm": (0.3, 0.5), "hard": (0.8, 0.9), "rigid": (1.0, 1.0)}
ALL = "All"
# Digits, and decimals at most, of Cs and Cd.
DIGITS, DECIMALS = 4, 12
# Work [s] on runs between two answers.
SLICE = 0.02
# Frequencies [Hz] between which a word is looked for, and halvings of that range.
FREQUENCIES, HALVINGS = (0.01, 1_000.0), 40

Rows = list[dict[str, Any]]


def material_rows(world: World, first: str | None, done: bool) -> Generator[float, None, Rows]:
    """Materials that springs have; before several of them, all as one. Yields how much is done while runs go on.

    first: the material that is shown first, None: that of the most springs.
    """
    used = [slot for slot in range(len(world.material_names)) if (world.material == slot).any()]
    rows: list[tuple[str, int | None]] = [(world.material_names[slot], slot) for slot in used]
    if len(rows) > 1:
        rows.insert(0, (ALL, None))
    counts = np.bincount(world.material[world.material >= 0], minlength=1)
    shown = first if first in world.material_names else world.material_names[int(np.argmax(counts))]
    subjects, meters, found = subjects_of(world), Meters(), []
    for name, slot in rows:
        made = yield from _words(world, slot, subjects, meters, float(done))
        found.append({"name": name, "slot": slot, "is_first": slot is not None and name == shown, **made})
    return found


def _words(
    world: World, material: int | None, subjects: dict[str, Subject], meters: Meters, done: float
) -> Generator[float, None, dict[str, Any]]:
    """The words, the sentence and the map of the largest body of a material."""
    of_it = [each for each in subjects.values() if material in (None, int(world.material[each.body.springs[0]]))]
    if not of_it or not jit.COMPILED:
        return {"words": USUAL}
    subject = max(of_it, key=lambda each: len(each.body.springs))
    meter = meters.of(world, subject)
    meter.trace()
    while meter.is_busy:
        meter.advance(SLICE)
        yield done
    if meter.curve is None:
        return {"words": USUAL}
    motion = BodyMotion.of(subject.body.shape, world.settings, subject.lowest_mode or 1.0)
    motion = replace(motion, curve=meter.curve)
    support, pairs = meter.stance.support, {word: _pair(meter, motion, sag) for word, sag in WORDS.items()}
    said = sag_sentence(subject.name, support)
    scale = scale_for(motion.sag_of_tick, tuple(value for pair in pairs.values() for value in pair))
    return {
        "words": pairs,
        "subject": subject_words(subject.name, support),
        "says": {"sag": said.sag, "flat": said.flat, "flat_from": FLAT},
        "map": SagMap.of(motion, scale).as_data(),
    }


def _pair(meter: SagMeter, motion: BodyMotion, sag: float) -> tuple[float, float]:
    """Cs and Cd per tick at which the body sags so far, with the damping that a firmness has."""
    low, high = (math.log(each) for each in FREQUENCIES)
    pair = 1.0, 1.0
    for _ in range(HALVINGS if sag > 0.0 else 0):
        middle = 0.5 * (low + high)
        stiffness, damping, _ = meter.springs_of(meter.range.nearest(Firmness(hz=float(f"{math.exp(middle):.4g}"))))
        pair = stiffness, damping
        is_softer = float(motion.sag_of_tick(np.array([stiffness]), np.array([damping]))[0]) > sag
        low, high = (middle, high) if is_softer else (low, middle)
    return _coefficient(pair[0]), _coefficient(pair[1])


def _coefficient(value: float) -> float:
    """In few digits, or with few digits of what it is below 1 by: that says how firm a stiff body is."""
    if value < 0.5:
        return float(f"{value:.{DIGITS}g}")
    return round(1.0 - float(f"{1.0 - value:.{DIGITS}g}"), DECIMALS)
