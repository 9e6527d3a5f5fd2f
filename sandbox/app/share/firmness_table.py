"""The table of firmness of a page: by material, Cs and Cd of each word, what sags by how much, and the pad's map."""

from collections.abc import Generator
from dataclasses import replace
from typing import Any

import numpy as np

from sandbox.app.base.sag_map import SagMap, own_of, scale_of, word_pairs
from sandbox.app.base.sag_sentences import sag_sentence, subject_words
from sandbox.level.document.model import Level
from sandbox.physics import jit
from sandbox.physics.softness.body_motion import FLAT, BodyMotion
from sandbox.physics.softness.sag_meter import MeasuredBody, SagMeters, measured_bodies
from sandbox.physics.world import World

# Cs and Cd for the words of firmness where nothing sags that could tell what they mean.
USUAL = {"jelly": (0.01, 0.1), "soft": (0.05, 0.2), "firm": (0.3, 0.5), "hard": (0.8, 0.9), "rigid": (1.0, 1.0)}
ALL = "All"
# Work [s] on runs between two answers.
SLICE = 0.02

Rows = list[dict[str, Any]]


def material_rows(world: World, level: Level, done: bool) -> Generator[float, None, Rows]:
    """Materials that springs have; before several of them, all as one. Yields how much is done while runs go on.

    What is shown first is the material that the level's text speaks of, else that of the most springs.
    """
    used = [slot for slot in range(len(world.material_names)) if (world.material == slot).any()]
    rows: list[tuple[str, int | None]] = [(world.material_names[slot], slot) for slot in used]
    if len(rows) > 1:
        rows.insert(0, (ALL, None))
    counts = np.bincount(world.material[world.material >= 0], minlength=1)
    first = None if level.look is None else level.look.material
    shown = first if first in world.material_names else world.material_names[int(np.argmax(counts))]
    subjects, meters, found = measured_bodies(world), SagMeters(), []
    for name, slot in rows:
        own = own_of(level, name) if slot is not None else None
        made = yield from _words(world, slot, subjects, meters, own or (), float(done))
        found.append({"name": name, "slot": slot, "is_first": slot is not None and name == shown, **made})
    return found


def _words(
    world: World,
    material: int | None,
    subjects: dict[str, MeasuredBody],
    meters: SagMeters,
    own: tuple[float, ...],
    done: float,
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
    support, pairs = meter.body.support, word_pairs(meter, motion)
    said = sag_sentence(subject.name, support)
    return {
        "words": pairs,
        "subject": subject_words(subject.name, support),
        "says": {"sag": said.sag, "flat": said.flat, "flat_from": FLAT},
        "map": SagMap.of(motion, scale_of(motion, pairs, own)).as_data(),
    }
