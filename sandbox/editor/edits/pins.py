"""Pins of a body: names of its ends where these say it, single particles where they do not."""

import numpy as np
from numpy.typing import NDArray

from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import AnyBody, expansion

Mask = NDArray[np.bool_]


def pins_of(body: AnyBody) -> Mask:
    """Which particles of a body (n,) are held."""
    return expansion(body).pinned


def with_pins(body: AnyBody, pinned: Mask) -> AnyBody:
    """The body with those particles (n,) held and no others; an end that was named stays so where all of it is held."""
    named = np.zeros(len(pinned), dtype=np.bool_)
    changes = {}
    if "pin" in body.__dict__:
        kept = []
        for end in body.__dict__["pin"]:
            held = pins_of(replaced(body, pin=(end,), pinned=(), cut=(), pose=None))
            if np.all(pinned[held]):
                kept.append(end)
                named |= held
        changes["pin"] = tuple(kept)
    return replaced(body, pinned=tuple(np.flatnonzero(pinned & ~named).tolist()), **changes)
