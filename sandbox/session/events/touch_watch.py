"""TouchWatch: watches a run tick by tick for what its commands do not tell: who touches whom, who is in which zone."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.document.model import ZoneDef
from sandbox.level.things.contacts import ContactListener
from sandbox.level.things.names import ThingNames
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.arrays import Floats

# Two things that are apart for no longer than this are still in touch [s].
APART = 0.25
# Pairs that are remembered; of more it is said how many they are.
MOST_PAIRS = 2_000


@dataclass
class Meeting:
    """How long two things were together, from the first time to the last; times: how often that began.

    is_over: whether they are apart since `last`.
    """

    first: int
    last: int
    times: int = 1
    is_over: bool = False

    def begin(self) -> None:
        """Together again."""
        self.times += 1
        self.is_over = False

    def end(self, tick: int) -> None:
        """Apart, since that tick."""
        self.last, self.is_over = tick, True


class TouchWatch:
    """Told of every tick by `watch`.

    touches: by the ids of both; insides: by the ids of a thing and a zone that all of it was in. unlisted: pairs that
    there was no more room for. Its memory grows with the pairs, not with time.
    """

    def __init__(self, zones: Iterable[ZoneDef]) -> None:
        self.touches: dict[tuple[str, str], Meeting] = {}
        self.insides: dict[tuple[str, str], Meeting] = {}
        self.unlisted = 0
        self._zones = tuple(zones)
        self._inside: set[tuple[str, str]] | None = None
        self._listener: ContactListener | None = None

    def following(self, states: Iterable[LevelWorld]) -> Iterator[LevelWorld]:
        """These states, each watched before it is passed on."""
        for world in states:
            self.watch(world)
            yield world

    def watch(self, world: LevelWorld) -> None:
        """Take in the world after a tick. Ticks come in order, none left out."""
        if self._listener is None:
            self._listener = ContactListener(round(APART * world.settings.tick_rate))
        events = self._listener.update(world)
        for contact in events.begin:
            self._begin(self.touches, contact.pair, world.tick)
        for pair in events.end:
            self._end(self.touches, pair, self._listener.last_touch(world.tick))
        if self._zones:
            self._watch_zones(world)

    def _watch_zones(self, world: LevelWorld) -> None:
        now = things_inside(world, self._zones)
        # What is there from the start has not entered.
        before = now if self._inside is None else self._inside
        for pair in sorted(now - before):
            self._begin(self.insides, pair, world.tick)
        for pair in sorted(before - now):
            self.insides.setdefault(pair, Meeting(0, 0, 0))
            self._end(self.insides, pair, world.tick)
        self._inside = now

    def _begin(self, meetings: dict[tuple[str, str], Meeting], pair: tuple[str, str], tick: int) -> None:
        known = meetings.get(pair)
        if known is not None:
            known.begin()
        elif len(meetings) < MOST_PAIRS:
            meetings[pair] = Meeting(tick, tick)
        else:
            self.unlisted += 1

    def _end(self, meetings: dict[tuple[str, str], Meeting], pair: tuple[str, str], tick: int) -> None:
        if pair in meetings:
            meetings[pair].end(tick)


def things_inside(world: LevelWorld, zones: Iterable[ZoneDef]) -> set[tuple[str, str]]:
    """Things with the zones that all their particles are in, as the metric `inside` asks."""
    things, shown = ThingNames.of(world), shown_particles(world)
    count = len(things.names)
    owner = things.of_particle[shown]
    whole, position = np.bincount(owner, minlength=count), world.position[shown]
    found = set()
    for zone in zones:
        inside = np.bincount(owner[_in_zone(zone, position)], minlength=count)
        found |= {(things.names[thing], zone.id) for thing in np.flatnonzero((inside == whole) & (whole > 0)).tolist()}
    return found


def _in_zone(zone: ZoneDef, position: Floats) -> NDArray[np.bool_]:
    """Which places (n, 2) [m] lie in a zone."""
    x, y = position[:, 0], position[:, 1]
    with np.errstate(all="ignore"):
        if zone.box is not None:
            left, bottom, right, top = zone.box
            return np.asarray((x >= left) & (x <= right) & (y >= bottom) & (y <= top))
        if zone.circle is not None:
            middle_x, middle_y, radius = zone.circle
            return np.asarray((x - middle_x) ** 2 + (y - middle_y) ** 2 <= radius**2)
        inside = np.zeros(len(x), dtype=np.bool_)
        corners = zone.polygon or ()
        for (ax, ay), (bx, by) in zip(corners, (*corners[1:], *corners[:1]), strict=True):
            if ay != by:
                inside ^= ((ay > y) != (by > y)) & (x < (bx - ax) * (y - ay) / (by - ay) + ax)
        return inside
