"""Followers: what of a run is taken in tick by tick: what broke, was stopped, fired, moved, and is near the limit."""

from collections import Counter, deque

import numpy as np
from numpy.typing import NDArray

from sandbox.app.base.sentences import sentence
from sandbox.level.document.model import Level
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.rules.rule import ActionDef
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.analysis.stability import stability_shares
from sandbox.physics.sanitise import Containment
from sandbox.physics.snapshot import Snapshot
from sandbox.physics.world import World
from sandbox.session.outcome import outcome

# After so long [s] without a break a new line begins.
QUIET = 4.0
# Things that a line names.
_NAMED = 2


class Breaks:
    """Counts what breaks in runs of a level, by the thing that it is a part of."""

    def __init__(self, level: Level) -> None:
        # What loose springs are called that have a name.
        self._called = {f":{index}": spring.name for index, spring in enumerate(level.springs) if spring.name}
        self._counts: Counter[str] = Counter()
        self._last = -1

    def note(self, world: World) -> None:
        """Take in the springs that broke in the last tick."""
        broken = world.broken.tolist()
        if not broken:
            return
        if not self._last < world.tick <= self._last + QUIET * world.settings.tick_rate:
            self._counts.clear()
        self._last = world.tick
        self._counts.update(self._thing(world, spring) for spring in broken)

    def _thing(self, world: World, spring: int) -> str:
        """The body that a spring is a part of, or its own name, or else what it is made of."""
        name = world.spring_names[spring]
        body = name.rpartition(":")[0] or self._called.get(name, "")
        if body:
            return f"the {body}"
        material = world.material_names[int(world.material[spring])]
        return "a spring" if material == "default" else f"the {material}"

    @property
    def text(self) -> str:
        """The line, "" where nothing broke."""
        things = self._counts.most_common()
        parts = [f"{name} broke" + (f" in {count:,} places" if count > 1 else "") for name, count in things[:_NAMED]]
        others = len(things) - _NAMED
        if others > 0:
            parts.append(f"{others} more {'thing' if others == 1 else 'things'} broke")
        text = "; ".join(parts)
        return sentence(text) if text else ""


class Stopped:
    """Collects the values that no physics can give, which were taken back in a run."""

    def __init__(self) -> None:
        self._hits: list[Containment] = []

    def note(self, world: World) -> None:
        """Take in the impossible values that the last tick took back."""
        # A run that went back in time has another future.
        self._hits = [hit for hit in self._hits if hit.tick < world.tick]
        self._hits += world.contained

    def details(self, tick: int) -> list[str]:
        """A line for each value that was taken back until a tick, with its tick and its slot."""
        return [str(hit) for hit in self._hits if hit.tick <= tick]

    def text(self, tick: int) -> str:
        """The events until a tick, in words for a person; "" where there are none."""
        hits = [hit for hit in self._hits if hit.tick <= tick]
        # What a particle is a part of, by its name: "right.3" is of right, "ball" is the thing itself.
        things = dict.fromkeys(f"the {hit.name.rpartition('.')[0] or hit.name}" for hit in hits if hit.frozen)
        if things:
            frozen = list(things)
            verb, them = ("was", "it") if len(frozen) == 1 else ("were", "them")
            more = f"{', '.join(frozen[:_NAMED])} and {len(frozen) - _NAMED} more"
            listed = more if len(frozen) > _NAMED else " and ".join(frozen)
            return sentence(f"{listed} went out of bounds and {verb} stopped. A click with Pin lets {them} go")
        return "A spring or a contact went out of bounds and was set back." if hits else ""


# Actions that are kept until they are taken, the newest; whoever shows a run takes them every frame.
MOST = 100


class Fired:
    """Collects the rules that fired, tick by tick; ended: whether the run was won or lost since `take` was called."""

    def __init__(self, level: Level) -> None:
        self._level = level
        self._actions: deque[ActionDef] = deque(maxlen=MOST)
        self.ended = False

    def note(self, world: World) -> None:
        """Take in the rules that fired at the end of the last tick."""
        if not self._level.rules:
            return
        fired = np.flatnonzero(world.rule_last == world.tick).tolist()
        if not fired:
            return
        for rule in fired:
            self._actions.extend(run_rules(self._level)[rule].then)
        result = outcome(self._level, world)
        self.ended = self.ended or (result is not None and result.tick == world.tick)

    def take(self) -> tuple[list[ActionDef], bool]:
        """The actions of what fired since the last call, in order, and whether the run was won or lost meanwhile."""
        taken = list(self._actions), self.ended
        self._actions.clear()
        self.ended = False
        return taken


# Faster than this [m/s] is no livelier: what flies away is not what one wants to see.
FASTEST = 20.0


class Activity:
    """The mean speed of what moves, by tick, of the ticks that were shown."""

    def __init__(self) -> None:
        self._speeds: dict[int, float] = {}

    def note(self, shown: Snapshot) -> None:
        """Look at a state that is shown; an earlier tick again replaces what was known of it."""
        if shown.tick in self._speeds:
            return
        moving = shown_particles(shown) & (shown.inverse_mass > 0.0)
        velocity = shown.velocity[moving]
        speed = np.minimum(np.sqrt(np.sum(velocity * velocity, axis=1)), FASTEST)
        self._speeds[shown.tick] = float(np.nan_to_num(speed).mean()) if len(speed) else 0.0

    def liveliest(self, first: int, last: int, ticks: int) -> int:
        """The tick from which on this many ticks within first..last move the most; those not shown count as still."""
        speeds = np.array([self._speeds.get(tick, 0.0) for tick in range(first, last + 1)])
        if len(speeds) <= ticks:
            return first
        sums = np.concatenate([[0.0], np.cumsum(speeds)])
        return first + int(np.argmax(sums[ticks:] - sums[:-ticks]))


# Ticks between two looks at what changes by itself, such as springs that break.
LOOK_EVERY = 15


class StabilityPaint:
    """Keeps the shares of a run's springs (m,), see stability_shares."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._shares: NDArray[np.float64] = np.zeros(0)

    def shares(self, world: World, revision: int = 0) -> NDArray[np.float64]:
        """The shares of its springs as they are now; revision: another number where a command may have changed them."""
        key = world, revision, world.tick // LOOK_EVERY, world.spring_count, world.settings.solver
        if key != self._key:
            self._key, self._shares = key, stability_shares(world)
        return self._shares
