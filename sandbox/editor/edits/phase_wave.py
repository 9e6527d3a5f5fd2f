"""Phase waves: muscles that swing one after another, by where they lie along a way or by their order."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.items import Definition, Item, changed, chosen_items, definitions, items_of
from sandbox.editor.scene import make_scene
from sandbox.level.format.quantities import Point, replaced

# Digits of a phase behind the point: a part in 10,000 of a period is less than a tick.
DECIMALS = 4


def muscles(document: Document) -> list[Item]:
    """The selected muscles in file order, or all of the level where none is selected; bodies whose springs are, too."""
    level = document.level
    found = chosen_items(level, document.selection)
    chosen = [item for item, part in found.items() if part.__dict__.get("drive") is not None]
    every = zip(items_of(level), definitions(level), strict=True)
    return chosen or [item for item, part in every if part.__dict__.get("drive") is not None]


def wave_along(document: Document, start: Point, end: Point, waves: float = 1.0) -> Document:
    """Let muscles swing later the farther they lie on the way from start to end [m]: this many waves along it.

    The wave runs from start to end; what lies beside is measured along the way. Raises EditError.
    """
    way = np.subtract(end, start)
    squared = float(way @ way)
    if squared == 0.0:
        raise EditError("drag farther")
    scene = make_scene(document.level)

    def share(item: Item) -> float:
        own = frozenset([item])
        springs = np.flatnonzero(scene.springs_of(own))
        ends = np.concatenate([scene.particle_a[springs], scene.particle_b[springs]])
        return float((scene.position[ends].mean(axis=0) - start) @ way) / squared

    return _with_phases(document, share, waves)


def wave_in_order(document: Document, waves: float = 1.0) -> Document:
    """Let muscles swing one after another in their order, this many waves once round. Raises EditError."""
    found = muscles(document)
    places = {item: index / len(found) for index, item in enumerate(found)}
    return _with_phases(document, places.__getitem__, waves)


def _with_phases(document: Document, share: Callable[[Item], float], waves: float) -> Document:
    """The document with the phase of every muscle by its share of the way."""
    if not math.isfinite(waves):
        raise EditError("waves: give a number")
    found = muscles(document)
    if not found:
        raise EditError("there is no muscle; select springs or bodies, and add one under Drive in Properties")
    level, phases = document.level, {item: _phase(-waves * share(item)) for item in found}
    for phase in set(phases.values()):
        alike = frozenset(item for item in found if phases[item] == phase)
        level = changed(level, alike, lambda part, phase=phase: _ahead(part, phase))  # type: ignore[misc]
    return document if level is document.level else replace(document, level=checked(level))


def _phase(turns: float) -> float:
    """A phase from 0 up to 1."""
    return round(turns % 1.0, DECIMALS) % 1.0


def _ahead(part: Definition, phase: float) -> Definition:
    drive = part.__dict__["drive"]
    return part if drive.phase == phase else replaced(part, drive=replaced(drive, phase=phase))
