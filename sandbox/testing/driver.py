"""Driver: a run of a level for programs and tests in Python: it drags, cuts, drives, waits and measures."""

import json
import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import shown, suggestion
from sandbox.level.reading.files import load_level, parse_level
from sandbox.physics.analysis.query import load_bearing, strain
from sandbox.physics.world import HAND_STRENGTH
from sandbox.session.commands import Command, CommandError, CutSprings, Grab, MoveGrab, Release
from sandbox.session.commands.faults import NO_SLOT
from sandbox.session.commands.named import PARTICLES, SPRINGS, Named
from sandbox.session.session import Session
from sandbox.session.summary import particle_metric

# Frames of this file are left out of what pytest shows of a failure.
__tracebackhide__ = True

Point = tuple[float, float]
LevelLike = Level | dict[str, Any] | str | Path


class NotReached(AssertionError):
    """A condition that did not come to hold in its time."""


class SandboxSession(Protocol):
    """The type of the fixture `sandbox_session`, to annotate tests: it begins a run of a level."""

    def __call__(self, level: LevelLike) -> "Driver": ...


def found_level(level: LevelLike, folders: Sequence[Path] = ()) -> Level:
    """A level that a test names: itself, its JSON object, a file as seen from one of the folders, or a shipped name.

    A file may be named without its ending, and lie in a folder `levels` there. Raises LevelError.
    """
    if isinstance(level, Level):
        return level
    if isinstance(level, dict):
        return parse_level(json.dumps(level).encode(), "level")
    places = [folder / inside for folder in folders for inside in (level, f"{level}.json", f"levels/{level}.json")]
    return load_level(str(next((place for place in places if place.is_file()), level)))


