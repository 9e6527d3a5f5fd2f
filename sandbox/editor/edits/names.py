"""Names: free ids, and references to particles wherever a level holds them."""

import re
from collections.abc import Callable, Iterable

from sandbox.editor.edits.rule_names import with_springs_followed, with_things_followed
from sandbox.level.document.model import Level
from sandbox.level.format.limits import TEXT_LIMIT
from sandbox.level.format.quantities import replaced

# What a number at the end of an id looks like; a copy of "rope 2" is "rope 3".
_NUMBERED = re.compile(r"(.*\S) ([1-9][0-9]{0,8})")

# What becomes of a reference: another one, or None where what hangs on it goes.
Rewire = Callable[[str], str | None]


def taken_ids(level: Level) -> set[str]:
    """Ids of a level's bodies, loose particles, terrain and zones."""
    return {part.id for parts in (level.bodies, level.particles, level.terrain, level.zones) for part in parts}


def free_id(level: Level, base: str) -> str:
    """The id itself where it is free, else with the lowest free number from 2: "rope 2"."""
    return free_ids(taken_ids(level), [base])[0]


def free_ids(taken: set[str], wanted: Iterable[str]) -> list[str]:
    """A free id for each of those that are wanted, different from each other; `taken` grows by them."""
    numbers: dict[str, int] = {}
    found = []
    for name in wanted:
        if name in taken:
            match = _NUMBERED.fullmatch(name)
            base = match[1] if match else name
            number = numbers.get(base, 2)
            while (name := f"{base[: TEXT_LIMIT - 11]} {number}") in taken:
                number += 1
            numbers[base] = number + 1
        taken.add(name)
        found.append(name)
    return found


def owner_of(reference: str) -> str:
    """Id of what a reference speaks of: of a particle its body."""
    return reference.partition(".")[0]


def with_owner(reference: str, owner: str) -> str:
    """The reference as one to the same particle of another body, or to another loose particle."""
    _, dot, part = reference.partition(".")
    return owner + dot + part


def renamed(ids: dict[str, str]) -> Rewire:
    """References to bodies, loose particles, terrain and zones by their new ids."""
    return lambda reference: with_owner(reference, ids.get(owner_of(reference), owner_of(reference)))


def rewired(level: Level, change: Rewire) -> tuple[Level, list[int]]:
    """Change every reference of springs, welds, checks, rules and the camera; what refers to what is gone goes too.

    Also the old indices of the springs that stay.
    """
    springs, kept = [], []
    for index, spring in enumerate(level.springs):
        a, b = change(spring.a), change(spring.b)
        if a is not None and b is not None:
            springs.append(spring if (a, b) == (spring.a, spring.b) else replaced(spring, a=a, b=b))
            kept.append(index)
    welds = []
    for first, second in level.welds:
        a, b = change(first), change(second)
        if a is not None and b is not None:
            welds.append((a, b))
    checks = []
    for check in level.checks:
        old = {field: name for field in ("particle", "other", "body") if (name := getattr(check, field)) is not None}
        new = {field: change(name) for field, name in old.items()}
        if new == old:
            checks.append(check)
        elif None not in new.values():
            checks.append(replaced(check, **new))
    level = replaced(level, springs=tuple(springs), welds=tuple(welds), checks=tuple(checks))
    level = with_things_followed(with_springs_followed(level, level.rules, kept), change)
    return _with_companion(level, change), kept


def _with_companion(level: Level, change: Rewire) -> Level:
    """The level with what its camera goes along with: of a body that is gone its first particle, or nothing."""
    look = level.look
    if look is None or look.follow is None:
        return level
    there = {part.id for parts in (level.bodies, level.particles) for part in parts}
    wanted = next((name for name in (change(look.follow), change(f"{look.follow}.0")) if name in there), None)
    return level if wanted == look.follow else replaced(level, look=replaced(look, follow=wanted))
