"""HeldKeys: the keys that a check holds while its level runs, as commands that drive what the keys drive."""

from collections.abc import Sequence

from sandbox.level.checks import HoldDef
from sandbox.level.document.model import Level
from sandbox.level.plan.actuators import driving_keys
from sandbox.session.commands import SetDrive
from sandbox.session.session import Session


class HeldKeys:
    """Presses and releases keys at their ticks; of several that drive one part, the one pressed last counts."""

    def __init__(self, level: Level, holds: Sequence[HoldDef]) -> None:
        rate, keys = level.settings.tick_rate, driving_keys(level) if holds else {}
        spans = [(round(hold.during[0] * rate), round(hold.during[1] * rate), hold.key) for hold in holds]
        self._values: dict[int, dict[int, float]] = {}
        held: dict[int, float] = {}
        for tick in sorted({edge for start, end, _ in spans for edge in (start, end)}):
            pressed = sorted(
                (start, number, key) for number, (start, end, key) in enumerate(spans) if start <= tick < end
            )
            now = {part: value for _, _, key in pressed for part, value in keys[key]}
            changed = {
                part: now.get(part, 0.0) for part in {**held, **now} if held.get(part, 0.0) != now.get(part, 0.0)
            }
            self._values[tick], held = changed, now

    def press(self, session: Session) -> None:
        """Drive what is due before a session's next tick."""
        for part, value in self._values.get(session.tick, {}).items():
            session.submit(SetDrive(part, value))
