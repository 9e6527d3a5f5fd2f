"""The replay file, version 2: JSON Lines, each line sealed by a chain of hashes over everything before it.

    {"format": "spring-sandbox/replay", "version": 2, "physics_version": ..., "level": {...}, ..., "chain": "..."}
    {"tick": 12, "gesture": 3, "command": {...}, "chain": "..."}       applied at tick 12, before its step
    {"tick": 13, "hash": "...", "arrays": {...}, "chain": "..."}       the state after 13 steps, for every tick from 0
    {"tick": 600, "state": {...}, "settings": {...}, "chain": "..."}   every bit of it, now and then and at the end;
                                                                       also "joined", where bodies joined while it ran
    {"end": true, "tick": 900, "hash": "...", "chain": "..."}

The first line names the level's file in "level_file", where it was read from one, and in "run_with" the settings that
are not as in that file, but as whoever ran it chose. {"tick": 20, "written": [...]} names what a program wrote into the
world by hand.

`hash` is of the whole state, `arrays` has a hash for each array; lines hold their first digits, but `hash` is whole at
a stored state and at the end. `arrays` names the arrays that changed since the line before, with null for one that is
no longer in use; at a stored state it names all that are in use. `state` holds the arrays that changed since the last
stored state. chain = the first digits of blake2b over the whole digest of the previous line and this line's bytes
before its own chain.

Version 1, which is read as well: all arrays in every line, and all digits.
"""

import base64
import binascii
import hashlib
import json
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.level.assembly.build_world import LevelWorld, build_world
from sandbox.level.assembly.joining import join_definition
from sandbox.level.document.model import Level
from sandbox.level.format.limits import PARTICLE_LIMIT, SPRING_LIMIT
from sandbox.level.reading.files import file_of, level_data, run_with
from sandbox.physics.keeping.arguments import check_corners, check_whole_numbers, room_of
from sandbox.physics.keeping.equipment import Equipment
from sandbox.physics.keeping.growing import grow
from sandbox.physics.marks import GRAB_COUNT, GRAB_MATERIAL
from sandbox.physics.settings import NUMBER_COUNT
from sandbox.physics.snapshot import Snapshot, canonical_bytes
from sandbox.physics.state import ALWAYS_STORED, BY_STORED, COLUMNS, FAMILIES, OF_RULES, Column, Family
from sandbox.physics.step import PHYSICS_VERSION
from sandbox.physics.terrain import NO_TERRAIN
from sandbox.physics.world import World, WorldSettings
from sandbox.session.replay import FORMAT
from sandbox.version import __version__

VERSION = 2
# Hexadecimal digits of a line's chain, by version; of hashes a reader compares as many as there are. That anything
# differs is said by the hash of the whole state, those of arrays only say which.
CHAIN_DIGITS = {1: 32, VERSION: 8}
TICK_DIGITS = 16
ARRAY_DIGITS = 6
# Ticks between two stored states, unless a writer is told otherwise.
STATE_TICKS = 600
# What the arrays of a state may hold together [bytes]: the largest world has 77 MB.
STATE_LIMIT = 128 * 2**20
# The most rows that arrays of a state can have: a world holds no more.
MOST_ROWS = {
    Family.PARTICLE: PARTICLE_LIMIT + GRAB_COUNT,
    Family.SPRING: SPRING_LIMIT + GRAB_COUNT,
    Family.CONSTRAINT: SPRING_LIMIT,
    Family.CORNER: 3 * SPRING_LIMIT,
    Family.CONTACT: 3 * SPRING_LIMIT,
    Family.HAND: GRAB_COUNT,
}

_CHAIN_MARK = b', "chain": "'
_DIGEST_BYTES = 16


def seal(values: dict[str, Any], previous: str, version: int = VERSION) -> tuple[bytes, str]:
    """A line's bytes, newline included, and its digest: the `previous` of the next line, "" of the first."""
    body = json.dumps(values, allow_nan=False, ensure_ascii=True)[:-1].encode()
    digest = _digest(body, previous)
    return body + _ending(digest, version), digest


def unseal(line: bytes, previous: str, version: int = VERSION) -> str | None:
    """The digest of a line, or None where a byte of it, or of anything before it, has changed."""
    body, mark, tail = line.rpartition(_CHAIN_MARK)
    digest = _digest(body, previous)
    return digest if mark + tail == _ending(digest, version) else None


def _digest(body: bytes, previous: str) -> str:
    return hashlib.blake2b(previous.encode() + body, digest_size=_DIGEST_BYTES).hexdigest()


def _ending(digest: str, version: int) -> bytes:
    return _CHAIN_MARK + digest[: CHAIN_DIGITS[version]].encode() + b'"}\n'


