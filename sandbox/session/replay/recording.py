"""Replay: a recorded run as a file holds it, read back."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sandbox.level.document.model import Level
from sandbox.physics.settings import WorldSettings
from sandbox.physics.snapshot import Snapshot, state_hash
from sandbox.physics.state import BY_STORED
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.world import World
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay.format import decode_state

_PLACES = {name: place for place, name in enumerate(BY_STORED)}


class ReplayError(ValueError):
    """A replay or script that cannot be used; faults: one line each."""

    def __init__(self, *faults: str) -> None:
        super().__init__("\n".join(faults))
        self.faults = list(faults)


class OtherPhysicsError(ReplayError):
    """A recording that another physics version made, which this one can only record again."""


@dataclass(frozen=True, slots=True)
class TickHashes:
    """The hashes of the state after a tick: the first digits of the whole hash, and of the hash of each array.

    arrays: in the order of the table; nothing for one that is not in use.
    """

    whole: str
    arrays: tuple[str, ...]

    def fits(self, whole: str) -> bool:
        """Whether a state of this hash is the recorded one."""
        return whole.startswith(self.whole)

    def differs(self, array: str, present: Mapping[str, str]) -> bool:
        """Whether a state of these hashes by array has another array of that name."""
        digits = self.arrays[_PLACES[array]]
        return present.get(array, "")[: len(digits) or None] != digits


@dataclass(frozen=True)
class StoredState:
    """A state line: arrays as text, see format.decode_state; joined: what joined; line: where it stands in its file."""

    arrays: dict[str, str]
    settings: WorldSettings
    joined: tuple[dict[str, Any], ...]
    line: int


@dataclass(frozen=True)
class ByHand:
    """What was written into a recorded world past its commands, after so many ticks; no run can repeat that."""

    tick: int
    what: tuple[str, ...]

    def __str__(self) -> str:
        return (
            f"at tick {self.tick} a program wrote {', '.join(self.what)} by hand, which no run repeats: "
            "do it with a command"
        )


@dataclass(frozen=True)
class Replay:
    """A recorded run: hashes[t] is the state after t ticks; end_hash is None where the file is cut off.

    physics_version, sandbox_version: of the program that recorded it. written: what was written into its world by hand.
    """

    source: str
    level: Level
    script: tuple[ScriptLine, ...]
    hashes: tuple[TickHashes, ...]
    states: dict[int, StoredState]
    end_hash: str | None
    physics_version: int = PHYSICS_VERSION
    sandbox_version: str = ""
    written: tuple[ByHand, ...] = ()

    @property
    def is_of_this_physics(self) -> bool:
        """Whether this program steps as the one that recorded it."""
        return self.physics_version == PHYSICS_VERSION

    @property
    def ticks(self) -> int:
        """Ticks recorded."""
        return len(self.hashes) - 1

    @property
    def compared(self) -> str:
        """What of a run is compared with it: every tick, or of a link, which has no hashes of ticks, its end."""
        return "every tick" if self.hashes[0].whole else "its end"

    def fits(self, world: World) -> bool:
        """Whether a run of it is as recorded, by the hashes that there are of its tick."""
        present = state_hash(world)
        ends = world.tick == self.ticks and self.end_hash is not None
        return self.hashes[world.tick].fits(present) and (not ends or present == self.end_hash)

    def state(self, tick: int) -> Snapshot:
        """The stored state of a tick. Raises ReplayError where there is none, or one that its own hash belies."""
        stored = self.states.get(tick)
        if stored is None:
            raise ReplayError(f"{self.source}: no state is stored at tick {tick}")
        try:
            snapshot = decode_state(self.level, tick, stored.arrays, stored.settings, stored.joined)
        except ValueError as error:
            raise ReplayError(f"{self.source}: line {stored.line}: {error}") from None
        driven = len(snapshot.equipment.actuators.names)
        if len(snapshot.actuator_value) != driven:
            raise ReplayError(
                f"{self.source}: line {stored.line}: state.part_value: has {len(snapshot.actuator_value)} values, "
                f"where there are {driven} driven parts"
            )
        if not self.hashes[tick].fits(state_hash(snapshot)):
            raise ReplayError(
                f"{self.source}: line {stored.line}: state: is not the one whose hash stands at tick {tick}"
            )
        return snapshot
