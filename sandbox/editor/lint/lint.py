"""Lint: what the maker of a level may have overlooked, found a slice at a time while they draw.

A document's level is sound, which every edit sees to; these are things that a sound level can have all the same.
"""

import itertools
from collections.abc import Iterator

import numpy as np

from sandbox.editor.lint.beginning import beginnings
from sandbox.editor.lint.checks import checks_without_hands, hopeless_checks
from sandbox.editor.lint.contacts import buried_particles, turning_in_vain
from sandbox.editor.lint.finding import (
    GROUND,
    Finding,
    Rule,
    called,
    deletion,
    falling_particles,
    listed,
    middle_of,
)
from sandbox.editor.lint.hopeless_rules import hopeless_rules, idle_counters, open_goals, vain_goals
from sandbox.editor.lint.hydraulics import hydraulics_at_another_length
from sandbox.editor.lint.looks import unknown_looks
from sandbox.editor.lint.motors import motors_in_vain
from sandbox.editor.lint.places import crossing_bodies, overlapping_particles, water_in_water
from sandbox.editor.lint.solver import springs_past_limits
from sandbox.editor.lint.stacks import buckling_columns
from sandbox.editor.scene import Scene
from sandbox.level.document.model import Level

__all__ = ["Finding", "findings"]


def findings(level: Level, scene: Scene) -> Iterator[Finding | None]:
    """Everything found about a level, of which scene is the scene; None = a point at which to let the window draw."""
    rules = (
        hopeless_checks(level, scene),
        checks_without_hands(level, scene),
        hopeless_rules(level, scene),
        idle_counters(level),
        open_goals(level),
        vain_goals(level),
        springs_past_limits(level, scene),
        falling_parts(level, scene),
        idle_items(scene),
        motors_in_vain(level, scene),
        hydraulics_at_another_length(level, scene),
        unknown_looks(level),
        overlapping_particles(scene),
        crossing_bodies(level, scene),
        buried_particles(level, scene),
        turning_in_vain(level, scene),
        buckling_columns(level, scene),
        water_in_water(level),
        beginnings(level, scene),
    )
    return itertools.chain.from_iterable(listed(rule) for rule in rules)


def falling_parts(level: Level, scene: Scene) -> Rule:
    """Parts that nothing holds, under gravity."""
    part, is_falling = yield from falling_particles(level, scene)
    falling = np.flatnonzero(is_falling)
    yield None
    # Particles part by part, parts in order of their first particle.
    falling = falling[np.argsort(part[falling], kind="stable")]
    yield None
    starts = np.flatnonzero(np.diff(part[falling], prepend=-1, append=len(part))).tolist()
    whole = np.bincount(scene.particle_item, minlength=len(scene.items))
    for start, end in itertools.pairwise(starts):
        slots = falling[start:end]
        owners, counts = np.unique(scene.particle_item[slots], return_counts=True)
        items = [scene.items[index] for index in owners.tolist()]
        if len(items) == 1 and counts[0] < whole[owners[0]]:
            subject = f'"{scene.names(int(slots[0]))}"' + (f" and {len(slots) - 1} more" if len(slots) > 1 else "")
        else:
            subject = called(scene.level, items[0]) + (
                f" and what it is joined to, {len(items)} items," if len(items) > 1 else ""
            )
        text = f"{subject} will fall out of sight: nothing holds it; pin a particle of it or join it to something"
        many = "{count} things will fall out of sight: nothing holds them; pin them, join them, or draw ground below"
        yield Finding("warning", text, frozenset(items), scene.place(int(slots[0])), GROUND, many)
        yield None


def idle_items(scene: Scene) -> Rule:
    """Loose springs between two pinned particles, and pinned loose particles that hold nothing and touch nothing."""
    bodies = len(scene.level.bodies)
    loose = np.flatnonzero(scene.spring_item >= bodies + len(scene.level.particles))
    held = loose[scene.pinned[scene.particle_a[loose]] & scene.pinned[scene.particle_b[loose]]]
    for spring in held.tolist():
        item = scene.items[int(scene.spring_item[spring])]
        text = f"{called(scene.level, item)} does nothing: both its ends are pinned; unpin one or delete it"
        many = "{count} springs do nothing: both their ends are pinned; unpin one or delete them"
        chosen = frozenset([item])
        yield Finding("hint", text, chosen, middle_of(scene, spring), deletion(chosen), many)
    yield None
    used = np.zeros(len(scene.position), dtype=np.bool_)
    for slots in (scene.particle_a, scene.particle_b, scene.welds.ravel()):
        used[slots] = True
    if scene.level.has_contacts:
        used |= scene.collision.touches != 0
    for slot in np.flatnonzero(scene.pinned & ~used & (scene.particle_item >= bodies)).tolist():
        item = scene.items[int(scene.particle_item[slot])]
        text = f"{called(scene.level, item)} is pinned and holds nothing; join something to it or delete it"
        many = "{count} particles are pinned and hold nothing; join something to them or delete them"
        chosen = frozenset([item])
        yield Finding("hint", text, chosen, scene.place(slot), deletion(chosen), many)
    yield None
