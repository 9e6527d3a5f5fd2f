"""Diverges: a run on one level differs from the same on another."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import shown_particles
from sandbox.physics.snapshot import Snapshot, hash_by_array
from sandbox.physics.state import BY_STORED
from sandbox.session.commands.records import ScriptLine, to_record
from sandbox.session.replay.divergence import first_difference
from sandbox.session.session import Session
from sandbox.session.shrink.failure import Failure, FailureSeen, FailureWatch
from sandbox.session.shrink.trials import carried_out


@dataclass(frozen=True)
class Diverges(Failure):
    """A run differs from the one with the same commands on another level.

    array: the first that differs, "": any; those in which the two differ from the beginning do not count. apart: it is
    no difference of bits, but a particle is further than so [m] from where it is on the other level.
    """

    level: Level = field(repr=False)
    array: str = ""
    apart: float | None = None

    def __str__(self) -> str:
        if self.apart is not None:
            return f"a particle comes more than {self.apart:g} m away from where it is on the other level"
        return f"the runs on both levels differ, first in {self.array or 'any array'}"

    def watch(self, session: Session, kept: Any = None) -> FailureWatch:
        return _PairWatch(self, session, kept)


class _PairWatch(FailureWatch):
    def __init__(self, failure: Diverges, session: Session, kept: tuple[Snapshot, frozenset[str]] | None) -> None:
        self._failure, self._session = failure, session
        self._other = Session(failure.level, start=kept[0] if kept else None)
        # How much of the log the other has carried out.
        self._done = len(session.history.log)
        self._aside = kept[1] if kept else frozenset(self._differing())

    def _differing(self) -> list[str]:
        ours, theirs = hash_by_array(self._session.world), hash_by_array(self._other.world)
        return [name for name in BY_STORED if ours.get(name) != theirs.get(name)]

    def before(self) -> None:
        log = self._session.history.log
        for entry in log[self._done :]:
            if not entry.implied:
                record = to_record(entry.command, self._session.world)
                carried_out(self._other, ScriptLine(entry.tick, entry.gesture, record, 0))
        self._done = len(log)
        self._other.advance()
        self._other.take_messages()

    def after(self) -> FailureSeen | None:
        if self._failure.apart is not None:
            return self._far_apart(self._failure.apart)
        found = next((name for name in self._differing() if name not in self._aside), None)
        if found is None:
            return None
        self.is_over = True
        if self._failure.array not in ("", found):
            return None
        session, column = self._session, BY_STORED[found]
        told = first_difference(session.tick, found, getattr(session.world, column.name), self._other.world)
        return FailureSeen(Diverges(self._failure.level, found), f"diverged at {told}")

    def _far_apart(self, bound: float) -> FailureSeen | None:
        ours, theirs = self._session.world, self._other.world
        count = min(ours.particle_count, theirs.particle_count)
        if ours.particle_names[:count] == theirs.particle_names[:count]:
            places = np.arange(count), np.arange(count)
        else:
            both = [name for name in ours.particle_names if name in set(theirs.particle_names)]
            places = (
                np.array([ours.particle_slot(name) for name in both], dtype=np.int64),
                np.array([theirs.particle_slot(name) for name in both], dtype=np.int64),
            )
        shown = shown_particles(ours)[places[0]] & shown_particles(theirs)[places[1]]
        distance = np.sqrt(np.sum((ours.position[places[0]] - theirs.position[places[1]]) ** 2, axis=1))
        distance = np.where(shown, distance, 0.0)
        # What is not a number is as far as can be.
        if bool(np.all(distance <= bound)):
            return None
        slot = int(np.argmax(np.where(np.isnan(distance), np.inf, distance)))
        name = ours.particle_names[int(places[0][slot])]
        return FailureSeen(
            self._failure, f"tick {ours.tick}: {name} is {distance[slot]:.3g} m from where it is on the other level"
        )

    def keep(self) -> tuple[Snapshot, frozenset[str]]:
        return self._other.snapshot(), self._aside
