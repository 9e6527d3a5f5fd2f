"""TwinPlayback: a run that passes on what is done to it to another one, but for the settings that the two differ in."""

from collections.abc import Collection
from typing import Self

import numpy as np

from sandbox.app.run.playback import Playback
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.world import World
from sandbox.session.commands import Command, SetCoefficients, SetFirmness, SetSolver
from sandbox.session.log import Branch

# What is set on one side alone.
OWN = (SetCoefficients, SetFirmness, SetSolver)
# In the other run it counts as a gesture as well, so that undo takes the same back in both.
NOTHING = SetSolver()


class TwinPlayback(Playback):
    """A run with a twin: every command goes to both, those of OWN to one; gestures pair, and so do undo and redo."""

    twin: "TwinPlayback | None" = None

    def pair(self, other: "TwinPlayback") -> None:
        """Pass commands on to the other run from now on; the other one goes by the clock of this one, see `follow`."""
        self.twin, other.twin = other, self
        other.clock = self.clock
        self._pairs: dict[int, int] = {}
        other._pairs = {}

    def submit(self, command: Command, gesture: int | None = None) -> None:
        """Queue a command here and in the twin."""
        super().submit(command, gesture)
        twin = self.twin
        if twin is None:
            return
        if gesture is not None and gesture not in self._pairs:
            self._pairs[gesture] = twin.session.new_gesture()
        paired = None if gesture is None else self._pairs[gesture]
        Playback.submit(twin, NOTHING if isinstance(command, OWN) else command, paired)

    def follow(self, tick: int) -> None:
        """Run to a tick that the twin has got to."""
        self.apply_pending()
        session = self.session
        if tick < session.tick or session.history.keyframes.before(min(tick, session.last_tick)).tick > session.tick:
            Playback.seek(self, min(tick, session.last_tick))
        while self.session.tick < tick:
            if self.session.tick == tick - 1:
                self.previous = self.session.snapshot()
            self._tick()
            if self.session.tick == tick:
                self.current = self.session.snapshot()
        if len(self.previous.mass) != len(self.current.mass):
            self.previous = self.current
        # It says the same as its twin.
        self.session.take_messages()
        self.messages.clear()

    def return_to(self, branch: Branch) -> None:
        """Go back to where a branch begins in both."""
        place, twin = self.session.branches.index(branch), self.twin
        super().return_to(branch)
        if twin is not None and place < len(twin.session.branches):
            Playback.return_to(twin, twin.session.branches[place])

    def reset(self, kept: Collection[type[Command]] = OWN) -> Self:
        """Begin the same level again, with the settings that it has now, at the same speed."""
        return super().reset(kept)


def coefficients_of(world: World, material: int | None) -> tuple[float, float] | None:
    """Cs and Cd of a material's springs (None = all); None where there are none, or several."""
    chosen = world.material >= 0 if material is None else world.material == material
    chosen &= (world.law != LAW_HOOKE) & world.spring_active
    pairs = np.unique(np.stack([world.stiffness[chosen], world.damping[chosen]], axis=1), axis=0)
    return (float(pairs[0, 0]), float(pairs[0, 1])) if len(pairs) == 1 else None
