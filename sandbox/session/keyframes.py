"""Keyframes: states of a run that are kept, so that going back steps again from the nearest one only."""

import bisect
from collections import deque
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, replace

from sandbox.physics.snapshot import Snapshot, take
from sandbox.physics.world import World

KEYFRAME_TICKS = 60
# Commands of one tick after which its state is kept as well, until the next keyframe, so that undoing the last of
# thousands does not carry out all the others again: this many, and this many more for each particle, as keeping takes
# longer then. Lower keeps more, higher undoes slower.
KEYFRAME_COMMANDS, COMMANDS_PER_PARTICLE = 4, 0.004
# Memory for keyframes [bytes]; beyond it every other one goes, and going back re-steps twice as far.
KEYFRAME_BUDGET = 128 * 2**20


@dataclass(frozen=True)
class Keyframe:
    """The state of a tick once all commands of an order below this one are applied; between: of some of that tick."""

    order: int
    snapshot: Snapshot
    between: bool = False

    @property
    def tick(self) -> int:
        """Ticks since the level's start."""
        return self.snapshot.tick


class Keyframes:
    """The states that are kept, in order, at least the first one; what did not change between two is kept once."""

    def __init__(self, first: Keyframe) -> None:
        self._kept = [first]
        self._size = _own_size(first, None)
        # Ticks between two keyframes, twice as many each time that the budget is used up.
        self._spacing = KEYFRAME_TICKS
        # Ticks on the way to the last one sought: going back tick by tick steps a span again once only.
        self._passed: deque[Keyframe] = deque(maxlen=KEYFRAME_TICKS)
        self._unkept = 0

    def __len__(self) -> int:
        return len(self._kept)

    def __iter__(self) -> Iterator[Keyframe]:
        return iter(self._kept)

    @property
    def first(self) -> Keyframe:
        """The state in which the run began."""
        return self._kept[0]

    def copy(self) -> "Keyframes":
        """The same ones."""
        result = copy(self)
        result._kept, result._passed = self._kept.copy(), self._passed.copy()
        return result

    def before(self, tick: int) -> Keyframe:
        """The last one at or before a tick."""
        found = self._kept[bisect.bisect_right(self._kept, tick, key=_tick) - 1]
        return max((each for each in self._passed if found.tick < each.tick <= tick), key=_tick, default=found)

    def note_tick(self, world: World, order: int) -> None:
        """Keep a tick that was reached where it is time to; order: of the next command to come."""
        self._unkept = 0
        if world.tick % self._spacing == 0 and self._kept[-1].tick < world.tick:
            if any(kept.between for kept in self._kept):
                self._set([kept for kept in self._kept if not kept.between])
            self.keep(Keyframe(order, take(world)))
        elif world.tick % self._spacing == 0 and self._lacks(world.tick):
            self.insert(Keyframe(order, take(world)))

    def _lacks(self, tick: int) -> bool:
        """Whether a tick lies in a gap that was passed over, not between two that are as near as usual."""
        place = bisect.bisect_right(self._kept, tick, key=_tick)
        return self._kept[place - 1].tick < tick and self._kept[place].tick - self._kept[place - 1].tick > self._spacing

    def insert(self, keyframe: Keyframe) -> None:
        """Keep one of a tick that was passed over."""
        place = bisect.bisect_right(self._kept, keyframe.tick, key=_tick)
        self._set([*self._kept[:place], _sharing(keyframe, self._kept[place - 1]), *self._kept[place:]])

    def keep(self, keyframe: Keyframe) -> None:
        """Keep one behind all others."""
        self._unkept = 0
        keyframe = _sharing(keyframe, self._kept[-1])
        self._size += _own_size(keyframe, self._kept[-1])
        self._kept.append(keyframe)
        while self._size > KEYFRAME_BUDGET and len(self._kept) > 2:
            self._thin()

    def note_passed(self, world: World, order: int, target: int) -> None:
        """Keep a tick shortly before the one sought for a while, as the next one sought may be among these."""
        if target - world.tick < KEYFRAME_TICKS:
            before = self._passed[-1] if self._passed else self._kept[-1]
            self._passed.append(_sharing(Keyframe(order, take(world)), before))

    def note_command(self, world: World, order: int) -> None:
        """Keep the state after a command where enough of this tick have been applied; order: of the next to come."""
        self._unkept += 1
        enough = KEYFRAME_COMMANDS + COMMANDS_PER_PARTICLE * world.particle_count
        # In the past that was sought, later ones are kept already.
        if self._unkept >= enough and self._kept[-1].order < order:
            self.keep(Keyframe(order, take(world), between=True))

    def note_return(self) -> None:
        """The world is as one of them has it."""
        self._unkept = 0

    def drop_after(self, order: int) -> None:
        """Forget the states after a command of this order or a later one."""
        self._drop([kept for kept in self._kept if kept.order <= order])

    def drop_beyond(self, tick: int) -> None:
        """Forget those of later ticks."""
        self._drop([kept for kept in self._kept if kept.tick <= tick])

    def onward(self, first: Keyframe) -> "Keyframes":
        """One of them and those that follow it."""
        result = Keyframes(first)
        result._spacing = self._spacing
        result._set([first, *(kept for kept in self._kept if kept.order >= first.order and kept.tick > first.tick)])
        return result

    def _drop(self, kept: list[Keyframe]) -> None:
        self._passed.clear()
        if len(kept) < len(self._kept):
            self._set(kept)

    def _thin(self) -> None:
        """Let every other one go; of those between the commands of one tick first."""
        first = next((place for place, kept in enumerate(self._kept) if kept.between), 1)
        if not self._kept[first].between:
            self._spacing *= 2
        self._set(self._kept[:first] + self._kept[first + 1 :: 2])

    def _set(self, kept: list[Keyframe]) -> None:
        self._kept = kept
        self._size = sum(_own_size(each, kept[place - 1] if place else None) for place, each in enumerate(kept))


def _sharing(keyframe: Keyframe, before: Keyframe) -> Keyframe:
    """A keyframe that has the arrays of the one before where they are equal."""
    present, earlier = keyframe.snapshot.arrays, before.snapshot.arrays
    arrays = {
        name: earlier[name] if array is earlier[name] or array.tobytes() == earlier[name].tobytes() else array
        for name, array in present.items()
    }
    return replace(keyframe, snapshot=replace(keyframe.snapshot, arrays=arrays))


def _own_size(keyframe: Keyframe, before: Keyframe | None) -> int:
    """What a keyframe needs [bytes] beside the one before it."""
    earlier = {} if before is None else before.snapshot.arrays
    return sum(array.nbytes for name, array in keyframe.snapshot.arrays.items() if earlier.get(name) is not array)


def _tick(keyframe: Keyframe) -> int:
    return keyframe.tick
