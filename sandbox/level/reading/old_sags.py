"""Sags of levels before version 4: those of a square of a body's height whose slowest wobble is the body's.

Since version 4 a sag is what the body itself shows where it stands. So that an older level means what it meant, its
bodies get the frequency and the damping ratio that their sags came to; and rules the sags that they really made.
"""

from typing import Any

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.faults.validate import check_level
from sandbox.level.format.limits import FREQUENCY_RANGE, SAG_LIMIT
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody, expansion
from sandbox.level.kinds.body_def import FirmnessDef
from sandbox.physics.keeping.equipment import design_gravity, height_of
from sandbox.physics.softness.firmness import FirmnessRange, lowest_mode_of
from sandbox.physics.softness.kernels.reach import BY_SAG, FIRMED, Reach, coefficients_within, wobble_of_square

# Versions before it have such sags.
SAGS_STAND = 4


def with_old_sags(level: Level, source: str) -> Level:
    """A level that an older version wrote, in the words of this one. Raises LevelError with all other faults."""
    ruled = {action.body for rule in level.rules for action in rule.then if action.sag}
    sagging = {body.id for body in level.bodies if body.firmness is not None and body.firmness.sag}
    if not ruled | sagging:
        return level
    # What is built is within the limits, and can be built.
    plain = [replaced(body, firmness=None) if body.id in sagging else body for body in level.bodies]
    check_level(replaced(level, bodies=tuple(plain)), source)
    bodies = {body.id: body for body in level.bodies}
    acts = [tuple(_as_it_sagged(level, bodies, action) for action in rule.then) for rule in level.rules]
    rules = tuple(replaced(rule, then=then) for rule, then in zip(level.rules, acts, strict=True))
    made = tuple(_as_it_wobbled(level, body) if body.id in sagging else body for body in level.bodies)
    return replaced(level, bodies=made, rules=rules)


def _as_it_wobbled(level: Level, body: AnyBody) -> AnyBody:
    assert body.firmness is not None and body.firmness.sag is not None
    reach, sag = _reach_of(level, body), body.firmness.sag
    if coefficients_within(*reach, BY_SAG, sag, 0.0, np.zeros(2)) != FIRMED:
        return body
    hz, ratio = wobble_of_square(reach, sag)
    low, high = FREQUENCY_RANGE
    return replaced(body, firmness=FirmnessDef(hz=hz, ratio=ratio)) if low <= hz <= high else body


def _as_it_sagged(level: Level, bodies: dict[str, AnyBody], action: Any) -> Any:
    body = bodies.get(action.body)
    if body is None or not action.sag:
        return action
    reach, pair = _reach_of(level, body), np.zeros(2)
    if coefficients_within(*reach, BY_SAG, action.sag, 0.0, pair) != FIRMED:
        return action
    now = FirmnessRange.of(expansion(body).stiff_form, level.settings.gravity, level.settings.tick_rate)
    return replaced(action, sag=min(now.sag_of(*pair.tolist()), SAG_LIMIT))


def _reach_of(level: Level, body: AnyBody) -> Reach:
    shape, settings = expansion(body).stiff_form, level.settings
    height = height_of(shape, *settings.gravity)
    return Reach(lowest_mode_of(shape), height, design_gravity(*settings.gravity), 1.0 / settings.tick_rate)
