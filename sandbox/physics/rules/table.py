"""The table of a level's rules, as kernels read it. What a run makes of them is state (state.py)."""

from typing import NamedTuple

from sandbox.physics.arrays import Flags, Floats, Slots
from sandbox.physics.rules.zones import Zones

# What a term asks. Of those from CENTRE_X on a value lies between bounds; of the last, terms are asked.
TOUCHES, CROSSES, CENTRE_X, CENTRE_Y, SPEED, DISTANCE, INSIDE, FASTEST, STRAIN, MOTION, BROKEN, UNSOUND = range(12)
SETTLED, COUNTER, TIME, KEY, ALL, ANY, NOT = range(12, 19)
# Of things, what no rule names.
NOBODY = -1


class Terms(NamedTuple):
    """What rules ask, each below what asks it in turn; those of TOUCHES come first."""

    kind: Slots
    first: Slots  # first, last: the slots of what it is about; of ALL, ANY and NOT the members
    last: Slots
    zone: Slots  # of INSIDE and CROSSES; of TOUCHES the first thing
    other: Slots  # the second thing or NOBODY, slot, counter, key, first probe or first of `still_ticks`
    low: Floats  # low, high: the bounds, both included
    high: Floats
    slot: Slots  # particles, or springs of STRAIN and BROKEN
    member: Slots  # terms
    value: Floats  # value, holds: as they were found last
    holds: Flags


class Things(NamedTuple):
    """The number of the body, loose particle or piece of terrain that each belongs to, or NOBODY."""

    of_particle: Slots
    of_spring: Slots
    of_terrain: Slots


class Rules(NamedTuple):
    """The rules of a level, in the order of the file."""

    zones: Zones
    terms: Terms
    things: Things
    term: Slots  # what each asks
    delay: Slots  # [ticks] that it must have held before
    once: Flags
    probe: Slots  # particles whose way is followed