class Driver:
    """A run of a level: a Level, its JSON object, a file, or a shipped level's name. Raises LevelError.

    Names are those of level files: particles `rope.end`, springs `rope:3`, driven parts by the wheel's id or `:0`.
    A name that there is not raises CommandError, as does a time in the past. session: the run itself, for all else.
    """

    def __init__(self, level: LevelLike) -> None:
        self.level = found_level(level)
        self.session = Session(self.level)
        self._broken: list[str] = []
        # What was measured last, by the words of it.
        self._measured: dict[str, str] = {}

    def __repr__(self) -> str:
        """The run in a line."""
        return f"<Driver of {self.level.name!r} at {self.seconds:g} s>"

    @property
    def seconds(self) -> float:
        """Simulated time since the beginning [s]."""
        return self.session.tick / self.session.world.settings.tick_rate

    def run(self, seconds: float) -> None:
        """Run for some simulated time [s]."""
        for _ in range(self._ticks(seconds)):
            self._advance()

    def run_until(self, condition: "Callable[[Driver], bool] | float", within: float = 10.0) -> None:
        """Run until a condition holds, at most `within` [s] longer, or until a time [s] since the beginning.

        Raises NotReached, with what the condition measured last, where it does not come to hold.
        """
        if not callable(condition):
            if condition < self.seconds:
                raise CommandError(f"run_until({condition:g}): it is {self.seconds:g} s already")
            self.run(condition - self.seconds)
            return
        ticks = self._ticks(within, "within")
        for left in range(ticks, -1, -1):
            self._measured.clear()
            if condition(self):
                return
            if left:
                self._advance()
        measured = "".join(f"\n  {what} = {value}" for what, value in self._measured.items())
        raise NotReached(
            f"{self.level.name}: within {within:g} s, until {self.seconds:g} s, it did not come to hold"
            + (f"; measured last:{measured}" if measured else "")
        )

    def drag(
        self, particle: str, to: Point, seconds: float = 1.0, hold: bool = False, strength: float = HAND_STRENGTH
    ) -> None:
        """Take a particle with a hand and move that to a place [m] in some time [s]; hold: keep hold of it there.

        strength [m/s^2]: the hand pulls with at most this times the mass of the body, as in the command `grab`.
        """
        session = self.session
        ticks = max(1, self._ticks(seconds))
        grab, gesture = self._free_hand(), session.new_gesture()
        slot = self._particle(particle)
        x, y = session.world.position[slot].tolist()
        self._do(Grab(grab, slot, (x, y), strength), gesture)
        for tick in range(1, ticks + 1):
            part = tick / ticks
            self._do(MoveGrab(grab, (x + (to[0] - x) * part, y + (to[1] - y) * part)), gesture)
            self._advance()
        if not hold:
            self._do(Release(grab), gesture)

    def let_go(self) -> None:
        """Release all that is held."""
        for grab in range(10):
            if self.session.world.is_held(grab):
                self._do(Release(grab))

    def cut(self, *springs: str) -> None:
        """Cut springs."""
        self._do(CutSprings(springs))

    def drive(self, part: str, value: float) -> None:
        """Drive a motor or a hydraulic: 1 forward, -1 backward, 0 not at all."""
        self.do("set_drive", part=part, value=float(value))

    def do(self, command: "Command | dict[str, Any] | str", **fields: Any) -> None:
        """Carry out any command, as Session.do takes it, see docs/commands.md."""
        self._do(command, **fields)

    def strain(self, springs: "str | Iterable[str] | None" = None) -> float:
        """The largest |l - L| / L now: of one spring, of several, of a body by its id, or of all that bear load."""
        world = self.session.world
        if springs is None:
            slots = np.flatnonzero(load_bearing(world))
        elif isinstance(springs, str) and ":" not in springs:
            slots = self._springs_of(springs)
        else:
            named = [springs] if isinstance(springs, str) else list(springs)
            slots = np.array([self._slot(SPRINGS, name) for name in named], dtype=np.int64)
        value = float(np.max(np.abs(strain(world)[slots]), initial=0.0)) if len(slots) else 0.0
        self._measured[f"strain({'' if springs is None else repr(springs)})"] = f"{value:.6g}"
        return value

    def position(self, particle: str) -> Point:
        """Where a particle is [m]."""
        x, y = self.session.world.position[self._particle(particle)].tolist()
        self._measured[f"position({particle!r})"] = f"({x:.6g}, {y:.6g}) m"
        return x, y

    def speed(self, particle: str) -> float:
        """How fast a particle is [m/s]."""
        self._particle(particle)
        value = particle_metric(self.session.world, particle, "speed")
        self._measured[f"speed({particle!r})"] = f"{value:.6g} m/s"
        return value

    def broken(self) -> list[str]:
        """The names of the springs that broke until now, in order; not of those that were cut."""
        self._measured["broken()"] = repr(self._broken)
        return list(self._broken)

    def _particle(self, name: str) -> int:
        return self._slot(PARTICLES, name)

    def _slot(self, names: Named, name: str) -> int:
        try:
            return names.slot(self.session.world, name)
        except CommandError as error:
            raise CommandError(str(error)) from None

    def _springs_of(self, body: str) -> np.ndarray:
        names = self.session.world.spring_names
        slots = [slot for slot, name in enumerate(names) if name.startswith(f"{body}:")]
        if not slots:
            bodies = {name.partition(":")[0] for name in names} - {""}
            raise CommandError(NO_SLOT.format("body with springs", shown(body)) + suggestion(body, bodies))
        return np.array(slots)

    def _ticks(self, seconds: float, what: str = "seconds") -> int:
        if not (math.isfinite(seconds) and seconds >= 0.0):
            raise CommandError(f"{what}: must be greater than or equal to 0, not {seconds:g}")
        return round(seconds * self.session.world.settings.tick_rate)

    def _free_hand(self) -> int:
        free = next((grab for grab in range(10) if not self.session.world.is_held(grab)), None)
        if free is None:
            raise CommandError("all ten hands hold something: let_go first")
        return free

    def _do(self, command: "Command | dict[str, Any] | str", gesture: int | None = None, **fields: Any) -> None:
        try:
            self.session.do(command, gesture, **fields)
        except CommandError as error:
            # Raised anew, so that a test shows its own line and not where in the library it was found.
            raise CommandError(str(error)) from None

    def _advance(self) -> None:
        with np.errstate(over="ignore", invalid="ignore"):
            self.session.advance()
        self._broken += [self.session.world.spring_names[slot] for slot in self.session.world.broken.tolist()]
