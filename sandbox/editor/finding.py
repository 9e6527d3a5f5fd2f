"""Finding: one thing about a level that its maker may want to know; and rules, which look for them in slices."""

from collections.abc import Generator, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sandbox.editor.items import Item, Selection
from sandbox.editor.scene import Scene
from sandbox.level.model import Level

Severity = Literal["error", "warning", "hint"]
Slots = NDArray[np.int64]
# What a rule gives: findings, and None where it has worked for long enough to let the window draw.
Rule = Iterator["Finding | None"]

# Findings of one kind that are listed one by one; the rest is told in one line.
LISTED = 20


@dataclass(frozen=True)
class Finding:
    """A sentence that says what is so and what to do, the items it is about, and where [m]."""

    severity: Severity
    text: str
    items: Selection
    place: tuple[float, float] | None


def listed(rule: Rule) -> Rule:
    """The first findings of a rule, and one line for all others of it."""
    count, rest = 0, 0
    items: set[Item] = set()
    last: Finding | None = None
    for finding in rule:
        if finding is not None:
            count += 1
            if count > LISTED:
                rest += 1
                items |= finding.items
                last, finding = finding, None
        yield finding
    if last is not None:
        yield Finding(last.severity, f"And {rest} more, such as: {last.text}", frozenset(items), last.place)


def called(item: Item) -> str:
    """An item as sentences name it."""
    return f'"{item.key}"' if item.kind != "spring" else f'spring ":{item.key}"'


def place_of(scene: Scene, slot: int) -> tuple[float, float]:
    """Place [m] of a particle."""
    x, y = scene.position[slot].tolist()
    return x, y


def middle_of(scene: Scene, spring: int) -> tuple[float, float]:
    """Middle [m] of a spring."""
    ends = scene.position[[scene.particle_a[spring], scene.particle_b[spring]]]
    x, y = ends.mean(axis=0).tolist()
    return x, y


def connected_parts(scene: Scene) -> Generator[None, None, Slots]:
    """The lowest slot of the part that each particle belongs to (n,): what springs and welds hold together.

    Roots take over the lowest neighbour's label until no spring joins two labels, which takes few rounds.
    """
    label = scene.first_of_weld.copy()
    a, b = scene.particle_a, scene.particle_b
    while True:
        a, b = label[a], label[b]
        apart = a != b
        a, b = a[apart], b[apart]
        if not len(a):
            return label
        np.minimum.at(label, np.maximum(a, b), np.minimum(a, b))
        yield None
        while True:
            lower = label[label]
            if np.array_equal(lower, label):
                break
            label = lower
        yield None


def falling_particles(level: Level, scene: Scene) -> Generator[None, None, tuple[Slots, NDArray[np.bool_]]]:
    """The part that each particle belongs to (n,), and whether gravity takes it away (n,): no pin holds its part."""
    part = yield from connected_parts(scene)
    held = np.zeros(len(part), dtype=np.bool_)
    held[part[scene.pinned]] = True
    return part, ~held[part] & (level.settings.gravity != (0.0, 0.0))
