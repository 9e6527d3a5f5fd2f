"""What rules do: their actions, carried out before the tick after the one in which they fired.

They are no commands of a person: no history or recording holds them, as they follow from the state.
"""

from contextlib import suppress
from typing import Any, assert_never

import numpy as np

from sandbox.level.assembly.build_world import LevelWorld
from sandbox.level.document.model import Level
from sandbox.level.plan.run_rules import run_rules
from sandbox.level.rules.rule import ActionDef
from sandbox.physics.commands.command import RULE
from sandbox.physics.keeping.equipment import Firmness
from sandbox.physics.softness.firmness import softening
from sandbox.session.commands.command import CommandError, act
from sandbox.session.commands.records import from_record
from sandbox.session.outcome import stars_of


class RuleActions:
    """The actions of a level's rules."""

    def __init__(self, level: Level, world: LevelWorld) -> None:
        """world: that of the level, at its start."""
        self._level = level
        self._counters = level.counter_names

    def act(self, world: LevelWorld) -> None:
        """Do what is due: rule by rule in the order of the file, of each its actions in order.

        One that cannot be done, as what it names is gone, does nothing.
        """
        for rule in np.flatnonzero(world.rule_due).tolist():
            world.rule_due[rule] = False
            for action in run_rules(self._level)[rule].then:
                if action.win is not None and not world.rule_stars[rule]:
                    world.rule_stars[rule] = stars_of(action.stars, self._level, world, int(world.rule_first[rule]))
                if action.count is not None:
                    world.counter[self._counters.index(action.count)] += action.by
                    continue
                if action.sag is not None:
                    world.command("soften", RULE, **softening_of(action, self._level, world))
                    continue
                record = record_of(action, world, self._level.settings.tick_rate)
                with suppress(CommandError):
                    if record is not None:
                        act(world, from_record(record, world))


def softening_of(action: ActionDef, level: Level, world: LevelWorld) -> dict[str, Any]:
    """The arguments of `soften` for an action: all of a body sags as its definition says, under the gravity of
    the level.
    """
    body = next(place for place, form in enumerate(world.forms) if form.name == action.body)
    during = round(action.during * level.settings.tick_rate)
    asked = softening(world, body, Firmness(sag=action.sag), level.settings.gravity)
    return asked | {"duration": during}


def record_of(action: ActionDef, world: LevelWorld, rate: int) -> dict[str, Any] | None:
    """The command of an action as recordings have it; None where it is none, or where all it names is gone.

    rate: ticks in a second.
    """
    (does,) = action.done
    value, during = getattr(action, does), round(action.during * rate)
    match does:
        case "cut":
            names = [name for name in world.spring_names if name == value or name.startswith(f"{value}:")]
            springs = [name for name in names if world.spring_active[world.spring_slot(name)]]
            return {"type": "cut_springs", "springs": springs} if springs else None
        case "pin" | "unpin":
            return {"type": does, "particle": value}
        case "drive":
            return {"type": "set_drive", "part": value, "value": action.value}
        case "gravity":
            return {"type": "set_gravity", "gravity": list(value), "duration": during}
        case "wind":
            return {"type": "set_air", "wind": list(value), "duration": during}
        case "win" | "fail" | "say" | "sound" | "count" | "checkpoint" | "sag":
            return None
        case _:
            assert_never(does)
