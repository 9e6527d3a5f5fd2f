"""Snapshot: a read-only copy of every bit of a world's state; hashes of that state."""

import functools
import hashlib
import itertools
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import Field, dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.physics.keeping.equipment import Equipment
from sandbox.physics.settings import WorldSettings
from sandbox.physics.state import COLUMNS, MOVING, TOPOLOGY, Column, StateArrays
from sandbox.physics.terrain import Terrain
from sandbox.physics.world import World


@dataclass(frozen=True, eq=False, repr=False)
class Snapshot(StateArrays):
    """A read-only copy of a world's state: its arrays (see StateArrays), settings and tick; its equipment and terrain.

    arrays: by attribute; each is an attribute of the snapshot too.
    """

    arrays: Mapping[str, NDArray[Any]]
    settings: WorldSettings
    tick: int
    grab_particle: int
    grab_spring: int
    terrain: Terrain
    equipment: Equipment

    def __post_init__(self) -> None:
        self.__dict__.update(self.arrays)


def _copied(world: World, columns: Iterable[Column]) -> dict[str, NDArray[Any]]:
    copies = {column.name: getattr(world, column.name).copy() for column in columns}
    for copy in copies.values():
        copy.flags.writeable = False
    return copies


def _topology(world: World) -> dict[str, NDArray[Any]]:
    """Copies of the arrays of topology, shared by all snapshots until that changes."""
    return _copied(world, TOPOLOGY)


def take(world: World) -> Snapshot:
    """Copy a world's state."""
    return Snapshot(
        {**world.derived(_topology), **_copied(world, MOVING)}, settings=world.settings, tick=world.tick,
        grab_particle=world.grab_particle, grab_spring=world.grab_spring, terrain=world.terrain,
        equipment=world.equipment,
    )  # fmt: skip


def restore(world: World, snapshot: Snapshot) -> None:
    """Bring a world back to a snapshot of itself, slots added since then included."""
    # Names of slots that the snapshot does not have, or has for something else that joined, go.
    particles, springs = len(snapshot.mass), len(snapshot.rest_length)
    for present, kept in itertools.zip_longest(world.joined, snapshot.equipment.joined):
        if present is not kept:
            for joined in filter(None, (present, kept)):
                particles, springs = min(particles, joined.first_particle), min(springs, joined.first_spring)
            break
    world.forget_names_beyond(particles, springs)
    world.equipment = snapshot.equipment
    # Before the arrays: another solver begins some of them anew.
    world.settings = snapshot.settings
    copied = world.derived(_topology)
    for column in COLUMNS:
        present, kept = getattr(world, column.name), snapshot.arrays[column.name]
        if copied.get(column.name) is kept:
            continue
        if len(present) != len(kept):
            setattr(world, column.name, kept.copy())
        elif not (column.topology and np.array_equal(present, kept)):
            present[:] = kept
            world.topology_version += column.topology
    world.tick = snapshot.tick
    world.grab_particle = snapshot.grab_particle
    world.grab_spring = snapshot.grab_spring
    world.may_fly = True
    world.trust()


def canonical_bytes(array: NDArray[Any]) -> bytes:
    """The bytes that are hashed and stored: little-endian, -0.0 as 0.0 and every NaN as the same NaN."""
    if array.dtype.kind == "f":
        array = array + 0.0
        array[np.isnan(array)] = np.nan
    if sys.byteorder != "little":
        array = array.astype(array.dtype.newbyteorder("<"), copy=False)
    return array.tobytes()


# Arrays larger than so much [bytes] are hashed each time rather than kept.
_LARGEST_KEPT = 1_000_000
_NOTHING: tuple[bytes | None, str | None] = (None, None)
_COLUMNS = tuple((column.name, column.stored, column) for column in COLUMNS)


def array_hash(column: Column, array: NDArray[Any]) -> str | None:
    """Hash of an array; None: it has its usual values and is left out."""
    content = canonical_bytes(array)
    if column.sparse and content == _usual_bytes(column, len(array)):
        return None
    return hashlib.blake2b(content, digest_size=8).hexdigest()


@functools.lru_cache(maxsize=512)
def _usual_bytes(column: Column, count: int) -> bytes:
    return canonical_bytes(column.usual_rows(count))


def _hashed(_: World) -> dict[str, tuple[bytes, str | None]]:
    """Bytes and hash of each array of a world that was hashed last, by its name in files."""
    return {}


def hash_by_array(world: World | Snapshot) -> dict[str, str]:
    """blake2b of each state array in use, 16 hexadecimal digits, by its name in files.

    Of a world, what was hashed last is kept: most arrays are those of the tick before.
    """
    arrays, hashes = vars(world), {}
    kept = world.derived(_hashed) if isinstance(world, World) else {}
    for name, stored, column in _COLUMNS:
        array = arrays[name]
        present = array.tobytes()
        last, digest = kept.get(stored, _NOTHING)
        if present != last:
            digest = array_hash(column, array)
            if len(present) <= _LARGEST_KEPT:
                kept[stored] = present, digest
        if digest is not None:
            hashes[stored] = digest
    return hashes


def state_hash(world: World | Snapshot, arrays: Mapping[str, str] | None = None) -> str:
    """blake2b over the hashes of every array in use, the tick and the settings, in fixed order: 32 digits.

    arrays: the result of `hash_by_array` for this state, where the caller has it already.
    """
    by_array = hash_by_array(world) if arrays is None else arrays
    text = "\n".join([*by_array.values(), str(world.tick), *_settings_text(world.settings)])
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


@dataclass(frozen=True, slots=True)
class Left:
    """A world's state as it was left: bytes of its arrays, as far as they are kept, their hashes, and the settings."""

    kept: dict[str, tuple[bytes, str | None]]
    hashes: Mapping[str, str]
    settings: WorldSettings

    def written(self, world: World) -> list[str]:
        """The arrays, by their names in files, and `settings`, that have changed in a world since."""
        arrays, kept, found = vars(world), self.kept, []
        for name, stored, column in _COLUMNS:
            if arrays[name].tobytes() == kept.get(stored, _NOTHING)[0]:
                continue
            if array_hash(column, arrays[name]) != self.hashes.get(stored):
                found.append(stored)
        return found if world.settings == self.settings else [*found, "settings"]


def leave(world: World, hashes: Mapping[str, str]) -> Left:
    """Note a world that was hashed just now, to tell later which arrays were written."""
    return Left(world.derived(_hashed).copy(), hashes, world.settings)


# Settings, which nobody writes to, that were hashed last, and their texts.
_LAST_SETTINGS: list[tuple[WorldSettings, tuple[str, ...]]] = []


def _settings_text(settings: WorldSettings) -> tuple[str, ...]:
    for last, texts in _LAST_SETTINGS:
        if last is settings:
            return texts
    texts = tuple(text for setting in fields(settings) for text in _canonical(setting, settings))
    _LAST_SETTINGS[:] = [(settings, texts)]
    return texts


def _canonical(setting: Field[Any], settings: WorldSettings) -> Iterator[str]:
    """A setting as the texts that are hashed: by its type, so that 1 and 1.0 are the same number."""
    value = getattr(settings, setting.name)
    if setting.type in (float, tuple[float, float]):
        for number in value if isinstance(value, tuple) else (value,):
            yield (number + 0.0).hex()
    else:
        yield str(value)
