"""Columns of jelly boxes, alone or on one another, that are higher than they can stand: see `critical_height`."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sandbox.editor.lint.finding import Finding, Rule, called
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level, NissenMaterial
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.jelly import BoxShape, JellyDef
from sandbox.physics.equation import of_springs
from sandbox.physics.softness.body_motion import critical_height
from sandbox.physics.softness.firmness import LARGEST_READ, FirmnessRange, OutOfReach

# What is less tall than so many times its width falls over by nothing but its corners.
SLENDER = 2.0
# What is nearer above a body than this share of its height lies on it, if their middles are within half of a width.
NEAR = 0.25


class _Box(NamedTuple):
    """A jelly box of the level by its index: where it begins and ends along and across gravity [m]."""

    body: int
    low: float
    high: float
    left: float
    right: float

    @property
    def width(self) -> float:
        return self.right - self.left


def buckling_columns(level: Level, scene: Scene) -> Rule:
    """Columns that lean out under their own weight, whatever the solver."""
    boxes = list(_boxes(level, scene))
    yield None
    for column in _columns(boxes, level.has_contacts):
        tall = sum(box.high - box.low for box in column)
        if tall > SLENDER * min(box.width for box in column):
            most = min(_critical(level, index) for index in {box.body for box in column})
            if tall > most:
                yield _finding(level, scene, column, tall, most)
        yield None


def _finding(level: Level, scene: Scene, column: list[_Box], tall: float, most: float) -> Finding:
    items = [scene.items[box.body] for box in column]
    if len(column) == 1:
        what, cure = f"{called(level, items[0])} is", "make it firmer, wider or lower"
    else:
        what = f"the column of {len(column)} bodies on {called(level, items[0])} is"
        cure = "make them firmer or wider, or take some off"
    text = f"{what} {tall:.3g} m tall, and a column of this jelly buckles above {most:.2g} m; {cure}"
    many = "{count} columns of jelly are taller than they can stand; make them firmer, wider or lower"
    x, y = np.mean(scene.position[scene.particle_item == column[-1].body], axis=0).tolist()
    return Finding("hint", text, frozenset(items), (x, y), many=many)


def _boxes(level: Level, scene: Scene) -> Iterator[_Box]:
    up = -np.array(level.settings.gravity, dtype=np.float64)
    if not up.any():
        return
    up /= np.sqrt(np.sum(up * up))
    for index, body in enumerate(level.bodies):
        if isinstance(body, JellyDef) and isinstance(body.shape, BoxShape) and not body.pinned:
            place = scene.position[scene.particle_item == index]
            along, across = place @ up, place @ np.array([up[1], -up[0]])
            yield _Box(index, *(float(value) for part in (along, across) for value in (part.min(), part.max())))


def _columns(boxes: list[_Box], may_touch: bool) -> Iterator[list[_Box]]:
    """Stacks of boxes, each from the lowest up."""
    remaining = sorted(boxes, key=lambda box: box.low)
    while remaining:
        column = [remaining.pop(0)]
        while may_touch and (above := next((box for box in remaining if _lies_on(box, column[-1])), None)) is not None:
            remaining.remove(above)
            column.append(above)
        yield column


def _lies_on(box: _Box, lower: _Box) -> bool:
    apart = abs(box.left + box.right - lower.left - lower.right) / 2.0
    near = abs(box.low - lower.high) < NEAR * (lower.high - lower.low)
    return near and apart < min(box.width, lower.width) / 2.0


def _critical(level: Level, index: int) -> float:
    """The height [m] above which a column like a body buckles; inf where it is not known."""
    body, settings = level.bodies[index], level.settings
    made = expansion(body)
    material = level.material(body.material)
    if made.form_count[0] > LARGEST_READ or not isinstance(material, NissenMaterial):
        return float("inf")
    form = made.stiff_form
    pair = material.stiffness, material.damping
    if body.firmness is not None:
        reach = FirmnessRange.of(form, settings.gravity, settings.tick_rate)
        try:
            pair = of_springs(*reach.coefficients(body.firmness.asked), reach.lowest_mode)
        except OutOfReach:
            return float("inf")
    return critical_height(form, settings.gravity, *pair, 1.0 / settings.tick_rate)
