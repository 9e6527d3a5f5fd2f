"""Driver: a run of a level for tests in Python: it drags, cuts, drives, waits and measures."""

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox.level.document.model import Level
from sandbox.level.reading.files import load_level, parse_level
from sandbox.physics.analysis.query import load_bearing, strain
from sandbox.physics.world import HAND_STRENGTH
from sandbox.session.commands import Command, CommandError, CutSprings, Grab, MoveGrab, Release
from sandbox.session.commands.records import from_record
from sandbox.session.session import Session
from sandbox.session.summary import particle_metric

Point = tuple[float, float]


def found_level(level: "Level | dict[str, Any] | str | Path", folders: Sequence[Path]) -> Level:
    """A level that a test names: itself, its JSON object, a file as seen from one of the folders, or a shipped name.

    Raises LevelError.
    """
    if isinstance(level, Level):
        return level
    if isinstance(level, dict):
        return parse_level(json.dumps(level).encode(), "level")
    places = [folder / level for folder in folders]
    return load_level(str(next((place for place in places if place.is_file()), level)))


class Driver:
    """A run of a level, made by the fixture `sandbox_session`.

    Names are those of level files: particles `rope.end`, springs `rope:3`, driven parts by the wheel's id or `:0`.
    A name that there is not raises CommandError or KeyError. session: the run itself, for all else.
    """

    def __init__(self, level: Level) -> None:
        self.session = Session(level)
        self.level = level
        self._broken: list[str] = []

    @property
    def seconds(self) -> float:
        """Simulated time since the beginning [s]."""
        return self.session.tick / self.session.world.settings.tick_rate

    def run(self, seconds: float) -> None:
        """Let it run for some simulated time [s]."""
        for _ in range(round(seconds * self.session.world.settings.tick_rate)):
            self._advance()

    def run_until(self, condition: "Callable[[Driver], bool] | float", within: float = 10.0) -> None:
        """Run until a condition holds, at most `within` [s] longer, or until a time [s] since the beginning.

        The test fails where the condition does not come to hold.
        """
        if not callable(condition):
            self.run(condition - self.seconds)
            return
        for _ in range(round(within * self.session.world.settings.tick_rate)):
            if condition(self):
                return
            self._advance()
        if not condition(self):
            pytest.fail(f"{self.level.name}: within {within:g} s, until {self.seconds:g} s, it did not come to hold")

    def drag(
        self, particle: str, to: Point, seconds: float = 1.0, hold: bool = False, strength: float = HAND_STRENGTH
    ) -> None:
        """Take a particle with a hand and move that to a place [m] in some time [s]; hold: keep hold of it there.

        strength [m/s^2]: the hand pulls with at most this times the mass of the body, as in the command `grab`.
        """
        session = self.session
        grab, gesture = self._free_hand(), session.new_gesture()
        slot = session.world.particle_slot(particle)
        x, y = session.world.position[slot].tolist()
        self._submit(Grab(grab, slot, (x, y), strength), gesture)
        ticks = max(1, round(seconds * session.world.settings.tick_rate))
        for tick in range(1, ticks + 1):
            part = tick / ticks
            self._submit(MoveGrab(grab, (x + (to[0] - x) * part, y + (to[1] - y) * part)), gesture)
            self._advance()
        if not hold:
            self._submit(Release(grab), gesture)

    def let_go(self) -> None:
        """Let go of all that is held."""
        for grab in range(10):
            if self.session.world.is_held(grab):
                self._submit(Release(grab))

    def cut(self, *springs: str) -> None:
        """Take springs out."""
        self._submit(CutSprings(tuple(self._slot(name) for name in springs)))

    def drive(self, part: str, value: float) -> None:
        """Drive a motor or a hydraulic: 1 forward, -1 backward, 0 not at all."""
        self.do({"type": "set_drive", "part": part, "value": float(value)})

    def do(self, command: dict[str, Any]) -> None:
        """Carry out any command, as files have it, see docs/commands.md."""
        self.session.apply_pending()
        self._submit(from_record(command, self.session.world))

    def strain(self, springs: "str | Iterable[str] | None" = None) -> float:
        """The largest |l - L| / L now: of one spring, of several, of a body by its id, or of all that bear load."""
        world = self.session.world
        if springs is None:
            slots = np.flatnonzero(load_bearing(world))
        elif isinstance(springs, str) and ":" not in springs:
            slots = np.array([slot for slot, name in enumerate(world.spring_names) if name.startswith(f"{springs}:")])
            if not len(slots):
                raise KeyError(springs)
        else:
            slots = np.array([self._slot(name) for name in ([springs] if isinstance(springs, str) else springs)])
        return float(np.max(np.abs(strain(world)[slots]), initial=0.0)) if len(slots) else 0.0

    def position(self, particle: str) -> Point:
        """Where a particle is [m]."""
        x, y = self.session.world.position[self.session.world.particle_slot(particle)].tolist()
        return x, y

    def speed(self, particle: str) -> float:
        """How fast a particle is [m/s]."""
        return particle_metric(self.session.world, particle, "speed")

    def broken(self) -> list[str]:
        """The names of the springs that broke until now, in order; not of those that were cut."""
        return list(self._broken)

    def _slot(self, name: str) -> int:
        return self.session.world.spring_slot(name)

    def _free_hand(self) -> int:
        free = next((grab for grab in range(10) if not self.session.world.is_held(grab)), None)
        if free is None:
            raise CommandError("all ten hands hold something: let_go first")
        return free

    def _submit(self, command: Command, gesture: int | None = None) -> None:
        """Apply a command now. Raises CommandError where it cannot be carried out."""
        told = len(self.session.messages)
        self.session.submit(command, gesture)
        self.session.apply_pending()
        if len(self.session.messages) > told:
            raise CommandError("; ".join(self.session.messages[told:]))

    def _advance(self) -> None:
        with np.errstate(over="ignore", invalid="ignore"):
            self.session.advance()
        self._broken += [self.session.world.spring_names[slot] for slot in self.session.world.broken.tolist()]
