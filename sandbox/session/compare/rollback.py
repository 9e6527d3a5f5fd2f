"""Rollback: at every tick a run goes back some ticks, by a snapshot, and comes to the same bits once more.

A state that no snapshot holds shows here: what it does is not undone with the rest. Levels are played by random hands.
"""

import random
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sandbox.level.document.model import Level
from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.physics.snapshot import Snapshot
from sandbox.session.commands import Redo, Undo
from sandbox.session.compare.distance import Progress
from sandbox.session.compare.divergence import Divergence, first_divergence
from sandbox.session.replay.recording import Replay, ReplayError, faults_of
from sandbox.session.session import Session

# How long random hands play a level [s].
HANDS_SECONDS = 10.0
# Gestures begin so often [1/s]; a drag lasts from the first to the second of these times [s], and moves so often [1/s].
GESTURES_A_SECOND, DRAG_SECONDS, MOVES_A_SECOND = 1.5, (0.3, 1.5), 20.0
# How far a hand goes, as a part of the level's size; and how hard things are pushed [m/s].
REACH, PUSH = 0.25, 2.0


@dataclass(frozen=True)
class RolledBack:
    """The result of going back. back, ticks: how far, and how often; commands: how many were carried out.

    found: the first difference, None: there is none.
    """

    back: int
    ticks: int
    commands: int
    found: Divergence | None

    def __str__(self) -> str:
        if self.found is not None:
            return f"DIVERGES at {self.found}"
        return f"equal again from {self.back} ticks before each of {self.ticks:,}, with {self.commands} commands"


def roll_back(replay: Replay, back: int, level: Level | None = None, progress: Progress | None = None) -> RolledBack:
    """Run a recording's commands, on its level or on another, and go back at every tick. Raises ReplayError."""
    if back > replay.ticks:
        raise ReplayError(f"{replay.source}: a run of {replay.ticks} ticks does not go back {back} ticks")
    with faults_of(replay):
        return _rolled_back(Session(replay.on(level), script=replay.script), replay.ticks, back, lambda: None, progress)


def roll_back_level(level: Level, back: int, seed: int = 0, progress: Progress | None = None) -> RolledBack:
    """Play a level with random hands for 10 s, and go back at every tick."""
    session = Session(level)
    ticks = round(HANDS_SECONDS * level.settings.tick_rate)
    return _rolled_back(session, ticks, back, RandomHands(session, seed).act, progress)


def _rolled_back(
    session: Session, ticks: int, back: int, act: Callable[[], object], progress: Progress | None
) -> RolledBack:
    """After each tick, go back as far as states are kept, come there again, and compare."""
    history, world = session.history, session.world
    # A state for each of the last ticks, the present one last.
    states: deque[Snapshot] = deque([session.snapshot()], maxlen=back + 1)
    found = None
    with np.errstate(over="ignore", invalid="ignore"):
        while session.tick < ticks and found is None:
            seen = len(history.log)
            act()
            session.advance()
            present = session.snapshot()
            # An undo or redo has made another past: states before it are forgotten.
            is_other_past = any(isinstance(entry.command, (Undo, Redo)) for entry in history.log[seen:])
            if is_other_past:
                states.clear()
            states.append(present)
            if not is_other_past:
                session.step_again(states[0])
                differing = first_divergence(present, world)
                found = differing and replace(differing, note=f"stepped again from tick {states[0].tick}")
            if progress is not None:
                progress(session.tick, ticks)
    return RolledBack(back, session.tick, len(history.log), found)


class RandomHands:
    """Gives a session gestures at random; call `act` before every tick. What the session refuses is left out."""

    def __init__(self, session: Session, seed: int) -> None:
        self._session = session
        self._chance = random.Random(f"hands {seed}")
        rate = session.world.settings.tick_rate
        self._rate = rate
        self._first = GESTURES_A_SECOND / rate
        position = session.world.position[shown_particles(session.world)]
        self._size = float(np.max(np.ptp(position, axis=0), initial=0.5)) if len(position) else 1.0
        # The hand that holds something: its gesture, where it goes [m] in a tick, and when it lets go.
        self._held: tuple[int, np.ndarray[Any, Any], np.ndarray[Any, Any], int] | None = None
        self._pinned: list[int] = []
        self._acts = (self._grab, self._grab, self._grab, self._push, self._drive, self._pin, self._cut)

    def act(self) -> None:
        """Submit some random commands before the next tick."""
        if self._held is not None:
            self._move()
        elif self._chance.random() < self._first:
            self._chance.choice(self._acts)()

    def _particle(self) -> int | None:
        world = self._session.world
        slots = np.flatnonzero(shown_particles(world) & (world.inverse_mass > 0.0)).tolist()
        return self._chance.choice(slots) if slots else None

    def _grab(self) -> None:
        slot, world = self._particle(), self._session.world
        if slot is None:
            return
        gesture, place = self._session.new_gesture(), world.position[slot].copy()
        record = {"type": "grab", "grab": 0, "particle": world.particle_names[slot], "target": place.tolist()}
        record["strength"] = self._chance.uniform(20.0, 300.0)
        if self._session.attempt(record, gesture):
            ticks = max(1, round(self._chance.uniform(*DRAG_SECONDS) * self._rate))
            reach = np.array([self._chance.uniform(-1.0, 1.0), self._chance.uniform(-1.0, 1.0)]) * REACH * self._size
            self._held = gesture, place, reach / ticks, self._session.tick + ticks

    def _move(self) -> None:
        assert self._held is not None
        gesture, place, step, end = self._held
        tick = self._session.tick
        place += step
        if tick >= end:
            self._session.attempt({"type": "release", "grab": 0}, gesture)
            self._held = None
        elif tick % max(1, round(self._rate / MOVES_A_SECOND)) == 0:
            self._session.attempt({"type": "move_grab", "grab": 0, "target": place.tolist()}, gesture)

    def _push(self) -> None:
        slot, world = self._particle(), self._session.world
        if slot is None:
            return
        speed = [self._chance.uniform(-PUSH, PUSH), self._chance.uniform(-PUSH, PUSH)]
        impulse = [float(world.mass[slot]) * each for each in speed]
        record = {"type": "push", "position": world.position[slot].tolist(), "radius": 0.1 * self._size}
        self._session.attempt(record | {"impulse": impulse}, self._session.new_gesture())

    def _drive(self) -> None:
        names = self._session.world.actuators.names
        if names:
            record: dict[str, Any] = {"type": "set_drive", "part": self._chance.choice(list(names))}
            self._session.attempt(
                record | {"value": self._chance.choice([-1.0, 0.0, 0.5, 1.0])}, self._session.new_gesture()
            )

    def _pin(self) -> None:
        """Pin a free particle, or let go of one that was pinned like this."""
        world, gesture = self._session.world, self._session.new_gesture()
        if self._pinned:
            self._session.attempt({"type": "unpin", "particle": world.particle_names[self._pinned.pop()]}, gesture)
            return
        slot = self._particle()
        if slot is not None and self._session.attempt({"type": "pin", "particle": world.particle_names[slot]}, gesture):
            self._pinned.append(slot)

    def _cut(self) -> None:
        world = self._session.world
        slots = np.flatnonzero(shown_springs(world)).tolist()
        # The last ones stay, so that there is something to drag.
        if len(slots) > 10 and self._chance.random() < 0.3:
            record = {"type": "cut_springs", "springs": [world.spring_names[self._chance.choice(slots)]]}
            self._session.attempt(record, self._session.new_gesture())
