"""Fired: which rules of a level fired while its run was seen, for what is heard, said and shown of that."""

from collections import deque

import numpy as np

from sandbox.level.document.model import Level
from sandbox.level.rules.action import ActionDef
from sandbox.physics.world import World
from sandbox.session.outcome import outcome

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
            self._actions.extend(self._level.rules[rule].then)
        result = outcome(self._level, world)
        self.ended = self.ended or (result is not None and result.tick == world.tick)

    def take(self) -> tuple[list[ActionDef], bool]:
        """The actions of what fired since the last call, in order, and whether the run was won or lost meanwhile."""
        taken = list(self._actions), self.ended
        self._actions.clear()
        self.ended = False
        return taken
