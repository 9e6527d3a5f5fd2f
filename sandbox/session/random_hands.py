"""Random hands: they drag, push, pin, cut and drive in a running level, the same for the same seed."""

import random
from typing import Any

import numpy as np

from sandbox.physics.analysis.query import shown_particles, shown_springs
from sandbox.session.commands import CommandError
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session

# Gestures begin so often [1/s]; a drag lasts from the first to the second of these times [s], and moves so often [1/s].
GESTURES_A_SECOND, DRAG_SECONDS, MOVES_A_SECOND = 1.5, (0.3, 1.5), 20.0
# How far a hand goes, as a part of the level's size; and how hard things are pushed [m/s].
REACH, PUSH = 0.25, 2.0


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
        """Do what comes to mind before the next tick."""
        if self._held is not None:
            self._move()
        elif self._chance.random() < self._first:
            self._chance.choice(self._acts)()

    def _do(self, record: dict[str, Any], gesture: int) -> bool:
        session, told = self._session, len(self._session.refusals)
        try:
            command = from_record(record, session.world)
        except CommandError:
            return False
        session.submit(command, gesture)
        session.apply_pending()
        return len(session.refusals) == told

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
        if self._do(record, gesture):
            ticks = max(1, round(self._chance.uniform(*DRAG_SECONDS) * self._rate))
            reach = np.array([self._chance.uniform(-1.0, 1.0), self._chance.uniform(-1.0, 1.0)]) * REACH * self._size
            self._held = gesture, place, reach / ticks, self._session.tick + ticks

    def _move(self) -> None:
        assert self._held is not None
        gesture, place, step, end = self._held
        tick = self._session.tick
        place += step
        if tick >= end:
            self._do({"type": "release", "grab": 0}, gesture)
            self._held = None
        elif tick % max(1, round(self._rate / MOVES_A_SECOND)) == 0:
            self._do({"type": "move_grab", "grab": 0, "target": place.tolist()}, gesture)

    def _push(self) -> None:
        slot, world = self._particle(), self._session.world
        if slot is None:
            return
        speed = [self._chance.uniform(-PUSH, PUSH), self._chance.uniform(-PUSH, PUSH)]
        impulse = [float(world.mass[slot]) * each for each in speed]
        record = {"type": "push", "position": world.position[slot].tolist(), "radius": 0.1 * self._size}
        self._do(record | {"impulse": impulse}, self._session.new_gesture())

    def _drive(self) -> None:
        names = self._session.world.actuators.names
        if names:
            record = {"type": "set_drive", "part": self._chance.choice(list(names))}
            self._do(record | {"value": self._chance.choice([-1.0, 0.0, 0.5, 1.0])}, self._session.new_gesture())

    def _pin(self) -> None:
        """Pin a free particle, or let go of one that was pinned like this."""
        world, gesture = self._session.world, self._session.new_gesture()
        if self._pinned:
            self._do({"type": "unpin", "particle": world.particle_names[self._pinned.pop()]}, gesture)
            return
        slot = self._particle()
        if slot is not None and self._do({"type": "pin", "particle": world.particle_names[slot]}, gesture):
            self._pinned.append(slot)

    def _cut(self) -> None:
        world = self._session.world
        slots = np.flatnonzero(shown_springs(world)).tolist()
        # The last ones stay, so that there is something to drag.
        if len(slots) > 10 and self._chance.random() < 0.3:
            record = {"type": "cut_springs", "springs": [world.spring_names[self._chance.choice(slots)]]}
            self._do(record, self._session.new_gesture())
