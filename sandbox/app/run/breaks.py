"""What broke in a run, in plain words: one line for all that breaks shortly after each other."""

from collections import Counter

from sandbox.app.base.sentences import sentence
from sandbox.level.document.model import Level
from sandbox.physics.world import World

# After so long [s] without a break a new line begins.
QUIET = 4.0
# Things that the line names.
NAMED = 2


class Breaks:
    """Counts what breaks in runs of a level, by the thing that it is a part of."""

    def __init__(self, level: Level) -> None:
        # What loose springs are called that have a name.
        self._called = {f":{index}": spring.name for index, spring in enumerate(level.springs) if spring.name}
        self._counts: Counter[str] = Counter()
        self._last = -1

    def note(self, world: World) -> None:
        """Take in the springs that broke in the last tick."""
        broken = world.broken.tolist()
        if not broken:
            return
        if not self._last < world.tick <= self._last + QUIET * world.settings.tick_rate:
            self._counts.clear()
        self._last = world.tick
        self._counts.update(self._thing(world, spring) for spring in broken)

    def _thing(self, world: World, spring: int) -> str:
        """The body that a spring is a part of, or its own name, or else what it is made of."""
        name = world.spring_names[spring]
        body = name.rpartition(":")[0] or self._called.get(name, "")
        if body:
            return f"the {body}"
        material = world.material_names[int(world.material[spring])]
        return "a spring" if material == "default" else f"the {material}"

    @property
    def text(self) -> str:
        """The line, "" where nothing broke."""
        things = self._counts.most_common()
        parts = [_told(name, count) for name, count in things[:NAMED]]
        others = len(things) - NAMED
        if others > 0:
            parts.append(f"{others} more {'thing' if others == 1 else 'things'} broke")
        text = "; ".join(parts)
        return sentence(text) if text else ""


def _told(name: str, count: int) -> str:
    return f"{name} broke" if count == 1 else f"{name} broke in {count:,} places"