def level_digest(data: dict[str, Any]) -> str:
    """sha256 of a level's JSON, keys sorted, without white space."""
    return hashlib.sha256(json.dumps(data, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def header(level: Level) -> dict[str, Any]:
    """The first line's values."""
    data = level_data(level)
    return {
        "format": FORMAT,
        "version": VERSION,
        "physics_version": PHYSICS_VERSION,
        "sandbox_version": __version__,
        "level_sha256": level_digest(data),
        **({"level_file": file_of(level)} if file_of(level) else {}),
        **({"run_with": run_with(level)} if run_with(level) else {}),
        "level": data,
    }


def encode_state(state: World | Snapshot, names: Iterable[str] = tuple(BY_STORED)) -> dict[str, Any]:
    """State arrays of those names as base64 of zlib of their little-endian bytes, and the settings."""
    arrays = {
        name: base64.b64encode(zlib.compress(canonical_bytes(getattr(state, BY_STORED[name].name)), 6)).decode()
        for name in names
    }
    joined = [
        {"particle": each.first_particle, "spring": each.first_spring, "definition": each.definition}
        for each in state.equipment.joined
    ]
    return {"state": arrays, "settings": asdict(state.settings)} | ({"joined": joined} if joined else {})


def _equipment(
    world: LevelWorld, joined: Sequence[Mapping[str, Any]], grabs: tuple[int, int], state: Mapping[str, NDArray[Any]]
) -> Equipment:
    """The equipment of a level's world once bodies of a state line have joined it, whose arrays are given.

    grabs: where hands have their slots. Raises ValueError.
    """
    world.grab_particle, world.grab_spring = grabs
    most = [len(state[name]) for name in ("mass", "law")]
    for each in joined:
        first, present = [each["particle"], each["spring"]], [world.particle_count, world.spring_count]
        if not all(least <= slot <= limit for least, slot, limit in zip(present, first, most, strict=True)):
            raise ValueError("joined: bodies lie over each other, or beyond the arrays")
        # What lies between them counts for its names alone.
        for family, slot, count in zip((Family.PARTICLE, Family.SPRING), first, present, strict=True):
            grow(world, family, slot - count, {})
        world.particle_active[present[0] :], world.mass[present[0] :] = True, 1.0
        world.name_slots_to(*first)
        join_definition(world, each["definition"])
    return world.equipment


def decode_state(
    level: Level, tick: int, state: dict[str, str], settings: WorldSettings, joined: Sequence[Mapping[str, Any]],
    most: int = STATE_LIMIT,
) -> Snapshot:  # fmt: skip
    """The snapshot of a state line of a level's run; joined: what joined it until then. Raises ValueError, one line."""
    if not ALWAYS_STORED <= set(state) <= set(BY_STORED):
        raise ValueError(f"state: the arrays are {', '.join(BY_STORED)}")
    arrays: dict[str, NDArray[Any]] = {}
    world = build_world(level)
    for family, columns in FAMILIES.items():
        names = [column.stored for column in columns]
        # The level says how many rows rules have, also where a file is older than they.
        counts = {len(getattr(world, columns[0].name))} if family in OF_RULES else set()
        for column in columns:
            if column.stored in state:
                arrays[column.stored] = decode_array(column, state[column.stored])
                most -= arrays[column.stored].nbytes
                if most < 0:
                    raise ValueError("state: holds more than there is memory for")
                counts.add(len(arrays[column.stored]))
            if len(counts) > 1:
                raise ValueError(f"state: {', '.join(names)} are not equally long")
        if not counts:
            raise ValueError(f"state: {', '.join(names)} are not equally long")
        # What a file does not have yet is as usual.
        arrays |= {column.stored: column.usual_rows(*counts) for column in columns if column.stored not in state}
    elements = [arrays[f"element_{each}"] for each in ("kind", "first", "corners")]
    check_corners("state.element", elements, len(arrays["corner_particle"]))
    hands = np.flatnonzero(arrays["material"] == GRAB_MATERIAL)
    if len(hands) not in (0, GRAB_COUNT) or np.any(np.diff(hands) != 1):
        raise ValueError(f"state.material: there are {GRAB_COUNT} hands in a row, or none")
    grab_spring = int(hands[0]) if len(hands) else -1
    grab_particle = int(arrays["particle_a"][grab_spring]) if len(hands) else -1
    if len(hands) and grab_particle + GRAB_COUNT > len(arrays["mass"]):
        raise ValueError("state.particle_a: a hand has no particle of its own")
    if len(arrays["hand_force"]) != len(hands):
        raise ValueError("state.hand_force: there is one of each hand")
    if len(arrays["setting_ticks"]) != NUMBER_COUNT:
        raise ValueError(f"state.setting_ticks: there are {NUMBER_COUNT}, one of each number of the settings")
    equipment = _equipment(world, joined, (grab_particle, grab_spring), arrays)
    rows = {family: len(arrays[columns[0].stored]) for family, columns in FAMILIES.items()}
    room = room_of(world)._replace(rows=rows)
    try:
        for column in COLUMNS:
            check_whole_numbers(f"state.{column.stored}", column, arrays[column.stored], room)
    except IndexError as error:
        raise ValueError(str(error)) from None
    driven, values = len(equipment.actuators.names), len(arrays["part_value"])
    if driven != values:
        raise ValueError(f"state.part_value: has {values} values, where there are {driven} driven parts")
    return Snapshot(
        {BY_STORED[name].name: array for name, array in arrays.items()},
        settings=settings,
        tick=tick,
        grab_particle=grab_particle,
        grab_spring=grab_spring,
        terrain=NO_TERRAIN,
        equipment=equipment,
    )


def decode_array(column: Column, text: str) -> Any:
    """An array of a state line, of no more rows than there can be. Raises ValueError."""
    kind, name, most = np.dtype(column.dtype), column.stored, MOST_ROWS.get(column.family, PARTICLE_LIMIT)
    limit = most * kind.itemsize * column.width
    try:
        inflater = zlib.decompressobj()
        data = inflater.decompress(base64.b64decode(text, validate=True), limit + 1)
    except (binascii.Error, zlib.error, ValueError) as error:
        raise ValueError(f"state.{name}: not base64 of zlib data: {error}") from None
    if not inflater.eof or len(data) > limit or len(data) % (kind.itemsize * column.width):
        raise ValueError(f"state.{name}: cut off, or of more than {most:,} rows")
    array = np.frombuffer(data, dtype=kind.newbyteorder("<")).astype(kind)
    return array.reshape(-1, column.width) if column.width > 1 else array
