"""What a level lets hands do: commands that it keeps away, and budgets, which are the last rows of its counters."""

from typing import Any

from sandbox.level.document.model import Level
from sandbox.level.rules.hands import MEANINGS, UNTOUCHED, HandsDef
from sandbox.physics.world import World


def hands_of(world: World) -> HandsDef | None:
    """What hands may do in the level of a world; None: everything."""
    return world.source.hands if isinstance(world.source, Level) else None


def refusal_of(world: World, command: Any) -> str:
    """Why hands may not give a command now, in words; nothing where they may."""
    hands = hands_of(world)
    if hands is None:
        return ""
    deed = hands.budget_of(command.type)
    if deed and world.counter[hands.row(deed, len(world.counter))] < _needs(command):
        return hands.exhausted(deed)
    return hands.refusal(command.type)


def spend(world: World, command: Any) -> None:
    """Take from its budget what a command needed that was carried out."""
    hands = hands_of(world)
    deed = "" if hands is None else hands.budget_of(command.type)
    if hands is not None and deed:
        world.counter[hands.row(deed, len(world.counter))] -= _needs(command)


def _needs(command: Any) -> int:
    return len(set(command.springs)) if command.type == "cut_springs" else 1


def left_of(hands: HandsDef | None, counters: Any) -> list[tuple[int, str, int]]:
    """Of each budget the row of its counter, its name for players, and how many there are at the start."""
    if hands is None:
        return []
    return [(hands.row(deed, len(counters)), MEANINGS[deed].left, most) for deed, most in hands.budgets.items()]


def by_hand(world: World, types: list[str]) -> dict[str, Any]:
    """The same for pages: of types of commands why they are refused, and rows and words of their budgets."""
    hands = hands_of(world)
    if hands is None:
        return {"refused": {}, "budgets": {}, "bodies": None, "untouched": UNTOUCHED}
    needing = [(kind, hands.budget_of(kind)) for kind in types]
    count = len(world.counter)
    return {
        "refused": {kind: hands.refusal(kind) for kind in types if hands.refusal(kind)},
        "budgets": {kind: [hands.row(deed, count), hands.exhausted(deed)] for kind, deed in needing if deed},
        "bodies": hands.bodies,
        "untouched": UNTOUCHED,
    }
