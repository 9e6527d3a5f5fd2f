"""Updates: what was recorded again, told once for each cause."""

import json
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sandbox.session.replay.recording import Replay
    from sandbox.session.replay.verify import Comparison

# Recordings that are named below one cause.
MOST_NAMED = 12


@dataclass(frozen=True)
class Update:
    """A recording that was recorded again. cause: lines; effect: a line; farthest [m]: how far its runs are apart."""

    name: str
    cause: list[str]
    effect: str
    farthest: float = 0.0
    checks: list[str] = field(default_factory=list)

    def to_text(self) -> str:
        """It as a line of JSON, which processes hand on."""
        return json.dumps(asdict(self))


def update_of(name: str, recorded: "Replay", moved: list[str], found: "Comparison | None") -> Update:
    """What to tell of a recording that was recorded again."""
    old = [] if recorded.is_of_this_physics else [f"recorded with physics version {recorded.physics_version}"]
    cause = [*old, *moved]
    if found is None:
        return Update(name, cause, "equal in every bit")
    if found.edits:
        cause += found.edits
    elif recorded.is_of_this_physics:
        cause.append(str(found.by_hand) if found.by_hand else f"this build steps differently: {found.divergence.array}")
    if found.apart is None:
        return Update(name, cause, str(found.divergence))
    return Update(name, cause, str(found.apart), found.apart.farthest, list(found.apart.lines))


def grouped(texts: Iterable[str]) -> list[str]:
    """The lines of all updates, given as JSON: each cause once, with the largest effect, and the recordings."""
    groups: dict[tuple[str, ...], list[Update]] = defaultdict(list)
    for text in texts:
        update = Update(**json.loads(text))
        groups[tuple(update.cause)].append(update)
    lines = []
    for cause, updates in groups.items():
        most = max(updates, key=lambda each: each.farthest)
        names = sorted(each.name for each in updates)
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        of = f" ({most.name})" if len(names) > 1 and most.farthest else ""
        lines += [
            *cause,
            f"  {most.effect}{of}",
            *(f"  {line}{of}" for line in most.checks),
            f"  {len(names)} recording{'s' if len(names) > 1 else ''}: {', '.join(names[:MOST_NAMED])}{more}",
        ]
    return lines
