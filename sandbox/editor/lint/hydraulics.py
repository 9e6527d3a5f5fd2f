"""Hydraulics that move at once, since they begin at another length than they are drawn at."""

from collections.abc import Callable

import numpy as np

from sandbox.editor.document import Document
from sandbox.editor.edits.fields import set_field
from sandbox.editor.items import Item
from sandbox.editor.lint.finding import Finding, Remedy, Rule, called, middle_of
from sandbox.editor.panel.typed import number_text
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level
from sandbox.level.format.quantities import significant

# What begins no further from its length on the sheet than this part of it is drawn as it begins.
NEAR = 0.05
# Digits of a length that a person reads.
DIGITS = 3


def hydraulics_at_another_length(level: Level, scene: Scene) -> Rule:
    """Hydraulics without a rest length of their own whose shortest length is not the one that they are drawn at."""
    first = len(scene.rest_length) - len(level.springs)
    for index, spring in enumerate(level.springs):
        if spring.hydraulic is None or spring.rest_length is not None:
            continue
        a, b = (scene.position[slots[first + index]] for slots in (scene.particle_a, scene.particle_b))
        drawn, begins = float(np.hypot(*(b - a))), spring.hydraulic.shortest
        if abs(drawn - begins) <= NEAR * drawn:
            continue
        item = Item("spring", index)
        way, deed = ("shorter", "pulls") if begins < drawn else ("longer", "pushes")
        apart = number_text(significant(abs(drawn - begins), DIGITS))
        text = (
            f"{called(level, item)} begins {apart} m {way} than it is drawn and {deed} at once: without a rest length "
            "a hydraulic begins at its shortest; give it one"
        )
        target = significant(drawn, DIGITS)
        remedy = None
        if spring.hydraulic.shortest <= target <= spring.hydraulic.longest:
            remedy = Remedy("Begin as drawn", _begin_at(item, target))
        many = "{count} hydraulics begin at another length than they are drawn and move at once; give them rest lengths"
        yield Finding("hint", text, frozenset([item]), middle_of(scene, first + index), remedy, many)
    yield None


def _begin_at(item: Item, length: float) -> Callable[[Document], Document]:
    def begun(document: Document) -> Document:
        return set_field(document, [item], "rest_length", length)

    return begun
