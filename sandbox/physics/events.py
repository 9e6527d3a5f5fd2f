"""Events of a tick, beside its state."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Containment:
    """An impossible value that was taken back: at a tick, in the array `array` of the particle, spring or constraint
    `name`.
    """

    tick: int
    array: str
    name: str
    frozen: bool

    def __str__(self) -> str:
        text = f"tick {self.tick}: {self.name}: an impossible {self.array.replace('_', ' ')} was taken back"
        return text + ("; it is frozen where it last was, unpin it to let it go" if self.frozen else "")
