"""What went out of bounds in a run and was stopped: in plain words, and with ticks and slots for who asks."""

from sandbox.app.base.sentences import sentence
from sandbox.physics.sanitise import Containment
from sandbox.physics.world import World

# Things that the line names.
NAMED = 2


class Stopped:
    """Collects the values that no physics can give, which were taken back in a run."""

    def __init__(self) -> None:
        self._hits: list[Containment] = []

    def note(self, world: World) -> None:
        """Take in what the last tick took back."""
        # A run that went back in time has another future.
        self._hits = [hit for hit in self._hits if hit.tick < world.tick]
        self._hits += world.contained

    def details(self, tick: int) -> list[str]:
        """A line for each value that was taken back until a tick, with its tick and its slot."""
        return [str(hit) for hit in self._hits if hit.tick <= tick]

    def text(self, tick: int) -> str:
        """What happened until a tick, for a person; "" where nothing did."""
        hits = [hit for hit in self._hits if hit.tick <= tick]
        frozen = list(dict.fromkeys(_thing(hit.name) for hit in hits if hit.frozen))
        if frozen:
            verb, them = ("was", "it") if len(frozen) == 1 else ("were", "them")
            return sentence(f"{_listed(frozen)} went out of bounds and {verb} stopped. A click with Pin lets {them} go")
        return "A spring or a contact went out of bounds and was set back." if hits else ""


def _thing(name: str) -> str:
    """What a particle is a part of, by its name: "right.3" is of right, "ball" is the thing itself."""
    return f"the {name.rpartition('.')[0] or name}"


def _listed(names: list[str]) -> str:
    """Names in a sentence, the first ones and how many more."""
    if len(names) > NAMED:
        return f"{', '.join(names[:NAMED])} and {len(names) - NAMED} more"
    return " and ".join(names)
